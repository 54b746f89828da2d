"""The command ``rank``: from two cases to the page for the crew."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tautwire.analyses.survey.corrections import Correction
from tautwire.analyses.survey.rank import Figures, Ranked, Ranking
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


def test_several_tension_lengths_make_one_list(invoke: Invoke, tmp_path: Path) -> None:
    """Two lines are one list with masts and chainage; --first takes the worst of both to the
    crew's page, and only in the line where it lies something changes."""
    line = {"line.masts": ["12-1", "12-3", "12-5", "12-7"],
            "line.chainage": [12e3, 12055.0, 12110.0, 12165.0]}  # fmt: skip
    case = design(3).with_(**line)
    names = []
    for number, change in enumerate((-0.01, -0.02), 1):
        for name, one in ((f"line-{number}", case), (f"built-{number}", wrong(case, {13: change}))):
            data = one.with_(name=name).to_dict()
            (tmp_path / f"{name}.json").write_text(json.dumps(data), encoding="utf-8")
            names.append(f"{name}.json")
    shown = invoke("rank", *names, "--first", "1", "--workers", "1", "--out", "out")
    assert shown.code == 0, shown.err
    told = json.loads((tmp_path / "out" / "corrections.json").read_text(encoding="utf-8"))
    assert [(one["place"], one["line"]) for one in told["corrections"]] == [(1, 2), (2, 1)]
    assert [one["made"] for one in told["lines"]] == [0, 1]
    assert told["lines"][0]["built"] == told["lines"][0]["checked"]
    assert told["lines"][1]["built"] != told["lines"][1]["checked"]
    page = (tmp_path / "out" / "corrections.html").read_text(encoding="utf-8")
    assert "built-2: dropper 5 of span 2, mast 12-3 to 12-5, km 12.082" in page
    assert "built-1:" not in page


def _ranking(built: float, checked: float) -> Ranking:
    """Return a ranking of two corrections, of which the first raises the deviation by itself."""
    case = design(3)
    ranked = tuple(
        Ranked(
            correction=Correction(place, "dropper", 2, place, 60.0 + place, 1.0, 1.02),
            effect=3.0 - place, alone=Figures(25.0 + rise, 150.0, 60.0, 0.0),
            together=Figures(checked, 150.0, 60.0, 0.0), uplift=0.0, place=place,
        )
        for place, rise in ((1, 0.4), (2, -0.3))
    )  # fmt: skip
    figures = (Figures(value, 150.0, 60.0, 0.0) for value in (built, checked))
    first, then = figures
    return Ranking(case, first, ranked, 2, then, passages=3, length=165.0, cpu=1.0)


def test_corrections_that_make_a_line_worse_are_told(
    invoke: Invoke, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where the standard deviation with the first corrections is above that as built, terminal and
    page warn; nobody is told of a gain; corrections that raise it by themselves are marked."""
    path = tmp_path / "line.json"
    path.write_text(json.dumps(design(3).to_dict()), encoding="utf-8")
    for checked, warns in ((25.6, True), (24.0, False)):
        ranking = _ranking(25.0, checked)
        monkeypatch.setattr(
            "tautwire.cli.commands.measuring.rank.rank_lines",
            lambda *_, found=ranking, **__: [found],
        )
        (tmp_path / f"out-{warns}").mkdir()
        shown = invoke("rank", path, path, "--out", f"out-{warns}")
        assert shown.code == 0, shown.err
        page = (tmp_path / f"out-{warns}" / "corrections.html").read_text(encoding="utf-8")
        text = f"σ is {checked:.2f} N, more than the 25.00 N as built"
        assert (text in " ".join(shown.err.split())) is warns
        assert (text in page) is warns
        assert "What the first change together" in shown.out
        assert "What they change" in page
        assert "gain" not in shown.out
        assert "+0.400 ↑" in shown.out
        assert "-0.300 ↑" not in shown.out
        assert "1 ↑" in page
        assert "2 ↑" not in page


def test_cases_come_in_pairs(invoke: Invoke, tmp_path: Path) -> None:
    """A design without its line as built, and an empty list for the crew, are refused."""
    path = tmp_path / "line.json"
    path.write_text(json.dumps(design(3).to_dict()), encoding="utf-8")
    odd = invoke("rank", path, path, path)
    assert (odd.code, "rank line-1.yaml built-1.yaml" in odd.err) == (2, True)
    none = invoke("rank", path, path, "--first", "0")
    assert (none.code, "give 1 to 1000" in none.err) == (2, True)


def test_refuses_a_line_that_is_as_designed(invoke: Invoke, tmp_path: Path) -> None:
    """Nothing to correct is said with a cure."""
    path = tmp_path / "line.json"
    path.write_text(json.dumps(design(3).to_dict()), encoding="utf-8")
    refused = invoke("rank", path, path)
    assert refused.code == 2
    assert "--least" in refused.err


def _is_gone(group: int) -> bool:
    """Return whether a group of processes has ended within ten seconds."""
    for _ in range(100):
        try:
            os.killpg(group, 0)
        except ProcessLookupError:
            return True
        time.sleep(0.1)
    return False


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
@pytest.mark.parametrize("workers", [1, 2])
def test_a_stop_says_what_is_kept_and_ends(workers: int, tmp_path: Path) -> None:
    """Two signals at once, as a terminal and a supervisor send them, end the command and its
    processes; what is finished is kept and the message says where."""
    case = design(12)
    wrongs = dict.fromkeys(range(0, len(case.line.span_lengths()) * 9, 9), 0.02)
    for name, one in (("line", case), ("built", wrong(case, wrongs))):
        (tmp_path / f"{name}.json").write_text(json.dumps(one.to_dict()), encoding="utf-8")
    program = [sys.executable, "-m", "tautwire", "rank", "line.json", "built.json"]
    with subprocess.Popen(
        [*program, "--out", "out", "--workers", str(workers)],
        cwd=tmp_path,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as process:
        end = time.monotonic() + 120.0
        while not list(tmp_path.glob("out/passages/*.npz")) and time.monotonic() < end:
            assert process.poll() is None
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        os.killpg(process.pid, signal.SIGINT)
        _, told = process.communicate(timeout=60)
    assert process.returncode == 130, told
    assert "what is finished is kept in" in told
    assert list(tmp_path.glob("out/passages/*.npz"))
    assert _is_gone(process.pid)


def test_a_stop_without_a_folder_keeps_nothing(
    invoke: Invoke, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without a folder nothing can be kept, and the message says so."""
    path = tmp_path / "line.json"
    path.write_text(json.dumps(design(3).to_dict()), encoding="utf-8")

    def stopped(*_: object, **__: object) -> None:
        raise Interrupted(2)

    monkeypatch.setattr("tautwire.cli.commands.measuring.rank.rank_lines", stopped)
    told = invoke("rank", path, path)
    assert told.code == 130
    assert "nothing was kept" in told.err
