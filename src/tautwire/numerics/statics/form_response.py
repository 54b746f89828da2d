"""How a found shape moves when given lengths and heights change: one factor, many columns.

At the equilibrium ``r(x, p) = 0`` of shape finding the unknowns follow a parameter by
``dx/dp = -r_x^-1 r_p``. The bordered tangent ``r_x`` is factored once; a column ``r_p`` is that of
the unstrained length of a tie, or the column of the stiffness that belongs to a held coordinate.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.statics.form_finding import (
    Form,
    FormFinder,
    FormProblem,
    tie_force_rate,
)

Array = NDArray[Any]
Index = NDArray[np.int64]


class FormResponse:
    """The tangent of a found shape, factored.

    Parameters
    ----------
    problem
        What was given.
    form
        Its shape.

    Raises
    ------
    ValueError
        When the tangent is singular.
    """

    def __init__(self, problem: FormProblem, form: Form) -> None:
        from scipy.linalg.lapack import dgbtrf  # pyright: ignore[reportAttributeAccessIssue]

        self._finder, self._system = FormFinder(problem), form.system
        self._width = self._finder.pattern.bandwidth
        band = self._finder.bordered_band(form.system)
        self._factor, self._pivots, info = dgbtrf(band, self._width, self._width, overwrite_ab=True)
        if info:
            raise ValueError("the tangent of the shape is singular")

    def of_lengths(self, ties: Index) -> tuple[Array, Array]:
        """Return movements and forces of ties per unstrained length of some taut ties.

        Parameters
        ----------
        ties : (n,)

        Returns
        -------
        (n_dof, n) and (n_tie, n) N/m
            Coordinates of the nodes, and axial forces of the ties that are taut.
        """
        columns = self._finder.tie_columns(self._system)[:, ties]
        rhs = np.zeros((self._system.dof_count, len(ties)))
        rhs[self._system.ties.dofs[:, ties], np.arange(len(ties))] = columns
        moved = self._solved(rhs)
        forces = self._forces(moved)
        forces[ties, np.arange(len(ties))] += tie_force_rate(self._system)[ties]
        return moved, forces * self._finder.problem.taut[:, None]

    def of_held(self, coordinates: Index) -> tuple[Array, Array]:
        """Return the same per movement of some held coordinates, along the axes of the nodes.

        Parameters
        ----------
        coordinates : (n,)
        """
        rhs = self._finder.tangent(self._system)[:, coordinates].toarray()
        moved = self._solved(rhs, coordinates)
        return moved, self._forces(moved) * self._finder.problem.taut[:, None]

    def _solved(self, rhs: Array, coordinates: Index | None = None) -> Array:
        from scipy.linalg.lapack import dgbtrs  # pyright: ignore[reportAttributeAccessIssue]

        finder, width = self._finder, self._width
        rhs[finder.problem.held] = 0.0
        found, _ = dgbtrs(self._factor, width, width, -rhs, self._pivots)
        found[finder.problem.held | finder.replaced] = 0.0
        if coordinates is not None:
            found[coordinates, np.arange(len(coordinates))] = 1.0
        return np.stack([finder.turned(column) for column in found.T], axis=1)

    def _forces(self, moved: Array) -> Array:
        """Return what taut ties carry more when the nodes move, ``(n_tie, n)`` [N]."""
        ties = self._system.ties
        direction = ties.state(self._system.position).direction
        ends = moved.reshape(-1, 6, moved.shape[1])[ties.nodes, :3]
        apart = np.einsum("in,nik->nk", direction, ends[:, 0] - ends[:, 1])
        return ties.stiffness[:, None] * apart
