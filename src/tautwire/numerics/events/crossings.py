"""When contacts open and close: located between samples, and by steps that end there.

The gap is the height of the running surface above the head, negative in contact. A contact is lost
while its gap is not negative.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.motion.stepper import StepBlock, Stepper
from tautwire.signals.losses import contact_changes
from tautwire.status import Status

Array = NDArray[Any]

_LOCATING_STEPS = 20
"""Most sub-steps to one crossing; the line takes 2 to 4, halving in turn at most 20 to a
millionth."""
_MOST_IN_A_STEP = 10
"""Most crossings in one step: a head does not chatter ten times in a millisecond."""
_SHORTEST = 1e-9
"""Share of a step below which an instant is met: rounding of the time of a passage."""
_EDGE = 0.02
"""Share of the bracket that a trial keeps from its ends, so that it always shrinks. Chosen: 0.001
to 0.1 change no loss of AC simple at 330 km/h by 1 us."""
_AIM = 0.1
"""Part of the tolerance that a trial aims beyond the crossing, so that it ends on the new side.
Chosen: with 0.01 and 0.5 the losses of AC simple at 330 km/h move by less than the tolerance is
worth (0.04 and 0.16 ms of 1.3 to 6.3 ms)."""


@dataclass(frozen=True)
class Crossing:
    """An instant at which a contact opens or closes.

    Attributes
    ----------
    time : float s
    pantograph : int
        0-based.
    opens : bool
        True for a separation, False for a re-contact.
    """

    time: float
    pantograph: int
    opens: bool


def crossings_between(time: Array, gap: Array) -> list[Crossing]:
    """Locate the crossings of a record by straight lines between samples.

    Parameters
    ----------
    time : (n,) s
    gap : (n, n_pantograph) m
        NaN before a pantograph has entered.

    Returns
    -------
    list of Crossing
        In order of time.
    """
    found = [
        Crossing(float(at), number, bool(opens))
        for number, column in enumerate(gap.T)
        for at, opens in zip(*contact_changes(time, column), strict=True)
    ]
    return sorted(found, key=lambda c: c.time)


def suspect_times(time: Array, gap: Array, shortest: float) -> Array:
    """Return the samples at which a contact is lost, nearly lost, or lost between samples.

    A peak of the gap counts when the parabola through its three samples, raised until a loss of
    the duration ``shortest`` shows, would rise by no more than its peak lies below zero.

    Parameters
    ----------
    time : (n,) s
        Evenly spaced.
    gap : (n, n_pantograph) m
        NaN before a pantograph has entered.
    shortest : float s

    Returns
    -------
    (n_suspect,) s
    """
    is_suspect: NDArray[np.bool_] = np.any(gap >= 0.0, axis=1)
    if len(time) > 2:
        before, here, after = gap[:-2], gap[1:-1], gap[2:]
        fall = 2.0 * here - before - after
        safe = np.where(fall > 0.0, fall, 1.0)
        top = here + (after - before) ** 2 / (8.0 * safe)
        share = shortest / (time[1] - time[0])
        near = top + fall * share**2 / 8.0 >= 0.0
        is_suspect[1:-1] |= (near & (here >= before) & (here > after)).any(axis=1)
    return time[is_suspect]


@dataclass(frozen=True, eq=False)
class DividedStep:
    """A step that was divided where contacts open and close.

    Attributes
    ----------
    parts : tuple of StepBlock
        One row each; the last one is the end of the step.
    crossings : tuple of Crossing
    status : Status
        ``RUNNING`` when the end of the step was reached.
    """

    parts: tuple[StepBlock, ...]
    crossings: tuple[Crossing, ...]
    status: Status


def divide_step(stepper: Stepper, time_step: float, gap: Array, tolerance: float) -> DividedStep:
    """Take one step, divided at every instant where a contact opens or closes.

    The instant is sought on the line through the gaps on both sides of it, which stands for the
    tangent; the step up to there is solved in full, and the line is drawn anew until the contact
    has just opened or closed. The rest of the step follows (paper section V.A).

    Parameters
    ----------
    stepper
        At the start of the step.
    time_step : float s
        Of the undivided step.
    gap : (n_pantograph,) m
        At the start of the step; NaN for a pantograph that has not entered.
    tolerance : float m
        Largest gap, or penetration, at which a crossing counts as met.
    """
    parts: list[StepBlock] = []
    crossings: list[Crossing] = []
    rest = time_step
    for _ in range(_MOST_IN_A_STEP):
        start, since = stepper.mark(), stepper.time
        end = stepper.advance(1, rest)
        if end.status is not Status.RUNNING:
            return DividedStep(tuple(parts), tuple(crossings), end.status)
        if _first_crossed(gap, end.gap[0]) is None:
            return DividedStep((*parts, end), tuple(crossings), Status.RUNNING)
        stepper.rewind(start)
        located = _locate_first(stepper, start, gap, (rest, end.gap[0]), tolerance)
        if isinstance(located, Status):
            return DividedStep(tuple(parts), tuple(crossings), located)
        crossings += (Crossing(since + at, who, opens) for at, who, opens in located.changes)
        parts.append(located.part)
        gap, rest = located.part.gap[0], rest - located.step
        if rest <= _SHORTEST * time_step:
            return DividedStep(tuple(parts), tuple(crossings), Status.RUNNING)
    return DividedStep(tuple(parts), tuple(crossings), Status.TOO_MANY_LOSSES)


def _crossed(before: Array, after: Array) -> NDArray[np.int64]:
    """Return the pantographs whose contact changes, in order of time on straight lines."""
    crossed = np.flatnonzero(~np.isnan(before) & ((before >= 0.0) != (after >= 0.0)))
    shares = before[crossed] / (before[crossed] - after[crossed])
    return crossed[np.argsort(shares, kind="stable")]


def _first_crossed(before: Array, after: Array) -> int | None:
    """Return the pantograph whose contact changes first, on straight lines; None without any."""
    crossed = _crossed(before, after)
    return int(crossed[0]) if len(crossed) else None


@dataclass(frozen=True, eq=False)
class _Located:
    """A sub-step that ends where contact changes.

    Attributes
    ----------
    part : StepBlock
    step : float s
        Its length.
    changes : tuple of (s, int, bool)
        Instant from the start of the sub-step, pantograph, and whether the contact opens.
    """

    part: StepBlock
    step: float
    changes: tuple[tuple[float, int, bool], ...]


def _locate_first(
    stepper: Stepper, start: object, before: Array, end: tuple[float, Array], tolerance: float
) -> _Located | Status:
    """Solve the sub-step up to the first change of contact, and stay there.

    Which one is first is not known before: a contact may change back within the step, or earlier
    than its straight line says. Where a sub-step up to one change holds others, the first of
    these is sought within it. Changes that no shorter sub-step tells apart are taken together.
    """
    step, after = end
    sought = _crossed(before, after)[:1]
    while True:
        who = int(sought[-1])
        bracket = _Bracket(step, float(before[who]), float(after[who]), tolerance)
        part = _locate(stepper, start, who, bracket)
        if isinstance(part, Status):
            return part
        step, after = bracket.right, part.gap[0]
        crossed = _crossed(before, after)
        others = crossed[~np.isin(crossed, sought)]
        if not len(others):
            break
        sought = np.append(sought, others[:1])
    shares = before[crossed] / (before[crossed] - after[crossed])
    instants = np.where(crossed == who, bracket.zero(), shares * step)
    opens = after[crossed] >= 0.0
    changes = sorted(zip(instants.tolist(), crossed.tolist(), opens.tolist(), strict=True))
    return _Located(part, step, tuple(changes))


class _Bracket:
    """A sub-step ``left`` before and a sub-step ``right`` after a crossing, with their gaps.

    Parameters
    ----------
    step : float s
        The step in which the crossing lies.
    before, after : float m
        Gaps at its start and at its end.
    tolerance : float m
        Gap that is small enough.
    """

    def __init__(self, step: float, before: float, after: float, tolerance: float) -> None:
        self.left, self.right = 0.0, step
        self._before, self._after = before, after
        self._tolerance = tolerance
        self._shortest = _SHORTEST * step
        self._last_side = 0
        self.opens = after >= 0.0

    @property
    def is_met(self) -> bool:
        """True when the right end lies at the crossing."""
        return abs(self._after) <= self._tolerance or self.right - self.left <= self._shortest

    def trial(self) -> float:
        """Return the sub-step at which a line through both ends meets a tenth of the tolerance.

        The middle of the bracket when the line has missed twice on the same side.
        """
        if abs(self._last_side) > 1:
            return 0.5 * (self.left + self.right)
        aim = _AIM * self._tolerance * (1.0 if self.opens else -1.0)
        share = (aim - self._before) / (self._after - self._before)
        share = min(max(share, _EDGE), 1.0 - _EDGE)
        return self.left + share * (self.right - self.left)

    def narrow(self, step: float, gap: float) -> None:
        """Take note of the gap after a sub-step."""
        side = 1 if (gap >= 0.0) == self.opens else -1
        if side > 0:
            self.right, self._after = step, gap
        else:
            self.left, self._before = step, gap
        self._last_side = self._last_side + side if side * self._last_side > 0 else side

    def zero(self) -> float:
        """Return where the line through both ends crosses zero, from the start of the step [s]."""
        share = self._before / (self._before - self._after)
        return self.left + share * (self.right - self.left)


def _locate(
    stepper: Stepper, start: object, pantograph: int, bracket: _Bracket
) -> StepBlock | Status:
    """Solve sub-steps from ``start`` until one ends at the crossing, and stay there."""
    for _ in range(_LOCATING_STEPS):
        stepper.rewind(start)
        step = bracket.right if bracket.is_met else bracket.trial()
        block = stepper.advance(1, step)
        if block.status is not Status.RUNNING:
            return block.status
        if bracket.is_met:
            return block
        bracket.narrow(step, float(block.gap[0, pantograph]))
        if bracket.is_met and bracket.right == step:
            return block
    return Status.NOT_CONVERGED
