"""The contact wire resampled evenly along the track: static shape, mode shapes, spectra."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tautwire.results.equilibrium import Equilibrium, WirePoints
from tautwire.signals.spectra import (
    Spectrum,
    Window,
    amplitude_spectrum,
    power_spectral_density,
)

Array = NDArray[np.float64]

POINTS_PER_ELEMENT = 4
"""Even points per shortest element: an element is a cubic, which four points determine."""


def even_points(
    shape: Equilibrium, *, start: float | None = None, end: float | None = None, count: int = 0
) -> WirePoints:
    """Spread points evenly along the static contact wire.

    Parameters
    ----------
    shape
        Static state.
    start, end
        Part of the line [m]; the whole line by default.
    count
        Number of points; by default four per shortest element. The point at `end`, where a
        periodic record repeats, is left out.

    Returns
    -------
    WirePoints
    """
    wire = shape.contact
    start = float(wire.s[0]) if start is None else start
    end = float(wire.s[-1]) if end is None else end
    if not count:
        shortest = float(np.diff(wire.s).min())
        count = max(8, int(np.ceil((end - start) / shortest * POINTS_PER_ELEMENT)))
    x = np.linspace(start, end, count, endpoint=False)
    return shape.points(wire, x)


def wavenumber_spectrum(
    values: ArrayLike, spacing: float, window: Window = "hann", *, density: bool = False
) -> Spectrum:
    """Compute the spectrum of something along the track over wave number.

    Parameters
    ----------
    values : (n_point,)
    spacing : float m
    window : {"hann", "none"}
    density : bool
        False: amplitudes; True: power density, in the squared unit of the values times metre.

    Returns
    -------
    Spectrum
        Over wave number [1/m]; ``spectrum.wavelength`` is its reciprocal.
    """
    if density:
        found = power_spectral_density(values, spacing, window=window)
    else:
        found = amplitude_spectrum(values, spacing, window)
    return replace(found, abscissa_unit="1/m")
