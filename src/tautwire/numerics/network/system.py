"""Everything the equations of motion of a line need, as arrays, and their assembly.

Degrees of freedom are numbered node by node, ``6*node + (x, y, z, x', y', z')``, and nodes along
the track, whatever wire they belong to, so that every matrix is banded.

Equation of motion (paper eq. 8)::

    M a + C v + Q(q, v) = load + contact

``Q`` holds cables, ties (damping included), clamps, stays and grounds. ``C = a_R M + b_R K0`` plus
the dampers of the grounds; ``K0`` is the tangent of cables and stays at the static state. The
ties' share of ``b_R K0`` acts along the tie and only while its law lets it act: the force of a
dropper is ``max(0, k (l - L0) + b_R k dl/dt)``.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.elements import ancf
from tautwire.numerics.elements.bar import BarState, bar_tangent
from tautwire.numerics.network.parts import (
    Cables,
    Clamps,
    Grounds,
    Path,
    Rayleigh,
    Stays,
    Ties,
    law_allows,
)

Array = NDArray[Any]
Index = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class System:
    """Arrays that describe a line.

    Attributes
    ----------
    cables, ties, clamps, stays, grounds
        The parts.
    node_mass : (n_node,) kg
        Lumped masses (clamps, halves of droppers).
    load : (n_dof,) N, N m
        Constant loads: weight and end tensions.
    fixed : (n_dof,) bool
        Degrees of freedom that do not move.
    position : (n_dof,) m
        Static state.
    paths : tuple of Path
        Wires that a pantograph may run under.
    damping : Rayleigh
        Proportional damping.
    """

    cables: Cables
    node_mass: Array
    load: Array
    fixed: NDArray[np.bool_]
    position: Array
    ties: Ties = field(default_factory=Ties.none)
    clamps: Clamps = field(default_factory=Clamps.none)
    stays: Stays = field(default_factory=Stays.none)
    grounds: Grounds = field(default_factory=Grounds.none)
    paths: tuple[Path, ...] = ()
    damping: Rayleigh = field(default_factory=Rayleigh)

    @property
    def node_count(self) -> int:
        """Number of nodes."""
        return len(self.node_mass)

    @property
    def dof_count(self) -> int:
        """Number of degrees of freedom, fixed ones included."""
        return 6 * self.node_count

    def with_(self, **changes: Any) -> System:
        """Return a copy with some parts replaced."""
        return replace(self, **changes)

    @cached_property
    def translations(self) -> Index:
        """Degrees of freedom that are coordinates, not slopes, ``(3 n_node,)``."""
        return (6 * np.arange(self.node_count)[:, None] + np.arange(3)).ravel()


class InternalForce(NamedTuple):
    """Nodal forces Q ``(n_dof,)`` and what they were made of."""

    nodal: Array
    tie_axial: Array


def tie_axial_force(system: System, q: Array, v: Array | None = None) -> Array:
    """Return the axial force of each tie as its law allows, ``(n_tie,)`` [N].

    For a dropper ``max(0, k (l - L0) + b_R k dl/dt)``.
    """
    axial = _tie_axial(system, system.ties.state(q), v)
    return np.where(law_allows(system.ties.law, axial), axial, 0.0)


def _tie_axial(system: System, state: BarState, v: Array | None) -> Array:
    ties = system.ties
    axial = ties.stiffness * (state.length - ties.length)
    if v is not None and system.damping.stiffness:
        nodes = v.reshape(-1, 6)[:, :3]
        relative = nodes[ties.nodes[:, 0]] - nodes[ties.nodes[:, 1]]
        rate = np.einsum("in,ni->n", state.direction, relative)
        axial = axial + system.damping.stiffness * ties.stiffness * rate
    return axial


def internal_force(
    system: System, q: Array, v: Array | None = None, *, slackening: bool = True
) -> InternalForce:
    """Return the forces of cables, ties, clamps, stays and grounds.

    Parameters
    ----------
    system
        The line.
    q : (n_dof,)
        Nodal coordinates.
    v : (n_dof,), optional
        Nodal velocities, for the damping of the ties.
    slackening
        False lets droppers push (used while the shape is searched).

    Returns
    -------
    InternalForce
        Nodal forces ``(n_dof,)`` and forces of the ties ``(n_tie,)`` [N].
    """
    total = np.zeros(q.shape, dtype=q.dtype)
    cables, ties, clamps = system.cables, system.ties, system.clamps
    cables.add_forces(total, ancf.force(cables.coordinates(q), cables.section))
    nodes = total.reshape(-1, 6)[:, :3]
    state = ties.state(q)
    axial = _tie_axial(system, state, v)
    if slackening:
        axial = np.where(law_allows(ties.law, axial), axial, 0.0)
    pull = (axial * state.direction).T
    np.add.at(nodes, ties.nodes[:, 0], pull)
    np.subtract.at(nodes, ties.nodes[:, 1], pull)
    joint = clamps.pull(q)
    np.subtract.at(nodes, clamps.nodes[:, 0], joint)
    np.add.at(nodes, clamps.nodes[:, 1], joint)
    stays = system.stays.state(q)
    np.add.at(
        nodes, system.stays.node, (system.stays.axial_force(stays.length) * stays.direction).T
    )
    np.add.at(nodes, system.grounds.node, system.grounds.pull(q))
    return InternalForce(total, axial)


@dataclass(frozen=True, eq=False)
class PartMatrices:
    """Matrices of the parts of a line: tangents, masses or dampers.

    Attributes
    ----------
    cables : (4, 3, 4, 3, n_cable)
    ties : (3, 3, n_tie)
        Block B of ``[[B, -B], [-B, B]]``.
    clamps : (3, 3, n_clamp)
        The same.
    stays : (3, 3, n_stay)
    grounds : (3, 3, n_ground)
    """

    cables: Array
    ties: Array
    clamps: Array
    stays: Array
    grounds: Array

    def with_(self, **changes: Array) -> PartMatrices:
        """Return a copy with the matrices of some kinds replaced."""
        return replace(self, **changes)

    def scaled(
        self,
        *,
        cables: float = 0.0,
        ties: float = 0.0,
        clamps: float = 0.0,
        stays: float = 0.0,
        grounds: float = 0.0,
    ) -> PartMatrices:
        """Return every kind of part times a factor; a kind without factor counts nothing."""
        return PartMatrices(
            cables * self.cables,
            ties * self.ties,
            clamps * self.clamps,
            stays * self.stays,
            grounds * self.grounds,
        )


def tangent_parts(
    system: System, q: Array, *, taut: NDArray[np.bool_] | None = None, pushing: bool = False
) -> PartMatrices:
    """Return the tangent of every part at ``q``.

    Parameters
    ----------
    system
        The line.
    q : (n_dof,)
        Nodal coordinates.
    taut : (n_tie,) bool, optional
        Ties that have their stiffness; all of them by default.
    pushing
        True counts the force of droppers that are too short to be taut (while a shape is sought).
    """
    ties = system.ties
    state = ties.state(q)
    axial = ties.stiffness * (state.length - ties.length)
    if not pushing:
        axial = np.where(law_allows(ties.law, axial), axial, 0.0)
    keep = np.ones(len(axial)) if taut is None else taut.astype(float)
    return PartMatrices(
        ancf.tangent(system.cables.coordinates(q), system.cables.section),
        bar_tangent(state, keep * ties.stiffness, keep * axial),
        np.eye(3)[:, :, None] * system.clamps.stiffness,
        system.stays.tangent(q),
        np.moveaxis(system.grounds.stiffness, 0, -1),
    )


def mass_parts(system: System) -> PartMatrices:
    """Return the mass of every part in the layout of :class:`PartMatrices`.

    Lumped masses are not included; see :func:`lumped_mass`.
    """
    cables = system.cables
    m = ancf.mass_matrix(cables.length, cables.mass)
    none = [np.zeros((3, 3, len(part))) for part in (system.ties, system.clamps, system.grounds)]
    stays = np.eye(3)[:, :, None] * (system.stays.mass / 3.0)
    return PartMatrices(np.einsum("ijn,ab->iajbn", m, np.eye(3)), none[0], none[1], stays, none[2])


def ground_dampers(system: System, parts: PartMatrices) -> PartMatrices:
    """Return the dampers of the grounds in the layout of ``parts``."""
    dampers = np.moveaxis(system.grounds.damping, 0, -1)
    return replace(parts.scaled(), grounds=dampers)


def lumped_mass(system: System) -> Array:
    """Return lumped masses spread over the degrees of freedom, ``(n_dof,)`` [kg]."""
    diagonal = np.zeros((system.node_count, 6))
    diagonal[:, :3] = system.node_mass[:, None]
    return diagonal.ravel()


def weight_load(system: System, gravity: float) -> Array:
    """Return the weight of cables and ties as nodal loads, ``(n_dof,)``.

    Parameters
    ----------
    system
        The line, with its unstrained lengths.
    gravity
        [m/s2]
    """
    total = np.zeros(system.dof_count)
    cables, ties = system.cables, system.ties
    forces = np.zeros((4, 3, len(cables)))
    forces[:, 2] = ancf.weight(cables.length, cables.mass, gravity)
    cables.add_forces(total, forces)
    half = 0.5 * ties.mass * gravity * ties.length
    np.subtract.at(total, 6 * ties.nodes + 2, half[:, None])
    return total
