"""``study``: a base case computed many times, in parallel, resumable."""

from __future__ import annotations

import logging
import re
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from tautwire.analyses.threads import core_count
from tautwire.cli.about import program
from tautwire.cli.folders import Files, prepared_folder, tell_files
from tautwire.cli.interrupts import Interrupts
from tautwire.cli.json_text import to_json
from tautwire.cli.progress import SECONDS_BETWEEN_LINES, duration
from tautwire.cli.session import DONE, FAILED, Answer
from tautwire.cli.views.tables import facts, heading, table
from tautwire.errors import InputError
from tautwire.files import write_text
from tautwire.inputs.attached import load_project
from tautwire.model.preflight import Advice, preflight
from tautwire.report.figures.study_figures import readable_axis
from tautwire.report.pages.study_page import write_study_report
from tautwire.report.parts.words import with_error
from tautwire.specs.project import Project
from tautwire.studies.execution.executor import Executor, LocalWorkers, StudyError
from tautwire.studies.files import save_csv, save_netcdf
from tautwire.studies.plan import WHOLE, Plan, plan_study
from tautwire.studies.run import Options, StudyProgress, run_study
from tautwire.studies.store import Store
from tautwire.studies.study_file import load_study
from tautwire.studies.table import StudyTable, collect
from tautwire.text import MARK, as_name, marked
from tautwire.version import __version__

if TYPE_CHECKING:
    from rich.progress import Progress as Bar

MOST_ROWS = 30
"""Rows shown on the terminal: what fits on a screen; the files hold all."""
MOST_WORKERS = 1000
"""Workers that may be asked for; a slip of the finger is told before it fills the memory."""
MOST_ADVISED = 300
"""Cases whose advice is computed before the work, some ten milliseconds each."""


@dataclass(frozen=True)
class StudyRequest:
    """What the user asked for.

    Attributes
    ----------
    study : Path
    workers : int or None
    cluster : str or None
    certificates : Path or None
        Their folder.
    options : Options
    out : Path or None
    error : str or None
        Kind of numerical error of every figure, in place of ``settings.error`` of the cases.
    project : Path or None
        File with the project block.
    """

    study: Path
    workers: int | None
    cluster: str | None
    certificates: Path | None
    options: Options
    out: Path | None
    error: str | None = None
    project: Path | None = None


def run_study_file(answer: Answer, request: StudyRequest) -> None:
    """Run a study, show its outcome and write its files, also when it was stopped."""
    study = load_study(request.study)
    if request.error is not None:
        study = study.with_(overrides={**study.overrides, "settings.error": request.error})
    plan = plan_study(study)
    project = plan.project if request.project is None else load_project(request.project)
    interrupts, begin = Interrupts(), time.perf_counter()
    wanted = request.out or _default_folder(plan)
    with prepared_folder(wanted) as folder, interrupts.handled():
        executor = _executor(request, folder)
        answer.say(program())
        answer.say(_opening(plan))
        _tell_advice(answer, plan)
        with StudyWatch(answer, interrupts) as watch, interrupts.patient():
            found, stopped = _computed(plan, folder, executor, request.options, watch)
        with interrupts.patient():
            elapsed = time.perf_counter() - begin
            answer.document.update(_document(found, watch.last, executor, elapsed))
            if stopped is not None:
                answer.fail("study", [str(stopped)], FAILED)
            if request.options.shard != WHOLE and found.counts()["missing"]:
                _leave_to_others(answer, request, folder, found)
            else:
                answer.show(*_view(found, watch.last, elapsed))
                answer.warn(found.mixture().splitlines())
                _write_files(answer, Files(folder), found, executor, project)
            _refuse_failures(answer, found, watch.last)
    if interrupts.requested is not None:
        answer.exit_code = interrupts.exit_code


def _computed(
    plan: Plan, folder: Path, executor: Executor, options: Options, watch: StudyWatch
) -> tuple[StudyTable, StudyError | None]:
    """Return the table, and why the study stopped before its end."""
    try:
        return run_study(plan, folder, executor=executor, options=options, watch=watch), None
    except StudyError as error:
        return collect(plan, Store(folder)), error


def _executor(request: StudyRequest, folder: Path) -> Executor:
    if request.cluster is not None and request.workers is not None:
        raise InputError("--workers and --cluster exclude each other; give one of them")
    if request.cluster is None and request.certificates is not None:
        raise InputError("--tls is for --cluster tls://HOST:PORT; give both")
    if request.cluster is not None:
        from tautwire.studies.execution.cluster import DaskCluster

        logging.getLogger("distributed").setLevel(logging.CRITICAL)  # what is lost is told below
        return DaskCluster(request.cluster, folder, certificates=request.certificates)
    count = core_count() if request.workers is None else request.workers
    if not 1 <= count <= MOST_WORKERS:
        raise InputError(f"--workers: got {count}; give 1 to {MOST_WORKERS}")
    return LocalWorkers(count, folder)


