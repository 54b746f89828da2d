"""What people see: tables within 80 columns, warnings on standard error, quick answers."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tautwire.cli.json_text import to_json

from .conftest import SHORT, Invoke, Outcome


def _widest(text: str) -> int:
    return max(map(len, text.splitlines()))


@pytest.mark.parametrize("arguments", [("--help",), ("run", "-h"), ("cases",), ("schema", "-h")])
def test_help_and_lists(arguments: tuple[str, ...], invoke: Invoke) -> None:
    """Help and lists go to standard output and fit a terminal."""
    outcome = invoke(*arguments)
    assert outcome.code == 0
    assert outcome.err == ""
    assert _widest(outcome.out) <= 100


def test_check_for_people(invoke: Invoke) -> None:
    """``check`` shows speed, wave quantities and advice."""
    outcome = invoke("check", "ac-simple", "--set", "settings.nodes_between_droppers=9")
    assert outcome.code == 0
    assert "320" in outcome.out
    assert "459.6 km/h" in outcome.out
    assert "settings.nodes_between_droppers" in outcome.out
    assert "CPU time each with the compiled core" in outcome.out
    assert _widest(outcome.out) <= 80


def test_static_for_people(invoke: Invoke) -> None:
    """``static`` shows a span, the line, and writes files only when asked."""
    outcome = invoke("static", "ac-simple", *SHORT, "--set", "settings.section=[2, 2]")
    assert outcome.code == 0
    assert "dropper 9" in outcome.out
    assert "non-uniformity" in outcome.out
    assert _widest(outcome.out) <= 80
    assert not list(Path().iterdir())


def test_a_narrow_terminal_loses_no_digit(invoke: Invoke, monkeypatch: pytest.MonkeyPatch) -> None:
    """At 40 columns every number of a wide terminal is there, whole."""

    def numbers(columns: int) -> list[str]:
        monkeypatch.setenv("COLUMNS", str(columns))
        outcome = invoke("static", "ac-simple", *SHORT, "--set", "settings.section=[2, 2]")
        return sorted(re.findall(r"-?\d+\.\d+", outcome.out))

    assert numbers(40) == numbers(160)


def test_static_files(invoke: Invoke) -> None:
    """With ``--out`` the static state and its tables are files."""
    outcome = invoke(
        "static", "ac-simple", *SHORT, "--set", "settings.section=[2, 2]", "--out", "line"
    )
    tables = {"droppers.csv", "elasticity.csv", "supports.csv", "design.csv"}
    pages = {"static.html", "workshop.xlsx", "line.xlsx"}
    names = {"static.nc", "static.json", *pages, *tables}
    assert outcome.code == 0
    assert {path.name for path in Path("line").iterdir()} == names
    rows = Path("line/elasticity.csv").read_text(encoding="utf-8").splitlines()
    assert rows[0] == "span,kind,index,position [m],elasticity under 100 N [mm/N]"
    assert rows[1].startswith("2,support,0,55.0000,0.")


def test_run_for_people(invoke: Invoke) -> None:
    """``run`` shows force, limits and published results, and writes to a folder of its own."""
    outcome = invoke(
        "run", "ac-simple", *SHORT, "--no-report", "--free-uplift", "120 mm",
        "--out", "tautwire-ac-simple",
    )  # fmt: skip
    assert outcome.code == 0
    assert "σ 0-20 Hz" in outcome.out
    assert re.search(r"EN 50119 +within +not checked", outcome.out)
    assert "not checked: nobody compared the limit with the standard's text" in outcome.out
    assert "passed" not in outcome.out
    assert "world benchmark (2015)" in outcome.out
    assert "warning: ends of the line" in outcome.err
    assert "warning: mesh" in outcome.err
    assert "degrees of freedom" in outcome.err
    assert _widest(outcome.out) <= 80
    assert not Path("tautwire-ac-simple/report.html").exists()
    assert Path("tautwire-ac-simple/run.nc").exists()


def test_compare_for_people(short_run: tuple[Path, Outcome], invoke: Invoke) -> None:
    """``compare`` shows the table of the standard; a tolerance nobody verified never passes."""
    rows = (short_run[0] / "force.csv").read_text(encoding="utf-8").splitlines()
    Path("measured.csv").write_text(
        "\n".join(",".join(row.split(",")[1:3]) for row in rows), encoding="utf-8"
    )
    outcome = invoke("compare", short_run[0] / "run.nc", "measured.csv")
    assert outcome.code == 0
    assert "−20 to 20 %" in outcome.out
    assert "met, tolerance not checked" in " ".join(outcome.out.split())
    assert re.search(r"tolerances +all \d met", outcome.out)
    assert "there is neither time nor speed; the rows are timed by 320 km/h" in outcome.err


def test_compare_says_what_is_missed(short_run: tuple[Path, Outcome], invoke: Invoke) -> None:
    """A force varying twice as much, measured the other way: the miss and direction are told."""
    rows = (short_run[0] / "force.csv").read_text(encoding="utf-8").splitlines()
    # The filtered force: losses of the raw one would be taken for a sensor at the end of its range.
    samples = [[float(row.split(",")[column]) for column in (1, 3)] for row in rows[1:]]
    lines = ["position [m],force [N]", *(f"{x},{2 * force - 150}" for x, force in samples[::-1])]
    Path("measured.csv").write_text("\n".join(lines), encoding="utf-8")
    outcome = invoke("compare", short_run[0] / "run.nc", "measured.csv")
    assert outcome.code == 0
    assert re.search(r"tolerances +\d of \d missed: ", outcome.out)
    assert "missed, tolerance not checked" in " ".join(outcome.out.split())
    assert "runs towards falling positions" in outcome.err
    assert "the train ran towards falling chainage" in outcome.err


def test_copy_and_check(invoke: Invoke) -> None:
    """A copy of a library case is accepted as it is, and replaced only by force."""
    assert invoke("cases", "ac-simple", "--copy", "mine.yaml").code == 0
    assert invoke("check", "mine.yaml", "--json").document["case"] == "mine"
    assert invoke("cases", "ac-simple", "--copy", "mine.yaml").code == 2
    assert invoke("cases", "ac-simple", "--copy", "mine.yaml", "--force").code == 0


def test_show_entry(invoke: Invoke) -> None:
    """``cases NAME`` shows the commented file."""
    assert "tension: 22 kN" in invoke("cases", "ac-simple").out


def test_module_runs() -> None:
    """``python -m tautwire`` is the same program."""
    told = subprocess.run(
        [sys.executable, "-m", "tautwire", "--version"], capture_output=True, text=True, check=True
    )
    assert told.stdout.startswith("tautwire ")
    assert "backend" in told.stdout


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
@pytest.mark.parametrize("arguments", [("cases",), ("cases", "--json")])
def test_standard_output_is_full(arguments: tuple[str, ...]) -> None:
    """Output that cannot be written is one sentence, not a traceback."""
    with Path("/dev/full").open("w") as full:
        told = subprocess.run(
            [sys.executable, "-m", "tautwire", *arguments],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert told.returncode == 1
    assert "No space left" in told.stderr
    assert "Traceback" not in told.stderr


def test_json_text() -> None:
    """Numbers that are not finite become null; lists of numbers stay on one line."""
    data = {"a": [1.0, float("nan")], "b": np.array([[1, 2]]), "c": {}, "d": np.float64("inf")}
    assert to_json(data) == (
        '{\n "a": [1.0, null],\n "b": [\n  [1, 2]\n ],\n "c": {},\n "d": null\n}'
    )
