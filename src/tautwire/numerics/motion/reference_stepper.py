"""The time integration in NumPy: modified Newton to a tolerance, or full Newton.

Each step solves ``M a + (1 + alpha) g - alpha g_n = 0`` with ``g = C v + Q - load - contact`` for
the end acceleration ``a``. The matrix of the static state, with every dropper taut, is factored
once per step size; it is turned with the wires (:mod:`tautwire.numerics.motion.corotation`). Slack
droppers enter through the residual. Each pantograph is eliminated exactly: with ``h`` its head
compliance over the step, the contact acts like a unilateral spring ``k_s/(1 + k_s h)`` between the
wire and the head's force-free position, and enters the linear solve as a rank-one term.

When the increments shrink by less than a factor 0.3 twice in a step, the matrix is factored anew
at the current state; when that does not help, the step is finished with full Newton. An iteration
that fails is begun again with full Newton from the wires where they are: long steps make the
prediction, with its accelerations kept, so poor that wires are pushed and the tangent is
indefinite.

A step makes a new state and leaves the old one alone, so that a state is its own mark.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.contact.path import ContactWirePath
from tautwire.numerics.motion.effective_matrix import (
    MOST_FACTORS,
    LineMatrices,
    StepCoefficients,
    StepFactors,
)
from tautwire.numerics.motion.pantograph import PantographStep
from tautwire.numerics.motion.step_solver import (
    Clock,
    PantographState,
    Prediction,
    State,
    Step,
    StepSolver,
    Touch,
    Watchdog,
    contact_forces,
)
from tautwire.numerics.motion.stepper import (
    SAME_TIME,
    PantographInput,
    StepBlock,
    StepCounters,
    StepOptions,
    reachable_tolerance,
)
from tautwire.numerics.network.system import System, internal_force, tie_axial_force
from tautwire.status import Status

Array = NDArray[Any]
Index = NDArray[np.int64]

_MOST_CHAINS = 64
"""Pantographs' solved steps that are kept, one per length of step; when full, all go."""


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
        self._tolerance = reachable_tolerance(system, options)
        self._inputs = tuple(pantographs)
        self._paths = tuple(
            ContactWirePath(path.nodes, system.cables.length[path.cables]) for path in system.paths
        )
        self._matrices = LineMatrices(system)
        self._factors = StepFactors(system, self._matrices, options)
        self._chains: dict[float, tuple[PantographStep, ...]] = {}
        self._systems: dict[float, System] = {}
        still = np.zeros_like(system.position)
        at_start = tuple(
            PantographState.at_rest(p.chain.stage_count, len(system.paths)) for p in pantographs
        )
        self._state = State(Clock(), system.position.copy(), still, still, still, at_start)

    @property
    def time(self) -> float:
        """Time reached [s]."""
        return self._state.clock.time

    @property
    def coordinates(self) -> Array:
        """Nodal coordinates at the time reached, ``(n_dof,)``."""
        return self._state.q

    @property
    def velocities(self) -> Array:
        """Nodal velocities at the time reached, ``(n_dof,)``."""
        return self._state.v

    def start_from(self, q: Array, v: Array) -> None:
        """Replace the state at time zero (plucked wires, wave tests); forces need not balance.

        Parameters
        ----------
        q, v : (n_dof,)
            Coordinates and velocities.
        """
        from scipy.sparse.linalg import spsolve

        system = self._system
        g = self._matrices.damping @ v + internal_force(system, q, v).nodal - system.load
        g = np.where(system.fixed, 0.0, g)
        free = np.flatnonzero(~system.fixed)
        a = np.zeros_like(q)
        mass = self._matrices.mass.tocsc()[free][:, free]
        a[free] = spsolve(mass, -g[free])
        self._state = replace(self._state, q=q.copy(), v=v.copy(), a=a, g=g)

    def mark(self) -> State:
        """Return the present state, to come back to."""
        return self._state

    def rewind(self, mark: object) -> None:
        """Go back to a state returned by ``mark``; counters keep counting."""
        if not isinstance(mark, State):
            raise TypeError("rewind takes what mark returned")
        self._state = mark

    def advance(
        self, steps: int, time_step: float | None = None, *, until_crossing: bool = False
    ) -> StepBlock:
        """Take up to ``steps`` steps: see :meth:`.Stepper.advance`."""
        records: list[_Record] = []
        status, refused = Status.RUNNING, None
        for _ in range(steps):
            status, state = self._step(time_step or self._options.time_step)
            if state is None:
                break
            if until_crossing and _changes_contact(self._state, state):
                refused = np.array([p.gap for p in state.pantographs])
                break
            self._state = state
            self.counters.steps += 1
            records.append(self._record())
        return self._block(records, status, refused)

    def _begin(self, time_step: float) -> Step:
        """Predict wires and pantographs at the end of a step."""
        start, integrator, dt = self._state, self._options.integrator, time_step
        c = StepCoefficients.of(integrator, dt)
        clock = start.clock.after(dt)
        return Step(
            c,
            clock,
            start,
            start.q + dt * start.v + dt**2 * (0.5 - integrator.beta) * start.a,
            start.v + dt * (1.0 - integrator.gamma) * start.a,
            tuple(self._predict(c, start.clock.time, clock.time)),
        )

    def _predict(self, c: StepCoefficients, begin: float, end: float) -> Iterator[Prediction]:
        """Advance the pantographs that are on the line without contact force."""
        k = self._options.contact_stiffness
        chains = self._chains_for(c.time_step)
        for i, (given, chain) in enumerate(zip(self._inputs, chains, strict=True)):
            if end < given.start_time - SAME_TIME:
                continue
            state = self._state.pantographs[i]
            before = chain.internal(state.z, state.v, given.external(begin))
            z, v, known = chain.predict(state.z, state.v, state.a, before, state.force)
            a_free = chain.acceleration(z, v, known, given.external(end))
            head = float(given.start_height + z[0] + c.to_position * a_free[0])
            plane, rise = given.plane(end), float(given.unevenness(np.array(end)))
            yield Prediction(i, chain, plane, rise, head, k, given.reach, z, v, a_free)

    def _chains_for(self, time_step: float) -> tuple[PantographStep, ...]:
        """Return the pantographs' equations for a step; those of some steps are kept."""
        if time_step not in self._chains:
            if len(self._chains) == _MOST_CHAINS:
                self._chains.clear()
            self._chains[time_step] = tuple(
                PantographStep(p.chain, self._options.integrator, time_step) for p in self._inputs
            )
        return self._chains[time_step]

    def _system_for(self, time_step: float) -> System:
        """Return the line as it is integrated with a step."""
        stiffening = self._options.stiffening
        if stiffening is None:
            return self._system
        if time_step not in self._systems:
            if len(self._systems) == MOST_FACTORS:
                self._systems.clear()
            self._systems[time_step] = stiffening.applied_to(self._system, time_step)
        return self._systems[time_step]

    def _touch(self, q: Array, step: Step) -> list[Touch] | None:
        """Return the contacts at an iterate; None when a pantograph has left the wire."""
        touches = []
        for p in step.predictions:
            elements = step.start.pantographs[p.index].elements
            found = [
                (number, point)
                for number, path in enumerate(self._paths)
                if (point := path.locate(q, p.plane, elements[number])) is not None
                and abs(point.lateral) <= p.reach
            ]
            if not found:
                return None
            forces = contact_forces(p, np.array([point.height + p.rise for _, point in found]))
            touches += [
                Touch(p, number, point, float(force))
                for (number, point), force in zip(found, forces, strict=True)
            ]
        return touches

    def _residual(self, step: Step, q: Array, v: Array, a: Array, touches: list[Touch]) -> Array:
        """Return ``alpha g_n - M a - (1 + alpha) g``, zero at fixed degrees of freedom."""
        system = self._system_for(step.c.time_step)
        g = self._matrices.damping @ v
        g += internal_force(system, q, v).nodal
        g -= system.load
        for touch in touches:
            g[touch.point.dofs] -= touch.force * touch.point.push
        alpha = self._options.integrator.alpha
        r = alpha * step.start.g - self._matrices.mass @ a - step.c.weight * g
        r[system.fixed] = 0.0
        return r

    def _step(self, time_step: float) -> tuple[Status, State | None]:
        """Solve one step; return the state at its end, None when it fails."""
        step, full = self._begin(time_step), self._options.full_newton
        # An iteration that is lost shows in its increment.
        with np.errstate(over="ignore", invalid="ignore"):
            status, a = self._iterate(step, step.start.a, full_newton=full)
            if a is None:
                status, a = self._iterate(step, step.resting(), full_newton=True)
        return (status, None) if a is None else self._end(step, a)

    def _iterate(self, step: Step, a: Array, *, full_newton: bool) -> tuple[Status, Array | None]:
        """Find the end acceleration from a first guess; None when that fails.

        An iterate whose tangent is not positive definite is taken back by half, towards the last
        one where it was.
        """
        options, sound = self._options, None
        watch = Watchdog(full_newton=full_newton)
        solver = StepSolver(self._system, self._factors, step, full_newton=full_newton)
        for _ in range(options.iterations):
            q, v = step.position(a), step.velocity(a)
            touches = self._touch(q, step)
            if touches is None:
                return Status.OFF_THE_LINE, None
            if watch.wants_factor:
                self.counters.refactorisations += 1
                if not solver.renew(q, v, only_taut=watch.full_newton):
                    if sound is None:
                        return Status.SINGULAR, None
                    a = 0.5 * (a + sound)
                    continue
                sound = a if watch.full_newton else None
            r = self._residual(step, q, v, a, touches)
            da = solver.solve(r, touches)
            if da is None:
                return Status.SINGULAR, None
            a = a + da
            self.counters.iterations += 1
            moved = np.abs(da[self._system.translations]).max()
            increment = step.c.to_position * float(moved)
            if not np.isfinite(increment):
                return Status.NOT_FINITE, None
            if increment <= self._tolerance and watch.count > 0:
                self.counters.full_newton_steps += watch.full_newton
                return Status.RUNNING, a
            watch.observe(increment)
        return Status.NOT_CONVERGED, None

    def _end(self, step: Step, a: Array) -> tuple[Status, State | None]:
        """Return the state at the end of a converged step."""
        alpha, start = self._options.integrator.alpha, step.start
        q, g = step.position(a), start.g
        if alpha:
            g = (alpha * start.g - self._matrices.mass @ a) / step.c.weight
        touches = self._touch(q, step)
        if touches is None:
            return Status.OFF_THE_LINE, None
        pantographs = list(start.pantographs)
        for p in step.predictions:
            own = [touch for touch in touches if touch.prediction is p]
            before = start.pantographs[p.index]
            pantographs[p.index] = _moved(self._inputs[p.index], step.c, before, own)
        return Status.RUNNING, State(step.clock, q, step.velocity(a), a, g, tuple(pantographs))

    def _record(self) -> _Record:
        state = self._state
        pantographs = state.pantographs
        return _Record(
            self.time,
            np.array([p.force for p in pantographs]),
            np.array([p.gap for p in pantographs]),
            np.array([p.wire_height for p in pantographs]),
            np.array([force for p in pantographs for force in p.forces]),
            np.concatenate([p.z for p in pantographs]) if pantographs else np.empty(0),
            tie_axial_force(self._system, state.q, state.v),
            state.q[self._observed],
        )

    def _block(self, records: list[_Record], status: Status, refused: Array | None) -> StepBlock:
        stages = sum(p.chain.stage_count for p in self._inputs)
        count = len(self._inputs)

        def stack(name: str, width: int) -> Array:
            rows = [getattr(r, name) for r in records]
            return np.array(rows) if rows else np.empty((0, width))

        return StepBlock(
            time=np.array([r.time for r in records]),
            contact_force=stack("contact_force", count),
            gap=stack("gap", count),
            wire_height=stack("wire_height", count),
            path_force=stack("path_force", count * len(self._paths)).reshape(
                len(records), count, len(self._paths)
            ),
            stages=stack("stages", stages),
            dropper_force=stack("dropper_force", len(self._system.ties)),
            observed=stack("observed", len(self._observed)),
            status=status,
            refused_gap=refused,
        )