def _default_folder(plan: Plan) -> Path:
    return Path("tautwire-study-" + as_name(plan.study.name))


def _opening(plan: Plan) -> str:
    axes = " × ".join(
        f"{' + '.join(axis.name for axis in dimension.axes)} ({dimension.size})"
        for dimension in plan.dimensions
    )
    refused = sum(bool(point.problems) for point in plan.points)
    text = f"{len(plan.points)} cases: {axes}"
    return f"{text}; {refused} of them refused by validation" if refused else text


def _tell_advice(answer: Answer, plan: Plan) -> None:
    """Tell before the work what mesh, step and line of the cases cannot do, alike ones once."""
    points = list(plan.by_key.values())[:MOST_ADVISED]
    found: dict[tuple[str, str], list[Advice]] = {}
    for point in points:
        for advice in preflight(plan.case(point)):
            found.setdefault((advice.severity, advice.topic), []).append(advice)
    for (severity, _), alike in found.items():
        text = f"{alike[0]} ({len(alike)} of {len(points)} cases)"
        if severity == "note":
            answer.say(f"note: {text}")
        else:
            answer.warn([text])


def _leave_to_others(
    answer: Answer, request: StudyRequest, folder: Path, found: StudyTable
) -> None:
    """Say how far the whole study is, of which a part was computed."""
    counts = found.counts()
    there = found.status.size - counts["missing"]
    answer.document["files"] = {}
    kind = "" if request.error is None else f" --error {request.error}"
    answer.show(
        f"part {request.options.shard}: {there} of {found.status.size} cases of the study are "
        "finished; when all parts have ended, put the table together with:\n"
        f"tautwire study {request.study} --out {folder}{kind} --resume"
    )


def _write_files(
    answer: Answer, files: Files, found: StudyTable, executor: Executor, project: Project
) -> None:
    """Write table, document and report.

    Raises
    ------
    OutputError
        When some cannot be written, unless a failure was told already.
    """
    text = to_json(answer.document) + "\n"
    files.write("table.csv", lambda path: save_csv(found, path))
    files.write("table.nc", lambda path: save_netcdf(found, path))
    files.write("study.json", lambda path: write_text(path, text))
    facts_of_page = {"Computed by": executor.description}
    files.write("study.html", lambda path: write_study_report(found, path, facts_of_page, project))
    tell_files(answer, files)


def _refuse_failures(answer: Answer, found: StudyTable, last: StudyProgress | None) -> None:
    """End with an error when every case that was wanted has failed."""
    if answer.exit_code == DONE and last is not None and 0 < last.total == last.failed:
        reasons = [f"{len(f.cases)} × {f.reason}" for f in found.failures()]
        answer.fail("computation", ["every case failed", *reasons], FAILED)


def _document(
    found: StudyTable, last: StudyProgress | None, executor: Executor, elapsed: float
) -> dict[str, Any]:
    computed = 0 if last is None else last.computed
    return {
        "study": found.study.name,
        "title": found.study.title,
        "version": __version__,
        "computed_by": executor.description,
        "mixture": found.mixture(),
        "cases": {"total": int(found.status.size), **found.counts()},
        "computed_now": computed,
        "kept_from_before": 0 if last is None else last.resumed,
        "elapsed_s": elapsed,
        "cpu_per_case_s": _mean(found, "cpu_s"),
        "failures": [failure.as_dict() for failure in found.failures()],
        "warned": [warned.as_dict() for warned in found.warned()],
        "axes": [
            {
                "name": axis.name,
                "path": axis.path,
                "unit": axis.unit or "1",
                "values": list(axis.coordinates),
            }
            for axis in found.axes
        ],
        "rows": found.rows(),
    }


def _mean(found: StudyTable, name: str) -> float | None:
    values = found[name].values
    kept = values[np.isfinite(values)]
    return float(kept.mean()) if kept.size else None


def _view(found: StudyTable, last: StudyProgress | None, elapsed: float) -> list[Any]:
    """Return what the terminal shows: counts, failures, the cases in short."""
    counts = found.counts()
    computed = 0 if last is None else last.computed
    kept = 0 if last is None else last.resumed
    shown = [f"{n} {word}" for word, n in counts.items() if n]
    parts: list[Any] = [
        heading(found.study.title or found.study.name, "study"),
        facts(
            [
                ("cases", ", ".join(shown)),
                ("computed now", f"{computed}, {kept} kept from before"),
                ("time", duration(elapsed)),
            ]
        ),
    ]
    for title, alike in (("Without a result", found.failures()), ("Warnings", found.warned())):
        if alike:
            rows = [(str(len(one.cases)), one.status, one.reason) for one in alike]
            parts += [heading(title), table(("cases", "", "reason"), "rlL", rows)]
    if "std" in found.variables:
        parts += [heading("Cases", _window(found)), _case_table(found)]
    return parts


