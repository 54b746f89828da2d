"""Static states of one window of a line under many loads at once, droppers going slack.

Modified Newton iteration: the tangent at rest is factored once; all loads share its solves and the
evaluation of forces. Droppers that go slack or taut, steady arms that turn (stiff, so that a turn
of a degree matters) and the shares of several wires under one rigid head are accounted for within
each iteration by a small dense problem (Woodbury).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.network.banded import BandedCholesky, Pattern
from tautwire.numerics.network.cuts import copies
from tautwire.numerics.network.system import System, internal_force, tangent_parts
from tautwire.numerics.statics.bars import Bars, Step, Wires, level
from tautwire.status import Status

Array = NDArray[Any]
Index = NDArray[np.int64]

_MODIFIED_ITERATIONS = 40
"""Most iterations with the factor at rest; chosen, library lines need four."""
_FULL_ITERATIONS = 60
"""Most iterations with full Newton: 3 rad of turning in steps as below, and a few to converge."""
_SLOPE_STEP = 0.05
"""Largest change of a direction in one iteration [rad]: a taut wire turns by about as much between
neighbouring droppers. Chosen: 0.02 and 0.2 change nothing on AC simple."""
_DIVERGED = 10.0
"""Growth of an increment that ends the iteration with the factor at rest; chosen, a
wire that turns up to its next dropper makes one grow once, by less."""


@dataclass(frozen=True, eq=False)
class Push:
    """Wires that a rigid head pushes to one height.

    Attributes
    ----------
    dofs : (n_wire, k)
        Coordinates of the line that a unit force on each wire acts on.
    values : (n_wire, k)
        How: the height of a wire is ``values @ q[dofs]``.
    force : float N
        On all wires together.
    """

    dofs: Index
    values: Array
    force: float

    def heights(self, q: Array) -> Array:
        """Return the heights of the wires, ``(n_wire,)`` [m]."""
        return np.sum(self.values * q[self.dofs], axis=1)

    def load(self, shares: Array, count: int) -> Array:
        """Return forces ``(n_wire,)`` on the wires as nodal loads, ``(count,)``."""
        load = np.zeros(count)
        np.add.at(load, self.dofs, shares[:, None] * self.values)
        return load


@dataclass(frozen=True, eq=False)
class Pushed:
    """Static state under a push.

    Attributes
    ----------
    status : Status
    position : (n_dof,)
        Coordinates of the window.
    heights : (n_wire,) m
        Of the pushed wires.
    shares : (n_wire,) N
        Force on each of them.
    tie_force : (n_tie,) N
        Of the ties inside the window, as their law allows.
    iterations : int
    """

    status: Status
    position: Array
    heights: Array
    shares: Array
    tie_force: Array
    iterations: int


class _State:
    """A state on its way: displacements ``u`` and the shares of the force."""

    def __init__(self, push: Push, size: int) -> None:
        self.push, self.u = push, np.zeros(size)
        self.shares = np.full(len(push.values), push.force / len(push.values))
        self.status, self.iterations, self._last = Status.RUNNING, 0, np.inf

    def load(self) -> Array:
        """Return the nodal loads, ``(n_dof,)``."""
        return self.push.load(self.shares, len(self.u))

    def move(self, du: Array, size: float, increment: float) -> None:
        """Take a step of the iteration with the tangent at rest, and judge it.

        From the second one on, which first knows how far stiff bars have turned, the increments
        of such an iteration fall evenly or faster, so that the next one can be foretold.
        """
        self.iterations += 1
        if not np.isfinite(size) or size > _DIVERGED * self._last:
            self.status = Status.NOT_CONVERGED
            return
        self.u = self.u + du
        ahead = size * min(1.0, size / self._last) if self.iterations > 2 else size
        if ahead <= increment:
            self.status = Status.DONE
        elif self.iterations == _MODIFIED_ITERATIONS:
            self.status = Status.NOT_CONVERGED
        self._last = size


class Window:
    """A stretch of a line, nonlinear; the line outside is linear and condensed onto it.

    Parameters
    ----------
    inside
        The parts inside the window, at rest.
    first_dof
        Number that its first coordinate has in the line.
    band : (bandwidth + 1, n_dof)
        Tangent at rest, the line outside condensed onto it, in upper banded storage.
    in_corner : (n_dof,) bool
        Coordinates that feel the line outside.
    increment
        Largest change of a coordinate accepted as converged [m].
    """

    def __init__(
        self,
        inside: System,
        first_dof: int,
        band: Array,
        in_corner: NDArray[np.bool_],
        increment: float,
    ) -> None:
        self._system, self._first, self._increment = inside, first_dof, increment
        self._pattern, self._width = Pattern(inside), len(band) - 1
        ties = inside.ties
        state = ties.state(inside.position)
        taut = ties.acting(ties.stiffness * (state.length - ties.length))
        self._beyond = _within(band - self._tangent(inside.position, taut), in_corner)
        self._outside = _symmetric(self._beyond)
        self._force_at_rest = internal_force(inside, inside.position).nodal
        factor = BandedCholesky.of(band)
        if factor is None:
            raise ValueError("the tangent of the static state is not positive definite")
        self._factor = factor
        self._stays_at_rest = inside.stays.tangent(inside.position)
        self._pulled, self._pull = self._unit_pulls(state.direction)
        self._responses: dict[int, tuple[Array, Array]] = {}
        self._bars = Bars(ties, taut, lambda place: self._response_to(place)[1])

    def _unit_pulls(self, direction: Array) -> tuple[Index, Array]:
        """Return coordinates and values of unit pulls of the ties and stays, both ``(n, 6)``."""
        ties, stays = self._system.ties, self._system.stays
        ends = np.zeros((3 * len(stays), 6), dtype=np.int64)
        ends[:, 0] = stays.dofs.T.ravel()
        pull = np.concatenate([direction.T, -direction.T], axis=1)
        dofs = np.concatenate([ties.dofs.T, ends])
        pull = np.concatenate([pull, np.tile(np.eye(6)[0], (len(ends), 1))])
        return dofs, np.where(self._system.fixed[dofs], 0.0, pull)

    def respond(self, pushes: Sequence[Push]) -> list[Pushed]:
        """Return the static state under each of some pushes, found together."""
        own = [replace(push, dofs=push.dofs - self._first) for push in pushes]
        return [
            self._answer(state if state.status is Status.DONE else self._full_newton(state.push))
            for state in self._modified_newton(own)
        ]

    def _answer(self, state: _State) -> Pushed:
        axial = self._axial_at(state.u[:, None])[:, 0]
        force = np.where(self._system.ties.acting(axial), axial, 0.0)
        q = self._system.position + state.u
        heights = state.push.heights(q)
        return Pushed(state.status, q, heights, state.shares, force, state.iterations)

    # ---- the line ------------------------------------------------------------------------------

    def _tangent(self, q: Array, taut: NDArray[np.bool_]) -> Array:
        """Return the tangent of the parts inside in upper banded storage."""
        parts = tangent_parts(self._system, q, taut=taut)
        band = self._pattern.upper_band(self._pattern.values(parts))
        return np.pad(band, ((self._width + 1 - len(band), 0), (0, 0)))

    def _unbalanced(self, u: Array, load: Array) -> Array:
        """Return what loads leave unbalanced at displacements ``u``, all ``(n_dof, m)``."""
        count = u.shape[1]
        q = (self._system.position[:, None] + u).T.ravel()
        nodal = internal_force(copies(self._system, count), q).nodal.reshape(count, -1).T
        return self._free(load - (nodal - self._force_at_rest[:, None]) - self._outside @ u)

    def _free(self, r: Array) -> Array:
        """Return nodal forces without those on fixed coordinates."""
        return np.where(self._system.fixed[:, None], 0.0, r)

    def _axial_at(self, u: Array) -> Array:
        """Return the forces of all ties as if none could slacken, ``(n_tie, m)`` [N]."""
        ties = self._system.ties
        nodes = (self._system.position[:, None] + u).reshape(-1, 6, u.shape[1])[:, :3]
        apart = nodes[ties.nodes[:, 0]] - nodes[ties.nodes[:, 1]]
        length = np.sqrt((apart**2).sum(axis=1))
        return ties.stiffness[:, None] * (length - ties.length[:, None])

    def _response_to(self, place: int) -> tuple[Array, Array]:
        """Return displacements and movements of all bars under a unit pull of one [m/N]."""
        if place not in self._responses:
            load = np.zeros(self._system.dof_count)
            np.add.at(load, self._pulled[place], self._pull[place])
            response = self._factor.solve(load)
            self._responses[place] = response, self._movements(response)
        return self._responses[place]

    def _movements(self, u: Array) -> Array:
        """Return elongations of ties and movements of stays in displacements, ``(n_pull, ...)``."""
        return np.einsum("ik,ik...->i...", self._pull, u[self._pulled])

    def _turned(self, u: Array) -> Array:
        """Return what the tangents of the stays are more than at rest, ``(m, n_stay, 3, 3)``."""
        stays = self._system.stays
        q = (self._system.position[:, None] + u).T.ravel()
        tangent = copies(self._system, u.shape[1]).stays.tangent(q)
        more = tangent.reshape(3, 3, u.shape[1], len(stays)) - self._stays_at_rest[:, :, None]
        return more.transpose(2, 3, 0, 1)

    def _size(self, du: Array) -> float:
        return float(np.abs(du[self._system.translations]).max())

    # ---- iterations ----------------------------------------------------------------------------

    def _modified_newton(self, pushes: Sequence[Push]) -> list[_State]:
        """Iterate with the tangent at rest until every state is found or given up."""
        states = [_State(push, self._system.dof_count) for push in pushes]
        units = [self._units(push, self._factor) for push in pushes]
        running = list(range(len(pushes)))
        r = self._free(np.stack([state.load() for state in states], axis=1))
        while running:
            u = np.stack([states[i].u for i in running], axis=1)
            du = self._factor.solve(r)
            raw, moved, turned = self._axial_at(u), self._movements(du), self._turned(u)
            for k, i in enumerate(running):
                wires = self._wires(states[i], du[:, k], units[i])
                self._step(
                    states[i], du[:, k], Step(raw[:, k], moved[:, k], turned[k], wires), units[i]
                )
            running = [i for i in running if states[i].status is Status.RUNNING]
            if running:
                u = np.stack([states[i].u for i in running], axis=1)
                r = self._unbalanced(u, np.stack([states[i].load() for i in running], axis=1))
        return states

    def _units(self, push: Push, factor: BandedCholesky) -> Array:
        """Return displacements under unit forces on the wires; nothing where there is but one."""
        count = len(push.values) if len(push.values) > 1 else 0
        loads = np.zeros((self._system.dof_count, count))
        for wire in range(count):
            loads[:, wire] = push.load(np.eye(count)[wire], len(loads))
        return factor.solve(self._free(loads)) if count else loads

    def _wires(self, state: _State, du: Array, units: Array) -> Wires | None:
        """Return the wires under the head after a step; None where there is but one."""
        if not units.size:
            return None
        heights = state.push.heights(self._system.position + state.u + du)
        flexibility = np.stack([state.push.heights(unit) for unit in units.T], axis=1)
        return Wires(heights, flexibility, self._movements(units))

    def _step(self, state: _State, du: Array, step: Step, units: Array) -> None:
        """Correct a step for the bars and the shares of the wires, and take it."""
        try:
            change = self._bars.change(step)
        except np.linalg.LinAlgError:
            state.move(du, np.inf, self._increment)
            return
        for place, pull in zip(change.places, change.pulls, strict=True):
            du = du - pull * self._response_to(int(place))[0]
        if units.size:
            du = du + units @ change.shares
            state.shares = state.shares + change.shares
        state.move(du, self._size(du), self._increment)

    def _full_newton(self, push: Push) -> _State:
        """Iterate with the tangent at the state reached."""
        state = _State(push, self._system.dof_count)
        for _ in range(_FULL_ITERATIONS):
            state.iterations += 1
            u = state.u[:, None]
            taut = self._system.ties.acting(self._axial_at(u)[:, 0])
            tangent = self._tangent(self._system.position + state.u, taut) + self._beyond
            factor = BandedCholesky.of(tangent)
            if factor is None:
                state.status = Status.SINGULAR
                return state
            du = factor.solve(self._unbalanced(u, state.load()[:, None]))[:, 0]
            units = self._units(push, factor)
            wires = self._wires(state, du, units)
            if wires is not None:
                shares = level(wires.flexibility, wires.heights)
                state.shares, du = state.shares + shares, du + units @ shares
            size = self._size(du)
            if not np.isfinite(size):
                state.status = Status.NOT_FINITE
                return state
            slope = float(np.abs(du.reshape(-1, 6)[:, 3:]).max())
            state.u = state.u + du / max(1.0, slope / _SLOPE_STEP)
            if size <= self._increment:
                state.status = Status.DONE
                return state
        state.status = Status.NOT_CONVERGED
        return state


def _within(band: Array, in_corner: NDArray[np.bool_]) -> Array:
    """Return the entries of an upper band whose row and column are both chosen."""
    width = len(band) - 1
    column = np.arange(band.shape[1])
    row = np.maximum(column - width + np.arange(width + 1)[:, None], 0)
    return np.where(in_corner[row] & in_corner, band, 0.0)


def _symmetric(band: Array) -> Any:
    """Return a symmetric matrix in upper banded storage as a sparse one."""
    from scipy.sparse import coo_array

    depth, cols = np.nonzero(band)
    rows = cols - (len(band) - 1 - depth)
    off = rows != cols
    values = band[depth, cols]
    places = np.concatenate([rows, cols[off]]), np.concatenate([cols, rows[off]])
    size = band.shape[1]
    return coo_array((np.concatenate([values, values[off]]), places), shape=(size, size)).tocsr()
