"""The time integration by the compiled core.

The algorithm is that of :mod:`tautwire.numerics.motion.reference_stepper`; this module translates
between the passage and the core, :mod:`tautwire.numerics.motion.native_line` between the line and
the core.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.motion.native_line import NodeOrder, line_arrays
from tautwire.numerics.motion.step_solver import Clock
from tautwire.numerics.motion.stepper import (
    COUNTED_NOTES,
    LARGEST_NOTES,
    SAME_TIME,
    PantographInput,
    StepBlock,
    StepCounters,
    StepOptions,
    reachable_tolerance,
)
from tautwire.numerics.network.system import System
from tautwire.status import Status

Array = NDArray[Any]
Index = NDArray[np.int64]

_CHUNK = 100
"""Steps per call of the core, some 5 ms: between them Python sees signals."""
_MOST_AHEAD = 1000
"""Most steps whose known data are made at once, some hundred kilobytes a pantograph: made for 20
steps each, the length of a block, they took a tenth of a passage."""
_RUNNING, _CROSSING = 0, 5  # as in engine.hpp
_OF_PAIRS = ("contact_force", "gap", "wire_height")
_OUTCOMES = {
    1: Status.NOT_CONVERGED,
    2: Status.SINGULAR,
    3: Status.NOT_FINITE,
    4: Status.OFF_THE_LINE,
}


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
        The line in its static state.
    pantographs
        Their chains and ways along the line.
    options
        Integrator, step, tolerance.
    observed
        Degrees of freedom whose coordinates are recorded at every step.
    threads
        That may take part in a step; results do not depend on them. How many do is noted: one
        where the line is too short to be divided.

    Raises
    ------
    NotAChainError
        The wires of the line branch or form rings.
    """

    def __init__(
        self,
        core: ModuleType,
        system: System,
        pantographs: Sequence[PantographInput],
        options: StepOptions,
        observed: Index,
        threads: int = 1,
    ) -> None:
        self.counters = StepCounters()
        self._system, self._options = system, options
        self._inputs = tuple(pantographs)
        self._order = NodeOrder.of(system.cables.nodes, system.node_count)
        observed = np.asarray(observed, dtype=np.int64)
        self._observed = 6 * self._order.place[observed // 6] + observed % 6
        self._clock = Clock()
        self._ahead = _Known(self._clock, np.zeros(1), {})
        arrays = line_arrays(system, self._order, options.stiffening, options.contact_stiffness)
        self._paths = len(arrays["path_stiffness"])
        self._core = core.Stepper(
            arrays, _scheme(options, reachable_tolerance(system, options), threads)
        )
        self.counters.notes["threads"] = self._core.threads()
        for given in self._inputs:
            chain = given.chain
            self._core.add_pantograph(
                np.ascontiguousarray(chain.mass, dtype=float),
                chain.chain_matrix(chain.stiffness),
                chain.chain_matrix(chain.damping),
                given.start_height,
                np.array([-given.reach, given.reach]),
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
        return out[self._from_core]

    @property
    def velocities(self) -> Array:
        """Nodal velocities at the time reached, ``(n_dof,)``."""
        out = np.empty(self._system.dof_count)
        self._core.velocities(out)
        return out[self._from_core]

    @property
    def timings(self) -> dict[str, float]:
        """Wall time spent so far by the core in the parts of its work [s]."""
        names = ("elimination", "contacts", "substitution", "records", "total")
        return dict(zip(names, self._core.timings(), strict=True))

    @cached_property
    def _from_core(self) -> Index:
        return (6 * self._order.place[:, None] + np.arange(6)).ravel()

    def start_from(self, q: Array, v: Array) -> None:
        """Replace the state at time zero (plucked wires, wave tests); forces need not balance.

        Parameters
        ----------
        q, v : (n_dof,)
            Coordinates and velocities.
        """
        if not self._core.start_from(q[self._order.dofs], v[self._order.dofs]):
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
        """Take up to ``steps`` steps: see :meth:`.Stepper.advance`."""
        histories = self._empty_histories(steps)
        refused = np.empty(len(self._inputs))
        time = np.empty(steps)
        size = time_step or self._options.time_step
        asked = {"time_step": size, "observed": self._observed, "until_crossing": until_crossing}
        taken, outcome = 0, _RUNNING
        while taken < steps and outcome == _RUNNING:
            stop = min(taken + _CHUNK, steps)
            known = self._coming(stop - taken, size)
            rows = {name: array[taken:stop] for name, array in histories.items()}
            rows["refused_gap"] = refused
            done, outcome = self._core.advance(known.arrays | asked, rows)
            time[taken : taken + done] = known.time[1 : done + 1]
            self._clock = self._clock.after(size, done) if done else self._clock
            taken += done
        self._count()
        return StepBlock(
            time=time[:taken],
            status=_OUTCOMES.get(outcome, Status.RUNNING),
            refused_gap=refused if outcome == _CROSSING else None,
            **self._of_pantographs({name: array[:taken] for name, array in histories.items()}),
        )

    def _of_pantographs(self, histories: dict[str, Array]) -> dict[str, Array]:
        """Return histories with those of pairs (pantograph, path) joined to pantographs."""
        steps, count = len(histories["observed"]), len(self._inputs)
        if not count:
            return histories | {"path_force": np.empty((steps, 0, self._paths))}
        shape = (steps, count, self._paths)
        force, gap, height = (histories[name].reshape(shape) for name in _OF_PAIRS)
        absent = np.isnan(gap)
        nearest = np.where(absent, np.inf, gap).argmin(axis=2)
        at = np.arange(steps)[:, None], np.arange(count), nearest
        return histories | {
            "contact_force": force.sum(axis=2),
            "path_force": np.where(absent, np.nan, force),
            "gap": gap[at],
            "wire_height": height[at],
        }

    def _count(self) -> None:
        steps, iterations, refactorisations, full, *notes = self._core.counters()
        self.counters.steps = steps
        self.counters.iterations = iterations
        self.counters.refactorisations = refactorisations
        self.counters.full_newton_steps = full
        names = (*COUNTED_NOTES, *LARGEST_NOTES)
        self.counters.notes.update(zip(names, notes, strict=True))

    def _empty_histories(self, steps: int) -> dict[str, Array]:
        pairs = len(self._inputs) * self._paths
        widths = {
            **dict.fromkeys(_OF_PAIRS, pairs),
            "stages": sum(p.chain.stage_count for p in self._inputs),
            "dropper_force": len(self._system.ties),
            "observed": len(self._observed),
        }
        return {name: np.empty((steps, width)) for name, width in widths.items()}

    def _coming(self, steps: int, time_step: float) -> _Known:
        """Return what is known in advance of the next steps.

        It is made for twice as many steps each time when all that was made before is used.
        """
        begin, ahead = self._clock.counting(time_step), self._ahead
        done = begin.count - ahead.begin.count
        is_known = (begin.since, time_step) == (ahead.begin.since, ahead.begin.time_step)
        if not is_known or not 0 <= done <= ahead.steps - steps:
            more = 2 * ahead.steps if is_known and 0 < done <= ahead.steps else 0
            self._ahead = ahead = self._known(max(steps, min(more, _MOST_AHEAD)), begin)
            done = 0
        return ahead.part(done, steps)

    def _known(self, steps: int, begin: Clock) -> _Known:
        """Return what is known in advance of a number of steps."""
        time = begin.since + (begin.count + np.arange(steps + 1)) * begin.time_step
        end = time[1:]
        loads = [np.empty((steps + 1, 0))] + [given.external(time) for given in self._inputs]
        external = np.concatenate(loads, axis=1)
        rise = _columns([given.unevenness(end) for given in self._inputs], steps)
        arrays = {
            "frame": _frames(self._inputs, end),
            "rise": np.repeat(rise, self._paths, axis=1),
            "on_line": _columns(
                [end >= g.start_time - SAME_TIME for g in self._inputs], steps, dtype=bool
            ),
            "before": external[:-1].copy(),
            "after": external[1:].copy(),
        }
        return _Known(begin, time, arrays)


@dataclass(frozen=True, eq=False)
class _Known:
    """What is known in advance of a number of equal steps.

    Attributes
    ----------
    begin : Clock
        Before the first one.
    time : (n_step + 1,) s
        Before the first one and after each.
    arrays : dict of (n_step, ...)
        As the core takes them.
    """

    begin: Clock
    time: Array
    arrays: dict[str, Array]

    @property
    def steps(self) -> int:
        """Number of steps."""
        return len(self.time) - 1

    def part(self, done: int, steps: int) -> _Known:
        """Return the same for some of the steps, when a number of them is done."""
        rows = {name: array[done : done + steps] for name, array in self.arrays.items()}
        begin = self.begin.after(self.begin.time_step, done)
        return _Known(begin, self.time[done : done + steps + 1], rows)


def _columns(values: list[Array], steps: int, dtype: type = float) -> Array:
    """Return a contiguous array with one column per pantograph, ``(steps, n)``."""
    return np.stack(values, axis=1) if values else np.empty((steps, 0), dtype=dtype)


def _frames(inputs: Sequence[PantographInput], time: Array) -> Array:
    """Return the planes of contact at some instants, ``(n_time, n_pantograph, 3, 3)``.

    A point of the plane, its normal along the track, the direction in which the head rises.
    """
    frames = np.empty((len(time), len(inputs), 3, 3))
    for number, given in enumerate(inputs):
        plane = given.plane(time)
        frames[:, number, 0] = plane.origin
        frames[:, number, 1:] = plane.axes[:, ::2]
    return frames


def _scheme(options: StepOptions, tolerance: float, threads: int) -> dict[str, float | int | bool]:
    integrator = options.integrator
    return {
        "alpha": integrator.alpha,
        "beta": integrator.beta,
        "gamma": integrator.gamma,
        "time_step": options.time_step,
        "tolerance": tolerance,
        "iterations": options.iterations,
        "full_newton": options.full_newton,
        "threads": threads,
    }
