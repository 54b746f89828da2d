"""The time integration in NumPy: modified Newton to a tolerance, or full Newton.

Each step solves ``M a + (1 + alpha) g - alpha g_n = 0`` with ``g = C v + Q - load - contact`` for
the end acceleration ``a``. The matrix of the static state, with every dropper taut, is factored
once; it is turned with the wires (:mod:`tautwire.numerics.corotation`). Slack droppers enter
through the residual. Each pantograph is eliminated exactly: with ``h`` its head compliance over
the step, the contact acts like a unilateral spring ``k_s/(1 + k_s h)`` between the wire and the
head's force-free position, and enters the linear solve as a rank-one term.

When the increments shrink by less than a factor 0.3 twice in a step, the matrix is factored anew
at the current state; when that does not help, the step is finished with full Newton.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.banded import BandedCholesky, Pattern
from tautwire.numerics.contact import ContactPoint, ContactWirePath
from tautwire.numerics.corotation import NodeRotation, unit_tangents
from tautwire.numerics.pantograph import PantographStep
from tautwire.numerics.stepper import PantographInput, StepBlock, StepCounters, StepOptions
from tautwire.numerics.system import (
    System,
    TangentParts,
    dropper_axial_force,
    internal_force,
    lumped_mass,
    mass_parts,
    tangent_parts,
)
from tautwire.status import Status

Array = NDArray[Any]
Index = NDArray[np.int64]

_SLOW = 0.3
_SLOW_ALLOWED = 2


@dataclass
class _PantographState:
    """Where one pantograph is; heights count from the start."""

    z: Array
    v: Array
    a: Array
    force: float = 0.0
    element: int = 0


@dataclass(frozen=True)
class _Prediction:
    """What is known of one pantograph in a step before its contact force is."""

    index: int
    x: float
    head_free: float
    z: Array
    v: Array
    a_free: Array


@dataclass(frozen=True)
class _Touch:
    """Contact of one pantograph at an iterate."""

    index: int
    point: ContactPoint
    force: float


class _Matrices:
    """Mass, damping and static stiffness of a line, and the entries from which A is summed."""

    def __init__(self, system: System) -> None:
        self.pattern = Pattern(system)
        self._system = system
        self._mass_values = self.pattern.values(mass_parts(system))
        self._lumped = lumped_mass(system)
        parts = tangent_parts(system, system.position)
        rayleigh = TangentParts(
            parts.cables, 0.0 * parts.droppers, parts.arms, 0.0 * parts.springs
        )
        supports = TangentParts(
            0.0 * parts.cables, 0.0 * parts.droppers, 0.0 * parts.arms, system.spring_damping
        )
        a_r, b_r = system.damping_mass, system.damping_stiffness
        self._damping_values = (
            a_r * self._mass_values
            + b_r * self.pattern.values(rayleigh)
            + self.pattern.values(supports)
        )
        self.mass = self.pattern.csr(self._mass_values, self._lumped)
        self.damping = self.pattern.csr(self._damping_values, a_r * self._lumped)
        self._lumped_damping = a_r * self._lumped

    def effective_band(self, parts: TangentParts, c: float, k: float) -> Array:
        """Return ``M + c C + k K`` for a tangent K, droppers damped like ``b_R K``."""
        b_r = self._system.damping_stiffness
        scaled = TangentParts(
            k * parts.cables, (k + c * b_r) * parts.droppers, k * parts.arms, k * parts.springs
        )
        values = self._mass_values + c * self._damping_values + self.pattern.values(scaled)
        return self.pattern.upper_band(values, self._lumped + c * self._lumped_damping)


class ReferenceStepper:
    """Time integration of one line and its pantographs in NumPy.

    Parameters
    ----------
    system
        The line in its static state.
    pantographs
        Their chains and ways along the line.
    options
        Integrator, step, tolerance.
    observed
        Degrees of freedom whose coordinates are recorded at every step.
    """

    def __init__(
        self,
        system: System,
        pantographs: Sequence[PantographInput],
        options: StepOptions,
        observed: Index,
    ) -> None:
        self.counters = StepCounters()
        self._system, self._options, self._observed = system, options, observed
        self._inputs = tuple(pantographs)
        self._path = ContactWirePath(
            system.contact_nodes, system.cable_length[: len(system.contact_nodes) - 1]
        )
        self._matrices = _Matrices(system)
        self._steps = [
            PantographStep(p.chain, options.integrator, options.time_step) for p in pantographs
        ]
        self._states = [
            _PantographState(*np.zeros((3, p.chain.stage_count))) for p in self._inputs
        ]
        self._set_coefficients()
        self._q = system.position.copy()
        self._v = np.zeros_like(self._q)
        self._a = np.zeros_like(self._q)
        self._g = np.zeros_like(self._q)
        self._count = 0
        self._factor_at(self._q)

    def _set_coefficients(self) -> None:
        dt, integrator = self._options.time_step, self._options.integrator
        self._weight = 1.0 + integrator.alpha
        self._to_velocity = integrator.gamma * dt
        self._to_position = integrator.beta * dt**2

    @property
    def time(self) -> float:
        """Time reached [s]."""
        return self._count * self._options.time_step

    @property
    def coordinates(self) -> Array:
        """Nodal coordinates at the time reached, ``(n_dof,)``."""
        return self._q

    @property
    def velocities(self) -> Array:
        """Nodal velocities at the time reached, ``(n_dof,)``."""
        return self._v

    def start_from(self, q: Array, v: Array) -> None:
        """Replace the state at time zero (plucked wires, wave tests); forces need not balance.

        Parameters
        ----------
        q, v : (n_dof,)
            Coordinates and velocities.
        """
        from scipy.sparse.linalg import spsolve

        self._q, self._v = q.copy(), v.copy()
        system = self._system
        g = self._matrices.damping @ v + internal_force(system, q, v).nodal - system.load
        free = np.flatnonzero(~system.fixed)
        self._g = np.where(system.fixed, 0.0, g)
        self._a = np.zeros_like(q)
        mass = self._matrices.mass.tocsc()[free][:, free]
        self._a[free] = spsolve(mass, -self._g[free])

    def advance(self, steps: int) -> StepBlock:
        """Take up to ``steps`` steps; fewer when one fails (see the block's status)."""
        records: list[_Record] = []
        status = Status.RUNNING
        for _ in range(steps):
            status = self._step()
            if status is not Status.RUNNING:
                break
            records.append(self._record())
        return _block(records, self, status)

    def _factor_at(self, q: Array, taut: NDArray[np.bool_] | None = None) -> bool:
        """Factor the effective matrix at ``q``; False when it is not positive definite."""
        parts = tangent_parts(self._system, q, taut=taut)
        band = self._matrices.effective_band(
            parts, self._weight * self._to_velocity, self._weight * self._to_position
        )
        factor = BandedCholesky.of(band)
        if factor is None:
            return False
        self._factor, self._reference = factor, unit_tangents(q)
        return True

    def _predict(self, time: float) -> list[_Prediction]:
        """Advance the pantographs that are on the line without contact force."""
        predictions = []
        for i, (given, step, state) in enumerate(
            zip(self._inputs, self._steps, self._states, strict=True)
        ):
            if time < given.start_time - 1e-12:
                continue
            before = step.internal(state.z, state.v, given.external(time - self._options.time_step))
            z, v, known = step.predict(state.z, state.v, state.a, before, state.force)
            a_free = step.acceleration(z, v, known, given.external(time))
            head = given.start_height + z[0] + self._to_position * a_free[0]
            predictions.append(_Prediction(i, given.position(time), float(head), z, v, a_free))
        return predictions

    def _touch(self, q: Array, predictions: list[_Prediction]) -> list[_Touch] | None:
        """Return the contacts at an iterate; None when a pantograph has left the wire."""
        touches = []
        for p in predictions:
            point = self._path.locate(q, p.x, self._states[p.index].element)
            if point is None:
                return None
            force = self._stiffness(p.index) * max(0.0, p.head_free - point.height)
            touches.append(_Touch(p.index, point, force))
        return touches

    def _stiffness(self, index: int) -> float:
        """Contact stiffness in series with the head's compliance over a step [N/m]."""
        k = self._options.contact_stiffness
        return k / (1.0 + k * self._steps[index].compliance)

    def _residual(self, q: Array, v: Array, a: Array, touches: list[_Touch]) -> Array:
        """Return ``alpha g_n - M a - (1 + alpha) g``, zero at fixed degrees of freedom."""
        system = self._system
        g = self._matrices.damping @ v
        g += internal_force(system, q, v).nodal
        g -= system.load
        for touch in touches:
            g[touch.point.dofs_z] -= touch.force * touch.point.row
        r = self._options.integrator.alpha * self._g - self._matrices.mass @ a - self._weight * g
        r[system.fixed] = 0.0
        return r

    def _step(self) -> Status:
        dt, integrator = self._options.time_step, self._options.integrator
        time = (self._count + 1) * dt
        q_p = self._q + dt * self._v + dt**2 * (0.5 - integrator.beta) * self._a
        v_p = self._v + dt * (1.0 - integrator.gamma) * self._a
        predictions = self._predict(time)
        a = self._a.copy()
        watch = _Watchdog(self._options.full_newton)
        rotation = NodeRotation(self._reference, unit_tangents(self._q + dt * self._v))
        columns: Array | None = None
        for _ in range(self._options.iterations):
            q, v = q_p + self._to_position * a, v_p + self._to_velocity * a
            touches = self._touch(q, predictions)
            if touches is None:
                return Status.OFF_THE_LINE
            r = self._residual(q, v, a, touches)
            if watch.wants_factor:
                taut = dropper_axial_force(self._system, q, v) > 0.0
                if not self._factor_at(q, taut if watch.full_newton else None):
                    return Status.SINGULAR
                rotation, columns = NodeRotation(self._reference, self._reference), None
                self.counters.refactorisations += 1
            if columns is None:
                columns = self._contact_columns(touches, rotation)
            da = self._solve(r, touches, columns, rotation)
            a += da
            self.counters.iterations += 1
            increment = self._to_position * float(np.abs(da[self._system.translations]).max())
            if not np.isfinite(increment):
                return Status.NOT_FINITE
            if increment <= self._options.tolerance and watch.count > 0:
                self._accept(q_p, v_p, a, predictions)
                self.counters.full_newton_steps += watch.full_newton
                return Status.RUNNING
            watch.observe(increment)
        return Status.NOT_CONVERGED

    def _contact_columns(self, touches: list[_Touch], rotation: NodeRotation) -> Array:
        """Return ``A^-1 N`` for every pantograph on the line, ``(n_dof, n_touch)``."""
        columns = np.zeros((self._system.dof_count, len(touches)))
        for i, touch in enumerate(touches):
            columns[touch.point.dofs_z, i] = touch.point.row
        for i in range(len(touches)):
            columns[:, i] = self._precondition(columns[:, i], rotation)
        return columns

    def _precondition(self, r: Array, rotation: NodeRotation) -> Array:
        x = rotation.forward(self._factor.solve(rotation.backward(r)))
        x[self._system.fixed] = 0.0
        return x

    def _solve(
        self, r: Array, touches: list[_Touch], columns: Array, rotation: NodeRotation
    ) -> Array:
        """Solve ``(A + sum kappa N G') da = r`` with the contacts that are closed."""
        x = self._precondition(r, rotation)
        closed = [i for i, touch in enumerate(touches) if touch.force > 0.0]
        if not closed:
            return x
        y = np.empty(len(closed))
        small = np.empty((len(closed), len(closed)))
        for row, i in enumerate(closed):
            point = touches[i].point
            y[row] = _height_rate(point, x)
            small[row] = [_height_rate(point, columns[:, j]) for j in closed]
            kappa = self._weight * self._stiffness(touches[i].index) * self._to_position
            small[row, row] += 1.0 / kappa
        return x - columns[:, closed] @ np.linalg.solve(small, y)

    def _accept(
        self, q_p: Array, v_p: Array, a: Array, predictions: list[_Prediction]
    ) -> None:
        """Make the converged end of the step the new state."""
        alpha = self._options.integrator.alpha
        self._q, self._v = q_p + self._to_position * a, v_p + self._to_velocity * a
        if alpha:
            self._g = (alpha * self._g - self._matrices.mass @ a) / self._weight
        self._a = a
        self._count += 1
        self.counters.steps += 1
        self._touches = self._touch(self._q, predictions) or []
        self._predictions = predictions
        for p, touch in zip(predictions, self._touches, strict=True):
            state, step = self._states[p.index], self._steps[p.index]
            state.a = p.a_free - self._weight * touch.force * step.head_response
            state.z = p.z + self._to_position * state.a
            state.v = p.v + self._to_velocity * state.a
            state.force, state.element = touch.force, touch.point.element

    def _record(self) -> _Record:
        count = len(self._inputs)
        gap = np.full(count, np.nan)
        height = np.full(count, np.nan)
        for touch in self._touches:
            i = touch.index
            head = self._inputs[i].start_height + self._states[i].z[0]
            gap[i], height[i] = touch.point.height - head, touch.point.height
        return _Record(
            self.time,
            np.array([s.force for s in self._states]),
            gap,
            height,
            np.concatenate([s.z for s in self._states]) if count else np.empty(0),
            dropper_axial_force(self._system, self._q, self._v),
            self._q[self._observed],
        )


@dataclass(frozen=True, eq=False)
class _Record:
    time: float
    contact_force: Array
    gap: Array
    wire_height: Array
    stages: Array
    dropper_force: Array
    observed: Array


class _Watchdog:
    """Watches the contraction of one step's iteration and says when a new factor is needed."""

    def __init__(self, full_newton: bool) -> None:
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
    along = point.row @ x[point.dofs_x]
    return float(point.row @ x[point.dofs_z] - point.slope * along)


def _block(records: list[_Record], stepper: ReferenceStepper, status: Status) -> StepBlock:
    def stack(name: str, width: int) -> Array:
        rows = [getattr(r, name) for r in records]
        return np.array(rows) if rows else np.empty((0, width))

    inputs, system = stepper._inputs, stepper._system
    return StepBlock(
        time=np.array([r.time for r in records]),
        contact_force=stack("contact_force", len(inputs)),
        gap=stack("gap", len(inputs)),
        wire_height=stack("wire_height", len(inputs)),
        stages=stack("stages", sum(p.chain.stage_count for p in inputs)),
        dropper_force=stack("dropper_force", len(system.dropper_length)),
        observed=stack("observed", len(stepper._observed)),
        status=status,
    )
