"""Gauss-Legendre rules on the unit interval."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def gauss_unit(count: int) -> tuple[Array, Array]:
    """Return abscissae and weights of the Gauss-Legendre rule on [0, 1].

    Parameters
    ----------
    count
        Number of points; the rule is exact for polynomials of degree ``2*count - 1``.

    Returns
    -------
    points, weights : (count,)
    """
    points, weights = np.polynomial.legendre.leggauss(count)
    return 0.5 * (points + 1.0), 0.5 * weights
