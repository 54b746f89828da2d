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
"""Even points per shortest element: an element is a cubic, which four points determine."""


@dataclass(frozen=True, eq=False)
class EvenPoints:
    """Evenly spaced points of the contact wire in its static shape.

    Attributes
    ----------
    x : (n_point,) m
    nodes : (n_point, 2)
        Nodes at the ends of the wire element that each point lies in.
    rows : (n_point, 4)
        Hermite row of each point: ``z = row @ (z1, z1', z2, z2')``.
    """

    x: Array
    nodes: NDArray[np.int64]
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
        nodes = vectors.reshape(*vectors.shape[:-1], vectors.shape[-1] // 6, 2, 3)[..., direction]
        left, right = nodes[..., self.nodes[:, 0], :], nodes[..., self.nodes[:, 1], :]
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
    wire = shape.contact
    start = float(wire.s[0]) if start is None else start
    end = float(wire.s[-1]) if end is None else end
    if not count:
        shortest = float(np.diff(wire.s).min())
        count = max(8, int(np.ceil((end - start) / shortest * POINTS_PER_ELEMENT)))
    x = np.linspace(start, end, count, endpoint=False)
    element = wire.element(x)
    lengths = wire.lengths[element]
    xi = local_coordinate(shape.position[wire.dofs(element, 0)], lengths, x)
    nodes = np.stack([wire.nodes[element], wire.nodes[element + 1]], axis=1)
    return EvenPoints(x, nodes, position_row(xi, lengths))


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
