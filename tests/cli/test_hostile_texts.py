"""Texts of others reach the terminal and the files of the user as texts, never as orders."""

from __future__ import annotations

import dataclasses
import os
from pathlib import Path

import pytest

import tautwire as tw

from .conftest import Invoke

ESCAPE = "\x1b]0;owned\x07\x1b[2J\x9b31m"


def test_escapes_in_a_file_name(invoke: Invoke) -> None:
    """A file name with escape sequences is shown with their numbers."""
    name = f"a{ESCAPE}.yaml"
    Path(name).write_text("wires: 1\n", encoding="utf-8")
    outcome = invoke("check", name)
    assert outcome.code == 2
    assert "a<1B>]0;owned<07><1B>[2J<9B>31m.yaml" in outcome.err
    assert not set(ESCAPE[:1] + "\x07\x9b") & set(outcome.err)


def test_escapes_in_a_result(invoke: Invoke, short_run: tuple[Path, object]) -> None:
    """Titles in a result file of somebody else do not reach the terminal as orders."""
    run = tw.load_run(short_run[0] / "run.nc")
    nasty = run.case.with_(title=f"line {ESCAPE}", name="x")
    tw.save_run(dataclasses.replace(run, case=nasty), "nasty.nc")
    outcome = invoke("losses", "nasty.nc")
    told = outcome.out + outcome.err
    assert outcome.code == 0
    assert "\x1b" not in told
    assert "\x9b" not in told


def test_further_folders_are_allowed_on_the_command_line(
    invoke: Invoke, monkeypatch: pytest.MonkeyPatch
) -> None:
    """``--allow`` lets a case include a file that does not lie in its folder."""
    monkeypatch.setenv("TAUTWIRE_ALLOW", "")
    Path("lines").mkdir()
    Path("parts").mkdir()
    Path("parts/speed.yaml").write_text("speed: 200 km/h\n", encoding="utf-8")
    Path("lines/mine.yaml").write_text(
        "schema: 1\ninclude: ac-simple\nname: mine\nscenario: {include: ../parts/speed.yaml}\n",
        encoding="utf-8",
    )
    refused = invoke("check", "lines/mine.yaml")
    assert refused.code == 2
    assert f"tautwire --allow {os.path.realpath('parts')} ..." in refused.err
    assert invoke("--allow", "parts", "check", "lines/mine.yaml").code == 0
