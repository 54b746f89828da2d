"""Where the pantograph touches the contact wire, and the unilateral penalty law (paper eq. 9).

The pantograph stands in a plane across the track, through a point p and with the tangent t of the
track as its normal; its head rises along b, the normal of the plane of the rails. The force acts
along b at the point of the wire in that plane, ``(r(xi) - p) . t = 0``, whose height is
``h = (r(xi) - p) . b``. The derivative of the height with respect to the nodal coordinates includes
the shift of the point, ``dh/de = S (b - (r' . b / r' . t) t)``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.elements.hermite import local_coordinate, position_row, slope_row
from tautwire.numerics.track import Frames

Array = NDArray[np.float64]
Index = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class ContactPoint:
    """The touched point of the wire.

    Attributes
    ----------
    element : int
        Index along the wire (between stations ``element`` and ``element + 1``).
    xi : float
        Local coordinate in [0, 1].
    height, lateral : float m
        Place of the point in the plane of contact.
    dofs : (4, 3)
        Degrees of freedom of r1, r1', r2 and r2'.
    row : (4,)
        Hermite row S(xi).
    push : (4, 3)
        What a unit of contact force puts on ``dofs``.
    gradient : (4, 3)
        Derivative of the height with respect to ``dofs``.
    """

    element: int
    xi: float
    height: float
    lateral: float
    dofs: Index
    row: Array
    push: Array
    gradient: Array


class ContactWirePath:
    """Finds touched points along a wire.

    Parameters
    ----------
    nodes : (n_station,)
        Nodes of the wire from left to right.
    lengths : (n_station - 1,) m
        Unstrained element lengths.
    """

    def __init__(self, nodes: Index, lengths: Array) -> None:
        self._nodes = np.asarray(nodes)
        self._lengths = np.asarray(lengths)

    def locate(self, q: Array, plane: Frames, hint: int = 0) -> ContactPoint | None:
        """Return the point of the wire in a plane of contact; None when the wire ends before.

        Parameters
        ----------
        q : (n_dof,)
            Nodal coordinates.
        plane
            Frame of the track at the pantograph.
        hint
            Element in which to start looking.
        """
        r = q.reshape(-1, 2, 3)
        element = self._find_element(r, plane, hint)
        if element is None:
            return None
        length = self._lengths[element]
        ends = self._nodes[element : element + 2]
        e = r[ends].reshape(4, 3).copy()
        e[::2] -= plane.origin
        local = e @ plane.axes.T
        xi = float(local_coordinate(local[:, 0], length, 0.0))
        row, rate = position_row(xi, length), slope_row(xi, length)
        _, lateral, height = (row @ local).tolist()
        slope = float(rate @ local[:, 2]) / float(rate @ local[:, 0])
        t, _, b = plane.axes
        dofs = (6 * ends[:, None] + np.arange(6)).reshape(4, 3)
        push, gradient = row[:, None] * b, row[:, None] * (b - slope * t)
        return ContactPoint(element, xi, height, lateral, dofs, row, push, gradient)

    def _find_element(self, r: Array, plane: Frames, hint: int) -> int | None:
        def ahead(station: int) -> float:
            return float((r[self._nodes[station], 0] - plane.origin) @ plane.axes[0])

        last = len(self._nodes) - 1
        if not ahead(0) <= 0.0 <= ahead(last):
            return None
        element = min(max(hint, 0), last - 1)
        while ahead(element) > 0.0:
            element -= 1
        while element < last - 1 and ahead(element + 1) <= 0.0:
            element += 1
        return element
