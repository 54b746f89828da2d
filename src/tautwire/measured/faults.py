"""Faults of sensors and of the position, found in a recording and named; nothing is repaired here.

Every test compares a channel with itself, with its partners or with physics, and its limit stands
beside its reason. What is found are suspicions with numbers: a person decides.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from tautwire.measured.recording import Array, Recording

Kind = Literal[
    "drop-out",
    "spike",
    "saturation",
    "swapped sign",
    "wrong unit",
    "dead sensor",
    "gain",
    "swapped strips",
    "clock drift",
    "position jump",
]
Mask = NDArray[np.bool_]

FROZEN_SAMPLES = 10
"""Equal readings in a row that a live sensor with noise of a few quanta does not show by chance."""

SPIKE_DEVIATIONS = 15.0
"""Deviation of a spike from its neighbours over their usual deviation. Contact forces are smooth
over the five samples compared; the largest of 1e6 normal deviations is 5."""

SPIKE_FORCE = 40.0
"""Smallest spike that is told [N]. A computed contact force with losses, sampled at 1 kHz by two
sensors, departs by up to 27 N from the median of five samples; one sample of 40 N at 1 kHz moves a
force at 20 Hz by less than 2 N."""

CLIPPED_SAMPLES = 3
"""Samples in a row at exactly the extreme reading that count as clipped."""

CLIPPED_SHARE = 2e-4
"""Share of clipped samples from which a sensor is called saturated."""

PLAUSIBLE_MEAN = (30.0, 450.0)
"""Mean force of any pantograph in regular service [N], from 40 N of a light metro pantograph to
the 350 N of two heads on a DC line, with room."""

DEAD_SHARE = 0.05
"""Standard deviation of a dead sensor over that of its liveliest partner."""

GAIN_ERROR = 0.06
"""Relative difference of gains within a strip that is told; 10 % is found, 3 % is not."""

CLOCK_ERROR = 6e-3
"""Relative disagreement of clock and odometer that is told; wheels drift by up to 0.3 %."""

JUMP = 1.0
"""Sudden disagreement of odometer and speed that is told [m]."""

_STRIP_BAND = 20.0
"""Above this frequency the inertia of a strip is a notable share of its sensors' force [Hz]."""

_STRIP_CONTRAST = 0.1
"""Difference of correlations from which strips count as told apart."""


@dataclass(frozen=True)
class Fault:
    """Something suspicious.

    Attributes
    ----------
    kind : str
    channel : str
        The channel in words.
    text : str
        What was found, with numbers, and what to try.
    sensor : int or None
        Row of the force sensor.
    samples : (n,) bool or None
        Samples that should not be used; None where the whole channel is meant.
    """

    kind: Kind
    channel: str
    text: str
    sensor: int | None = None
    samples: Mask | None = None


def find_faults(recording: Recording) -> tuple[Fault, ...]:
    """Look for faults of sensors, units and position.

    Parameters
    ----------
    recording

    Returns
    -------
    tuple of Fault
        Empty for a clean recording.
    """
    tests: tuple[Callable[[Recording], Iterator[Fault]], ...] = (
        _dropouts,
        _spikes,
        _saturation,
        _signs,
        _unit,
        _dead,
        dead_accelerometers,
        _gains,
        _strips,
        _clock,
        _jumps,
    )
    return tuple(fault for test in tests for fault in test(recording))


def without_faulty_samples(recording: Recording, faults: tuple[Fault, ...]) -> Recording:
    """Return the recording with NaN where a sensor's samples are faulty.

    Parameters
    ----------
    recording
    faults
        As found; those that mean a whole channel change nothing.
    """
    forces = recording.forces.copy()
    for fault in faults:
        if fault.sensor is not None and fault.samples is not None:
            forces[fault.sensor, fault.samples] = np.nan
    return recording.with_(forces=forces)


def _sensor_name(recording: Recording, row: int) -> str:
    if len(recording.forces) == 1:
        return "contact force"
    strip = int(recording.force_strips[row])
    number = int(np.flatnonzero(recording.sensors_of(strip) == row)[0]) + 1
    return f"force sensor {number} of strip {strip}"


def _runs(mask: Mask) -> NDArray[np.int64]:
    """Return start and end (not included) of every run of true samples, ``(n_run, 2)``."""
    padded = np.concatenate([[False], mask, [False]]).astype(np.int8)
    return np.flatnonzero(np.diff(padded)).reshape(-1, 2)


def _mask_of(runs: NDArray[np.int64], count: int) -> Mask:
    mask = np.zeros(count, dtype=bool)
    for start, end in runs:
        mask[start:end] = True
    return mask


