"""The identification: readings against the numbers of the paper, as page and CSV."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from tautwire.files import write_text
from tautwire.report.parts.blocks import Section, Table, Text
from tautwire.report.parts.words import number
from tautwire.report.writers.html import render
from tautwire.reproductions.song2021 import published
from tautwire.reproductions.song2021.reproduction import Identification
from tautwire.reproductions.song2021.sections.identification import (
    ALONE,
    GROUPS,
    LIBRARY,
    Trial,
    levels,
)
from tautwire.text import csv_text
from tautwire.version import __version__

ALONE_READING = "sharp, spans 4 to 13"
"""Filter and window of the table of single departures."""

SHOWN = 25
"""Readings in the first table; the CSV file has all."""

WORDS = (
    "Every reading is a line (steady arms, fixing of the messenger wire), a contact stiffness, a "
    "filter and a window. It is judged by how many numbers of the text it meets: the six "
    "elasticities of Table 1 within 3 % (100 or 200 N, whichever meets more), the seven numbers "
    "of Table 2 (standard deviations within 2 %, Fm 0.5 %, Fmax 3 %, Fmin 5 %), the three changes "
    "of section III.B within 3 percentage points (on NAD 15), the three lines of NAD 9, no loss of "
    "contact on the ideal line. For the best of them and the named ones also the eight lines of "
    "section III.A on four meshes and the cut-off of section IV.C at five speeds, which do not "
    "count in the order. No reading is preferred because one number fits."
)


def writers(found: Identification) -> dict[str, Callable[[Path], object]]:
    """Return the files of an identification by name: how each is written to a path."""
    return {
        "identification.html": lambda path: write_text(path, _page(found)),
        "identification.csv": lambda path: write_text(path, table_csv(found.trials)),
    }


def _page(found: Identification) -> str:
    section = Section(
        "identification",
        "What did the authors compute?",
        (Text(WORDS), best_table(found.trials), levels_table(found.trials),
         alone_table(found.trials)),
    )  # fmt: skip
    masthead = {
        "title": "Song, Rønnquist, Nåvik (2021): readings against claims",
        "description": published.TITLE,
        "facts": {
            "Passages": f"{found.cost['passages']:g}",
            "Processor time": f"{found.cost['cpu_s'] / 60.0:.1f} min",
            "Missing": str(len(found.missing)),
        },
        "version": __version__,
        "case_hash": "ac-simple",
    }
    return render([section], masthead)


HEAD = ("line", "contact stiffness [kN/m]", "filter and window", *GROUPS, "met",
        *(published.NAMES[name] for name in published.QUANTITIES))  # fmt: skip


def _row(one: Trial) -> tuple[str, ...]:
    return (
        one.line,
        str(one.stiffness),
        one.reading,
        *(f"{met}/{of}" if of else "" for met, of in one.met.values()),
        str(one.total),
        *(number(one.numbers[name], 2) for name in published.QUANTITIES),
    )


def best_by_line(trials: Sequence[Trial]) -> list[Trial]:
    """Return every line and contact stiffness with the filter and window that meet most."""
    best: dict[tuple[str, int], Trial] = {}
    for one in trials:
        best.setdefault((one.line, one.stiffness), one)
    return list(best.values())


def best_table(trials: Sequence[Trial]) -> Table:
    """Return the best window and filter of the readings that meet most numbers."""
    paper = ("the paper", "", "", *("",) * len(GROUPS), "", *(f"{v:g}" for v in
             published.PAPER.values()))  # fmt: skip
    return Table(
        "Readings that meet most numbers of the text, each with the filter and window that meet "
        "most; on the right Table 2 [N].",
        HEAD,
        "lrl" + "r" * (len(HEAD) - 3),
        (paper, *(_row(one) for one in best_by_line(trials)[:SHOWN])),
    )


def levels_table(trials: Sequence[Trial]) -> Table:
    """Return what fixing one choice costs: the best that can still be met with it."""
    return Table(
        "The price of each choice: the most numbers that any reading of the grid meets with it.",
        ("varied", "value", "most met", "by"),
        "llrl",
        tuple(
            (factor, level, str(best.total), f"{best.line}, {best.stiffness} kN/m, {best.reading}")
            for factor, level, best in levels(trials)
        ),
    )


def alone_table(trials: Sequence[Trial]) -> Table:
    """Return the library case and single departures from it, read alike."""
    wanted = [LIBRARY, *ALONE]
    found = {t.line: t for t in trials if t.stiffness == 50 and t.reading == ALONE_READING}
    return Table(
        "The library case at 50 kN/m, and single departures from it; sharp filter, spans 4 to 13.",
        HEAD,
        "lrl" + "r" * (len(HEAD) - 3),
        tuple(_row(found[line]) for line in wanted if line in found),
    )


def table_csv(trials: Sequence[Trial]) -> str:
    """Return all readings as CSV."""
    return csv_text(HEAD, [_row(one) for one in trials])
