"""Spectra: amplitudes, Parseval, wave numbers, passing lines."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from tautwire.signals.spectra import (
    Window,
    amplitude_spectrum,
    background_limit,
    over_wavenumber,
    passing_lines,
    power_spectral_density,
)

STEP = 1e-3


@pytest.mark.parametrize("window", ["hann", "none"])
def test_amplitude_of_a_sine(window: Window) -> None:
    """A sine of amplitude A and a whole number of periods gives a line of height A."""
    time = STEP * np.arange(2000)
    spectrum = amplitude_spectrum(169.0 + 30.0 * np.sin(2 * np.pi * 12.5 * time), STEP, window)
    peak = int(np.argmax(spectrum.value))
    assert spectrum.abscissa[peak] == pytest.approx(12.5)
    assert spectrum.value[peak] == pytest.approx(30.0, rel=1e-9)
    assert spectrum.value[0] == pytest.approx(0.0, abs=1e-9)


@settings(max_examples=30, deadline=None)
@given(
    record=arrays(np.float64, st.integers(4, 101), elements=st.floats(-1e3, 1e3, width=32)),
)
def test_parseval(record: np.ndarray) -> None:
    """Without a window the area under the power density is the variance."""
    density = power_spectral_density(record, STEP, window="none")
    assert np.sum(density.value) * density.resolution == pytest.approx(
        np.var(record), rel=1e-9, abs=1e-9
    )


def test_segments_keep_the_level_of_white_noise() -> None:
    """The mean density of white noise of variance s^2 is 2 s^2 dt, with or without segments."""
    noise = 3.0 * np.random.default_rng(0).standard_normal(20000)
    for segments in (1, 9):
        density = power_spectral_density(noise, STEP, segments)
        assert np.mean(density.value[1:-1]) == pytest.approx(2.0 * 9.0 * STEP, rel=0.05)
        assert density.segments == segments


def test_wave_number_keeps_the_area() -> None:
    """Over wave number f / v the area under the power density stays the variance."""
    time = STEP * np.arange(1000)
    density = power_spectral_density(np.sin(2 * np.pi * 40.0 * time), STEP, window="none")
    waves = over_wavenumber(density, 80.0, is_density=True)
    assert np.sum(waves.value) * waves.resolution == pytest.approx(0.5, rel=1e-9)
    assert waves.wavelength[np.argmax(waves.value)] == pytest.approx(2.0)
    assert np.isinf(waves.wavelength[0])


def test_passing_lines_of_the_benchmark() -> None:
    """At 320 km/h spans of 55 m pass at 1.62 Hz and droppers of 5.75 m at 15.46 Hz.

    Source: Song et al. (2021), section I, and the benchmark's geometry.
    """
    lines = passing_lines({"dropper": 5.75, "span": 55.0}, 320.0 / 3.6, 20.0, orders=2)
    assert [line.name for line in lines] == ["span", "span", "dropper"]
    assert lines[0].frequency == pytest.approx(1.616, abs=1e-3)
    assert lines[1].order == 2
    assert lines[2].frequency == pytest.approx(15.46, abs=5e-3)
    assert lines[2].wavenumber == pytest.approx(1.0 / 5.75)


def test_bad_spectra_are_refused() -> None:
    """Too short records, too many segments and a missing speed are refused."""
    short = amplitude_spectrum(np.ones(8), STEP)
    with pytest.raises(ValueError, match="at least four samples"):
        amplitude_spectrum([1.0, 2.0], STEP)
    with pytest.raises(ValueError, match="overlapping pieces"):
        power_spectral_density(np.ones(8), STEP, segments=20)
    with pytest.raises(ValueError, match="positive speed"):
        over_wavenumber(short, 0.0, is_density=False)
    with pytest.raises(ValueError, match="over_wavenumber"):
        _ = short.wavelength


def test_background_exceeds_its_limit_as_often_as_asked() -> None:
    """Noise: the largest of three lines over the mean of 20 others passes the limit in 1 %."""
    generator = np.random.default_rng(1)
    power = generator.exponential(size=(200_000, 23))
    ratio = power[:, :3].max(axis=1) / power[:, 3:].mean(axis=1)
    limit = background_limit(20, 0.01, places=3)
    assert np.mean(ratio > limit) == pytest.approx(0.01, rel=0.08)
    assert background_limit(10**7, 0.01) == pytest.approx(-np.log(0.01), rel=1e-4)
