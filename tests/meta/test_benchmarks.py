"""The benchmarks run, on a small line."""

from __future__ import annotations

import importlib.util
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from ..lines import HAS_CORE

needs_core = pytest.mark.skipif(not HAS_CORE, reason="no compiled core here")


SMALLEST = {
    "contact_loss": ("--quick", "--passages", "1"),
    "error_bars": ("--lines", "1"),
    "exudyn_line": ("--elements", "2", "--seconds", "0.2"),
    "library_lines": ("--blocks", "1"),
    "monte_carlo": ("--blocks", "1", "1"),
    "time_step": ("--spans", "4", "--nodes", "4"),
    "topologies": (),
}
"""Benchmarks and the arguments with which they run fastest."""
TESTED_BELOW = {"accuracy", "passage", "profile_steps", "run", "ten_kilometres"}
IN_PACKAGE = {"library_lines", "topologies"}
"""Benchmarks that run with ``-m``."""
PARTS = {"exudyn_rig", "machine"}
"""What benchmarks are made of."""
CLOSING = {
    "contact_loss": r"variable 1 ms against constant 1 ms, interpolated: [1-9]\d* losses, ",
    "error_bars": r"[01] of 1 lines contained",
    "exudyn_line": r"raw contact forces: correlation 0\.9\d+, ",
    "library_lines": r"ac-simple-curve, NAD 9 +39\d{3} ",
    "monte_carlo": r"{'cpu_s_per_case_1': \d",
    "time_step": r" +2\.00  extrapolated ",
    "topologies": r"graded +11532 ",
}
"""How the last line that a benchmark prints begins."""


def output(root: Path, program: str, *words: str) -> str:
    """Run a benchmark from the root of the repository and return what it prints."""
    answer = subprocess.run(
        [sys.executable, "-m", f"benchmarks.{program}", *words]
        if program in IN_PACKAGE
        else [sys.executable, str(root / "benchmarks" / f"{program}.py"), *words],
        capture_output=True,
        text=True,
        check=False,
        cwd=root,
    )
    assert answer.returncode == 0, answer.stderr
    return answer.stdout


def test_every_benchmark_is_tested(root: Path) -> None:
    """No benchmark is left out of the tests of this module."""
    found = {path.stem for path in (root / "benchmarks").glob("*.py")}
    assert found == SMALLEST.keys() | TESTED_BELOW | PARTS


@pytest.mark.slow
@needs_core
@pytest.mark.parametrize("program", SMALLEST)
def test_runs(root: Path, program: str) -> None:
    """A benchmark runs with its smallest arguments up to its last line."""
    if program == "exudyn_line" and importlib.util.find_spec("exudyn") is None:
        pytest.skip("Exudyn is not installed")
    text = output(root, program, *SMALLEST[program])
    assert re.match(CLOSING[program], text.splitlines()[-1]), text


