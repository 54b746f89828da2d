"""Comparison of a simulated run with a measured one, after EN 50318.

Both forces are filtered in the same way, then brought to common positions over the part of the
analysed section that was measured.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from tautwire.assessment.limits import Limits, Tolerance, load_limits
from tautwire.errors import InputError
from tautwire.inputs.measured import MeasuredRun
from tautwire.plain import Plain, named
from tautwire.results.run import Run
from tautwire.signals.bands import band_signal
from tautwire.signals.filters import Lowpass, SharpLowpass, evenly_spaced, is_uniform

Array = NDArray[np.float64]

_BANDS = ((0.0, 5.0), (5.0, 20.0))
"""Bands that are compared [Hz], those of EN 50318:2018 as remembered."""
_UNITS = {"uplift": "m", "contact_height_range": "m"}
_LARGE_STEP = 3.0
"""A step longer than so many median steps is reported as a hole in the measurement."""


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
    standard, edition : str or None
        None without tolerance.
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
    position : (n,) m
        Common positions, increasing.
    simulated_force, measured_force : (n,) N
        Filtered forces there.
    notes : tuple of str
    """

    derived: ClassVar[tuple[str, ...]] = ("missed",)

    label: str = field(metadata=named("measurement"))
    pantograph: str
    filter: str
    start: float = field(metadata=named("start_m"))
    end: float = field(metadata=named("end_m"))
    rows: tuple[MeasurementRow, ...]
    position: Array
    simulated_force: Array
    measured_force: Array
    notes: tuple[str, ...]

    @property
    def missed(self) -> tuple[str, ...]:
        """Return the quantities whose difference is not allowed, whether verified or not."""
        return tuple(row.quantity for row in self.rows if row.within is False)


@dataclass(frozen=True, eq=False)
class _Track:
    """Filtered force, its bands, and uplift at the contact point over increasing positions.

    `forces` has one column for the filtered force and one per band.
    """

    position: Array
    forces: Array
    uplift_position: Array
    uplift: Array | None

    def forces_at(self, position: Array) -> Array:
        """Interpolate the columns of forces, (n,) m to (n, n_column) N."""
        columns = [np.interp(position, self.position, column) for column in self.forces.T]
        return np.column_stack(columns)

    def uplift_at(self, position: Array) -> Array:
        """Interpolate the uplift, (n,) m to (n,) m; NaN where it was not recorded."""
        if self.uplift is None:
            return np.full(position.size, np.nan)
        return np.interp(position, self.uplift_position, self.uplift)


def compare_with_measurement(
    run: Run,
    measured: MeasuredRun,
    *,
    pantograph: str | None = None,
    filter: Lowpass | None = None,
    measured_is_filtered: bool = False,
    offset: float = 0.0,
    limits: Limits | None = None,
) -> MeasurementComparison:
    """Compare a run with a measurement over the part of the section that was measured.

    The simulated force is filtered over the whole record; the measured one likewise, unless it
    is filtered already or sampled too coarsely. The uplift of a measurement is that at the
    pantograph, so the uplift at supports is compared at the instants of passing.

    Parameters
    ----------
    run : Run
    measured : MeasuredRun
        Without time its samples are timed by its speed column, or by the speed of the case.
    pantograph : str, optional
        Name; by default the leading one.
    filter : Lowpass, optional
        By default the sharp filter at 20 Hz.
    measured_is_filtered : bool
        True leaves the measured force as it is; bands are then still taken from it.
    offset : float m
        Position in the model of the measurement's zero.
    limits : Limits, optional
        Tolerances; by default those of the package.

    Returns
    -------
    MeasurementComparison

    Raises
    ------
    InputError
        When the measurement and the analysed section do not overlap.
    """
    lowpass = filter or SharpLowpass()
    name = pantograph or run.pantographs[0].name
    simulated = _simulated_track(run, name, lowpass)
    notes: list[str] = []
    against = _running_directions(run, measured)
    if against:
        notes.append(against)
    lower = None if measured_is_filtered else lowpass
    track = _measured_track(run, measured, offset, lower, notes)
    position = _common_positions(run, simulated, track)
    forces = simulated.forces_at(position), track.forces_at(position)
    numbers = [
        _numbers(run, part, force, position)
        for part, force in zip((simulated, track), forces, strict=True)
    ]
    tolerances = {entry.quantity: entry for entry in (limits or load_limits()).tolerances}
    return MeasurementComparison(
        label=measured.label,
        pantograph=name,
        filter=lowpass.describe(),
        start=float(position[0]),
        end=float(position[-1]),
        rows=tuple(
            _row(quantity, value, numbers[1][quantity], tolerances.get(quantity))
            for quantity, value in numbers[0].items()
        ),
        position=position,
        simulated_force=forces[0][:, 0],
        measured_force=forces[1][:, 0],
        notes=tuple(notes),
    )


