"""The folder of the reproduction: its studies, run where something is missing, and read back."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from tautwire.analyses.threads import core_count
from tautwire.specs.case import Case
from tautwire.specs.study import Study
from tautwire.studies.execution.executor import LocalWorkers
from tautwire.studies.execution.task import DONE, STANDARD_TASK
from tautwire.studies.plan import Plan, plan_study
from tautwire.studies.run import Options, Watch, run_study
from tautwire.studies.store import Store

PASSAGES = ("passages", "irregular")
"""Studies whose cases are passages."""


class Folder:
    """The folder of a reproduction: one study per kind of computation, each resumable.

    Parameters
    ----------
    path
    workers
        Number of processes; by default one per core.
    watch
        Told the progress of every study; True stops it.
    """

    def __init__(self, path: Path, workers: int | None, watch: Watch | None) -> None:
        self._path, self._workers, self._watch = path, workers, watch
        self._plans: dict[str, Plan] = {}

    def compute(self, kind: str, study: Study, task: str = STANDARD_TASK) -> None:
        """Compute what is missing of a study, or failed before."""
        plan = self._plans[kind] = plan_study(study)
        place = self._path / kind
        store = Store(place)
        done = {key for key in store.finished() if (store.load(key) or {}).get("status") == DONE}
        if set(plan.by_key) <= done:
            return
        executor = LocalWorkers(min(self._workers or core_count(), len(plan.by_key)), place)
        options = Options(resume=True, retry_failed=True, task=task)
        run_study(plan, place, executor=executor, options=options, watch=self._watch)

    def rows(self) -> tuple[dict[str, dict[str, Any]], dict[str, str]]:
        """Return finished rows by kind and name, and why others are missing."""
        found: dict[str, dict[str, Any]] = {kind: {} for kind in self._plans}
        missing: dict[str, str] = {}
        for kind, plan in self._plans.items():
            store = Store(self._path / kind)
            for point in plan.points:
                name = str(next(iter(plan.coordinates(point).values())))
                row = store.load(point.key) if point.key else None
                if row is not None and row["status"] == DONE:
                    found[kind][name] = {**row, "key": point.key}
                elif row is not None:
                    missing[name] = str(row["reason"])
                else:
                    missing[name] = "; ".join(point.problems) or "not computed"
        return found, missing

    def run_paths(self) -> dict[str, Path]:
        """Return the run files of all finished passages by name."""
        rows, _ = self.rows()
        return {
            name: Store(self._path / kind).run_path(row["key"])
            for kind in PASSAGES
            for name, row in rows.get(kind, {}).items()
        }

    def first_case(self, kind: str) -> Case:
        """Return the first case of a study."""
        plan = self._plans[kind]
        return plan.case(plan.points[0])
