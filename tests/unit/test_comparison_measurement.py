"""Comparison of a run with a recording."""

from __future__ import annotations

import json
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tautwire.assessment.comparison.coverage import covered
from tautwire.assessment.comparison.measurement import (
    MeasurementComparison,
    MeasurementRow,
    compare_with_measurement,
)
from tautwire.assessment.comparison.stretches import length_figures
from tautwire.errors import InputError
from tautwire.inputs.load import load_case
from tautwire.measured.evaluation import Treatment
from tautwire.measured.recording import Recording
from tautwire.report.pages.comparison_page import compose_comparison
from tautwire.results.run import Run
from tautwire.signals.filters import Butterworth
from tautwire.specs.project import Project

from .synthetic import make_run

Array = NDArray[np.float64]


@pytest.fixture(scope="module")
def run() -> Run:
    """A passage with waves of 55 m and 5.75 m in the force and no noise."""
    base = make_run()
    record = base.pantographs[0]
    x = record.position
    force = 169.0 + 50.0 * np.sin(2 * np.pi * x / 55.0) + 30.0 * np.sin(2 * np.pi * x / 5.75)
    return replace(base, pantographs=(replace(record, contact_force=force),))


def recording_of(time: Array, place: Array, force: Array, **changes: Any) -> Recording:
    """Return a recording with one force and the way run."""
    empty = np.empty((0, len(time)))
    plain = Recording(
        "run.csv", time, force[None], np.array([1]), empty, np.empty(0, dtype=np.int64),
        speed=None, distance=np.abs(place - place[0]), chainage=place,
    )  # fmt: skip
    return plain.with_(**changes)


def measured_like(run: Run, gain: float = 1.0, every: int = 1, **changes: Any) -> Recording:
    """Return a measurement equal to the run, its force about 169 N times `gain`."""
    record = run.pantographs[0]
    uplift = record.wire_height - run.equilibrium.running_height(record.position)
    whole = recording_of(
        run.time, record.position, 169.0 + gain * (record.contact_force - 169.0), uplift=uplift
    )
    return _rows(whole, slice(None, None, every)).with_(**changes)


def _rows(recording: Recording, rows: Any) -> Recording:
    """Return some rows of a recording."""
    names = ("time", "distance", "chainage", "uplift", "height")
    arrays = {name: getattr(recording, name) for name in names}
    return recording.with_(
        forces=recording.forces[:, rows],
        accelerations=np.empty((0, recording.forces[:, rows].shape[1])),
        **{name: value[rows] for name, value in arrays.items() if value is not None},
    )


def row_of(comparison: MeasurementComparison, quantity: str) -> MeasurementRow:
    """Return the row of one quantity."""
    return next(row for row in comparison.rows if row.quantity == quantity)


def test_a_run_equals_itself(run: Run) -> None:
    """A measurement equal to the run differs by what the change to even distance costs, less than
    0.2 % of sigma; no tolerance is verified, none passes."""
    comparison = compare_with_measurement(run, measured_like(run), search=0.0)
    for row in comparison.rows:
        limit = 1e-4 if row.unit == "m" else 0.1
        assert row.difference == pytest.approx(0.0, abs=limit), row
    judged = [row for row in comparison.rows if row.standard is not None]
    assert [row.quantity for row in judged] == [
        "standard_deviation",
        "uplift",
        "contact_height_range",
    ]
    assert all(row.within is True and row.passed is None for row in judged)
    assert all(row.within is None for row in comparison.rows if row.standard is None)
    assert (comparison.start, comparison.end) == pytest.approx((165.0, 715.0), abs=0.3)
    assert comparison.measured_force == pytest.approx(comparison.simulated_force, abs=0.5)
    assert comparison.placement.verdict == "as recorded"
    json.dumps(comparison.as_dict(), allow_nan=False)


@pytest.mark.parametrize(("gain", "within"), [(1.24, True), (1.26, False), (0.84, True)])
def test_tolerance_of_the_standard_deviation(run: Run, gain: float, within: bool) -> None:
    """sigma may differ by 20 % of the measured one: 1/1.24 - 1 = -19.4 %, 1/1.26 - 1 = -20.6 %."""
    row = row_of(compare_with_measurement(run, measured_like(run, gain)), "standard_deviation")
    assert row.relative_difference == pytest.approx(1.0 / gain - 1.0, abs=2e-3)
    assert row.within is within
    assert (row.low, row.high) == (-0.2, 0.2)


