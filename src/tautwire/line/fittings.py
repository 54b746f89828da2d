"""Bodies and stays on wires: where they are, and what a wire is made of there."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tautwire.line.pieces import BESIDE, At, Body, Line, Run, WireStay
from tautwire.numerics.network.parts import BOTH_WAYS, COMPRESSION_ONLY, TENSION_ONLY
from tautwire.specs.case import Case
from tautwire.specs.line.fitting import Body as BodySpec
from tautwire.specs.line.fitting import Fitting, Stay

LAWS = {"rope": TENSION_ONLY, "bar": BOTH_WAYS, "strut": COMPRESSION_ONLY}

Array = NDArray[np.float64]

TOUCHING = 1e-6
"""Distance below which the end of a body is at an attachment [m]: places are given to millimetres,
and sums of them are rounded."""


def with_fittings(line: Line, case: Case) -> tuple[Line, list[str]]:
    """Return a line with bodies and stays on its wires, and a sentence for each without a place.

    Parameters
    ----------
    line
        Without any.
    case
        What it has.
    """
    bodies: list[Body] = []
    stays: list[WireStay] = []
    problems = []
    for number, body in enumerate(case.bodies, 1):
        run, ends, fault = _place(line, body, 0.5 * body.length)
        fault = fault or (_on_another(bodies, run, ends) if run is not None else "")
        if fault:
            problems.append(f"bodies[{number}] ({body.name}): {fault}")
        elif run is not None:
            bodies.append(_body(run, body, ends))
    for number, stay in enumerate(case.stays, 1):
        run, ends, fault = _place(line, stay, 0.0)
        if fault:
            problems.append(f"stays[{number}] ({stay.name}): {fault}")
        elif run is not None:
            stays.append(_stay(run, stay, ends[0]))
    if not bodies and not stays:
        return line, problems
    bodies.sort(key=lambda body: body.start)
    stays.sort(key=lambda stay: stay.at.s)
    return replace(line, bodies=tuple(bodies), stays=tuple(stays)), problems


def _place(line: Line, spec: Fitting, half: float) -> tuple[Run | None, tuple[float, float], str]:
    """Return the run and the ends of what sits on a wire, or what is wrong with its place."""
    middle = line.masts[spec.span - 1] + spec.at
    ends = (middle - half, middle + half)
    runs = [
        run
        for run in line.runs
        if run.wire_name == spec.wire
        and run.tension_length == (spec.tension_length or run.tension_length)
        and run.start.s < ends[0]
        and ends[1] < run.end.s
    ]
    if len(runs) != 1:
        which = "several tension lengths have a" if runs else "there is no"
        where = f"from {ends[0]:g} m to {ends[1]:g} m" if half else f"at {middle:g} m"
        text = f"{which} wire {spec.wire!r} {where}; name wire, tension_length, span and at"
        return None, ends, text
    start, end = (_touching(line.points(runs[0].name), s) for s in ends)
    faults = (_too_close(line, runs[0], s) for s in (start, end))
    return runs[0], (start, end), next(filter(None, faults), "")


def _on_another(bodies: Iterable[Body], run: Run, ends: tuple[float, float]) -> str:
    for other in bodies:
        if other.run == run.name and ends[0] < other.end and other.start < ends[1]:
            return (
                f"lies on {other.name!r} of the same wire, {other.start:g} m to {other.end:g} m; "
                "move one of them (at)"
            )
    return ""


def _stay(run: Run, spec: Stay, s: float) -> WireStay:
    end = (spec.end_along, spec.end_y, spec.end_z)
    pull = -spec.force if spec.law == "strut" else spec.force
    law = LAWS[spec.law]
    return WireStay(spec.name, At(run.name, s), end, law, spec.stiffness, spec.slack, pull)


def _touching(points: list[float], s: float) -> float:
    nearest = min(points, key=lambda point: abs(point - s))
    return nearest if abs(nearest - s) < TOUCHING else s


def _too_close(line: Line, run: Run, s: float) -> str:
    near = [p for p in line.points(run.name) if 0.0 < abs(p - s) < BESIDE]
    if not near:
        return ""
    mast = max(index for index, place in enumerate(line.masts) if place <= near[0])
    return (
        f"its end at {s:.4f} m is {1e3 * abs(near[0] - s):.0f} mm beside something else on the "
        f"wire, at {near[0]:.4f} m (span {mast + 1}, {near[0] - line.masts[mast]:.4f} m from the "
        f"left); put it there or {1e3 * BESIDE:.0f} mm away, with at or length"
    )


def _body(run: Run, spec: BodySpec, ends: tuple[float, float]) -> Body:
    wire, length = run.wire, ends[1] - ends[0]
    axial = wire.axial_stiffness if spec.axial_stiffness is None else spec.axial_stiffness
    bending = wire.bending_stiffness if spec.bending_stiffness is None else spec.bending_stiffness
    mass = wire.mass
    if spec.mass is not None and length > 0.0:
        mass = spec.mass / length * (1.0 + wire.tension / axial)
    lump = spec.end_mass if length > 0.0 else 0.5 * (spec.mass or 0.0)
    return Body(spec.name, run.name, ends[0], ends[1], mass, lump, axial, bending)


@dataclass(frozen=True, eq=False)
class Sections:
    """What the elements of a run are made of.

    Attributes
    ----------
    axial, bending, mass : (n_element,) N, N m2, kg/m
    is_body : (n_element,) bool
    """

    axial: Array
    bending: Array
    mass: Array
    is_body: NDArray[np.bool_]


def sections(line: Line, run: Run, s: Array) -> Sections:
    """Return what a run is made of, element by element.

    Parameters
    ----------
    line
    run
    s : (n_element + 1,) m
        Places of its nodes, with nodes at the ends of bodies.
    """
    count, wire = len(s) - 1, run.wire
    found = Sections(
        np.full(count, wire.axial_stiffness),
        np.full(count, wire.bending_stiffness),
        np.full(count, wire.mass),
        np.zeros(count, dtype=bool),
    )
    middle = 0.5 * (s[1:] + s[:-1])
    for body in on_run(line, run):
        inside = (body.start < middle) & (middle < body.end)
        found.axial[inside], found.bending[inside] = body.axial, body.bending
        found.mass[inside], found.is_body[inside] = body.mass, True
    return found


def on_run(line: Line, run: Run) -> Iterator[Body]:
    """Yield the bodies of a run from left to right."""
    yield from (body for body in line.bodies if body.run == run.name)


def lumps(line: Line) -> Iterator[tuple[At, float]]:
    """Yield where bodies put masses on wires [kg]: at both ends, which may be one place."""
    for body in line.bodies:
        yield At(body.run, body.start), body.end_mass
        yield At(body.run, body.end), body.end_mass


def total_mass(line: Line, body: Body) -> float:
    """Return the mass of a body with its clamps [kg]."""
    unstrained = (body.end - body.start) / (1.0 + line.by_name[body.run].wire.tension / body.axial)
    return body.mass * unstrained + 2.0 * body.end_mass
