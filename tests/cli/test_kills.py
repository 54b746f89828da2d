"""``run`` killed and terminated at random moments: nothing finished is lost, nothing is half.

``python -m tests.cli.test_kills COUNT SEED`` does the same more often.
"""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pytest

from tautwire.results.run import Run
from tautwire.results.storage import load_run

from .conftest import SHORT

COMMAND = (sys.executable, "-m", "tautwire", "run", "ac-simple", *SHORT,
           "--set", "settings.time_step=0.2 ms", "--no-report", "--out", "out")  # fmt: skip


def _run(folder: Path, *more: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [*COMMAND, *more], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    )


def _whole(folder: Path) -> tuple[Run, float]:
    """Return an undisturbed run and the time it took [s]."""
    begin = time.perf_counter()
    with _run(folder) as process:
        _, err = process.communicate()
    assert process.returncode == 0, err
    return load_run(folder / "out" / "run.nc"), time.perf_counter() - begin


def _is_part(run: Run, whole: Run) -> bool:
    """Tell whether a run is the whole one, or its beginning, to the last bit."""
    count = run.time.size
    pairs = zip(run.pantographs, whole.pantographs, strict=True)
    return np.array_equal(run.time, whole.time[:count]) and all(
        np.array_equal(a.contact_force, b.contact_force[:count]) for a, b in pairs
    )


def disturb(dice: random.Random, folder: Path, whole: Run, duration: float) -> str:
    """Send a signal to a run at a random moment, see what it left, and run it again."""
    number = dice.choice([signal.SIGKILL, signal.SIGTERM])
    with _run(folder) as process:
        time.sleep(dice.uniform(0.0, 1.1 * duration))
        process.send_signal(number)
        _, err = process.communicate(timeout=120)
    assert "Traceback" not in err or process.returncode == -number, err
    path = folder / "out" / "run.nc"
    left = "nothing"
    if path.exists():
        kept = load_run(path)
        assert _is_part(kept, whole)
        left = kept.status
    if number == signal.SIGTERM and process.returncode == 143 and "kept" in err:
        assert path.exists() or "nothing was kept" in err
    if process.returncode == 0:
        assert left == "done"
    with _run(folder, "--force") as process:
        _, err = process.communicate()
    assert process.returncode == 0, err
    assert _is_part(load_run(path), whole)
    assert load_run(path).time.size == whole.time.size
    names = {path.name for path in (folder / "out").iterdir()}
    assert names == {"run.nc", "results.json", "droppers.csv", "force.csv"}
    return f"{signal.Signals(number).name} {left}"


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
@pytest.mark.slow
def test_killed_run_leaves_whole_files(tmp_path: Path) -> None:
    """Three times: what is left loads and is bit-equal as far as it goes; a second run ends well
    and leaves only its own files."""
    (tmp_path / "whole").mkdir()
    whole, duration = _whole(tmp_path / "whole")
    dice = random.Random(9)
    for number in range(3):
        folder = tmp_path / str(number)
        folder.mkdir()
        assert disturb(dice, folder, whole, duration)


def main(count: int, seed: int) -> None:
    """Disturb many runs."""
    dice, found = random.Random(seed), dict[str, int]()
    with tempfile.TemporaryDirectory() as place:
        whole, duration = _whole(Path(place))
        for _ in range(count):
            with tempfile.TemporaryDirectory() as folder:
                outcome = disturb(dice, Path(folder), whole, duration)
                found[outcome] = found.get(outcome, 0) + 1
    sys.stdout.write(f"{count} runs of {duration:.1f} s: {found}\n")


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))
