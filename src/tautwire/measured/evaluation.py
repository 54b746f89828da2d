"""A recording from its sensors to its figures: faults, steps, statistics, events, spectrum."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np

from tautwire.errors import InputError
from tautwire.measured.events import Event, force_events, hard_spots
from tautwire.measured.faults import (
    Fault,
    dead_accelerometers,
    find_faults,
    without_faulty_samples,
)
from tautwire.measured.processing import (
    AerodynamicCorrection,
    EvenDistance,
    Filtering,
    InertiaCorrection,
    Processed,
    ProcessingStep,
    process,
)
from tautwire.measured.recording import Array, Recording, Step
from tautwire.measured.summary import StretchStatistics, stretch_statistics
from tautwire.plain import Plain, named
from tautwire.signals.bands import band_name
from tautwire.signals.filters import Lowpass, SharpLowpass
from tautwire.signals.spectra import Spectrum, amplitude_spectrum

BANDS = ((0.0, 5.0), (5.0, 20.0))
"""Bands of the standard deviation [Hz]: spans and droppers, as in the world benchmark."""
PERCENTILES = (1.0, 5.0, 25.0, 50.0, 75.0, 95.0, 99.0)
"""Shares of the way [%] below a force: quartiles, and tails that some hundred metres still fill."""
SPACING = 0.25
"""Even distance of the processed force [m], as recorders usually write it."""
_FEWEST_LEFT = 4
"""Samples that a spline needs."""
_NOTHING_LEFT = (
    "{}: no sample of the force is left after gaps, faults and their margins; see which sensor is "
    "at fault, or leave its column aside in the mapping file"
)
HIGHEST_LINE = 50.0
"""Highest frequency of the spectrum that is shown [Hz]."""


@dataclass(frozen=True)
class Treatment:
    """How a recording is processed.

    Attributes
    ----------
    lowpass : Lowpass or None
        None for a force that is filtered already.
    masses : mapping of int to float kg
        Mass above the sensors by strip; without any, inertia is not corrected.
    air : AerodynamicCorrection or None
    stretch : float m
        Length of the stretches of the statistics where no marks tell spans.
    loss_below : float N
        Force at or below which contact counts as lost.
    high_above : float N or None
        Force above which an event is told; by default mean plus three standard deviations.
    hard_above : float m/s2 or None
        Acceleration of the head above which a hard spot is told; by default a multiple of what is
        usual in the run.
    """

    lowpass: Lowpass | None = field(default_factory=SharpLowpass)
    masses: Mapping[int, float] = field(default_factory=dict)
    air: AerodynamicCorrection | None = None
    stretch: float = 1000.0
    loss_below: float = 0.0
    high_above: float | None = None
    hard_above: float | None = None


@dataclass(frozen=True)
class ForceFigures(Plain):
    """Figures of the processed force.

    Attributes
    ----------
    mean, standard_deviation, maximum, minimum : float N
    statistical_maximum, statistical_minimum : float N
        Mean plus and minus three standard deviations.
    bands : dict of str to float N
        Standard deviation by band; NaN beyond what the samples hold.
    percentiles : dict of str to float N
    missing_share : float
    """

    mean: float
    standard_deviation: float
    maximum: float
    minimum: float
    statistical_maximum: float
    statistical_minimum: float
    bands: dict[str, float]
    percentiles: dict[str, float]
    missing_share: float


@dataclass(frozen=True)
class RangeFigures(Plain):
    """Least, mean and largest value of a channel, in SI, and the share without a reading."""

    name: str
    least: float
    mean: float
    largest: float
    unit: str
    missing_share: float


@dataclass(frozen=True, eq=False)
class Evaluation(Plain):
    """What a recording says.

    Attributes
    ----------
    label : str
    samples : int
    interval : float s
    length : float m
        Way run; NaN where unknown.
    direction : str
        ``"rising"`` or ``"falling"`` chainage.
    highest_frequency : float Hz
    notes : tuple of str
    faults : tuple of dict
    steps : tuple of dict
    force : ForceFigures or None
        None for a recording without force.
    ranges : tuple of RangeFigures
        Of the other channels.
    stretches, events : tuple
    position : (n,) m
        Chainage where it was recorded, else way run, of the processed force; NaN without either.
    time : (n,) s
        Of the processed force.
    values : (n,) N
    spectrum : Spectrum or None
        Amplitudes of the unfiltered force in its longest stretch without gaps.
    """

    untold: ClassVar[tuple[str, ...]] = ("position", "time", "values", "spectrum")

    label: str = field(metadata=named("recording"))
    samples: int
    interval: float = field(metadata=named("interval_s"))
    length: float = field(metadata=named("length_m"))
    direction: str
    highest_frequency: float = field(metadata=named("highest_frequency_hz"))
    notes: tuple[str, ...]
    faults: tuple[dict[str, Any], ...]
    steps: tuple[dict[str, Any], ...]
    force: ForceFigures | None
    ranges: tuple[RangeFigures, ...]
    stretches: tuple[dict[str, Any], ...]
    events: tuple[dict[str, Any], ...]
    position: Array
    time: Array
    values: Array
    spectrum: Spectrum | None

    @property
    def abscissa(self) -> tuple[str, Array]:
        """What the force stands over, with its heading: the position, or the time without one."""
        if np.isnan(self.position).all():
            return "time [s]", self.time
        return "position [m]", self.position


def evaluate(
    recording: Recording,
    treatment: Treatment | None = None,
    faults: tuple[Fault, ...] | None = None,
) -> Evaluation:
    """Process a recording and take its figures.

    Parameters
    ----------
    recording
    treatment
    faults
        As found before; by default they are looked for.

    Raises
    ------
    InputError
        When a correction asks for a channel that was not recorded.
    """
    asked = treatment or Treatment()
    if faults is None:
        has_force = len(recording.forces) > 0
        faults = find_faults(recording) if has_force else tuple(dead_accelerometers(recording))
    notes, force, stretches, events = list(recording.notes), None, [], []
    signal, spectrum, raw = None, None, None
    if len(recording.forces):
        signal, bands = force_and_bands(recording, faults, asked, notes)
        raw = unfiltered_force(recording, faults, asked)
        spectrum = _spectrum(recording, raw)
        force = _figures(signal, bands)
        events = _events(recording, signal, asked, force)
        stretches = _stretches(recording, signal, asked)
    hard, looked = hard_spots(recording, None if raw is None else raw.force, asked.hard_above)
    events = sorted([*events, *hard], key=lambda event: event.start)
    place = chainage_of(recording, signal) if signal is not None else np.empty(0)
    way = recording.distance
    return Evaluation(
        label=recording.label,
        samples=len(recording.time),
        interval=recording.interval,
        length=float(way[-1] - way[0]) if way is not None else math.nan,
        direction="rising" if recording.is_rising else "falling",
        highest_frequency=recording.highest_frequency,
        notes=tuple(notes),
        faults=tuple(_told(fault) for fault in faults),
        steps=tuple(_step(step) for step in (*(signal.steps if signal else ()), *looked)),
        force=force,
        ranges=_ranges(recording),
        stretches=tuple(vars(one) for one in stretches),
        events=tuple(vars(event) for event in events),
        position=place,
        time=signal.time if signal is not None else np.empty(0),
        values=signal.force if signal is not None else np.empty(0),
        spectrum=spectrum,
    )


def processed_force(
    recording: Recording, faults: Sequence[Fault], treatment: Treatment, notes: list[str]
) -> Processed:
    """Return the contact force, filtered and at even distance as far as that is possible.

    Parameters
    ----------
    recording
    faults
        Their samples are left out.
    treatment
    notes
        Takes what could not be done, and why.

    Raises
    ------
    InputError
        When a correction asks for a channel that was not recorded.
    """
    signal = unfiltered_force(recording, faults, treatment)
    steps: list[ProcessingStep] = []
    lowpass = treatment.lowpass
    if lowpass is not None and lowpass.cutoff >= 0.5 / recording.interval:
        notes.append(
            f"sampled every {1e3 * recording.interval:.3g} ms, too coarsely to be filtered at "
            f"{lowpass.cutoff:g} Hz; the force is taken as it is"
        )
    elif lowpass is not None:
        steps.append(Filtering(lowpass))
    if recording.distance is not None:
        steps.append(EvenDistance(max(SPACING, recording.spacing)))
    for step in steps:
        signal = step.apply(signal)
        if (~np.isnan(signal.force)).sum() < _FEWEST_LEFT:
            raise InputError(_NOTHING_LEFT.format(recording.label))
    return signal


def unfiltered_force(
    recording: Recording, faults: Sequence[Fault], treatment: Treatment
) -> Processed:
    """Return the contact force, corrected as far as that is asked for.

    Parameters
    ----------
    recording
    faults
        Their samples are left out.
    treatment

    Raises
    ------
    InputError
        When a correction asks for a channel that was not recorded, or nothing is left.
    """
    clean = without_faulty_samples(recording, tuple(faults))
    steps: list[ProcessingStep] = []
    if treatment.masses:
        steps.append(InertiaCorrection(treatment.masses))
    if treatment.air is not None:
        steps.append(treatment.air)
    as_recorded = recording.contact_force is not None and not treatment.masses
    try:
        signal = process(clean, steps, as_recorded=as_recorded)
    except ValueError as error:
        raise InputError(f"{recording.label}: {error}") from None
    if (~np.isnan(signal.force)).sum() < _FEWEST_LEFT:
        raise InputError(_NOTHING_LEFT.format(recording.label))
    return signal


def force_and_bands(
    recording: Recording, faults: Sequence[Fault], treatment: Treatment, notes: list[str]
) -> tuple[Processed, Array]:
    """Return the processed force and, at the same places, its parts per band.

    Parameters
    ----------
    recording, faults, treatment, notes
        As for :func:`processed_force`.

    Returns
    -------
    signal : Processed
    bands : (n_band, n) N
        One row per band of :data:`BANDS`; NaN beyond what the samples hold, or where the margins
        of gaps leave nothing. The bands of a force that is filtered already are those of the sharp
        filter.
    """
    signal = processed_force(recording, faults, treatment, notes)
    lowpass = treatment.lowpass or SharpLowpass()
    up_to = {0.0: np.zeros(len(signal.force))}
    for cutoff in sorted({high for _, high in BANDS}):
        up_to[cutoff] = np.full(len(signal.force), np.nan)
        if cutoff <= recording.highest_frequency:
            cut = replace(treatment, lowpass=lowpass.with_cutoff(cutoff))
            with suppress(InputError):  # nothing is left beside the gaps
                up_to[cutoff] = processed_force(recording, faults, cut, []).force
    return signal, np.array([up_to[high] - up_to[low] for low, high in BANDS])


def chainage_of(recording: Recording, signal: Processed) -> Array:
    """Return the recorded chainage at the samples of a signal [m]; else the way run, or NaN."""
    if recording.chainage is not None:
        return np.interp(signal.time, recording.time, recording.chainage)
    return np.full(len(signal.time), np.nan) if signal.distance is None else signal.distance


def _figures(signal: Processed, bands: Array) -> ForceFigures:
    known = signal.force[~np.isnan(signal.force)]
    mean, deviation = float(known.mean()), float(known.std())
    shares = np.percentile(known, PERCENTILES)
    return ForceFigures(
        mean=mean,
        standard_deviation=deviation,
        maximum=float(known.max()),
        minimum=float(known.min()),
        statistical_maximum=mean + 3.0 * deviation,
        statistical_minimum=mean - 3.0 * deviation,
        bands={
            band_name(band): float(np.nanstd(part)) if not np.isnan(part).all() else math.nan
            for band, part in zip(BANDS, bands, strict=True)
        },
        percentiles={f"{p:g}": float(v) for p, v in zip(PERCENTILES, shares, strict=True)},
        missing_share=signal.missing_share,
    )


def _events(
    recording: Recording, signal: Processed, treatment: Treatment, force: ForceFigures
) -> list[Event]:
    high = treatment.high_above
    place = chainage_of(recording, signal)
    return list(
        force_events(
            signal.time,
            place,
            signal.force,
            loss_below=treatment.loss_below,
            high_above=force.statistical_maximum if high is None else high,
        )
    )


def _stretches(
    recording: Recording, signal: Processed, treatment: Treatment
) -> list[StretchStatistics]:
    """Return statistics between marks where there are some, else of even stretches."""
    if signal.distance is None:
        return []
    place = chainage_of(recording, signal)
    ordered = slice(None) if place[-1] >= place[0] else slice(None, None, -1)
    place, force = place[ordered], signal.force[ordered]
    marks = np.unique(np.interp(recording.mark_times, recording.time, _places(recording)))
    if len(marks) > 2:
        labels = [f"{a:.1f} to {b:.1f} m" for a, b in pairwise(marks)]
        return list(stretch_statistics(place, force, marks.tolist(), labels))
    first = math.floor(place[0] / treatment.stretch)
    count = math.floor(place[-1] / treatment.stretch) - first + 1
    edges = [treatment.stretch * (first + n) for n in range(count + 1)]
    labels = [f"{a / 1e3:g} to {b / 1e3:g} km" for a, b in pairwise(edges)]
    return list(stretch_statistics(place, force, edges, labels))


def _places(recording: Recording) -> Array:
    if recording.chainage is not None:
        return recording.chainage
    assert recording.distance is not None
    return recording.distance


def _spectrum(recording: Recording, raw: Processed) -> Spectrum | None:
    """Return the amplitudes over frequency of the longest stretch without gaps."""
    known = np.concatenate([[False], ~np.isnan(raw.force), [False]]).astype(np.int8)
    edges = np.flatnonzero(np.diff(known)).reshape(-1, 2)
    if not len(edges):
        return None
    start, end = edges[int(np.argmax(edges[:, 1] - edges[:, 0]))].tolist()
    if end - start < 64:
        return None
    step = recording.interval
    time = np.arange(float(raw.time[start]), float(raw.time[end - 1]), step)
    found = amplitude_spectrum(np.interp(time, raw.time[start:end], raw.force[start:end]), step)
    shown = found.abscissa <= min(HIGHEST_LINE, recording.highest_frequency)
    return Spectrum(found.abscissa[shown], found.value[shown], "Hz", found.window, found.segments)


def _ranges(recording: Recording) -> tuple[RangeFigures, ...]:
    channels = [
        ("speed", recording.speed, "m/s"),
        ("height", recording.height, "m"),
        ("stagger", recording.stagger, "m"),
        ("thickness", recording.thickness, "m"),
        ("uplift", recording.uplift, "m"),
        ("arc", recording.arc, ""),
    ]
    channels += [
        (f"acceleration of strip {strip}", values, "m/s^2")
        for strip, values in zip(
            recording.acceleration_strips.tolist(), recording.accelerations, strict=True
        )
    ]
    return tuple(
        RangeFigures(
            name,
            float(np.nanmin(values)),
            float(np.nanmean(values)),
            float(np.nanmax(values)),
            unit,
            float(np.isnan(values).mean()),
        )
        for name, values, unit in channels
        if values is not None and not np.isnan(values).all()
    )


def _told(fault: Fault) -> dict[str, Any]:
    count = None if fault.samples is None else int(fault.samples.sum())
    return {
        "kind": fault.kind,
        "channel": fault.channel,
        "text": fault.text,
        "samples_left_out": count,
    }


def _step(step: Step) -> dict[str, Any]:
    return {"name": step.name, **step.parameters}
