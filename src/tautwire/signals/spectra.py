"""Amplitude and power spectra over frequency and over wave number, and the lines to expect."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Window = Literal["hann", "none"]


@dataclass(frozen=True, eq=False)
class Spectrum:
    """One-sided spectrum.

    Attributes
    ----------
    abscissa : (n_line,)
        Frequency [Hz] or wave number [1/m], see `abscissa_unit`.
    value : (n_line,)
        Amplitude [unit of the signal], or power density [unit squared per abscissa unit].
    abscissa_unit : str
        ``"Hz"`` or ``"1/m"``.
    window : str
        Window applied to the record.
    segments : int
        Number of half-overlapping pieces that were averaged.
    """

    abscissa: Array
    value: Array
    abscissa_unit: str
    window: str
    segments: int

    @property
    def resolution(self) -> float:
        """Distance between neighbouring lines [Hz or 1/m]."""
        return float(self.abscissa[1] - self.abscissa[0])

    @property
    def wavelength(self) -> Array:
        """Wavelength of the lines of a spectrum over wave number [m]; infinite at 0."""
        if self.abscissa_unit != "1/m":
            raise ValueError("wavelengths need a spectrum over wave number: use over_wavenumber")
        with np.errstate(divide="ignore"):
            return 1.0 / self.abscissa


@dataclass(frozen=True)
class PassingLine:
    """A frequency at which the pantograph passes something periodic.

    Attributes
    ----------
    name : str
    length : float m
        Distance between two passings.
    order : int
        Harmonic n.
    frequency : float Hz
        ``n v / length``.
    wavenumber : float 1/m
        ``n / length``.
    """

    name: str
    length: float
    order: int
    frequency: float
    wavenumber: float


def amplitude_spectrum(signal: ArrayLike, time_step: float, window: Window = "hann") -> Spectrum:
    """Compute the amplitude of the sines a signal consists of; the mean is removed.

    A sine of amplitude A whose period divides the record gives a line of height A, with either
    window.

    Parameters
    ----------
    signal : (n_time,)
    time_step : float s
    window : {"hann", "none"}

    Returns
    -------
    Spectrum
        Over frequency [Hz]; values in the unit of the signal.
    """
    record = _record(signal)
    weight = _window(window, record.size)
    lines = np.fft.rfft((record - record.mean()) * weight)
    value = np.abs(lines) / weight.sum() * _sides(record.size)
    return Spectrum(_frequencies(record.size, time_step), value, "Hz", window, 1)


def power_spectral_density(
    signal: ArrayLike, time_step: float, segments: int = 1, window: Window = "hann"
) -> Spectrum:
    """Compute the one-sided power spectral density; the mean of the record is removed.

    The record is cut into `segments` pieces of equal length that overlap by half, and their
    periodograms are averaged (Welch). Without a window and with one segment the sum over all
    lines times the resolution is the variance of the signal (Parseval).

    Parameters
    ----------
    signal : (n_time,)
    time_step : float s
    segments : int
        Number of pieces; more give a smoother spectrum with a coarser resolution.
    window : {"hann", "none"}

    Returns
    -------
    Spectrum
        Over frequency [Hz]; values in the squared unit of the signal per Hz.
    """
    record = _record(signal)
    if segments < 1 or 2 * record.size // (segments + 1) < 2:
        raise ValueError(f"cannot cut {record.size} samples into {segments} overlapping pieces")
    hop = record.size // (segments + 1)
    length = record.size if segments == 1 else 2 * hop
    weight = _window(window, length)
    centred = record - record.mean()
    total = np.zeros(length // 2 + 1)
    for piece in range(segments):
        lines = np.fft.rfft(centred[piece * hop : piece * hop + length] * weight)
        total += np.abs(lines) ** 2
    density = total / segments * time_step / np.sum(weight**2) * _sides(length)
    return Spectrum(_frequencies(length, time_step), density, "Hz", window, segments)


def _frequencies(size: int, time_step: float) -> Array:
    """Return the frequencies of a real transform of ``size`` samples [Hz]."""
    return np.arange(size // 2 + 1) / (size * time_step)


def over_wavenumber(spectrum: Spectrum, speed: float, *, is_density: bool) -> Spectrum:
    """Express a spectrum over frequency as one over wave number ``f / v``.

    Parameters
    ----------
    spectrum : Spectrum
        Over frequency.
    speed : float m/s
    is_density : bool
        True for a power spectral density, whose values are multiplied by the speed so that the
        area under it remains the variance; False for an amplitude spectrum.

    Returns
    -------
    Spectrum
        Over wave number [1/m]; the wavelength is its reciprocal.
    """
    if spectrum.abscissa_unit != "Hz" or speed <= 0.0:
        raise ValueError("a spectrum over frequency and a positive speed are needed")
    value = spectrum.value * speed if is_density else spectrum.value
    return Spectrum(spectrum.abscissa / speed, value, "1/m", spectrum.window, spectrum.segments)


def passing_lines(
    lengths: Mapping[str, float], speed: float, highest: float, orders: int = 1
) -> tuple[PassingLine, ...]:
    """List the frequencies ``n v / length`` at which periodic items are passed.

    Parameters
    ----------
    lengths : mapping of str to float m
        Name and distance, for example ``{"span": 55.0, "dropper interval": 5.75}``.
    speed : float m/s
    highest : float Hz
        Lines above it are left out.
    orders : int
        Number of harmonics per item.

    Returns
    -------
    tuple of PassingLine, by increasing frequency

    Examples
    --------
    >>> [line] = passing_lines({"span": 55.0}, 320.0 / 3.6, 2.0)
    >>> round(line.frequency, 2)
    1.62
    """
    lines = [
        PassingLine(name, length, n, n * speed / length, n / length)
        for name, length in lengths.items()
        for n in range(1, orders + 1)
        if length > 0.0 and n * speed / length <= highest
    ]
    return tuple(sorted(lines, key=lambda line: line.frequency))


def background_limit(neighbours: int, chance: float, places: int = 1) -> float:
    """Return the power of a line over the mean power around it that background rarely exceeds.

    Amplitudes of a smooth background scatter so that the power of one line over the mean power of
    M neighbouring ones has the F distribution with 2 and 2 M degrees of freedom (the test for a
    sinusoid in coloured noise); ``P(ratio > x) = (1 + x/M)^-M``. For the largest of several lines
    the chance is shared between them (Sidak).

    Parameters
    ----------
    neighbours : int
        Number of lines the mean is taken of.
    chance : float
        Chance that the background exceeds the limit, 0 to 1.
    places : int
        Number of lines of which the largest is tested.

    Examples
    --------
    >>> round(background_limit(20, 0.01), 2)
    5.18
    """
    single = -math.expm1(math.log1p(-chance) / places)
    return neighbours * math.expm1(-math.log(single) / neighbours)


def _record(signal: ArrayLike) -> Array:
    record = np.asarray(signal, dtype=np.float64)
    if record.ndim != 1 or record.size < 4:
        raise ValueError("a spectrum needs one column of at least four samples")
    return record


def _window(window: Window, size: int) -> Array:
    if window == "none":
        return np.ones(size)
    return 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(size) / size)


def _sides(size: int) -> Array:
    """Return 2 for lines that stand for +f and -f, 1 for the mean and the Nyquist line."""
    sides = np.full(size // 2 + 1, 2.0)
    sides[0] = 1.0
    if size % 2 == 0:
        sides[-1] = 1.0
    return sides