def _dropouts(recording: Recording) -> Iterator[Fault]:
    """Find missing readings, and readings that stand still."""
    for row, force in enumerate(recording.forces):
        if _is_dead(recording, row):
            continue
        missing = np.isnan(force)
        still = np.concatenate([np.diff(force) == 0.0, [False]])
        runs = _runs(still)
        least = max(FROZEN_SAMPLES, 4.0 * _usual_run(force))
        frozen = runs[runs[:, 1] - runs[:, 0] >= least - 1] + np.array([0, 1])
        frozen = frozen[~_at_extreme(force, frozen) & _is_abrupt(force, frozen)]
        samples = missing | _mask_of(frozen, len(force))
        if samples.any():
            places = _runs(samples)
            begin, end = recording.time[places[0, 0]], recording.time[places[0, 1] - 1]
            yield Fault(
                "drop-out",
                _sensor_name(recording, row),
                f"{samples.sum()} samples in {len(places)} places are missing or stand still, "
                f"first from {begin:.3f} s to {end:.3f} s; they are left out, not bridged",
                row,
                samples,
            )


def _usual_run(force: Array) -> float:
    """Return how many equal readings in a row are usual: the 99 % quantile of the lengths.

    A smooth force sampled fast or written coarsely repeats its reading on every crest; that is no
    fault. Runs at the ends of the range are not counted.
    """
    inside = force[(force > np.nanmin(force)) & (force < np.nanmax(force))]
    changes = np.flatnonzero(np.diff(inside) != 0.0)
    return float(np.quantile(np.diff(changes), 0.99)) if len(changes) > 1 else 1.0


def _is_abrupt(force: Array, runs: NDArray[np.int64]) -> Mask:
    """Tell which runs begin or end with a jump; a smooth force leaves a level by one quantum."""
    steps = np.abs(np.diff(force, prepend=np.nan, append=np.nan))
    quantum = float(np.nanmin(np.where(steps > 0.0, steps, np.inf), initial=np.inf))
    edges = np.fmax(steps[runs[:, 0]], steps[runs[:, 1]]) if len(runs) else np.empty(0)
    return ~(edges <= 1.5 * quantum)


def _at_extreme(force: Array, runs: NDArray[np.int64]) -> Mask:
    """Tell which runs stand at the largest or smallest reading: those are clipped, not frozen."""
    low, high = np.nanmin(force), np.nanmax(force)
    return np.array([force[start] in (low, high) and force[start] != 0.0 for start, _ in runs],
                    dtype=bool)  # fmt: skip


def _spikes(recording: Recording) -> Iterator[Fault]:
    """Find single samples far from their neighbours."""
    from scipy.ndimage import median_filter

    for row, force in enumerate(recording.forces):
        if np.isnan(force).all():
            continue
        known = np.where(np.isnan(force), np.nanmedian(force), force)
        deviation = np.abs(known - median_filter(known, 5, mode="nearest"))
        # The standard deviation of normal noise is 1.4826 times its median deviation.
        usual = 1.4826 * float(np.median(deviation))
        samples = deviation > max(SPIKE_DEVIATIONS * usual, SPIKE_FORCE)
        samples &= ~np.isnan(force)
        if samples.any():
            yield Fault(
                "spike",
                _sensor_name(recording, row),
                f"{len(_runs(samples))} spikes of up to {deviation.max():.0f} N, the largest at "
                f"{recording.time[int(deviation.argmax())]:.3f} s; they are left out",
                row,
                samples,
            )


def _saturation(recording: Recording) -> Iterator[Fault]:
    """Find plateaus at exactly the extreme reading."""
    for row, force in enumerate(recording.forces):
        if _is_dead(recording, row):
            continue
        for level in (np.nanmax(force), np.nanmin(force)):
            if level == 0.0:  # a drop-out, or a real loss of contact
                continue
            runs = _runs(force == level)
            least = max(CLIPPED_SAMPLES, 2.0 * _usual_run(force) + 1.0)
            clipped = runs[runs[:, 1] - runs[:, 0] >= least]
            samples = _mask_of(clipped, len(force))
            if samples.mean() > CLIPPED_SHARE:
                yield Fault(
                    "saturation",
                    _sensor_name(recording, row),
                    f"{samples.sum()} samples in {len(clipped)} places stand at exactly "
                    f"{level:.1f} N, the end of its range; they are left out",
                    row,
                    samples,
                )


