"""``static``: shape, dropper lengths and forces, elasticity."""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path

from tautwire.analyses.design.conditions import examine, state_of
from tautwire.analyses.design.lateral import lateral_sweep
from tautwire.analyses.design.masts import Masts, masts_of
from tautwire.analyses.design.workshop import WorkshopSheet, workshop_sheet
from tautwire.analyses.road.elasticity import elasticity as compute_elasticity
from tautwire.analyses.road.shape import find_shape
from tautwire.assessment.design.checks import DesignCheck, design_checks
from tautwire.assessment.design.lateral import LateralCheck, known_gauge, lateral_check
from tautwire.cli.about import backend, program
from tautwire.cli.folders import Files, result_folder, tell_files
from tautwire.cli.interrupts import Interrupts
from tautwire.cli.json_text import to_json
from tautwire.cli.progress import StepWatch
from tautwire.cli.session import DONE, FAILED, Answer
from tautwire.cli.views.conditions_view import conditions_view
from tautwire.cli.views.design_view import lateral_view, masts_view
from tautwire.cli.views.documents import static_document
from tautwire.cli.views.mapping_view import announce_tables
from tautwire.cli.views.static_view import static_view
from tautwire.cli.views.tables import heading
from tautwire.errors import ConvergenceError
from tautwire.files import write_bytes, write_text
from tautwire.inputs.attached import with_project
from tautwire.inputs.book.case_book import write_workbook
from tautwire.inputs.load import load_case
from tautwire.model.build import Model, build
from tautwire.model.plausibility import implausible_inputs, implausible_shape
from tautwire.report.pages.conditions_page import ConditionsPage, write_conditions_page
from tautwire.report.parts.condition_words import conditions_csv
from tautwire.report.parts.design.check_words import checks_csv
from tautwire.report.parts.design.lateral_words import lateral_csv
from tautwire.report.parts.design.mast_words import (
    installation_csv,
    supports_csv,
    tensions_csv,
)
from tautwire.report.parts.design.workshop_words import rounding_in_words, workshop_sheets
from tautwire.report.parts.tables import write_dropper_table
from tautwire.results.design.conditions import ConditionState
from tautwire.results.equilibrium import Elasticity, Equilibrium
from tautwire.results.storage import save_equilibrium
from tautwire.specs.case import Case
from tautwire.specs.line.catenary import Line
from tautwire.tables.writing import workbook_bytes
from tautwire.text import csv_text

STATIC_FILE = "static.nc"


@dataclass(frozen=True)
class StaticRequest:
    """What the user asked for.

    Attributes
    ----------
    case : str
        Name or file.
    overrides : sequence of str
    out : Path or None
    force : bool
        Replace the files of another result.
    reports : tuple of str
        Kinds of page that are written: ``"html"``, ``"pdf"``.
    project : Path or None
        File with the project block.
    """

    case: str
    overrides: Sequence[str]
    out: Path | None
    force: bool = False
    reports: tuple[str, ...] = ("html",)
    project: Path | None = None


def find_static(answer: Answer, request: StaticRequest) -> None:
    """Find the static state of a case, show it, and write its files.

    The shape is on disk before the elasticity is computed, and stays when that is stopped.
    """
    if "pdf" in request.reports:
        from tautwire.report.writers.pdf import require_pdf

        require_pdf()
    announce_tables(answer, request.case)
    case = with_project(load_case(request.case, request.overrides), request.project)
    known_gauge(case.requirements.gauge)
    out, interrupts = request.out, Interrupts()
    with nullcontext() if out is None else result_folder(out, force=request.force) as files:
        answer.say(program(case.settings.backend))
        begin = time.process_time()
        with interrupts.handled():
            model = build(case)
            shape = find_shape(model)
            found = time.process_time()
            if files is not None:
                files.write(STATIC_FILE, lambda path: save_equilibrium(shape, path, case))
            answer.say(f"shape found in {found - begin:.1f} s of CPU time; elasticity follows")
            elasticity = _elasticity(answer, interrupts, model, shape)
            cost = {"shape_cpu_s": found - begin, "elasticity_cpu_s": time.process_time() - found}
            states = _conditions(answer, interrupts, model, shape, elasticity)
            design = _design(model, shape, states or (state_of(model, shape, elasticity),))
            with interrupts.patient():
                is_whole = files is not None and not interrupts.exit_code
                sheet = _workshop(answer, model, shape) if is_whole else None
                result = _Result(
                    case, shape, elasticity, design, sheet, _unusual(answer, case, shape)
                )
                answer.document["cost"] = {"dof": shape.position.size, **cost}
                _present(answer, result, interrupts)
                if files is not None:
                    _write(answer, files, result)
                    _write_design(files, case, design)
                    _write_pages(files, result, request.reports if is_whole else ())
                    tell_files(answer, files)
    answer.exit_code = interrupts.exit_code
    if answer.exit_code == DONE and design.has_faults:
        answer.exit_code = FAILED


