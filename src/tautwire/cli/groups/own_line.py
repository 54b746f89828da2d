"""Commands for somebody's own line: what it can be made of."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from tautwire.cli.idle import refuse_idle
from tautwire.cli.options import JsonOption, LimitsOption
from tautwire.cli.session import answering


def register(app: typer.Typer) -> None:
    """Add the commands to the program."""
    app.command()(catalogue)
    app.command()(new)
    app.command()(limits)


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
        from tautwire.cli.commands.inputs.catalogue import copy_entry, show_catalogue

        words = " ".join(name or [])
        refuse_idle("--copy FILE: it replaces that file", {"--force": force and copy is None})
        if copy is not None:
            idle = {"--kind": kind}
            refuse_idle("a list to choose from; --copy takes the entry by its whole name", idle)
            copy_entry(answer, words, copy, own, force=force)
        else:
            show_catalogue(answer, words, kind, own)


def _option(flag: str, metavar: str, text: str) -> typer.models.OptionInfo:
    return typer.Option(f"--{flag}", metavar=metavar, help=text, show_default=False)


def new(
    file: Annotated[Path, typer.Argument(metavar="FILE.yaml", help="Case file to write.")],
    system: Annotated[str | None, _option("system", "SYSTEM", "ac, dc-1.5kv or dc-3kv.")] = None,
    speed: Annotated[str | None, _option("speed", "SPEED", 'As in "160 km/h".')] = None,
    span: Annotated[str | None, _option("span", "LENGTH", 'As in "60 m".')] = None,
    spans: Annotated[str | None, _option("spans", "N", "Number of spans.")] = None,
    contact: Annotated[str | None, _option("contact", "NAME", "Contact wire.")] = None,
    contact_tension: Annotated[
        str | None, _option("contact-tension", "FORCE", "Its tension.")
    ] = None,
    messenger: Annotated[str | None, _option("messenger", "NAME", "Messenger wire.")] = None,
    messenger_tension: Annotated[
        str | None, _option("messenger-tension", "FORCE", "Its tension.")
    ] = None,
    ends: Annotated[str | None, _option("ends", "KIND", "mid-point, weighted or anchored.")] = None,
    band: Annotated[
        str | None, _option("band", "FREQ", "Highest frequency of mesh and step.")
    ] = None,
    arm_share: Annotated[
        str | None,
        _option("arm-share", "SHARE", "Share of the wire that arms carry, 0 to 0.5."),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
    as_json: JsonOption = False,
) -> None:  # fmt: skip
    """Write a case for your own line to begin with, and say why each value was chosen.

    What is not said is asked for on a terminal, else chosen by the program.
    """
    with answering(as_json) as answer:
        from tautwire.cli.commands.inputs.new import Answers, write_new

        answers = Answers(
            system, speed, span, spans, contact, contact_tension, messenger, messenger_tension,
            ends, band, arm_share,
        )  # fmt: skip
        write_new(answer, file, answers, force=force)


def limits(
    file: LimitsOption = None,
    copy: Annotated[
        Path | None,
        typer.Option("--copy", metavar="FILE", help="Write them as a file of your own.",
                     show_default=False),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Let --copy replace a file.")] = False,
    as_json: JsonOption = False,
) -> None:  # fmt: skip
    """List the limits that a passage is checked against, or copy them to a file of your own."""
    with answering(as_json) as answer:
        from tautwire.cli.commands.inputs.limits import copy_limits, show_limits

        refuse_idle("--copy FILE: it replaces that file", {"--force": force and copy is None})
        if copy is not None:
            idle = {"--limits": file}
            refuse_idle("no --copy, which writes the limits of the program", idle)
            copy_limits(answer, copy, force=force)
        else:
            show_limits(answer, file)
