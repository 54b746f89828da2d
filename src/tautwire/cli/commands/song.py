"""``reproduce song2021``: the high-frequency programme of the paper, repeated and judged."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from tautwire.cli.about import program
from tautwire.cli.commands.study import MOST_WORKERS, StudyWatch
from tautwire.cli.folders import Files, prepared_folder
from tautwire.cli.interrupts import Interrupts
from tautwire.cli.session import FAILED, Answer, OutputError
from tautwire.cli.views.tables import files_written, heading, table
from tautwire.errors import InputError
from tautwire.reproductions.song2021.pages.output import writers
from tautwire.reproductions.song2021.passages import FULL, QUICK
from tautwire.reproductions.song2021.reproduction import STUDY, SongRecord, reproduce
from tautwire.studies.execution.executor import StudyError


def reproduce_song(answer: Answer, out: Path | None, workers: int | None, *, quick: bool) -> None:
    """Run what is missing, show the verdicts and write the files.

    Parameters
    ----------
    answer
    out
        Folder; what is finished there is kept.
    workers
        Number of processes.
    quick
        Whether fewer readings are computed.
    """
    if workers is not None and not 1 <= workers <= MOST_WORKERS:
        raise InputError(f"--workers: got {workers}; give 1 to {MOST_WORKERS}")
    wanted, interrupts = out or Path(f"tautwire-reproduce-{STUDY}"), Interrupts()
    with prepared_folder(wanted) as folder, interrupts.handled():
        answer.say(program())
        scope = QUICK if quick else FULL
        try:
            with StudyWatch(answer, interrupts) as watch, interrupts.patient():
                record = reproduce(folder, scope, workers=workers, watch=watch)
        except StudyError as error:
            answer.fail("study", [str(error)], FAILED)
            return
        with interrupts.patient():
            answer.document.update(record.as_dict())
            answer.show(*_view(record))
            _write(answer, Files(folder), record)
    if interrupts.requested is not None:
        answer.exit_code = interrupts.exit_code


def _view(record: SongRecord) -> list[Any]:
    rows = [(claim.section, claim.verdict, claim.statement) for claim in record.claims]
    parts: list[Any] = [
        heading(record.title, "validation record"),
        record.statement,
        heading("Claims"),
        table(("section", "verdict", ""), "LLL", rows),
    ]
    if record.missing:
        missing = [f"{name}: {reason}" for name, reason in record.missing.items()]
        parts += [heading("Not computed"), "\n".join(missing)]
    return parts


def _write(answer: Answer, files: Files, record: SongRecord) -> None:
    for name, write in writers(record).items():
        files.write(name, write)
    answer.document["files"] = files.written
    answer.show(heading("Files"), files_written(files.written))
    if files.problems:
        raise OutputError(files.problems)
