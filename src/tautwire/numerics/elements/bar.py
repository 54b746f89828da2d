"""Two-node bar that carries axial force only: droppers and steady arms.

Axial force ``N = k (l - L0)`` with the current length ``l = |r_a - r_b|``; the tension-only
switch is applied by the caller.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]


class BarState(NamedTuple):
    """Kinematics of bars: unit vector from b to a ``(3, n)``, length ``(n,)`` [m]."""

    direction: Array
    length: Array


def bar_state(a: Array, b: Array) -> BarState:
    """Return direction (from b to a) and length of bars between ``a`` and ``b``, ``(3, n)`` [m]."""
    w = a - b
    length = np.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
    return BarState(w / length, length)


def bar_tangent(state: BarState, stiffness: Array, axial: Array) -> Array:
    """Return the 3x3 block ``k t t^T + N/l (I - t t^T)`` of each bar.

    Parameters
    ----------
    state
        Kinematics.
    stiffness : (n,) N/m
        Axial stiffness k; zero for a slack bar.
    axial : (n,) N
        Axial force N; zero for a slack bar.

    Returns
    -------
    (3, 3, n)
        The bar's tangent is ``[[B, -B], [-B, B]]`` with this block B.
    """
    t = state.direction
    tt = t[:, None] * t[None, :]
    geometric = axial / state.length
    return stiffness * tt + geometric * (np.eye(3)[:, :, None] - tt)
