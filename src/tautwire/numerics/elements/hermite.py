"""Cubic Hermite shape functions of the ANCF cable element (paper eq. 3).

The element interpolates ``r(xi) = S1 r1 + S2 r1' + S3 r2 + S4 r2'`` with ``xi = chi/L0`` in [0, 1].
Kernels work with ``d = (r2 - r1)/L0`` instead of ``r1`` and ``r2``; the derivatives then read
``r' = B_d d + B_1 r1' + B_2 r2'`` with coefficients that do not depend on the element length.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def position_row(xi: ArrayLike, length: ArrayLike) -> Array:
    """Return S1 .. S4 at ``xi``: ``r = row @ (r1, r1', r2, r2')``.

    Parameters
    ----------
    xi
        Local coordinate(s) in [0, 1].
    length
        Unstrained element length(s) [m].

    Returns
    -------
    (..., 4)
    """
    s, length = np.asarray(xi), np.asarray(length)
    return np.stack(
        [
            1.0 - 3.0 * s**2 + 2.0 * s**3,
            length * (s - 2.0 * s**2 + s**3),
            3.0 * s**2 - 2.0 * s**3,
            length * (s**3 - s**2),
        ],
        axis=-1,
    )


def slope_row(xi: ArrayLike, length: ArrayLike) -> Array:
    """Return the derivatives of S1 .. S4 with respect to ``xi`` (not ``chi``), ``(..., 4)``."""
    s, length = np.asarray(xi), np.asarray(length)
    return np.stack(
        [
            -6.0 * s + 6.0 * s**2,
            length * (1.0 - 4.0 * s + 3.0 * s**2),
            6.0 * s - 6.0 * s**2,
            length * (3.0 * s**2 - 2.0 * s),
        ],
        axis=-1,
    )


def derivative_tables(xi: ArrayLike) -> tuple[Array, Array]:
    """Return the coefficients of ``r'`` and ``L0 r''`` on ``(d, r1', r2')``.

    Parameters
    ----------
    xi
        Local coordinates ``(n_point,)``.

    Returns
    -------
    first, second : (n_point, 3)
    """
    s = np.asarray(xi, dtype=float)
    first = np.stack([6.0 * s - 6.0 * s**2, 1.0 - 4.0 * s + 3.0 * s**2, 3.0 * s**2 - 2.0 * s], 1)
    second = np.stack([6.0 - 12.0 * s, 6.0 * s - 4.0, 6.0 * s - 2.0], 1)
    return first, second
