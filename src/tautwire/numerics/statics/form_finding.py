"""Shape finding: one bordered Newton solve for coordinates and unstrained lengths (paper eq. 7).

The x coordinate of every wire node is prescribed by the mesh; the unstrained length of the element
on its left takes its place among the unknowns. In height mode the contact wire's z at a dropper is
prescribed and the dropper's unstrained length takes its place. The system stays square and banded:
``d(Q - G)/dL0`` fills the columns of the replaced coordinates. Gravity and masses depend on the
unstrained lengths too.

Where a wire is clamped to another (a stitch wire), its tension is given at one end; the force of
the joint at the other end takes the place of the coordinate there.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.elements import ancf
from tautwire.numerics.network.banded import Pattern
from tautwire.numerics.network.system import System, internal_force, tangent_parts, weight_load
from tautwire.numerics.statics.newton import NewtonResult, NewtonSettings, damped_newton

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
    """A line whose shape is sought.

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
    """

    system: System
    held: NDArray[np.bool_]
    cable_slot: Index
    tie_slot: Index
    gravity: float
    taut: NDArray[np.bool_]
    joints: Index = field(default_factory=lambda: np.empty((0, 2), dtype=np.int64))


@dataclass(frozen=True, eq=False)
class Form:
    """Outcome of shape finding.

    Attributes
    ----------
    system : System
        The problem's system with the found coordinates, lengths, and complete loads.
    reactions : (n_dof,) N, N m
        Force that holds each held degree of freedom; zero elsewhere up to the residual.
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
    return _FormFinder(problem).solve(residual)


class _FormFinder:
    def __init__(self, problem: FormProblem) -> None:
        self.problem = problem
        system = problem.system
        self.n_dof, self.n_cable = system.dof_count, len(system.cables)
        self.pattern = Pattern(system)
        self.replaced = np.zeros(self.n_dof, dtype=bool)
        self.replaced[problem.cable_slot] = True
        self.replaced[problem.joints[:, 1]] = True
        self.free_length = np.flatnonzero(problem.tie_slot >= 0)
        self.replaced[problem.tie_slot[self.free_length]] = True
        keep = ~problem.held[self.pattern.rows]
        keep &= ~(problem.held | self.replaced)[self.pattern.cols]
        self.kept = np.flatnonzero(keep)

    def unpack(self, x: Array) -> System:
        """Return the system at coordinates and lengths ``x``."""
        given = self.problem.system
        counts = [self.n_dof, self.n_cable, len(given.ties)]
        q, cables, ties, pulls = np.split(x, np.cumsum(counts))
        system = given.with_(
            position=q, cables=given.cables.with_(length=cables), ties=given.ties.of_length(ties)
        )
        load = system.load + weight_load(system, self.problem.gravity)
        host, other = self.problem.joints.T
        np.add.at(load, host, pulls)
        np.subtract.at(load, other, pulls)
        return system.with_(load=load)

    def unbalanced(self, system: System) -> Array:
        """Return the unbalanced nodal forces Q - load, slack ties left out."""
        stiffness = np.where(self.problem.taut, system.ties.stiffness, 0.0)
        acting = system.with_(ties=system.ties.with_(stiffness=stiffness))
        return internal_force(acting, system.position, slackening=False).nodal - system.load

    def residual(self, x: Array) -> Array:
        r = self.unbalanced(self.unpack(x))
        return np.where(self.problem.held, 0.0, r)

    def direction(self, x: Array, r: Array) -> Array | None:
        from scipy.linalg import LinAlgError, solve_banded

        system = self.unpack(x)
        width = self.pattern.bandwidth
        band = self.bordered_band(system, width)
        try:
            step = solve_banded((width, width), band, -r, check_finite=False)
        except LinAlgError:
            return None
        return self.pack_step(step)

    def bordered_band(self, system: System, width: int) -> Array:
        """Return the tangent with length columns in general banded storage."""
        parts = tangent_parts(system, system.position, taut=self.problem.taut, pushing=True)
        values = self.pattern.values(parts)[self.kept]
        rows, cols = self.pattern.rows[self.kept], self.pattern.cols[self.kept]
        blocks = [(rows, cols, values), self.cable_columns(system), self.tie_columns(system)]
        blocks.append(self.joint_columns())
        rows, cols, values = (np.concatenate(part) for part in zip(*blocks, strict=True))
        keep = ~self.problem.held[rows]
        flat = (width + rows - cols)[keep] * self.n_dof + cols[keep]
        height = 2 * width + 1
        band = np.bincount(flat, weights=values[keep], minlength=height * self.n_dof)
        band = band.reshape(height, self.n_dof)
        band[width, self.problem.held & ~self.replaced] += 1.0
        return band

    def cable_columns(self, system: System) -> tuple[Index, Index, Array]:
        """Return d(Q - G)/dL0 of the wire elements."""
        cables = system.cables
        column = ancf.length_derivative(cables.coordinates(system.position), cables.section)
        column[:, 2] -= ancf.weight_length_derivative(
            cables.length, cables.mass, self.problem.gravity
        )
        cols = np.broadcast_to(self.problem.cable_slot, cables.dofs.shape)
        return cables.dofs.ravel(), cols.ravel(), column.reshape(-1)

    def tie_columns(self, system: System) -> tuple[Index, Index, Array]:
        """Return d(Q - G)/dL0 of the ties whose length is sought."""
        free, ties = self.free_length, system.ties
        state = ties.state(system.position)
        rate = -ties.stiffness
        rate = np.where(np.isnan(ties.axial), rate, rate * state.length / ties.length)
        pull = rate * state.direction
        column = np.concatenate([pull, -pull])
        column[[2, 5]] += 0.5 * ties.mass * self.problem.gravity
        rows = ties.dofs[:, free]
        cols = np.broadcast_to(self.problem.tie_slot[free], rows.shape)
        return rows.ravel(), cols.ravel(), column[:, free].ravel()

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
        start = self.problem.system
        pulls = np.zeros(len(self.problem.joints))
        x = np.concatenate([start.position, start.cables.length, start.ties.length, pulls])
        settings = NewtonSettings(increment=_INCREMENT, residual=residual)
        newton = damped_newton(x, self.residual, self.direction, self.limits(), settings)
        system = self.unpack(newton.x)
        pulls = newton.x[len(newton.x) - len(pulls) :]
        return Form(system, self.unbalanced(system), pulls, newton)
