"""What happens to a study when processes are killed, cases fail, or the disk is full; for real."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from tautwire.errors import InputError
from tautwire.files import FolderLock
from tautwire.studies.execution.executor import LocalWorkers, StudyError
from tautwire.studies.run import Options, StudyProgress, run_study

from .conftest import Place, Start, seeds

NAP = Options(task="slow_tasks:nap")
NAP_ON = Options(task="slow_tasks:nap", resume=True)

STUDY_OF_SEEDS = """
study = make_study({"schema": 1, "name": "seeds", "base": "ac-simple",
                    "axes": {"settings.seed": {"seeds": 12}}, "keep_runs": KEEP})
run_study(study, folder, executor=LocalWorkers(2, folder), options=Options(task=TASK))
"""


def code(task: str, *, keep_runs: bool = False) -> str:
    """Return a script that runs 12 cases on two workers."""
    return STUDY_OF_SEEDS.replace("KEEP", str(keep_runs)).replace("TASK", repr(task))


def wait_for(condition: Callable[[], bool], seconds: float = 60.0) -> None:
    """Wait until something is so."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it did not happen in time"
        time.sleep(0.01)


def is_alive(process: int) -> bool:
    """Tell whether a process runs (a zombie does not)."""
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return False
    return state != "Z"


def test_killed_worker_loses_one_attempt_only(place: Place) -> None:
    """kill -9 of a worker in the middle: it is replaced, every case ends once, none is lost."""
    killed: list[int] = []
    messages: list[str] = []

    def kill_once(progress: StudyProgress) -> bool:
        messages.append(progress.message)
        if progress.computed >= 3 and not killed:
            lines = place.log.read_text().splitlines()
            busy = int([line for line in lines if line.startswith("begin")][-1].split()[2])
            os.kill(busy, signal.SIGKILL)
            killed.append(busy)
        return False

    workers = LocalWorkers(2, place.folder)
    table = run_study(seeds(12), place.folder, executor=workers, options=NAP, watch=kill_once)
    assert killed
    assert table.counts()["done"] == 12
    assert np.array_equal(table["square"].values, np.arange(12.0) ** 2)
    begun, ended = place.noted("begin"), place.noted("end")
    assert set(ended) == set(range(12))
    assert begun.total() <= 13
    assert max(begun.values()) <= 2
    assert any("killed by signal 9" in text for text in messages)
    assert not place.drafts()


@pytest.mark.slow
def test_case_that_kills_its_worker(place: Place) -> None:
    """A case that takes its worker down twice becomes a failed row; the others are computed."""
    options = Options(task="slow_tasks:murder")
    workers = LocalWorkers(2, place.folder)
    table = run_study(seeds(6), place.folder, executor=workers, options=options)
    assert table.counts() == {"done": 5, "failed": 1, "refused": 0, "missing": 0}
    assert table.status[3] == "failed"
    assert "killed by signal 9 2 times" in table.reason[3]
    assert place.noted("begin")[3] == 2


def test_failing_cases_are_rows(place: Place) -> None:
    """A case that fails is a row with its reason; equal failures are told together."""
    options = Options(task="slow_tasks:stumble")
    workers = LocalWorkers(2, place.folder)
    table = run_study(seeds(8), place.folder, executor=workers, options=options)
    assert table.counts() == {"done": 4, "failed": 4, "refused": 0, "missing": 0}
    common, single = table.failures()
    assert common.cases == (1, 4, 7)
    assert common.reason.startswith("stopped at t = 1.500 s")
    assert single.cases == (5,)
    assert "RuntimeError: an error nobody thought of" in single.reason


@pytest.mark.slow
def test_killed_parent_loses_nothing(place: Place, start_study: Start) -> None:
    """kill -9 of the parent: its workers end, finished cases stay, --resume computes the rest."""
    parent = start_study(code("slow_tasks:nap"))
    wait_for(lambda: place.rows() >= 4)
    parent.kill()
    parent.communicate()
    workers = place.workers()
    wait_for(lambda: not any(map(is_alive, workers)))
    before = set(place.noted("end"))
    kept = place.rows()
    assert 4 <= kept < 12
    table = run_study(
        seeds(12), place.folder, executor=LocalWorkers(2, place.folder), options=NAP_ON
    )
    assert table.counts()["done"] == 12
    ended = place.noted("end")
    assert set(ended) == set(range(12))
    assert ended.total() - 12 <= len(before) - kept
    assert not place.drafts()


def test_resume_computes_nothing_twice(place: Place) -> None:
    """A stopped study goes on where it was; a finished one computes nothing."""
    workers = [LocalWorkers(2, place.folder) for _ in range(3)]
    study = seeds(10)
    first = run_study(study, place.folder, executor=workers[0], options=NAP, watch=_at(3))
    assert 3 <= first.counts()["done"] < 10
    assert first.counts()["missing"] > 0
    done = {seed for seed, status in enumerate(first.status) if status == "done"}
    second = run_study(study, place.folder, executor=workers[1], options=NAP_ON)
    assert second.counts()["done"] == 10
    assert all(place.noted("begin")[seed] == 1 for seed in done)
    total = place.noted("begin").total()
    third = run_study(study, place.folder, executor=workers[2], options=NAP_ON)
    assert np.array_equal(third["square"].values, second["square"].values)
    assert place.noted("begin").total() == total


