"""Elasticity: static uplift of the contact wire per vertical force."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.threads import single_threaded
from tautwire.errors import ConvergenceError, ModelError
from tautwire.line.measures import droppers_of_spans
from tautwire.model.build import Model
from tautwire.model.equations import equations
from tautwire.numerics.statics.loaded_line import StaticSolver
from tautwire.results.equilibrium import Elasticity, Equilibrium, WirePoints
from tautwire.status import Status

Array = NDArray[np.float64]

TOGETHER = 0.02
"""Contact wires within this height of the lowest are lifted with it [m]."""

_LEVEL, _LEVELLINGS = 1e-7, 20
"""Difference of heights [m] at which wires under one head are level, and most attempts."""


@single_threaded
def elasticity(
    model: Model,
    shape: Equilibrium,
    *,
    force: float | None = None,
    watch: Callable[[int, int], None] | None = None,
) -> Elasticity:
    """Compute the elasticity at supports, droppers and midway between them.

    Every point is a static solve of the nonlinear line (droppers go slack) with a vertical force
    on the contact wire. The points cover the analysed section, its last support included. Several
    contact wires at one height are lifted by one rigid head.

    Parameters
    ----------
    model
        The line.
    shape
        Its static state.
    force
        Vertical force [N]; ``settings.elasticity_force`` by default.
    watch
        Called before every point with its number (from 0) and the number of points; what it
        raises ends the computation.

    Returns
    -------
    Elasticity

    Raises
    ------
    ModelError
        When nothing holds the line in its shape.
    ConvergenceError
        When the static state under the force is not found; the point is named.
    """
    force = model.case.settings.elasticity_force if force is None else force
    solver = _solver(model, shape)
    points = _points(model)
    values = []
    for number, point in enumerate(points):
        if watch is not None:
            watch(number, len(points))
        values.append(_flexibility(shape, solver, point, force))
    return Elasticity(
        force=force,
        span=np.array([p.span for p in points]),
        kind=tuple(p.kind for p in points),
        index=np.array([p.index for p in points]),
        x=np.array([p.x for p in points]),
        elasticity=np.array(values),
    )


def _solver(model: Model, shape: Equilibrium) -> StaticSolver:
    try:
        return StaticSolver(equations(model, shape))
    except ValueError:
        raise ModelError(f"elasticity: {Status.SINGULAR.sentence} {Status.SINGULAR.cure}") from None


@dataclass(frozen=True)
class _Point:
    span: int
    kind: str
    index: int
    x: float


def _points(model: Model) -> list[_Point]:
    """Return the points of the analysed section from left to right."""
    first, last = model.case.resolved_section()
    masts, droppers = model.line.masts, droppers_of_spans(model.line)
    points = []
    for span in range(first, last + 1):
        left, right = masts[span - 1], masts[span]
        ends = np.concatenate([[left], left + np.array(droppers[span - 1]), [right]])
        points.append(_Point(span, "support", 0, float(left)))
        for number, x in enumerate(ends[:-1]):
            if number:
                points.append(_Point(span, "dropper", number, float(x)))
            middle = 0.5 * (x + ends[number + 1])
            points.append(_Point(span, "middle", number, float(middle)))
    points.append(_Point(last + 1, "support", 0, float(masts[last])))
    held = {1, model.case.line.spans + 1}
    return [p for p in points if not (p.kind == "support" and p.span in held)]


def _pressed(shape: Equilibrium, x: float) -> WirePoints:
    """Return the wires that a head touches: the lowest, and those at about its height."""
    level = float(shape.running_height(np.array(x)))
    points = [
        shape.points(wire, np.array([x]))
        for wire in shape.of_role("contact")
        if wire.s[0] <= x <= wire.s[-1]
    ]
    near = [point for point in points if point.heights(shape.position)[0] <= level + TOGETHER]
    return WirePoints.joined(near)


def _flexibility(shape: Equilibrium, solver: StaticSolver, point: _Point, force: float) -> float:
    """Return uplift per force at one point [m/N].

    Several wires are lifted by one rigid head: their heights become equal, and their shares of the
    force follow, by Broyden's method from the flexibility with all droppers taut.
    """
    wires = _pressed(shape, point.x)
    count = len(wires.rows)
    rest = wires.heights(shape.position)
    shares = np.full(count, force / count)
    heights = _lifted(wires, solver, shares, point)
    flexibility = _linear_flexibility(wires, solver) if count > 1 else np.zeros((1, 1))
    for _ in range(_LEVELLINGS):
        if np.ptp(heights) <= _LEVEL:
            return float((heights.mean() - rest.mean()) / force)
        change = _levelling(flexibility, heights)
        moved = _lifted(wires, solver, shares + change, point)
        error = moved - heights - flexibility @ change
        flexibility = flexibility + np.outer(error, change) / (change @ change)
        shares, heights = shares + change, moved
    raise ConvergenceError(
        f"elasticity at {_named(point)}: the contact wires under the head do not come level. "
        "Try a smaller settings.elasticity_force."
    )


def _named(point: _Point) -> str:
    return f"{point.kind} {point.index or ''} of span {point.span}, x = {point.x:.2f} m"


def _lifted(wires: WirePoints, solver: StaticSolver, shares: Array, point: _Point) -> Array:
    """Return the heights of the wires under forces on them, ``(n,)`` [m]."""
    response = solver.solve(wires.load(shares, solver.size))
    if response.status is not Status.DONE:
        raise ConvergenceError(
            f"elasticity at {_named(point)}, {shares.sum():g} N: {response.status.sentence} "
            "Try a smaller settings.elasticity_force."
        )
    return wires.heights(response.position)


def _linear_flexibility(wires: WirePoints, solver: StaticSolver) -> Array:
    """Return how the heights follow small forces with all droppers taut, ``(n, n)`` [m/N]."""
    units = np.eye(len(wires.rows))
    columns = [wires.values(solver.linear(wires.load(unit, solver.size))) for unit in units]
    return np.stack(columns, axis=1)


def _levelling(flexibility: Array, heights: Array) -> Array:
    """Return changes of the forces, zero in sum, that make the heights equal, linearly [N]."""
    count = len(heights)
    border = np.ones((count + 1, count + 1))
    border[:count, :count] = flexibility
    border[:count, -1], border[-1, -1] = -1.0, 0.0
    change: Array = np.linalg.solve(border, np.append(-heights, 0.0))[:count].astype(np.float64)
    return change
