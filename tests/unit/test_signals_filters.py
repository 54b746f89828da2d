"""Filters and bands: closed forms and properties."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.signal import butter, sosfiltfilt

from tautwire.signals.bands import BANDS, band_name, band_signal, band_standard_deviations
from tautwire.signals.filters import (
    Butterworth,
    Lowpass,
    SharpLowpass,
    is_uniform,
    resample_uniform,
)

STEP = 1e-3
TIME = STEP * np.arange(4000)
FILTERS = [SharpLowpass(), Butterworth()]
RECORDS = arrays(np.float64, 300, elements=st.floats(-1e3, 1e3, width=32))
KINDS = st.sampled_from(FILTERS)


def sine(frequency: float, amplitude: float = 1.0) -> np.ndarray:
    """Return a sine over the common time axis."""
    return amplitude * np.sin(2.0 * np.pi * frequency * TIME)


@pytest.mark.parametrize("lowpass", FILTERS, ids=lambda f: f.kind)
def test_constant_passes_unchanged(lowpass: Lowpass) -> None:
    """A constant force passes both filters unchanged, ends included."""
    assert lowpass.apply(np.full(500, 169.0), STEP) == pytest.approx(169.0, rel=1e-9)


@pytest.mark.parametrize("lowpass", FILTERS, ids=lambda f: f.kind)
def test_standard_deviation_of_a_sine(lowpass: Lowpass) -> None:
    """A sine of amplitude A well inside a band has the standard deviation A / sqrt(2).

    What the ends of the record leave in other bands a second away stays below 1 % of A.
    """
    inside = (TIME >= 1.0) & (TIME < 3.0)
    deviations = band_standard_deviations(lowpass, 169.0 + sine(10.0, 40.0), STEP, inside)
    assert deviations["0_50"] == pytest.approx(40.0 / np.sqrt(2.0), rel=1e-3)
    assert deviations["5_20"] == pytest.approx(40.0 / np.sqrt(2.0), rel=1e-3)
    assert deviations["0_5"] == pytest.approx(0.0, abs=0.4)


@pytest.mark.parametrize("lowpass", FILTERS, ids=lambda f: f.kind)
def test_bands_separate_two_sines(lowpass: Lowpass) -> None:
    """A slow and a fast sine come out in their own bands with their own deviation."""
    inside = (TIME >= 1.0) & (TIME < 3.0)
    deviations = band_standard_deviations(lowpass, sine(1.0, 50.0) + sine(10.0, 30.0), STEP, inside)
    assert deviations["0_2"] == pytest.approx(50.0 / np.sqrt(2.0), rel=2e-3)
    assert deviations["5_20"] == pytest.approx(30.0 / np.sqrt(2.0), rel=2e-3)
    assert deviations["0_20"] == pytest.approx(np.hypot(50.0, 30.0) / np.sqrt(2.0), rel=2e-3)


def test_sharp_filter_removes_what_lies_above_and_keeps_what_lies_below() -> None:
    """The sharp filter keeps the dropper line at 15.5 Hz and removes one at 22 Hz.

    A second away from the ends of the record, whose kinks spread, to 3 %.
    """
    middle = slice(1000, 3000)
    kept = SharpLowpass(20.0).apply(sine(15.5), STEP)
    gone = SharpLowpass(20.0).apply(sine(22.0), STEP)
    assert kept[middle] == pytest.approx(sine(15.5)[middle], abs=0.03)
    assert gone[middle] == pytest.approx(0.0, abs=0.03)


def test_sharp_filter_keeps_the_line_at_the_cutoff() -> None:
    """A cosine of the mirrored record exactly at the cut-off is kept, the next one is removed."""
    count = 1000
    instants = STEP * (np.arange(count) + 0.5)
    resolution = 1.0 / (2.0 * count * STEP)
    at, above = (np.cos(2.0 * np.pi * f * instants) for f in (20.0, 20.0 + resolution))
    assert SharpLowpass(20.0).apply(at, STEP) == pytest.approx(at, abs=1e-12)
    assert SharpLowpass(20.0).apply(above, STEP) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("frequency", [5.0, 15.46, 20.0, 25.0])
def test_butterworth_gain_is_that_of_two_passes(frequency: float) -> None:
    """The gain is 1 / (1 + (f/fc)^12): order 6, run twice, cut-off not corrected.

    At 15.46 Hz, the dropper passing of AC simple at 320 km/h, it is 0.957.
    """
    filtered = Butterworth(order=6, cutoff=20.0).apply(sine(frequency), STEP)
    middle = slice(1000, 3000)
    wave = np.exp(-2j * np.pi * frequency * TIME[middle]) * np.hanning(2000)
    gain = abs(np.sum(filtered[middle] * wave)) / abs(np.sum(sine(frequency)[middle] * wave))
    warped = np.tan(np.pi * frequency * STEP) / np.tan(np.pi * 20.0 * STEP)
    assert gain == pytest.approx(1.0 / (1.0 + warped**12), rel=2e-3)
    if frequency == 15.46:
        assert gain == pytest.approx(0.957, abs=0.001)


@pytest.mark.parametrize("order", [1, 2, 5, 6, 12])
@pytest.mark.parametrize(("cutoff", "count"), [(2.0, 300), (20.0, 4000), (450.0, 4000)])
def test_butterworth_equals_scipy(order: int, cutoff: float, count: int) -> None:
    """The sections and their two passes are those of ``scipy.signal``, to 1e-10."""
    record = 5.0 + np.random.default_rng(0).normal(size=(count, 2))
    extension = min(count - 1, int(np.ceil(order / (cutoff * STEP))))
    sections = butter(order, cutoff, fs=1.0 / STEP, output="sos")
    theirs = sosfiltfilt(sections, record, axis=0, padtype="even", padlen=extension)
    assert Butterworth(order, cutoff).apply(record, STEP) == pytest.approx(theirs, abs=1e-10)


def test_filters_do_not_shift_in_time() -> None:
    """The maximum of a slow bump stays at its instant with both filters."""
    bump = np.exp(-(((TIME - 2.0) / 0.1) ** 2))
    for lowpass in FILTERS:
        assert TIME[np.argmax(lowpass.apply(bump, STEP))] == pytest.approx(2.0, abs=STEP)


@settings(max_examples=20, deadline=None)
@given(first=RECORDS, second=RECORDS, factor=st.floats(-10.0, 10.0), lowpass=KINDS)
def test_filters_are_linear(
    first: np.ndarray, second: np.ndarray, factor: float, lowpass: Lowpass
) -> None:
    """filter(a x + y) = a filter(x) + filter(y)."""
    together = lowpass.apply(factor * first + second, STEP)
    apart = factor * lowpass.apply(first, STEP) + lowpass.apply(second, STEP)
    assert together == pytest.approx(apart, abs=1e-6)


@settings(max_examples=20, deadline=None)
@given(record=RECORDS, shift=st.floats(-1e3, 1e3), lowpass=KINDS)
def test_filters_commute_with_a_shift_of_level(
    record: np.ndarray, shift: float, lowpass: Lowpass
) -> None:
    """A constant added before the filter comes out added after it."""
    moved = lowpass.apply(record + shift, STEP)
    assert moved == pytest.approx(lowpass.apply(record, STEP) + shift, abs=1e-6)


@settings(max_examples=20, deadline=None)
@given(record=RECORDS)
def test_sharp_filter_does_not_know_the_direction_of_time(record: np.ndarray) -> None:
    """Filtering the reversed record gives the reversed result (a run in -x equals one in +x)."""
    lowpass = SharpLowpass(50.0)
    assert lowpass.apply(record[::-1], STEP)[::-1] == pytest.approx(
        lowpass.apply(record, STEP), abs=1e-9
    )


@settings(max_examples=20, deadline=None)
@given(record=RECORDS)
def test_sharp_bands_are_orthogonal(record: np.ndarray) -> None:
    """Bands of the sharp filter add up to the signal, and their energies to its energy."""
    edges = [0.0, 5.0, 20.0, 200.0, 499.0]
    lowpass = SharpLowpass()
    parts = [band_signal(lowpass, record, STEP, a, b) for a, b in pairwise(edges)]
    rest = record - sum(parts)
    energies = [float(np.sum(part**2)) for part in (*parts, rest)]
    assert sum(energies) == pytest.approx(float(np.sum(record**2)), rel=1e-9, abs=1e-6)
    assert lowpass.apply(lowpass.apply(record, STEP), STEP) == pytest.approx(
        lowpass.apply(record, STEP), abs=1e-8
    )


@pytest.mark.parametrize("lowpass", FILTERS, ids=lambda f: f.kind)
def test_cutoff_at_the_nyquist_frequency_is_refused(lowpass: Lowpass) -> None:
    """A cut-off that is not below the Nyquist frequency is refused with both numbers."""
    with pytest.raises(ValueError, match=r"20 Hz is not below the Nyquist frequency 20 Hz"):
        lowpass.apply(np.ones(100), 0.025)


def test_bands_above_the_nyquist_frequency_have_no_value() -> None:
    """At 4 ms the band to 200 Hz is NaN and the others are numbers."""
    record = np.sin(np.arange(1000.0))
    deviations = band_standard_deviations(SharpLowpass(), record, 4e-3, np.ones(1000, dtype=bool))
    assert set(deviations) == {band_name(band) for band in BANDS}
    assert np.isnan(deviations["0_200"])
    assert all(np.isfinite(deviations[k]) for k in deviations if k != "0_200")


def test_columns_are_filtered_one_by_one() -> None:
    """A record of two columns gives the columns' own results."""
    columns = np.column_stack([sine(3.0), sine(40.0)])
    for lowpass in FILTERS:
        filtered = lowpass.apply(columns, STEP)
        assert filtered[:, 1] == pytest.approx(lowpass.apply(columns[:, 1], STEP), abs=1e-12)


