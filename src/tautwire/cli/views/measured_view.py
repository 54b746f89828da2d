"""What a recording says, for the terminal."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from tautwire.cli.views.tables import facts, heading, table
from tautwire.measured.evaluation import Evaluation
from tautwire.report.parts.recordings.measured import (
    COUNTED,
    EVENTS,
    event_rows,
    figure_rows,
    range_rows,
    step_rows,
    stretch_rows,
)
from tautwire.report.parts.words import number

MOST_ROWS = 20
"""Rows of a table on the terminal; the files hold all."""


def evaluation_view(found: Evaluation) -> list[Any]:
    """Return the parts to show."""
    parts: list[Any] = [
        heading("Recording", found.label),
        facts(
            [
                ("samples", f"{found.samples}, one every {_interval(found.interval)}"),
                ("way", f"{number(found.length)} m, towards {found.direction} chainage"),
                ("holds", f"the force up to {number(found.highest_frequency)} Hz"),
            ]
        ),
    ]
    if found.notes:
        parts += [heading("Understood"), "\n".join(f"- {note}" for note in found.notes)]
    parts.append(heading("Faults"))
    rows = [(fault["kind"], f"{fault['channel']}: {fault['text']}") for fault in found.faults]
    parts.append(table(("", ""), "lL", rows) if rows else "none found")
    if found.steps:
        parts += [heading("Processing"), table(("step", "with"), "lL", step_rows(found))]
    if found.force is not None:
        parts += [
            heading("Contact force"),
            table(("", "", ""), "Lrl", figure_rows(found.force, found.highest_frequency)),
            heading("Stretches"),
            table(*COUNTED, _few(stretch_rows(found))),
        ]
    if found.events or found.force is not None:
        rows = _few(event_rows(found))
        parts += [heading("Events", f"{len(found.events)}"), table(EVENTS, "lrrr", rows)]
    if found.ranges:
        heads = ("channel", "least", "mean", "largest", "missing")
        parts += [heading("Other channels"), table(heads, "Lrrrr", range_rows(found))]
    return parts


def _interval(seconds: float) -> str:
    return f"{1e3 * seconds:.4g} ms" if math.isfinite(seconds) else "unknown time"


def _few(rows: Iterable[tuple[str, ...]]) -> list[tuple[str, ...]]:
    every = list(rows)
    if len(every) <= MOST_ROWS:
        return every
    rest = (f"... {len(every) - MOST_ROWS} more", *("" for _ in every[0][1:]))
    return [*every[:MOST_ROWS], rest]
