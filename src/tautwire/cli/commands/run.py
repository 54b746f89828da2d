"""``run``: one passage, its files and its summary."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from tautwire.analyses.force.statistics import contact_statistics
from tautwire.analyses.road.elasticity import elasticity as compute_elasticity
from tautwire.analyses.road.pipeline import run_case
from tautwire.analyses.road.validity import judged
from tautwire.analyses.threads import core_count
from tautwire.assessment.checks import Criteria
from tautwire.assessment.limits import known_system, limits_of, load_limits
from tautwire.cli.about import computation, program
from tautwire.cli.folders import Files, default_folder, result_folder, tell_files
from tautwire.cli.interrupts import Interrupts
from tautwire.cli.json_text import to_json
from tautwire.cli.progress import PassageWatch
from tautwire.cli.session import FAILED, Answer, OutputError
from tautwire.cli.views.documents import run_document
from tautwire.cli.views.mapping_view import announce_tables
from tautwire.cli.views.run_view import run_view
from tautwire.errors import ConvergenceError, InputError, ModelError
from tautwire.files import write_text
from tautwire.inputs.attached import with_project
from tautwire.inputs.load import load_case
from tautwire.model.build import build
from tautwire.model.plausibility import implausible_inputs
from tautwire.model.preflight import Advice, preflight
from tautwire.model.resolution import size
from tautwire.numerics.motion.backend import sharing
from tautwire.report.parts.tables import write_dropper_table, write_force_history
from tautwire.results.equilibrium import Elasticity
from tautwire.results.run import Run
from tautwire.results.storage import save_run
from tautwire.specs.case import Case
from tautwire.units import UnitError, parse_quantity

RUN_FILE = "run.nc"


@dataclass(frozen=True)
class RunRequest:
    """What the user asked for.

    Attributes
    ----------
    case : str
        Name or file.
    overrides : sequence of str
    out : Path or None
    criteria : Criteria
    reports : tuple of str
        Kinds of report that are written: ``"html"``, ``"pdf"``.
    force : bool
        Replace the files of another result.
    project : Path or None
        File with the project block.
    """

    case: str
    overrides: Sequence[str]
    out: Path | None
    criteria: Criteria
    reports: tuple[str, ...]
    force: bool = False
    project: Path | None = None


def run_passage(answer: Answer, request: RunRequest) -> None:
    """Simulate a passage, show it and write its files, also when it was stopped or failed."""
    if "pdf" in request.reports:
        from tautwire.report.writers.pdf import require_pdf

        require_pdf()
    announce_tables(answer, request.case)
    case = with_project(load_case(request.case, request.overrides), request.project)
    if request.criteria.limits is None:
        limits_of(case)  # faults are told before the passage, not after it
    interrupts = Interrupts()
    folder = request.out or default_folder(case.name, request.overrides)
    with result_folder(folder, force=request.force) as files:
        answer.say(program(case.settings.backend))
        advice = [*preflight(case), *implausible_inputs(case)]
        refuse_hopeless(advice)
        answer.advise(advice)
        answer.say(computation(size(case), case.settings.backend))
        with interrupts.handled():
            run = _passage(answer, case, interrupts)
            with interrupts.patient():
                elasticity = None
                try:
                    if run.status == "done" and interrupts.requested is None:
                        elasticity = _elasticity(run)
                finally:
                    files.write(RUN_FILE, lambda path: save_run(run, path, elasticity))
                with _telling_what_is_kept(answer, files):
                    _present(answer, run, request.criteria, [str(item) for item in advice])
                    _write(answer, files, run)
                    _write_reports(answer, files, run, elasticity, request)
                    tell_files(answer, files)
    if run.status == "failed":
        answer.fail("computation", [run.message], FAILED)
    elif interrupts.requested is not None:
        answer.exit_code = interrupts.exit_code


@contextmanager
def _telling_what_is_kept(answer: Answer, files: Files) -> Iterator[None]:
    """Say where the passage is when its evaluation fails."""
    try:
        yield
    except OutputError:
        raise
    except Exception:
        if RUN_FILE in files.written:
            path = files.written[RUN_FILE]
            answer.say(f"the passage is kept in {path}; 'tautwire report {path}' reads it")
        raise


def refuse_hopeless(advice: Sequence[Advice]) -> None:
    """Refuse a run that cannot give its result, before anything is computed.

    Raises
    ------
    ModelError
        With every reason.
    """
    reasons = [str(item) for item in advice if item.severity == "refused"]
    if reasons:
        raise ModelError("\n".join(reasons))


def criteria_of(system: str, free_uplift: str | None, file: Path | None = None) -> Criteria:
    """Read what a run is judged by as the user wrote it.

    Parameters
    ----------
    system, free_uplift
        Supply system; free space for uplift with its unit, or None.
    file
        Own limits; None for those of the case, or of the package.

    Raises
    ------
    InputError
        When one is not understood.
    """
    try:
        known_system(system)
        space = None if free_uplift is None else parse_quantity(free_uplift, "m")
    except UnitError as error:
        raise InputError(f"--free-uplift: {error}") from None
    except InputError as error:
        raise InputError([f"--system: {problem}" for problem in error.problems]) from None
    return Criteria(system.lower(), space, None if file is None else load_limits(file))


def _passage(answer: Answer, case: Case, interrupts: Interrupts) -> Run:
    """Return the run; a failed one with its status and reason."""
    tuned = case.scenario.target_mean_force() is not None
    try:
        with (
            PassageWatch(answer, interrupts, is_tuned=tuned) as watch,
            interrupts.patient(),
            sharing(core_count()),
        ):
            return run_case(case, watch=watch)
    except ConvergenceError as error:
        if not isinstance(error.partial, Run):
            raise
        return judged(replace(error.partial, status="failed", message=str(error)))


def _present(answer: Answer, run: Run, criteria: Criteria, advice: Sequence[str]) -> None:
    """Fill the document and show the summary."""
    statistics = contact_statistics(run)
    found = criteria.checks(statistics, run.case, run.accuracy)
    warnings = [*run.warnings, *statistics.notes]
    answer.warn([text for text in warnings if text not in advice])
    answer.document.update(run_document(run, statistics, found, warnings))
    answer.show(*run_view(run, statistics, found))
    if run.status == "partial":
        answer.say(run.message, style="yellow")


def _elasticity(run: Run) -> Elasticity | None:
    """Return the elasticity for the report; without it the report has one section less."""
    try:
        return compute_elasticity(build(run.case), run.equilibrium)
    except (ConvergenceError, ModelError):
        return None


def _write(answer: Answer, files: Files, run: Run) -> None:
    """Write the numbers of a run, the most important first."""
    text = to_json(answer.document) + "\n"
    files.write("results.json", lambda path: write_text(path, text))
    files.write("droppers.csv", lambda path: write_dropper_table(run.equilibrium, run.case, path))
    for number, record in enumerate(run.pantographs, 1):
        name = "force.csv" if number == 1 else f"force-{number}.csv"
        files.write(name, lambda path, who=record.name: write_force_history(run, path, who))


def _write_reports(
    answer: Answer, files: Files, run: Run, elasticity: Elasticity | None, request: RunRequest
) -> None:
    """Write the report in every form that was asked for, from one content."""
    if not request.reports:
        return
    from tautwire.report.pages.run_page import compose_report

    answer.say("writing the report")
    page = compose_report(run, elasticity, criteria=request.criteria)
    for kind in request.reports:
        files.write(f"report.{kind}", page.write)
