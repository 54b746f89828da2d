"""A condition: a new equilibrium with the unstrained lengths of the design."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.road.faults import refuse_impossible
from tautwire.analyses.threads import single_threaded
from tautwire.errors import ConvergenceError, ModelError
from tautwire.line.defects import Placed, placed
from tautwire.model.build import Model
from tautwire.model.equations import anchored_ends, at_rest, is_held
from tautwire.model.operation.cantilevers import cantilevers_of
from tautwire.model.operation.defects import lumps, with_defects, without_broken
from tautwire.model.operation.devices import (
    EndState,
    WireEnd,
    ends_of_wires,
    first_state,
    next_state,
)
from tautwire.model.operation.elastic import resisting
from tautwire.model.operation.weather import in_weather, reweighed
from tautwire.numerics.network.parts import BOTH_WAYS, Grounds
from tautwire.numerics.network.system import System, internal_force, tie_axial_force
from tautwire.numerics.statics.given_lengths import Settled, Swing, settle
from tautwire.results.equilibrium import Equilibrium, Operated
from tautwire.specs.conditions.condition import Condition
from tautwire.status import Status

Array = NDArray[Any]

Ends = list[tuple[WireEnd, EndState]]

_PASSES = 20
"""Most attempts to find which ends of wires move and which are held."""


_SAME_FORCE = 1e-2
"""Change of what turned cantilevers take along the track that counts as none [N]: a millionth of a
tension."""


@single_threaded
def operate(model: Model, design: Equilibrium) -> Equilibrium:
    """Find the state of a line in the condition that its case has chosen.

    The unstrained lengths of the design, changed by temperature and defects, are given; plain
    Newton finds the coordinates. Where that is too far for one step, the change is made in parts.

    Parameters
    ----------
    model
        The line; ``case.condition`` names the condition.
    design
        Its design, see :func:`find_shape`.

    Returns
    -------
    Equilibrium
        The design itself without a condition.

    Raises
    ------
    ConvergenceError
        When there is no equilibrium on the way, with how far it could be followed.
    ModelError
        When a wire is slack, an arm pushed, or the messenger wire hangs below the contact wire;
        every place is named.
    """
    condition = model.case.chosen_condition
    if condition is None:
        return design
    if design.operated is not None:
        raise ModelError("a condition starts from the design, not from another condition")
    defects = placed(model.line, condition)
    wires = ends_of_wires(model, condition)
    previous = _previous(model, design, condition, wires)
    ends = [
        (end, first_state(end, before, is_seized=_is_seized(model, end, defects)))
        for end, before in zip(wires, previous, strict=True)
    ]
    turning, iterations = cantilevers_of(model), 0
    turned = turning.square
    for _ in range(_PASSES):
        start, system = _prepared(model, design, condition, defects, ends)
        system = turned.on(model, turning, system)
        settled = settle(start, system, _swing(model, system, wires))
        iterations += settled.iterations
        _refuse_unsettled(condition, settled)
        found = [
            (end, next_state(end, state, before, *_moved(end, design, settled.system)))
            for (end, state), before in zip(ends, previous, strict=True)
        ]
        before, turned = turned, turning.turned(model, settled.system, design.position)
        is_steady = bool(np.all(np.abs(turned.along - before.along) < _SAME_FORCE))
        if found == ends and is_steady:
            settled = replace(settled, iterations=iterations)
            shape = _equilibrium(model, design, condition, settled, ends)
            refuse_impossible(model, shape)
            return shape
        ends = found
    raise ConvergenceError(
        f"condition {condition.name!r}: the tensioning devices or turning cantilevers do not "
        "settle; check the ranges and efficiencies of line.ends, and supports.hinge"
    )


def _previous(
    model: Model, design: Equilibrium, condition: Condition, ends: list[WireEnd]
) -> list[float]:
    """Return where the ends stood in the state that the line comes from [m]."""
    if condition.after is None:
        return [0.0] * len(ends)
    before = operate(replace(model, case=model.case.with_condition(condition.after)), design)
    assert before.operated is not None
    travel = before.operated.end_travel
    return [float(travel[end.side, end.strand]) for end in ends]


def _is_seized(model: Model, end: WireEnd, defects: Placed) -> bool:
    run = model.mesh.strands[end.strand].run
    return (run.name, "right" if end.side else "left") in defects.seized


def _prepared(
    model: Model, design: Equilibrium, condition: Condition, defects: Placed, ends: Ends
) -> tuple[System, System]:
    """Return the design and the line under the condition, with the same parts and ends held."""
    held = np.zeros_like(design.end_pulls, dtype=bool)
    for end, state in ends:
        held[end.side, end.strand] = state.travel is not None
    start = without_broken(model, at_rest(model, design, held, defects.arms), defects)
    changed = in_weather(model, with_defects(model, start, defects), condition, defects.missing)
    gravity = model.case.line.gravity
    system = reweighed(start, changed, lumps(model, defects), gravity)
    load = system.load.copy().reshape(-1, 6)
    for end, state in ends:
        if state.travel is None:
            load[end.node, :3] += (state.pull - _design_pull(design, end)) * end.outward
    return start, system.with_(load=load.ravel(), position=_shifted(model, system, ends))


def _shifted(model: Model, system: System, ends: Ends) -> Array:
    """Return coordinates of wires pulled along with their ends, evenly between what is held."""
    position = system.position.copy().reshape(-1, 6)
    shift = {e.node: e.outward * s.travel for e, s in ends if s.travel is not None}
    for strand in model.mesh.strands:
        held = [node for node in strand.nodes.tolist() if system.fixed[6 * node]]
        if not held:
            continue
        moved = np.array([shift.get(node, np.zeros(3)) for node in held])
        at = model.mesh.s[held]
        for axis in range(3):
            position[strand.nodes, axis] += np.interp(strand.s, at, moved[:, axis])
    return position.ravel()


def _design_pull(design: Equilibrium, end: WireEnd) -> float:
    pull = float(design.end_pulls[end.side, end.strand])
    return pull if end.side else -pull


def _swing(model: Model, system: System, ends: list[WireEnd]) -> Swing:
    """Let everything that holds the wires swing along the track, but for ends and fixed points."""
    tangent = model.mesh.frames.axes[:, 0].copy()
    tangent[[end.node for end in ends]] = 0.0
    pieces = (*model.line.registrations, *model.line.suspensions)
    tangent[model.mesh.nodes(piece.at for piece in pieces if piece.is_fixed_along)] = 0.0
    tangent[resisting(model.line, model.mesh)] = 0.0
    stays = tangent[system.stays.node]
    stays[len(stays) - len(model.line.stays) :] = 0.0  # those of wires stand still
    return Swing(stays, tangent[system.grounds.node])


def _refuse_unsettled(condition: Condition, settled: Settled) -> None:
    if settled.status is Status.DONE:
        return
    raise ConvergenceError(
        f"condition {condition.name!r}: an equilibrium was found up to "
        f"{100.0 * settled.share:.0f} % of the change and none beyond "
        f"({settled.iterations} iterations, residual {settled.residual:.3g} N). "
        f"{settled.status.sentence} Look at the line under a smaller change: a wire goes slack, or "
        "a support lets a wire go sideways"
    )


def _moved(end: WireEnd, design: Equilibrium, system: System) -> tuple[float, float]:
    """Return how far an end has moved outwards [m], and how hard its wire pulls [N]."""
    moved = (system.position - design.position).reshape(-1, 6)[end.node, :3]
    wire = system.with_(grounds=Grounds.none())
    pull = internal_force(wire, system.position).nodal.reshape(-1, 6)[end.node, :3]
    return float(moved @ end.outward), float(pull @ end.outward)


def _equilibrium(
    model: Model,
    design: Equilibrium,
    condition: Condition,
    settled: Settled,
    ends: Ends,
) -> Equilibrium:
    """Read lengths, forces and positions from the line under a condition."""
    system = settled.system
    heights, count = model.mesh.heights(system.position), len(model.line.hangers)
    ties = system.ties.chosen(np.arange(len(system.ties)) < count)
    nodes = model.mesh.nodes(at for _, at in model.line.contact_supports)
    before = at_rest(model, design, anchored_ends(model))
    shape = replace(
        design,
        position=system.position,
        cable_lengths=system.cables.length,
        dropper_lengths_unstrained=ties.length,
        dropper_lengths=ties.state(system.position).length,
        dropper_forces=tie_axial_force(system, system.position)[:count],
        dropper_heights=heights[ties.nodes[:, 1]],
        support_heights=heights[nodes],
        **_held(model, design, system),
        joint_pulls=_joint_pulls(model, system),
        weight=design.weight - float((system.load - before.load)[2::6].sum()),
        reaction=design.reaction + _supported(system) - _supported(before),
        iterations=settled.iterations,
        residual=settled.residual,
    )
    return replace(shape, **_at_ends(design, condition, system, ends))


def _joint_pulls(model: Model, system: System) -> Array:
    """Return the pulls of all joints; one that is broken pulls nothing."""
    pulls = system.clamps.pull(system.position)
    pairs = map(tuple, system.clamps.nodes.tolist())
    found = dict(zip(pairs, pulls, strict=True))
    joints = [(model.mesh.node(j.host), model.mesh.node(j.other)) for j in model.line.joints]
    return np.array([found.get(nodes, np.zeros(3)) for nodes in joints]).reshape(-1, 3)


def _held(model: Model, design: Equilibrium, system: System) -> dict[str, Array]:
    """Return how arms and springs hold the contact wires."""
    nodes = model.mesh.nodes(at for _, at in model.line.contact_supports)
    arms = nodes[design.arm_supports - 1]
    force, end, apart = _arms(model, design, system, arms)
    springs = np.zeros((system.node_count, 3))
    np.add.at(springs, system.grounds.node, system.grounds.pull(system.position))
    upward = model.mesh.frames.components(springs)[nodes, 2]
    is_spring = design.contact_preloads != 0.0
    return {
        "contact_preloads": design.contact_preloads - np.where(is_spring, upward, 0.0),
        "arm_forces": force,
        "arm_angles": np.arctan2(apart[:, 2], np.abs(apart[:, 1])),
        "arm_ends": end,
    }


def _arms(
    model: Model, design: Equilibrium, system: System, nodes: Any
) -> tuple[Array, Array, Array]:
    """Return forces and far ends of the arms, and their ends as seen from the wires.

    An arm that is no longer there carries nothing. One that acts as a vertical spring pulls
    sideways as much as holds its wire there.
    """
    frames, stays = model.mesh.frames[nodes], system.stays
    wire, before = (
        frames.to_local(q.reshape(-1, 6)[nodes, :3]) for q in (system.position, design.position)
    )
    axial = stays.axial_force(stays.state(system.position).length)
    of_arms = np.arange(len(stays)) < len(stays) - len(model.line.stays)
    arms = np.flatnonzero(of_arms & (stays.law == BOTH_WAYS))
    pulls = {int(stays.node[row]): (axial[row], stays.end[row]) for row in arms}
    r, count, elastic = system.position.reshape(-1, 6)[:, :3], len(model.line.hangers), system.ties
    forces = tie_axial_force(system, system.position)[count:]
    for (heel, node), pull in zip(elastic.nodes[count:].tolist(), forces, strict=True):
        pulls[node] = pull, r[heel]
    bare = system.with_(grounds=Grounds.none())
    missing = internal_force(bare, system.position).nodal - system.load
    lateral = frames.components(missing.reshape(-1, 6)[nodes, :3])[:, 1]
    along = np.stack([model.mesh.s[nodes], *np.zeros((2, len(nodes)))], axis=1)
    force, end = np.zeros(len(nodes)), design.arm_ends - along
    end[:, 0] += wire[:, 0] - before[:, 0]
    for arm, node in enumerate(nodes.tolist()):
        if node in pulls:
            force[arm], far = pulls[node]
            end[arm] = frames[arm].to_local(far)
        elif is_held(system, node, frames.axes[arm, 1]):
            apart = end[arm] - wire[arm]
            force[arm] = lateral[arm] * np.hypot(apart[1], apart[2]) / apart[1]
    return force, end + along, end - wire


def _supported(system: System) -> float:
    """Return the sum of the vertical forces of fixed points, springs and arms [N]."""
    q, stays = system.position, system.stays
    held = (internal_force(system, q).nodal - system.load)[2::6][system.fixed[2::6]]
    arms = stays.state(q)
    pull = stays.axial_force(arms.length) * arms.direction[2]
    return float(held.sum() - system.grounds.pull(q)[:, 2].sum() - pull.sum())


def _at_ends(
    design: Equilibrium,
    condition: Condition,
    system: System,
    ends: Ends,
) -> dict[str, Any]:
    """Return how far the ends of the wires have moved, what they do, and how the wires pull."""
    travel = np.full_like(design.end_pulls, np.nan)
    pulls = np.zeros_like(travel)
    words = [["clamped"] * len(design.wire_names) for _ in range(2)]
    for end, state in ends:
        moved, pull = _moved(end, design, system)
        travel[end.side, end.strand] = moved
        pulls[end.side, end.strand] = pull if end.side else -pull
        words[end.side][end.strand] = state.word
    told = tuple(words[0]), tuple(words[1])
    return {"end_pulls": pulls, "operated": Operated(condition, design, system, travel, told)}
