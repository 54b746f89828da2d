"""The time integration by the compiled core.

The algorithm is that of :mod:`tautwire.numerics.reference_stepper`; this module translates between
the arrays of a line and those of the core, station by station.
"""

from __future__ import annotations

from collections.abc import Sequence
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.pantograph import PantographStep
from tautwire.numerics.stepper import (
    PantographInput,
    StepBlock,
    StepCounters,
    StepOptions,
)
from tautwire.numerics.system import System
from tautwire.status import Status

Array = NDArray[Any]
Index = NDArray[np.int64]

_CHUNK = 100
_ENTRY_TOLERANCE = 1e-12
_OUTCOMES = (
    Status.RUNNING,
    Status.NOT_CONVERGED,
    Status.SINGULAR,
    Status.NOT_FINITE,
    Status.OFF_THE_LINE,
)
# Two wires are factored together when a lagging dropper coupling would converge slower than this.
_SLOW_COUPLING = 0.25


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
    left, right = system.cable_nodes.T
    lower, arms = system.dropper_nodes[:, 1], system.arm_nodes
    order = np.lexsort((left, left % 2))
    expected = (2 * np.arange(count - 1) + np.arange(2)[:, None]).ravel()
    is_two_wires = (
        system.node_count == 2 * count
        and np.array_equal(left[order], expected)
        and np.array_equal(right, left + 2)
        and np.array_equal(system.contact_nodes, 2 * np.arange(count))
        and np.array_equal(system.dropper_nodes[:, 0], lower + 1)
        and not (lower % 2).any()
        and not (arms % 2).any()
        and len(np.unique(lower)) == len(lower)
        and len(np.unique(arms)) == len(arms)
    )
    return order if is_two_wires else None


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
        coupled = _coupling(system, options) > _SLOW_COUPLING
        self._core = core.Stepper(_line_arrays(system), _scheme(options, coupled=coupled))
        for given in self._inputs:
            self._core.add_pantograph(
                given.chain.chain_matrix(given.chain.stiffness),
                given.chain.chain_matrix(given.chain.damping),
                _inverse_mass(PantographStep(given.chain, options.integrator, options.time_step)),
                given.start_height,
            )
        self.counters.notes["kernels"] = f"native ({core.instruction_set})"
        if coupled:
            self.counters.notes["droppers"] = "stiff: both wires are factored together"

    @property
    def time(self) -> float:
        """Time reached [s]."""
        return self.counters.steps * self._options.time_step

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

    def start_from(self, q: Array, v: Array) -> None:
        """Replace the state at time zero (plucked wires, wave tests); forces need not balance.

        Parameters
        ----------
        q, v : (n_dof,)
            Coordinates and velocities.
        """
        self._core.start_from(np.ascontiguousarray(q), np.ascontiguousarray(v))

    def advance(self, steps: int) -> StepBlock:
        """Take up to ``steps`` steps; fewer when one fails (see the block's status)."""
        histories = self._empty_histories(steps)
        first, taken, status = self.counters.steps, 0, Status.RUNNING
        while taken < steps and status is Status.RUNNING:
            stop = min(taken + _CHUNK, steps)
            rows = {name: array[taken:stop] for name, array in histories.items()}
            done, outcome = self._core.advance(self._known(first + taken, stop - taken), rows)
            status = _OUTCOMES[outcome]
            taken += done
            self._count(first + taken)
        time = (first + 1 + np.arange(taken)) * self._options.time_step
        kept = {name: array[:taken] for name, array in histories.items()}
        return StepBlock(time=time, status=status, **kept)

    def _count(self, steps: int) -> None:
        _, iterations, refactorisations, full = self._core.counters()
        self.counters.steps = steps
        self.counters.iterations = iterations
        self.counters.refactorisations = refactorisations
        self.counters.full_newton_steps = full

    def _empty_histories(self, steps: int) -> dict[str, Array]:
        count = len(self._inputs)
        widths = {
            "contact_force": count,
            "gap": count,
            "wire_height": count,
            "stages": sum(p.chain.stage_count for p in self._inputs),
            "dropper_force": len(self._system.dropper_length),
            "observed": len(self._observed),
        }
        return {name: np.empty((steps, width)) for name, width in widths.items()}

    def _known(self, first: int, steps: int) -> dict[str, Array]:
        """Return what is known in advance of ``steps`` steps after step ``first``."""
        time = (first + np.arange(steps + 1)) * self._options.time_step
        end = time[1:]
        loads = [np.empty((steps + 1, 0))]
        loads += [np.array([given.external(t) for t in time]) for given in self._inputs]
        external = np.concatenate(loads, axis=1)
        columns = [given.position(end) for given in self._inputs]
        on_line = [end >= given.start_time - _ENTRY_TOLERANCE for given in self._inputs]
        return {
            "position": np.array(columns).reshape(len(columns), steps).T.copy(),
            "on_line": np.array(on_line, dtype=bool).reshape(len(columns), steps).T.copy(),
            "before": external[:-1].copy(),
            "after": external[1:].copy(),
            "observed": self._observed,
        }


