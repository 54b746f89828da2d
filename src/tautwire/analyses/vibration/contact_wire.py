"""The contact wire resampled evenly along the track: static shape, mode shapes, spectra."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tautwire.numerics.elements.hermite import local_coordinate, position_row
from tautwire.results.equilibrium import Equilibrium
from tautwire.signals.spectra import (
    Spectrum,
    Window,
    amplitude_spectrum,
    power_spectral_density,
)

Array = NDArray[np.float64]

POINTS_PER_ELEMENT = 4


@dataclass(frozen=True, eq=False)
class EvenPoints:
    """Evenly spaced points of the contact wire in its static shape.

    Attributes
    ----------
    x : (n_point,) m
    element : (n_point,)
        Wire element (0-based) each point lies in.
    rows : (n_point, 4)
        Hermite row of each point: ``z = row @ (z1, z1', z2, z2')``.
    """

    x: Array
    element: NDArray[np.int64]
    rows: Array

    @property
    def spacing(self) -> float:
        """Distance between neighbouring points [m]."""
        return float(self.x[1] - self.x[0])

    def values(self, vectors: Array, direction: int = 2) -> Array:
        """Interpolate coordinates or displacements of the contact wire at the points.

        Parameters
        ----------
        vectors : (..., n_dof)
            Nodal coordinates, or displacements such as a mode shape.
        direction
            0 along the track, 1 lateral, 2 vertical.

        Returns
        -------
        (..., n_point)
        """
        stations = vectors.shape[-1] // 12
        nodes = vectors.reshape(*vectors.shape[:-1], stations, 2, 2, 3)[..., 0, :, direction]
        left, right = nodes[..., self.element, :], nodes[..., self.element + 1, :]
        ends = np.concatenate([left, right], axis=-1)
        return np.einsum("...pi,pi->...p", ends, self.rows)


def even_points(
    shape: Equilibrium, *, start: float | None = None, end: float | None = None, count: int = 0
) -> EvenPoints:
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
    EvenPoints
    """
    stations = shape.station_x
    start = float(stations[0]) if start is None else start
    end = float(stations[-1]) if end is None else end
    if not count:
        shortest = float(np.diff(stations).min())
        count = max(8, int(np.ceil((end - start) / shortest * POINTS_PER_ELEMENT)))
    x = np.linspace(start, end, count, endpoint=False)
    element = np.clip(np.searchsorted(stations, x, side="right") - 1, 0, len(stations) - 2)
    lengths = shape.cable_lengths[element]
    nodes = shape.position.reshape(-1, 2, 2, 3)[:, 0, :, 0]
    ends = np.concatenate([nodes[element], nodes[element + 1]], axis=1)
    return EvenPoints(x, element, position_row(local_coordinate(ends, lengths, x), lengths))


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
