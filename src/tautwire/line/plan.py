"""Tension lengths in figures: which masts they pass, and where their wires are there."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from tautwire.errors import ModelError
from tautwire.numerics.track import Track
from tautwire.specs.case import Case
from tautwire.specs.line.catenary import Ends
from tautwire.specs.line.tension import Overlap, TensionLength
from tautwire.specs.line.wire import Wire


@dataclass(frozen=True)
class Plan:
    """One tension length; lists have one value per mast of the whole line.

    Attributes
    ----------
    name : str
        Empty when there is only one.
    first, last : int
        0-based masts at which it is anchored.
    ends : Ends
    fixed_point : int or None
        0-based.
    contact_z, shift : tuple of float m
        Heights of the contact wires, and lateral shift of all wires.
    raised : frozenset of int
        Masts at which the contact wires are raised out of the way of pantographs.
    droppers : (float, float) m
        Where contact wires have droppers.
    """

    name: str
    first: int
    last: int
    ends: Ends
    fixed_point: int | None
    contact_z: tuple[float, ...]
    shift: tuple[float, ...]
    raised: frozenset[int]
    droppers: tuple[float, float]

    @property
    def inner(self) -> range:
        """Masts between the anchors."""
        return range(self.first + 1, self.last)

    def run(self, wire: str) -> str:
        """Return the name of the run of a wire."""
        return f"{self.name} {wire}" if self.name else wire


def plans(case: Case, track: Track) -> tuple[Plan, ...]:
    """Return the tension lengths of a case from left to right.

    Raises
    ------
    ModelError
        When an overlap leaves a contact wire too little room to rise.
    """
    masts = case.line.support_positions()
    heights = case.supports.contact_heights(len(masts))
    level = (0.0,) * len(masts)
    if not case.tension_lengths:
        whole = (masts[0], masts[-1])
        last = len(masts) - 1
        return (Plan("", 0, last, case.line.ends, None, heights, level, frozenset(), whole),)
    found = [_alone(spec, masts, heights) for spec in case.tension_lengths]
    overlaps = case.overlaps or (Overlap(),)
    for number, _ in enumerate(pairwise(found)):
        overlap = overlaps[min(number, len(overlaps) - 1)]
        left, right = found[number], found[number + 1]
        found[number] = _raised((case, track), left, overlap, side=1, last=left.last)
        found[number + 1] = _raised((case, track), right, overlap, side=-1, last=right.first)
        shared = range(right.first, left.last + 1)
        found[number] = _shifted(found[number], shared, 0.5 * overlap.separation)
        found[number + 1] = _shifted(found[number + 1], shared, -0.5 * overlap.separation)
    return tuple(found)


def _alone(spec: TensionLength, masts: tuple[float, ...], heights: tuple[float, ...]) -> Plan:
    first, last = spec.masts[0] - 1, spec.masts[1] - 1
    fixed = None if spec.fixed_point is None else spec.fixed_point - 1
    level, whole = (0.0,) * len(masts), (masts[first], masts[last])
    return Plan(spec.name, first, last, spec.ends, fixed, heights, level, frozenset(), whole)


def _shifted(plan: Plan, masts: range, by: float) -> Plan:
    shift = tuple(y + by if mast in masts else y for mast, y in enumerate(plan.shift))
    return _changed(plan, shift=shift)


def _raised(
    whole: tuple[Case, Track], plan: Plan, overlap: Overlap, *, side: int, last: int
) -> Plan:
    """Raise the contact wires at an anchor and at the mast before it.

    From the last dropper a wire rises freely above the rails, ``T z'' = w`` with its load w in the
    frame of the track, so that it needs the distance ``sqrt(2 T h / w)`` to the mast where it is
    raised by h above its lowest dropper.
    """
    (case, track), towards = whole, -side
    masts = case.line.support_positions()
    raised = last + towards
    z = list(plan.contact_z)
    z[last] += overlap.anchor_rise
    z[raised] += overlap.rise
    climb = overlap.rise + _largest_presag(case)
    way = max(
        math.sqrt(2.0 * wire.tension * climb / _load(wire, track, masts[raised], case.line.gravity))
        for _, wire in case.wires.of_role("contact")
    )
    free = masts[raised] - side * way
    limits = (plan.droppers[0], free) if side > 0 else (free, plan.droppers[1])
    running = masts[raised + towards]
    if (free - running) * side < 0.0:
        raise ModelError(
            f"tension length {plan.name!r}: the contact wire needs {way:.1f} m to rise by "
            f"{overlap.rise:g} m at support {raised + 1}, and the span to support "
            f"{raised + towards + 1} has {abs(masts[raised] - running):g} m; lower overlaps.rise"
        )
    return _changed(plan, contact_z=tuple(z), raised=plan.raised | {raised}, droppers=limits)


def _load(wire: Wire, track: Track, s: float, gravity: float) -> float:
    """Return the load of a taut wire in the frame of the track [N/m].

    Its weight normal to the rails, less what its tension takes over where they bend upwards: in a
    vertical curve, and in a canted one.

    Raises
    ------
    ModelError
        When nothing is left of it.
    """
    upright = float(track.frames(s).axes[2, 2])
    load = wire.mass * gravity * upright - wire.tension * float(track.rise_curvature(s))
    if load <= 0.0:
        raise ModelError(
            f"x = {s:g} m: with {1e-3 * wire.tension:g} kN a wire does not hang down towards the "
            "rails, which bend up too sharply there (track); move the overlap or lower the tension"
        )
    return load


def _largest_presag(case: Case) -> float:
    spans = case.line.spans
    drops = [
        drop
        for one in case.dropper_sets
        if one.about == "span" and one.mode == "height"
        for row in one.presag_by_span(spans)
        for drop in row
    ]
    return max(drops, default=0.0)


def _changed(plan: Plan, **changes: Any) -> Plan:
    return replace(plan, **changes)
