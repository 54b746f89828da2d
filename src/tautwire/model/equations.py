"""The line at its static state: the arrays on which elasticity, modes and dynamics work."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.errors import ModelError
from tautwire.model.build import Model
from tautwire.model.operation.devices import tensioning_devices
from tautwire.model.operation.elastic import (
    HOLDING,
    arms_on_heels,
    elastic_grounds,
    held_heels,
    moving_masses,
)
from tautwire.model.registrations import (
    registrations_at_rest,
    suspension_grounds,
    uplift_stops,
    wire_stays,
)
from tautwire.numerics.network.parts import Clamps, Grounds, Stays, Ties
from tautwire.numerics.network.system import System, internal_force, weight_load
from tautwire.results.equilibrium import Equilibrium

Array = NDArray[Any]


def equations(model: Model, shape: Equilibrium) -> System:
    """Return the line with all its supports, at rest in the found shape.

    Parameters
    ----------
    model
        The line.
    shape
        Its static state.

    Returns
    -------
    System
        ``position`` is an equilibrium of this system.

    Raises
    ------
    ModelError
        When the shape is that of another condition than the one of the case.
    """
    found = None if shape.operated is None else shape.operated.condition.name
    if found != model.case.condition:
        raise ModelError(
            f"the static state is that of {_named(found)}, the case asks for "
            f"{_named(model.case.condition)}; find it again, or choose the condition with "
            "case.with_condition"
        )
    if shape.operated is not None:
        return shape.operated.system
    return at_rest(model, shape, anchored_ends(model))


def _named(condition: str | None) -> str:
    return "the design" if condition is None else f"the condition {condition!r}"


def anchored_ends(model: Model) -> NDArray[np.bool_]:
    """Return which left and right ends of the wires are held along the track, ``(2, n_wire)``."""
    runs = [strand.run for strand in model.mesh.strands]
    ends = [[run.start.kind for run in runs], [run.end.kind for run in runs]]
    return np.array(ends) == "anchored"


def at_rest(
    model: Model,
    shape: Equilibrium,
    anchored: NDArray[np.bool_],
    broken: Collection[int] = (),
) -> System:
    """Return the line in its design, with some ends of wires held along the track.

    Parameters
    ----------
    model
        The line.
    shape
        Its design.
    anchored : (2, n_wire) bool
        Which left and right ends are held.
    broken
        Rows of registrations that hold nothing.
    """
    line, mesh, gravity = model.line, model.mesh, model.case.line.gravity
    built = model.form.system
    held, load = _ends_and_suspensions(model, shape, anchored)
    stays, grounds = Stays.none(), suspension_grounds(line, mesh, shape.suspension_free_heights)
    tensioning, arms = tensioning_devices(model, shape.position), Ties.none()
    mass = tensioning.mass + moving_masses(line, mesh, broken)
    for group, rest in registrations_at_rest(line, mesh, shape, gravity, broken):
        rest, on_heels = arms_on_heels(mesh, group, rest)
        stays, grounds = stays.joined(rest.stays), grounds.joined(rest.grounds)
        arms = arms.joined(on_heels)
        load[group.nodes, :3] += rest.load
        held[group.nodes, 1] = rest.is_held_sideways
        mass[group.nodes] += rest.added_mass
    held_heels(line, mesh, held, broken)
    stays = stays.joined(uplift_stops(line, mesh, shape, broken))
    stays = stays.joined(wire_stays(line, mesh, shape, built.stays))
    system = built.with_(
        position=shape.position,
        cables=built.cables.with_(length=shape.cable_lengths),
        ties=built.ties.of_length(shape.dropper_lengths_unstrained).joined(arms),
        stays=stays,
        grounds=grounds.joined(tensioning.springs),
        clamps=_clamps(built.clamps, shape),
        load=load.ravel(),
    )
    mass = system.node_mass + system.ties.hanging_mass(system.node_count) + mass
    system = system.with_(node_mass=mass, load=system.load + weight_load(system, gravity))
    elastic = elastic_grounds(line, mesh, system, broken)
    system = _holding(system, held, mesh.frames.axes)
    system.fixed.reshape(-1, 6)[mesh.heels[mesh.heels >= 0], 3:] = True
    return system.with_(grounds=system.grounds.joined(elastic))


def _ends_and_suspensions(
    model: Model, shape: Equilibrium, anchored: NDArray[np.bool_]
) -> tuple[NDArray[np.bool_], Array]:
    """Return what the ends of the wires and the suspensions hold, and loads.

    ``(n_node, 3)`` along the axes of the track, and ``(n_node, 6)``.
    """
    mesh = model.mesh
    fixed = np.zeros((mesh.node_count, 3), dtype=bool)
    load = np.zeros((mesh.node_count, 6))
    load[:, 2] -= model.form.system.node_mass * model.case.line.gravity
    for number, strand in enumerate(mesh.strands):
        ends = (strand.run.start, strand.nodes[0]), (strand.run.end, strand.nodes[-1])
        for side, (end, node) in enumerate(ends):
            fixed[node, 1:3] = end.kind != "clamped"
            fixed[node, 0] = anchored[side, number]
            load[node, :3] += shape.end_pulls[side, number] * mesh.frames.axes[node, 0]
    for piece in model.line.suspensions:
        is_rigid = piece.elastic is None or piece.elastic.lateral is None
        fixed[mesh.node(piece.at), :2] = piece.is_fixed_along, is_rigid
    for piece in model.line.registrations:
        fixed[mesh.node(piece.at), 0] = piece.is_fixed_along
    return fixed, load


def _holding(system: System, held: NDArray[np.bool_], axes: Array) -> System:
    """Hold nodes in some directions of the track.

    A direction that is an axis of the coordinates is a fixed degree of freedom, and so is all of a
    node that is held in every direction. Any other is a stiff spring, damped like the wires, which
    in the found shape carries what would be out of balance without it.
    """
    directions = axes * held[..., None]
    is_axis = held & (np.count_nonzero(axes, axis=2) == 1)
    fixed = np.zeros((len(held), 6), dtype=bool)
    fixed[:, :3] = np.any((directions != 0.0) & is_axis[..., None], axis=1)
    fixed[np.all(held, axis=1), :3] = True
    node, axis = np.nonzero(held & ~is_axis & ~np.all(held, axis=1)[:, None])
    d = axes[node, axis]
    unbalanced = internal_force(system, system.position).nodal - system.load
    force = np.sum(d * unbalanced.reshape(-1, 6)[node, :3], axis=1)
    stiffness = HOLDING * d[:, :, None] * d[:, None, :]
    holding = Grounds(
        node,
        stiffness,
        system.damping.stiffness * stiffness,
        system.position.reshape(-1, 6)[node, :3] + (force / HOLDING)[:, None] * d,
    )
    return system.with_(fixed=fixed.ravel(), grounds=system.grounds.joined(holding))


def is_held(system: System, node: int, direction: Array) -> bool:
    """Tell whether a node is fixed, or held by a stiff spring, in a direction across the track."""
    own = system.grounds.stiffness[system.grounds.node == node]
    is_fixed = bool(system.fixed[6 * node : 6 * node + 3][direction != 0.0].all())
    return is_fixed or bool(np.any(direction @ own @ direction > 0.5 * HOLDING))


def _clamps(clamps: Clamps, shape: Equilibrium) -> Clamps:
    """Return the joints so that in the found shape they pull as they should."""
    r = shape.position.reshape(-1, 6)[:, :3]
    apart = r[clamps.nodes[:, 1]] - r[clamps.nodes[:, 0]]
    return clamps.with_(offset=apart - shape.joint_pulls / clamps.stiffness[:, None])
