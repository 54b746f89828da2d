"""Running of a study: hand out cases, keep what is finished, tell how far it is."""

from __future__ import annotations

import os
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from tautwire.analyses.threads import core_count
from tautwire.errors import InputError
from tautwire.files import FolderLock
from tautwire.specs.study import Study
from tautwire.studies.execution.executor import Event, Executor, LocalWorkers
from tautwire.studies.execution.task import FAILED, STANDARD_TASK, Job
from tautwire.studies.plan import WHOLE, Plan, Shard, pending, plan_study
from tautwire.studies.store import Store
from tautwire.studies.table import StudyTable, collect

_PULSE = 0.2
"""Time between two looks at signals and progress [s]."""


@dataclass(frozen=True)
class StudyProgress:
    """How far a study is.

    Attributes
    ----------
    total : int
        Cases to compute in all, equal ones counted once, refused ones not.
    resumed : int
        Cases that were finished before.
    computed : int
        Cases finished now.
    failed : int
        Failed ones among all that are finished.
    elapsed : float s
    message : str
        What has just happened, if worth telling.
    """

    total: int
    resumed: int
    computed: int
    failed: int
    elapsed: float
    message: str = ""

    @property
    def finished(self) -> int:
        """Cases that need no more computing."""
        return self.resumed + self.computed

    @property
    def share(self) -> float:
        """Share of the cases that is finished, 0 to 1."""
        return self.finished / self.total if self.total else 1.0

    @property
    def remaining(self) -> float:
        """Estimated time to go [s]; NaN before the first case is finished."""
        if not self.computed:
            return 0.0 if self.finished >= self.total else float("nan")
        return self.elapsed / self.computed * (self.total - self.finished)


Watch = Callable[[StudyProgress], bool]


@dataclass(frozen=True)
class Options:
    """How a study is run.

    Attributes
    ----------
    resume : bool
        Keep cases that are finished in the folder and compute the others.
    retry_failed : bool
        With `resume`: compute failed cases again.
    task : str
        ``module:function`` that computes a case.
    shard : Shard
        Part of the study to compute; other parts may be computed in the same folder meanwhile.
    """

    resume: bool = False
    retry_failed: bool = False
    task: str = STANDARD_TASK
    shard: Shard = WHOLE


def run_study(
    study: Study | Plan,
    folder: str | os.PathLike[str],
    *,
    executor: Executor | None = None,
    options: Options | None = None,
    watch: Watch | None = None,
) -> StudyTable:
    """Compute the cases of a study and collect them in a table.

    Every finished case is on disk at once, in the folder, under a key made of its input, the
    program version and what is computed. Whatever is killed, no finished case is lost, and with
    ``resume`` none is computed twice.

    Parameters
    ----------
    study
        A study, or one written out.
    folder
        Where results go; made if there is none.
    executor
        What computes; by default one process per core.
    options
        Whether to resume.
    watch
        Called a few times per second; returning True stops the study and keeps what is finished.

    Returns
    -------
    StudyTable
        Cases that were not computed have the status ``"missing"``.

    Raises
    ------
    InputError
        When the study is at fault, or the folder holds results and `resume` is off.
    StudyError
        When no more cases can be computed or stored.

    Examples
    --------
    >>> table = run_study(load_study("study.yaml"), "out")  # doctest: +SKIP
    """
    plan = study if isinstance(study, Plan) else plan_study(study)
    store, chosen = Store(folder), options or Options()
    with FolderLock(store.folder, str(chosen.shard) if chosen.shard != WHOLE else ""):
        if chosen.shard == WHOLE:  # drafts may be another part's, which is just writing them
            store.sweep()
        finished = _kept(plan, store, chosen)
        with executor or LocalWorkers(core_count(), folder) as running:
            _compute(plan, finished, running, chosen, watch)
        return collect(plan, store)


def _kept(plan: Plan, store: Store, options: Options) -> dict[str, str]:
    """Return the status of the cases that are finished already."""
    present = store.finished()
    if options.shard != WHOLE:
        present &= set(options.shard.of(plan.by_key))
    if present and not options.resume:
        raise InputError(
            f"{store.folder}: holds {len(present)} finished cases; add --resume to keep them and "
            "compute the rest, or choose another folder with --out"
        )
    found: dict[str, str] = {}
    for key in sorted(present & set(plan.by_key)):
        row = store.load(key) or {}
        if row.get("status") == FAILED and options.retry_failed:
            Path(store.row_path(key)).unlink(missing_ok=True)
        else:
            found[key] = str(row.get("status", ""))
    return found


def _compute(
    plan: Plan,
    finished: dict[str, str],
    executor: Executor,
    options: Options,
    watch: Watch | None,
) -> None:
    """Hand out cases until all are finished or the watch asks to stop."""
    waiting = deque(pending(plan, set(finished), options.shard))
    progress = _Counter(len(waiting) + len(finished), finished)
    running = 0
    while True:
        while waiting and executor.room > 0:
            point = waiting.popleft()
            case = plan.case(point).to_dict()
            executor.submit(Job(point.key, case, options.task, plan.study.keep_runs))
            running += 1
        if watch is not None and watch(progress.now()):
            return
        if not running:
            return
        event = executor.next(_PULSE)
        if event is not None:
            running -= event.kind == "finished"
            progress.add(event)


class _Counter:
    """Keeps the figures of the progress."""

    def __init__(self, total: int, finished: dict[str, str]) -> None:
        self._total, self._resumed = total, len(finished)
        self._failed = sum(status == FAILED for status in finished.values())
        self._computed = 0
        self._message = ""
        self._begin = time.perf_counter()

    def add(self, event: Event) -> None:
        if event.kind == "retry":
            self._message = f"a worker process {event.reason}; its case is tried again"
            return
        self._computed += 1
        self._failed += event.status == FAILED
        self._message = f"a case failed: {event.reason}" if event.status == FAILED else ""

    def now(self) -> StudyProgress:
        message, self._message = self._message, ""
        return StudyProgress(
            self._total,
            self._resumed,
            self._computed,
            self._failed,
            time.perf_counter() - self._begin,
            message,
        )