@needs_core
def test_own_side_of_the_comparison(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Tautwire's side of the comparison with Exudyn runs without Exudyn, and begins in static
    equilibrium: 169 N of uplift, less what the base spring takes back."""
    monkeypatch.syspath_prepend(str(root / "benchmarks"))
    line = importlib.import_module("exudyn_line")
    history, case = line.with_tautwire(elements=2, seconds=0.01)
    assert case.line.spans == 10
    assert history.steps == 10
    assert 150.0 < history.force[0] < 169.0


@pytest.mark.slow
def test_passage(root: Path) -> None:
    """The measured passage tells cost, memory and the speed of the machine."""
    text = output(root, "passage", "--spans", "4", "--nodes", "4", "--seconds", "0.1")
    found = json.loads(text)
    assert found["dof"] == 6 * 2 * (4 * 10 * 3 + 1)
    assert found["cpu_per_s"] > 0.0
    assert found["memory_mb"] > 50.0
    assert min(found["dgemm"], found["cached"], found["memory"]) > 0.1


@pytest.mark.slow
@needs_core
def test_table_is_stored_and_compared(root: Path, tmp_path: Path) -> None:
    """Rows are stored as JSON with the machine beside them; the last line compares with stored rows
    and names what costs more than 10 % more work than then."""
    file = tmp_path / "stored.json"
    size = ("--spans", "4", "--seconds", "0.1", "--repeats", "1")
    words = (*size, "--only", "4 spans, NAD 9", "whole", "--store", str(file))
    text = output(root, "run", *words, "--compare", str(file))
    assert text.splitlines()[-1] == "nothing to compare with"
    rows = json.loads(file.read_text())
    assert list(rows) == ["4 spans, NAD 9", "whole run, NAD 9"]
    assert {row["processor"] for row in rows.values()} == {rows["4 spans, NAD 9"]["processor"]}
    for row in rows.values():
        assert row["work"] == pytest.approx(row["cpu_s"] * row["dgemm"])
        assert row["wall_s"] > 0.0
    rows["4 spans, NAD 9"]["work"] /= 1e3
    rows["whole run, NAD 9"]["work"] *= 1e3
    file.write_text(json.dumps(rows))
    command = [sys.executable, str(root / "benchmarks" / "run.py"), *words[:-2]]
    again = subprocess.run(
        [*command, "--compare", str(file)], capture_output=True, text=True, check=False
    )
    assert again.returncode == 1, again.stderr
    last = again.stdout.splitlines()[-1]
    assert last.startswith("REGRESSION in 1 of 2 rows compared: 4 spans, NAD 9: work +")


def test_fall_against_exudyn_is_told(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A row whose work is as stored, but whose ratio to Exudyn has fallen by more than 10 %, is a
    regression; that the rows were stored on another processor is said."""
    monkeypatch.syspath_prepend(str(root / "benchmarks"))
    run = importlib.import_module("run")
    row = {"work": 8.0, "backend": "native (AVX-512)", "ratio": 80.0, "processor": "A"}
    assert run.compared({"two wires": row}, {"two wires": row}) == (
        "no regression of more than 10% in 1 rows compared",
        False,
    )
    slower = {"two wires": row | {"ratio": 70.0}}
    text, has_regressed = run.compared(slower, {"two wires": row | {"processor": "B"}})
    assert has_regressed
    assert text == (
        "REGRESSION in 1 of 1 rows compared: two wires: ratio to Exudyn -12% (stored on B; here A)"
    )


@pytest.mark.slow
@needs_core
def test_profile(root: Path) -> None:
    """The profile's shares make up the whole step."""
    text = output(root, "profile_steps", "--spans", "4", "--nodes", "4")
    shares = [float(line.split("%")[0].split()[-1]) for line in text.splitlines()[4:]]
    assert sum(shares) == pytest.approx(100.0, abs=0.5)


@pytest.mark.slow
@needs_core
def test_accuracy(root: Path) -> None:
    """The fast path stays within 0.1 N rms and 0.5 N of full Newton, with the same losses."""
    text = output(root, "accuracy", "--spans", "4", "--nodes", "4")
    rows = [line.split() for line in text.splitlines()[1:]]
    assert len(rows) == 3
    for *_, rms, largest, losses, with_full_newton in rows:
        assert float(rms) <= 0.1
        assert float(largest) <= 0.5
        assert losses == with_full_newton
    assert int(rows[-1][-1]) >= 5


@pytest.mark.slow
@needs_core
def test_ten_kilometres(root: Path) -> None:
    """Two tension lengths instead of nine: set-up and cost are told, and what memory it took."""
    text = output(root, "ten_kilometres", "--lengths", "2", "--seconds", "1")
    first, _, setup, cost, memory, _ = text.splitlines()
    assert "2.37 km" in first
    assert "1.0 s of the passage" in first
    assert 0.0 < float(setup.split()[1]) < 20.0
    least, median = (float(part.split()[-1]) for part in cost.split(","))
    assert 0.0 < least <= median
    shape, passage, file = (float(part.split()[-1]) for part in memory.split(","))
    assert 50.0 < shape <= passage <= file < 2000.0
