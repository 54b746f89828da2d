"""How the columns of a workbook were understood, shown and kept."""

from __future__ import annotations

from tautwire.cli.session import Answer
from tautwire.cli.views.tables import facts, heading
from tautwire.files import write_text
from tautwire.inputs.workbook import Workbook, case_of, is_workbook, open_workbook


def announce_workbook(answer: Answer, reference: str) -> None:
    """Show how a workbook is read and write the mapping where it was proposed; else do nothing."""
    from pathlib import Path

    if not is_workbook(reference):
        return
    workbook = open_workbook(Path(reference))
    _, tables = case_of(workbook)
    answer.document["mapping"] = {
        one.sheet.name: {"table": one.kind, "columns": {u.heading: u.field.name for u in one.uses}}
        for one in workbook.mappings
    }
    for one in workbook.mappings:
        rows = [(use.heading, _meaning(use.field.name, use.unit)) for use in one.uses]
        rows += [(name, "kept aside") for name in one.aside]
        answer.show(heading(f"{one.sheet.name}", f"read as {one.kind}"), facts(rows))
    for note in tables.notes:
        answer.say(note)
    if workbook.unread:
        answer.say(f"sheets that are no tables of a line: {', '.join(workbook.unread)}")
    _keep(answer, workbook)


def _keep(answer: Answer, workbook: Workbook) -> None:
    if workbook.is_proposed:
        write_text(workbook.mapping_file, workbook.mapping_text())
        answer.say(f"mapping written: {workbook.mapping_file}; change it if a column is misread")
    else:
        answer.say(f"columns read as {workbook.mapping_file} says")


def _meaning(field: str, unit: str) -> str:
    return f"{field.replace('_', ' ')} [{unit}]" if unit else field.replace("_", " ")
