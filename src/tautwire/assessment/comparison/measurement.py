"""Comparison of a simulated run with a measured one, after the process of EN 50318 and IEC 63453.

Both forces are filtered in the same way. The measured one is laid over the line and compared where
both were taken, at the measured places; what was not measured counts on neither side.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from tautwire.assessment.comparison.coverage import Coverage, coverage_of
from tautwire.assessment.comparison.placement import Placement, place_on_line
from tautwire.assessment.comparison.stretches import (
    LengthFigures,
    SpanFigures,
    length_figures,
    span_figures,
)
from tautwire.assessment.limits import Limits, Tolerance, limits_of
from tautwire.errors import InputError
from tautwire.measured.evaluation import (
    BANDS,
    PERCENTILES,
    Evaluation,
    Treatment,
    evaluate,
    force_and_bands,
    unfiltered_force,
)
from tautwire.measured.faults import find_faults
from tautwire.measured.processing import EvenDistance, Processed
from tautwire.measured.recording import Recording
from tautwire.plain import Plain, named
from tautwire.results.run import Run
from tautwire.signals.bands import band_name, band_signal
from tautwire.signals.filters import Lowpass, SharpLowpass, evenly_spaced
from tautwire.signals.spectra import Spectrum, amplitude_spectrum

Array = NDArray[np.float64]

_UNITS = {"uplift": "m", "contact_height_range": "m", "elasticity": "m/N"}
_UP_TO = {
    "standard_deviation": 20.0,
    "maximum": 20.0,
    "minimum": 20.0,
    **{f"std_{band_name(band)}": band[1] for band in BANDS},
}
"""Frequency that the samples must hold for a number to be judged [Hz]."""
SHORTEST_WAVE = 1.0
"""Shortest wavelength of the spectra [m], shorter than any distance of droppers."""


@dataclass(frozen=True)
class MeasurementRow(Plain):
    """One number of the run beside the measured one.

    Attributes
    ----------
    quantity : str
    simulated, measured : float
        In `unit`.
    difference : float
        Simulated minus measured.
    relative_difference : float or None
        The same over the measured value; None where that is zero.
    unit : str
    low, high : float or None
        Allowed difference; a fraction of the measured value when `is_relative`.
    is_relative : bool
    within : bool or None
        Whether the difference is allowed; None without tolerance or value.
    passed : bool or None
        The same, but None as long as the tolerance is not verified.
    standard, edition, clause : str or None
        None without tolerance, or where the clause is not known.
    verified : bool
    note : str
    """

    quantity: str
    simulated: float
    measured: float
    difference: float
    relative_difference: float | None
    unit: str
    low: float | None
    high: float | None
    is_relative: bool
    within: bool | None
    passed: bool | None
    standard: str | None
    edition: str | None
    clause: str | None
    verified: bool
    note: str


@dataclass(frozen=True, eq=False)
class MeasurementComparison(Plain):
    """Table and overlay of a simulated and a measured run.

    Attributes
    ----------
    label : str
        Name of the measurement.
    pantograph : str
    filter : str
        Filter of both forces.
    start, end : float m
        Part of the line that was compared.
    rows : tuple of MeasurementRow
    percentiles : mapping of str to (float, float) N
        Force that a share of the way [%] lies below, simulated and measured.
    spans : tuple of SpanFigures
    tension_lengths : tuple of LengthFigures
        Empty for a line of one.
    coverage : Coverage
        What the comparison speaks of.
    placement : Placement
    notes : tuple of str
    position : (n,) m
        Common positions, increasing.
    simulated_force, measured_force : (n,) N
        Filtered forces there; NaN where nothing was measured.
    simulated_spectrum, measured_spectrum : Spectrum or None
        Amplitudes of the unfiltered forces over wave number.
    evaluation : Evaluation
        The measurement by itself.
    """

    derived: ClassVar[tuple[str, ...]] = ("missed",)
    untold: ClassVar[tuple[str, ...]] = (
        "position", "simulated_force", "measured_force", "simulated_spectrum", "measured_spectrum",
    )  # fmt: skip

    label: str = field(metadata=named("measurement"))
    pantograph: str
    filter: str
    start: float = field(metadata=named("start_m"))
    end: float = field(metadata=named("end_m"))
    rows: tuple[MeasurementRow, ...]
    percentiles: Mapping[str, tuple[float, float]]
    spans: tuple[SpanFigures, ...]
    tension_lengths: tuple[LengthFigures, ...]
    coverage: Coverage
    placement: Placement
    notes: tuple[str, ...]
    position: Array
    simulated_force: Array
    measured_force: Array
    simulated_spectrum: Spectrum | None
    measured_spectrum: Spectrum | None
    evaluation: Evaluation

    @property
    def missed(self) -> tuple[str, ...]:
        """Return the quantities whose difference is not allowed, whether verified or not."""
        return tuple(row.quantity for row in self.rows if row.within is False)


@dataclass(frozen=True, eq=False)
class _Track:
    """Forces, uplift and height at the contact point over increasing positions.

    `forces` has a row for the filtered force, one per band, and one for the unfiltered force.
    """

    position: Array
    forces: Array
    places: Array
    uplift: Array | None
    height: Array | None

    def forces_at(self, position: Array) -> Array:
        """Interpolate the rows of forces, (n,) m to (n_row, n) N."""
        return np.array([np.interp(position, self.position, row) for row in self.forces])

    def at(self, values: Array | None, position: Array) -> Array:
        """Interpolate uplift or height, (n,) m to (n,) m; NaN where there is none."""
        if values is None:
            return np.full(position.size, np.nan)
        return np.interp(position, self.places, values)


def compare_with_measurement(
    run: Run,
    recording: Recording,
    *,
    pantograph: str | None = None,
    treatment: Treatment | None = None,
    offset: float = 0.0,
    search: float | None = None,
    limits: Limits | None = None,
) -> MeasurementComparison:
    """Compare a run with a measurement over the part of the section that was measured.

    The uplift of a measurement is that at the pantograph, so the uplift at supports is compared at
    the instants of passing.

    Parameters
    ----------
    run : Run
    recording : Recording
    pantograph : str, optional
        Name; by default the leading one.
    treatment : Treatment, optional
        Filter and corrections of the measurement; the simulated force is filtered alike, at 20 Hz
        by the sharp filter where the measured one is filtered already.
    offset : float m
        Position in the model of the measurement's zero; where the line has chainage, what is added
        to the recorded one.
    search : float m, optional
        Largest error of the recorded positions; by default nearly half of the shortest span. 0
        takes the positions as they are.
    limits : Limits, optional
        Tolerances; by default those of the package.

    Raises
    ------
    InputError
        When the measurement has no force, or nothing in common with the analysed section.
    """
    asked, name = treatment or Treatment(), pantograph or run.pantographs[0].name
    if not len(recording.forces):
        raise InputError(f"{recording.label}: holds no force; nothing to compare")
    lowpass = asked.lowpass or SharpLowpass()
    simulated = _simulated_track(run, name, lowpass)
    faults = find_faults(recording)
    evaluation = evaluate(recording, asked, faults)
    notes = [*evaluation.notes, *incompleteness(run)]
    signal, bands = force_and_bands(recording, faults, asked, [])
    placement = place_on_line(
        run, recording, signal, (simulated.position, simulated.forces[0]), offset=offset,
        search=search,
    )  # fmt: skip
    notes += [*_running_directions(run, recording), placement.text]
    raw = _evenly(unfiltered_force(recording, faults, asked), signal)
    measured = _measured_track(recording, placement, np.vstack([signal.force, bands, raw]))
    inside = _common(run, simulated, measured, recording)
    position = measured.position[inside]
    forces = simulated.forces_at(position), measured.forces[:, inside]
    known = ~np.isnan(forces[1][0])
    numbers = [
        _numbers(run, track, part[:, known], position)
        for track, part in zip((simulated, measured), forces, strict=True)
    ]
    tolerances = {entry.quantity: entry for entry in (limits or limits_of(run.case)).tolerances}
    rows = tuple(
        _judged(quantity, value, numbers[1][quantity], tolerances, recording.highest_frequency)
        for quantity, value in numbers[0].items()
    )
    spectra = [_spectrum(position, part[-1], recording) for part in forces]
    return MeasurementComparison(
        label=recording.label,
        pantograph=name,
        filter=lowpass.describe() + ("" if asked.lowpass else "; the measured force as recorded"),
        start=float(position[0]),
        end=float(position[-1]),
        rows=rows,
        percentiles=_percentiles(forces, known),
        spans=span_figures(run, position, forces[0][0], forces[1][0]),
        tension_lengths=length_figures(run, position, forces[0][0], forces[1][0]),
        coverage=coverage_of(run, name, recording, (float(position[0]), float(position[-1]))),
        placement=placement,
        notes=tuple(dict.fromkeys(notes)),
        position=position,
        simulated_force=forces[0][0],
        measured_force=forces[1][0],
        simulated_spectrum=spectra[0],
        measured_spectrum=spectra[1],
        evaluation=evaluation,
    )


def _running_directions(run: Run, recording: Recording) -> list[str]:
    """Say that the two passages run against each other, where that is known."""
    chainage = run.case.line.chainage
    falls = chainage is not None and chainage[-1] < chainage[0]
    own = run.case.scenario.direction
    forwards = recording.is_rising != falls  # towards larger positions of the model
    if recording.chainage is None or forwards == (own == "+x"):
        return []
    return [
        f"the measurement runs towards {'rising' if recording.is_rising else 'falling'} positions, "
        f"the run in direction {own}: what is compared was passed the other way; for a like "
        f'passage run the case with scenario.direction="{"+x" if forwards else "-x"}"'
    ]


def _simulated_track(run: Run, name: str, lowpass: Lowpass) -> _Track:
    record, force = run.pantograph(name), run.contact_force(name)
    if force.time.size < 2:
        raise InputError(f"pantograph {name!r} never entered the line; nothing to compare")
    columns = np.column_stack([force.position, force.force])
    time, values = evenly_spaced(force.time, columns, run.case.settings.step())
    step = float(time[1] - time[0])
    rows = []
    try:
        rows.append(lowpass.apply(values[:, 1], step))
        rows += [band_signal(lowpass, values[:, 1], step, low, high) for low, high in BANDS]
    except ValueError as error:
        raise InputError(f"the simulated force cannot be filtered: {error}") from None
    place, height = record.position[record.active], record.wire_height[record.active]
    uplift = height - run.equilibrium.running_height(place)
    forward, onward = (slice(None, None, -1 if x[0] > x[-1] else 1) for x in (values[:, 0], place))
    return _Track(
        values[forward, 0],
        np.array([*rows, values[:, 1]])[:, forward],
        place[onward],
        uplift[onward],
        height[onward],
    )


def _evenly(raw: Processed, signal: Processed) -> Array:
    """Return the unfiltered force at the places of a processed one, free of aliases."""
    assert signal.distance is not None
    return EvenDistance(float(signal.distance[1] - signal.distance[0])).apply(raw).force


def _measured_track(recording: Recording, placement: Placement, forces: Array) -> _Track:
    order = slice(None, None, -1 if placement.position[0] > placement.position[-1] else 1)
    rows = slice(None, None, -1 if placement.rows[0] > placement.rows[-1] else 1)
    return _Track(
        placement.position[order],
        forces[:, order],
        placement.rows[rows],
        None if recording.uplift is None else recording.uplift[rows],
        None if recording.height is None else recording.height[rows],
    )


def _common(
    run: Run, simulated: _Track, measured: _Track, recording: Recording
) -> NDArray[np.bool_]:
    """Tell which measured places lie in the analysed section and were passed by the run."""
    first, last = run.case.resolved_section()
    supports = run.equilibrium.mast_x
    section = float(supports[first - 1]), float(supports[last])
    start, end = max(section[0], simulated.position[0]), min(section[1], simulated.position[-1])
    inside = (measured.position >= start) & (measured.position <= end)
    if (inside & ~np.isnan(measured.forces[0])).sum() < 2:
        raise InputError(
            f"{recording.label}: the measurement covers {measured.position[0]:.1f} m to "
            f"{measured.position[-1]:.1f} m of the model, the run {simulated.position[0]:.1f} m to "
            f"{simulated.position[-1]:.1f} m, the analysed section {section[0]:.1f} m to "
            f"{section[1]:.1f} m: nothing in common; give the offset of the measurement's zero"
        )
    return inside


def _numbers(run: Run, track: _Track, forces: Array, position: Array) -> dict[str, float]:
    """Return the compared numbers of one record; NaN where it does not hold them."""
    supports = run.equilibrium.mast_x
    inside = supports[(supports >= position[0]) & (supports <= position[-1])]
    uplift = track.at(track.uplift, inside)
    height = track.at(track.height, position)
    if track.height is None:
        height = run.equilibrium.running_height(position) + track.at(track.uplift, position)
    return {
        "mean": float(forces[0].mean()),
        "standard_deviation": float(forces[0].std()),
        **{
            f"std_{band_name(band)}": float(part.std())
            for band, part in zip(BANDS, forces[1:], strict=False)
        },
        "maximum": float(forces[0].max()),
        "minimum": float(forces[0].min()),
        "uplift": float(uplift.max()) if uplift.size else math.nan,
        "contact_height_range": float(np.ptp(height)),
    }


def _percentiles(
    forces: Sequence[Array], known: NDArray[np.bool_]
) -> dict[str, tuple[float, float]]:
    simulated, measured = (np.percentile(part[0, known], PERCENTILES) for part in forces)
    return {
        f"{share:g}": (float(a), float(b))
        for share, a, b in zip(PERCENTILES, simulated, measured, strict=True)
    }


def _spectrum(position: Array, force: Array, recording: Recording) -> Spectrum | None:
    """Return the amplitudes over wave number, gaps as the mean; None for a short record."""
    step = float(np.median(np.diff(position)))
    grid = np.arange(float(position[0]), float(position[-1]), step)
    if len(grid) < 64:
        return None
    filled = np.where(np.isnan(force), np.nanmean(force), force)
    found = amplitude_spectrum(np.interp(grid, position, filled), step)
    held = recording.highest_frequency * recording.interval / recording.spacing
    shown = found.abscissa <= min(1.0 / SHORTEST_WAVE, held)
    return Spectrum(found.abscissa[shown], found.value[shown], "1/m", found.window, 1)


def _judged(
    quantity: str,
    simulated: float,
    measured: float,
    tolerances: Mapping[str, Tolerance],
    highest: float,
) -> MeasurementRow:
    """Return a row; what lies beyond the samples has no tolerance, and its note says why."""
    wanted = _UP_TO.get(quantity, 0.0)
    if highest >= wanted:
        return row_of(quantity, simulated, measured, tolerances.get(quantity))
    note = f"not judged: needs {wanted:g} Hz, the samples hold {highest:.3g} Hz"
    return row_of(quantity, simulated, measured, None, note)


def incompleteness(run: Run) -> tuple[str, ...]:
    """Say that a run did not reach its end; nothing of one that did.

    Parameters
    ----------
    run
    """
    if run.status == "done":
        return ()
    why = f", {run.message}" if run.message else ""
    return (
        f"the run is not complete ({run.status}{why}): its numbers are those of the part that it "
        "computed",
    )


def row_of(
    quantity: str,
    simulated: float,
    measured: float,
    tolerance: Tolerance | None,
    note: str = "",
) -> MeasurementRow:
    """Return one number of a run beside the measured one, and whether its tolerance is met.

    Parameters
    ----------
    quantity : str
    simulated, measured : float
        In SI.
    tolerance : Tolerance or None
        None where none is known.
    note : str
        Told where there is no tolerance.
    """
    difference = simulated - measured
    relative = difference / measured if measured else None
    is_relative = tolerance is not None and tolerance.relative
    judged = relative if is_relative else difference
    within: bool | None = None
    if tolerance is not None and judged is not None and math.isfinite(judged):
        within = tolerance.low <= judged <= tolerance.high
    return MeasurementRow(
        quantity=quantity,
        simulated=simulated,
        measured=measured,
        difference=difference,
        relative_difference=relative,
        unit=_UNITS.get(quantity, "N"),
        low=None if tolerance is None else tolerance.low,
        high=None if tolerance is None else tolerance.high,
        is_relative=is_relative,
        within=within,
        passed=within if tolerance is not None and tolerance.verified else None,
        standard=None if tolerance is None else tolerance.standard,
        edition=None if tolerance is None else tolerance.edition,
        verified=tolerance is not None and tolerance.verified,
        clause=None if tolerance is None else tolerance.clause,
        note=note if tolerance is None else tolerance.note,
    )