def _elasticity(
    answer: Answer, interrupts: Interrupts, model: Model, shape: Equilibrium
) -> Elasticity | None:
    """Return the elasticity; None when a signal stopped it."""
    with StepWatch(answer, interrupts, "elasticity") as watch, interrupts.patient():
        return compute_elasticity(model, shape, watch=watch)


@dataclass(frozen=True)
class _Result:
    """What was found, and what is unusual about it."""

    case: Case
    shape: Equilibrium
    elasticity: Elasticity | None
    design: _Design
    sheet: WorkshopSheet | None
    warnings: tuple[str, ...]


def _unusual(answer: Answer, case: Case, shape: Equilibrium) -> tuple[str, ...]:
    odd = [*implausible_inputs(case), *implausible_shape(case, shape)]
    answer.advise(odd)
    return tuple(str(item) for item in odd)


def _workshop(answer: Answer, model: Model, shape: Equilibrium) -> WorkshopSheet | None:
    """Return the workshop sheet of a design with droppers; None where the line is not found."""
    if shape.operated is not None or not shape.dropper_x.size:
        return None
    try:
        return workshop_sheet(model, shape)
    except ConvergenceError as error:
        answer.warn([f"no workshop sheet: with droppers cut to workshop.step, {error}"])
        return None


def _present(answer: Answer, result: _Result, interrupts: Interrupts) -> None:
    """Fill the document and show the tables."""
    case, shape, design = result.case, result.shape, result.design
    name = backend(case.settings.backend)
    answer.document |= static_document(case, shape, result.elasticity, name, [*result.warnings])
    if interrupts.exit_code:
        answer.document["status"] = "partial"
    answer.show(*static_view(case, shape, result.elasticity))
    _show_conditions(answer, design.states)
    _show_design(answer, case.line, design)
    if result.sheet is not None:
        answer.document["workshop"] = result.sheet.as_dict()
        answer.show(heading("Workshop"), rounding_in_words(shape, result.sheet))


def _write(answer: Answer, files: Files, result: _Result) -> None:
    case, shape, found = result.case, result.shape, result.elasticity
    text = to_json(answer.document) + "\n"
    if found is not None:
        files.write(STATIC_FILE, lambda path: save_equilibrium(shape, path, case, found))
        files.write("elasticity.csv", lambda path: write_text(path, elasticity_csv(found)))
    files.write("static.json", lambda path: write_text(path, text))
    files.write("droppers.csv", lambda path: write_dropper_table(shape, case, path))
    files.write("line.xlsx", lambda path: write_workbook(case, path))
    if result.sheet is not None:
        book = workshop_sheets(case, shape, result.sheet)
        files.write("workshop.xlsx", lambda path: write_bytes(path, workbook_bytes(book)))


def _conditions(
    answer: Answer,
    interrupts: Interrupts,
    model: Model,
    design: Equilibrium,
    elasticity: Elasticity | None,
) -> tuple[ConditionState, ...]:
    """Examine the conditions of the case, unless one of them was asked for; a signal ends it."""
    case = model.case
    if not case.conditions or case.condition is not None or elasticity is None:
        return ()
    states = [state_of(model, design, elasticity)]
    for one in case.conditions:
        with StepWatch(answer, interrupts, one.name) as watch, interrupts.patient():
            states.append(examine(model, design, one.name, watch=watch))
    return tuple(states)


