"""From sensors to the contact force, in separate, named steps (after EN 50317).

Clause numbers are not given: no text of the standard was at hand. What the sensors below the head
carry differs from the contact force by the inertia of the mass above them and by the air::

    F = sum F_sensor - sum_strip m_strip a_strip + F_air(v)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from tautwire.measured.recording import Array, Recording, Step
from tautwire.signals.filters import Lowpass, evenly_spaced

_ALIASING = 0.8
"""Share of the Nyquist frequency of the new sampling that is kept by :class:`EvenDistance`."""


@dataclass(frozen=True, eq=False)
class Processed:
    """A contact force on its way from the sensors.

    Attributes
    ----------
    recording : Recording
    time : (n,) s
    force : (n,) N
        NaN where a sensor was missing or a filter would have reached into a gap.
    distance : (n,) m or None
        Odometer at the samples.
    steps : tuple of Step
        What was done, in order.
    """

    recording: Recording
    time: Array
    force: Array
    distance: Array | None
    steps: tuple[Step, ...] = ()

    @property
    def missing_share(self) -> float:
        """Share of the samples without a force."""
        return float(np.isnan(self.force).mean())


class ProcessingStep(Protocol):
    """One step; it adds what it did to the record of steps."""

    def apply(self, signal: Processed) -> Processed:
        """Return the processed signal."""
        ...


def process(
    recording: Recording, steps: Sequence[ProcessingStep], *, as_recorded: bool = False
) -> Processed:
    """Sum the sensors, or take the contact force that was recorded, and apply steps in order.

    Parameters
    ----------
    recording
    steps
        What comes after the sum.
    as_recorded
        Whether to take the force that the recorder computed, which the sensors only check.

    Raises
    ------
    ValueError
        When no such force was recorded.
    """
    total = recording.forces.sum(axis=0)  # NaN where any sensor is missing
    first = Step("sum of sensors", {"sensors": len(recording.forces)})
    if as_recorded:
        if recording.contact_force is None:
            raise ValueError("the recording has no contact force besides its sensors")
        difference = recording.contact_force - total
        known = ~np.isnan(difference)
        apart = float(difference[known].mean()) if known.any() else float("nan")
        parameters = {"sensors": len(recording.forces), "mean_above_their_sum_n": apart}
        total, first = recording.contact_force, Step("contact force as recorded", parameters)
    signal = Processed(recording, recording.time, total, recording.distance, (first,))
    for step in steps:
        signal = step.apply(signal)
    return signal


@dataclass(frozen=True)
class InertiaCorrection:
    """Take the inertia of the strips off the force of the sensors.

    Parameters
    ----------
    masses : mapping of int to float kg
        Mass above the sensors, by strip; a strip without mass is not corrected.
    """

    masses: Mapping[int, float]

    def apply(self, signal: Processed) -> Processed:
        """See :class:`ProcessingStep`."""
        force = signal.force.copy()
        for strip, mass in self.masses.items():
            if mass == 0.0:
                continue
            acceleration = signal.recording.strip_acceleration(strip)
            if acceleration is None:
                raise ValueError(
                    f"strip {strip} has no accelerometer, or none whose readings differ; give its "
                    "mass as 0 kg to leave its inertia uncorrected"
                )
            force -= mass * acceleration
        return _with(signal, Step("inertia correction", {"mass_kg": dict(self.masses)}), force)


@dataclass(frozen=True)
class AerodynamicCorrection:
    """Add the aerodynamic force on what is above the sensors, a table over speed by direction.

    Parameters
    ----------
    speed, force : tuple of float m/s, N
        Speeds increase; beyond the table the nearest value holds, and the step says at how many
        samples.
    direction : str
        Of running for which the table holds.
    """

    speed: tuple[float, ...]
    force: tuple[float, ...]
    direction: str = "forward"

    def apply(self, signal: Processed) -> Processed:
        """See :class:`ProcessingStep`."""
        if signal.recording.speed is None:
            raise ValueError("the recording has no speed for the aerodynamic correction")
        speed = signal.recording.speed
        added = np.interp(speed, self.speed, self.force)
        parameters = {
            "direction": self.direction, "speed_m_s": self.speed, "force_n": self.force,
            **self._beyond(speed),
        }  # fmt: skip
        return _with(signal, Step("aerodynamic correction", parameters), signal.force + added)

    def _beyond(self, speed: Array) -> dict[str, Any]:
        """Say which share of the speeds (n,) [m/s] the table does not reach, and their range."""
        outside = speed[(speed < self.speed[0]) | (speed > self.speed[-1])]
        if not len(outside):
            return {}
        return {
            "share_beyond_table": len(outside) / len(speed),
            "speeds_beyond_m_s": (float(outside.min()), float(outside.max())),
        }


@dataclass(frozen=True)
class Filtering:
    """Low-pass the force over time.

    A gap is bridged by a line for the filter, and taken out again with a margin of one period of
    the cut-off on either side, within which the filter has seen the bridge.

    Parameters
    ----------
    lowpass : Lowpass
    """

    lowpass: Lowpass

    def apply(self, signal: Processed) -> Processed:
        """See :class:`ProcessingStep`."""
        step = float(np.median(np.diff(signal.time)))
        missing = np.isnan(signal.force)
        bridged = signal.force
        if missing.any():
            known = ~missing
            bridged = np.interp(signal.time, signal.time[known], signal.force[known])
        grid, values = evenly_spaced(signal.time, bridged[:, None], step)
        smooth = self.lowpass.apply(values[:, 0], float(grid[1] - grid[0]))
        force = np.interp(signal.time, grid, smooth)
        margin = int(np.ceil(1.0 / (self.lowpass.cutoff * step)))
        force[_widened(missing, margin)] = np.nan
        parameters = {
            "filter": self.lowpass.describe(),
            "cutoff_hz": self.lowpass.cutoff,
            "margin_of_gaps_samples": margin,
        }
        return _with(signal, Step("filter", parameters), force)


@dataclass(frozen=True)
class EvenDistance:
    """Resample the force at even steps of the distance run.

    A cubic spline through the samples is evaluated at the instants at which the odometer reaches
    the steps. The force must hold nothing beyond the Nyquist frequency of the new samples, so it
    is filtered first where the steps are coarse.

    Parameters
    ----------
    spacing : float m
    """

    spacing: float

    def apply(self, signal: Processed) -> Processed:
        """See :class:`ProcessingStep`."""
        from scipy.interpolate import CubicSpline

        from tautwire.signals.filters import SharpLowpass

        if signal.distance is None:
            raise ValueError("the recording has no distance to sample by")
        moving = np.concatenate([[True], np.diff(np.maximum.accumulate(signal.distance)) > 0.0])
        place, time = signal.distance[moving], signal.time[moving]
        fastest = float((np.diff(place) / np.diff(time)).max())
        interval = float(np.median(np.diff(signal.time)))
        highest = _ALIASING * 0.5 * fastest / self.spacing
        held = [step.parameters.get("cutoff_hz", np.inf) for step in signal.steps]
        if highest < min([0.5 / interval, *held]):
            signal = Filtering(SharpLowpass(highest)).apply(signal)
        grid = np.arange(place[0], place[-1], self.spacing)
        instants = np.interp(grid, place, time)
        known = ~np.isnan(signal.force)
        force = np.full(len(grid), np.nan)
        if known.sum() >= 2:
            force = CubicSpline(signal.time[known], signal.force[known])(instants)
        missing = np.interp(instants, signal.time, (~known).astype(float)) > 0.0
        force[missing] = np.nan
        done = Step("even distance", {"spacing_m": self.spacing})
        return replace(
            signal, time=instants, force=force, distance=grid, steps=(*signal.steps, done)
        )


def _with(signal: Processed, step: Step, force: Array) -> Processed:
    return replace(signal, force=force, steps=(*signal.steps, step))


def _widened(mask: NDArray[np.bool_], margin: int) -> NDArray[np.bool_]:
    """Return a mask grown by some samples on either side."""
    if not mask.any():
        return mask
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    grown = mask.copy()
    for start, end in edges.reshape(-1, 2):
        grown[max(0, start - margin) : end + margin] = True
    return grown
