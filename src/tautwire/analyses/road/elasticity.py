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
from tautwire.numerics.elements.hermite import position_row
from tautwire.numerics.statics.loaded_line import StaticSolver
from tautwire.results.equilibrium import Elasticity, Equilibrium
from tautwire.status import Status

Array = NDArray[np.float64]


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
    on the contact wire. The points cover the analysed section, its last support included.

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


def _flexibility(shape: Equilibrium, solver: StaticSolver, point: _Point, force: float) -> float:
    """Return uplift per force at one point [m/N]."""
    wire = shape.contact
    element = wire.element(np.array(point.x))
    xi = (point.x - wire.s[element]) / (wire.s[element + 1] - wire.s[element])
    row = position_row(xi, wire.lengths[element])
    dofs = wire.dofs(element, 2)
    load = np.zeros(len(shape.position))
    load[dofs] = force * row
    response = solver.solve(load)
    if response.status is not Status.DONE:
        raise ConvergenceError(
            f"elasticity at {point.kind} {point.index or ''} of span {point.span}, "
            f"x = {point.x:.2f} m, {force:g} N: {response.status.sentence} "
            "Try a smaller settings.elasticity_force."
        )
    uplift = row @ (response.position[dofs] - shape.position[dofs])
    return float(uplift / force)
