"""Shape finding: one bordered Newton solve for coordinates and unstrained lengths (paper eq. 7).

Every node has axes of its own: along the track, lateral, and normal to the plane of the rails. All
that is prescribed, and every equation, belongs to these directions.

The coordinate along the track of every wire node is prescribed by the mesh; the unstrained length
of the element on its left takes its place among the unknowns. In height mode the contact wire's
height at a dropper is prescribed and the dropper's unstrained length takes its place. The system
stays square and banded: ``d(Q - G)/dL0`` fills the columns of the replaced coordinates. Gravity and
masses depend on the unstrained lengths too.

Where a wire is clamped to another (a stitch wire), its tension is given at one end; the force of
the joint at the other end takes the place of the coordinate there.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.elements import ancf
from tautwire.numerics.network.banded import Pattern
from tautwire.numerics.network.system import System, internal_force, tangent_parts, weight_load
from tautwire.numerics.statics.newton import NewtonResult, NewtonSettings, damped_newton

if TYPE_CHECKING:
    from scipy.sparse import csr_array

Array = NDArray[Any]
Index = NDArray[np.int64]

_LARGEST_STEP = {"position": 0.5, "slope": 0.1, "length": 0.05, "force": 1e4}
"""Largest change in one iteration [m, 1, m, N]: about what a first guess is off. Chosen: a third
takes one iteration more on an overlap, three times as much changes nothing on the library's
cases."""
_INCREMENT = 1e-7
"""Largest change, over the largest step, that counts as converged: 0.05 um. 1e-6 takes as many
iterations, 1e-8 one more, which changes heights by rounding alone."""


@dataclass(frozen=True, eq=False)
class FormProblem:
    """A line whose shape is sought; coordinates by number are those along the axes of the nodes.

    Attributes
    ----------
    system : System
        Connectivity, stiffness, first guess of coordinates and lengths. ``load`` holds the loads
        that do not depend on lengths (end tensions, clamps, arms).
    held : (n_dof,) bool
        Prescribed coordinates whose equation is not solved (their reaction follows).
    cable_slot : (n_cable,)
        Degree of freedom whose column is replaced by the element's unstrained length.
    tie_slot : (n_tie,)
        Degree of freedom replaced by the tie's unstrained length; -1 where the length is given.
    gravity : float m/s2
    taut : (n_tie,) bool
        Ties that carry force.
    joints : (n_joint, 2)
        Coordinates along the track of two clamped wires, the host's first, whose joint carries a
        force that is sought; it takes the place of the second coordinate.
    axes : (n_node, 3, 3)
        Directions along the track, lateral and normal at every node, as rows; those of the
        coordinates by default.
    """

    system: System
    held: NDArray[np.bool_]
    cable_slot: Index
    tie_slot: Index
    gravity: float
    taut: NDArray[np.bool_]
    joints: Index = field(default_factory=lambda: np.empty((0, 2), dtype=np.int64))
    axes: Array = field(default_factory=lambda: np.eye(3)[None])


@dataclass(frozen=True, eq=False)
class Form:
    """Outcome of shape finding.

    Attributes
    ----------
    system : System
        The problem's system with the found coordinates, lengths, and complete loads.
    reactions : (n_dof,) N, N m
        Force that holds each held coordinate along the axes of the nodes; zero elsewhere up to the
        residual.
    joint_pulls : (n_joint,) N
        Force of each sought joint on its host, positive to the right.
    newton : NewtonResult
    """

    system: System
    reactions: Array
    joint_pulls: Array
    newton: NewtonResult


def find_form(problem: FormProblem, residual: float) -> Form:
    """Solve for the equilibrium shape.

    Parameters
    ----------
    problem
        What is prescribed, and a first guess.
    residual
        Largest out-of-balance force accepted [N].
    """
    return FormFinder(problem).solve(residual)


class FormFinder:
    """The equations of one problem: unknowns packed and unpacked, residual, tangent.

    Parameters
    ----------
    problem
    """

    def __init__(self, problem: FormProblem) -> None:
        self.problem = problem
        system = problem.system
        self.n_dof, self.n_cable = system.dof_count, len(system.cables)
        self.axes = np.broadcast_to(problem.axes, (system.node_count, 3, 3))
        self.turning = _turning(self.axes)
        self.pattern = Pattern(system)
        self.replaced = np.zeros(self.n_dof, dtype=bool)
        self.replaced[problem.cable_slot] = True
        self.replaced[problem.joints[:, 1]] = True
        self.free_length = np.flatnonzero(problem.tie_slot >= 0)
        self.replaced[problem.tie_slot[self.free_length]] = True

    def turned(self, local: Array) -> Array:
        """Return nodal vectors ``(n_dof,)`` given by their components along the axes."""
        return np.einsum("nij,nai->naj", self.axes, local.reshape(-1, 2, 3)).ravel()

    def components(self, vectors: Array) -> Array:
        """Return the components of nodal vectors along the axes, ``(n_dof,)``."""
        return np.einsum("nij,naj->nai", self.axes, vectors.reshape(-1, 2, 3)).ravel()

    def unpack(self, x: Array) -> System:
        """Return the system at coordinates and lengths ``x``."""
        given = self.problem.system
        counts = [self.n_dof, self.n_cable, len(given.ties)]
        q, cables, ties, pulls = np.split(x, np.cumsum(counts))
        system = given.with_(
            position=self.turned(q),
            cables=given.cables.with_(length=cables),
            ties=given.ties.of_length(ties),
        )
        load = system.load + weight_load(system, self.problem.gravity)
        host, other = self.problem.joints.T
        joint = np.zeros(self.n_dof)
        np.add.at(joint, host, pulls)
        np.subtract.at(joint, other, pulls)
        return system.with_(load=load + self.turned(joint))

    def unbalanced(self, system: System) -> Array:
        """Return the unbalanced nodal forces Q - load along the axes, slack ties left out."""
        stiffness = np.where(self.problem.taut, system.ties.stiffness, 0.0)
        acting = system.with_(ties=system.ties.with_(stiffness=stiffness))
        force = internal_force(acting, system.position, slackening=False).nodal
        return self.components(force - system.load)

    def residual(self, x: Array) -> Array:
        """Return what is out of balance where it must not be, ``(n_dof,)``."""
        r = self.unbalanced(self.unpack(x))
        return np.where(self.problem.held, 0.0, r)

    def direction(self, x: Array, r: Array) -> Array | None:
        """Return Newton's step; None when the tangent is singular."""
        from scipy.linalg.lapack import dgbsv  # pyright: ignore[reportAttributeAccessIssue]

        width = self.pattern.bandwidth
        band = self.bordered_band(self.unpack(x))
        _, _, step, info = dgbsv(width, width, band, -r, overwrite_ab=True, overwrite_b=True)
        return None if info else self.pack_step(step)

    def tangent(self, system: System) -> csr_array:
        """Return d(Q - G)/dq along the axes of the nodes, ``(n_dof, n_dof)``."""
        parts = tangent_parts(system, system.position, taut=self.problem.taut, pushing=True)
        matrix = self.pattern.csr(self.pattern.values(parts))
        return (self.turning @ matrix @ self.turning.T).tocsr()

    def bordered_band(self, system: System) -> Array:
        """Return the tangent with length columns as LAPACK factorises it.

        Returns
        -------
        (3 * bandwidth + 1, n_dof)
            General banded storage, column by column; the first ``bandwidth`` rows are room for the
            factor.
        """
        held, width = self.problem.held, self.pattern.bandwidth
        matrix = self.tangent(system).tocoo()
        kept = ~(held[matrix.row] | (held | self.replaced)[matrix.col])
        blocks = [(matrix.row[kept], matrix.col[kept], matrix.data[kept])]
        blocks += [self.cable_columns(system), self.sought_columns(system), self.joint_columns()]
        band = np.zeros((self.n_dof, 3 * width + 1))
        for rows, cols, values in blocks:
            own = ~held[rows]
            place = cols[own] * np.int64(3 * width) + (2 * width + rows[own])
            band.reshape(-1)[place] = values[own]  # no other entry goes there
        band[held & ~self.replaced, 2 * width] += 1.0
        return band.T

    def cable_columns(self, system: System) -> tuple[Index, Index, Array]:
        """Return d(Q - G)/dL0 of the wire elements."""
        cables = system.cables
        column = ancf.length_derivative(cables.coordinates(system.position), cables.section)
        column[:, 2] -= ancf.weight_length_derivative(
            cables.length, cables.mass, self.problem.gravity
        )
        axes = self.axes[cables.nodes[:, [0, 0, 1, 1]]]
        column = np.einsum("naij,ajn->ain", axes, column)
        cols = np.broadcast_to(self.problem.cable_slot, cables.dofs.shape)
        return cables.dofs.ravel(), cols.ravel(), column.reshape(-1)

    def sought_columns(self, system: System) -> tuple[Index, Index, Array]:
        """Return d(Q - G)/dL0 of the ties whose length is sought."""
        rows = system.ties.dofs[:, self.free_length]
        cols = np.broadcast_to(self.problem.tie_slot[self.free_length], rows.shape)
        column = self.tie_columns(system)[:, self.free_length]
        return rows.ravel(), cols.ravel(), column.ravel()

    def tie_columns(self, system: System) -> Array:
        """Return d(Q - G)/dL0 of all ties as if they were taut, ``(6, n_tie)``."""
        ties = system.ties
        pull = tie_force_rate(system) * ties.state(system.position).direction
        column = np.concatenate([pull, -pull])
        column[[2, 5]] += 0.5 * ties.mass * self.problem.gravity
        column = np.einsum("naij,ajn->ain", self.axes[ties.nodes], column.reshape(2, 3, -1))
        return column.reshape(6, -1)

    def joint_columns(self) -> tuple[Index, Index, Array]:
        """Return d(Q - G)/dP of the joints whose force P is sought."""
        host, other = self.problem.joints.T
        ones = np.ones(len(host))
        rows = np.concatenate([host, other])
        return rows, np.concatenate([other, other]), np.concatenate([-ones, ones])

    def pack_step(self, step: Array) -> Array:
        """Distribute a solution over coordinates and lengths."""
        problem = self.problem
        dq = np.where(problem.held | self.replaced, 0.0, step)
        ties = np.zeros(len(problem.tie_slot))
        ties[self.free_length] = step[problem.tie_slot[self.free_length]]
        pulls = step[problem.joints[:, 1]]
        return np.concatenate([dq, step[problem.cable_slot], ties, pulls])

    def limits(self) -> Array:
        """Return the largest step of each unknown."""
        nodal = np.repeat([_LARGEST_STEP["position"], _LARGEST_STEP["slope"]], 3)
        lengths = self.n_cable + len(self.problem.tie_slot)
        return np.concatenate(
            [
                np.tile(nodal, self.n_dof // 6),
                np.full(lengths, _LARGEST_STEP["length"]),
                np.full(len(self.problem.joints), _LARGEST_STEP["force"]),
            ]
        )

    def solve(self, residual: float) -> Form:
        """Solve the problem; see :func:`find_form`."""
        start = self.problem.system
        pulls = np.zeros(len(self.problem.joints))
        q = self.components(start.position)
        x = np.concatenate([q, start.cables.length, start.ties.length, pulls])
        settings = NewtonSettings(increment=_INCREMENT, residual=residual)
        newton = damped_newton(x, self.residual, self.direction, self.limits(), settings)
        system = self.unpack(newton.x)
        pulls = newton.x[len(newton.x) - len(pulls) :]
        return Form(system, self.unbalanced(system), pulls, newton)


def tie_force_rate(system: System) -> Array:
    """Return the force of taut ties per unstrained length, both ends held, ``(n_tie,)`` [N/m]."""
    ties = system.ties
    stretched = ties.state(system.position).length / ties.length
    return -ties.stiffness * np.where(np.isnan(ties.axial), 1.0, stretched)


def _turning(axes: Array) -> csr_array:
    """Return the matrix that leads from nodal vectors to their components along the axes."""
    from scipy.sparse import bsr_array

    count = len(axes)
    blocks = np.repeat(axes, 2, axis=0)
    return bsr_array((blocks, np.arange(2 * count), np.arange(2 * count + 1))).tocsr()
