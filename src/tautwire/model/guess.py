"""First guess of the shape: two taut strings that hang on supports and droppers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class StringWire:
    """One wire as a string.

    Attributes
    ----------
    tension : float N
    load : (n_station,) N
        Downward load lumped at the stations.
    held : (n_held,)
        Stations at prescribed height.
    height : (n_held,) m
    """

    tension: float
    load: Array
    held: Index
    height: Array


def string_shape(x: Array, wire: StringWire) -> tuple[Array, Array]:
    """Return the height of a string and the upward force it needs at its stations.

    Parameters
    ----------
    x : (n_station,) m
    wire
        Tension, loads and held stations.

    Returns
    -------
    height : (n_station,) m
    reaction : (n_station,) N
        Zero at free stations.
    """
    from scipy.linalg import solveh_banded

    diagonal, upper = _string_matrix(x, wire.tension)
    band, rhs = _hold(np.stack([upper, diagonal]), -wire.load, wire.held, wire.height)
    z = solveh_banded(band, rhs)
    reaction = diagonal * z + wire.load
    reaction[:-1] += upper[1:] * z[1:]
    reaction[1:] += upper[1:] * z[:-1]
    free = np.ones(len(x), dtype=bool)
    free[wire.held] = False
    reaction[free] = 0.0
    return z, reaction


def coupled_shape(
    x: Array, contact: StringWire, messenger: StringWire, droppers: Index, lengths: Array
) -> tuple[Array, Array]:
    """Return the heights of two strings joined by droppers of given stretched length.

    Parameters
    ----------
    x : (n_station,) m
    contact, messenger
        The wires; stations held are the supports.
    droppers : (n_dropper,)
        Stations of the droppers.
    lengths : (n_dropper,) m

    Returns
    -------
    contact_height, messenger_height : (n_station,) m
    """
    from scipy.linalg import solveh_banded

    n = len(x)
    band = np.zeros((3, 2 * n))
    rhs = np.zeros(2 * n)
    for side, wire in enumerate((contact, messenger)):
        diagonal, upper = _string_matrix(x, wire.tension)
        band[2, side::2] = diagonal
        band[0, side::2] = upper
        rhs[side::2] = -wire.load
    stiff = 1e3 * float(band[2].max())
    band[2, 2 * droppers] += stiff
    band[2, 2 * droppers + 1] += stiff
    band[1, 2 * droppers + 1] -= stiff
    rhs[2 * droppers] -= stiff * lengths
    rhs[2 * droppers + 1] += stiff * lengths
    held = np.concatenate([2 * contact.held, 2 * messenger.held + 1])
    height = np.concatenate([contact.height, messenger.height])
    band, rhs = _hold(band, rhs, held, height)
    z = solveh_banded(band, rhs)
    return z[0::2], z[1::2]


def _string_matrix(x: Array, tension: float) -> tuple[Array, Array]:
    """Return diagonal and upper diagonal (first entry unused) of a string's stiffness matrix."""
    k = tension / np.diff(x)
    diagonal = np.zeros(len(x))
    diagonal[:-1] += k
    diagonal[1:] += k
    return diagonal, np.concatenate([[0.0], -k])


def _hold(band: Array, rhs: Array, held: Index, height: Array) -> tuple[Array, Array]:
    """Prescribe unknowns of a symmetric upper banded system by a penalty on the diagonal."""
    band, rhs = band.copy(), rhs.copy()
    penalty = 1e9 * float(band[-1].max())
    band[-1, held] += penalty
    rhs[held] += penalty * height
    return band, rhs
