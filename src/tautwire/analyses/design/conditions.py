"""The conditions of a line side by side, the design first."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.road.elasticity import TOGETHER
from tautwire.analyses.road.elasticity import elasticity as compute_elasticity
from tautwire.analyses.road.operate import operate
from tautwire.errors import ConvergenceError, ModelError
from tautwire.model.build import Model
from tautwire.results.design.conditions import ConditionState, EndOfWire, Extreme
from tautwire.results.equilibrium import Elasticity, Equilibrium
from tautwire.text import DESIGN

Array = NDArray[Any]


def examine(
    model: Model,
    design: Equilibrium,
    name: str | None,
    *,
    with_elasticity: bool = True,
    watch: Callable[[int, int], None] | None = None,
) -> ConditionState:
    """Find the state of a line in one condition, or why there is none.

    Parameters
    ----------
    model
        The line.
    design
        Its design.
    name
        Of the condition; None for the design.
    with_elasticity
        Whether the elasticity is computed.
    watch
        Called before every point of the elasticity, see :func:`elasticity`.
    """
    own = replace(model, case=model.case.with_condition(name))
    try:
        shape = operate(own, design)
        found = compute_elasticity(own, shape, watch=watch) if with_elasticity else None
        return state_of(own, shape, found)
    except (ConvergenceError, ModelError) as error:
        return ConditionState(name or DESIGN, tuple(_told(own)), _without_name(str(error), name))


def _without_name(text: str, name: str | None) -> str:
    return text.replace(f"condition {name!r}: ", "")


def _told(model: Model) -> list[str]:
    condition = model.case.chosen_condition
    return [] if condition is None else condition.told()


def state_of(model: Model, shape: Equilibrium, found: Elasticity | None) -> ConditionState:
    """Read the figures of one state.

    Parameters
    ----------
    model
        With the condition chosen.
    shape
        In this condition.
    found
        Elasticity, where it was computed.
    """
    first, last = model.case.resolved_section()
    masts = model.line.masts
    left, right, heights = _reach(shape, masts, first, last)
    own = (shape.dropper_span >= first) & (shape.dropper_span <= last)
    hangs = own & (shape.dropper_forces > 0.0)
    arms = shape.support_number[shape.arm_supports - 1]
    inside = (arms >= first) & (arms <= last + 1)
    return ConditionState(
        name=model.case.condition or DESIGN,
        told=tuple(_told(model)),
        heights=heights,
        left=left,
        right=right,
        dropper_forces=_extent(shape.dropper_forces[hangs]),
        slack=tuple(str(model.line.hangers[row].label) for row in np.flatnonzero(own & ~hangs)),
        arm_forces=_extent(shape.arm_forces[inside]),
        ends=tuple(_ends(model, shape)),
        elasticity_range=() if found is None else _extent(found.elasticity),
        nonuniformity=float("nan") if found is None else found.nonuniformity,
        shape=shape,
        elasticity=found,
    )


def _extent(values: Array) -> tuple[float, ...]:
    return (float(values.min()), float(values.max())) if len(values) else ()


def _reach(
    shape: Equilibrium, masts: tuple[float, ...], first: int, last: int
) -> tuple[Extreme, Extreme, tuple[float, ...]]:
    """Return where contact wires lie farthest to either side, and between which heights.

    A wire that is raised out of the way of pantographs does not count.
    """
    points = np.concatenate([wire.position for wire in shape.of_role("contact")])
    inside = (points[:, 0] >= masts[first - 1]) & (points[:, 0] <= masts[last])
    is_run_on = points[:, 2] <= shape.running_height(points[:, 0]) + TOGETHER
    points = points[inside & is_run_on]

    def extreme(row: int) -> Extreme:
        x = float(points[row, 0])
        span = int(np.searchsorted(masts[1:-1], x, side="right")) + 1
        return Extreme(float(points[row, 1]), min(span, last), x)

    lateral = points[:, 1]
    return extreme(int(lateral.argmax())), extreme(int(lateral.argmin())), _extent(points[:, 2])


def _ends(model: Model, shape: Equilibrium) -> Iterator[EndOfWire]:
    """Yield what both ends of every wire do that is not clamped to another."""
    for number, strand in enumerate(model.mesh.strands):
        if strand.run.start.kind == "clamped":
            continue
        for side, end in enumerate((strand.run.start, strand.run.end)):
            operated = shape.operated
            travel = 0.0 if operated is None else float(operated.end_travel[side, number])
            weights = None if end.device is None else end.device.weights
            yield EndOfWire(
                wire=strand.run.name,
                side="right" if side else "left",
                state=str(end.kind) if operated is None else operated.end_words[side][number],
                tension=abs(float(shape.end_pulls[side, number])),
                travel=travel,
                sinking=float("nan") if weights is None else weights.ratio * travel,
            )
