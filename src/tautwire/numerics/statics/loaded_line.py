"""Static response to point forces: modified Newton with an exact account of slack droppers.

The tangent of the unloaded line, with every dropper taut, is factored once. Slack droppers are
taken out of it by a low-rank correction (Woodbury), so that only the small change of geometry is
left to the iteration.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.network.banded import BandedCholesky, Pattern
from tautwire.numerics.network.system import System, internal_force, tangent_parts
from tautwire.status import Status

Array = NDArray[Any]

_MODIFIED_ITERATIONS = 40
"""Most iterations with the factor at rest, each a hundredth of a factor; at half as many some
points of AC simple go on with full Newton, which moves the elasticity by 1e-8."""
_FULL_ITERATIONS = 60
"""Most iterations with full Newton: 3 rad of turning in steps as below, and a few to converge."""
_SLOPE_STEP = 0.05
"""Largest change of a direction in one iteration [rad]: a taut wire turns by about as much between
neighbouring droppers. Chosen: 0.02 and 0.2 change nothing on AC simple."""
_RESPONSES_KEPT = 64
"""Solved unit loads of droppers that are kept: those within reach of a few points; memory for long
lines. With 8 the elasticity takes as long."""
_DIVERGED = 10.0
"""Growth of an increment that ends the iteration with the factor at rest; chosen, a
wire that turns up to its next dropper makes one grow once, by less."""


@dataclass(frozen=True, eq=False)
class StaticResponse:
    """Static state under an extra load.

    Attributes
    ----------
    status : Status
    position : (n_dof,)
    dropper_force : (n_dropper,) N
    iterations : int
    """

    status: Status
    position: Array
    dropper_force: Array
    iterations: int


class StaticSolver:
    """Solves ``Q(q) = load + extra`` for many extra loads on one line.

    Parameters
    ----------
    system
        The line; ``position`` is its unloaded static state.
    increment
        Largest change of a coordinate accepted as converged [m].
    """

    def __init__(self, system: System, increment: float = 1e-8) -> None:
        self._system = system
        self._increment = increment
        self._pattern = Pattern(system)
        ties = system.ties
        state = ties.state(system.position)
        self._taut0 = ties.acting(ties.stiffness * (state.length - ties.length))
        factor = self._factor(system.position, self._taut0)
        if factor is None:
            raise ValueError("the tangent of the static state is not positive definite")
        self._base = factor
        self._dofs, self._pull = self._unit_dropper_loads(state.direction)
        self._solved: dict[int, Array] = {}

    def solve(self, extra: Array) -> StaticResponse:
        """Return the static state under additional nodal loads ``extra`` ``(n_dof,)``."""
        response = self._modified_newton(extra)
        if response.status is Status.DONE:
            return response
        return self._full_newton(extra)

    @property
    def size(self) -> int:
        """Number of degrees of freedom."""
        return self._system.dof_count

    def linear(self, extra: Array) -> Array:
        """Return the small displacements under extra loads, all droppers taut, ``(n_dof,)``."""
        return self._base.solve(np.where(self._system.fixed, 0.0, extra))

    def _factor(self, q: Array, taut: NDArray[np.bool_]) -> BandedCholesky | None:
        values = self._pattern.values(tangent_parts(self._system, q, taut=taut))
        return BandedCholesky.of(self._pattern.upper_band(values))

    def _unit_dropper_loads(self, direction: Array) -> tuple[Array, Array]:
        """Return dofs and values of a unit tension in each dropper, both ``(n_dropper, 6)``."""
        system = self._system
        dofs = system.ties.dofs.T
        pull = np.concatenate([direction.T, -direction.T], axis=1)
        return dofs, np.where(system.fixed[dofs], 0.0, pull)

    def _response_to(self, dropper: int) -> Array:
        """Return the displacements under a unit tension in one dropper, ``(n_dof,)``."""
        if dropper not in self._solved:
            if len(self._solved) >= _RESPONSES_KEPT:
                self._solved.clear()
            load = np.zeros(self._system.dof_count)
            load[self._dofs[dropper]] = self._pull[dropper]
            self._solved[dropper] = self._base.solve(load)
        return self._solved[dropper]

    def _residual(self, q: Array, extra: Array) -> tuple[Array, Array]:
        force = internal_force(self._system, q)
        r = self._system.load + extra - force.nodal
        r[self._system.fixed] = 0.0
        return r, force.tie_axial

    def _size(self, dq: Array) -> float:
        return float(np.abs(dq[self._system.translations]).max())

    def _modified_newton(self, extra: Array) -> StaticResponse:
        q = self._system.position.copy()
        last, count = np.inf, 0
        r, axial = self._residual(q, extra)
        while count < _MODIFIED_ITERATIONS:
            count += 1
            slack = np.flatnonzero(self._taut0 & ~self._system.ties.acting(axial))
            dq = self._base.solve(r)
            if len(slack):
                dq = self._without(slack, dq)
            size = self._size(dq)
            if not np.isfinite(size) or size > _DIVERGED * last:
                break
            q += dq
            last = size
            r, axial = self._residual(q, extra)
            if size <= self._increment:
                return StaticResponse(Status.DONE, q, axial, count)
        return StaticResponse(Status.NOT_CONVERGED, q, axial, count)

    def _without(self, slack: NDArray[np.int64], dq: Array) -> Array:
        """Correct a solution for droppers that have gone slack."""
        dofs, pull = self._dofs[slack], self._pull[slack]
        responses = np.column_stack([self._response_to(int(i)) for i in slack])
        small = np.einsum("ik,ikj->ij", pull, responses[dofs])
        small -= np.diag(1.0 / self._system.ties.stiffness[slack])
        amplitude = np.linalg.solve(small, np.einsum("ik,ik->i", pull, dq[dofs]))
        return dq - responses @ amplitude

    def _full_newton(self, extra: Array) -> StaticResponse:
        q = self._system.position.copy()
        count = 0
        r, axial = self._residual(q, extra)
        while count < _FULL_ITERATIONS:
            count += 1
            factor = self._factor(q, self._system.ties.acting(axial))
            if factor is None:
                return StaticResponse(Status.SINGULAR, q, axial, count)
            dq = factor.solve(r)
            if not np.isfinite(self._size(dq)):
                return StaticResponse(Status.NOT_FINITE, q, axial, count)
            q += dq / max(1.0, float(np.abs(dq.reshape(-1, 6)[:, 3:]).max()) / _SLOPE_STEP)
            r, axial = self._residual(q, extra)
            if self._size(dq) <= self._increment:
                return StaticResponse(Status.DONE, q, axial, count)
        return StaticResponse(Status.NOT_CONVERGED, q, axial, count)