def _show_conditions(answer: Answer, states: tuple[ConditionState, ...]) -> None:
    if len(states) > 1:
        answer.document["conditions"] = [state.as_dict() for state in states]
        answer.show(*conditions_view(states))


@dataclass(frozen=True)
class _Design:
    """What those who design the line ask for: its states, and what follows from them."""

    states: tuple[ConditionState, ...]
    masts: Masts
    lateral: LateralCheck | None
    checks: tuple[DesignCheck, ...]

    @property
    def has_faults(self) -> bool:
        own = () if self.lateral is None else self.lateral.faults
        return bool(own) or any(state.fault for state in self.states)


def _design(model: Model, shape: Equilibrium, states: tuple[ConditionState, ...]) -> _Design:
    gauge, lateral = model.case.requirements.gauge, None
    if gauge is not None and shape.operated is None:
        lateral = lateral_check(lateral_sweep(model, shape, gauge), gauge)
    return _Design(states, masts_of(model, states), lateral, design_checks(model, states))


def _show_design(answer: Answer, line: Line, design: _Design) -> None:
    contact = tuple(
        w.name for s in design.states[:1] if s.shape for w in s.shape.of_role("contact")
    )
    answer.document["masts"] = design.masts.as_dict()
    answer.show(*masts_view(design.masts, line, contact))
    if design.lateral is not None:
        answer.document["lateral"] = design.lateral.as_dict()
        answer.show(*lateral_view(design.lateral))
    answer.document["design_checks"] = [one.as_dict() for one in design.checks]


def _write_design(files: Files, case: Case, design: _Design) -> None:
    masts, lateral, states = design.masts, design.lateral, design.states
    files.write("supports.csv", lambda path: write_text(path, supports_csv(masts, case.line)))
    if len(states) > 1:
        files.write("tensions.csv", lambda path: write_text(path, tensions_csv(masts)))
    if masts.installation:
        installed = installation_csv(masts, case.line)
        files.write("installation.csv", lambda path: write_text(path, installed))
    if lateral is not None:
        files.write("lateral.csv", lambda path: write_text(path, lateral_csv(lateral)))
    if design.checks:
        files.write("design.csv", lambda path: write_text(path, checks_csv(design.checks)))
    if len(states) > 1:
        files.write("conditions.csv", lambda path: write_text(path, conditions_csv(states)))
    if len(states) > 1 or lateral is not None:
        page = ConditionsPage(case, states, masts, lateral, design.checks)
        files.write("conditions.html", lambda path: write_conditions_page(page, path))


def _write_pages(files: Files, result: _Result, kinds: Sequence[str]) -> None:
    """Write the page in every form that was asked for, from one content."""
    if not kinds:
        return
    from tautwire.report.pages.static_page import StaticPage, compose_static_page

    design = result.design
    content = StaticPage(
        result.case,
        result.shape,
        result.elasticity,
        design.masts,
        design.lateral,
        design.checks,
        result.sheet,
        result.warnings,
    )
    page = compose_static_page(content)
    for kind in kinds:
        files.write(f"static.{kind}", page.write)


def elasticity_csv(elasticity: Elasticity) -> str:
    """Return the elasticity as CSV, one row per point."""
    force = f"{elasticity.force:g} N"
    head = ("span", "kind", "index", "position [m]", f"elasticity under {force} [mm/N]")
    points = zip(
        elasticity.span.tolist(),
        elasticity.kind,
        elasticity.index.tolist(),
        elasticity.x.tolist(),
        elasticity.elasticity.tolist(),
        strict=True,
    )
    return csv_text(
        head,
        ((span, kind, index, f"{x:.4f}", f"{1e3 * value:.6f}")
         for span, kind, index, x, value in points),
    )  # fmt: skip
