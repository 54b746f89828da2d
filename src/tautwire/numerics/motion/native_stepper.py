"""The time integration by the compiled core.

The algorithm is that of :mod:`tautwire.numerics.motion.reference_stepper`; this
module translates between the arrays of a line and those of the core, station by station.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.motion.dispersion import WaveStiffening
from tautwire.numerics.motion.step_solver import Clock
from tautwire.numerics.motion.stepper import (
    PantographInput,
    StepBlock,
    StepCounters,
    StepOptions,
    reachable_tolerance,
)
from tautwire.numerics.network.parts import BOTH_WAYS, TENSION_ONLY, Grounds
from tautwire.numerics.network.system import System
from tautwire.status import Status

Array = NDArray[Any]
Index = NDArray[np.int64]

_CHUNK = 100
_SAME_TIME = 1e-12
_RUNNING, _CROSSING = 0, 5
_OUTCOMES = {
    1: Status.NOT_CONVERGED,
    2: Status.SINGULAR,
    3: Status.NOT_FINITE,
    4: Status.OFF_THE_LINE,
}


def cable_order(system: System) -> Index | None:
    """Return the wire elements ordered contact wire first, each from left to right.

    None when the line is not made of two continuous wires whose nodes stand side by side,
    ``2*station + wire``, with droppers within a station and arms at the contact wire.

    Parameters
    ----------
    system
        The line.
    """
    count = system.node_count // 2
    nodes, ties, arms = system.cables.nodes, system.ties, system.stays.node
    left, right = nodes.T
    lower = ties.nodes[:, 1]
    order = np.lexsort((left, left % 2))
    expected = (2 * np.arange(count - 1) + np.arange(2)[:, None]).ravel()
    is_two_wires = (
        system.node_count == 2 * count
        and len(system.paths) == 1
        and len(left) == len(expected)
        and np.array_equal(left[order], expected)
        and np.array_equal(right, left + 2)
        and np.array_equal(system.paths[0].nodes, 2 * np.arange(count))
        and np.array_equal(ties.nodes[:, 0], lower + 1)
        and not (lower % 2).any()
        and not (arms % 2).any()
        and len(np.unique(lower)) == len(lower)
        and len(np.unique(arms)) == len(arms)
        and len(system.clamps) == 0
        and (ties.law == TENSION_ONLY).all()
        and (system.stays.law == BOTH_WAYS).all()
        and _is_diagonal(system.grounds)
    )
    return order if is_two_wires else None


def _is_diagonal(grounds: Grounds) -> bool:
    """Tell whether grounds act along the axes only, one at most on every coordinate."""
    across = ~np.eye(3, dtype=bool)
    return (
        not grounds.stiffness[:, across].any()
        and not grounds.damping[:, across].any()
        and len(np.unique(grounds.node)) == len(grounds.node)
    )


@dataclass(frozen=True, eq=False)
class _Mark:
    """A state of the core and the time it belongs to."""

    clock: Clock
    state: Array


class NativeStepper:
    """Time integration of one line and its pantographs by the compiled core.

    Parameters
    ----------
    core
        The compiled module.
    system
        The line in its static state; :func:`cable_order` must accept it.
    pantographs
        Their chains and ways along the line.
    options
        Integrator, step, tolerance.
    observed
        Degrees of freedom whose coordinates are recorded at every step.
    """

    def __init__(
        self,
        core: ModuleType,
        system: System,
        pantographs: Sequence[PantographInput],
        options: StepOptions,
        observed: Index,
    ) -> None:
        self.counters = StepCounters()
        self._system, self._options = system, options
        self._inputs = tuple(pantographs)
        self._observed = np.ascontiguousarray(observed, dtype=np.int64)
        self._clock = Clock()
        self._core = core.Stepper(
            _line_arrays(system, options.stiffening),
            _scheme(options, reachable_tolerance(system, options)),
        )
        for given in self._inputs:
            chain = given.chain
            self._core.add_pantograph(
                np.ascontiguousarray(chain.mass, dtype=float),
                chain.chain_matrix(chain.stiffness),
                chain.chain_matrix(chain.damping),
                given.start_height,
            )

    @property
    def time(self) -> float:
        """Time reached [s]."""
        return self._clock.time

    @property
    def coordinates(self) -> Array:
        """Nodal coordinates at the time reached, ``(n_dof,)``."""
        out = np.empty(self._system.dof_count)
        self._core.coordinates(out)
        return out

    @property
    def velocities(self) -> Array:
        """Nodal velocities at the time reached, ``(n_dof,)``."""
        out = np.empty(self._system.dof_count)
        self._core.velocities(out)
        return out

    @property
    def timings(self) -> dict[str, float]:
        """Wall time spent so far by the core in the parts of its work [s]."""
        names = ("elimination", "contacts", "substitution", "records", "total")
        return dict(zip(names, self._core.timings(), strict=True))

    def start_from(self, q: Array, v: Array) -> None:
        """Replace the state at time zero (plucked wires, wave tests); forces need not balance.

        Parameters
        ----------
        q, v : (n_dof,)
            Coordinates and velocities.
        """
        if not self._core.start_from(np.ascontiguousarray(q), np.ascontiguousarray(v)):
            raise ValueError("the mass matrix is not positive definite")

    def mark(self) -> _Mark:
        """Return the present state, to come back to."""
        state = np.empty(self._core.state_size())
        self._core.save(state)
        return _Mark(self._clock, state)

    def rewind(self, mark: object) -> None:
        """Go back to a state returned by ``mark``; counters keep counting."""
        if not isinstance(mark, _Mark):
            raise TypeError("rewind takes what mark returned")
        self._core.restore(mark.state)
        self._clock = mark.clock

    def advance(
        self, steps: int, time_step: float | None = None, *, until_crossing: bool = False
    ) -> StepBlock:
        """Take up to ``steps`` steps; fewer when one fails (see the block's status).

        Parameters
        ----------
        steps
            Number of steps.
        time_step
            Step [s]; that of the options by default.
        until_crossing
            Stop before a step in which the gap of a pantograph changes between negative and
            not negative; that step is not kept.
        """
        histories = self._empty_histories(steps)
        refused = np.empty(len(self._inputs))
        time = np.empty(steps)
        taken, outcome = 0, _RUNNING
        while taken < steps and outcome == _RUNNING:
            stop = min(taken + _CHUNK, steps)
            known = self._known(stop - taken, time_step or self._options.time_step)
            rows = {name: array[taken:stop] for name, array in histories.items()}
            done, outcome = self._core.advance(
                known.arrays | {"until_crossing": until_crossing}, rows | {"refused_gap": refused}
            )
            time[taken : taken + done] = known.time[1 : done + 1]
            self._clock = known.clocks[done]
            taken += done
        self._count()
        return StepBlock(
            time=time[:taken],
            status=_OUTCOMES.get(outcome, Status.RUNNING),
            refused_gap=refused if outcome == _CROSSING else None,
            path_force=histories["contact_force"][:taken, :, None],
            **{name: array[:taken] for name, array in histories.items()},
        )

    def _count(self) -> None:
        steps, iterations, refactorisations, full, local = self._core.counters()
        self.counters.steps = steps
        self.counters.iterations = iterations
        self.counters.refactorisations = refactorisations
        self.counters.full_newton_steps = full
        self.counters.notes["local_iterations"] = local

    def _empty_histories(self, steps: int) -> dict[str, Array]:
        count = len(self._inputs)
        widths = {
            "contact_force": count,
            "gap": count,
            "wire_height": count,
            "stages": sum(p.chain.stage_count for p in self._inputs),
            "dropper_force": len(self._system.ties),
            "observed": len(self._observed),
        }
        return {name: np.empty((steps, width)) for name, width in widths.items()}

    def _known(self, steps: int, time_step: float) -> _Known:
        """Return what is known in advance of the next steps."""
        clocks = [self._clock]
        for _ in range(steps):
            clocks.append(clocks[-1].after(time_step))
        time = np.array([c.time for c in clocks])
        end = time[1:]
        loads = [np.empty((steps + 1, 0))] + [_external(given, time) for given in self._inputs]
        external = np.concatenate(loads, axis=1)
        arrays = {
            "time_step": time_step,
            "position": _columns([given.position(end) for given in self._inputs], steps),
            "rise": _columns([given.unevenness(end) for given in self._inputs], steps),
            "on_line": _columns([end >= g.start_time - _SAME_TIME for g in self._inputs], steps),
            "before": external[:-1].copy(),
            "after": external[1:].copy(),
            "observed": self._observed,
        }
        return _Known(tuple(clocks), time, arrays)


@dataclass(frozen=True, eq=False)
class _Known:
    """Clocks and times of the ends of a number of steps, the present first, and their data."""

    clocks: tuple[Clock, ...]
    time: Array
    arrays: dict[str, Any]


def _columns(values: list[Array], steps: int) -> Array:
    """Return a contiguous array with one column per pantograph, ``(steps, n)``."""
    return np.stack(values, axis=1) if values else np.empty((steps, 0))


def _external(given: PantographInput, time: Array) -> Array:
    """Return the external forces on the stages at some instants, ``(n_time, n_stage)`` [N]."""
    if given.roof is None and time[0] - given.start_time >= given.ramp:
        return np.tile(given.external(float(time[0])), (len(time), 1))
    return np.array([given.external(t) for t in time])


def _scheme(options: StepOptions, tolerance: float) -> dict[str, float | bool]:
    integrator = options.integrator
    return {
        "alpha": integrator.alpha,
        "beta": integrator.beta,
        "gamma": integrator.gamma,
        "time_step": options.time_step,
        "contact_stiffness": options.contact_stiffness,
        "tolerance": tolerance,
        "iterations": options.iterations,
        "full_newton": options.full_newton,
    }


def _line_arrays(system: System, stiffening: WaveStiffening | None) -> dict[str, Any]:
    """Return the arrays of the line in the order of the core."""
    order = cable_order(system)
    count = system.node_count // 2
    cables, ties, stays, grounds = system.cables, system.ties, system.stays, system.grounds
    arm_stations = stays.node // 2
    node_mass = system.node_mass.reshape(count, 2).copy()
    node_mass[arm_stations, 0] += stays.mass / 3.0
    stiffness = np.diagonal(grounds.stiffness, axis1=1, axis2=2).ravel()
    damping = np.diagonal(grounds.damping, axis1=1, axis2=2).ravel()
    springs = np.flatnonzero((stiffness != 0.0) | (damping != 0.0))
    arrays = {
        "length": cables.length[order],
        "axial_stiffness": cables.axial[order],
        "bending_stiffness": cables.bending[order],
        "mass": cables.mass[order],
        "node_mass": node_mass,
        "load": system.load,
        "position": system.position,
        "dropper_length": ties.length,
        "dropper_stiffness": ties.stiffness,
        "arm_end": stays.end,
        "arm_length": stays.length,
        "arm_stiffness": stays.stiffness,
        "spring_stiffness": stiffness[springs],
        "spring_damping": damping[springs],
        "spring_free": grounds.free.ravel()[springs],
    }
    if stiffening is not None:
        arrays["stiffening_bending"] = stiffening.bending[order]
        arrays["stiffening_load"] = stiffening.load
    indices = {
        "dropper_station": ties.nodes[:, 1] // 2,
        "arm_station": arm_stations,
        "spring_dof": grounds.dofs.T.ravel()[springs],
    }
    result: dict[str, Any] = {k: np.ascontiguousarray(v, dtype=float) for k, v in arrays.items()}
    result |= {k: np.ascontiguousarray(v, dtype=np.int64) for k, v in indices.items()}
    result["fixed"] = np.ascontiguousarray(system.fixed, dtype=bool)
    result["damping_mass"] = float(system.damping.mass)
    result["damping_stiffness"] = float(system.damping.stiffness)
    return result
