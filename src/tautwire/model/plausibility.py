"""Is a line what somebody would build? Values outside what is usual are named, never refused.

Every piece of advice has the value, the usual range and the place. What the input tells is told by
:func:`implausible_inputs`; what only the static state tells by :func:`implausible_shape`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import groupby, pairwise

import numpy as np
from numpy.typing import NDArray

from tautwire.line.alignment import alignment
from tautwire.line.expand import expand
from tautwire.line.fittings import total_mass
from tautwire.model.preflight import Advice
from tautwire.results.equilibrium import Equilibrium
from tautwire.specs.case import Case
from tautwire.specs.line.dropper import Droppers
from tautwire.specs.line.wire import Wire

Array = NDArray[np.float64]

DIP = 0.01
"""Depth to which a body may bend the contact wire between droppers [m] before it is told: chosen,
half of a usual pre-sag; sagging joints wear strips and wire."""

BENT = 0.05
"""Deflection of an elastic cantilever under the lateral pull of its design [m] from which it is
told: chosen, a tenth of the stagger from side to side."""

COPPER = 8900.0
"""Density of copper and its alloys [kg/m3], of which contact wires and most ropes are made."""

STIFFNESS_PER_MASS = {"contact": (9e6, 15e6), "other": (4e6, 28e6)}
"""Usual EA over mass per length [N m/kg]. Contact wires of copper alloys have 11 to 14e6 (100 to
130 GPa), ropes of bronze 11 to 13e6, of steel and aluminium up to 26e6; copper-clad steel has
least. The range of the catalogue and of public lines, widened by a tenth."""

BENDING_OF_SOLID = {"contact": (0.4, 1.5), "other": (0.0, 1.5)}
"""Usual EI over that of a solid round copper wire with the same EA and mass, ``EA A/(4 pi)``:
grooved wires have 0.9 to 1.1, two of them taken as one 0.5, ropes 0 (slip) to 1.2 (stick)."""

ARM_ANGLE = (0.0, 20.0)
"""Usual inclination of steady arms [degrees]: 6 to 16 in a Chinese design text, 10 in the benchmark
of 2015, about 1 where an arm carries nothing but itself."""

ARM_SHARE = 0.6
"""Usual largest share of the contact wire, from the dropper before to the dropper behind a support,
that an arm carries; half is what a wire without pre-sag there lays on it."""

SLACK = 0.5
"""Force below which a dropper counts as slack at rest [N]: less than its own clamp weighs."""

SCATTER = 6.0
"""Usual largest over smallest dropper force of a span: 1.2 to 3.5 on the lines of the library."""

ROUNDED = 1e-3
"""Step to which pre-sag tends to be rounded [m]."""

ROUNDED_SHARE = 0.25
"""Share of a dropper's load that rounding its pre-sag may move before it is told: chosen, AC simple
has 6 %, droppers in pairs half a metre apart 50 %."""

SAME_SIDE = 4
"""Supports in a row with their stagger on one side, on straight track, from which it is told: the
strips of a pantograph wear evenly only with both sides."""

HEIGHT_OFF = 0.1
"""Distance of the wire at rest from its given height [m] from which it is told: an arm given by its
angle moves it by a millimetre, and heights are measured to centimetres."""

_ALONE = (
    "a contact wire without droppers hangs on span wires or brackets: supports.closure 'spring' "
    "with supports.spring, as in {stiffness: 2 kN/m}"
)

_CURVED = 1e-6
"""Curvature from which a track is not straight [1/m]: a radius of 1000 km."""

_NAMED = 6
"""Places that are named one by one."""


def implausible_inputs(case: Case) -> tuple[Advice, ...]:
    """Name values of a case that do not belong together or that nobody builds.

    Parameters
    ----------
    case

    Returns
    -------
    tuple of Advice
        Warnings; empty for a usual line.
    """
    found = [advice for name, wire in case.wires.named() for advice in _wire(name, wire)]
    return (*found, *_staggers(case), *_rounded_presag(case), *_bodies(case), *_stays(case))


def implausible_shape(case: Case, shape: Equilibrium) -> tuple[Advice, ...]:
    """Name what is unusual about the static state of a case.

    Parameters
    ----------
    case
    shape
        Its static state.

    Returns
    -------
    tuple of Advice
    """
    return (
        *_heights(case, shape),
        *_slack(case, shape),
        *_scatter(case, shape),
        *_arms(case, shape),
        *_bent(case, shape),
    )


def _bent(case: Case, shape: Equilibrium) -> Iterator[Advice]:
    """Tell that a cantilever gives way far under what its arm pulls in the design."""
    pulls = np.abs(shape.arm_forces * np.cos(shape.arm_angles))
    for support, pull in zip(shape.support_number[shape.arm_supports - 1], pulls, strict=True):
        cantilever = case.supports.at(int(support) - 1).cantilever
        arm = None if cantilever is None else cantilever.arm
        if arm is None or arm.lateral is None or pull <= BENT * arm.lateral:
            continue
        yield _warning(
            "elastic cantilever",
            f"the heel at {case.line.support_in_words(int(support))} gives way by "
            f"{pull / arm.lateral:.2f} m under the {pull:.0f} N that its arm pulls sideways "
            f"(usual: at most {BENT:g} m)",
            "check supports.cantilever.arm.lateral (50 to 500 kN/m)",
        )
        return


def _warning(topic: str, text: str, cure: str) -> Advice:
    return Advice(topic, "warning", text, cure)


def _wire(name: str, wire: Wire) -> Iterator[Advice]:
    """Tell that mass, EA and EI of a wire do not belong to one wire."""
    kind = "contact" if wire.role == "contact" else "other"
    path, stiffness = f"wires.{name}", wire.axial_stiffness
    low, high = STIFFNESS_PER_MASS[kind]
    if not low <= stiffness / wire.mass <= high:
        area = wire.mass / COPPER
        yield _warning(
            f"wire {name}",
            f"EA of {1e-6 * stiffness:.3g} MN and {wire.mass:g} kg/m hardly belong to one wire: as "
            f"copper it would have {1e6 * area:.0f} mm2 and {1e-9 * stiffness / area:.0f} GPa "
            f"(usual: EA over mass of {1e-6 * low:g} to {1e-6 * high:g} MN m/kg, here "
            f"{1e-6 * stiffness / wire.mass:.1f})",
            f"check {path}.axial_stiffness and {path}.mass, or take both by name ({path}.use)",
        )
    solid = stiffness * wire.mass / COPPER / (4.0 * math.pi)
    low, high = BENDING_OF_SOLID[kind]
    if not low * solid <= wire.bending_stiffness <= high * solid:
        yield _warning(
            f"wire {name}",
            f"EI of {wire.bending_stiffness:g} N m2 is {wire.bending_stiffness / solid:.2f} times "
            f"that of a solid copper wire with the same EA and mass, {solid:.0f} N m2 (usual: "
            f"{low:g} to {high:g} times)",
            f"check {path}.bending_stiffness, axial_stiffness and mass, or take all by name "
            f"({path}.use)",
        )


def _staggers(case: Case) -> Iterator[Advice]:
    """Tell that the wire stays on one side of straight track."""
    sides = np.sign(case.supports.contact_staggers(case.line.spans + 1))
    turning = alignment(case.track, case.line).plan_curvature(case.line.support_positions())
    sides[np.abs(turning) > _CURVED] = 0.0
    first = 1
    for side, same in groupby(sides.tolist()):
        count = len(list(same))
        if side and count >= SAME_SIDE:
            yield _warning(
                "stagger",
                f"supports {first} to {first + count - 1} have their stagger on the same side of "
                f"straight track (usual: alternating, at most {SAME_SIDE - 1} in a row); the wire "
                "wears one place of the strips",
                "alternate the signs of supports.contact_stagger, or give one value",
            )
        first += count


def _bodies(case: Case) -> Iterator[Advice]:
    """Tell that a body bends a contact wire between the places that hold it.

    A string under the tension T sags by ``P a b/(T (a + b))`` under the force P at distances a and
    b from where it is held; P is what a body weighs more than the wire in its place.
    """
    if not case.bodies:
        return
    line = expand(case)
    for body in line.bodies:
        run = line.by_name[body.run]
        if run.role != "contact":
            continue
        held = line.holding_points(run)
        left = max((s for s in held if s <= body.start), default=run.start.s)
        right = min((s for s in held if s >= body.end), default=run.end.s)
        a, b = (0.5 * (body.start + body.end) - end for end in (left, right))
        wire = run.wire.mass * (body.end - body.start)
        force = (total_mass(line, body) - wire) * case.line.gravity
        dip = -force * a * b / (run.wire.tension * (a - b)) if a > b else 0.0
        if dip > DIP:
            yield _warning(
                "body",
                f"{body.name!r} in {body.run!r} at {body.start:.2f} m pulls the contact wire down "
                f"by {1e3 * dip:.0f} mm between the droppers or supports beside it, {-b:.1f} m and "
                f"{a:.1f} m away (usual: at most {1e3 * DIP:g} mm)",
                "hang it on droppers at its ends, or check its mass (bodies)",
            )


def _stays(case: Case) -> Iterator[Advice]:
    """Tell that a stay of a contact wire leads below it, where pantographs pass."""
    heights, wires = case.supports.contact_heights(case.line.spans + 1), dict(case.wires.named())
    for number, stay in enumerate(case.stays, 1):
        wire = wires[stay.wire]
        lowest = min(heights[stay.span - 1 : stay.span + 1])
        if wire.role == "contact" and stay.end_z < lowest:
            yield _warning(
                "stay",
                f"{stay.name!r} leads from the contact wire in span {stay.span}, at {lowest:g} m, "
                f"down to {stay.end_z:g} m: pantographs that pass the wire meet it",
                f"put its far end higher than the wire (stays[{number}].end_z)",
            )


def _rounded_presag(case: Case) -> Iterator[Advice]:
    """Tell that rounding of the pre-sag decides the dropper forces."""
    spans = case.line.spans
    for one in case.dropper_sets:
        if one.mode != "height" or one.about != "span" or not _is_rounded(one, spans):
            continue
        wire = dict(case.wires.named())[one.lower]
        rows, lengths = one.positions_by_span(spans), case.line.span_lengths()
        effects = [
            (*_effect(wire, case.line.gravity, gaps), span, number)
            for span, (row, length) in enumerate(zip(rows, lengths, strict=True), 1)
            for number, gaps in enumerate(_gaps(row, length), 1)
        ]
        share, force, span, number = max(effects, key=lambda effect: round(effect[0], 9))
        if share > ROUNDED_SHARE:
            yield _warning(
                "pre-sag",
                f"the pre-sags are whole millimetres, and half a millimetre more or less changes "
                f"the force of dropper {number} of {case.line.span_in_words(span)} by "
                f"{force:.0f} N, {100 * share:.0f} % of the wire it carries (usual: at most "
                f"{100 * ROUNDED_SHARE:g} %): its neighbours are close",
                "give droppers.presag to a hundredth of a millimetre, or droppers.lengths",
            )


def _is_rounded(one: Droppers, spans: int) -> bool:
    values = np.array([value for row in one.presag_by_span(spans) for value in row])
    steps = values / ROUNDED
    return bool(values.any() and np.abs(steps - np.round(steps)).max() < 1e-6)


def _gaps(row: Sequence[float], length: float) -> list[tuple[float, float]]:
    """Return the distances of each dropper of a span from what holds the wire on both sides."""
    gaps = [right - left for left, right in pairwise((0.0, *row, length))]
    return list(pairwise(gaps))


def _effect(wire: Wire, gravity: float, gaps: tuple[float, float]) -> tuple[float, float]:
    """Return what half a rounding step moves a dropper's force by, over its load and in N.

    A string under the tension T that is lifted by z at distances a and b from its neighbours pulls
    with ``T z (1/a + 1/b)``; a dropper carries half of the wire on both sides.
    """
    force = 0.5 * ROUNDED * wire.tension * (1.0 / gaps[0] + 1.0 / gaps[1])
    return force / (0.5 * wire.mass * gravity * sum(gaps)), force


def _heights(case: Case, shape: Equilibrium) -> Iterator[Advice]:
    """Tell that the wire does not hang where it was to hang; raised wires are left out."""
    if case.tension_lengths:
        return
    given = np.array(case.supports.contact_heights(case.line.spans + 1))
    off = shape.support_heights - given[shape.support_number - 1]
    worst = int(np.abs(off).argmax())
    if abs(off[worst]) > HEIGHT_OFF:
        side = "above" if off[worst] > 0 else "below"
        cure = "check supports.closure and what it is given"
        if not len(shape.dropper_x):
            cure = _ALONE
        yield _warning(
            "height of the wire",
            f"the contact wire lies {abs(off[worst]):.2f} m {side} supports.contact_height at "
            f"{case.line.support_in_words(int(shape.support_number[worst]))} (usual: within "
            f"{HEIGHT_OFF:g} m)",
            cure,
        )


def _slack(case: Case, shape: Equilibrium) -> Iterator[Advice]:
    """Name droppers that carry nothing at rest."""
    slack = np.flatnonzero(shape.dropper_forces < SLACK)
    if len(slack):
        names = [
            f"dropper {shape.dropper_number[i]} of "
            f"{case.line.span_in_words(int(shape.dropper_span[i]))}"
            for i in slack
        ]
        yield _warning(
            "slack droppers",
            f"{len(slack)} of {len(shape.dropper_forces)} droppers carry nothing at rest (usual: "
            f"none): {_listed(names)}",
            "check their lengths (droppers.lengths) against their neighbours'",
        )


def _scatter(case: Case, shape: Equilibrium) -> Iterator[Advice]:
    """Tell that the dropper forces of a span are far apart.

    Raised wires hang on a dropper of their own and are left out; rounded pre-sag is told by itself.
    """
    if case.tension_lengths or any(_rounded_presag(case)):
        return
    worst = (SCATTER, 0, 0.0, 0.0)
    for span in np.unique(shape.dropper_span).tolist():
        forces = shape.dropper_forces[shape.dropper_span == span]
        taut = forces[forces >= SLACK]
        if len(taut) > 2:
            low, high = float(taut.min()), float(taut.max())
            worst = max(worst, (high / low, span, low, high))
    ratio, span, low, high = worst
    if span:
        yield _warning(
            "dropper forces",
            f"the dropper forces of {case.line.span_in_words(span)} range from {low:.1f} to "
            f"{high:.1f} N, 1 to {ratio:.1f} (usual: up to 1 to {SCATTER:g})",
            "check droppers.presag or droppers.lengths there; a millimetre at droppers close to "
            "each other is worth tens of newtons",
        )


def _arms(case: Case, shape: Equilibrium) -> Iterator[Advice]:
    """Name steady arms that carry more of the wire than usual, and others that stand unusually."""
    share, degrees = arm_shares(case, shape), np.degrees(shape.arm_angles)
    number = shape.support_number[shape.arm_supports - 1]
    much, (low, high) = share > ARM_SHARE, ARM_ANGLE
    if much.any():
        yield _warning(
            "steady arms",
            f"{much.sum()} of {len(share)} carry more than {ARM_SHARE:g} of the contact wire "
            "between the droppers beside them (usual: 0 to 0.5): "
            f"{_at_supports(case, share[much], number[much], '', 2)}; they stand at "
            f"{_range(degrees[much], '°', 1)} (usual: 6 to 16°). Arms that carry the wire take 10 "
            "to 45 % off the uplift",
            "use supports.closure 'lift' with the share that is built (supports.share)",
        )
    odd = ~much & ((degrees < low) | (degrees > high))
    if odd.any():
        yield _warning(
            "steady arms",
            f"{odd.sum()} of {len(degrees)} stand outside {low:g} to {high:g}° (usual: 6 to 16°, "
            "about 1° where they carry only themselves): "
            f"{_at_supports(case, degrees[odd], number[odd], '°', 1)}",
            _ALONE
            if not len(shape.dropper_x)
            else "check the heights and staggers beside these supports (supports.contact_height, "
            "supports.contact_stagger) and supports.arm",
        )


def arm_shares(case: Case, shape: Equilibrium) -> Array:
    """Return the share of the wire that each steady arm carries, ``(n_arm,)``.

    The vertical force of the arm on the wire, its own half weight deducted, over the weight of the
    contact wire from the dropper before to the dropper behind it; NaN without droppers on both
    sides.
    """
    masts = shape.support_number[shape.arm_supports - 1] - 1
    arms = [case.supports.at(mast).arm for mast in masts.tolist()]
    hanging = np.array([0.5 * arm.mass * arm.length for arm in arms]) * case.line.gravity
    lift = shape.arm_forces * np.sin(shape.arm_angles) - hanging
    runs = expand(case).by_name
    found = np.full(len(lift), np.nan)
    for number, row in enumerate(shape.arm_supports - 1):
        wire = int(shape.support_wire[row])
        own = shape.dropper_x[shape.dropper_wires[:, 1] == wire]
        before, behind = own[own < shape.support_x[row]], own[own > shape.support_x[row]]
        if len(before) and len(behind):
            mass = runs[shape.wire_names[wire]].wire.mass
            weight = mass * case.line.gravity * (behind.min() - before.max())
            found[number] = lift[number] / weight
    return found


def _range(values: Array, unit: str, digits: int) -> str:
    low, high = (f"{value:.{digits}f}" for value in (values.min(), values.max()))
    return f"{low}{unit}" if low == high else f"{low} to {high}{unit}"


def _at_supports(
    case: Case, values: Array, numbers: NDArray[np.int64], unit: str, digits: int
) -> str:
    """Name values one by one, or their range where there are many."""
    if len(values) <= _NAMED:
        told = [
            f"{value:.{digits}f}{unit} at {case.line.support_in_words(number)}"
            for value, number in zip(values, numbers.tolist(), strict=True)
        ]
        return ("; " if case.line.place_of_support(0) else ", ").join(told)
    return f"{_range(values, unit, digits)} at supports {numbers.min()} to {numbers.max()}"


def _listed(names: Sequence[str]) -> str:
    shown = ", ".join(names[:_NAMED])
    return shown if len(names) <= _NAMED else f"{shown} and {len(names) - _NAMED} more"