def _signs(recording: Recording) -> Iterator[Fault]:
    """Find a sensor whose mean is negative while the pantograph lifts."""
    for row, force in enumerate(recording.forces):
        mean = float(np.nanmean(force)) if not np.isnan(force).all() else 0.0
        if mean < 0.0 and abs(mean) > np.nanstd(force) * DEAD_SHARE:
            yield Fault(
                "swapped sign",
                _sensor_name(recording, row),
                f"its mean is {mean:.1f} N, but a pantograph lifts the wire; turn its sign",
                row,
            )


_UNITS = (("kN", 1e3), ("daN", 10.0), ("kgf", 9.80665), ("lbf", 4.4482216))


def _unit(recording: Recording) -> Iterator[Fault]:
    """Find a mean force, or a speed, that fits another unit better."""
    total = float(np.nansum(np.nanmean(np.abs(recording.forces), axis=1)))
    low, high = PLAUSIBLE_MEAN
    if not low <= total <= high:
        fitting = [unit for unit, factor in _UNITS if low <= total * factor <= high]
        hint = f"they may be in {' or '.join(fitting)}" if fitting else "check unit and calibration"
        yield Fault(
            "wrong unit",
            "force sensors",
            f"together they read {total:.3g} N on average, {low:g} to {high:g} N are usual; {hint}",
        )
    ratio = _speed_ratio(recording)
    if ratio is not None and not _is_near_one(ratio):
        named = {3.6: "m/s read as km/h", 1.0 / 3.6: "km/h read as m/s", 0.44704: "mph"}
        close = [
            word for value, word in named.items() if abs(ratio / value - 1.0) < 3.0 * CLOCK_ERROR
        ]
        yield Fault(
            "wrong unit",
            "speed",
            f"the odometer moves {ratio:.3f} times as fast as the speed says"
            + (f" ({close[0]})" if close else ""),
        )


def _is_near_one(ratio: float) -> bool:
    """Tell drifting clocks and wheels, off by percents, from units: half and more."""
    return 0.9 < ratio < 1.1


def _speed_ratio(recording: Recording) -> float | None:
    """Return the way of the odometer over the way of the speed."""
    if recording.speed is None or recording.distance is None:
        return None
    way = np.diff(recording.distance)
    steps = np.diff(recording.time)
    from_speed = 0.5 * (recording.speed[1:] + recording.speed[:-1]) * steps
    # Without jumps of the odometer; twenty samples' way is room for a speed in km/h.
    usual = np.abs(way - from_speed) < np.median(np.abs(way)) * 20.0 + JUMP
    return float(way[usual].sum() / from_speed[usual].sum()) if from_speed[usual].sum() else None


def _is_dead(recording: Recording, row: int) -> bool:
    deviations = np.nanstd(recording.forces, axis=1)
    liveliest = float(np.nanmax(deviations))
    return len(deviations) > 1 and bool(deviations[row] < DEAD_SHARE * liveliest)


def _dead(recording: Recording) -> Iterator[Fault]:
    """Find a sensor that hardly moves while its partners do."""
    for row in range(len(recording.forces)):
        if _is_dead(recording, row):
            yield Fault(
                "dead sensor",
                _sensor_name(recording, row),
                f"it moves by {np.nanstd(recording.forces[row]):.2g} N, less than "
                f"{100 * DEAD_SHARE:g} % of its liveliest partner; the sum lacks its share",
                row,
            )


def dead_accelerometers(recording: Recording) -> Iterator[Fault]:
    """Find accelerometers that read nothing, or the same throughout.

    Parameters
    ----------
    recording
        With or without forces.
    """
    for row in np.flatnonzero(~recording.is_live).tolist():
        known = recording.accelerations[row][~np.isnan(recording.accelerations[row])]
        said = f"{known[0]:g} m/s² throughout" if len(known) else "nothing"
        strip = int(recording.acceleration_strips[row])
        rest = "the others" if recording.strip_acceleration(strip) is not None else "none"
        yield Fault(
            "dead sensor",
            recording.accelerometer_name(row),
            f"it reads {said}; left out, which leaves {rest} of its strip",
        )


def _gains(recording: Recording) -> Iterator[Fault]:
    """Find two sensors of a strip that would not share a wire in the middle evenly.

    The wire at lateral position y loads the two sensors of a strip with ``1/2 +- y/b`` of its
    force. With equal gains their shares at y = 0 are equal.
    """
    for strip in recording.strips():
        rows = recording.sensors_of(strip)
        if len(rows) != 2 or any(_is_dead(recording, int(row)) for row in rows):
            continue
        first, second = recording.forces[rows]
        if min(np.nanmean(first), np.nanmean(second)) <= 0.0:
            continue
        ratio = _gain_ratio(first, second, recording.stagger)
        if abs(ratio - 1.0) > GAIN_ERROR:
            yield Fault(
                "gain",
                f"force sensors of strip {strip}",
                f"with the wire in the middle sensor 1 reads {ratio:.3f} times what sensor 2 reads"
                + ("" if recording.stagger is not None else " (mean of the run, stagger unknown)")
                + "; check their calibration",
            )


