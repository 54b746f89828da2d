"""The line at its static state: the arrays on which elasticity, modes and dynamics work."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.model.arms import steady_arms
from tautwire.model.build import Model, arm_half_weight, interior_support_nodes
from tautwire.model.mesh import CONTACT, MESSENGER
from tautwire.numerics.network.parts import Grounds, Stays
from tautwire.numerics.network.system import System, weight_load
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
    """
    case, mesh = model.case, model.mesh
    hold = _vertical_hold(model, shape)
    built = model.form.system
    system = built.with_(
        position=shape.position,
        cables=built.cables.with_(length=shape.cable_lengths),
        ties=built.ties.of_length(shape.dropper_lengths_unstrained),
        stays=_arms(model, shape, hold),
        grounds=_grounds(model, shape, hold),
        fixed=_fixed(model, hold),
        load=_static_loads(model, shape, hold),
    )
    mass = system.node_mass + system.ties.hanging_mass(system.node_count)
    if hold is not None:
        mass[interior_support_nodes(mesh, CONTACT)] += hold.added_mass
    weight = weight_load(system, case.line.gravity)
    return system.with_(node_mass=mass, load=system.load + weight)


@dataclass(frozen=True, eq=False)
class _VerticalHold:
    """Preloaded vertical springs that hold the contact wire at the supports between the anchors.

    Attributes
    ----------
    along : (n_support - 2,) N/m
        Stiffness along the track.
    stiffness, damping : (n_support - 2,) N/m, N s/m
    preload : (n_support - 2,) N
        Upward force in the static state, weight of what moves with the spring deducted.
    added_mass : float kg
        Mass that is not among the lumped masses yet.
    """

    along: Array
    stiffness: Array
    damping: Array
    preload: Array
    added_mass: float


def _vertical_hold(model: Model, shape: Equilibrium) -> _VerticalHold | None:
    """Return the vertical springs of the contact wire; None where steady arms swing.

    A steady arm with motion ``vertical`` acts as the spring that a swinging one is for small
    rotations at constant lateral pull H: ``V = H tan(angle)`` gives
    ``dV/dz = H / (l cos^3 angle)``; along the track it is a pendulum of stiffness N/l. A third of
    its mass moves with the wire.
    """
    spec = model.case.supports
    ones = np.ones(len(model.mesh.support_station) - 2)
    if spec.closure == "spring" and spec.spring is not None:
        spring = spec.spring
        return _VerticalHold(
            0.0 * ones, spring.stiffness * ones, spring.damping * ones, shape.contact_preloads, 0.0
        )
    if spec.arm.motion == "swinging":
        return None
    cosine = np.cos(shape.arm_angles)
    along = shape.arm_forces / spec.arm.length
    preload = shape.arm_forces * np.sin(shape.arm_angles) - arm_half_weight(model.case)
    third = spec.arm.mass * spec.arm.length / 3.0
    return _VerticalHold(along, along / cosine**2, 0.0 * ones, preload, third)


def _fixed(model: Model, hold: _VerticalHold | None) -> NDArray[np.bool_]:
    """Return the degrees of freedom that never move."""
    case, mesh = model.case, model.mesh
    fixed = np.zeros((mesh.station_count, 2, 6), dtype=bool)
    for station, end in ((0, case.line.ends.left), (-1, case.line.ends.right)):
        fixed[station, :, 1:3] = True
        fixed[station, :, 0] = end == "anchored"
    inner = mesh.support_station[1:-1]
    fixed[inner, MESSENGER, 1] = True
    fixed[inner, MESSENGER, 0] = case.supports.messenger_longitudinal == "fixed"
    fixed[inner, CONTACT, 1] = hold is not None
    return fixed.ravel()


def _static_loads(model: Model, shape: Equilibrium, hold: _VerticalHold | None) -> Array:
    """Return the loads that do not depend on unstrained lengths."""
    case, mesh = model.case, model.mesh
    load = np.zeros((mesh.station_count, 2, 6))
    load[:, :, 2] -= (model.form.system.node_mass * case.line.gravity).reshape(-1, 2)
    load[0, :, 0] += shape.end_pulls[0]
    load[-1, :, 0] += shape.end_pulls[1]
    inner = mesh.support_station[1:-1]
    load[inner, CONTACT, 2] += -arm_half_weight(case) if hold is None else hold.preload
    return load.ravel()


def _arms(model: Model, shape: Equilibrium, hold: _VerticalHold | None) -> Stays:
    """Return the swinging arms."""
    count = len(shape.arm_supports) if hold is None else 0
    nodes = 2 * model.mesh.support_station[shape.arm_supports[:count] - 1] + CONTACT
    return steady_arms(model.case.supports.arm, nodes, shape.arm_ends[:count])


def _grounds(model: Model, shape: Equilibrium, hold: _VerticalHold | None) -> Grounds:
    """Return the springs to ground: messenger-wire supports, vertical springs of the contact wire.

    The preload of the latter is a load; the spring itself counts from the static height, which
    includes springs without stiffness (constant-force supports).
    """
    spec, mesh = model.case.supports, model.mesh
    nodes = interior_support_nodes(mesh, MESSENGER)
    zeros, ones = np.zeros(len(nodes)), np.ones(len(nodes))
    messenger = Grounds(
        nodes,
        _along_axes(zeros, spec.messenger_stiffness * ones),
        _along_axes(zeros, spec.messenger_damping * ones),
        np.column_stack([zeros, zeros, shape.messenger_free_heights]),
    )
    if hold is None:
        return messenger
    contact = Grounds(
        interior_support_nodes(mesh, CONTACT),
        _along_axes(hold.along, hold.stiffness),
        _along_axes(zeros, hold.damping),
        np.column_stack([shape.support_x[1:-1], zeros, shape.support_heights[1:-1]]),
    )
    return Grounds.joined(messenger, contact)


def _along_axes(along: Array, vertical: Array) -> Array:
    """Return diagonal matrices ``(n, 3, 3)`` that act along the track and vertically."""
    matrix = np.zeros((len(along), 3, 3))
    matrix[:, 0, 0], matrix[:, 2, 2] = along, vertical
    return matrix
