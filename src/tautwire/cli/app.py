"""The command ``tautwire``: what it offers, and nothing heavier than that.

Every command imports what it needs when it is called, so that help appears at once.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from tautwire.cli.groups import design, high_frequency, measuring, own_line
from tautwire.cli.groups.workflow import in_order_of_work
from tautwire.cli.idle import refuse_idle
from tautwire.cli.options import (
    AccurateOption,
    CaseArgument,
    ConditionOption,
    ErrorOption,
    ForceOption,
    FreeUpliftOption,
    JsonOption,
    LimitsOption,
    OutFolderOption,
    PdfOption,
    ProjectOption,
    SetOption,
    SystemOption,
    with_accurate,
    with_condition,
    with_error,
)
from tautwire.cli.session import FAILED, REFUSED, answering, open_closed_streams

_UsageError: Any = typer.BadParameter.__base__

app = typer.Typer(
    name="tautwire",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    epilog="Exit codes: 0 done, 1 computation failed or stopped, 2 input refused, "
    "130 or 143 interrupted with a partial result kept.",
)


def main() -> None:
    """Run the command line and end the process with its exit code."""
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")  # banded systems gain nothing from more threads
    open_closed_streams()
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")  # pyright: ignore[reportAttributeAccessIssue]
    code = run_command_line(sys.argv[1:])
    try:
        sys.stdout.flush()
    except OSError as error:
        code = _give_up_output(error)
    sys.exit(code)


def run_command_line(arguments: Sequence[str]) -> int:
    """Run one command and return its exit code.

    Parameters
    ----------
    arguments
        What follows the name of the program.
    """
    try:
        code = app(args=list(arguments), prog_name="tautwire", standalone_mode=False)
    except _UsageError as error:
        return _refuse_usage(error, as_json="--json" in arguments)
    except typer.Abort:
        return 130
    except KeyboardInterrupt:
        sys.stderr.write("interrupted\n")
        return 130
    except OSError as error:
        return _give_up_output(error)
    return code if isinstance(code, int) else 0


def _give_up_output(error: OSError) -> int:
    """End when standard output cannot be written; quietly when its reader has gone."""
    if not isinstance(error, BrokenPipeError):
        reason = error.strerror or str(error)
        sys.stderr.write(f"error: standard output cannot be written ({reason})\n")
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return FAILED


def _refuse_usage(error: Any, *, as_json: bool) -> int:
    """Say what is wrong with the arguments themselves."""
    error.show()
    if as_json:
        import json

        problem = {"kind": "usage", "problems": [error.format_message()]}
        sys.stdout.write(json.dumps({"error": problem}) + "\n")
    return REFUSED


@app.callback(invoke_without_command=True)
def tautwire(
    version: Annotated[
        bool, typer.Option("--version", help="Show the version and the backend in use.")
    ] = False,
    allow: Annotated[
        list[Path] | None,
        typer.Option(
            "--allow",
            metavar="DIR",
            help="Let a case include files and tables from this folder too, not only from its own "
            "(TAUTWIRE_ALLOW does the same); may be repeated.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Simulate how a railway pantograph and the overhead contact line move together.

    CASE is the name of a library case (see "tautwire cases") or a file.
    """
    if allow:
        before = os.environ.get("TAUTWIRE_ALLOW", "")
        folders = [*map(os.path.abspath, allow), *filter(None, [before])]
        os.environ["TAUTWIRE_ALLOW"] = os.pathsep.join(folders)
    if version:
        from tautwire.cli.about import show_version

        raise typer.Exit(show_version())