def _running_directions(run: Run, measured: MeasuredRun) -> str:
    """Say that the two passages run against each other; empty when they do not."""
    rising = measured.position[-1] > measured.position[0]
    own = run.case.scenario.direction
    if rising == (own == "+x"):
        return ""
    return (
        f"the measurement runs towards {'rising' if rising else 'falling'} positions, the run in "
        f"direction {own}: what is compared was passed the other way; for a like passage run the "
        f'case with scenario.direction="{"+x" if rising else "-x"}"'
    )


def _simulated_track(run: Run, name: str, lowpass: Lowpass) -> _Track:
    record = run.pantograph(name)
    force = run.contact_force(name)
    if force.time.size < 2:
        raise InputError(f"pantograph {name!r} never entered the line; nothing to compare")
    columns = np.column_stack([force.position, force.force])
    time, values = evenly_spaced(force.time, columns, run.case.settings.step())
    try:
        forces = _filtered(values[:, 1], float(time[1] - time[0]), lowpass)
    except ValueError as error:
        raise InputError(f"the simulated force cannot be filtered: {error}") from None
    place = record.position[record.active]
    uplift = record.wire_height[record.active] - _static_height(run, place)
    return _sorted_track(values[:, 0], forces, place, uplift)


def _measured_track(
    run: Run, measured: MeasuredRun, offset: float, lowpass: Lowpass | None, notes: list[str]
) -> _Track:
    """Filter the measured force; add to the notes what was done to the measurement."""
    if measured.position[0] == measured.position[-1]:
        raise InputError(f"{measured.label}: the pantograph does not move")
    time = _measured_time(run, measured, notes)
    place = measured.position + offset
    moved = np.concatenate([[True], np.diff(time) > 0.0])
    steps = np.diff(time[moved])
    step = float(np.median(steps))
    if steps.max() > _LARGE_STEP * step:
        notes.append(f"the measurement has a hole of {steps.max():.3g} s, bridged by a line")
    columns = np.column_stack([place, measured.force])[moved]
    if not is_uniform(time[moved], 1e-3):
        notes.append(f"the measurement was resampled every {1e3 * step:.3g} ms")
    grid, values = evenly_spaced(time[moved], columns, step)
    interval = float(grid[1] - grid[0])
    if lowpass is None:
        notes.append("the measured force was taken as filtered already")
    elif lowpass.cutoff >= 0.5 / interval:
        notes.append(
            f"the measurement is sampled every {1e3 * interval:.3g} ms, too coarsely to be "
            f"filtered at {lowpass.cutoff:g} Hz; it was taken as it is"
        )
        lowpass = None
    forces = _filtered(values[:, 1], interval, lowpass)
    return _sorted_track(values[:, 0], forces, place, measured.uplift)


