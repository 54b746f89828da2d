"""``reproduce song2021``: the high-frequency programme of the paper, repeated and judged."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from tautwire.cli.about import program
from tautwire.cli.commands.study import MOST_WORKERS, StudyWatch
from tautwire.cli.folders import Files, prepared_folder, tell_files
from tautwire.cli.interrupts import Interrupts
from tautwire.cli.session import FAILED, Answer
from tautwire.cli.views.tables import heading, table
from tautwire.errors import InputError
from tautwire.reproductions.song2021.pages import page_identification
from tautwire.reproductions.song2021.pages.output import writers
from tautwire.reproductions.song2021.passages import FULL, QUICK
from tautwire.reproductions.song2021.reproduction import (
    STUDY,
    Identification,
    SongRecord,
    identify_readings,
    reproduce,
)
from tautwire.reproductions.song2021.sections.identification import GROUPS
from tautwire.studies.execution.executor import StudyError

Result = TypeVar("Result", SongRecord, Identification)

MOST_READINGS = 15
"""Readings of an identification that are shown."""


def reproduce_song(
    answer: Answer, out: Path | None, workers: int | None, *, quick: bool, identify: bool = False
) -> None:
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
    identify
        Whether readings are compared instead of claims judged.
    """
    if workers is not None and not 1 <= workers <= MOST_WORKERS:
        raise InputError(f"--workers: got {workers}; give 1 to {MOST_WORKERS}")
    if quick and identify:
        raise InputError("--quick and --identify: give one of them")
    if identify:
        _run(answer, out, partial(identify_readings, workers=workers), _identification_view,
             page_identification.writers)  # fmt: skip
    else:
        scope = QUICK if quick else FULL
        _run(answer, out, partial(reproduce, scope=scope, workers=workers), _view, writers)


def _run(
    answer: Answer,
    out: Path | None,
    compute: Callable[..., Result],
    view: Callable[[Result], list[Any]],
    files: Callable[[Result], Mapping[str, Callable[[Path], object]]],
) -> None:
    """Compute in a folder, show the result and write its files."""
    wanted, interrupts = out or Path(f"tautwire-reproduce-{STUDY}"), Interrupts()
    with prepared_folder(wanted) as folder, interrupts.handled():
        answer.say(program())
        try:
            with StudyWatch(answer, interrupts) as watch, interrupts.patient():
                found = compute(folder, watch=watch)
        except StudyError as error:
            answer.fail("study", [str(error)], FAILED)
            return
        with interrupts.patient():
            answer.document.update(found.as_dict())
            answer.show(*view(found))
            _write(answer, Files(folder), files(found))
    if interrupts.requested is not None:
        answer.exit_code = interrupts.exit_code


def _identification_view(found: Identification) -> list[Any]:
    best = page_identification.best_by_line(found.trials)[:MOST_READINGS]
    rows = [
        (f"{one.line}, {one.stiffness} kN/m",
         *(f"{met}/{of}" if of else "–" for met, of in one.met.values()), str(one.total))
        for one in best
    ]  # fmt: skip
    heads = ("reading", *GROUPS, "met")
    parts: list[Any] = [
        heading("Readings that meet most numbers of the paper"),
        table(heads, "L" + "r" * (len(heads) - 1), rows),
    ]
    return [*parts, *_missing(found.missing)]


def _missing(missing: Mapping[str, str]) -> list[Any]:
    if not missing:
        return []
    return [heading("Not computed"), "\n".join(f"{n}: {reason}" for n, reason in missing.items())]


def _view(record: SongRecord) -> list[Any]:
    rows = [(claim.section, claim.verdict, claim.statement) for claim in record.claims]
    parts: list[Any] = [
        heading(record.title, "validation record"),
        record.statement,
        heading("Claims"),
        table(("section", "verdict", ""), "LLL", rows),
    ]
    return [*parts, *_missing(record.missing)]


def _write(answer: Answer, files: Files, wanted: Mapping[str, Callable[[Path], object]]) -> None:
    for name, write in wanted.items():
        files.write(name, write)
    tell_files(answer, files)