@pytest.mark.parametrize(("shift", "within"), [(-0.019, True), (0.009, True), (0.011, False)])
def test_tolerance_of_the_uplift(run: Run, shift: float, within: bool) -> None:
    """The simulated uplift at supports may lie 10 mm under to 20 mm over the measured one."""
    measured = measured_like(run)
    assert measured.uplift is not None
    comparison = compare_with_measurement(
        run, measured.with_(uplift=measured.uplift + shift), search=0.0
    )
    row = row_of(comparison, "uplift")
    assert row.difference == pytest.approx(-shift, abs=1e-5)
    assert row.within is within
    assert row_of(comparison, "contact_height_range").difference == pytest.approx(0.0, abs=1e-4)


def test_recorded_height_is_compared(run: Run) -> None:
    """The height of the wire at the pantograph, as measuring trains record it, gives the vertical
    range of the contact point without any uplift."""
    measured = measured_like(run, uplift=None, height=run.pantographs[0].wire_height + 0.1)
    row = row_of(compare_with_measurement(run, measured, search=0.0), "contact_height_range")
    assert row.difference == pytest.approx(0.0, abs=1e-4)
    assert row.within is True


def test_bands_are_compared(run: Run) -> None:
    """sigma(0-5) is that of the span wave, sigma(5-20) that of the dropper wave: A / sqrt(2)."""
    comparison = compare_with_measurement(run, measured_like(run))
    assert row_of(comparison, "std_0_5").simulated == pytest.approx(50 / np.sqrt(2), rel=0.01)
    assert row_of(comparison, "std_5_20").measured == pytest.approx(30 / np.sqrt(2), rel=0.01)


def test_percentiles_and_spans(run: Run) -> None:
    """Percentiles and the figures of every span agree where the forces do; the spectra peak at the
    waves that the force is made of."""
    found = compare_with_measurement(run, measured_like(run, gain=1.1), search=0.0)
    low, high = (np.array([side[n] for side in found.percentiles.values()]) for n in (0, 1))
    assert high - 169.0 == pytest.approx(1.1 * (low - 169.0), abs=0.5)
    assert [span.span for span in found.spans] == list(range(4, 14))
    for span in found.spans:
        deviation = "standard_deviation"
        assert span.measured[deviation] == pytest.approx(1.1 * span.simulated[deviation], rel=0.01)
    for spectrum in (found.simulated_spectrum, found.measured_spectrum):
        assert spectrum is not None
        top = spectrum.abscissa[np.argsort(spectrum.value)[-8:]]
        assert np.abs(top - 1 / 55).min() < 2 * spectrum.resolution
        assert np.abs(top - 1 / 5.75).min() < 2 * spectrum.resolution


def test_figures_by_tension_length() -> None:
    """Of two tension lengths that overlap both have what lies in the overlap; what was not measured
    counts on neither side, and a line of one has no such table."""
    case = load_case("ac-simple-curve")
    masts = np.array(case.line.support_positions())
    line: Any = SimpleNamespace(case=case, equilibrium=SimpleNamespace(mast_x=masts))
    ends = [one.masts for one in case.tension_lengths]
    assert len(ends) == 2
    place = np.arange(0.0, masts[-1], 0.5)
    force = 100.0 + 30.0 * (place >= masts[ends[1][0] - 1])
    measured = np.where(place < masts[1], np.nan, force - 5.0)
    one, two = length_figures(line, place, force, measured)
    assert (one.supports, two.supports) == tuple(ends)
    assert (one.simulated["minimum"], one.simulated["maximum"]) == (100.0, 130.0)
    assert (two.simulated["mean"], two.measured["mean"]) == (130.0, 125.0)
    assert one.measured_share < 1.0
    assert two.measured_share == pytest.approx(1.0)
    alone: Any = SimpleNamespace(case=load_case("ac-simple"), equilibrium=line.equilibrium)
    assert length_figures(alone, place, force, measured) == ()


def test_own_sampling_and_direction(run: Run) -> None:
    """A measurement every 4 ms towards falling positions, without uplift, agrees within 1 %."""
    backwards = _rows(measured_like(run, every=4, uplift=None), slice(None, None, -1))
    assert backwards.chainage is not None
    measured = backwards.with_(
        time=-backwards.time, distance=backwards.chainage[0] - backwards.chainage
    )
    comparison = compare_with_measurement(run, measured)
    assert row_of(comparison, "standard_deviation").relative_difference == pytest.approx(
        0, abs=0.01
    )
    assert np.isnan(row_of(comparison, "uplift").measured)
    assert row_of(comparison, "uplift").within is None
    assert np.all(np.diff(comparison.position) > 0.0)
    assert any("runs towards falling positions" in note for note in comparison.notes)
    assert any('scenario.direction="-x"' in note for note in comparison.notes)


