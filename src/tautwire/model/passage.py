"""When and where the pantographs enter the line, and how long the passage lasts."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tautwire.errors import ModelError
from tautwire.model.build import Model
from tautwire.model.irregularity import surface_profile
from tautwire.numerics.motion.pantograph import PantographChain
from tautwire.numerics.motion.stepper import PantographInput, RoofMotion
from tautwire.results.equilibrium import Equilibrium
from tautwire.specs.case import Case
from tautwire.specs.pantograph import Air, Pantograph

Array = NDArray[np.float64]

LOWERED = 1.0
"""Distance of a lowered pantograph from the wire at the start [m]."""

ROOM_AT_END = 0.1
"""Distance from the far end that no pantograph passes [m]: a weighted end moves by centimetres."""

_POINTS_PER_SPAN = 101
"""Points over which the height of a span is averaged; the mean of 55 mm of sag is 0.1 mm off."""

_LOOKS = 0.5
"""Distance between the places where wires are sought on the heads [m]: one that runs 2 m aside over
a span of 50 m moves by 2 cm."""

_CLEAR = 2.0
"""Distance of the first place under a wire from the last one that it misses, less than a metre more
or less [m]."""

BASE_SPRING_SHARE = 0.05
"""Share of the mean force beyond which the base spring's part in it is told."""


@dataclass(frozen=True, eq=False)
class Passage:
    """The plan of one passage.

    Attributes
    ----------
    pantographs : tuple of PantographInput
    uplift_forces : tuple of float N
        One per pantograph.
    duration : float s
        Until the leading pantograph has reached the far end of the line.
    latest : float s
        Until when it is on the modelled wire: a last step may not go beyond.
    warnings : tuple of str
    """

    pantographs: tuple[PantographInput, ...]
    uplift_forces: tuple[float, ...]
    duration: float
    latest: float
    warnings: tuple[str, ...] = ()


def plan_passage(model: Model, shape: Equilibrium, forces: Sequence[float]) -> Passage:
    """Plan the passage of all pantographs of the case.

    Each pantograph enters at the same place, at rest and just touching the wire in its static
    position, when the train has brought it there: ``settings.start`` from the anchor, or further
    where the wires of the end spans leave the heads sideways to their anchors. One without
    uplift force is lowered and does not touch the wire. The spring on the roof carries nothing
    when the head is at the working height, wherever the line begins.

    Parameters
    ----------
    model
        The line.
    shape
        Its static state.
    forces : (n_pantograph,) N
        Uplift force of each pantograph.

    Raises
    ------
    ModelError
        When the line is too short for the last pantograph to cross the analysed section, or the
        wire lies beside a head in the section.
    """
    case = model.case
    length = case.line.length()
    sign = 1.0 if case.scenario.direction == "+x" else -1.0
    (left, right), told = _ends(model, shape)
    start, end = (left, right) if sign > 0 else (right, left)
    start_x = start if sign > 0 else length - start
    duration = (length - start - end) / case.scenario.speed
    _check_length(model, start, end)
    height = float(shape.running_height(np.array(start_x)))
    surface = surface_profile(model.irregularities)
    height += 0.0 if surface is None else float(surface.at(np.array(start_x)))
    running = _running_heights(model, shape)
    inputs = tuple(
        PantographInput(
            chain=_chain(spec),
            start_time=spec.behind / case.scenario.speed,
            start_x=start_x,
            start_height=height if force > 0.0 else height - LOWERED,
            velocity=sign * case.scenario.speed,
            stage_forces=_stage_forces(spec, force, case.scenario.air, height, running),
            ramp=case.settings.ramp,
            roof=_roof(spec),
            surface=surface,
            reach=0.5 * spec.head_length,
            track=model.line.track,
        )
        for spec, force in zip(case.pantographs, forces, strict=True)
    )
    warnings = told + [
        text
        for spec, force in zip(case.pantographs, forces, strict=True)
        for text in _base_spring_warning(spec, force, running)
    ]
    latest = (length - start - ROOM_AT_END) / case.scenario.speed
    return Passage(inputs, tuple(forces), duration, latest, tuple(warnings))


def working_height(model: Model, shape: Equilibrium) -> float:
    """Return the working height of a pantograph that has none of its own [m].

    Parameters
    ----------
    model
        The line.
    shape
        Its static state.
    """
    return float(_running_heights(model, shape).mean())


def _running_heights(model: Model, shape: Equilibrium) -> Array:
    """Return the static height of the contact wire, averaged over each analysed span [m].

    The sag inside the spans, which repeats and belongs to the design, is averaged out.
    """
    first, last = model.case.resolved_section()
    supports = np.array(model.case.line.support_positions()[first - 1 : last + 1])
    at = np.linspace(supports[:-1], supports[1:], _POINTS_PER_SPAN)
    return shape.running_height(at).mean(axis=0)


def _stage_forces(spec: Pantograph, uplift: float, air: Air, start: float, running: Array) -> Array:
    """Return what acts on the stages of a raised pantograph, ``(n_stage,)`` [N].

    The base spring of the equations counts from the start, so its force there, with the head at
    ``start`` instead of the working height, is given as a load.
    """
    forces = np.zeros(len(spec.stages))
    if uplift == 0.0:
        return forces
    forces += spec.stage_forces(air)
    forces[spec.lifted_stage()] += uplift
    working = float(running.mean()) if spec.working_height is None else spec.working_height
    forces[-1] -= spec.stages[-1].stiffness * (start - working)
    return forces


