"""Assembly into banded and compressed storage, and the banded Cholesky factor.

Numbering nodes along the track, whatever wire they belong to, keeps the band narrow (semi-bandwidth
17 for two wires on common stations); LAPACK's banded Cholesky then beats general sparse
factorisations by an order of magnitude.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.network.system import PartMatrices, System

if TYPE_CHECKING:
    from scipy.sparse import csr_array

Array = NDArray[Any]
Index = NDArray[np.int64]


class Pattern:
    """Where the entries of element matrices go; computed once per line.

    Parameters
    ----------
    system
        The line; only its connectivity and fixed degrees of freedom are used.
    """

    def __init__(self, system: System) -> None:
        self.size = system.dof_count
        self.fixed = np.asarray(system.fixed)
        parts = (system.cables, system.ties, system.clamps, system.stays, system.grounds)
        groups = [_pairs(part.dofs) for part in parts]
        self.rows: Index = np.concatenate([g[0] for g in groups])
        self.cols: Index = np.concatenate([g[1] for g in groups])
        self.bandwidth = int(np.abs(self.rows - self.cols).max(initial=0))
        free = ~(self.fixed[self.rows] | self.fixed[self.cols])
        self._upper = np.flatnonzero((self.rows <= self.cols) & free)
        rows, cols = self.rows[self._upper], self.cols[self._upper]
        self._flat = (self.bandwidth + rows - cols) * self.size + cols

    def values(self, parts: PartMatrices) -> Array:
        """Return the entries of all element matrices in the order of ``rows`` and ``cols``."""
        return np.concatenate(
            [
                parts.cables.ravel(),
                _between(parts.ties).ravel(),
                _between(parts.clamps).ravel(),
                parts.stays.ravel(),
                parts.grounds.ravel(),
            ]
        )

    def upper_band(self, values: Array, diagonal: Array | None = None) -> Array:
        """Sum entries into LAPACK upper banded storage; fixed rows become the identity.

        Parameters
        ----------
        values
            Entries in the order of ``rows`` and ``cols``.
        diagonal : (n_dof,), optional
            Added to the diagonal of the free degrees of freedom.

        Returns
        -------
        (bandwidth + 1, n_dof)
        """
        height = self.bandwidth + 1
        band = np.bincount(
            self._flat, weights=values[self._upper], minlength=height * self.size
        ).reshape(height, self.size)
        if diagonal is not None:
            band[-1] += np.where(self.fixed, 0.0, diagonal)
        band[-1, self.fixed] = 1.0
        return band

    def csr(self, values: Array, diagonal: Array | None = None) -> csr_array:
        """Sum entries into a compressed sparse row matrix; fixed degrees of freedom are kept."""
        from scipy.sparse import coo_array, diags_array

        matrix = coo_array((values, (self.rows, self.cols)), shape=(self.size, self.size)).tocsr()
        if diagonal is not None:
            matrix = matrix + diags_array(diagonal)
        return matrix.tocsr()


def _between(b: Array) -> Array:
    """Return ``[[B, -B], [-B, B]]`` of parts between two nodes, ``(6, 6, n)``."""
    return np.concatenate([np.concatenate([b, -b], 1), np.concatenate([-b, b], 1)], 0)


def _pairs(dofs: Index) -> tuple[Index, Index]:
    """Return row and column index of every entry of dense element matrices over ``(m, n)`` dofs."""
    m, n = dofs.shape
    rows = np.broadcast_to(dofs[:, None], (m, m, n)).ravel()
    cols = np.broadcast_to(dofs[None, :], (m, m, n)).ravel()
    return rows, cols


@dataclass(frozen=True, eq=False)
class BandedCholesky:
    """Cholesky factor ``A = U' U`` of a symmetric positive definite banded matrix.

    Attributes
    ----------
    factor : (bandwidth + 1, n)
        LAPACK upper banded storage.
    """

    factor: Array

    @classmethod
    def of(cls, band: Array) -> BandedCholesky | None:
        """Factorise upper banded storage; None when the matrix is not positive definite."""
        from scipy.linalg.lapack import dpbtrf  # pyright: ignore[reportAttributeAccessIssue]

        factor, info = dpbtrf(np.asfortranarray(band), lower=0)
        return None if info else cls(factor)

    def solve(self, rhs: Array) -> Array:
        """Solve for one ``(n,)`` or several ``(n, m)`` right-hand sides."""
        from scipy.linalg.lapack import dpbtrs  # pyright: ignore[reportAttributeAccessIssue]

        solution, info = dpbtrs(self.factor, rhs, lower=0)
        if info:
            raise ValueError(f"banded solve refused its arguments (LAPACK info {info})")
        return solution
