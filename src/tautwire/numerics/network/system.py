"""Everything the equations of motion of a line need, as arrays, and their assembly.

Degrees of freedom are numbered node by node, ``6*node + (x, y, z, x', y', z')``, and nodes along
the track (``2*station + wire``), so that every matrix is banded.

Equation of motion (paper eq. 8)::

    M a + C v + Q(q, v) = load + contact

``Q`` holds wires, droppers (tension only, damping included), steady arms and support springs.
``C = a_R M + b_R K0`` plus the support dampers; ``K0`` is the tangent of wires and arms at the
static state. The droppers' share of ``b_R K0`` acts along the dropper and only while it is taut:
their force is ``max(0, k (l - L0) + b_R k dl/dt)``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.elements import ancf
from tautwire.numerics.elements.bar import BarState, bar_state, bar_tangent

Array = NDArray[Any]
Index = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class System:
    """Arrays that describe a line.

    Attributes
    ----------
    cable_nodes : (n_cable, 2)
        Left and right node of each wire element; a node is at most once left and once right.
    cable_length : (n_cable,) m
        Unstrained lengths.
    cable_axial_stiffness, cable_bending_stiffness, cable_mass : (n_cable,) N, N m2, kg/m
    dropper_nodes : (n_dropper, 2)
        Messenger-wire node and contact-wire node.
    dropper_length, dropper_stiffness : (n_dropper,) m, N/m
        Unstrained length and axial stiffness.
    arm_nodes : (n_arm,)
        Contact-wire node of each steady arm.
    arm_ends : (n_arm, 3) m
        Fixed far ends.
    arm_length, arm_stiffness, arm_mass : (n_arm,) m, N/m, kg
    spring_dofs : (n_spring,)
        Degrees of freedom on which grounded spring-dampers act.
    spring_stiffness, spring_damping, spring_free : (n_spring,) N/m, N s/m, m
        ``spring_free`` is the coordinate at which the spring is slack.
    node_mass : (n_node,) kg
        Lumped masses (clamps, halves of droppers).
    load : (n_dof,) N, N m
        Constant loads: weight and end tensions.
    fixed : (n_dof,) bool
        Degrees of freedom that do not move.
    position : (n_dof,) m
        Static state.
    damping_mass, damping_stiffness : float 1/s, s
        Rayleigh coefficients a_R and b_R.
    contact_nodes : (n_station,)
        Nodes of the contact wire from left to right.
    """

    cable_nodes: Index
    cable_length: Array
    cable_axial_stiffness: Array
    cable_bending_stiffness: Array
    cable_mass: Array
    dropper_nodes: Index
    dropper_length: Array
    dropper_stiffness: Array
    arm_nodes: Index
    arm_ends: Array
    arm_length: Array
    arm_stiffness: Array
    arm_mass: Array
    spring_dofs: Index
    spring_stiffness: Array
    spring_damping: Array
    spring_free: Array
    node_mass: Array
    load: Array
    fixed: NDArray[np.bool_]
    position: Array
    damping_mass: float
    damping_stiffness: float
    contact_nodes: Index

    @property
    def node_count(self) -> int:
        """Number of nodes."""
        return len(self.node_mass)

    @property
    def dof_count(self) -> int:
        """Number of degrees of freedom, fixed ones included."""
        return 6 * self.node_count

    def with_(self, **changes: Any) -> System:
        """Return a copy with some arrays replaced."""
        return replace(self, **changes)

    @cached_property
    def section(self) -> ancf.CableSection:
        """Length and stiffness of the wire elements."""
        return ancf.CableSection(
            self.cable_length, self.cable_axial_stiffness, self.cable_bending_stiffness
        )

    @cached_property
    def translations(self) -> Index:
        """Degrees of freedom that are coordinates, not slopes, ``(3 n_node,)``."""
        return (6 * np.arange(self.node_count)[:, None] + np.arange(3)).ravel()

    def cable_coordinates(self, q: Array) -> Array:
        """Gather element coordinates (r1, r1', r2, r2') from ``q``, ``(4, 3, n_cable)``."""
        nodes = q.reshape(-1, 6)
        e = np.empty((12, len(self.cable_nodes)), dtype=q.dtype)
        e[:6] = nodes[self.cable_nodes[:, 0]].T
        e[6:] = nodes[self.cable_nodes[:, 1]].T
        return e.reshape(4, 3, -1)

    def add_cable_forces(self, total: Array, forces: Array) -> None:
        """Add element forces ``(4, 3, n_cable)`` to the nodal forces ``(n_dof,)`` in place."""
        nodes, flat = total.reshape(-1, 6), forces.reshape(12, -1)
        nodes[self.cable_nodes[:, 0]] += flat[:6].T
        nodes[self.cable_nodes[:, 1]] += flat[6:].T

    def dropper_state(self, q: Array) -> BarState:
        """Return direction (contact to messenger wire) and length of the droppers."""
        r = q.reshape(-1, 6)[:, :3]
        return bar_state(r[self.dropper_nodes[:, 0]].T, r[self.dropper_nodes[:, 1]].T)

    def arm_state(self, q: Array) -> BarState:
        """Return direction (far end to wire) and length of the steady arms."""
        return bar_state(q.reshape(-1, 6)[self.arm_nodes, :3].T, self.arm_ends.T)


class InternalForce(NamedTuple):
    """Nodal forces Q ``(n_dof,)`` and what they were made of."""

    nodal: Array
    dropper_axial: Array


def dropper_axial_force(system: System, q: Array, v: Array | None = None) -> Array:
    """Return ``max(0, k (l - L0) + b_R k dl/dt)`` of each dropper, ``(n_dropper,)`` [N]."""
    return _taut(_dropper_axial(system, system.dropper_state(q), v))


def _dropper_axial(system: System, state: BarState, v: Array | None) -> Array:
    axial = system.dropper_stiffness * (state.length - system.dropper_length)
    if v is not None and system.damping_stiffness:
        nodes = v.reshape(-1, 6)[:, :3]
        relative = nodes[system.dropper_nodes[:, 0]] - nodes[system.dropper_nodes[:, 1]]
        rate = np.einsum("in,ni->n", state.direction, relative)
        axial = axial + system.damping_stiffness * system.dropper_stiffness * rate
    return axial


def _taut(axial: Array) -> Array:
    return np.where(np.real(axial) > 0.0, axial, 0.0)


def internal_force(
    system: System, q: Array, v: Array | None = None, *, slackening: bool = True
) -> InternalForce:
    """Return the forces of wires, droppers, arms and support springs.

    Parameters
    ----------
    system
        The line.
    q : (n_dof,)
        Nodal coordinates.
    v : (n_dof,), optional
        Nodal velocities, for the damping of the droppers.
    slackening
        False lets droppers push (used while the shape is searched).

    Returns
    -------
    InternalForce
        Nodal forces ``(n_dof,)`` and dropper forces ``(n_dropper,)`` [N].
    """
    total = np.zeros(q.shape, dtype=q.dtype)
    system.add_cable_forces(total, ancf.force(system.cable_coordinates(q), system.section))
    nodes = total.reshape(-1, 6)
    state = system.dropper_state(q)
    axial = _dropper_axial(system, state, v)
    if slackening:
        axial = _taut(axial)
    pull = (axial * state.direction).T
    nodes[system.dropper_nodes[:, 0], :3] += pull
    nodes[system.dropper_nodes[:, 1], :3] -= pull
    arms = system.arm_state(q)
    tension = system.arm_stiffness * (arms.length - system.arm_length)
    nodes[system.arm_nodes, :3] += (tension * arms.direction).T
    dofs = system.spring_dofs
    total[dofs] += system.spring_stiffness * (q[dofs] - system.spring_free)
    return InternalForce(total, axial)


@dataclass(frozen=True, eq=False)
class TangentParts:
    """Tangent stiffness of the parts of a line at one state.

    Attributes
    ----------
    cables : (4, 3, 4, 3, n_cable)
    droppers : (3, 3, n_dropper)
    arms : (3, 3, n_arm)
    springs : (n_spring,)
    """

    cables: Array
    droppers: Array
    arms: Array
    springs: Array


def tangent_parts(
    system: System, q: Array, *, taut: NDArray[np.bool_] | None = None, pushing: bool = False
) -> TangentParts:
    """Return the tangent of every part at ``q``.

    Parameters
    ----------
    system
        The line.
    q : (n_dof,)
        Nodal coordinates.
    taut : (n_dropper,) bool, optional
        Droppers that have their stiffness; all of them by default.
    pushing
        True counts the force of droppers that are too short to be taut (while a shape is sought).
    """
    state = system.dropper_state(q)
    axial = system.dropper_stiffness * (state.length - system.dropper_length)
    if not pushing:
        axial = np.maximum(axial, 0.0)
    keep = np.ones(len(axial)) if taut is None else taut.astype(float)
    arms = system.arm_state(q)
    tension = system.arm_stiffness * (arms.length - system.arm_length)
    return TangentParts(
        ancf.tangent(system.cable_coordinates(q), system.section),
        bar_tangent(state, keep * system.dropper_stiffness, keep * axial),
        bar_tangent(arms, system.arm_stiffness, tension),
        system.spring_stiffness,
    )


def mass_parts(system: System) -> TangentParts:
    """Return the mass of every part in the layout of :class:`TangentParts`.

    Lumped masses are not included; see :func:`lumped_mass`.
    """
    m = ancf.mass_matrix(system.cable_length, system.cable_mass)
    cables = np.einsum("ijn,ab->iajbn", m, np.eye(3))
    arms = np.eye(3)[:, :, None] * (system.arm_mass / 3.0)
    n_dropper, n_spring = len(system.dropper_length), len(system.spring_dofs)
    return TangentParts(cables, np.zeros((3, 3, n_dropper)), arms, np.zeros(n_spring))


def lumped_mass(system: System) -> Array:
    """Return lumped masses spread over the degrees of freedom, ``(n_dof,)`` [kg]."""
    diagonal = np.zeros((system.node_count, 6))
    diagonal[:, :3] = system.node_mass[:, None]
    return diagonal.ravel()


def weight_load(system: System, dropper_mass: float, gravity: float) -> Array:
    """Return the weight of wires and droppers as nodal loads, ``(n_dof,)``.

    Parameters
    ----------
    system
        The line, with its unstrained lengths.
    dropper_mass
        Mass per unstrained length [kg/m]; half of each dropper hangs on either end.
    gravity
        [m/s2]
    """
    total = np.zeros(system.dof_count)
    forces = np.zeros((4, 3, len(system.cable_length)))
    forces[:, 2] = ancf.weight(system.cable_length, system.cable_mass, gravity)
    system.add_cable_forces(total, forces)
    half = 0.5 * dropper_mass * gravity * system.dropper_length
    np.subtract.at(total, 6 * system.dropper_nodes + 2, half[:, None])
    return total
