"""Command lines run inside the test process, and one short run whose files several tests read."""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from tautwire.cli.app import run_command_line

SHORT = (
    "--set", "line.spans=4",
    "--set", "settings.nodes_between_droppers=3",
    "--set", "settings.time_step=4 ms",
    "--set", "scenario.uplift_force=150 N",
)  # fmt: skip
"""Overrides that make a passage of the reference line last a few seconds."""


@dataclass(frozen=True)
class Outcome:
    """What a command line left behind."""

    code: int
    out: str
    err: str

    @property
    def document(self) -> Any:
        """The one JSON document on standard output."""
        return json.loads(self.out)


Invoke = Callable[..., Outcome]


def _invoke(*arguments: str | Path) -> Outcome:
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err):
        code = run_command_line([str(argument) for argument in arguments])
    return Outcome(code, out.getvalue(), err.getvalue())


@pytest.fixture
def invoke(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Invoke:
    """Run a command line in an empty folder and return exit code and both outputs."""
    monkeypatch.chdir(tmp_path)
    return _invoke


@pytest.fixture(scope="session")
def short_run(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Outcome]:
    """Folder and outcome of one short run with all its files."""
    folder = tmp_path_factory.mktemp("short") / "result"
    return folder, _invoke("run", "ac-simple", *SHORT, "--out", folder, "--json")
