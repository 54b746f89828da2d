"""Help in the order of work, and completion in the shell."""

from __future__ import annotations

import os
import re
import subprocess
import sys

import pytest

from tautwire.cli.app import app
from tautwire.cli.groups.workflow import PANELS

from .conftest import Invoke


def test_commands_stand_in_the_order_of_work(invoke: Invoke) -> None:
    """From describing a line to comparing it with measurements; no command is left out."""
    outcome = invoke("--help")
    assert outcome.code == 0
    places = [outcome.out.index(panel) for panel in PANELS]
    assert places == sorted(places)
    listed = re.findall(r"^│ ([a-z][a-z-]+) ", outcome.out, re.MULTILINE)
    registered = [info.name or info.callback.__name__ for info in app.registered_commands]
    assert listed == registered
    ordered = [name for names in PANELS.values() for name in names]
    assert [name for name in ordered if name in registered] == registered


def _completed(words: str) -> list[str]:
    """Return what the shell offers after some words, the last of them incomplete."""
    asked = {
        "_TAUTWIRE_COMPLETE": "complete_bash",
        "COMP_WORDS": words,
        "COMP_CWORD": str(len(words.split(" ")) - 1),
    }
    done = subprocess.run(
        [sys.executable, "-c", "from tautwire.cli import main; main()"],
        env=os.environ | asked, capture_output=True, text=True, check=False, timeout=60,
    )  # fmt: skip
    assert not done.stderr
    return done.stdout.split()


@pytest.mark.parametrize(
    ("words", "offered"),
    [
        ("tautwire mo", ["modes"]),
        ("tautwire check ac-simple-c", ["ac-simple-curve"]),
        ("tautwire run --pro", ["--project"]),
        ("tautwire run my-line.ya", []),
    ],
)
def test_shell_completes(words: str, offered: list[str]) -> None:
    """Commands, options and library cases are completed; files are left to the shell."""
    assert _completed(words) == offered


def test_completion_can_be_installed(invoke: Invoke) -> None:
    """The help names the options that install it."""
    text = invoke("--help").out
    assert "--install-completion" in text
    assert "--show-completion" in text