def _at(count: int) -> Callable[[StudyProgress], bool]:
    return lambda progress: progress.computed >= count


def test_equal_cases_are_computed_once(place: Place) -> None:
    """Combinations that amount to the same case share one computation."""
    study = seeds(3, axes={"settings.seed": [5, 6], "m": {"variants": {
        "a": {"line.gravity": 9.81}, "b": {"line.gravity": "9.81 m/s^2"}}}})  # fmt: skip
    table = run_study(study, place.folder, executor=LocalWorkers(1, place.folder), options=NAP)
    assert table.key[0, 0] == table.key[0, 1]
    assert table.counts()["done"] == 4
    assert place.noted("begin") == {5: 1, 6: 1}


@pytest.mark.slow
def test_failed_cases_can_be_tried_again(place: Place) -> None:
    """With retry_failed a failed case is computed again, a finished one is not."""
    study = seeds(5)
    options = Options(task="slow_tasks:stumble")
    run_study(study, place.folder, executor=LocalWorkers(1, place.folder), options=options)
    again = Options(task="slow_tasks:nap", resume=True, retry_failed=True)
    table = run_study(study, place.folder, executor=LocalWorkers(1, place.folder), options=again)
    assert table.counts()["done"] == 5
    assert place.noted("begin")[1] == 1


def test_results_are_not_overwritten_by_accident(place: Place) -> None:
    """Without resume a folder that holds results is refused, with both ways out."""
    run_study(seeds(2), place.folder, executor=LocalWorkers(1, place.folder), options=NAP)
    with pytest.raises(InputError, match=r"2 finished cases; add --resume .* or choose another"):
        run_study(seeds(2), place.folder, executor=LocalWorkers(1, place.folder), options=NAP)


def test_two_studies_cannot_share_a_folder(place: Place) -> None:
    """While one study computes in a folder, another is refused."""
    with FolderLock(place.folder), pytest.raises(InputError, match="another command is computing"):
        run_study(seeds(2), place.folder, executor=LocalWorkers(1, place.folder), options=NAP)


def test_damaged_row_is_computed_again(place: Place) -> None:
    """A row that a crash of the machine left empty counts as not there."""
    study = seeds(3)
    table = run_study(study, place.folder, executor=LocalWorkers(1, place.folder), options=NAP)
    key = str(table.key[1])
    (place.folder / "rows" / key[:2] / f"{key}.json").write_text("")
    again = run_study(study, place.folder, executor=LocalWorkers(1, place.folder), options=NAP_ON)
    assert again.counts()["done"] == 3
    assert place.noted("begin") == {0: 1, 1: 2, 2: 1}


@pytest.mark.slow
def test_workers_that_cannot_start(
    place: Place, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """When worker processes die at once the study stops and shows why."""
    broken = tmp_path / "python"
    broken.write_text("#!/bin/sh\necho no such interpreter here >&2\nexit 3\n")
    broken.chmod(0o755)
    monkeypatch.setattr("sys.executable", str(broken))
    with pytest.raises(StudyError, match=r"ended with code 3.*no such interpreter here"):
        run_study(seeds(2), place.folder, executor=LocalWorkers(1, place.folder), options=NAP)


def limit_file_size() -> None:
    """Let no file of this process and its children grow beyond 40 kB."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (40_000, 40_000))


@pytest.mark.slow
def test_file_that_cannot_be_written(place: Place, start_study: Start) -> None:
    """A case that cannot be stored stops the study; finished ones stay, no draft is left."""
    parent = start_study(code("slow_tasks:swell", keep_runs=True), preexec_fn=limit_file_size)
    _, errors = parent.communicate(timeout=120)
    assert parent.returncode == 1
    assert "a finished case cannot be written (File too large)" in errors
    assert 4 <= place.rows() < 12
    assert not place.drafts()
    table = run_study(
        seeds(12, keep_runs=True),
        place.folder,
        executor=LocalWorkers(2, place.folder),
        options=Options(task="slow_tasks:swell", resume=True),
    )
    assert table.counts()["done"] == 12


@pytest.fixture
def small_disk(place: Place) -> Iterator[Path]:
    """A file system of 96 kB in the place of the study."""
    place.folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=96k", "tmpfs", str(place.folder)]
    if os.geteuid() != 0 or subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("a small file system can be mounted by root only")
    yield place.folder
    subprocess.run(["umount", str(place.folder)], check=True)


@pytest.mark.slow
def test_full_disk(place: Place, small_disk: Path, start_study: Start) -> None:
    """On a full disk the study ends with exit code 1 and keeps every finished case."""
    parent = start_study(code("slow_tasks:swell", keep_runs=True))
    _, errors = parent.communicate(timeout=120)
    assert parent.returncode == 1
    assert "cannot be written (No space left on device); make room" in errors
    assert 1 <= place.rows() < 12
    assert not place.drafts()
    kept = place.rows()
    subprocess.run(["mount", "-o", "remount,size=4m", str(small_disk)], check=True)
    table = run_study(
        seeds(12, keep_runs=True),
        small_disk,
        executor=LocalWorkers(2, small_disk),
        options=Options(task="slow_tasks:swell", resume=True),
    )
    assert table.counts()["done"] == 12
    assert place.noted("begin").total() <= 12 + (12 - kept)
