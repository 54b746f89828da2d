"""What computes the cases of a study: the interface, and worker processes on this machine."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from collections import Counter
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import IO, Any, Literal, Protocol

from tautwire.errors import TautwireError
from tautwire.studies.execution.task import FAILED, Job, lost_row
from tautwire.studies.execution.worker import FINISHED, UNWRITABLE, WORKER_MODULE
from tautwire.studies.store import Store

LOG = "workers.log"
MOST_LOSSES = 2
"""Times a case may take its worker down before it counts as failed."""

_THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "TAUTWIRE_THREADS")
_FAILED_STARTS = 3
"""Starts of each worker in a row that may fail before the study stops: one may fail for want of
memory."""
_FAREWELL = 5.0
"""Time for an idle worker to end [s]; far more than it takes, also on a busy machine."""


class StudyError(TautwireError):
    """The study cannot go on (disk full, cluster gone); what is finished is kept."""


@dataclass(frozen=True)
class Event:
    """Something that happened to a case.

    Attributes
    ----------
    key : str
    kind : str
        ``"finished"`` (its row is on disk), ``"retry"`` (its worker died, it will be tried again).
    status : str
        ``"done"`` or ``"failed"`` for a finished case.
    reason : str
    """

    key: str
    kind: Literal["finished", "retry"]
    status: str = ""
    reason: str = ""


class Executor(Protocol):
    """Computes cases; a context manager that ends its workers on leaving."""

    def __enter__(self) -> Executor: ...

    def __exit__(self, *_: object) -> None: ...

    @property
    def room(self) -> int:
        """How many more cases it takes now."""
        ...

    @property
    def description(self) -> str:
        """What computes, in words."""
        ...

    def submit(self, job: Job) -> None:
        """Take a case."""
        ...

    def next(self, timeout: float) -> Event | None:
        """Wait for an event; None when nothing happened in time [s].

        Raises
        ------
        StudyError
            When no more cases can be computed.
        """
        ...


@dataclass(eq=False)
class _Worker:
    """A worker process and the case it is computing."""

    process: subprocess.Popen[str]
    job: Job | None = None
    is_ready: bool = False


class LocalWorkers:
    """Worker processes on this machine, one case each at a time, one thread each.

    A worker that dies is replaced and its case tried once more; a case that takes a second worker
    down becomes a failed row.

    Parameters
    ----------
    count
        Number of processes.
    folder
        Folder of the study, to which the workers write.
    """

    def __init__(self, count: int, folder: str | os.PathLike[str]) -> None:
        self._count, self._store = count, Store(folder)
        self._workers: list[_Worker] = []
        self._messages: SimpleQueue[tuple[_Worker, dict[str, Any] | None]] = SimpleQueue()
        self._waiting: list[Job] = []
        self._losses: Counter[str] = Counter()
        self._failed_starts = 0

    @property
    def description(self) -> str:
        """What computes, in words."""
        return f"{self._count} worker process{'' if self._count == 1 else 'es'}"

    @property
    def room(self) -> int:
        """How many more cases it takes now."""
        busy = sum(worker.job is not None for worker in self._workers)
        return self._count - busy - len(self._waiting)

    def __enter__(self) -> LocalWorkers:
        for _ in range(self._count):
            self._start()
        return self

    def __exit__(self, *_: object) -> None:
        workers, self._workers = self._workers, []
        for worker in workers:
            _close(worker.process.stdin)  # an idle worker ends by itself
            if worker.job is not None or not worker.is_ready:
                worker.process.kill()
        for worker in workers:
            try:
                worker.process.wait(timeout=_FAREWELL)
            except subprocess.TimeoutExpired:
                worker.process.kill()
                worker.process.wait()
            _close(worker.process.stdout)

    def submit(self, job: Job) -> None:
        """Take a case."""
        self._waiting.append(job)
        self._hand_out()

    def next(self, timeout: float) -> Event | None:
        """Wait for an event; None when nothing happened in time [s]."""
        try:
            worker, message = self._messages.get(timeout=timeout)
        except Empty:
            return None
        if worker not in self._workers:
            return None
        event = self._lost(worker) if message is None else self._told(worker, message)
        self._hand_out()
        return event

    def _start(self) -> None:
        """Start a worker process and a thread that listens to it."""
        self._store.folder.mkdir(parents=True, exist_ok=True)
        with (self._store.folder / LOG).open("ab") as log:
            process = subprocess.Popen(
                [sys.executable, "-P", "-m", WORKER_MODULE, str(self._store.folder)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=log,
                text=True,
                encoding="utf-8",
                env=_environment(),
            )
        worker = _Worker(process)
        self._workers.append(worker)
        threading.Thread(target=self._listen, args=(worker,), daemon=True).start()

    def _listen(self, worker: _Worker) -> None:
        """Pass on what a worker says; its end last."""
        try:
            for line in worker.process.stdout or ():
                self._messages.put((worker, json.loads(line)))
        except ValueError:  # cut off in the middle, or closed from this side
            pass
        self._messages.put((worker, None))

    def _hand_out(self) -> None:
        """Give waiting cases to idle workers."""
        for worker in self._workers:
            if not self._waiting:
                return
            if worker.is_ready and worker.job is None:
                worker.job = self._waiting.pop(0)
                try:
                    assert worker.process.stdin is not None
                    worker.process.stdin.write(json.dumps(asdict(worker.job)) + "\n")
                    worker.process.stdin.flush()
                except OSError:
                    worker.is_ready = False  # it has died; its end is about to be told

    def _told(self, worker: _Worker, message: Mapping[str, Any]) -> Event | None:
        """Act on a message of a worker."""
        if message["event"] == UNWRITABLE:
            raise StudyError(
                f"{self._store.folder}: a finished case cannot be written ({message['reason']}); "
                "make room or choose another folder, and start again with --resume"
            )
        worker.is_ready = True
        self._failed_starts = 0
        if message["event"] != FINISHED:
            return None
        worker.job = None
        return Event(message["key"], "finished", message["status"], message["reason"])

    def _lost(self, worker: _Worker) -> Event | None:
        """Replace a worker that died; its case is tried again, or counted as failed."""
        code = worker.process.wait()
        _close(worker.process.stdin)
        _close(worker.process.stdout)
        self._workers.remove(worker)
        self._count_start(worker, code)
        self._start()
        job = worker.job
        if job is None:
            return None
        row = self._store.load(job.key)
        if row is not None:  # it died between writing and telling
            return Event(job.key, "finished", row["status"], row["reason"])
        self._losses[job.key] += 1
        how = _how_it_ended(code)
        if self._losses[job.key] < MOST_LOSSES:
            self._waiting.insert(0, job)
            return Event(job.key, "retry", reason=how)
        reason = f"its worker process {how} {MOST_LOSSES} times while computing this case"
        save_row(self._store, job.key, lost_row(reason))
        return Event(job.key, "finished", FAILED, reason)

    def _count_start(self, worker: _Worker, code: int) -> None:
        """Give up when workers die before they are ready."""
        if worker.is_ready or worker.job is not None:
            return
        self._failed_starts += 1
        if self._failed_starts >= _FAILED_STARTS * self._count:
            raise StudyError(
                f"worker processes do not start (the last one {_how_it_ended(code)}); "
                f"{self._store.folder / LOG} tells why: {_last_line(self._store.folder / LOG)}"
            )


def save_row(store: Store, key: str, row: Mapping[str, Any], run_file: bytes | None = None) -> None:
    """Write a row, or stop the study when it cannot be written.

    Raises
    ------
    StudyError
        When the disk is full or cannot be written to.
    """
    try:
        store.save(key, row, run_file)
    except OSError as error:
        raise StudyError(
            f"{store.folder}: a finished case cannot be written ({error.strerror or error}); make "
            "room or choose another folder, and start again with --resume"
        ) from error


def _environment() -> dict[str, str]:
    """Return the environment of a worker: one thread, and the modules of this process."""
    paths = os.pathsep.join(path for path in sys.path if path)
    return {**os.environ, **dict.fromkeys(_THREADS, "1"), "PYTHONPATH": paths}


def _close(pipe: IO[str] | None) -> None:
    """Close a pipe to a process that may have died."""
    try:
        if pipe is not None:
            pipe.close()
    except OSError:
        pass


def _how_it_ended(code: int) -> str:
    return f"was killed by signal {-code}" if code < 0 else f"ended with code {code}"


def _last_line(path: Path) -> str:
    try:
        lines = path.read_text(encoding="utf-8", errors="replace").split("\n")
    except OSError:
        return ""
    return next((line for line in reversed(lines) if line.strip()), "it is empty")
