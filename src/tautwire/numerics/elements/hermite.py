"""Cubic Hermite shape functions of the ANCF cable element (paper eq. 3).

The element interpolates ``r(xi) = S1 r1 + S2 r1' + S3 r2 + S4 r2'`` with ``xi = chi/L0`` in [0, 1].
Kernels work with ``d = (r2 - r1)/L0`` instead of ``r1`` and ``r2``; the derivatives then read
``r' = B_d d + B_1 r1' + B_2 r2'`` with coefficients that do not depend on the element length.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

_NEWTON_STEPS = 20
"""Far more than needed: an element is nearly straight, so that three steps reach rounding."""
_TOLERANCE = 1e-13
"""Of the local coordinate: rounding of a length of 1 m in a line of a kilometre."""


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


def local_coordinate(ends: ArrayLike, length: ArrayLike, x: ArrayLike) -> Array:
    """Solve ``S(xi) e_x = x`` for ``xi`` by Newton's method from the linear guess.

    Parameters
    ----------
    ends : (..., 4)
        x of the element: ``(r1, r1', r2, r2')``.
    length : (...) m
        Unstrained element length(s).
    x : (...) m
        Position(s) between the ends of the element.

    Returns
    -------
    (...)
    """
    ends, x = np.asarray(ends), np.asarray(x)
    xi = (x - ends[..., 0]) / (ends[..., 2] - ends[..., 0])
    for _ in range(_NEWTON_STEPS):
        row, rate = position_row(xi, length), slope_row(xi, length)
        step = (x - np.sum(row * ends, axis=-1)) / np.sum(rate * ends, axis=-1)
        xi = xi + step
        if np.max(np.abs(step), initial=0.0) < _TOLERANCE:
            break
    return xi


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
