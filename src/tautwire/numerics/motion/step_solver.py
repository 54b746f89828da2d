"""One step of the NumPy time integration: where it starts, what it predicts, how it is solved."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.contact.path import ContactPoint
from tautwire.numerics.motion.corotation import NodeRotation, unit_tangents
from tautwire.numerics.motion.effective_matrix import StepCoefficients, StepFactors
from tautwire.numerics.motion.pantograph import PantographStep
from tautwire.numerics.network.system import System, tie_axial_force
from tautwire.numerics.track import Frames

Array = NDArray[Any]

_SLOW = 0.3
"""Contraction of an iteration above which it is slow: from there on a new factor, which costs about
what three iterations do, pays within the digits that are wanted. At 1 ms no step is slow; at 3 ms
0.2, 0.3 and 0.5 give the same forces to 3e-4 N and, in this backend, 5.6, 5.6 and 3.7 s for 4
spans."""
_SLOW_ALLOWED = 2
"""Slow iterations of a step before a new factor: one may be a dropper that goes slack."""


@dataclass(frozen=True)
class Clock:
    """The time after ``count`` equal steps from ``since``: no rounding adds up in between."""

    since: float = 0.0
    count: int = 0
    time_step: float = 0.0

    @property
    def time(self) -> float:
        """Time [s]."""
        return self.since + self.count * self.time_step

    def counting(self, time_step: float) -> Clock:
        """Return the clock that shows the same time and counts steps of some size [s]."""
        return self if time_step == self.time_step else Clock(self.time, 0, time_step)

    def after(self, time_step: float, steps: int = 1) -> Clock:
        """Return the clock after more steps of some size [s]."""
        begin = self.counting(time_step)
        return Clock(begin.since, begin.count + steps, time_step)


@dataclass(frozen=True, eq=False)
class PantographState:
    """Where one pantograph is; heights count from the start.

    ``forces`` are those of the paths (n_path,), NaN where a path is out of reach; ``elements``
    where each path was met last. Gap and height belong to the nearest wire.
    """

    z: Array
    v: Array
    a: Array
    force: float = 0.0
    gap: float = float("nan")
    wire_height: float = float("nan")
    forces: tuple[float, ...] = ()
    elements: tuple[int, ...] = ()

    @classmethod
    def at_rest(cls, stages: int, paths: int) -> PantographState:
        """Return a pantograph with some stages that has not entered a line with some paths."""
        still = np.zeros(stages)
        return cls(still, still, still, forces=(np.nan,) * paths, elements=(0,) * paths)


@dataclass(frozen=True, eq=False)
class State:
    """Everything a step starts from; never changed, so that a state is its own mark."""

    clock: Clock
    q: Array
    v: Array
    a: Array
    g: Array
    pantographs: tuple[PantographState, ...]


@dataclass(frozen=True, eq=False)
class Prediction:
    """What is known of one pantograph in a step before its contact force is.

    ``plane`` is the frame of the track where it stands, ``rise`` the height of the running surface
    above the wires, ``stiffness`` that of the contact with each of them, ``reach`` how far to
    either side of the track the head does.
    """

    index: int
    chain: PantographStep
    plane: Frames
    rise: float
    head_free: float
    stiffness: float
    reach: float
    z: Array
    v: Array
    a_free: Array


@dataclass(frozen=True, eq=False)
class Step:
    """A step to be solved: the predicted state with zero end acceleration."""

    c: StepCoefficients
    clock: Clock
    start: State
    q_p: Array
    v_p: Array
    predictions: tuple[Prediction, ...]

    def position(self, a: Array) -> Array:
        """Return the coordinates at the end for an end acceleration."""
        return self.q_p + self.c.to_position * a

    def velocity(self, a: Array) -> Array:
        """Return the velocities at the end for an end acceleration."""
        return self.v_p + self.c.to_velocity * a

    def resting(self) -> Array:
        """Return the end acceleration that leaves the wires where they are."""
        return (self.start.q - self.q_p) / self.c.to_position


@dataclass(frozen=True, eq=False)
class Touch:
    """Contact of one pantograph with one path at an iterate."""

    prediction: Prediction
    path: int
    point: ContactPoint
    force: float

    @property
    def surface(self) -> float:
        """Height of the running surface [m]."""
        return self.point.height + self.prediction.rise


def contact_forces(prediction: Prediction, surfaces: Array) -> Array:
    """Return the forces between a head and the wires above it, ``(n_wire,)`` [N].

    A head on its own would rise to ``z``; under forces f it stands lower by the compliance H times
    their sum. So ``f = k max(0, z - H sum(f) - surface)``: of the lowest wires the most that all
    press on it are closed (1/k + H is positive definite, so there is one such set).

    Parameters
    ----------
    prediction
        The head.
    surfaces : (n_wire,) m
        Heights of the running surfaces.
    """
    k, compliance = prediction.stiffness, prediction.chain.compliance
    depth = prediction.head_free - surfaces
    total = pressed = 0.0
    for count, own in enumerate(np.sort(depth)[::-1].tolist(), start=1):
        if own <= compliance * total:
            break
        pressed += own
        total = k * pressed / (1.0 + count * k * compliance)
    return k * np.maximum(0.0, depth - compliance * total)


class StepSolver:
    """Solves for the increments of one step: kept factor, node rotation, rank-one contacts."""

    def __init__(
        self, system: System, factors: StepFactors, step: Step, *, full_newton: bool
    ) -> None:
        self._system, self._factors, self._step = system, factors, step
        self._columns: Array | None = None
        self._pairs: list[tuple[int, int]] = []
        self._factor = None if full_newton else factors.get(step.c.time_step)
        if self._factor is not None:
            ahead = step.start.q + step.c.time_step * step.start.v
            self._rotation = NodeRotation(self._factor.tangents, unit_tangents(ahead))

    def renew(self, q: Array, v: Array, *, only_taut: bool) -> bool:
        """Factor the matrix at an iterate; without its slack ties when ``only_taut``.

        False when it could not be factored.
        """
        dt, self._columns = self._step.c.time_step, None
        if only_taut:
            taut = self._system.ties.acting(tie_axial_force(self._system, q, v))
            self._factor = self._factors.make(q, dt, taut)
        else:
            self._factor = self._factors.renew(q, dt)
        if self._factor is not None:
            self._rotation = NodeRotation(self._factor.tangents, self._factor.tangents)
        return self._factor is not None

    def solve(self, r: Array, touches: list[Touch]) -> Array | None:
        """Solve ``(A + sum kappa N G') da = r`` with the contacts that are closed.

        None when the matrix could not be factored.
        """
        if self._factor is None:
            return None
        x = self._precondition(r)
        pairs = [(touch.prediction.index, touch.path) for touch in touches]
        if self._columns is None or pairs != self._pairs:
            self._columns, self._pairs = self._contact_columns(touches), pairs
        closed = [i for i, touch in enumerate(touches) if touch.force > 0.0]
        if not closed:
            return x
        c, columns = self._step.c, self._columns
        y = np.empty(len(closed))
        small = np.empty((len(closed), len(closed)))
        for row, i in enumerate(closed):
            point = touches[i].point
            y[row] = _height_rate(point, x)
            small[row] = [_height_rate(point, columns[:, j]) for j in closed]
            small[row] += _softness(touches, i, closed) / (c.weight * c.to_position)
        return x - columns[:, closed] @ np.linalg.solve(small, y)

    def _contact_columns(self, touches: list[Touch]) -> Array:
        """Return ``A^-1 N`` for every pantograph and path, ``(n_dof, n_touch)``."""
        columns = np.zeros((self._system.dof_count, len(touches)))
        for i, touch in enumerate(touches):
            columns[touch.point.dofs, i] = touch.point.push
            columns[:, i] = self._precondition(columns[:, i])
        return columns

    def _precondition(self, r: Array) -> Array:
        assert self._factor is not None
        x = self._factor.solve(r, self._rotation)
        x[self._system.fixed] = 0.0
        return x


def _softness(touches: list[Touch], i: int, closed: list[int]) -> Array:
    """Return a row of ``1/k + H``: what the gaps of closed contacts give way per force of one."""
    own = touches[i].prediction
    row = np.array(
        [own.chain.compliance * (touches[j].prediction.index == own.index) for j in closed]
    )
    row[closed.index(i)] += 1.0 / own.stiffness
    return row


class Watchdog:
    """Watches the contraction of one step's iteration and says when a new factor is needed."""

    def __init__(self, *, full_newton: bool) -> None:
        self.full_newton = full_newton
        self.wants_factor = full_newton
        self.count = 0
        self._last = np.inf
        self._slow = 0

    def observe(self, increment: float) -> None:
        """Take note of the increment of an iteration."""
        self.count += 1
        if self.full_newton:
            return
        is_slow = increment > _SLOW * self._last
        self._slow += is_slow
        self._last = increment
        self.wants_factor = is_slow and self._slow == _SLOW_ALLOWED
        if self._slow > 2 * _SLOW_ALLOWED:
            self.full_newton = self.wants_factor = True


def _height_rate(point: ContactPoint, x: Array) -> float:
    """Return the gradient of the touched point's height along ``x``."""
    return float(np.sum(point.gradient * x[point.dofs]))
