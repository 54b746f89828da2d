"""The commands that size a line before it is modelled: ``spans``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from tautwire.cli.options import JsonOption
from tautwire.cli.session import answering


def register(app: typer.Typer) -> None:
    """Add the commands to the command line.

    Parameters
    ----------
    app
    """
    app.command()(spans)


def spans(
    table_file: Annotated[
        Path, typer.Argument(metavar="TABLE", help="What is asked for, a YAML file.")
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", "-o", metavar="FILE", help="CSV file, or a page (.html).", show_default=False
        ),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Tabulate the longest span over radius and wind, from the lateral position of the wire."""
    with answering(as_json) as answer:
        from tautwire.cli.commands.inputs.spans import show_spans

        show_spans(answer, table_file, out)