def test_coarse_measurement_is_not_judged(run: Run) -> None:
    """Samples every 30 ms hold at most 8 Hz: what needs more has no tolerance, and says why."""
    comparison = compare_with_measurement(run, measured_like(run, every=30))
    assert any("too coarsely" in note for note in comparison.notes)
    assert np.isnan(row_of(comparison, "std_5_20").measured)
    row = row_of(comparison, "standard_deviation")
    assert row.within is None
    assert row.note == "not judged: needs 20 Hz, the samples hold 8.33 Hz"
    assert row_of(comparison, "std_0_5").relative_difference == pytest.approx(0.0, abs=0.02)
    json.dumps(comparison.as_dict(), allow_nan=False)


def test_filtered_measurement_is_not_filtered_again(run: Run) -> None:
    """A force that is filtered already stays as it is when the call says so."""
    lowpass = Butterworth(order=2, cutoff=20.0)
    filtered = lowpass.apply(run.pantographs[0].contact_force, 1e-3)
    measured = measured_like(run, forces=filtered[None])
    twice = compare_with_measurement(run, measured, treatment=Treatment(lowpass), search=0.0)
    once = compare_with_measurement(run, measured, treatment=Treatment(None), search=0.0)
    sharp = row_of(twice, "standard_deviation").measured
    assert row_of(once, "standard_deviation").measured > sharp + 1.0
    assert "order 2" in twice.filter
    assert "the measured force as recorded" in once.filter


def test_gaps_count_on_neither_side(run: Run) -> None:
    """What was not measured is left out of the simulated numbers too."""
    measured = measured_like(run)
    assert measured.chainage is not None
    forces = measured.forces.copy()
    gap = (measured.chainage > 300.0) & (measured.chainage < 410.0)
    forces[0, gap] = np.nan
    found = compare_with_measurement(run, measured.with_(forces=forces), search=0.0)
    assert row_of(found, "standard_deviation").difference == pytest.approx(0.0, abs=0.1)
    assert np.isnan(found.measured_force).mean() == pytest.approx(0.2, abs=0.03)
    by_number = {span.span: span.measured_share for span in found.spans}
    assert by_number[9] == 1.0
    assert 7 not in by_number
    assert any(fault["kind"] == "drop-out" for fault in found.evaluation.faults)


def test_offset_and_overlap(run: Run) -> None:
    """A measurement in other chainage needs its offset; without overlap it is refused."""
    measured = measured_like(run)
    assert measured.chainage is not None
    shifted = measured.with_(chainage=measured.chainage + 12_000.0)
    comparison = compare_with_measurement(run, shifted, offset=-12_000.0, search=0.0)
    assert row_of(comparison, "standard_deviation").difference == pytest.approx(0.0, abs=0.1)
    with pytest.raises(InputError, match=r"nothing in common; give the offset"):
        compare_with_measurement(run, shifted)


@pytest.mark.parametrize("falls", [False, True])
def test_chainage_of_the_line(run: Run, falls: bool) -> None:
    """Where the case has chainage, rising or falling, the recorded one needs no offset."""
    supports = run.equilibrium.support_x
    known = 48_000.0 - supports if falls else 47_000.0 + supports
    line = run.case.line.with_(chainage=tuple(known.tolist()))
    here = replace(run, case=run.case.with_(line=line))
    measured = measured_like(run)
    assert measured.chainage is not None
    chainage = 48_000.0 - measured.chainage if falls else 47_000.0 + measured.chainage
    found = compare_with_measurement(here, measured.with_(chainage=chainage), search=0.0)
    assert row_of(found, "standard_deviation").difference == pytest.approx(0.0, abs=0.1)
    assert not any("runs towards" in note for note in found.notes)


def test_odometer_errors_are_aligned(run: Run) -> None:
    """An odometer 7 m off that drifts by 0.3 % is laid over the line within a metre; marks of known
    chainage do the same."""
    place = run.pantographs[0].position
    irregular = 25.0 * np.sin(2 * np.pi * place / 61.0 + 2.0 * np.sin(place / 140.0))
    record = replace(
        run.pantographs[0],
        contact_force=run.pantographs[0].contact_force
        + irregular
        + 12.0 * np.sin(2 * np.pi * place / 23.0 + 3.0 * np.sin(place / 90.0)),
    )
    unequal = replace(run, pantographs=(record,))
    wrong = 7.0 + 1.003 * place
    measured = measured_like(unequal, chainage=wrong, distance=np.abs(wrong - wrong[0]))
    found = compare_with_measurement(unequal, measured)
    assert found.placement.verdict == "aligned", found.placement.text
    true = np.interp(found.placement.rows, place, place)
    inside = (place > 165.0) & (place < 715.0)
    assert np.abs(true - place)[inside].max() < 1.0
    marks = run.equilibrium.support_x
    instants = np.interp(marks, place, run.time)
    marked = measured.with_(mark_times=instants, mark_chainages=marks)
    by_marks = compare_with_measurement(unequal, marked, search=0.0)
    assert np.abs(by_marks.placement.rows - place)[inside].max() < 0.1


