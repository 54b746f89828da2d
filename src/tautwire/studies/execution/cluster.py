"""Cases computed on a Dask cluster.

The cluster's workers need the same version of tautwire; they send rows back, and this process
writes them. Start workers with one thread each: ``dask worker tcp://… --nthreads 1``.
"""

from __future__ import annotations

import os
from collections import Counter
from dataclasses import asdict
from queue import Empty, SimpleQueue
from typing import Any

from tautwire.errors import InputError
from tautwire.studies.execution.executor import MOST_LOSSES, Event, StudyError, save_row
from tautwire.studies.execution.task import Job, lost_row, perform
from tautwire.studies.store import Store
from tautwire.version import __version__

_AHEAD = 2
"""Cases handed to the cluster per thread, so that no worker waits for this process."""

_GONE = (
    "the cluster at {address} is gone ({reason}); finished cases are kept: start again with "
    "--resume when it is back"
)


class DaskCluster:
    """Workers of a Dask cluster.

    The scheduler gives a case to another worker when its worker dies, and gives it up after its
    ``allowed-failures`` (three by default). A result that was lost with the worker that held it is
    computed again as long as the scheduler answers.

    Parameters
    ----------
    address
        Of the scheduler, ``"tcp://host:8786"``.
    folder
        Folder of the study, to which this process writes.
    timeout
        Time to reach the scheduler [s].
    """

    def __init__(
        self, address: str, folder: str | os.PathLike[str], *, timeout: float = 20.0
    ) -> None:
        self._address, self._store, self._timeout = address, Store(folder), timeout
        self._client: Any = None
        self._running: dict[str, tuple[Job, Any]] = {}
        self._losses: Counter[str] = Counter()
        self._ended: SimpleQueue[tuple[str, Any]] = SimpleQueue()

    @property
    def description(self) -> str:
        """What computes, in words."""
        return f"the Dask cluster at {self._address}, {self._threads()} threads"

    @property
    def room(self) -> int:
        """How many more cases it takes now."""
        return max(1, _AHEAD * self._threads()) - len(self._running)

    def __enter__(self) -> DaskCluster:
        try:
            from distributed import Client
        except ImportError:
            raise InputError(
                "--cluster needs Dask; install it with: pip install 'tautwire[cluster]'"
            ) from None
        try:
            self._client = Client(
                self._address, timeout=self._timeout, set_as_default=False, name="tautwire-study"
            )
        except (OSError, ValueError) as error:
            raise InputError(
                f"--cluster {self._address}: no Dask scheduler answers there "
                f"({type(error).__name__}: {error}); check address and network"
            ) from None
        return self

    def __exit__(self, *_: object) -> None:
        if self._client is not None:
            self._running.clear()
            self._client.close(timeout=5)

    def submit(self, job: Job) -> None:
        """Take a case."""
        name = f"tautwire-{job.key}-{self._losses[job.key]}"
        future = self._client.submit(compute_remotely, asdict(job), key=name, pure=False)
        self._running[job.key] = (job, future)
        future.add_done_callback(lambda own, key=job.key: self._ended.put((key, own)))

    def next(self, timeout: float) -> Event | None:
        """Wait for an event; None when nothing happened in time [s]."""
        try:
            key, future = self._ended.get(timeout=timeout)
        except Empty:
            if self._client.status not in ("running", "connecting"):
                raise self._gone(f"connection {self._client.status}") from None
            return None
        job, current = self._running.get(key, (None, None))
        if job is None or future is not current:  # an attempt that was given up
            return None
        del self._running[key]
        return self._collect(job, future)

    def _collect(self, job: Job, future: Any) -> Event:
        """Write the row that came back."""
        from distributed import CancelledError, KilledWorker
        from distributed.comm.core import CommClosedError

        try:
            row, run_file = future.result(timeout=self._timeout)
        except KilledWorker as error:
            row, run_file = lost_row(f"its workers died while computing it ({error})"), None
        except (CancelledError, CommClosedError, TimeoutError) as error:
            if self._losses[job.key] + 1 < MOST_LOSSES:
                return self._again(job, error)
            self._threads()  # the case is to blame only as long as the scheduler answers
            reason = f"its result was lost {MOST_LOSSES} times ({type(error).__name__})"
            row, run_file = lost_row(reason), None
        except Exception as error:  # noqa: BLE001  raised by the remote machine, not by the case
            row, run_file = lost_row(f"its worker failed: {type(error).__name__}: {error}"), None
        if row["version"] != __version__:
            raise StudyError(
                f"the cluster at {self._address} computes with tautwire {row['version']}, this "
                f"is {__version__}; install the same version on its workers"
            )
        save_row(self._store, job.key, row, run_file)
        return Event(job.key, "finished", row["status"], row["reason"])

    def _again(self, job: Job, error: BaseException) -> Event:
        """Compute a case again whose result did not come, if the scheduler still answers."""
        try:
            self._threads()
            self._losses[job.key] += 1
            self.submit(job)
        except (OSError, RuntimeError) as gone:
            raise self._gone(type(gone).__name__) from error
        return Event(job.key, "retry", reason=f"was lost with a result ({type(error).__name__})")

    def _gone(self, reason: str) -> StudyError:
        return StudyError(_GONE.format(address=self._address, reason=reason))

    def _threads(self) -> int:
        if self._client is None:
            return 0
        if self._client.status != "running":
            raise self._gone(f"connection {self._client.status}")
        try:
            return sum(self._client.nthreads().values())
        except (OSError, TimeoutError) as error:
            raise self._gone(type(error).__name__) from error


def compute_remotely(job: dict[str, Any]) -> tuple[dict[str, Any], bytes | None]:
    """Compute a case on a worker of the cluster."""
    outcome = perform(Job(**job))
    return outcome.row, outcome.run_file