def _measured_time(run: Run, measured: MeasuredRun, notes: list[str]) -> Array:
    """Return the instants of the samples [s], from the time, the speed or the case's speed."""
    if measured.time is not None:
        return measured.time
    steps = np.abs(np.diff(measured.position))
    if measured.speed is not None and np.all(measured.speed > 0.0):
        notes.append("the measurement has no time; its samples were timed by its speed")
        steps = steps / (0.5 * (measured.speed[1:] + measured.speed[:-1]))
    else:
        notes.append("the measurement has no time; its samples were timed by the case's speed")
        steps = steps / run.case.scenario.speed
    return np.concatenate([[0.0], np.cumsum(steps)])


def _filtered(force: Array, interval: float, lowpass: Lowpass | None) -> Array:
    """Return the filtered force and its bands as columns, (n, 1 + n_band) N.

    Without a filter the force stays as it is; its bands are those of the sharp filter. A band
    above the Nyquist frequency is NaN.
    """
    columns = [force if lowpass is None else lowpass.apply(force, interval)]
    for low, high in _BANDS:
        if high < 0.5 / interval:
            columns.append(band_signal(lowpass or SharpLowpass(), force, interval, low, high))
        else:
            columns.append(np.full(force.size, np.nan))
    return np.column_stack(columns)


def _sorted_track(place: Array, forces: Array, uplift_place: Array, uplift: Array | None) -> _Track:
    """Turn a record that runs against the track around, so that positions increase."""
    if place[0] > place[-1]:
        place, forces = place[::-1], forces[::-1]
    if uplift_place[0] > uplift_place[-1]:
        uplift_place = uplift_place[::-1]
        uplift = None if uplift is None else uplift[::-1]
    return _Track(place, forces, uplift_place, uplift)


def _common_positions(run: Run, simulated: _Track, measured: _Track) -> Array:
    """Return evenly spaced positions in the section that both records cover."""
    first, last = run.case.resolved_section()
    supports = run.equilibrium.support_x
    section = float(supports[first - 1]), float(supports[last])
    start = max(section[0], simulated.position[0], measured.position[0])
    end = min(section[1], simulated.position[-1], measured.position[-1])
    spacing = min(
        float(np.median(np.diff(track.position[np.diff(track.position, prepend=-np.inf) > 0.0])))
        for track in (simulated, measured)
    )
    count = math.floor((end - start) / spacing) + 1
    if count < 2:
        raise InputError(
            f"the measurement covers {measured.position[0]:.1f} m to "
            f"{measured.position[-1]:.1f} m, the run {simulated.position[0]:.1f} m to "
            f"{simulated.position[-1]:.1f} m, the analysed section {section[0]:.1f} m to "
            f"{section[1]:.1f} m: nothing in common; give the offset of the measurement's zero"
        )
    return np.linspace(start, end, count)


def _numbers(run: Run, track: _Track, forces: Array, position: Array) -> dict[str, float]:
    """Return the compared numbers of one record; NaN where it does not hold them."""
    supports = run.equilibrium.support_x
    inside = supports[(supports >= position[0]) & (supports <= position[-1])]
    uplift = track.uplift_at(inside)
    height = _static_height(run, position) + track.uplift_at(position)
    return {
        "mean": float(forces[:, 0].mean()),
        "standard_deviation": float(forces[:, 0].std()),
        **{
            f"std_{low:g}_{high:g}": float(column.std())
            for (low, high), column in zip(_BANDS, forces[:, 1:].T, strict=True)
        },
        "maximum": float(forces[:, 0].max()),
        "minimum": float(forces[:, 0].min()),
        "uplift": float(uplift.max()) if uplift.size else math.nan,
        "contact_height_range": float(np.ptp(height)),
    }


def _static_height(run: Run, position: Array) -> Array:
    """Return the height of the contact wire at rest, (n,) m to (n,) m."""
    shape = run.equilibrium
    return shape.running_height(position)


def _row(
    quantity: str, simulated: float, measured: float, tolerance: Tolerance | None
) -> MeasurementRow:
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
        note="" if tolerance is None else tolerance.note,
    )
