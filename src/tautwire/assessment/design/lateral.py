"""Whether the contact wire stays on the pantograph heads, span by span."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tautwire.assessment.gauge import gauge_head, gauge_rule
from tautwire.formulas.pantograph_gauge import permissible_lateral_position
from tautwire.line.measures import SAME_PLACE
from tautwire.plain import Plain, named
from tautwire.results.design.lateral import SIDES, LateralSweep
from tautwire.specs.requirements import Gauge
from tautwire.specs.span_table import HeadRule

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LateralPlace(Plain):
    """The worst place of a span under wind towards one side.

    Attributes
    ----------
    span : int
    towards : str
        Side that the wind pushes to.
    wire : str
    x : float m
    position : float m
        Of the wire towards that side, from the finite-element equilibrium.
    given : float m
        Deflection of supports and tolerances on top of it.
    permissible, margin : float m
        What is left of the permissible position; negative when it is exceeded.
    alone, together : float m
        Estimates of the largest position in the span.
    radius, cant, height : float m
        There; radius infinite on straight track.
    """

    span: int
    towards: str
    wire: str
    x: float = field(metadata=named("x_m"))
    position: float = field(metadata=named("position_m"))
    given: float = field(metadata=named("deflection_and_tolerance_m"))
    permissible: float = field(metadata=named("permissible_m"))
    margin: float = field(metadata=named("margin_m"))
    alone: float = field(metadata=named("estimate_alone_m"))
    together: float = field(metadata=named("estimate_together_m"))
    radius: float = field(metadata=named("radius_m"))
    cant: float = field(metadata=named("cant_or_deficiency_m"))
    height: float = field(metadata=named("height_m"))


@dataclass(frozen=True, eq=False)
class LateralCheck(Plain):
    """The lateral position along a line.

    Attributes
    ----------
    wind : str
    places : tuple of LateralPlace
        Two per span, one for each side.
    faults : tuple of str
        Why the line has no state under the wind.
    notes : tuple of str
        What stands behind the permissible position.
    permissible : (2, n) m
        Along the line, see ``sweep``.
    sweep : LateralSweep
    """

    untold = ("permissible", "sweep")

    wind: str
    places: tuple[LateralPlace, ...]
    faults: tuple[str, ...]
    notes: tuple[str, ...]
    permissible: Array
    sweep: LateralSweep

    @property
    def worst(self) -> tuple[LateralPlace, ...]:
        """The worse side of every span."""
        spans = sorted({one.span for one in self.places})
        return tuple(
            min((one for one in self.places if one.span == span), key=lambda one: one.margin)
            for span in spans
        )


def known_gauge(gauge: Gauge | None) -> None:
    """Raise :class:`InputError` when the rule or head that a gauge names is unknown."""
    if gauge is not None and isinstance(gauge.permissible, HeadRule):
        gauge_rule(gauge.permissible.rule)
        gauge_head(gauge.permissible.head)


def lateral_check(sweep: LateralSweep, gauge: Gauge) -> LateralCheck:
    """Compare the lateral position of the contact wires with what is permissible.

    Parameters
    ----------
    sweep
        The line under wind from either side.
    gauge
        What is required.

    Raises
    ------
    InputError
        When the rule or the head is unknown.
    """
    permissible = _permissible(sweep, gauge)
    return LateralCheck(
        wind=str(gauge.wind),
        places=tuple(_places(sweep, gauge, permissible)),
        faults=tuple(
            f"wind towards the {side}: {line}"
            for side, fault in zip(SIDES, sweep.faults, strict=True)
            for line in fault.splitlines()
        ),
        notes=tuple(_notes(gauge)),
        permissible=permissible,
        sweep=sweep,
    )


def _permissible(sweep: LateralSweep, gauge: Gauge) -> Array:
    wanted = gauge.permissible
    if not isinstance(wanted, HeadRule):
        return np.full(sweep.position.shape, wanted)
    half, terms = gauge_head(wanted.head).half_width, gauge_rule(wanted.rule).terms
    return np.array(
        [
            [
                permissible_lateral_position(half, *there, terms)
                for there in zip(row, sweep.radius, sweep.cant, strict=True)
            ]
            for row in sweep.height
        ]
    )


def _places(sweep: LateralSweep, gauge: Gauge, permissible: Array) -> Iterator[LateralPlace]:
    given = gauge.deflection + gauge.tolerance
    margin = permissible - sweep.position - given
    for span, (left, right) in enumerate(pairwise(sweep.masts.tolist()), start=1):
        own = np.flatnonzero((sweep.x > left - SAME_PLACE) & (sweep.x < right + SAME_PLACE))
        for side, towards in enumerate(SIDES):
            if sweep.faults[side]:
                continue
            at = int(own[margin[side, own].argmin()])
            yield LateralPlace(
                span=span,
                towards=towards,
                wire=sweep.wire_names[int(sweep.wire[at])],
                x=float(sweep.x[at]),
                position=float(sweep.position[side, at]),
                given=given,
                permissible=float(permissible[side, at]),
                margin=float(margin[side, at]),
                alone=float(sweep.alone[side, span - 1]),
                together=float(sweep.together[side, span - 1]),
                radius=float(sweep.radius[at]),
                cant=float(sweep.cant[at]),
                height=float(sweep.height[side, at]),
            )


def _notes(gauge: Gauge) -> Iterator[str]:
    wanted = gauge.permissible
    if not isinstance(wanted, HeadRule):
        yield "permissible position as given"
        return
    rule, head = gauge_rule(wanted.rule), gauge_head(wanted.head)
    state = "verified" if rule.verified else "not checked against the standard"
    yield f"{rule.name}: {state}; {rule.confidence}, {rule.source}"
    yield f"head {head.id}: usable half width {head.half_width:g} m, {head.source}"