def _window(found: StudyTable) -> str:
    marks = f"; {MARK}: mesh and time step do not carry it" if any(found.marked.ravel()) else ""
    first = "" if found.status.size <= MOST_ROWS else f"the first {MOST_ROWS}; "
    return f"{first}leading pantograph, sharp filter, forces in N; all in table.csv{marks}"


def _case_table(found: StudyTable) -> Any:
    axes = [(axis, *readable_axis(axis)) for axis in found.axes]
    bands = [band for band in ("0_20", "0_200") if band in found.labels["band"]]
    rows = []
    for index in list(np.ndindex(*found.status.shape))[:MOST_ROWS]:
        places = dict(zip(found.names, index, strict=True))
        where = {a.name: places[d.name] for d in found.dimensions for a in d.axes}
        values = [values[where[axis.name]] for axis, _, values in axes]
        shown = [f"{v:g}" if isinstance(v, float) else str(v) for v in values]
        if found.status[index] != "done":
            rows.append((*shown, str(found.status[index]), *[""] * (2 + len(bands))))
            continue
        rows.append((*shown, *_forces(found, index, bands)))
    heads = [title.replace(" ", "\n") for _, title, _ in axes]
    names = [f"σ\n{band.replace('_', '-')}" for band in bands]
    return table((*heads, "mean", *names, "max", "min"), "r" * (len(axes) + 3 + len(bands)), rows)


def _forces(found: StudyTable, index: tuple[int, ...], bands: Sequence[str]) -> list[str]:
    """Return mean, standard deviations and extremes of the leading pantograph."""
    at, leading = found.labels["band"].index, (*index, 0, 0)
    deviations = [
        marked(
            with_error(
                float(found["std"].values[(*leading, at(band))]),
                found.error("std", (*leading, at(band))),
            ),
            is_carried=found.carries(index, f"std_{band}"),
        )
        for band in bands
    ]
    mean, high, low = (
        with_error(float(found[n].values[leading]), found.error(n, leading))
        for n in ("mean", "maximum", "minimum")
    )
    return [mean, *deviations, high, low]


class StudyWatch:
    """Shows how far a study is, and stops it when a signal has asked for it.

    Parameters
    ----------
    answer
        The command, for its standard error.
    interrupts
        Signals received.
    """

    def __init__(self, answer: Answer, interrupts: Interrupts) -> None:
        self._answer, self._interrupts = answer, interrupts
        self._spoke, self._told = float("-inf"), set[str]()
        self._bar: Bar | None = None
        self.last: StudyProgress | None = None

    def __enter__(self) -> Self:
        if self._answer.err.is_terminal:
            self._bar = _make_bar(self._answer)
            self._bar.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._bar is not None:
            self._bar.stop()

    def __call__(self, progress: StudyProgress) -> bool:
        """Show the progress; True asks to stop."""
        self.last = progress
        self._tell(progress.message)
        if self._bar is not None:
            self._bar.update(
                self._bar.task_ids[0],
                total=progress.total,
                completed=progress.finished,
                left=_left(progress),
            )
        else:
            self._write_line(progress)
        if self._interrupts.requested is None:
            return False
        self._answer.say("stopping; finished cases are kept, --resume computes the rest")
        return True

    def _tell(self, message: str) -> None:
        """Say what happened, equal messages once."""
        pattern = re.sub(r"\d+(?:\.\d+)?", "#", message)
        if message and pattern not in self._told:
            self._told.add(pattern)
            self._answer.warn([message])

    def _write_line(self, progress: StudyProgress) -> None:
        now = time.monotonic()
        if now - self._spoke >= SECONDS_BETWEEN_LINES:
            self._spoke = now
            failed = f", {progress.failed} failed" if progress.failed else ""
            self._answer.say(
                f"{progress.finished} of {progress.total} cases{failed}{_left(progress, ', ')}"
            )


def _left(progress: StudyProgress, before: str = "") -> str:
    seconds = progress.remaining
    if not np.isfinite(seconds) or progress.finished >= progress.total:
        return ""
    return f"{before}about {duration(seconds)} left"


def _make_bar(answer: Answer) -> Bar:
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

    bar = Progress(
        TextColumn("cases"),
        BarColumn(bar_width=24),
        MofNCompleteColumn(),
        TextColumn("{task.fields[left]}", markup=False),
        console=answer.err,
        transient=True,
    )
    bar.add_task("cases", total=None, left="")
    return bar
