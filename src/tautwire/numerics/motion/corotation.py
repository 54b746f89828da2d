"""Minimal rotations that carry the nodes' reference tangents onto the current ones.

The stiffest part of a wire, its axial stiffness, turns with the wire. A constant matrix therefore
is a poor approximation of the tangent after small rotations; turned node by node it stays a good
one: ``x = R A0^-1 R' r``.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]


def unit_tangents(q: Array) -> Array:
    """Return the unit tangent of every node, ``(3, n_node)``."""
    slope = q.reshape(-1, 6)[:, 3:].T
    norm = np.sqrt(slope[0] ** 2 + slope[1] ** 2 + slope[2] ** 2)
    return slope / norm


class NodeRotation:
    """Rotation of each node from its reference tangent to its current one (Rodrigues' formula).

    Parameters
    ----------
    reference, current : (3, n_node)
        Unit tangents; no node may have turned by half a turn.
    """

    def __init__(self, reference: Array, current: Array) -> None:
        self._axis = np.cross(reference, current, axis=0)[:, None]
        cosine = np.einsum("in,in->n", reference, current)
        self._scale = 1.0 / (1.0 + cosine)

    def forward(self, x: Array) -> Array:
        """Turn nodal vectors ``(n_dof,)`` from the reference to the current orientation."""
        return self._rotate(x, self._axis)

    def backward(self, x: Array) -> Array:
        """Turn nodal vectors ``(n_dof,)`` from the current to the reference orientation."""
        return self._rotate(x, -self._axis)

    def _rotate(self, x: Array, w: Array) -> Array:
        y = np.ascontiguousarray(x.reshape(-1, 2, 3).T)
        first = _cross(w, y)
        y += first + self._scale * _cross(w, first)
        return np.ascontiguousarray(y.T).reshape(-1)


def _cross(a: Array, b: Array) -> Array:
    out = np.empty_like(b)
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]
    return out
