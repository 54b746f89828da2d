"""``draw``: the layout plan of a line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tautwire.analyses.road.shape import find_shape
from tautwire.cli.about import program
from tautwire.cli.commands.results import refuse_unwritable
from tautwire.cli.idle import refuse_idle
from tautwire.cli.session import Answer
from tautwire.cli.views.mapping_view import announce_tables
from tautwire.cli.views.tables import facts, heading
from tautwire.errors import InputError
from tautwire.inputs.attached import with_project
from tautwire.inputs.load import load_case
from tautwire.model.build import build
from tautwire.report.layout_plan.plan import layout_plan, problems_before
from tautwire.version import __version__


@dataclass(frozen=True)
class DrawRequest:
    """What the user asked for.

    Attributes
    ----------
    case : str
        Name or file.
    overrides : sequence of str
    out : sequence of Path
    scale, paper : str or None
    project : Path or None
        File of a project block.
    """

    case: str
    overrides: Sequence[str]
    out: Sequence[Path]
    scale: str | None
    paper: str | None
    project: Path | None


def draw_plan(answer: Answer, request: DrawRequest) -> None:
    """Find the static state of a case and write its layout plan to files."""
    wanted = list(dict.fromkeys(request.out))
    problems = problems_before(wanted, request.scale, request.paper)
    for path in wanted:
        try:
            refuse_unwritable(path)
        except InputError as error:
            problems += error.problems
    if problems:
        raise InputError(problems)
    if all(path.suffix.lower() == ".dxf" for path in wanted):
        needs = "a file in .svg or .pdf: DXF has neither sheets nor a title block"
        refuse_idle(needs, {"--paper": request.paper, "--project": request.project})
    announce_tables(answer, request.case)
    case = with_project(load_case(request.case, request.overrides), request.project)
    answer.say(program(case.settings.backend))
    plan = layout_plan(case, find_shape(build(case)), scale=request.scale, paper=request.paper)
    written = [str(plan.write(path)) for path in wanted]
    warnings = []
    if plan.left_out:
        warnings.append(
            f"{plan.left_out} pieces of the track are too short at {plan.scale} for a text about "
            "them; choose a larger scale with --scale"
        )
        answer.warn(warnings)
    answer.document.update(
        {
            "version": __version__,
            "case": case.name,
            "files": written,
            "scale": plan.scale,
            "paper": plan.paper,
            "sheets": plan.pages,
            "warnings": warnings,
        }
    )
    answer.show(
        heading("Layout plan", case.title or case.name),
        facts({"scale": plan.scale, "sheets": f"{plan.pages} of {plan.paper}"}.items()),
        *(f"{name} written" for name in written),
    )
