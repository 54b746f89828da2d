"""``reproduce``: a published study repeated, with a verdict on each of its claims."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from tautwire.cli.about import program
from tautwire.cli.folders import Files, prepared_folder, tell_files
from tautwire.cli.interrupts import Interrupts
from tautwire.cli.progress import PassageWatch
from tautwire.cli.session import Answer
from tautwire.cli.views.tables import facts, heading, table
from tautwire.errors import InputError
from tautwire.inputs.reading.files import did_you_mean
from tautwire.reproductions import en50318_2002
from tautwire.reproductions.record import Record, found_text, range_text, writers

STUDIES = {en50318_2002.STUDY: en50318_2002.reproduce}
SONG = "song2021"
"""A study with a command of its own, see :mod:`tautwire.cli.commands.song`."""


def reproduce_study(answer: Answer, study: str, out: Path | None) -> None:
    """Repeat a study, show its record and write its files."""
    if study not in STUDIES:
        names = [*STUDIES, SONG]
        hint = did_you_mean(study, names) or f"; there are: {', '.join(names)}"
        raise InputError(f"STUDY {study!r}: there is no such study{hint}")
    wanted, interrupts = out or Path(f"tautwire-reproduce-{study}"), Interrupts()
    with prepared_folder(wanted) as folder, interrupts.handled():
        answer.say(program())
        with PassageWatch(answer, interrupts) as watch, interrupts.patient():
            record = STUDIES[study](watch)
        with interrupts.patient():
            answer.document.update(record.as_dict())
            answer.show(*_record_view(record))
            _write(answer, Files(folder), record)
    if interrupts.requested is not None:
        answer.exit_code = interrupts.exit_code


def _write(answer: Answer, files: Files, record: Record) -> None:
    for name, write in writers(record).items():
        files.write(name, write)
    tell_files(answer, files)


def _record_view(record: Record) -> list[Any]:
    parts: list[Any] = [heading(record.title, "validation record"), record.statement]
    kinds = list(record.filters)
    for run in record.runs:
        rows = [
            (
                claim.name,
                range_text(claim),
                *(found_text(claim, kind) for kind in kinds),
                claim.verdict,
            )
            for claim in record.claims
            if claim.run == run
        ]
        heads = ("", "published", *kinds, "verdict")
        parts += [heading(run), table(heads, "Lr" + "r" * len(kinds) + "L", rows)]
        parts += [
            f"{claim.verdict}: {claim.name}; {claim.explanation}."
            for claim in record.claims
            if claim.run == run and claim.explanation
        ]
    inputs = ", ".join(source.path for source in record.doubtful_inputs)
    parts += [
        heading("Filters"),
        facts([("published", record.published_filter), *record.filters.items()]),
        heading("Inputs that rest on memory"),
        inputs or "none",
    ]
    return parts