def _base_spring_warning(spec: Pantograph, uplift: float, running: Array) -> Iterator[str]:
    """Tell that heights and base spring together change the mean force noticeably."""
    stiffness, spread = spec.stages[-1].stiffness, float(np.ptp(running))
    if stiffness * spread > BASE_SPRING_SHARE * uplift > 0.0:
        yield (
            f"pantograph {spec.name!r}: the spring on its roof ({stiffness:g} N/m) changes the "
            f"contact force by {stiffness * spread:.1f} N over the {1e3 * spread:.0f} mm between "
            "the lowest and the highest span of the analysed section, more than "
            f"{100 * BASE_SPRING_SHARE:g} % of the uplift force of {uplift:.1f} N; a real "
            "pantograph lifts almost evenly over its working range: check the stiffness of its "
            "last stage (most lie between 0 and 200 N/m)"
        )


def _chain(spec: Pantograph) -> PantographChain:
    return PantographChain(
        mass=np.array([s.mass for s in spec.stages]),
        stiffness=np.array([s.stiffness for s in spec.stages]),
        damping=np.array([s.damping for s in spec.stages]),
    )


def _roof(spec: Pantograph) -> RoofMotion | None:
    if spec.roof_motion is None:
        return None
    return RoofMotion(np.array(spec.roof_motion.time), np.array(spec.roof_motion.height))


def _ends(model: Model, shape: Equilibrium) -> tuple[tuple[float, float], list[str]]:
    """Return how near to the left and right ends of the line a passage comes [m]; what to tell.

    Raises
    ------
    ModelError
        Where no contact wire lies on a head in or beside the analysed section.
    """
    case = model.case
    start, length = case.settings.start, case.line.length()
    s = np.linspace(start, length - start, 1 + math.ceil(length / _LOOKS))
    beside = np.min(
        [
            np.abs(np.interp(s, wire.s, wire.position[:, 1], left=np.inf, right=np.inf))
            for wire in shape.of_role("contact")
        ],
        axis=0,
    )
    shortest = min(case.pantographs, key=lambda pantograph: pantograph.head_length)
    missed = s[beside > 0.5 * shortest.head_length]
    if not missed.size:
        return (start, start), []
    worst = int(np.argmax(beside))
    span = int(np.clip(np.searchsorted(model.line.masts, s[worst]), 1, case.line.spans))
    told = (
        f"the contact wire leaves the head of pantograph {shortest.name!r} sideways: in span "
        f"{span}, x = {s[worst]:.1f} m, it lies {beside[worst]:.2f} m from the middle of the "
        f"track, and half the head is {0.5 * shortest.head_length:g} m"
    )
    ends = _inner_ends(case, missed)
    if ends is None:
        raise ModelError(
            f"{told}; change the stagger there (supports.contact_stagger; in a curve the wires run "
            "inside the arc between supports), make the spans shorter (line.span_length) or give "
            "the head its length (pantographs.head_length)"
        )
    kept = f"the passage keeps {ends[0]:g} m from the left end and {ends[1]:g} m from the right one"
    return ends, [f"{told}; {kept}", *_short_ramp(case, ends)]


def _inner_ends(case: Case, missed: Array) -> tuple[float, float] | None:
    """Return how near to the ends no head misses a wire [m]; None if the section is in the way.

    Parameters
    ----------
    case
    missed : (n,) m
        Places where the wire does not lie on the head.
    """
    length, x = case.line.length(), case.line.support_positions()
    first, last = case.resolved_section()
    is_before, is_behind = missed < x[first - 1], missed > x[last]
    aside = missed[is_before], length - missed[is_behind]
    left, right = (
        math.floor(way.max()) + _CLEAR if way.size else case.settings.start for way in aside
    )
    is_clear = left <= x[first - 1] and right <= length - x[last]
    return (left, right) if is_clear and np.all(is_before | is_behind) else None


def _short_ramp(case: Case, ends: tuple[float, float]) -> Iterator[str]:
    """Tell that the uplift force grows into the analysed section from where the passage begins."""
    first, last = case.resolved_section()
    x = case.line.support_positions()
    forward = case.scenario.direction == "+x"
    way = x[first - 1] - ends[0] if forward else x[-1] - x[last] - ends[1]
    ramp = case.settings.ramp * case.scenario.speed
    if way < ramp:
        yield (
            f"the analysed section begins {way:.0f} m after this start, and the uplift force grows "
            f"over {ramp:.0f} m (settings.ramp {case.settings.ramp:g} s); begin the section later "
            "(settings.section), add spans, or shorten settings.ramp"
        )


def _check_length(model: Model, start: float, end: float) -> None:
    """Refuse a line that ends before the last pantograph has crossed the analysed section.

    The end of the line, which no passage reaches, is left out.
    """
    case = model.case
    first, last = case.resolved_section()
    x = case.line.support_positions()
    forward = case.scenario.direction == "+x"
    way = x[last] if forward else x[-1] - x[first - 1]
    way = min(way, x[-1] - start)
    behind = case.pantographs[-1].behind
    reached = x[-1] - end - behind
    if reached < way - 1e-9:
        raise ModelError(
            f"the line is too short: when the leading pantograph reaches its end, pantograph "
            f"{case.pantographs[-1].name!r}, {behind:g} m behind, is still "
            f"{way - reached:.0f} m inside the analysed section (spans {first} to {last}); "
            "add spans (line.spans) or end the section earlier (settings.section)"
        )
