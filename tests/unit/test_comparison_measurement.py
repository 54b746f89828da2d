"""Comparison of a run with a measurement."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tautwire.assessment.measurement import (
    MeasurementComparison,
    MeasurementRow,
    compare_with_measurement,
)
from tautwire.errors import InputError
from tautwire.inputs.measured import MeasuredRun
from tautwire.results.run import Run
from tautwire.signals.filters import Butterworth

from .synthetic import make_run


@pytest.fixture(scope="module")
def run() -> Run:
    """A passage with waves of 55 m and 5.75 m in the force and no noise."""
    base = make_run()
    record = base.pantographs[0]
    x = record.position
    force = 169.0 + 50.0 * np.sin(2 * np.pi * x / 55.0) + 30.0 * np.sin(2 * np.pi * x / 5.75)
    return replace(base, pantographs=(replace(record, contact_force=force),))


def measured_like(run: Run, gain: float = 1.0, **changes: Any) -> MeasuredRun:
    """Return a measurement equal to the run, its force about 169 N times `gain`."""
    record = run.pantographs[0]
    static = np.interp(
        record.position, run.equilibrium.contact.s, run.equilibrium.contact_position[:, 2]
    )
    whole = MeasuredRun(
        label="run.csv",
        position=record.position,
        force=169.0 + gain * (record.contact_force - 169.0),
        time=run.time,
        uplift=record.wire_height - static,
    )
    return replace(whole, **changes)


def row_of(comparison: MeasurementComparison, quantity: str) -> MeasurementRow:
    """Return the row of one quantity."""
    return next(row for row in comparison.rows if row.quantity == quantity)


def test_a_run_equals_itself(run: Run) -> None:
    """A measurement equal to the run has no difference; no tolerance is verified, none passes."""
    comparison = compare_with_measurement(run, measured_like(run))
    assert [row.difference for row in comparison.rows] == pytest.approx(np.zeros(8), abs=1e-9)
    judged = [row for row in comparison.rows if row.standard is not None]
    assert [row.quantity for row in judged] == [
        "standard_deviation",
        "uplift",
        "contact_height_range",
    ]
    assert all(row.within is True and row.passed is None for row in judged)
    assert all(row.within is None for row in comparison.rows if row.standard is None)
    assert (comparison.start, comparison.end) == pytest.approx((165.0, 715.0), abs=0.1)
    assert comparison.measured_force == pytest.approx(comparison.simulated_force)
    json.dumps(comparison.as_dict(), allow_nan=False)


@pytest.mark.parametrize(("gain", "within"), [(1.24, True), (1.26, False), (0.84, True)])
def test_tolerance_of_the_standard_deviation(run: Run, gain: float, within: bool) -> None:
    """sigma may differ by 20 % of the measured one: 1/1.24 - 1 = -19.4 %, 1/1.26 - 1 = -20.6 %."""
    row = row_of(compare_with_measurement(run, measured_like(run, gain)), "standard_deviation")
    assert row.relative_difference == pytest.approx(1.0 / gain - 1.0, abs=1e-3)
    assert row.within is within
    assert (row.low, row.high) == (-0.2, 0.2)


@pytest.mark.parametrize(("shift", "within"), [(-0.019, True), (0.009, True), (0.011, False)])
def test_tolerance_of_the_uplift(run: Run, shift: float, within: bool) -> None:
    """The simulated uplift at supports may lie 10 mm under to 20 mm over the measured one."""
    measured = measured_like(run)
    assert measured.uplift is not None
    comparison = compare_with_measurement(run, replace(measured, uplift=measured.uplift + shift))
    row = row_of(comparison, "uplift")
    assert row.difference == pytest.approx(-shift)
    assert row.within is within
    assert row_of(comparison, "contact_height_range").difference == pytest.approx(0.0, abs=1e-9)


def test_bands_are_compared(run: Run) -> None:
    """sigma(0-5) is that of the span wave, sigma(5-20) that of the dropper wave: A / sqrt(2)."""
    comparison = compare_with_measurement(run, measured_like(run))
    assert row_of(comparison, "std_0_5").simulated == pytest.approx(50 / np.sqrt(2), rel=0.01)
    assert row_of(comparison, "std_5_20").measured == pytest.approx(30 / np.sqrt(2), rel=0.01)


def test_own_sampling_and_direction(run: Run) -> None:
    """A measurement every 4 ms, recorded backwards without time or uplift, agrees within 1 %."""
    record = run.pantographs[0]
    x = record.position[::4][::-1]
    measured = MeasuredRun("odo.csv", position=x, force=record.contact_force[::4][::-1])
    comparison = compare_with_measurement(run, measured)
    assert row_of(comparison, "standard_deviation").relative_difference == pytest.approx(
        0, abs=0.01
    )
    assert np.isnan(row_of(comparison, "uplift").measured)
    assert row_of(comparison, "uplift").within is None
    assert any("timed by the case's speed" in note for note in comparison.notes)
    assert np.all(np.diff(comparison.position) > 0.0)


def test_measurement_timed_by_its_speed(run: Run) -> None:
    """Without time the speed column times the samples."""
    speed = np.full(run.time.size, 320.0 / 3.6)
    comparison = compare_with_measurement(run, measured_like(run, time=None, speed=speed))
    assert any("timed by its speed" in note for note in comparison.notes)
    assert row_of(comparison, "standard_deviation").difference == pytest.approx(0.0, abs=1e-3)


def test_coarse_measurement_is_not_filtered(run: Run) -> None:
    """A sample every 30 ms cannot be filtered at 20 Hz: a note says that it is not."""
    measured = measured_like(run)
    assert measured.time is not None
    coarse = MeasuredRun(
        "coarse.csv", measured.position[::30], measured.force[::30], measured.time[::30]
    )
    comparison = compare_with_measurement(run, coarse)
    assert any("too coarsely" in note for note in comparison.notes)
    assert np.isnan(row_of(comparison, "std_5_20").measured)
    json.dumps(comparison.as_dict(), allow_nan=False)


def test_filtered_measurement_is_not_filtered_again(run: Run) -> None:
    """A force that is filtered already stays as it is when the call says so."""
    lowpass = Butterworth(order=2, cutoff=20.0)
    filtered = lowpass.apply(run.pantographs[0].contact_force, 1e-3)
    measured = measured_like(run, force=filtered)
    once = compare_with_measurement(run, measured, filter=lowpass, measured_is_filtered=True)
    twice = compare_with_measurement(run, measured, filter=lowpass)
    assert row_of(once, "standard_deviation").difference == pytest.approx(0.0, abs=1e-6)
    assert row_of(twice, "standard_deviation").difference > 1.0
    assert "order 2" in once.filter


def test_uneven_samples_and_holes_are_named(run: Run) -> None:
    """A measurement with a hole is resampled, and the notes say so."""
    measured = measured_like(run)
    assert measured.time is not None
    assert measured.uplift is not None
    keep = np.abs(run.time - 8.5) > 0.02
    holed = replace(
        measured,
        position=measured.position[keep],
        force=measured.force[keep],
        time=measured.time[keep],
        uplift=measured.uplift[keep],
    )
    comparison = compare_with_measurement(run, holed)
    assert any("hole of 0.04" in note for note in comparison.notes)
    assert any("resampled every 1 ms" in note for note in comparison.notes)
    assert row_of(comparison, "standard_deviation").difference == pytest.approx(0.0, abs=0.5)


def test_offset_and_overlap(run: Run) -> None:
    """A measurement in other chainage needs its offset; without overlap it is refused."""
    measured = measured_like(run)
    shifted = replace(measured, position=measured.position + 12_000.0)
    comparison = compare_with_measurement(run, shifted, offset=-12_000.0)
    assert row_of(comparison, "standard_deviation").difference == pytest.approx(0.0, abs=1e-6)
    with pytest.raises(InputError, match=r"nothing in common; give the offset"):
        compare_with_measurement(run, shifted)
    standing = MeasuredRun("still.csv", np.full(5, 300.0), np.ones(5))
    with pytest.raises(InputError, match="does not move"):
        compare_with_measurement(run, standing)


def test_partial_overlap_is_compared(run: Run) -> None:
    """A measurement from 300 m to 500 m is compared there."""
    measured = measured_like(run)
    part = (measured.position >= 300.0) & (measured.position <= 500.0)
    assert measured.time is not None
    short = MeasuredRun(
        "part.csv", measured.position[part], measured.force[part], measured.time[part]
    )
    comparison = compare_with_measurement(run, short)
    assert (comparison.start, comparison.end) == pytest.approx((300.0, 500.0), abs=0.2)


def test_pantograph_that_never_entered_is_refused() -> None:
    """A run whose pantograph never entered has nothing to compare."""
    absent = make_run(entering=False)
    measured = MeasuredRun("run.csv", np.linspace(0, 900, 100), np.full(100, 169.0))
    with pytest.raises(InputError, match="never entered"):
        compare_with_measurement(absent, measured)


@pytest.mark.parametrize(("direction", "told"), [("+x", True), ("-x", False)])
def test_running_directions_are_compared(run: Run, direction: str, told: bool) -> None:
    """A measurement towards falling positions is told apart from a run towards rising ones."""
    case = run.case.with_(scenario=run.case.scenario.with_(direction=direction))
    whole = measured_like(run, uplift=None, time=None)
    falling = replace(whole, position=whole.position[::-1], force=whole.force[::-1])
    notes = compare_with_measurement(replace(run, case=case), falling).notes
    assert any("runs towards falling positions" in note for note in notes) is told
    assert any('scenario.direction="-x"' in note for note in notes) is told


def test_missed_tolerances_are_named(run: Run) -> None:
    """A standard deviation 30 % too high misses its tolerance of 20 %, verified or not."""
    comparison = compare_with_measurement(run, measured_like(run, gain=1 / 1.3))
    assert "standard_deviation" in comparison.missed
    assert comparison.as_dict()["missed"] == list(comparison.missed)
    assert compare_with_measurement(run, measured_like(run)).missed == ()
