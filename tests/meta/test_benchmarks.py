"""The benchmarks run, on a small line."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from ..lines import HAS_CORE

needs_core = pytest.mark.skipif(not HAS_CORE, reason="no compiled core here")


def output(root: Path, program: str, *words: str) -> str:
    """Run a benchmark and return what it prints."""
    path = root / "benchmarks" / program
    answer = subprocess.run(
        [sys.executable, str(path), *words], capture_output=True, text=True, check=False
    )
    assert answer.returncode == 0, answer.stderr
    return answer.stdout


@pytest.mark.slow
def test_passage(root: Path) -> None:
    """The measured passage tells cost, memory and the speed of the machine."""
    text = output(root, "passage.py", "--spans", "4", "--nodes", "4", "--seconds", "0.1")
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
    text = output(root, "run.py", *words, "--compare", str(file))
    assert text.splitlines()[-1] == "nothing to compare with"
    rows = json.loads(file.read_text())
    assert list(rows) == ["4 spans, NAD 9", "whole run, NAD 9"]
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
    assert last.startswith("REGRESSION in 1 of 2 rows compared: 4 spans, NAD 9 +")


@pytest.mark.slow
@needs_core
def test_profile(root: Path) -> None:
    """The profile's shares make up the whole step."""
    text = output(root, "profile_steps.py", "--spans", "4", "--nodes", "4")
    shares = [float(line.split("%")[0].split()[-1]) for line in text.splitlines()[4:]]
    assert sum(shares) == pytest.approx(100.0, abs=0.5)


@pytest.mark.slow
@needs_core
def test_accuracy(root: Path) -> None:
    """The fast path stays within 0.1 N rms and 0.5 N of full Newton, with the same losses."""
    text = output(root, "accuracy.py", "--spans", "4", "--nodes", "4")
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
    text = output(root, "ten_kilometres.py", "--lengths", "2", "--seconds", "1")
    first, _, setup, cost, memory, _ = text.splitlines()
    assert "2.37 km" in first
    assert "1.0 s of the passage" in first
    assert 0.0 < float(setup.split()[1]) < 20.0
    least, median = (float(part.split()[-1]) for part in cost.split(","))
    assert 0.0 < least <= median
    shape, passage, file = (float(part.split()[-1]) for part in memory.split(","))
    assert 50.0 < shape <= passage <= file < 2000.0
