"""The commands of the high-frequency programme: ``study``, ``modes`` and ``advise``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from tautwire.cli.idle import refuse_idle
from tautwire.cli.options import (
    CaseArgument,
    ConditionOption,
    ErrorOption,
    JsonOption,
    OutFolderOption,
    ProjectOption,
    SetOption,
    with_condition,
)
from tautwire.cli.session import answering
from tautwire.signals.bands import WIDEST


def register(app: typer.Typer) -> None:
    """Add the commands to the command line.

    Parameters
    ----------
    app
    """
    app.command()(modes)
    app.command()(study)
    app.command()(advise)


def modes(
    case: CaseArgument,
    near: Annotated[
        float | None,
        typer.Option(
            "--near",
            metavar="HZ",
            help="Target frequency; the first modes by default.",
            show_default=False,
        ),
    ] = None,
    count: Annotated[
        int | None,
        typer.Option("--count", metavar="N", help="Number of modes.", show_default=False),
    ] = None,
    wavelength: Annotated[
        str | None,
        typer.Option(
            "--wavelength",
            metavar="LENGTH",
            help='Search the modes sensitive to a wavelength: "2.875 m", or DD/2, SD/2, DD/4, '
            "SD/4 (parts of the dropper interval and of the distance from support to dropper).",
            show_default=False,
        ),
    ] = None,
    overrides: SetOption = None,
    condition: ConditionOption = None,
    out: OutFolderOption = None,
    project: ProjectOption = None,
    as_json: JsonOption = False,
) -> None:
    """Find modes of vibration: the first ones, or those near a frequency or of a wavelength.

    Modes near a frequency are ranked by how much of them is vertical motion of the contact wire.
    """
    with answering(as_json) as answer:
        from tautwire.cli.commands.modes import ModesRequest, find_modes

        idle = {"--project": project if out is None else None}
        refuse_idle("--out DIR: it stands on the page that is written there", idle)
        changes = with_condition(overrides, condition)
        request = ModesRequest(case, changes, near, count, wavelength, out, project)
        find_modes(answer, request)


def study(
    study_file: Annotated[
        Path, typer.Argument(metavar="STUDY", help="Study file (YAML, TOML or JSON).")
    ],
    workers: Annotated[
        int | None,
        typer.Option(
            "--workers", metavar="N",
            help="Worker processes on this machine; one per core by default.",
            show_default=False,
        ),
    ] = None,
    cluster: Annotated[
        str | None,
        typer.Option(
            "--cluster", metavar="ADDRESS",
            help='Compute on a Dask cluster, as in "tls://host:8786". On tcp:// whoever reaches '
            "the scheduler can run code on it.",
            show_default=False,
        ),
    ] = None,
    tls: Annotated[
        Path | None,
        typer.Option(
            "--tls", metavar="DIR",
            help="Certificates for tls://: ca.pem, cert.pem, key.pem.",
            show_default=False,
        ),
    ] = None,
    shard: Annotated[
        str | None,
        typer.Option(
            "--shard", metavar="I/N",
            help="Compute part I of N only, for job arrays; all parts share one folder.",
            show_default=False,
        ),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Keep the cases that are finished in the folder.")
    ] = False,
    retry_failed: Annotated[
        bool, typer.Option("--retry-failed", help="With --resume: compute failed cases again.")
    ] = False,
    error: ErrorOption = None,
    out: OutFolderOption = None,
    project: ProjectOption = None,
    as_json: JsonOption = False,
) -> None:  # fmt: skip
    """Compute a study: a base case with values that vary; one table and one report.

    Every finished case is on disk at once. Whatever stops the study, --resume goes on with it.
    """
    with answering(as_json) as answer:
        from tautwire.cli.commands.study import StudyRequest, run_study_file
        from tautwire.studies.plan import WHOLE, Shard
        from tautwire.studies.run import Options

        part = WHOLE if shard is None else Shard.parse(shard)
        options = Options(resume or retry_failed, retry_failed, shard=part)
        request = StudyRequest(study_file, workers, cluster, tls, options, out, error, project)
        run_study_file(answer, request)


def advise(
    case: CaseArgument,
    band: Annotated[
        float, typer.Option("--band", metavar="HZ", help="Upper end of the band of interest.")
    ] = WIDEST,
    overrides: SetOption = None,
    as_json: JsonOption = False,
) -> None:
    """Advise on mesh, contact stiffness and cut-off for high frequencies.

    The line's own lengths and when they are passed, the element lengths, the cut-off that covers
    a quarter of the shortest interval, and the contact stiffness that keeps head and wire together.
    """
    with answering(as_json) as answer:
        from tautwire.cli.commands.advise import give_advice

        give_advice(answer, case, overrides or [], band)
