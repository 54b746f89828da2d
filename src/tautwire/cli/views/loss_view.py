"""Losses of contact on the terminal."""

from __future__ import annotations

from typing import Any

from tautwire.cli.views.tables import facts, heading, table
from tautwire.report.parts.words import number, quantity
from tautwire.results.statistics import ARC_NOTE, ContactLoss


def loss_view(loss: ContactLoss, most: int | None = None) -> list[Any]:
    """Return the losses of one pantograph as a table, the longest ones where there are more.

    Parameters
    ----------
    loss : ContactLoss
    most : int, optional
        Losses that are listed at most.
    """
    events = loss.events
    if most is not None and len(events) > most:
        events = tuple(sorted(events, key=lambda event: -event.duration)[:most])
    rows = [
        (
            number(event.start, 4),
            number(1e3 * event.duration, 2),
            number(event.position, 2),
            event.place,
        )
        for event in sorted(events, key=lambda event: event.start)
    ]
    which = loss.pantograph if len(events) == loss.count else f"the {len(events)} longest"
    classes = [
        (f"from {1e3 * part.low:g} ms", str(part.count)) for part in loss.classes() if part.count
    ]
    return [
        heading("Losses of contact", which),
        table(("start [s]", "duration [ms]", "position [m]", "nearest"), "rrrl", rows),
        facts(
            [
                ("losses", str(loss.count)),
                ("share of time", quantity(loss.percent, "%", 3)),
                ("5 ms or longer", str(loss.count_over())),
                *classes,
                ("note", ARC_NOTE),
            ]
        ),
    ]
