"""Losses of contact on the terminal."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from tautwire.cli.views.tables import facts, heading, table
from tautwire.report.parts.words import MISSING, number, quantity
from tautwire.results.statistics import ARC_NOTE, LOSS_BAND, ContactLoss
from tautwire.text import MARK, marked


def loss_cells(losses: Sequence[ContactLoss], told: Callable[[ContactLoss], str]) -> list[str]:
    """Return a figure of every pantograph, a dash where it never was in the section.

    Parameters
    ----------
    losses
    told
        Returns the figure of one of them.
    """
    return [
        marked(told(loss), is_carried=loss.is_carried) if loss.observed > 0.0 else MISSING
        for loss in losses
    ]


def loss_view(loss: ContactLoss, most: int | None = None) -> list[Any]:
    """Return the losses of one pantograph as a table, the longest ones where there are more.

    Parameters
    ----------
    loss : ContactLoss
    most : int, optional
        Losses that are listed at most.
    """
    if not loss.observed:
        return [heading("Losses of contact", f"{loss.pantograph} was never in the section")]
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
    mark = "" if loss.is_carried else f" {MARK}"
    which = loss.pantograph if len(events) == loss.count else f"the {len(events)} longest"
    classes = [
        (f"from {1e3 * part.low:g} ms", str(part.count)) for part in loss.classes() if part.count
    ]
    return [
        heading("Losses of contact", which + mark),
        table(("start [s]", "duration [ms]", "position [m]", "nearest"), "rrrl", rows),
        facts(
            [
                ("losses", str(loss.count) + mark),
                ("share of time", quantity(loss.percent, "%", 3) + mark),
                ("5 ms or longer", str(loss.count_over()) + mark),
                *classes,
                ("note", ARC_NOTE),
                *([] if loss.is_carried else [(MARK, not_carried(loss))]),
            ]
        ),
    ]


def not_carried(loss: ContactLoss) -> str:
    """Say what the mark beside losses means."""
    return (
        f"mesh and time step carry {loss.carried:.0f} Hz, losses need {LOSS_BAND:g} Hz "
        "(settings.band)"
    )
