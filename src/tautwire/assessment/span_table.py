"""Longest spans over radius and wind."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from tautwire.assessment.gauge import gauge_head, gauge_rule
from tautwire.formulas.lateral import SIDES, Blown, LongestSpan, lateral_position, longest_span
from tautwire.formulas.pantograph_gauge import permissible_lateral_position
from tautwire.formulas.wind import dynamic_pressure, wind_load
from tautwire.specs.span_table import Curve, GaugeRule, SpanTable


@dataclass(frozen=True)
class SpanRow:
    """The longest spans of one radius.

    Attributes
    ----------
    curve : Curve
    permissible : float m
    spans : tuple of LongestSpan
        One per wind speed.
    lateral : tuple of float m
        Largest lateral position at that span, towards the worse side, one per wind speed; NaN
        where no span is possible or nothing limits it.
    """

    curve: Curve
    permissible: float
    spans: tuple[LongestSpan, ...]
    lateral: tuple[float, ...]

    def as_dict(self, winds: tuple[float, ...]) -> dict[str, Any]:
        """Return the row as plain data."""
        return {
            "radius_m": None if math.isinf(self.curve.radius_or_infinity) else self.curve.radius,
            "stagger_m": list(self.curve.stagger),
            "cant_m": self.curve.cant,
            "permissible_m": self.permissible,
            "spans": [
                {
                    "wind_m_s": wind,
                    "longest_m": span.length if math.isfinite(span.length) else None,
                    "governs": span.governs,
                    "lateral_m": None if math.isnan(lateral) else lateral,
                }
                for wind, span, lateral in zip(winds, self.spans, self.lateral, strict=True)
            ],
        }


def span_table(spec: SpanTable) -> tuple[SpanRow, ...]:
    """Compute the longest span for every radius and wind speed.

    Parameters
    ----------
    spec
        What is asked for.

    Returns
    -------
    tuple of SpanRow
        In the order of ``spec.curves``.

    Raises
    ------
    InputError
        When a calculation rule or a head is unknown.
    """
    return tuple(_row(spec, curve, _permissible(spec, curve)) for curve in spec.curves)


def _permissible(spec: SpanTable, curve: Curve) -> float:
    if curve.permissible is not None:
        return curve.permissible
    wanted = spec.permissible
    if not isinstance(wanted, GaugeRule):
        assert wanted is not None  # the spec asks for one or the other
        return wanted
    return permissible_lateral_position(
        gauge_head(wanted.head).half_width,
        wanted.height,
        curve.radius_or_infinity,
        curve.cant,
        gauge_rule(wanted.rule).terms,
    )


def _row(spec: SpanTable, curve: Curve, permissible: float) -> SpanRow:
    spans, lateral = [], []
    for speed in spec.wind.speeds:
        pressure = dynamic_pressure(speed, spec.wind.density) * spec.wind.factor
        load = sum(wind_load(pressure, d, spec.wind.drag) for d in spec.wires.diameters)
        wire = Blown(spec.wires.tension, load, curve.radius_or_infinity, curve.stagger)
        span = longest_span(
            wire,
            permissible,
            largest_pull=math.inf if spec.radial_pull is None else spec.radial_pull,
            limit=math.inf if spec.longest is None else spec.longest,
            pulling=spec.wires.pulling or spec.wires.tension,
        )
        spans.append(span)
        lateral.append(_lateral(wire, span.length))
    return SpanRow(curve, permissible, tuple(spans), tuple(lateral))


def _lateral(wire: Blown, span: float) -> float:
    if span == 0.0 or math.isinf(span):
        return math.nan
    return max(lateral_position(wire, span, side) for side in SIDES)
