"""Studies on a Dask cluster: a real scheduler and two workers on loopback, killed in the middle."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from tautwire.studies.execution.cluster import DaskCluster
from tautwire.studies.execution.executor import Event, LocalWorkers, StudyError
from tautwire.studies.execution.task import Job
from tautwire.studies.plan import plan_study
from tautwire.studies.run import Options, StudyProgress, run_study

from .conftest import HERE, Place, seeds
from .local_cluster import Cluster

pytest.importorskip("distributed", reason="Dask is not installed")
pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore")]

NAP = Options(task="slow_tasks:nap")
NAP_ON = Options(task="slow_tasks:nap", resume=True)


@pytest.fixture
def cluster(place: Place, tmp_path: Path) -> Iterator[Cluster]:
    """A scheduler and two workers with one thread each."""
    with Cluster(tmp_path, HERE) as running:
        for _ in range(2):
            running.add_worker()
        running.wait_for_workers(2)
        yield running


def test_cluster_computes_what_processes_compute(cluster: Cluster, place: Place) -> None:
    """A study gives the same table on a cluster and on local processes."""
    executor = DaskCluster(cluster.address, place.folder)
    far = run_study(seeds(6), place.folder, executor=executor, options=NAP)
    assert far.counts()["done"] == 6
    assert len(place.workers()) == 2
    local = place.folder.with_name("local")
    near = run_study(seeds(6), local, executor=LocalWorkers(1, local), options=NAP)
    assert np.array_equal(far["square"].values, near["square"].values)
    assert np.array_equal(far.key, near.key)


def test_killed_cluster_worker(cluster: Cluster, place: Place) -> None:
    """kill -9 of a cluster's worker: its case goes to the other one, no case is lost."""
    killed: list[int] = []

    def kill_once(progress: StudyProgress) -> bool:
        if progress.computed >= 3 and not killed:
            cluster.workers[0].kill()
            killed.append(progress.computed)
        return False

    executor = DaskCluster(cluster.address, place.folder)
    table = run_study(seeds(12), place.folder, executor=executor, options=NAP, watch=kill_once)
    assert killed
    assert table.counts()["done"] == 12
    begun = place.noted("begin")
    assert set(begun) == set(range(12))
    assert begun.total() <= 14


def _holder_of_a_result(cluster: Cluster) -> int:
    """Wait for a finished result and return the process of the worker that holds it."""
    from distributed import Client

    end = time.monotonic() + 30.0
    with Client(cluster.address, timeout=5, set_as_default=False) as client:
        pids = client.run(os.getpid)
        while time.monotonic() < end:
            held = [address for own in client.who_has().values() for address in own]
            if held:
                return int(pids[held[0]])
            time.sleep(0.02)
    pytest.fail("no case was finished")


def test_worker_lost_with_a_finished_result(cluster: Cluster, place: Place) -> None:
    """A worker that holds a result falls silent, then is killed: the other computes it again."""
    study = plan_study(seeds(1))
    [point] = study.points
    events: list[Event] = []
    with DaskCluster(cluster.address, place.folder, timeout=3.0) as executor:
        executor.submit(Job(point.key, study.case(point).to_dict(), "slow_tasks:nap"))
        holder = _holder_of_a_result(cluster)
        os.kill(holder, signal.SIGSTOP)
        end = time.monotonic() + 60.0
        while not any(e.kind == "finished" for e in events) and time.monotonic() < end:
            event = executor.next(0.2)
            if event is not None:
                events.append(event)
                os.kill(holder, signal.SIGKILL)
    assert [(e.kind, e.status) for e in events] == [("retry", ""), ("finished", "done")]
    assert place.rows() == 1
    assert place.noted("end")[0] >= 2  # on a busy machine the other may fall silent for a while too


def test_worker_killed_while_results_wait(cluster: Cluster, place: Place) -> None:
    """A study goes on with one worker when the other dies holding results it has not fetched."""
    killed: list[int] = []

    def kill_once(progress: StudyProgress) -> bool:
        if progress.computed >= 2 and not killed:
            time.sleep(0.5)  # both workers now hold results that were not fetched
            cluster.workers[1].kill()
            killed.append(progress.computed)
        return False

    executor = DaskCluster(cluster.address, place.folder)
    table = run_study(seeds(12), place.folder, executor=executor, options=NAP, watch=kill_once)
    assert killed
    assert table.counts()["done"] == 12
    assert np.array_equal(table["square"].values, np.arange(12.0) ** 2)


def test_killed_scheduler(cluster: Cluster, place: Place) -> None:
    """kill -9 of the scheduler stops the study with a reason; --resume computes the rest once."""
    killed: list[int] = []

    def kill_once(progress: StudyProgress) -> bool:
        if progress.computed >= 3 and not killed:
            cluster.scheduler.kill()
            killed.append(progress.computed)
        return False

    executor = DaskCluster(cluster.address, place.folder)
    with pytest.raises(StudyError, match=r"is gone .*finished cases are kept"):
        run_study(seeds(12), place.folder, executor=executor, options=NAP, watch=kill_once)
    kept = place.rows()
    assert 3 <= kept < 12
    table = run_study(
        seeds(12), place.folder, executor=LocalWorkers(2, place.folder), options=NAP_ON
    )
    assert table.counts()["done"] == 12
    assert place.noted("begin").total() <= 12 + 5


def test_failing_case_on_a_cluster(cluster: Cluster, place: Place) -> None:
    """A case that fails on a cluster is a row with its reason, as elsewhere."""
    options = Options(task="slow_tasks:stumble")
    executor = DaskCluster(cluster.address, place.folder)
    table = run_study(seeds(5), place.folder, executor=executor, options=options)
    assert table.counts() == {"done": 2, "failed": 3, "refused": 0, "missing": 0}
    assert table.failures()[0].cases == (1, 4)
