"""How the columns of tables or a recording were understood, shown and kept."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from tautwire.cli.session import Answer
from tautwire.cli.views.tables import facts, heading
from tautwire.errors import InputError
from tautwire.files import write_text
from tautwire.inputs.book.workbook import Workbook, case_of, is_workbook, open_workbook
from tautwire.inputs.composition import compose
from tautwire.inputs.reading.recording import RecordingFile
from tautwire.measured.channels import Channel
from tautwire.tables.mapping import SheetMapping, Use


def announce_tables(answer: Answer, reference: str) -> None:
    """Show how tables of a line are read, and write the mapping of a workbook if proposed."""
    if not is_workbook(reference):
        _show(answer, compose(reference).sheets)
        return
    workbook = open_workbook(Path(reference))
    _, tables = case_of(workbook)
    _show(answer, workbook.mappings)
    for note in (*workbook.notes, *tables.notes):
        answer.say(note)
    if workbook.unread:
        answer.say(f"sheets that are no tables of a line: {', '.join(workbook.unread)}")
    _keep(answer, workbook)


def _show(answer: Answer, mappings: Sequence[SheetMapping]) -> None:
    if not mappings:
        return
    answer.document["mapping"] = {
        one.sheet.name: {"table": one.kind, "columns": {u.heading: u.field.name for u in one.uses}}
        for one in mappings
    }
    for one in mappings:
        rows = [(use.heading, _meaning(use, use.unit)) for use in one.uses]
        rows += [(name, "kept aside") for name in one.aside]
        answer.show(heading(f"{one.sheet.name}", f"read as {one.kind}"), facts(rows))


def _keep(answer: Answer, workbook: Workbook) -> None:
    if workbook.is_proposed:
        write_text(workbook.mapping_file, workbook.mapping_text())
        answer.say(f"mapping written: {workbook.mapping_file}; change it if a column is misread")
    else:
        answer.say(f"columns read as {workbook.mapping_file} says")


def announce_recording(answer: Answer, opened: RecordingFile) -> None:
    """Show how the columns of a recording are read, and keep the mapping where it was proposed."""
    channels = [*opened.channels, *(one for rate in opened.others for one in rate.channels)]
    answer.document["mapping"] = {
        one.use.heading: {
            "field": one.use.field.name, "unit": unit_of(one), "strip": one.use.strip,
            "sensor": one.use.sensor,
        }
        for one in channels
    }  # fmt: skip
    rows = [(one.use.heading, _meaning(one.use, unit_of(one))) for one in channels]
    rows += [(name, "kept aside") for name in opened.mapping.aside]
    answer.show(heading("Columns"), facts(rows))
    if not opened.is_proposed:
        answer.say(f"columns read as {opened.mapping_file} says")
        return
    try:
        write_text(opened.mapping_file, opened.mapping_text())
    except InputError as error:
        answer.say(f"the mapping is not kept: {error}")
    else:
        answer.say(
            f"mapping written: {opened.mapping_file}; change it if a column is misread. Files of "
            "this folder with the same columns are read by it too"
        )


def unit_of(channel: Channel) -> str:
    """Return the unit of a channel: as its heading says, as decided, or SI."""
    return channel.use.unit or channel.unit or channel.use.field.unit


def _meaning(use: Use, unit: str) -> str:
    told = (("strip", use.strip), ("sensor", use.sensor), ("of dropper", use.dropper))
    numbers = [f"{what} {number}" for what, number in told if number]
    words = " ".join([use.field.name.replace("_", " "), *numbers])
    return f"{words} [{unit}]" if unit else words
