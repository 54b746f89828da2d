"""What defects do to a line, as words: the places where it differs most from its design."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tautwire.results.design.conditions import ConditionState

HEAD = (
    "condition", "defects", "height, most [mm]", "at x [m]", "dropper force, most [N]",
    "of dropper", "arm pull, most [N]", "of support", "slack", "softest [mm/N]",
)  # fmt: skip
ALIGN = "llrrrlrrrr"

_NONE = ("", "")


def defect_rows(states: Sequence[ConditionState]) -> list[tuple[str, ...]]:
    """Return one row per condition with defects, over the whole line.

    Differences from the design: of the height of the first contact wire, of the forces of droppers
    and arms, the largest of each with its place; droppers that have become slack; the softest place
    beside that of the design.

    Parameters
    ----------
    states
        The design first.
    """
    rows = []
    for one in states[1:]:
        operated = None if one.shape is None else one.shape.operated
        if operated is None or not operated.condition.defects:
            continue
        defects = "; ".join(map(str, operated.condition.defects))
        rows.append((one.name, defects, *_changes(one), *_softest(states[0], one)))
    return rows


def _changes(state: ConditionState) -> tuple[str, ...]:
    shape = state.shape
    assert shape is not None
    assert shape.operated is not None
    design = shape.operated.design
    x, z = design.contact.s, shape.contact.position[:, 2] - design.contact.position[:, 2]
    at = int(np.abs(z).argmax())
    forces = shape.dropper_forces - design.dropper_forces
    most = int(np.abs(forces).argmax()) if len(forces) else -1
    dropper = _NONE if most < 0 else (
        f"{forces[most]:+.0f}",
        f"{shape.dropper_number[most]} of span {shape.dropper_span[most]}",
    )  # fmt: skip
    arms = shape.arm_forces - design.arm_forces
    pull = int(np.abs(arms).argmax()) if len(arms) else -1
    arm = _NONE if pull < 0 else (
        f"{arms[pull]:+.0f}",
        str(shape.support_number[shape.arm_supports[pull] - 1]),
    )  # fmt: skip
    slack = int(np.sum((shape.dropper_forces <= 0.0) & (design.dropper_forces > 0.0)))
    return (f"{1e3 * z[at]:+.1f}", f"{x[at]:.1f}", *dropper, *arm, str(slack))


def _softest(design: ConditionState, state: ConditionState) -> tuple[str]:
    if not (design.elasticity_range and state.elasticity_range):
        return ("",)
    return (f"{1e3 * state.elasticity_range[1]:.3f} ({1e3 * design.elasticity_range[1]:.3f})",)
