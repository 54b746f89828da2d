"""Cases computed on a Dask cluster.

The cluster's workers need the same version of tautwire; they send rows back, and this process
writes them. Start workers with one thread each: ``dask worker tcp://… --nthreads 1``.
"""

from __future__ import annotations

import os
import time
from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any

from tautwire.errors import InputError
from tautwire.studies.execution.executor import MOST_LOSSES, Event, StudyError, save_row
from tautwire.studies.execution.scheduler import ask_scheduler, make_security, parse_address
from tautwire.studies.execution.task import Job, lost_row
from tautwire.studies.store import Store
from tautwire.version import __version__

_AHEAD = 2
"""Cases handed to the cluster per thread, so that no worker waits for this process."""

_FETCH = 20.0
"""Time for a finished row to come [s]; its histories, if kept, are some tens of megabytes."""

_WITHOUT_WORKERS = 20.0
"""Time without any worker after which a study stops [s]: a batch system needs some to start one."""

_SAME_VERSION = "install the same version on all workers"

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
        Of the scheduler, ``"tcp://host:8786"`` or ``"tls://host:8786"``.
    folder
        Folder of the study, to which this process writes.
    certificates
        Folder of the certificates for ``tls://``, see :func:`make_security`; None leaves it to
        Dask's configuration.
    timeout
        Time for the scheduler to answer, and again for a worker to be there [s].

    Raises
    ------
    InputError
        When the address is malformed.
    """

    def __init__(
        self,
        address: str,
        folder: str | os.PathLike[str],
        *,
        certificates: Path | None = None,
        timeout: float = 7.0,  # asked up to twice before the work: refused within 20 s
    ) -> None:
        self._address, self._store, self._timeout = parse_address(address), Store(folder), timeout
        self._certificates = certificates
        self._client: Any = None
        self._running: dict[str, tuple[Job, Any]] = {}
        self._losses: Counter[str] = Counter()
        self._ended: SimpleQueue[tuple[str, Any]] = SimpleQueue()
        self._computes, self._last_seen = "", 0.0

    @property
    def description(self) -> str:
        """What computes, in words; also after the work."""
        return f"the Dask cluster at {self._address}{self._computes}"

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
        security = make_security(self._address, self._certificates)
        ask_scheduler(self._address, security, self._timeout)
        try:
            self._client = Client(
                self._address,
                timeout=self._timeout,
                security=security,
                set_as_default=False,
                name="tautwire-study",
            )
            self._meet_workers()
        except (OSError, ValueError) as error:
            self.__exit__()
            reason = f"{type(error).__name__}: {error}"
            raise InputError(f"--cluster {self._address}: cannot be used ({reason})") from None
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        if self._client is not None:
            self._running.clear()
            self._client.close(timeout=5)  # its tasks are cancelled; a lost scheduler never answers

    def _meet_workers(self) -> None:
        """See that there are workers, and that those which answer have this version."""
        try:
            self._client.wait_for_workers(1, timeout=self._timeout)
        except TimeoutError:
            raise InputError(
                f"--cluster {self._address}: the scheduler has no workers; start some, as in: "
                f"dask worker {self._address} --nthreads 1"
            ) from None
        threads = self._client.nthreads()
        self._computes = f" (workers: {len(threads)}, threads: {sum(threads.values())})"
        for worker, version in self._versions(list(threads)).items():
            if version != __version__:
                has = f"has tautwire {version}" if version else "cannot import tautwire"
                raise InputError(
                    f"--cluster {self._address}: the worker {worker} {has}, this is {__version__}; "
                    f"{_SAME_VERSION}"
                )
        self._last_seen = time.monotonic()

    def _versions(self, workers: Sequence[str]) -> dict[str, str | None]:
        """Return the version of tautwire on the workers that are free to answer."""
        asked = {
            worker: self._client.submit(_version_finder(), workers=[worker], pure=False, priority=9)
            for worker in workers
        }
        found: dict[str, str | None] = {}
        end = time.monotonic() + self._timeout
        for worker, future in asked.items():
            with suppress(TimeoutError):  # busy with a long case: its rows tell its version
                found[worker] = future.result(timeout=max(0.1, end - time.monotonic()))
        return found

    def submit(self, job: Job) -> None:
        """Take a case."""
        name = f"tautwire-{job.key}-{self._losses[job.key]}"
        future = self._client.submit(_computer(), asdict(job), key=name, pure=False)
        self._running[job.key] = (job, future)
        future.add_done_callback(lambda own, key=job.key: self._ended.put((key, own)))

    def next(self, timeout: float) -> Event | None:
        """Wait for an event; None when nothing happened in time [s]."""
        try:
            key, future = self._ended.get(timeout=timeout)
        except Empty:
            self._see_workers()
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
            row, run_file = future.result(timeout=_FETCH)
        except KilledWorker as error:
            row, run_file = lost_row(f"its workers died while computing it ({error})"), None
        except (CancelledError, CommClosedError, TimeoutError) as error:
            if self._losses[job.key] + 1 < MOST_LOSSES:
                return self._again(job, error)
            self._threads()  # the case is to blame only as long as the scheduler answers
            reason = f"its result was lost {MOST_LOSSES} times ({type(error).__name__})"
            row, run_file = lost_row(reason), None
        except (ImportError, AttributeError) as error:  # the function itself was not understood
            raise self._unlike(f"cannot load what computes a case ({error})") from error
        except Exception as error:  # noqa: BLE001  raised by the remote machine, not by the case
            row, run_file = lost_row(f"its worker failed: {type(error).__name__}: {error}"), None
        if row["version"] != __version__:
            raise self._unlike(f"computes with tautwire {row['version']}")
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

    def _see_workers(self) -> None:
        """Stop when there have been no workers for long; others may just be starting."""
        now = time.monotonic()
        if self._threads():
            self._last_seen = now
        elif now - self._last_seen > _WITHOUT_WORKERS:
            raise self._gone(f"no workers for {_WITHOUT_WORKERS:g} s")

    def _unlike(self, what: str) -> StudyError:
        return StudyError(
            f"--cluster {self._address}: a worker {what}, this is tautwire {__version__}; "
            f"{_SAME_VERSION}; finished cases are kept"
        )

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


def _version_finder() -> Callable[[], str | None]:
    """Return a function that tells a worker's version."""

    def find_version() -> str | None:
        from importlib import import_module

        try:
            return import_module("tautwire").__version__
        except ImportError:
            return None

    return find_version


def _computer() -> Callable[[dict[str, Any]], tuple[dict[str, Any], bytes | None]]:
    """Return the function that computes a case on a worker.

    Functions made in functions travel with their code. One that travels by its name would take down
    a worker whose tautwire is laid out differently, before it can say so.
    """

    def compute(job: dict[str, Any]) -> tuple[dict[str, Any], bytes | None]:
        from tautwire.studies.execution.task import Job, perform

        outcome = perform(Job(**job))
        return outcome.row, outcome.run_file

    return compute
