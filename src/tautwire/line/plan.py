"""Tension lengths in figures: which masts they pass, and where their wires are there."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from tautwire.errors import ModelError
from tautwire.line.measures import SAME_PLACE
from tautwire.numerics.track import Track
from tautwire.specs.case import Case
from tautwire.specs.line.catenary import Ends
from tautwire.specs.line.tension import Overlap, TensionLength
from tautwire.specs.line.wire import Wire

LEAST_SHARE = 0.25
"""Share of the weight of the wire before it that the last dropper of a raised wire carries at
least. On AC simple that is 19 N; bending of the wire, which the rule leaves out, is worth 1 N, on a
coarse mesh 10 N."""

_PLACES = 9
"""Places in a span at which the load of a wire is looked at: vertical curves are longer than an
eighth of a span."""


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
    droppers : dict of (float, float) m
        Where contact wires have droppers, by the name of the wire.
    """

    name: str
    first: int
    last: int
    ends: Ends
    fixed_point: int | None
    contact_z: tuple[float, ...]
    shift: tuple[float, ...]
    raised: frozenset[int]
    droppers: dict[str, tuple[float, float]]

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
        last = len(masts) - 1
        whole = _everywhere(case, 0, last)
        return (Plan("", 0, last, case.line.ends, None, heights, level, frozenset(), whole),)
    found = [_alone(case, spec, heights) for spec in case.tension_lengths]
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


def _alone(case: Case, spec: TensionLength, heights: tuple[float, ...]) -> Plan:
    first, last = spec.masts[0] - 1, spec.masts[1] - 1
    fixed = None if spec.fixed_point is None else spec.fixed_point - 1
    level, whole = (0.0,) * len(heights), _everywhere(case, first, last)
    return Plan(spec.name, first, last, spec.ends, fixed, heights, level, frozenset(), whole)


def _everywhere(case: Case, first: int, last: int) -> dict[str, tuple[float, float]]:
    masts = case.line.support_positions()
    return {name: (masts[first], masts[last]) for name, _ in case.wires.of_role("contact")}


def _shifted(plan: Plan, masts: range, by: float) -> Plan:
    shift = tuple(y + by if mast in masts else y for mast, y in enumerate(plan.shift))
    return _changed(plan, shift=shift)


def _raised(
    whole: tuple[Case, Track], plan: Plan, overlap: Overlap, *, side: int, last: int
) -> Plan:
    """Raise the contact wires at an anchor and at the mast before it."""
    (case, track), running = whole, last - 2 * side
    masts, raised = case.line.support_positions(), last - side
    z = list(plan.contact_z)
    z[last] += overlap.anchor_rise
    z[raised] += overlap.rise
    limits = {}
    for name, wire in case.wires.of_role("contact"):
        places = np.linspace(masts[running], masts[raised], _PLACES)
        load = min(_load(wire, track, s, case.line.gravity) for s in places.tolist())
        way = math.sqrt(2.0 * wire.tension * overlap.rise / load)
        span = abs(masts[raised] - masts[running])
        if way > span:
            most = math.floor(1e3 * overlap.rise * (span / way) ** 2)
            raise ModelError(
                f"tension length {plan.name!r}: the contact wire needs {way:.1f} m to rise by "
                f"{overlap.rise:g} m at support {raised + 1}, and the span to support "
                f"{running + 1} has {span:g} m; lower overlaps.rise (at most {most} mm there)"
            )
        rows = _hung(case, plan, name, (running, raised))
        end = masts[running] + side * _last_carried(rows, (span, overlap.rise), wire.tension, load)
        low, high = plan.droppers[name]
        limits[name] = (low, end) if side > 0 else (end, high)
    return _changed(plan, contact_z=tuple(z), raised=plan.raised | {raised}, droppers=limits)


def _hung(case: Case, plan: Plan, wire: str, way: tuple[int, int]) -> list[tuple[float, float]]:
    """Return distance and pre-sag of the droppers of a wire on the way from one mast to the next.

    Those counted from a mast may hang on either side of it. Droppers of given length are taken to
    hold the wire where it would be without pre-sag: what they do is known with the shape only.
    """
    (start, end), masts, rows = way, case.line.support_positions(), []
    sign = 1.0 if end > start else -1.0
    stitches = {name for name, _ in case.wires.of_role("stitch")}  # none at a raised mast
    for one in case.dropper_sets:
        if one.lower != wire or one.tension_length not in (None, plan.name):
            continue
        about_span = one.about == "span"
        count = case.line.spans if about_span else case.line.spans - 1
        positions, drops = one.positions_by_span(count), one.presag_by_span(count)
        carriers = (start,) if one.upper in stitches else way
        hosts = {min(way): min(way)} if about_span else {mast: mast - 1 for mast in carriers}
        for host, index in hosts.items():
            if index not in range(count):  # an anchor has no droppers of its own
                continue
            own = drops[index] if one.mode == "height" else (0.0,) * len(positions[index])
            rows += [
                (sign * (masts[host] + position - masts[start]), drop)
                for position, drop in zip(positions[index], own, strict=True)
            ]
    return sorted(row for row in rows if 0.0 < row[0] < abs(masts[end] - masts[start]))


def _last_carried(
    rows: list[tuple[float, float]], rise: tuple[float, float], tension: float, load: float
) -> float:
    """Return the distance of the last dropper that pulls under a wire that leaves it upwards [m].

    Beyond it nothing holds the wire up to the mast at the distance L, where it is raised by h; a
    dropper at d with the pre-sag p, behind another at d0 with p0, then carries
    ``w (L - d0)/2 - T ((h + p)/(L - d) + (p - p0)/(d - d0))``. 0 when none pulls.

    Parameters
    ----------
    rows
        Distance and pre-sag of the droppers [m].
    rise
        Distance L and height h of the mast [m].
    tension
    load
        Weight in the frame of the track [N/m].
    """
    (length, height), before, last = rise, (0.0, 0.0), 0.0
    for d, p in rows:
        d0, p0 = before
        if d - d0 < SAME_PLACE:  # two wires above hold it here
            continue
        kink = (height + p) / (length - d) + (p - p0) / (d - d0)
        if 0.5 * load * (length - d0) - tension * kink > LEAST_SHARE * load * (d - d0):
            last = d
        before = d, p
    return last


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


def _changed(plan: Plan, **changes: Any) -> Plan:
    return replace(plan, **changes)
