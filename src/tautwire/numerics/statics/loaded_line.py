"""Static response to point forces: a nonlinear window in a line that is linear outside it.

The tangent of the unloaded line is factored once from either end. What lies left and right of a
window then acts on it through two small matrices, exactly as the whole line does as long as it is
linear there; inside, elements and droppers are nonlinear. The cost of a force does not depend on
the length of the line.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.network.banded import BandedCholesky, Pattern
from tautwire.numerics.network.cuts import between
from tautwire.numerics.network.system import System, tangent_parts
from tautwire.numerics.statics.window import Window

Array = NDArray[Any]


class LoadedLine:
    """A line at rest whose response to forces is wanted in many places.

    Parameters
    ----------
    system
        The line; ``position`` is its unloaded static state.

    Raises
    ------
    ValueError
        When the tangent of the static state is not positive definite.
    """

    def __init__(self, system: System) -> None:
        self._system = system
        self._pattern = Pattern(system)
        ties = system.ties
        state = ties.state(system.position)
        taut = ties.acting(ties.stiffness * (state.length - ties.length))
        values = self._pattern.values(tangent_parts(system, system.position, taut=taut))
        self._band = self._pattern.upper_band(values)
        found = BandedCholesky.of(self._band), BandedCholesky.of(_reversed(self._band))
        if found[0] is None or found[1] is None:
            raise ValueError("the tangent of the static state is not positive definite")
        self._from_left, self._from_right = found[0].factor, found[1].factor

    def window(self, first: int = 0, last: int | None = None, increment: float = 1e-8) -> Window:
        """Return a window, the whole line by default.

        Parameters
        ----------
        first, last
            Its nodes are ``first`` to ``last - 1``; it is widened to the width of the band.
        increment
            Largest change of a coordinate accepted as converged [m].
        """
        count = self._system.node_count
        last = count if last is None else last
        missing = max(0, -(-self._pattern.bandwidth // 6) - (last - first))
        first, last = max(0, first - missing), min(count, last + missing)
        inside = between(self._system, first, last)
        band = _without_rows_above(self._band[:, 6 * first : 6 * last])
        in_corner = np.zeros(inside.dof_count, dtype=bool)
        if first > 0:
            self._condense(band, in_corner, 0, self._left_of(6 * first))
        if last < count:
            block = self._right_of(6 * last)
            self._condense(band, in_corner, inside.dof_count - len(block), block)
        return Window(inside, 6 * first, band, in_corner, increment)

    def _condense(
        self, band: Array, in_corner: NDArray[np.bool_], first: int, block: Array
    ) -> None:
        """Take a block off the stiffness in upper banded storage, in place."""
        width = len(band) - 1
        in_corner[first : first + len(block)] = True
        for column in range(len(block)):
            band[width - column :, first + column] -= block[: column + 1, column]

    def _left_of(self, dof: int) -> Array:
        """Return what the line left of a coordinate takes off the stiffness right of it."""
        return _coupling(self._from_left, dof)

    def _right_of(self, dof: int) -> Array:
        """Return what the line from a coordinate on takes off the stiffness left of it."""
        block = _coupling(self._from_right, self._system.dof_count - dof)
        return block[::-1, ::-1]


def _reversed(band: Array) -> Array:
    """Return the upper band of the matrix with rows and columns in reverse order."""
    width = len(band) - 1
    out = np.zeros_like(band)
    for d in range(width + 1):
        out[width - d, d:] = band[width - d, d:][::-1]
    return out


def _coupling(factor: Array, at: int) -> Array:
    """Return ``U12' U12`` of an upper factor cut at a row: a block of the width of the band."""
    width = len(factor) - 1
    count = min(width, at)
    upper = np.zeros((count, width))
    for column in range(width):
        rows = np.arange(max(at - count, at + column - width), at)
        upper[rows - (at - count), column] = factor[width + rows - (at + column), at + column]
    return upper.T @ upper


def _without_rows_above(band: Array) -> Array:
    """Return columns of an upper band as a matrix of their own: without rows of columns before."""
    width = len(band) - 1
    row = np.arange(band.shape[1]) - width + np.arange(width + 1)[:, None]
    return np.where(row < 0, 0.0, band)