@app.command()
def cases(
    name: Annotated[
        str | None, typer.Argument(metavar="NAME", help="Library entry.", show_default=False)
    ] = None,
    copy: Annotated[
        Path | None,
        typer.Option(
            "--copy",
            metavar="FILE",
            help="Write the entry as a commented file to edit.",
            show_default=False,
        ),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Let --copy replace an existing file.")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """List what the library holds, show an entry, or copy one to start your own line from."""
    with answering(as_json) as answer:
        from tautwire.cli.commands.inputs.library import copy_entry, list_library, show_entry

        refuse_idle("--copy FILE: it replaces that file", {"--force": force and copy is None})
        if name is None:
            list_library(answer, copying=copy is not None)
        elif copy is None:
            show_entry(answer, name)
        else:
            copy_entry(answer, name, copy, force=force)


@app.command()
def check(case: CaseArgument, overrides: SetOption = None, as_json: JsonOption = False) -> None:
    """Check an input: every error at once, wave quantities, advice. No passage runs."""
    with answering(as_json) as answer:
        from tautwire.cli.commands.inputs.check import check_case

        check_case(answer, case, overrides or [])


def _reports(*, html: bool, pdf: bool) -> tuple[str, ...]:
    return tuple(kind for kind, is_wanted in (("html", html), ("pdf", pdf)) if is_wanted)


@app.command()
def static(
    case: CaseArgument,
    overrides: SetOption = None,
    condition: ConditionOption = None,
    out: OutFolderOption = None,
    no_report: Annotated[
        bool, typer.Option("--no-report", help="Do not write the HTML page.")
    ] = False,
    project: ProjectOption = None,
    pdf: PdfOption = False,
    force: ForceOption = False,
    as_json: JsonOption = False,
) -> None:
    """Find the static shape: heights, dropper lengths and forces, elasticity.

    The conditions of the case stand side by side, unless --condition names one. With --out the
    files are written: a page of the static line and one of the conditions, dropper table, workshop
    sheet, the case as a workbook, the static state.
    """
    with answering(as_json) as answer:
        from tautwire.cli.commands.static import StaticRequest, find_static

        if out is None:
            idle = {"--pdf": pdf, "--project": project, "--force": force}
            refuse_idle("--out DIR: files are written with it only", idle)
        written = _reports(html=not no_report, pdf=pdf)
        values = with_condition(overrides, condition)
        find_static(answer, StaticRequest(case, values, out, force, written, project))


@app.command()
def draw(
    case: CaseArgument,
    overrides: SetOption = None,
    condition: ConditionOption = None,
    out: Annotated[
        list[Path] | None,
        typer.Option(
            "--out", "-o", metavar="FILE",
            help="File that ends in .svg, .pdf or .dxf; may be repeated. plan.svg by default.",
            show_default=False,
        ),
    ] = None,
    scale: Annotated[
        str | None,
        typer.Option(
            "--scale", metavar="SCALE",
            help="Of lengths and of heights, as in 1:500/1:50; by default 1:1000/1:100, or the "
            "next larger at which all texts have room.",
            show_default=False,
        ),
    ] = None,
    paper: Annotated[
        str | None,
        typer.Option(
            "--paper", metavar="SIZE",
            help="A3, A2, A1, A0 or roll; by default the smallest that the plan fits on.",
            show_default=False,
        ),
    ] = None,
    project: ProjectOption = None,
    as_json: JsonOption = False,
) -> None:  # fmt: skip
    """Draw the layout plan: plan and elevation true to scale, droppers, values at the supports.

    SVG and PDF have sheets with a title block (PDF needs the extra "pdf"); DXF has the line in one
    strip, in metres along the track, on a layer for every kind of part (extra "dxf").
    """
    with answering(as_json) as answer:
        from tautwire.cli.commands.inputs.draw import DrawRequest, draw_plan

        values = with_condition(overrides, condition)
        files = out or [Path("plan.svg")]
        draw_plan(answer, DrawRequest(case, values, files, scale, paper, project))


@app.command()
def run(
    case: CaseArgument,
    overrides: SetOption = None,
    condition: ConditionOption = None,
    out: OutFolderOption = None,
    no_report: Annotated[
        bool, typer.Option("--no-report", help="Do not write the HTML report.")
    ] = False,
    system: SystemOption = "ac",
    free_uplift: FreeUpliftOption = None,
    limits: LimitsOption = None,
    project: ProjectOption = None,
    error: ErrorOption = None,
    accurate: AccurateOption = False,
    pdf: PdfOption = False,
    force: ForceOption = False,
    as_json: JsonOption = False,
) -> None:
    """Simulate a passage, the mean force tuned where the case asks for it, and report on it.

    Files go to --out, or to a folder named after the case and what is --set. A folder that holds
    another run is refused without --force. Ctrl-C stops the passage and keeps what was computed.
    """
    with answering(as_json) as answer:
        from tautwire.cli.commands.run import RunRequest, criteria_of, run_passage

        asked = criteria_of(system, free_uplift, limits)
        written = _reports(html=not no_report, pdf=pdf)
        values = with_accurate(with_error(with_condition(overrides, condition), error), accurate)
        request = RunRequest(case, values, out, asked, written, force, project)
        run_passage(answer, request)


@app.command()
def report(
    runs: Annotated[
        list[Path],
        typer.Argument(metavar="RUN.nc", help="Results of \"tautwire run\"; several are overlaid."),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", "-o", metavar="FILE", help="HTML or PDF file; report.html by default.",
            show_default=False,
        ),
    ] = None,
    system: SystemOption = "ac",
    free_uplift: FreeUpliftOption = None,
    limits: LimitsOption = None,
    project: ProjectOption = None,
    pdf: PdfOption = False,
    as_json: JsonOption = False,
) -> None:  # fmt: skip
    """Write one report about one run, or about several runs overlaid: HTML, with --pdf PDF too."""
    with answering(as_json) as answer:
        from tautwire.cli.commands.results import report_runs
        from tautwire.cli.commands.run import criteria_of

        asked = criteria_of(system, free_uplift, limits)
        report_runs(answer, runs, out or Path("report.html"), asked, project, pdf=pdf)


@app.command()
def losses(
    runs: Annotated[
        list[Path],
        typer.Argument(
            metavar="RUN.nc",
            help="Results of \"tautwire run\"; several are compared with the last one.",
        ),
    ],
    pantograph: Annotated[
        str | None,
        typer.Option(
            "--pantograph", metavar="NAME", help="The leading one by default.", show_default=False
        ),
    ] = None,
    counted: Annotated[
        bool, typer.Option("--counted", help="Count lost samples, each as one time step.")
    ] = False,
    as_json: JsonOption = False,
) -> None:  # fmt: skip
    """List the losses of contact of a run, or compare those of several runs one by one."""
    with answering(as_json) as answer:
        from tautwire.cli.commands.losses import show_losses

        show_losses(answer, runs, pantograph, counted=counted)


@app.command()
def reproduce(
    study: Annotated[
        str, typer.Argument(metavar="STUDY", help="Published study: en50318-2002 or song2021.")
    ],
    out: OutFolderOption = None,
    quick: Annotated[
        bool, typer.Option("--quick", help="song2021: fewer readings and coarser meshes.")
    ] = False,
    identify: Annotated[
        bool,
        typer.Option(
            "--identify",
            help="song2021: compare readings of what the paper leaves open with its numbers.",
        ),
    ] = False,
    workers: Annotated[
        int | None,
        typer.Option(
            "--workers", metavar="N", help="song2021: processes; one per core by default.",
            show_default=False,
        ),
    ] = None,
    as_json: JsonOption = False,
) -> None:  # fmt: skip
    """Repeat a published study and judge each of its claims: a validation record.

    song2021 keeps every finished passage in its folder; started again, it computes the rest.
    """
    with answering(as_json) as answer:
        from tautwire.cli.commands.reproduce import SONG, reproduce_study

        if study == SONG:
            from tautwire.cli.commands.song import reproduce_song

            reproduce_song(answer, out, workers, quick=quick, identify=identify)
        else:
            idle = {"--quick": quick, "--identify": identify, "--workers": workers is not None}
            refuse_idle(f"the study {SONG}: {study} has no such choice", idle)
            reproduce_study(answer, study, out)


@app.command()
def schema(as_json: JsonOption = False) -> None:  # noqa: ARG001
    """Print the JSON Schema of a case file, for editors and programs."""
    with answering(as_json=True) as answer:
        from tautwire.specs.schema.json_schema import case_json_schema

        answer.document.update(case_json_schema())


for group in (measuring, high_frequency, design, own_line):
    group.register(app)
in_order_of_work(app)
