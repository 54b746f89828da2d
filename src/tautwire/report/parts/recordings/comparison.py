"""Rows about a run beside a measurement, for the terminal and the page alike."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

from tautwire.assessment.comparison.coverage import Coverage
from tautwire.assessment.comparison.measurement import MeasurementComparison, MeasurementRow
from tautwire.assessment.comparison.points import PointComparison
from tautwire.assessment.comparison.stretches import LengthFigures, SpanFigures
from tautwire.report.parts.words import (
    MISSING,
    counted,
    listing,
    number,
    quantity,
    readable,
    speed,
)

_NAMES = {
    "mean": "mean",
    "standard_deviation": "σ 0–20 Hz",
    "maximum": "maximum",
    "minimum": "minimum",
    "uplift": "uplift",
    "contact_height_range": "height range",
    "elasticity": "elasticity",
}
UNCHECKED = "tolerance not checked"
"""Said beside a tolerance that nobody compared with the text of its standard."""
HEADS = ("", "simulated", "measured", "difference", "allowed", "verdict")
"""Heading of the table of numbers."""
POINT_HEADS = ("", "at", *HEADS[1:])
"""Heading of the table of places."""


def name_of(quantity: str) -> str:
    """Return a compared quantity as it is read; bands are in Hz."""
    if quantity.startswith("std_"):
        return f"σ {quantity[4:].replace('_', '–')} Hz"
    return _NAMES.get(quantity, quantity)


def number_row(row: MeasurementRow) -> tuple[str, ...]:
    """Return a row of the table of numbers, without its verdict."""
    return (
        name_of(row.quantity),
        readable(row.simulated, row.unit),
        readable(row.measured, row.unit),
        _difference(row),
        _tolerance(row),
    )


def verdict_of(row: MeasurementRow) -> str:
    """Return ``"met"`` or ``"missed"``, or why neither can be said."""
    if row.within is None:
        return "not judged" if row.note.startswith("not judged") else ""
    if row.passed is None:  # the tolerance was not compared with the standard's text
        return f"{'met' if row.within else 'missed'}, {UNCHECKED}"
    return "met" if row.within else "missed"


def source_rows(rows: Iterable[MeasurementRow]) -> list[tuple[str, ...]]:
    """Return where each tolerance comes from."""
    every = [
        (
            name_of(row.quantity),
            f"{row.standard} {row.edition or ''}".strip(),
            row.clause or "not known",
            "verified" if row.verified else "not verified",
            row.note,
        )
        for row in rows
        if row.standard is not None
    ]
    return list(dict.fromkeys(every))


def point_rows(compared: PointComparison) -> list[tuple[str, ...]]:
    """Return the rows of the table of places, without their verdicts."""
    rows = []
    for one in compared.rows:
        name, simulated, measured, *others = number_row(one.numbers)
        if math.isfinite(one.accuracy):
            measured = f"{measured} ± {readable(one.accuracy, one.numbers.unit)}"
        rows.append((name, one.place, simulated, measured, *others))
    return rows


def outcome_of(compared: MeasurementComparison) -> str:
    """Say how many tolerances are met, and which are not."""
    judged = [row for row in compared.rows if row.within is not None]
    missed = [name_of(quantity) for quantity in compared.missed]
    if not judged:
        return "no number has both a tolerance and a value"
    if not missed:
        return f"all {len(judged)} met"
    return f"{len(missed)} of {len(judged)} missed: {', '.join(missed)}"


def span_rows(compared: MeasurementComparison) -> list[tuple[str, ...]]:
    """Return both forces span by span."""
    return [
        (" ".join(filter(None, (str(one.span), one.place))), *_both_forces(one))
        for one in compared.spans
    ]


def length_rows(compared: MeasurementComparison) -> list[tuple[str, ...]]:
    """Return both forces by tension length."""
    return [
        (
            f"{one.tension_length}, supports {one.supports[0]} to {one.supports[1]}",
            *_both_forces(one),
        )
        for one in compared.tension_lengths
    ]


def _both_forces(one: SpanFigures | LengthFigures) -> tuple[str, ...]:
    names = ("mean", "standard_deviation", "maximum", "minimum")
    sides = (number(side[name]) for name in names for side in (one.simulated, one.measured))
    return (*sides, f"{100.0 * one.measured_share:.0f} %")


def percentile_rows(compared: MeasurementComparison) -> list[tuple[str, ...]]:
    """Return the percentiles of both forces."""
    return [
        (f"{share} %", quantity(simulated, "N"), quantity(measured, "N"),
         quantity(simulated - measured, "N"))
        for share, (simulated, measured) in compared.percentiles.items()
    ]  # fmt: skip


def coverage_rows(part: Coverage) -> list[tuple[str, str]]:
    """Return what a comparison covers, in words."""
    shortest, longest = part.span_lengths
    lengths = f"{shortest:g} m" if shortest == longest else f"{shortest:g} to {longest:g} m"
    behind = ", ".join(f"{value:g}" for value in part.spacing)
    masses = listing([f"{mass:g}" for mass in part.masses])
    return [
        ("line", f"{part.case}, {part.line_type}"),
        ("wires", ", ".join(f"{name} {1e-3 * t:g} kN" for name, t in part.wires.items())),
        ("spans", f"{part.spans[0]} to {part.spans[1]}, {lengths}; {part.length:.0f} m in all"),
        ("pantograph", f"{part.pantograph}, masses {masses} kg; "
         + counted(part.pantographs, "pantograph")
         + (f" at {behind} m behind the first" if part.pantographs > 1 else "")),
        ("simulated speed", speed(part.simulated_speed)),
        ("measured speed", speed(part.measured_speed)),
        ("direction", part.direction),
        ("measured samples hold", f"up to {part.highest_frequency:.3g} Hz"),
    ]  # fmt: skip


def envelope_rows(covers: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return what several comparisons cover together, in words."""
    wires = ", ".join(
        f"{name} {_span(pair, 1e-3)} kN" for name, pair in covers["tensions_n"].items()
    )
    masses = "; ".join(listing([f"{mass:g}" for mass in own])
                       for own in covers["pantograph_masses_kg"])  # fmt: skip
    return [
        ("lines", listing(covers["lines"])),
        ("types of line", "; ".join(covers["line_types"])),
        ("wires", wires),
        ("spans", f"{_span(covers['span_lengths_m'])} m; {covers['length_m']:.0f} m in all"),
        ("pantographs", f"{listing(covers['pantographs'])}, masses {masses} kg"),
        ("pantographs at a time", listing([str(n) for n in covers["numbers_of_pantographs"]])),
        ("simulated speed", f"{_span(covers['speed_kmh'])} km/h"),
        ("measured speed", f"{_span(covers['measured_speed_kmh'])} km/h"),
        ("direction", listing(covers["directions"])),
    ]


def _span(pair: Iterable[float], factor: float = 1.0) -> str:
    low, high = (factor * value for value in pair)
    return f"{low:.4g}" if f"{low:.4g}" == f"{high:.4g}" else f"{low:.4g} to {high:.4g}"


def _difference(row: MeasurementRow) -> str:
    if not math.isfinite(row.difference):
        return MISSING
    if row.is_relative and row.relative_difference is not None:
        return f"{number(100 * row.relative_difference)} %"
    return readable(row.difference, row.unit)


def _tolerance(row: MeasurementRow) -> str:
    if row.low is None or row.high is None:
        return ""
    if row.is_relative:
        return f"{number(100 * row.low, 0)} to {number(100 * row.high, 0)} %"
    return f"{readable(row.low, row.unit).split()[0]} to {readable(row.high, row.unit)}"
