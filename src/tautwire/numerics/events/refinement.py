"""The adaptive step: finer where contact is lost, until the durations of the losses settle.

Two errors decide when a contact opens. One was made before: waves that the pantograph sent out up
to a second ago come back to it with the speed that the time step gives them. It is kept small by a
base step that follows from the tolerance and by stiffening the wires against the loss of wave speed
(:mod:`tautwire.numerics.motion.dispersion`). The other is made at the contact itself, shortly
before, during and after the loss. It is removed by going back before each loss, or near loss, and
taking steps of 1/2, 1/4, ... of the base step, until the durations of two passes agree. Newmark's
error falls with the square of the step, so that the finer of two passes is off by a third of their
difference.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import ceil, gcd, inf, log2, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.events.crossings import crossings_between, suspect_times
from tautwire.numerics.events.step_control import Chunk, LossCounter, Task, wave_words
from tautwire.numerics.motion.stepper import StepBlock
from tautwire.signals.losses import loss_intervals
from tautwire.status import Status

Array = NDArray[Any]
Span = tuple[float, float]
Spans = tuple[list[Span], ...]

_BASE_STEP = 0.5e-3
"""Step in the section for the tolerance below [s]: on AC simple with losses 1 ms moves the standard
deviation by 0.5 %, 0.25 ms by 0.1 %, and losses by 0.2 and 0.04 ms (theory page)."""
_BASE_TOLERANCE = 0.2e-3
"""Error of a loss to which the base step belongs [s]; the error falls with the square of the
step."""
_SEGMENT = 5
"""Samples taken ahead at once. Chosen: 2 and 10 move losses by up to 0.03 ms, below the
tolerance."""
_LONGEST = 0.2
"""Longest window [s]: a head that flies longer is not refined further. Chosen: 0.1 and 0.4 change
nothing on AC simple at 330 km/h."""
_MOST_LEVELS = 5
"""Most halvings: steps of 1/32 of the base step, 16 us."""
_ORDER_GAIN = 3.0
"""Difference of two passes over the error of the finer one, for an error of second order: 2^2 -
1."""
_SAME_TIME = 1e-9
"""Room for rounding in a time that many sub-steps add up to [s]."""


@dataclass(frozen=True)
class AdaptiveStep:
    """Refine the step around losses of contact until their durations settle.

    Parameters
    ----------
    time_step
        Sampling interval of the record, and step outside the analysed section [s].
    tolerance
        Error of the duration of a loss that is aimed at [s].
    lead, trail
        Time before a separation and after a re-contact that is refined [s].
    memory
        Time before the analysed section from which on the base step is used [s].
    shortest
        Losses that would last as long are not missed [s].
    most_losses
        Losses per pantograph after which the integration stops; without a limit by default.
    corrects_waves
        Stiffen the wires against the loss of wave speed.
    """

    time_step: float
    # What these four do stands on the theory page (adaptive step).
    tolerance: float = _BASE_TOLERANCE
    lead: float = 0.010
    trail: float = 0.004
    memory: float = 0.8
    shortest: float = 1e-3
    most_losses: float = inf
    corrects_waves: bool = True

    @property
    def base_level(self) -> int:
        """How often the time step is halved for the analysed section."""
        base = _BASE_STEP * sqrt(self.tolerance / _BASE_TOLERANCE)
        return max(0, ceil(log2(self.time_step / base) - 1e-9))

    def integrate(self, task: Task) -> Iterator[Chunk]:
        """Advance chunk by chunk; a chunk is final when no loss behind it can change it."""
        counter = LossCounter(self.most_losses)
        for chunk in _Refiner(self, task).chunks():
            yield counter.checked(chunk)
            if counter.is_exceeded:
                return

    def describe(self) -> str:
        """Name with parameters, as written to results."""
        base = 1e3 * self.time_step / 2**self.base_level
        return (
            f"adaptive step from {base:g} ms in the section and {1e3 * self.time_step:g} ms "
            f"outside, loss durations to {1e3 * self.tolerance:g} ms{wave_words(self)}"
        )


@dataclass(frozen=True, eq=False)
class _Segment:
    """A few samples, the state before them, and all gaps between them.

    Coordinates after them are kept at the end of a chunk only.
    """

    mark: object
    start: float
    steps: StepBlock
    time: Array
    gap: Array
    coordinates: Array | None


@dataclass(frozen=True)
class _Trouble:
    """From when to when contact is lost, or nearly lost."""

    first: float
    last: float


class _Refiner:
    """Takes segments ahead, goes back where contact is lost, hands out what is final."""

    def __init__(self, control: AdaptiveStep, task: Task) -> None:
        self._control, self._task, self._stepper = control, task, task.stepper
        self._length = gcd(_SEGMENT, task.chunk)
        self._ahead: list[_Segment] = []
        self._final: list[_Segment] = []
        self._trouble: _Trouble | None = None
        self._settled = -inf
        self._status = Status.RUNNING
        self._last: tuple[Array, Array] | None = None
        self._notes = task.stepper.counters.notes
        self._notes |= {"windows": 0, "refined_s": 0.0, "unsettled_windows": 0}

    def chunks(self) -> Iterator[Chunk]:
        """Integrate to the end of the task."""
        while not self._is_over():
            self._ahead.append(self._take_base())
            self._look_for_losses()
            if self._trouble is not None and self._is_past(self._trouble):
                self._refine(self._trouble)
                self._trouble = None
            yield from self._released()

    def _samples(self) -> int:
        """Return the number of samples taken."""
        return round(self._stepper.time / self._control.time_step)

    def _is_over(self) -> bool:
        return self._samples() >= self._task.steps or self._status is not Status.RUNNING

    def _take_base(self) -> _Segment:
        """Take the next samples of the base pass; outside the section up to the next chunk."""
        begin, end = self._task.focus
        if begin - self._control.memory <= self._stepper.time <= end:
            return self._take(self._control.base_level)
        chunk = self._task.chunk
        return self._take(0, chunk - self._samples() % chunk)

    def _take(self, level: int, samples: int | None = None) -> _Segment:
        """Take the next samples with the time step halved ``level`` times."""
        parts = 2**level
        samples = min(samples or self._length, self._task.steps - self._samples())
        mark, start = self._stepper.mark(), self._stepper.time
        dense = self._stepper.advance(samples * parts, self._control.time_step / parts)
        self._status = dense.status
        kept = dense.rows(parts - 1, len(dense.time), parts)
        ends_chunk = self._samples() % self._task.chunk == 0 or self._is_over()
        end = self._stepper.coordinates.copy() if ends_chunk else None
        return _Segment(mark, start, kept, dense.time, dense.gap, end)

    def _look_for_losses(self) -> None:
        """Find losses and near losses in the last segment of the base pass."""
        new, (begin, end) = self._ahead[-1], self._task.focus
        if not begin <= self._stepper.time <= end or _presses_well(new.gap):
            return
        time, gap = _joined(self._ahead[-2:])
        rows = len(new.time) + 2
        times = suspect_times(time[-rows:], gap[-rows:], self._control.shortest)
        times = times[(times >= max(begin, self._settled)) & (times <= end)]
        if len(times):
            first = times[0] if self._trouble is None else self._trouble.first
            self._trouble = _Trouble(float(first), float(times[-1]))

    def _is_past(self, trouble: _Trouble) -> bool:
        now = self._stepper.time
        is_calm = now - trouble.last >= self._control.trail
        return is_calm or now - trouble.first > _LONGEST or self._is_over()

    def _refine(self, trouble: _Trouble) -> None:
        """Replace the segments around a trouble by finer ones."""
        free = [i for i, s in enumerate(self._ahead) if s.start >= self._settled]
        early = [i for i in free if self._ahead[i].start <= trouble.first - self._control.lead]
        index = early[-1] if early else free[0]
        coarse = self._ahead[index:]
        losses, level, error = _losses(coarse), self._control.base_level, inf
        while error > self._control.tolerance and level < self._control.base_level + _MOST_LEVELS:
            level += 1
            del self._ahead[index:]
            self._retake(coarse, level)
            finer = _losses(self._ahead[index:])
            error, losses = _difference(losses, finer) / _ORDER_GAIN, finer
            if self._status is not Status.RUNNING:
                break
        self._settled = self._stepper.time - _SAME_TIME
        self._notes["windows"] += 1
        self._notes["refined_s"] += self._stepper.time - coarse[0].start
        self._notes["unsettled_windows"] += error > self._control.tolerance

    def _retake(self, coarse: Sequence[_Segment], level: int) -> None:
        """Take segments anew with a finer step, and more of them until contact has settled."""
        self._stepper.rewind(coarse[0].mark)
        fine: list[_Segment] = []
        is_done = False
        while not is_done:
            self._ahead.append(self._take(level))
            fine.append(self._ahead[-1])
            ends = [span[1] for spans in _losses(fine) for span in spans]
            now = self._stepper.time
            is_calm = now - max(ends, default=-inf) >= self._control.trail
            is_done = len(fine) >= len(coarse) and (is_calm or now - fine[0].start > _LONGEST)
            is_done |= self._is_over()

    def _released(self) -> Iterator[Chunk]:
        """Hand out what no later loss can change, in chunks."""
        horizon = self._stepper.time if self._trouble is None else self._trouble.first
        horizon -= self._control.lead + 2.0 * self._length * self._control.time_step
        everything = self._is_over()
        while self._ahead and (everything or self._ahead[0].time[-1] < horizon):
            self._final.append(self._ahead.pop(0))
            if self._final[-1].coordinates is not None:
                yield self._chunk()

    def _chunk(self) -> Chunk:
        segments, self._final = self._final, []
        time, gap = _joined(segments)
        if self._last is not None:
            time = np.concatenate([self._last[0], time])
            gap = np.concatenate([self._last[1], gap])
        self._last = (time[-1:], gap[-1:])
        steps = StepBlock.joined([s.steps for s in segments], segments[-1].steps.status)
        end = segments[-1].coordinates
        assert end is not None
        return Chunk(steps, end, tuple(crossings_between(time, gap)))


def _presses_well(gap: Array) -> bool:
    """Tell whether no contact comes near to opening: every penetration stays above half its mean.

    A quick answer for most of the samples; half, because suspect_times looks closely at the rest.
    """
    return bool((gap.max(axis=0) < 0.5 * gap.mean(axis=0)).all())


def _joined(segments: Sequence[_Segment]) -> tuple[Array, Array]:
    """Return time ``(n,)`` and gaps ``(n, n_pantograph)`` of some segments."""
    return np.concatenate([s.time for s in segments]), np.concatenate([s.gap for s in segments])


def _losses(segments: Sequence[_Segment]) -> Spans:
    """Return the spans of time in which each pantograph has lost contact."""
    time, gap = _joined(segments)
    intervals = (loss_intervals(time, column) for column in gap.T)
    return tuple(list(zip(start.tolist(), end.tolist(), strict=True)) for start, end in intervals)


def _difference(coarse: Spans, fine: Spans) -> float:
    """Return the largest difference in duration of losses that overlap; alone, a loss counts whole.

    Losses that only one pass has, or that one has in two parts, count with their own duration.
    """
    largest = 0.0
    for one, other in zip(coarse, fine, strict=True):
        for spans, others in ((one, other), (other, one)):
            for begin, end in spans:
                mates = [e - b for b, e in others if b < end and e > begin]
                largest = max(
                    largest, min((abs(end - begin - m) for m in mates), default=end - begin)
                )
    return largest
