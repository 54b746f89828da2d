"""Step control: how a passage is divided into time steps.

Each control is a small frozen object. It is given a time integration and yields what it has done
in chunks; samples lie at whole multiples of ``time_step``, whatever happens in between.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import inf
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.events.crossings import Crossing, divide_step
from tautwire.numerics.motion.stepper import StepBlock, Stepper
from tautwire.status import Status

Array = NDArray[Any]


@dataclass(frozen=True, eq=False)
class Task:
    """What a step control is to do.

    Attributes
    ----------
    stepper : Stepper
        At its start; its options' step is the control's ``time_step``.
    steps : int
        Number of samples to take.
    chunk : int
        Samples after which coordinates are wanted.
    contact_stiffness : float N/m
    focus : (begin, end) s
        While a pantograph is in the analysed section.
    """

    stepper: Stepper
    steps: int
    chunk: int
    contact_stiffness: float
    focus: tuple[float, float]


@dataclass(frozen=True, eq=False)
class Chunk:
    """A number of samples, final.

    Attributes
    ----------
    steps : StepBlock
    coordinates : (n_dof,)
        Nodal coordinates at the last sample.
    crossings : tuple of Crossing or None
        Located between the samples; None for a control that does not locate them.
    """

    steps: StepBlock
    coordinates: Array
    crossings: tuple[Crossing, ...] | None = None


class StepControl(Protocol):
    """What every step control offers."""

    @property
    def time_step(self) -> float:
        """Sampling interval of the record [s]."""
        ...

    @property
    def corrects_waves(self) -> bool:
        """True when the wires are stiffened against the loss of wave speed."""
        ...

    def integrate(self, task: Task) -> Iterator[Chunk]:
        """Integrate to the end; the status of the last chunk tells why it ended."""
        ...

    def describe(self) -> str:
        """Name with parameters, as written to results."""
        ...


def wave_words(control: StepControl) -> str:
    """Tell whether a control makes up for the loss of wave speed."""
    return ", wave speed corrected" if control.corrects_waves else ""


@dataclass(frozen=True)
class ConstantStep:
    """Advance with one time step throughout.

    Parameters
    ----------
    time_step
        [s]
    corrects_waves
        Stiffen the wires against the loss of wave speed
        (:mod:`tautwire.numerics.motion.dispersion`).
    """

    time_step: float
    corrects_waves: bool = True

    def integrate(self, task: Task) -> Iterator[Chunk]:
        """Advance chunk by chunk."""
        done = 0
        while done < task.steps:
            steps = task.stepper.advance(min(task.chunk, task.steps - done))
            done += len(steps.time)
            yield Chunk(steps, task.stepper.coordinates.copy())
            if steps.status is not Status.RUNNING:
                return

    def describe(self) -> str:
        """Name with parameters, as written to results."""
        return f"constant step {1e3 * self.time_step:g} ms{wave_words(self)}"


@dataclass(frozen=True)
class VariableStep:
    """Divide every step in which a contact opens or closes at that instant (paper section V).

    The instant is located to a gap, or to a contact force. Away from it, and before it, the step
    and its error are those of a constant step.

    Parameters
    ----------
    time_step
        Step away from separations and re-contacts [s].
    tolerance
        Gap at which a crossing counts as met [m].
    force_tolerance
        The same as a contact force [N]; replaces ``tolerance``.
    most_losses
        Losses per pantograph after which the integration stops; without a limit by default.
    corrects_waves
        Stiffen the wires against the loss of wave speed.
    """

    time_step: float
    tolerance: float = 1e-4  # 5 N at 50 kN/m, a fiftieth of the force before a loss
    force_tolerance: float | None = None
    most_losses: float = inf
    corrects_waves: bool = True

    def integrate(self, task: Task) -> Iterator[Chunk]:
        """Advance chunk by chunk, dividing steps."""
        counter = LossCounter(self.most_losses)
        done = 0
        gap: Array | None = None
        while done < task.steps:
            chunk, gap = self._chunk(task, min(task.chunk, task.steps - done), gap)
            done += len(chunk.steps.time)
            yield counter.checked(chunk)
            if chunk.steps.status is not Status.RUNNING or counter.is_exceeded:
                return

    def _chunk(self, task: Task, samples: int, gap: Array | None) -> tuple[Chunk, Array | None]:
        """Take a number of samples; return also the gaps at the last one."""
        tolerance = self.tolerance
        if self.force_tolerance is not None:
            tolerance = self.force_tolerance / task.contact_stiffness
        blocks: list[StepBlock] = []
        crossings: list[Crossing] = []
        status, done = Status.RUNNING, 0
        while done < samples and status is Status.RUNNING:
            block = task.stepper.advance(samples - done, self.time_step, until_crossing=True)
            status = block.status
            if len(block.time):
                gap = block.gap[-1]
            if block.refused_gap is not None:
                before = np.full_like(block.refused_gap, np.nan) if gap is None else gap
                divided = divide_step(task.stepper, self.time_step, before, tolerance)
                crossings += divided.crossings
                status = divided.status
                if status is Status.RUNNING:
                    block = StepBlock.joined([block, divided.parts[-1]], status)
                    gap = block.gap[-1]
            blocks.append(block)
            done += len(block.time)
        steps = StepBlock.joined(blocks, status)
        return Chunk(steps, task.stepper.coordinates.copy(), tuple(crossings)), gap

    def describe(self) -> str:
        """Name with parameters, as written to results."""
        met = f"{self.tolerance:g} m"
        if self.force_tolerance is not None:
            met = f"{self.force_tolerance:g} N"
        return (
            f"variable step {1e3 * self.time_step:g} ms, contact changes located to {met}"
            f"{wave_words(self)}"
        )


class LossCounter:
    """Counts separations, and stops an integration that meets too many.

    Parameters
    ----------
    most
        Losses per pantograph that are followed.
    """

    def __init__(self, most: float) -> None:
        self._most = most
        self._counts: dict[int, int] = {}

    @property
    def is_exceeded(self) -> bool:
        """True when a pantograph has lost contact too often."""
        return max(self._counts.values(), default=0) > self._most

    def checked(self, chunk: Chunk) -> Chunk:
        """Count the losses of a chunk; give it the status to stop with when they are too many."""
        for crossing in chunk.crossings or ():
            if crossing.opens:
                self._counts[crossing.pantograph] = self._counts.get(crossing.pantograph, 0) + 1
        if not self.is_exceeded or chunk.steps.status is not Status.RUNNING:
            return chunk
        return replace(chunk, steps=replace(chunk.steps, status=Status.TOO_MANY_LOSSES))