@dataclass(frozen=True, eq=False)
class _Record:
    time: float
    contact_force: Array
    gap: Array
    wire_height: Array
    path_force: Array
    stages: Array
    dropper_force: Array
    observed: Array


def _moved(
    given: PantographInput, c: StepCoefficients, before: PantographState, touches: list[Touch]
) -> PantographState:
    """Return a pantograph at the end of a step whose contact forces are known."""
    p, force = touches[0].prediction, sum(touch.force for touch in touches)
    a = p.a_free - c.weight * force * p.chain.head_response
    z, v = p.z + c.to_position * a, p.v + c.to_velocity * a
    nearest = min(touches, key=lambda touch: touch.surface)
    gap = nearest.surface - (given.start_height + float(z[0]))
    forces, elements = [np.nan] * len(before.forces), list(before.elements)
    for touch in touches:
        forces[touch.path], elements[touch.path] = touch.force, touch.point.element
    return PantographState(
        z, v, a, force, gap, nearest.point.height, tuple(forces), tuple(elements)
    )


def _changes_contact(before: State, after: State) -> bool:
    """Tell whether a contact opens or closes; one that was not yet made does neither."""
    return any(
        not np.isnan(old.gap) and (old.gap < 0.0) != (new.gap < 0.0)
        for old, new in zip(before.pantographs, after.pantographs, strict=True)
    )
