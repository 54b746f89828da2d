"""Studies and reproductions killed at random moments: nothing finished is lost, no bit differs.

The moments come from a seed. ``TAUTWIRE_KILLS=30`` tries more of them than usual.
"""

from __future__ import annotations

import contextlib
import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from .conftest import SMALL, values_on_disk

pytestmark = pytest.mark.slow

KILLS = int(os.environ.get("TAUTWIRE_KILLS", "2"))
REPRODUCTIONS = int(os.environ.get("TAUTWIRE_REPRODUCTION_KILLS", "1"))

STUDY = {
    "schema": 1,
    "name": "killed",
    "base": "ac-simple",
    "overrides": SMALL,
    "keep_runs": True,
    "axes": {"scenario.speed": {"from": "200 km/h", "to": "276 km/h", "count": 20}},
}
STUDY_COMMAND = [sys.executable, "-m", "tautwire", "study", "study.json", "--workers", "2"]

REPRODUCTION = """
import sys
from tautwire.reproductions.song2021.passages import UNCALIBRATED, Scope
from tautwire.reproductions.song2021.reproduction import reproduce
scope = Scope("tiny", 9, (UNCALIBRATED,), ("hinged",), (), ((UNCALIBRATED, "rough"),), (1,))
print(reproduce(sys.argv[1], scope, workers=2, changes={"line.spans": 4}).statement)
"""
"""``reproduce --quick`` on a short line."""


def prepared(folder: Path) -> Path:
    """Return a new folder that holds the study's file."""
    folder.mkdir()
    (folder / "study.json").write_text(json.dumps(STUDY))
    return folder


def timed(command: list[str], folder: Path) -> float:
    """Run a command to its end and return how long it took [s]."""
    begin = time.monotonic()
    subprocess.run(command, cwd=folder, check=True, capture_output=True, timeout=900)
    return time.monotonic() - begin


def contents(folder: Path) -> dict[str, Any]:
    """Return the numbers of all finished cases in all studies under a folder."""
    return {
        f"{rows.parent.relative_to(folder)}/{key}": values
        for rows in folder.rglob("rows")
        for key, values in values_on_disk(rows.parent).items()
    }


def victims(process: subprocess.Popen[bytes]) -> list[int]:
    """Return the process and its children."""
    path = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    return [process.pid, *(int(child) for child in path.read_text().split())]


def kill_sometime(
    command: list[str], folder: Path, dice: random.Random, longest: float
) -> dict[str, Any]:
    """Start a command, kill it or one of its workers at some moment, and return what was there."""
    process = subprocess.Popen(
        command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    time.sleep(dice.uniform(0.2, 1.0) * longest)
    before = contents(folder)
    number = dice.choice([signal.SIGKILL, signal.SIGTERM])
    if process.poll() is None:
        with contextlib.suppress(ProcessLookupError, FileNotFoundError):  # it may just have ended
            os.kill(dice.choice(victims(process)), number)
    process.wait(timeout=900)
    return before


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], float]:
    """Numbers of the study, and the time it takes."""
    folder = prepared(tmp_path_factory.mktemp("studies") / "undisturbed")
    duration = timed(STUDY_COMMAND, folder)
    found = contents(folder)
    assert len(found) == 20
    return found, duration


@pytest.mark.parametrize("seed", range(KILLS))
def test_killed_study(tmp_path: Path, undisturbed: tuple[dict[str, Any], float], seed: int) -> None:
    """KILL or TERM of command or worker: rows on disk stay, --resume ends equal to the bit."""
    expected, duration = undisturbed
    folder = prepared(tmp_path / "killed")
    before = kill_sometime(STUDY_COMMAND, folder, random.Random(seed), duration)
    assert before.items() <= contents(folder).items() <= expected.items()
    timed([*STUDY_COMMAND, "--resume"], folder)
    assert contents(folder) == expected
    place = folder / "tautwire-study-killed"
    assert len(list((place / "runs").glob("*.nc"))) == len(expected)
    assert all((place / f"table.{kind}").is_file() for kind in ("csv", "nc"))
    assert all((place / f"study.{kind}").is_file() for kind in ("json", "html"))
    assert not list(place.rglob("*.part"))


@pytest.mark.skipif(not REPRODUCTIONS, reason="no reproductions are asked for")
def test_killed_reproduction(tmp_path: Path) -> None:
    """KILL or TERM of a reproduction: what is finished stays, the next call ends equal."""
    command = [sys.executable, "-c", REPRODUCTION]
    duration = timed([*command, str(tmp_path / "undisturbed")], tmp_path)
    expected = contents(tmp_path / "undisturbed")
    for seed in range(REPRODUCTIONS):
        folder = tmp_path / f"killed-{seed}"
        folder.mkdir()
        own = [*command, str(folder)]
        before = kill_sometime(own, folder, random.Random(seed), duration)
        assert before.items() <= contents(folder).items() <= expected.items()
        timed(own, folder)
        assert contents(folder) == expected
        assert not list(folder.rglob("*.part"))
