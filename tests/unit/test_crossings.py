"""Instants at which contacts open and close: located in records, and by divided steps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from tautwire.numerics.events.crossings import (
    crossings_between,
    divide_step,
    suspect_times,
)
from tautwire.numerics.events.step_control import LossCounter, Task, VariableStep
from tautwire.numerics.motion.stepper import StepBlock, StepCounters
from tautwire.status import Status

Array = NDArray[np.float64]


@dataclass
class Gaps:
    """A time integration whose gaps are given functions of time, exact for every step."""

    functions: tuple[Callable[[float], float], ...]
    fails_below: float = 0.0
    time: float = 0.0
    counters: StepCounters = field(default_factory=StepCounters)

    @property
    def coordinates(self) -> Array:
        """Nothing moves."""
        return np.zeros(1)

    def gap(self, time: float) -> Array:
        """Return the gaps at an instant."""
        return np.array([function(time) for function in self.functions])

    def advance(
        self, steps: int, time_step: float | None = None, *, until_crossing: bool = False
    ) -> StepBlock:
        """Take steps, and stop before one in which a gap changes its sign."""
        step = time_step or 1e-3
        times, refused = [], None
        status = Status.NOT_CONVERGED if step < self.fails_below else Status.RUNNING
        for _ in range(steps if status is Status.RUNNING else 0):
            before, after = self.gap(self.time), self.gap(self.time + step)
            known = ~np.isnan(before)
            if until_crossing and np.any(known & ((before < 0.0) != (after < 0.0))):
                refused = after
                break
            self.time += step
            self.counters.steps += 1
            times.append(self.time)
        gaps = np.array([self.gap(t) for t in times]).reshape(len(times), len(self.functions))
        none = np.empty((len(times), 0))
        return StepBlock(np.array(times), gaps, gaps, gaps, none, none, none, none, status, refused)

    def mark(self) -> object:
        """Return the time."""
        return self.time

    def rewind(self, mark: object) -> None:
        """Go back."""
        assert isinstance(mark, float)
        self.time = mark


def line(zero: float, slope: float = 1.0) -> np.polynomial.Polynomial:
    """Return a gap that grows from below through an instant."""
    return np.polynomial.Polynomial([-slope * zero, slope])


def parabola(first: float, second: float, height: float = 1.0) -> np.polynomial.Polynomial:
    """Return a gap that is open between two instants."""
    return -height * line(first) * line(second)


def test_crossings_of_two_contacts_in_order() -> None:
    """Instants are the zeros of the straight lines between samples, in order of time; NaN before a
    pantograph has entered is no crossing."""
    gap = np.array([[-1.0, np.nan], [1.0, 3.0], [2.0, -1.0], [-2.0, -1.0]])
    found = crossings_between(np.arange(4.0), gap)
    assert [(c.time, c.pantograph, c.opens) for c in found] == [
        (0.5, 0, True),
        (1.75, 1, False),
        (2.5, 0, False),
    ]


@pytest.mark.parametrize(
    ("height", "is_suspect"), [(-0.02, True), (-0.2, False), (0.01, True)], ids=str
)
def test_peaks_that_nearly_open_are_suspect(height: float, is_suspect: bool) -> None:
    """A peak of the gap counts when a loss of the given duration could hide behind it: the parabola
    ``height - t^2`` would need to rise by less than its peak lies below zero."""
    time = np.linspace(-1.0, 1.0, 21)
    gap = height - time**2
    assert (len(suspect_times(time, gap[:, None], 0.3)) > 0) == is_suspect


@pytest.mark.parametrize("tolerance", [1e-4, 1e-7])
def test_divided_step_ends_where_contact_opens(tolerance: float) -> None:
    """A step is divided behind the separation, at a gap of at most the tolerance, and the rest of
    the step follows: its end is the end of the step."""
    curve = np.polynomial.Polynomial([-0.3, 0.2, 400.0])
    gaps, zero = Gaps((curve,)), float(curve.roots().max())
    divided = divide_step(gaps, 0.05, gaps.gap(0.0), tolerance)
    assert divided.status is Status.RUNNING
    assert len(divided.parts) == 2
    assert 0.0 <= divided.parts[0].gap[0, 0] <= tolerance
    assert gaps.time == pytest.approx(0.05, abs=1e-15)
    (crossing,) = divided.crossings
    assert crossing.opens
    assert crossing.time == pytest.approx(zero, abs=tolerance / 20.0)


def test_loss_and_contact_within_one_step() -> None:
    """Two pantographs that change within one step are served in their order; a contact that opens
    and closes again before the end of the step divides it twice."""
    gaps = Gaps((line(0.7), -1.0 * line(0.3)))
    divided = divide_step(gaps, 1.0, gaps.gap(0.0), 1e-6)
    found = [(c.pantograph, c.opens) for c in divided.crossings]
    assert found == [(1, False), (0, True)]
    assert [c.time for c in divided.crossings] == pytest.approx([0.3, 0.7], abs=1e-6)
    assert len(divided.parts) == 3


def test_change_within_the_sub_step_of_another_is_not_forgotten() -> None:
    """The straight line tells the wrong contact first: the one whose gap bends opens earlier. Both
    instants are found, in their order."""
    late = 0.4
    gaps = Gaps((line(0.6), lambda t: min(30.0 * (t - late), 1.0)))
    divided = divide_step(gaps, 1.0, gaps.gap(0.0), 1e-9)
    found = [(c.pantograph, c.opens) for c in divided.crossings]
    assert found == [(1, True), (0, True)]
    assert [c.time for c in divided.crossings] == pytest.approx([late, 0.6], abs=1e-6)


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    rates=st.lists(st.floats(20.0, 400.0), min_size=1, max_size=3),
    enters=st.lists(st.floats(0.0, 0.01), min_size=3, max_size=3),
)
def test_events_tell_the_state_of_every_sample(
    seed: int, rates: list[float], enters: list[float]
) -> None:
    """Whatever the gaps of one to three pantographs do, and in whatever state each enters, the
    instants of a variable step open and close in turn and add up to the state of every sample."""
    random = np.random.default_rng(seed)

    def gap(rate: float, enter: float) -> Callable[[float], float]:
        phase, offset = random.uniform(0.0, 2.0 * np.pi), random.uniform(-1.1, 1.1)
        return lambda t: (
            float(np.sin(2.0 * np.pi * rate * t + phase) + offset) if t >= enter else np.nan
        )

    gaps = Gaps(tuple(gap(rate, enter) for rate, enter in zip(rates, enters, strict=False)))
    chunks = list(VariableStep(1e-3, tolerance=1e-6).integrate(task(gaps, 40)))
    time = np.concatenate([chunk.steps.time for chunk in chunks])
    gap_history = np.concatenate([chunk.steps.gap for chunk in chunks])
    crossings = [c for chunk in chunks for c in chunk.crossings or ()]
    for number, column in enumerate(gap_history.T):
        own = [c for c in crossings if c.pantograph == number]
        assert all(a.opens != b.opens for a, b in pairwise(own))
        assert all(a.time <= b.time for a, b in pairwise(own))
        known = np.flatnonzero(~np.isnan(column))
        state = not own[0].opens if own else bool(len(known) and column[known[0]] >= 0.0)
        for row in known:
            passed = [c for c in own if c.time <= time[row] + 1e-9]
            assert (passed[-1].opens if passed else state) == (column[row] >= 0.0)


def test_a_loss_between_two_samples_is_not_seen() -> None:
    """What opens and closes within a step leaves no trace at its end: the variable step misses it,
    as the paper says of losses that need a higher sampling frequency."""
    gaps = Gaps((parabola(0.2, 0.6),))
    divided = divide_step(gaps, 1.0, gaps.gap(0.0), 1e-6)
    assert not divided.crossings


def test_too_many_changes_in_a_step_are_given_up() -> None:
    """More than ten changes of contact within one step end in a clear status."""
    gaps = Gaps(tuple(line(zero) for zero in np.linspace(0.05, 0.95, 12)))
    divided = divide_step(gaps, 1.0, gaps.gap(0.0), 1e-6)
    assert divided.status is Status.TOO_MANY_LOSSES
    assert len(divided.crossings) == 10


def test_failed_step_is_passed_on() -> None:
    """A step that fails while an instant is sought ends the division with its own status."""
    gaps = Gaps((line(0.5),), fails_below=0.9)
    divided = divide_step(gaps, 1.0, gaps.gap(0.0), 1e-6)
    assert divided.status is Status.NOT_CONVERGED


def task(gaps: Gaps, steps: int) -> Task:
    """Return steps in chunks of five."""
    return Task(gaps, steps, 5, 1e5, (0.0, 1.0))


def test_variable_step_samples_at_whole_steps() -> None:
    """Whatever is divided, samples lie at whole steps, in full chunks, and hold no instants of
    contact; the instants are handed out apart."""
    gaps = Gaps((parabola(2.3e-3, 7.8e-3),))
    chunks = list(VariableStep(1e-3, tolerance=1e-12).integrate(task(gaps, 12)))
    assert [len(chunk.steps.time) for chunk in chunks] == [5, 5, 2]
    time = np.concatenate([chunk.steps.time for chunk in chunks])
    assert time == pytest.approx(1e-3 * np.arange(1, 13), abs=1e-12)
    found = [c.time for chunk in chunks for c in chunk.crossings or ()]
    assert found == pytest.approx([2.3e-3, 7.8e-3], abs=1e-8)


def test_too_many_losses_end_the_run() -> None:
    """After the given number of losses of one pantograph the run stops with a clear status; what
    was computed up to there is handed out."""
    gaps = Gaps((lambda time: float(np.cos(np.pi * (1.0 + (time - 1e-3) / 1e-3))),))
    chunks = list(VariableStep(1e-3, tolerance=1e-3, most_losses=2).integrate(task(gaps, 12)))
    assert chunks[-1].steps.status is Status.TOO_MANY_LOSSES
    opened = [c for chunk in chunks for c in chunk.crossings or () if c.opens]
    assert len(opened) > 2
    assert "most_losses" in Status.TOO_MANY_LOSSES.cure
    assert not LossCounter(2).is_exceeded