def _inverse_mass(step: PantographStep) -> Array:
    """Return the inverse of the effective mass over a step, column by column."""
    zero = np.zeros(step.chain.stage_count)
    units = np.eye(step.chain.stage_count)
    return np.column_stack([step.acceleration(zero, zero, unit, zero) for unit in units])


def _coupling(system: System, options: StepOptions) -> float:
    """Estimate how slowly an iteration converges whose matrix leaves out the droppers' coupling.

    A dropper of stiffness k holds, over a step, ``s = (beta dt^2 + gamma dt b_R) k`` against the
    mass m that a node moves by itself; a lagging coupling leaves the share ``s/(m + s)``.
    """
    if not len(system.dropper_length):
        return 0.0
    integrator, dt = options.integrator, options.time_step
    over_step = integrator.beta * dt**2 + integrator.gamma * dt * system.damping_stiffness
    hold = (1.0 + integrator.alpha) * over_step * system.dropper_stiffness
    element = system.cable_mass * system.cable_length
    mass = system.node_mass.copy()
    np.add.at(mass, system.cable_nodes, 0.5 * element[:, None])
    return float((hold / (hold + mass[system.dropper_nodes].min(axis=1))).max())


def _scheme(options: StepOptions, *, coupled: bool) -> dict[str, float | bool]:
    integrator = options.integrator
    return {
        "alpha": integrator.alpha,
        "beta": integrator.beta,
        "gamma": integrator.gamma,
        "time_step": options.time_step,
        "contact_stiffness": options.contact_stiffness,
        "tolerance": options.tolerance,
        "iterations": options.iterations,
        "full_newton": options.full_newton,
        "coupled": coupled,
    }


def _line_arrays(system: System) -> dict[str, Any]:
    """Return the arrays of the line in the order of the core."""
    order = cable_order(system)
    count = system.node_count // 2
    arm_stations = system.arm_nodes // 2
    node_mass = system.node_mass.reshape(count, 2).copy()
    node_mass[arm_stations, 0] += system.arm_mass / 3.0
    arrays = {
        "length": system.cable_length[order],
        "axial_stiffness": system.cable_axial_stiffness[order],
        "bending_stiffness": system.cable_bending_stiffness[order],
        "mass": system.cable_mass[order],
        "node_mass": node_mass,
        "load": system.load,
        "position": system.position,
        "dropper_length": system.dropper_length,
        "dropper_stiffness": system.dropper_stiffness,
        "arm_end": system.arm_ends,
        "arm_length": system.arm_length,
        "arm_stiffness": system.arm_stiffness,
        "spring_stiffness": system.spring_stiffness,
        "spring_damping": system.spring_damping,
        "spring_free": system.spring_free,
    }
    indices = {
        "dropper_station": system.dropper_nodes[:, 1] // 2,
        "arm_station": arm_stations,
        "spring_dof": system.spring_dofs,
    }
    result: dict[str, Any] = {k: np.ascontiguousarray(v, dtype=float) for k, v in arrays.items()}
    result |= {k: np.ascontiguousarray(v, dtype=np.int64) for k, v in indices.items()}
    result["fixed"] = np.ascontiguousarray(system.fixed, dtype=bool)
    result["damping_mass"] = float(system.damping_mass)
    result["damping_stiffness"] = float(system.damping_stiffness)
    return result
