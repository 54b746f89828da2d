"""The figures of conditions as words, for the terminal, tables and the page."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from tautwire.results.design.conditions import ConditionState, Extreme
from tautwire.text import csv_text

SAME_TENSION = 1e-3
"""Share of a tension below which a change is not told: what a tensioning device is off anyway."""

Row = tuple[str, Callable[[ConditionState], str]]


def _number(
    pick: Callable[[ConditionState], tuple[float, ...]], at: int, scale: float, digits: int
) -> Callable[[ConditionState], str]:
    def tell(state: ConditionState) -> str:
        values = pick(state)
        return f"{scale * values[at]:.{digits}f}" if values else ""

    return tell


def _extreme(one: Extreme | None) -> str:
    return "" if one is None else f"{1e3 * one.value:.0f} (span {one.span})"


def _percent(value: float) -> str:
    return "" if math.isnan(value) else f"{100 * value:.1f}"


ROWS: tuple[Row, ...] = (
    ("lowest [m]", _number(lambda s: s.heights, 0, 1.0, 4)),
    ("highest [m]", _number(lambda s: s.heights, 1, 1.0, 4)),
    ("farthest left [mm]", lambda s: _extreme(s.left)),
    ("farthest right [mm]", lambda s: _extreme(s.right)),
    ("dropper force, least [N]", _number(lambda s: s.dropper_forces, 0, 1.0, 1)),
    ("dropper force, most [N]", _number(lambda s: s.dropper_forces, 1, 1.0, 1)),
    ("slack droppers", lambda s: str(len(s.slack))),
    ("arm pull, least [N]", _number(lambda s: s.arm_forces, 0, 1.0, 0)),
    ("arm pull, most [N]", _number(lambda s: s.arm_forces, 1, 1.0, 0)),
    ("elasticity, least [mm/N]", _number(lambda s: s.elasticity_range, 0, 1e3, 3)),
    ("elasticity, most [mm/N]", _number(lambda s: s.elasticity_range, 1, 1e3, 3)),
    ("non-uniformity [%]", lambda s: _percent(s.nonuniformity)),
)
"""What is compared of the contact wire, its droppers and arms, and how it is told."""


def condition_rows(states: Sequence[ConditionState]) -> list[tuple[str, ...]]:
    """Return one row per figure with one column per state."""
    return [(name, *(tell(one) for one in states)) for name, tell in ROWS]


def end_rows(states: Sequence[ConditionState]) -> list[tuple[str, ...]]:
    """Return one row per end of a wire that moves or pulls otherwise than in the design.

    Wire, side, condition, tension [N], travel [mm] with that of weights, state.
    """
    usual = {(end.wire, end.side): end.tension for one in states[:1] for end in one.ends}
    rows = []
    for one in states[1:]:
        for end in one.ends:
            before = usual[end.wire, end.side]
            if not end.travel and abs(end.tension - before) < SAME_TENSION * before:
                continue
            sunk = "" if math.isnan(end.sinking) else f" (weights {1e3 * end.sinking:+.0f})"
            travel = f"{1e3 * end.travel:+.1f}{sunk}"
            rows.append((end.wire, end.side, one.name, f"{end.tension:.0f}", travel, end.state))
    return sorted(rows, key=lambda row: row[:2])


def conditions_csv(states: Sequence[ConditionState]) -> str:
    """Return the figures of all states as CSV, one row per state and one column per figure."""
    head = (
        "condition", "what differs", "lowest [m]", "highest [m]", "farthest left [m]",
        "span of it", "farthest right [m]", "span of it ", "smallest dropper force [N]",
        "largest dropper force [N]", "slack droppers", "smallest arm pull [N]",
        "largest arm pull [N]", "smallest elasticity [mm/N]", "largest elasticity [mm/N]",
        "no such state",
    )  # fmt: skip
    return csv_text(head, (_csv_row(one) for one in states))


def _csv_row(one: ConditionState) -> tuple[str, ...]:
    def two(values: tuple[float, ...], digits: int, scale: float = 1.0) -> tuple[str, str]:
        low, high = (f"{scale * v:.{digits}f}" for v in values) if values else ("", "")
        return low, high

    def far(place: Extreme | None) -> tuple[str, str]:
        return ("", "") if place is None else (f"{place.value:.6f}", str(place.span))

    return (
        one.name,
        "; ".join(one.told),
        *two(one.heights, 6),
        *far(one.left),
        *far(one.right),
        *two(one.dropper_forces, 3),
        "; ".join(one.slack),
        *two(one.arm_forces, 3),
        *two(one.elasticity_range, 6, 1e3),
        " ".join(one.fault.split()),
    )
