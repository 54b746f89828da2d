"""The contact wires over the track under wind from either side, beside their estimates."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.road.elasticity import TOGETHER
from tautwire.analyses.road.operate import operate
from tautwire.errors import ConvergenceError, ModelError
from tautwire.formulas.lateral import Blown, lateral_position
from tautwire.line.pieces import Run
from tautwire.model.build import Model
from tautwire.model.operation.weather import wind_on
from tautwire.results.design.lateral import SIDES, LateralSweep, Side
from tautwire.results.equilibrium import Equilibrium
from tautwire.specs.conditions.condition import Condition
from tautwire.specs.requirements import Gauge

Array = NDArray[np.float64]


def lateral_sweep(model: Model, design: Equilibrium, gauge: Gauge) -> LateralSweep:
    """Find the line under wind from the right and from the left.

    Parameters
    ----------
    model
        The line.
    design
        Its design.
    gauge
        The wind, and the condition in which the line is otherwise.
    """
    x, wire = _points(design)
    states = [gauge.state(model.case.conditions, _from(side)) for side in SIDES]
    found = [_state(model, design, one) for one in states]
    position, height = np.full((2, len(x)), np.nan), np.full((2, len(x)), np.nan)
    for row, (shape, _) in enumerate(found):
        if shape is not None:
            sign = 1.0 if SIDES[row] == "left" else -1.0
            own = np.concatenate([w.position for w in shape.of_role("contact")])
            keep = _running(design)
            position[row], height[row] = sign * own[keep, 1], own[keep, 2]
    estimates = np.array([_estimates(model, one) for one in states])
    return LateralSweep(
        x=x,
        wire=wire,
        wire_names=tuple(w.name for w in design.of_role("contact")),
        masts=design.mast_x,
        position=position,
        height=height,
        radius=_radius(model.line.track.plan_curvature(x)),
        cant=_cant(model, x),
        alone=estimates[:, 0],
        together=estimates[:, 1],
        faults=(found[0][1], found[1][1]),
    )


def _from(side: Side) -> Side:
    return "right" if side == "left" else "left"


def _running(design: Equilibrium) -> NDArray[np.bool_]:
    """Return which nodes of contact wires are within reach of pantographs."""
    points = np.concatenate([wire.position for wire in design.of_role("contact")])
    return points[:, 2] <= design.running_height(points[:, 0]) + TOGETHER


def _points(design: Equilibrium) -> tuple[Array, NDArray[np.int64]]:
    wires = design.of_role("contact")
    keep = _running(design)
    x = np.concatenate([wire.position[:, 0] for wire in wires])[keep]
    counts = [len(wire.s) for wire in wires]
    number = np.repeat(np.arange(len(wires)), counts)[keep]
    return x, number


def _state(
    model: Model, design: Equilibrium, condition: Condition
) -> tuple[Equilibrium | None, str]:
    """Return the line under a condition, or why there is no such state."""
    case = model.case
    kept = tuple(one for one in case.conditions if one.name != condition.name)
    own = case.with_(conditions=(*kept, condition), condition=condition.name)
    try:
        return operate(replace(model, case=own), design), ""
    except (ConvergenceError, ModelError) as error:
        return None, str(error).replace(f"condition {condition.name!r}: ", "")


def _radius(curvature: Array) -> Array:
    bends = curvature != 0.0
    return np.where(bends, 1.0 / np.abs(np.where(bends, curvature, 1.0)), np.inf)


def _cant(model: Model, x: Array) -> Array:
    """Return cant or its deficiency, the larger, ``(n,)`` [m].

    ``deficiency = b v^2 / (g R) - cant`` with the distance b of the rails.
    """
    case = model.case
    width, speed = case.track.rail_distance, case.scenario.speed
    curvature = model.line.track.plan_curvature(x)
    lean = -width * model.line.track.frames(x).axes[:, 1, 2]
    cant = np.where(curvature < 0.0, -lean, lean)
    wanted = width * speed**2 / case.line.gravity * np.abs(curvature)
    return np.maximum(np.abs(cant), wanted - cant)


def _estimates(model: Model, condition: Condition) -> Array:
    """Return the largest distance to the lee in every span, ``(2, n_span)`` [m].

    The contact wire by itself, and contact and messenger wire as one; the largest of the contact
    wires that a span has.
    """
    assert condition.wind is not None
    left = condition.wind.pressure > 0.0
    masts, line = model.line.masts, model.line
    found = np.full((2, len(masts) - 1), np.nan)
    for run in line.of_role("contact"):
        others = [r for r in line.runs if r.tension_length == run.tension_length]
        carriers = [r for r in others if r.role == "messenger"]
        for row, group in enumerate(([run], [run, *carriers])):
            own = [
                _estimate(model, condition, group, ends, to_left=left) for ends in pairwise(masts)
            ]
            found[row] = np.fmax(found[row], own)
    return found


def _estimate(
    model: Model,
    condition: Condition,
    group: list[Run],
    ends: tuple[float, float],
    *,
    to_left: bool,
) -> float:
    """Return the lateral position of wires as one between two supports; NaN where none is held."""
    name = group[0].name
    held = {p.at.s: p.y for p in model.line.registrations if p.at.run == name}
    held |= {end.s: end.y for end in (group[0].start, group[0].end)}
    if not all(s in held for s in ends):
        return float("nan")
    curvature = float(model.line.track.plan_curvature(0.5 * (ends[0] + ends[1])))
    inwards = 1.0 if curvature > 0.0 else -1.0  # sign of y on the inside; on straight track right
    wire = Blown(
        sum(_tension(run, condition) for run in group),
        sum(wind_on(run, condition) for run in group),
        1.0 / abs(curvature) if curvature else float("inf"),
        (-inwards * held[ends[0]], -inwards * held[ends[1]]),
    )
    is_inwards = to_left == (inwards > 0.0)
    return lateral_position(wire, ends[1] - ends[0], "inside" if is_inwards else "outside")


def _tension(run: Run, condition: Condition) -> float:
    return condition.of_wire(run.wire_name).tension or run.wire.tension
