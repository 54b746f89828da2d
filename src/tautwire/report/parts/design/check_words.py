"""Checks of the design as words, for tables of every kind."""

from __future__ import annotations

import math
from collections.abc import Sequence

from tautwire.assessment.design.checks import DesignCheck
from tautwire.text import csv_text

HEAD = ("check", "this line", "estimate", "limit", "")

_SCALES = {"m": (1.0, 3, " m"), "m/s": (3.6, 0, " km/h"), "m/N": (1e3, 3, " mm/N")}
"""Factor, digits and unit in which a quantity is told; shares stand as they are."""


def check_rows(checks: Sequence[DesignCheck]) -> list[tuple[str, ...]]:
    """Return one row per check: what and where, value, estimate, limit, verdict."""
    return [
        (
            f"{one.name}, {one.place}" if one.place else one.name,
            _number(one.value, one),
            _number(one.estimate, one),
            _limit(one),
            {None: "", True: "within", False: "not within"}[one.within],
        )
        for one in checks
    ]


def _number(value: float, one: DesignCheck) -> str:
    if math.isnan(value):
        return ""
    if one.unit == "1":
        return f"{1e3 * value:.2f} mm/m" if _is_slope(one) else f"{value:.3f}"
    factor, digits, unit = _SCALES[one.unit]
    return f"{factor * value:.{digits}f}{unit}"


def _is_slope(one: DesignCheck) -> bool:
    return one.quantity in ("gradient", "gradient_change", "sweep")


def _limit(one: DesignCheck) -> str:
    if math.isnan(one.limit):
        return ""
    return f"{'≤' if one.sense == 'maximum' else '≥'} {_number(one.limit, one)}"


def source_rows(checks: Sequence[DesignCheck]) -> list[tuple[str, str]]:
    """Return name and source of every limit."""
    return [(one.name, one.source) for one in checks if one.source]


def checks_csv(checks: Sequence[DesignCheck]) -> str:
    """Return the checks as CSV, in SI units."""
    head = ("check", "place", "this line", "estimate", "unit", "formula of the estimate", "limit",
            "sense", "inside", "source of the limit")  # fmt: skip
    rows = (
        (
            one.name,
            one.place,
            _cell(one.value),
            _cell(one.estimate),
            one.unit,
            one.formula,
            _cell(one.limit),
            one.sense,
            {None: "", True: "yes", False: "no"}[one.within],
            one.source,
        )
        for one in checks
    )
    return csv_text(head, rows)


def _cell(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.6g}"