def _gain_ratio(first: Array, second: Array, stagger: Array | None) -> float:
    """Return the ratio of the readings of two sensors for a wire in the middle."""
    known = ~(np.isnan(first) | np.isnan(second))
    total = first + second
    known &= total > 0.3 * np.nanmedian(total)  # a share of little force is mostly noise
    share = first[known] / total[known]
    if stagger is None or np.nanstd(stagger) < 0.02:  # a wire that hardly moves: no slope to fit
        middle = float(np.median(share))
    else:
        lateral = stagger[known]
        usable = ~np.isnan(lateral)
        matrix = np.column_stack([np.ones(usable.sum()), lateral[usable]])
        middle = float(np.linalg.lstsq(matrix, share[usable], rcond=None)[0][0])
    return middle / (1.0 - middle)


def _strips(recording: Recording) -> Iterator[Fault]:
    """Find accelerometers that move with the sensors of the other strip."""
    strips = recording.strips()
    parts = {
        strip: (
            _fast(recording, recording.forces[recording.sensors_of(strip)].sum(axis=0)),
            recording.strip_acceleration(strip),
        )
        for strip in strips
    }
    for one, other in combinations(strips, 2):
        (force_1, acc_1), (force_2, acc_2) = parts[one], parts[other]
        if acc_1 is None or acc_2 is None:
            continue
        fast_1, fast_2 = _fast(recording, acc_1), _fast(recording, acc_2)
        own = _correlation(force_1, fast_1) + _correlation(force_2, fast_2)
        crossed = _correlation(force_1, fast_2) + _correlation(force_2, fast_1)
        if crossed > own + 2.0 * _STRIP_CONTRAST:
            yield Fault(
                "swapped strips",
                f"strips {one} and {other}",
                f"forces of one move with the accelerations of the other (correlation "
                f"{0.5 * crossed:.2f} against {0.5 * own:.2f}); exchange their accelerometers",
            )


def _fast(recording: Recording, signal: Array) -> Array:
    """Return what a signal holds above the band in which strips move together."""
    from tautwire.signals.filters import SharpLowpass

    known = np.where(np.isnan(signal), np.nanmedian(signal), signal)
    if recording.interval * _STRIP_BAND >= 0.5:
        return known - known.mean()
    return known - SharpLowpass(_STRIP_BAND).apply(known, recording.interval)


def _correlation(a: Array, b: Array) -> float:
    scale = float(np.linalg.norm(a) * np.linalg.norm(b))
    return float(a @ b) / scale if scale else 0.0


def _clock(recording: Recording) -> Iterator[Fault]:
    """Find a clock that runs at another rate than odometer and speed say."""
    ratio = _speed_ratio(recording)
    if ratio is None or not _is_near_one(ratio):
        return
    if abs(ratio - 1.0) > CLOCK_ERROR:
        yield Fault(
            "clock drift",
            "time",
            f"the odometer moves {100 * (ratio - 1.0):+.2f} % faster than speed and time say, "
            f"wheels drift by at most {100 * CLOCK_ERROR / 2:g} %; frequencies and speeds are off "
            "by as much",
        )


def _jumps(recording: Recording) -> Iterator[Fault]:
    """Find an odometer that jumps: one that was counted on, or that disagrees with the speed."""
    if recording.jumps:
        way, size = recording.jumps[0]
        yield Fault(
            "position jump",
            "position",
            f"{len(recording.jumps)} jumps that the train did not make, the first by {size:+.1f} m "
            f"after {way:.1f} m; it is counted on, and what lies beyond is off by as much",
        )
    if recording.distance is None or recording.speed is None:
        return
    way = np.diff(recording.distance)
    from_speed = 0.5 * (recording.speed[1:] + recording.speed[:-1]) * np.diff(recording.time)
    jumps = np.flatnonzero(np.abs(way - from_speed) > JUMP + 0.05 * np.abs(from_speed))
    if len(jumps):
        first = int(jumps[0])
        size = float(way[first] - from_speed[first])
        yield Fault(
            "position jump",
            "distance",
            f"{len(jumps)} jumps, the first by {size:+.1f} m at {recording.time[first]:.3f} s; "
            "positions after it are off by as much until they are aligned",
        )