def test_another_line_is_said_and_not_aligned(run: Run) -> None:
    """A force that does not match stays where it was recorded, and the notes say so."""
    rng = np.random.default_rng(5)
    other = np.convolve(rng.normal(0.0, 1.0, len(run.time)), np.ones(60), "same")
    found = compare_with_measurement(run, measured_like(run, forces=(169.0 + 3 * other)[None]))
    assert found.placement.verdict == "does not match"
    assert any("positions are taken as recorded" in note for note in found.notes)


def test_the_wrong_running_direction_is_said(run: Run) -> None:
    """A recording whose positions rise while the train ran the other way matches the line only when
    it is turned around: it is not aligned, and the notes say so."""
    place = run.pantographs[0].position
    irregular = 60.0 * np.sin(2 * np.pi * place / 61.0 + 4.0 * np.sin(place / 140.0))
    record = replace(run.pantographs[0], contact_force=169.0 + irregular)
    uneven = replace(run, pantographs=(record,))
    measured = measured_like(uneven)
    turned = compare_with_measurement(uneven, measured.with_(forces=measured.forces[:, ::-1]))
    assert turned.placement.verdict in ("wrong direction", "does not match")
    assert any("positions are taken as recorded" in note for note in turned.notes)
    assert compare_with_measurement(uneven, measured).placement.verdict == "aligned"


def test_partial_overlap_is_compared(run: Run) -> None:
    """A measurement from 300 m to 500 m is compared there, and the record says which spans."""
    measured = measured_like(run)
    assert measured.chainage is not None
    short = _rows(measured, (measured.chainage >= 300.0) & (measured.chainage <= 500.0))
    found = compare_with_measurement(run, short)
    assert (found.start, found.end) == pytest.approx((300.0, 500.0), abs=2.0)
    assert found.coverage.spans == (6, 10)
    assert found.coverage.measured_speed == pytest.approx(run.case.scenario.speed, rel=1e-3)


def test_coverage_of_several(run: Run) -> None:
    """Several comparisons cover the range of their speeds, lines and pantographs together."""
    first = compare_with_measurement(run, measured_like(run)).coverage
    second = replace(first, case="other", simulated_speed=250 / 3.6, span_lengths=(48.0, 60.0))
    assert covered([first, second]) == {
        "lines": ["other", "synthetic"],
        "line_types": ["simple"],
        "pantographs": ["front"],
        "pantograph_masses_kg": [(6.0, 9.0, 5.8)],
        "numbers_of_pantographs": [1],
        "speed_kmh": [250.0, 320.0],
        "measured_speed_kmh": [pytest.approx(320.0)] * 2,
        "directions": ["+x"],
        "tensions_n": {"contact": [22000.0, 22000.0], "messenger": [16000.0, 16000.0]},
        "span_lengths_m": [48.0, 60.0],
        "length_m": pytest.approx(2 * first.length),
    }
    assert first.wires == {"contact": 22e3, "messenger": 16e3}


def test_page(run: Run, tmp_path: Any) -> None:
    """The page shows numbers, tolerances with their source, coverage, forces and spans."""
    found = compare_with_measurement(run, measured_like(run, 1.3))
    page = compose_comparison([run, run], [found, found], Project(client="Valley Railway"))
    text = page.write(tmp_path / "c.html").read_text()
    assert "<dd>Valley Railway</dd>" in text
    for words in ("missed, tolerance not checked against the standard", "EN 50318 2002",
                  "not verified", "Span by span", "outside of it, it proves nothing",
                  "320 km/h"):  # fmt: skip
        assert words in text.replace("\u00a0", " "), words


def test_pantograph_that_never_entered_is_refused() -> None:
    """A run whose pantograph never entered has nothing to compare."""
    absent = make_run(entering=False)
    place = np.linspace(0, 900, 1000)
    measured = recording_of(place / 90.0, place, np.full(1000, 169.0))
    with pytest.raises(InputError, match="never entered"):
        compare_with_measurement(absent, measured)


def test_missed_tolerances_are_named(run: Run) -> None:
    """A standard deviation 30 % too high misses its tolerance of 20 %, verified or not."""
    comparison = compare_with_measurement(run, measured_like(run, gain=1 / 1.3))
    assert "standard_deviation" in comparison.missed
    assert comparison.as_dict()["missed"] == list(comparison.missed)
    assert compare_with_measurement(run, measured_like(run)).missed == ()