def test_descriptions_name_every_number() -> None:
    """A filter is named with order, passes and cut-off."""
    assert "order 4 forward and backward" in Butterworth(4, 18.0).describe()
    assert "18 Hz" in Butterworth(4, 18.0).describe()
    assert "25 Hz" in SharpLowpass(25.0).describe()
    assert isinstance(SharpLowpass(), Lowpass)
    assert Butterworth(4).with_cutoff(5.0) == Butterworth(4, 5.0)


@pytest.mark.parametrize(
    ("build", "text"),
    [
        (lambda: SharpLowpass(0.0), "positive frequency"),
        (lambda: Butterworth(cutoff=float("nan")), "positive frequency"),
        (lambda: Butterworth(order=0), "from 1 to 12"),
        (lambda: SharpLowpass().apply([1.0], 1e-3), "at least two samples"),
        (lambda: SharpLowpass().apply([1.0, 2.0], 0.0), "sampling interval"),
        (lambda: resample_uniform([0.0, 0.0], [1.0, 2.0]), "increasing instants"),
    ],
)
def test_bad_arguments_are_refused(build, text: str) -> None:
    """Impossible filters and records are refused with the reason."""
    with pytest.raises(ValueError, match=text):
        build()


def test_uneven_steps_are_found_and_resampled() -> None:
    """A record with uneven steps is resampled by linear interpolation, straight lines exactly."""
    time = np.array([0.0, 0.001, 0.0015, 0.003, 0.004])
    grid, values = resample_uniform(time, np.column_stack([2.0 * time, 1.0 - time]))
    assert not is_uniform(time)
    assert is_uniform(grid)
    assert grid[[0, -1]] == pytest.approx(time[[0, -1]])
    assert values == pytest.approx(np.column_stack([2.0 * grid, 1.0 - grid]))
    assert resample_uniform(time, time, 0.001)[0] == pytest.approx(0.001 * np.arange(5))
