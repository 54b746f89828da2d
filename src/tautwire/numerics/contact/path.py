"""Where the pantograph touches the contact wire, and the unilateral penalty law (paper eq. 9).

The force is vertical and acts at the point of the wire whose x equals the pantograph's x. With
``x(xi) = x_p`` the height of that point is ``z(xi)``; its derivative with respect to the nodal
coordinates includes the shift of the point, ``dz/de = S - (z'/x') S_x``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.elements.hermite import local_coordinate, position_row, slope_row

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
        z and y of the point.
    dofs_x, dofs_z : (4,)
        Degrees of freedom (r1, r1', r2, r2') in x and z.
    row : (4,)
        Hermite row S(xi): the vertical force F enters as ``row * F`` on ``dofs_z``.
    slope : float
        ``z'/x'`` at the point; the gradient of the height is ``row`` on ``dofs_z`` and
        ``-slope * row`` on ``dofs_x``.
    """

    element: int
    xi: float
    height: float
    lateral: float
    dofs_x: Index
    dofs_z: Index
    row: Array
    slope: float


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
        self._x_dofs = 6 * np.asarray(nodes)
        self._lengths = np.asarray(lengths)

    def locate(self, q: Array, x: float, hint: int = 0) -> ContactPoint | None:
        """Return the point of the wire at longitudinal position ``x``; None when it is off.

        Parameters
        ----------
        q : (n_dof,)
            Nodal coordinates.
        x
            Longitudinal position [m].
        hint
            Element in which to start looking.
        """
        element = self._find_element(q, x, hint)
        if element is None:
            return None
        length = self._lengths[element]
        left, right = self._x_dofs[element], self._x_dofs[element + 1]
        dofs_x = np.array([left, left + 3, right, right + 3])
        xi = float(local_coordinate(q[dofs_x], length, x))
        row, rate = position_row(xi, length), slope_row(xi, length)
        dofs_z = dofs_x + 2
        e_z = q[dofs_z]
        slope = float(rate @ e_z) / float(rate @ q[dofs_x])
        lateral = float(row @ q[dofs_x + 1])
        return ContactPoint(element, xi, float(row @ e_z), lateral, dofs_x, dofs_z, row, slope)

    def _find_element(self, q: Array, x: float, hint: int) -> int | None:
        dofs = self._x_dofs
        if not q[dofs[0]] <= x <= q[dofs[-1]]:
            return None
        element = min(max(hint, 0), len(dofs) - 2)
        while x < q[dofs[element]]:
            element -= 1
        while element < len(dofs) - 2 and x >= q[dofs[element + 1]]:
            element += 1
        return element
