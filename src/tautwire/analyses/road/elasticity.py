"""Elasticity: static uplift of the contact wire per vertical force."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.threads import single_threaded
from tautwire.errors import ConvergenceError, ModelError
from tautwire.line.measures import droppers_of_spans
from tautwire.model.build import Model
from tautwire.model.equations import equations
from tautwire.numerics.statics.loaded_line import LoadedLine
from tautwire.numerics.statics.window import Push, Window
from tautwire.results.equilibrium import Elasticity, Equilibrium, WirePoints
from tautwire.status import Status

Array = NDArray[np.float64]

TOGETHER = 0.02
"""Contact wires within this height of the lowest are lifted with it [m]."""

SPANS_BESIDE = 0.5
"""Parts of the spans left and right of the one under the force in which droppers may go slack and
elements turn; the line beyond is linear. With a half, library lines under 100 N are within 5e-5 of
the line nonlinear everywhere, with the whole of both spans within 4e-6 at 1.2 to 1.7 times the
cost."""


@single_threaded
def elasticity(
    model: Model,
    shape: Equilibrium,
    *,
    force: float | None = None,
    watch: Callable[[int, int], None] | None = None,
) -> Elasticity:
    """Compute the elasticity at supports, droppers and midway between them.

    Every point is a static solve with a vertical force on the contact wire: nonlinear (droppers
    go slack) in the span of the force and half of those beside it, exact but linear beyond. The
    points cover the analysed section, its last support included. Several contact wires at one
    height are lifted by one rigid head: their heights are equal, their shares of the force follow.

    Parameters
    ----------
    model
        The line.
    shape
        Its static state.
    force
        Vertical force [N]; ``settings.elasticity_force`` by default.
    watch
        Called before the points of every span with the number of points done and of all points;
        what it raises ends the computation.

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
    line = _line(model, shape)
    points = _points(model)
    values = []
    last = model.case.resolved_section()[1]
    for span, group in groupby(points, lambda point: min(point.span, last)):
        if watch is not None:
            watch(len(values), len(points))
        window = line.window(*_nodes(model, shape, span))
        values += _flexibilities(shape, window, list(group), force)
    return Elasticity(
        force=force,
        span=np.array([p.span for p in points]),
        kind=tuple(p.kind for p in points),
        index=np.array([p.index for p in points]),
        x=np.array([p.x for p in points]),
        elasticity=np.array(values),
    )


def _line(model: Model, shape: Equilibrium) -> LoadedLine:
    try:
        return LoadedLine(equations(model, shape))
    except ValueError:
        raise ModelError(f"elasticity: {Status.SINGULAR.sentence} {Status.SINGULAR.cure}") from None


def _nodes(model: Model, shape: Equilibrium, span: int) -> tuple[int, int]:
    """Return the first node, and the one after the last, of a span and parts of those beside it."""
    masts, count = model.line.masts, len(shape.node_s)
    number = np.arange(len(masts))
    ends = np.interp([span - 1 - SPANS_BESIDE, span + SPANS_BESIDE], number, masts)
    first = 0 if ends[0] <= masts[0] else int(np.searchsorted(shape.node_s, ends[0]))
    last = count if ends[1] >= masts[-1] else int(np.searchsorted(shape.node_s, ends[1], "right"))
    return first, last


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


def _push(shape: Equilibrium, x: float, force: float) -> Push:
    """Return the push of a head on the wires it touches: the lowest and those at its height."""
    level = float(shape.running_height(np.array(x)))
    points = [
        shape.points(wire, np.array([x]))
        for wire in shape.of_role("contact")
        if wire.s[0] <= x <= wire.s[-1]
    ]
    touched = WirePoints.joined(
        [point for point in points if point.heights(shape.position)[0] <= level + TOGETHER]
    )
    count = len(touched.s)
    return Push(touched.dofs.reshape(count, 12), touched.press.reshape(count, 12), force)


def _flexibilities(
    shape: Equilibrium, window: Window, points: Sequence[_Point], force: float
) -> list[float]:
    """Return uplift per force at some points of one window [m/N]."""
    pushes = [_push(shape, point.x, force) for point in points]
    values = []
    for point, push, pushed in zip(points, pushes, window.respond(pushes), strict=True):
        if pushed.status is not Status.DONE:
            raise ConvergenceError(
                f"elasticity at {_named(point)}, {force:g} N: {pushed.status.sentence} "
                "Try a smaller settings.elasticity_force."
            )
        rest = push.heights(shape.position)
        values.append(float(pushed.heights.mean() - rest.mean()) / force)
    return values


def _named(point: _Point) -> str:
    return f"{point.kind} {point.index or ''} of span {point.span}, x = {point.x:.2f} m"
