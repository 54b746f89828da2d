"""Rows about a recording, for the terminal and the page alike."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from tautwire.measured.evaluation import BANDS, Evaluation, ForceFigures
from tautwire.report.parts.words import band, number, quantity
from tautwire.signals.bands import band_name

COUNTED = (
    ("stretch", "mean [N]", "σ [N]", "max [N]", "min [N]", "measured"),
    "Lrrrrr",
)
"""Heading and alignment of the table of stretches."""
EVENTS = ("event", "position [m]", "duration [ms]", "extreme")
_UNITS = ((" m s2", "m/s²"), (" m s", "m/s"), (" kg", "kg"), (" n", "N"), (" m", "m"))
_UNSAID = ("name", "cutoff_hz")
"""What a step says elsewhere: its name beside it, its cut-off in the words of the filter."""


def figure_rows(force: ForceFigures, highest: float) -> list[tuple[str, str, str]]:
    """Return names, values and remarks of the figures of a force.

    Parameters
    ----------
    force
    highest : float Hz
        Frequency up to which the samples hold the force.
    """
    short = "" if highest >= BANDS[-1][1] else f"of what the rows hold, up to {highest:.1f} Hz"
    rows = [
        ("mean", quantity(force.mean, "N"), ""),
        ("standard deviation", quantity(force.standard_deviation, "N"), short),
    ]
    for one in BANDS:
        name = band_name(one)
        beyond = "" if one[1] < highest else "not judged: beyond what the rows hold"
        rows.append((f"σ {band(name)}", quantity(force.bands[name], "N"), beyond))
    rows += [
        ("maximum", quantity(force.maximum, "N"), short),
        ("minimum", quantity(force.minimum, "N"), short),
        ("mean + 3 σ", quantity(force.statistical_maximum, "N"), ""),
        ("mean − 3 σ", quantity(force.statistical_minimum, "N"), ""),
    ]
    rows += [
        (f"{name} % of the way below", quantity(value, "N"), "")
        for name, value in force.percentiles.items()
    ]
    rows.append(("not measured", quantity(100.0 * force.missing_share, "%", 2), ""))
    return rows


def step_rows(found: Evaluation) -> list[tuple[str, str]]:
    """Return the steps of the processing with their parameters in words."""
    return [
        (
            str(step["name"]),
            ", ".join(_parameter(key, step[key]) for key in step if key not in _UNSAID),
        )
        for step in found.steps
    ]


def _parameter(key: str, value: Any) -> str:
    words = key.replace("_", " ")
    for suffix, unit in _UNITS:
        if words.endswith(suffix):
            return f"{words.removesuffix(suffix)} {_value(value)} {unit}"
    return f"{words} {_value(value)}"


def _value(value: Any) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"strip {key}: {_value(item)}" for key, item in value.items())
    if isinstance(value, list | tuple):
        return " ".join(_value(item) for item in value)
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def stretch_rows(found: Evaluation) -> list[tuple[str, ...]]:
    """Return the statistics of the stretches."""
    return [
        (
            str(one["label"]),
            number(one["mean"]),
            number(one["standard_deviation"]),
            number(one["maximum"]),
            number(one["minimum"]),
            f"{100.0 * one['measured_share']:.1f} %",
        )
        for one in found.stretches
    ]


def event_rows(found: Evaluation) -> list[tuple[str, ...]]:
    """Return the events under :data:`EVENTS`."""
    return [
        (
            str(one["kind"]),
            number(one["position"]),
            number(1e3 * (one["end"] - one["start"])),
            quantity(one["extreme"], one["unit"].replace("^2", "²")),
        )
        for one in found.events
    ]


def range_rows(found: Evaluation) -> list[tuple[str, ...]]:
    """Return the ranges of the other channels in the units that people use."""
    rows = []
    for one in found.ranges:
        factor, unit = {"m": (1e3, "mm"), "m/s": (3.6, "km/h")}.get(one.unit, (1.0, one.unit))
        values = (number(factor * value) for value in (one.least, one.mean, one.largest))
        missing = f"{100.0 * one.missing_share:.1f} %" if math.isfinite(one.missing_share) else ""
        rows.append((f"{one.name} [{unit}]" if unit else one.name, *values, missing))
    return rows
