"""Checks of the design of a line: value, estimate and limit side by side.

Values come from the finite-element equilibrium of the line in its design and in its conditions;
where a check rests on a closed form alone, there is only its estimate.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from tautwire.assessment.design.limits import design_limits
from tautwire.assessment.wave_quantities import (
    amplification_factor,
    doppler_factor,
    midspan_elasticity,
    reflection_coefficient,
)
from tautwire.model.build import Model
from tautwire.model.equations import equations
from tautwire.numerics.elements import ancf
from tautwire.plain import Plain
from tautwire.results.design.conditions import ConditionState
from tautwire.results.equilibrium import Elasticity, Equilibrium
from tautwire.specs.case import Case
from tautwire.text import DESIGN

Array = NDArray[np.float64]

GIVEN = "given by the case"


@dataclass(frozen=True)
class DesignCheck(Plain):
    """One figure of the design against its limit.

    Attributes
    ----------
    quantity : str
        Key.
    name, place : str
    value : float
        Of the finite-element equilibrium, in `unit`; NaN where there is none.
    estimate : float
        Of the closed form; NaN where there is none.
    unit : str
        ``"m"``, ``"m/s"``, ``"m/N"`` or ``"1"``.
    formula : str
        Of the estimate.
    limit : float
        NaN where none is known.
    sense : str
    source : str
        Of the limit, with what is known of its verification.
    verified : bool
    """

    derived: ClassVar[tuple[str, ...]] = ("within",)

    quantity: str
    name: str
    place: str
    value: float
    estimate: float
    unit: str
    formula: str
    limit: float = math.nan
    sense: str = ""
    source: str = ""
    verified: bool = False

    @property
    def within(self) -> bool | None:
        """Whether value, or else estimate, keeps the limit; None without one of them."""
        value = self.estimate if math.isnan(self.value) else self.value
        if math.isnan(value) or math.isnan(self.limit):
            return None
        return value <= self.limit if self.sense == "maximum" else value >= self.limit


@dataclass(frozen=True, eq=False)
class _Stand:
    """The line in one state."""

    name: str
    model: Model
    shape: Equilibrium
    tension: Array = field(default_factory=lambda: np.empty(0))


def design_checks(model: Model, states: Sequence[ConditionState]) -> tuple[DesignCheck, ...]:
    """Check the design of a line.

    Parameters
    ----------
    model
        The line.
    states
        Its states, the design first; those that cannot be are left out.
    """
    stands = [_stand(model, one) for one in states if one.shape is not None]
    if not stands:
        return ()
    rows = [
        *_waves(model.case),
        *_gradients(stands[0]),
        *_heights(stands),
        *_sweep(stands[0]),
        *_tensions(stands),
        *_hanging(stands[0]),
        *_elasticity(model.case, states),
    ]
    return tuple(_limited(row, model.case) for row in rows)


def _stand(model: Model, state: ConditionState) -> _Stand:
    assert state.shape is not None
    name = None if state.name == DESIGN else state.name
    own = replace(model, case=model.case.with_condition(name))
    system = equations(own, state.shape)
    cables = system.cables
    tension = ancf.axial_force(cables.coordinates(system.position), cables.section)
    return _Stand(state.name, own, state.shape, tension)


def _limited(row: DesignCheck, case: Case) -> DesignCheck:
    """Return a check with the limit of the case, or else of the package."""
    given = _given(case).get(row.quantity)
    known = design_limits().get(row.quantity)
    if given is not None and known is not None:
        return replace(row, limit=given, sense=known.sense, source=GIVEN)
    bound = None if known is None else known.value(case.scenario.speed)
    if known is None or bound is None:
        return row
    named = ", ".join(filter(None, (known.standard, known.edition, known.clause)))
    state = "verified" if known.verified else f"not checked ({known.confidence})"
    return replace(
        row,
        limit=bound,
        sense=known.sense,
        source=f"{named}: {state}",
        verified=known.verified,
    )


def _given(case: Case) -> dict[str, float | None]:
    own = case.requirements
    least, largest = own.heights or (None, None)
    return {
        "least_height": least,
        "largest_height": largest,
        "shortest_dropper": own.shortest_dropper,
        "tension_share": own.tension_share,
    }


def _row(key: str, name: str, value: float, estimate: float, **more: Any) -> DesignCheck:
    told: dict[str, Any] = {"place": "", "unit": "1", "formula": ""} | more
    return DesignCheck(key, name, value=value, estimate=estimate, **told)


def _waves(case: Case) -> Iterator[DesignCheck]:
    contact, messenger, speed = case.wires.contact, case.wires.messenger, case.scenario.speed
    wave = contact.wave_speed()
    nan = math.nan
    yield _row(
        "wave_speed", "wave speed of the contact wire", nan, wave, unit="m/s", formula="sqrt(T/m)"
    )
    yield _row("wave_speed_ratio", "speed over wave speed", nan, speed / wave, formula="v/c")
    doppler = doppler_factor(speed, wave)
    yield _row("doppler", "Doppler factor", nan, doppler, formula="(c - v)/(c + v)")
    if messenger is not None:
        wires = (contact.tension, contact.mass, messenger.tension, messenger.mass)
        factor = amplification_factor(reflection_coefficient(*wires), doppler)
        yield _row(
            "amplification", "amplification factor", nan, factor, formula="reflection / Doppler"
        )


def _gradients(stand: _Stand) -> Iterator[DesignCheck]:
    """Yield the steepest gradient of the contact wire against the rails, and its largest change."""
    shape, case = stand.shape, stand.model.case
    masts = shape.mast_x
    built = np.array(case.supports.contact_heights(len(masts)))
    found = [np.diff(z) / np.diff(masts) for z in (shape.running_height(masts), built)]
    worst = int(np.abs(found[0]).argmax())
    law = "difference of heights of neighbouring supports over the span"
    yield _row(
        "gradient",
        "gradient of the contact wire",
        abs(float(found[0][worst])),
        abs(float(found[1][worst])),
        place=f"span {worst + 1}",
        formula=law,
    )
    if len(masts) > 2:
        changes = [np.abs(np.diff(own)) for own in found]
        worst = int(changes[0].argmax())
        yield _row(
            "gradient_change",
            "change of gradient",
            float(changes[0][worst]),
            float(changes[1][worst]),
            place=f"support {worst + 2}",
            formula=law,
        )


def _heights(stands: Sequence[_Stand]) -> Iterator[DesignCheck]:
    """Yield the lowest and the highest place of the running contact wire over all states."""
    case = stands[0].model.case
    built = case.supports.contact_heights(case.line.spans + 1)
    low, high = (math.inf, "", ""), (-math.inf, "", "")
    for stand in stands:
        masts = stand.shape.mast_x
        points = np.unique(np.concatenate([w.position[:, 0] for w in stand.shape.wires]))
        x = points[(points >= masts[0]) & (points <= masts[-1])]
        z = stand.shape.running_height(x)
        for at in (int(z.argmin()), int(z.argmax())):
            place = f"x = {x[at]:.1f} m, {stand.name}"
            low = min(low, (float(z[at]), place, ""))
            high = max(high, (float(z[at]), place, ""))
    law = "height at the supports"
    yield _row("least_height", "lowest contact wire", low[0], min(built), place=low[1], unit="m",
               formula=law)  # fmt: skip
    yield _row("largest_height", "highest contact wire", high[0], max(built), place=high[1],
               unit="m", formula=law)  # fmt: skip


def _sweep(stand: _Stand) -> Iterator[DesignCheck]:
    """Yield how far the wire wanders sideways per length of track, in the span with least.

    The variation of y over a span, over its length; the estimate is that of the bow
    ``b1 + (b2 - b1) x/L + x (L - x) / 2R`` that a wire is between its staggers in a curve.
    """
    shape, case = stand.shape, stand.model.case
    masts = shape.mast_x
    wire = shape.contact.position
    staggers = case.supports.contact_staggers(len(masts))
    track = stand.model.line.track
    rows = []
    for number, (left, right) in enumerate(pairwise(masts.tolist())):
        own = wire[(wire[:, 0] >= left - 1e-9) & (wire[:, 0] <= right + 1e-9)]
        if len(own) < 2:
            continue
        middle = float(track.plan_curvature(0.5 * (left + right)))
        x = np.linspace(0.0, right - left, 101)
        bow = (staggers[number + 1] - staggers[number]) * x / x[-1] + 0.5 * middle * x * (x[-1] - x)
        value, estimate = (float(np.abs(np.diff(y)).sum()) for y in (own[:, 1], bow))
        rows.append((value / x[-1], estimate / x[-1], number + 1))
    value, estimate, span = min(rows)
    speed = case.scenario.speed
    law = f"variation of y over the span; {1e3 * value * speed:.0f} mm/s at the speed"
    yield _row("sweep", "sweep over the strips, per length", value, estimate, place=f"span {span}",
               formula=law)  # fmt: skip


def _tensions(stands: Sequence[_Stand]) -> Iterator[DesignCheck]:
    """Yield the largest tension of each wire over the breaking load that wear leaves."""
    case = stands[0].model.case
    for name, wire in case.wires.named():
        if wire.strength is None:
            continue
        shares = []
        for stand in stands:
            condition, left = stand.model.case.chosen_condition, 1.0
            if condition is not None and wire.role == "contact":
                own = condition.of_wire(name).wear
                left -= condition.wear if own is None else own
            strands = [s for s in stand.model.mesh.strands if s.run.wire_name == name]
            largest = max(float(stand.tension[s.cables].max()) for s in strands)
            shares.append((largest / (wire.strength * left), stand.name))
        value, place = max(shares)
        yield _row(
            "tension_share",
            f"tension of {name!r} over its strength",
            value,
            wire.tension / wire.strength,
            place=place,
            formula="T over the breaking load, new wire",
        )


def _hanging(stand: _Stand) -> Iterator[DesignCheck]:
    """Yield the shortest dropper, and the sag of the messenger wire against the encumbrance.

    Moments about mid-span, ``T_m s_m + T_c s_c = w L^2 / 8``, give the sag s_m of the messenger
    wire from the pre-sag s_c of the contact wire; the shortest dropper is what is left.
    """
    shape, case = stand.shape, stand.model.case
    messenger = case.wires.messenger
    if messenger is None or not len(shape.dropper_lengths):
        return
    estimate = min(_left_over(case), default=math.nan)
    at = int(shape.dropper_lengths.argmin())
    yield _row(
        "shortest_dropper",
        "shortest dropper",
        float(shape.dropper_lengths[at]),
        estimate,
        place=str(stand.model.line.hangers[at].label),
        unit="m",
        formula="encumbrance + s_c - s_m at mid-span",
    )
    sags = [
        (_sag(shape, left, right), number)
        for number, (left, right) in enumerate(pairwise(shape.mast_x.tolist()), start=1)
    ]
    value, span = max(sags)
    yield _row(
        "messenger_sag",
        "sag of the messenger wire over the encumbrance",
        value / case.supports.encumbrances(case.line.spans + 1)[span - 1],
        _sag_estimate(case, span - 1) / case.supports.encumbrances(case.line.spans + 1)[span - 1],
        place=f"span {span}",
        formula="(w L^2/8 - T_c s_c)/T_m over the encumbrance",
    )


def _sag(shape: Equilibrium, left: float, right: float) -> float:
    """Return how far messenger wires sag below the line between two supports [m]."""
    found = [0.0]
    for wire in shape.of_role("messenger"):
        x, z = wire.position[:, 0], wire.position[:, 2]
        own = (x >= left - 1e-9) & (x <= right + 1e-9)
        if own.sum() > 2:
            chord = np.interp(x[own], [left, right], [z[own][0], z[own][-1]])
            found.append(float((chord - z[own]).max()))
    return max(found)


def _sag_estimate(case: Case, span: int) -> float:
    messenger, length = case.wires.messenger, case.line.span_lengths()[span]
    assert messenger is not None
    hung = case.wires.of_role("contact", "auxiliary", "messenger")
    weight = sum(wire.mass for _, wire in hung) * case.line.gravity
    tension = sum(wire.tension for _, wire in case.wires.of_role("contact"))
    carrying = sum(wire.tension for _, wire in case.wires.of_role("messenger"))
    return (weight * length**2 / 8.0 - tension * _presag(case, span)) / carrying


def _presag(case: Case, span: int) -> float:
    rows = [
        one.presag_by_span(case.line.spans)
        for one in case.dropper_sets
        if one.about == "span" and one.mode == "height"
    ]
    return max((max(row[span], default=0.0) for row in rows), default=0.0)


def _left_over(case: Case) -> Iterator[float]:
    heights = case.supports.encumbrances(case.line.spans + 1)
    for span, ends in enumerate(pairwise(heights)):
        yield sum(ends) / 2.0 + _presag(case, span) - _sag_estimate(case, span)


def _elasticity(case: Case, states: Sequence[ConditionState]) -> Iterator[DesignCheck]:
    """Yield the softest place, and the uplift at supports at rest where free space is given."""
    found = states[0].elasticity
    contact = sum(wire.tension for _, wire in case.wires.of_role("contact"))
    above = sum(wire.tension for _, wire in case.wires.of_role("messenger", "auxiliary"))
    softest = midspan_elasticity(max(case.line.span_lengths()), contact, above)
    value, place = math.nan, ""
    if found is not None:
        at = int(found.elasticity.argmax())
        value, place = float(found.elasticity[at]), f"span {found.span[at]}"
    yield _row("elasticity", "elasticity, softest place", value, softest, place=place, unit="m/N",
               formula="L/(4 sum(T))")  # fmt: skip
    free = case.uplift_space()
    if free is not None and found is not None:
        yield _uplift(case, found, free)


def _uplift(case: Case, found: Elasticity, free: float) -> DesignCheck:
    force = max(case.uplift_forces())
    supports = [row for row, kind in enumerate(found.kind) if kind == "support"]
    softest = max(supports, key=lambda row: found.elasticity[row])
    has_stop = any(kind.stop is not None for kind in case.supports.kinds())
    return _row(
        "uplift_share_with_stop" if has_stop else "uplift_share",
        "uplift at supports over the free space, at rest",
        float(found.elasticity[softest]) * force / free,
        math.nan,
        place=f"support {found.span[softest]}",
        formula=f"under {force:.0f} N",
    )
