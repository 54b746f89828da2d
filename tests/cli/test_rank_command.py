"""The command ``rank``: from two cases to the page for the crew."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tautwire.cli.session import Interrupted

from ..verification.test_rank import design, wrong
from .conftest import Invoke


def test_shows_and_writes(invoke: Invoke, tmp_path: Path) -> None:
    """The wrong dropper is shown with what to set it to; page, JSON and CSV are written."""
    case = design(3)
    for name, one in (("line", case), ("built", wrong(case, {13: -0.02}))):
        (tmp_path / f"{name}.json").write_text(json.dumps(one.to_dict()), encoding="utf-8")
    shown = invoke("rank", tmp_path / "line.json", tmp_path / "built.json", "--out", "out")
    assert shown.code == 0, shown.err
    assert "4 passages" in shown.out
    assert "+20.0" in shown.out
    page = (tmp_path / "out" / "corrections.html").read_text(encoding="utf-8")
    assert "dropper 5 of span 2" in page
    told = json.loads((tmp_path / "out" / "corrections.json").read_text(encoding="utf-8"))
    assert told["corrections"][0]["correction"]["row"] == 13
    assert (tmp_path / "out" / "corrections.csv").read_text(encoding="utf-8").count("\n") == 2


def test_refuses_a_line_that_is_as_designed(invoke: Invoke, tmp_path: Path) -> None:
    """Nothing to correct is said with a cure."""
    path = tmp_path / "line.json"
    path.write_text(json.dumps(design(3).to_dict()), encoding="utf-8")
    refused = invoke("rank", path, path)
    assert refused.code == 2
    assert "--least" in refused.err


def test_a_stop_says_what_is_kept(
    invoke: Invoke, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With a folder, a signal keeps what is finished, and the message says where."""
    path = tmp_path / "line.json"
    path.write_text(json.dumps(design(3).to_dict()), encoding="utf-8")

    def stopped(*_: object, **__: object) -> None:
        raise Interrupted(2)

    monkeypatch.setattr("tautwire.cli.commands.measuring.rank.rank", stopped)
    told = invoke("rank", path, path, "--out", "out")
    assert told.code == 130
    assert "what is finished is kept in" in told.err
    assert "nothing was kept" in invoke("rank", path, path).err
