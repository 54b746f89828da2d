"""Commands for somebody's own line: what it can be made of."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from tautwire.cli.options import JsonOption
from tautwire.cli.session import answering


def register(app: typer.Typer) -> None:
    """Add the commands to the program."""
    app.command()(catalogue)


def catalogue(
    name: Annotated[
        list[str] | None,
        typer.Argument(metavar="[NAME]", help="Name, or words to look for.", show_default=False),
    ] = None,
    kind: Annotated[
        str | None,
        typer.Option("--kind", metavar="KIND", help='As in "contact wire" or "rope".',
                     show_default=False),
    ] = None,
    own: Annotated[
        Path | None,
        typer.Option("--file", metavar="FILE", help="Own catalogue file to look in first.",
                     show_default=False),
    ] = None,
    copy: Annotated[
        Path | None,
        typer.Option("--copy", metavar="FILE", help="Write the entry as an own catalogue file.",
                     show_default=False),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Let --copy replace an existing file.")
    ] = False,
    as_json: JsonOption = False,
) -> None:  # fmt: skip
    """List, search and show wires, ropes, droppers, clamps, arms and pantographs with sources."""
    with answering(as_json) as answer:
        from tautwire.cli.commands.catalogue import copy_entry, show_catalogue

        words = " ".join(name or [])
        if copy is not None:
            copy_entry(answer, words, copy, own, force=force)
        else:
            show_catalogue(answer, words, kind, own)
