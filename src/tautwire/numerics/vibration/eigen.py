"""Undamped vibration ``K phi = omega^2 M phi`` of a line: modes near a target, and their count.

Modes are found by Lanczos iteration on the shifted and inverted problem, with a banded LU factor
of ``K - sigma M``. How many modes lie below a shift follows from the signs of the block pivots of
the same matrix (Sylvester's law of inertia), independently of any iteration, so that a missed
mode shows.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.network.banded import Pattern
from tautwire.numerics.network.system import System, lumped_mass, mass_parts, tangent_parts

if TYPE_CHECKING:
    from scipy.sparse import csr_array

Array = NDArray[np.float64]

_NEARLY_ZERO = 1e-13
"""A pivot smaller than this, in a matrix scaled to a diagonal of 1, may have any sign."""

_NUDGE = 1e-9
"""Relative change of a shift that hits a mode, or whose count is not sure."""

_TINY = 1e-300
"""Stands for a pivot of exactly zero; the count is then not sure anyway."""

_NUDGES = 3
"""Attempts at a shift whose count is sure; one is enough unless modes coincide to 1e-9."""

_LANCZOS_SEED = 20210
"""Of the first vector, so that a computation repeats; any other does as well."""


@dataclass(frozen=True, eq=False)
class Pairs:
    """Some modes of a line, by increasing frequency.

    Attributes
    ----------
    values : (n_mode,) 1/s2
        ``omega^2``.
    vectors : (n_mode, n_dof)
        Mode shapes with ``phi' M phi = 1``; zero where the line is held.
    residuals : (n_mode,)
        ``|K phi - omega^2 M phi| / |K phi|`` (2-norm).
    """

    values: Array
    vectors: Array
    residuals: Array


class Vibration:
    """Stiffness and mass of a line about its static state.

    All droppers are taut (the state is linearised), dampers are left out.

    Parameters
    ----------
    system
        The line; ``system.position`` is its static state.
    """

    def __init__(self, system: System) -> None:
        self._pattern = Pattern(system)
        self._stiffness = self._pattern.values(tangent_parts(system, system.position))
        self._mass = self._pattern.values(mass_parts(system))
        self._lumped = lumped_mass(system)
        self.free = ~np.asarray(system.fixed)

    @property
    def size(self) -> int:
        """Number of degrees of freedom, held ones included."""
        return len(self.free)

    @cached_property
    def stiffness(self) -> csr_array:
        """Tangent stiffness of the free degrees of freedom."""
        return self._pattern.csr(self._stiffness)[self.free][:, self.free]

    @cached_property
    def mass(self) -> csr_array:
        """Mass matrix of the free degrees of freedom."""
        return self._pattern.csr(self._mass, self._lumped)[self.free][:, self.free]

    def shifted_band(self, shift: float) -> Array:
        """Return ``K - shift M`` in LAPACK upper banded storage; held rows are the identity."""
        return self._pattern.upper_band(self._stiffness - shift * self._mass, -shift * self._lumped)

    def count_below(self, shift: float) -> int:
        """Count the modes with ``omega^2 < shift``."""
        negative, is_sure = negative_eigenvalues(self.shifted_band(shift))
        for _ in range(_NUDGES):
            if is_sure:
                break
            shift = _nudged(shift)
            negative, is_sure = negative_eigenvalues(self.shifted_band(shift))
        return negative

    def nearest(self, shift: float, count: int) -> Pairs:
        """Find the modes whose ``omega^2`` is nearest to a shift.

        Parameters
        ----------
        shift
            Target [1/s2].
        count
            Number of modes, less than the number of free degrees of freedom.
        """
        from scipy.sparse.linalg import LinearOperator, eigsh

        solve, shift = self._inverse(shift)
        n = int(self.free.sum())
        operator: Any = LinearOperator
        start = np.random.default_rng(_LANCZOS_SEED).standard_normal(n)
        values, vectors = eigsh(
            self.stiffness,
            k=count,
            M=self.mass,
            sigma=shift,
            OPinv=operator((n, n), matvec=solve, dtype=np.float64),
            v0=start,
            ncv=min(n, 2 * count + 20),  # ARPACK advises twice the count; few modes need more
        )
        return self._sorted(np.asarray(values), np.asarray(vectors))

    def _inverse(self, shift: float) -> tuple[Any, float]:
        """Return a function that solves ``(K - shift M) x = b``, and the shift it holds for."""
        factor = BandedLU.of(self.shifted_band(shift))
        while factor is None:
            shift = _nudged(shift)
            factor = BandedLU.of(self.shifted_band(shift))
        held = np.zeros(self.size)

        def solve(rhs: Array) -> Array:
            held[self.free] = rhs.ravel()
            return factor.solve(held)[self.free]

        return solve, shift

    def _sorted(self, values: Array, vectors: Array) -> Pairs:
        order = np.argsort(values)
        values, vectors = values[order], vectors[:, order]
        vectors = vectors / np.sqrt(np.sum(vectors * (self.mass @ vectors), axis=0))
        forces = self.stiffness @ vectors
        rest = forces - values * (self.mass @ vectors)
        full = np.zeros((len(values), self.size))
        full[:, self.free] = vectors.T
        residuals = np.linalg.norm(rest, axis=0) / np.linalg.norm(forces, axis=0)
        return Pairs(values, full, residuals)

    def orthogonality(self, vectors: Array) -> float:
        """Return the largest entry of ``Phi' M Phi - I``.

        Parameters
        ----------
        vectors : (n_mode, n_dof)
        """
        free = vectors[:, self.free]
        return float(np.abs(free @ (self.mass @ free.T) - np.eye(len(free))).max(initial=0.0))

    def energy_shares(
        self, vectors: Array, group: NDArray[np.int64], count: int, axes: Array
    ) -> Array:
        """Return the share of every group of components in ``phi' M phi``.

        Masses do not couple directions or wires, so the shares of a partition by direction and
        wire are positive and add up to 1.

        Parameters
        ----------
        vectors : (n_mode, n_dof)
        group : (n_dof,)
            Number of the group of each component along the axes, from 0.
        count
            Number of groups; some may be empty.
        axes : (n_node, 3, 3)
            Directions in which a node moves, as rows.

        Returns
        -------
        (n_mode, n_group)
        """
        momentum = np.zeros_like(vectors)
        momentum[:, self.free] = (self.mass @ vectors[:, self.free].T).T
        both = (v.reshape(len(v), len(axes), 2, 3) for v in (vectors, momentum))
        along, moved = (np.einsum("nij,mnaj->mnai", axes, v).reshape(vectors.shape) for v in both)
        energy = along * moved
        shares = [energy[:, group == number].sum(axis=1) for number in range(count)]
        return np.stack(shares, axis=1) / energy.sum(axis=1)[:, None]


def _nudged(shift: float) -> float:
    return shift * (1.0 + _NUDGE) + 1e-12


def negative_eigenvalues(band: Array) -> tuple[int, bool]:
    """Count the negative eigenvalues of a symmetric banded matrix by its block pivots.

    With ``A = L D L'`` (block tridiagonal, blocks as large as the bandwidth) the pivots are
    ``D_i = A_ii - B_i' D_(i-1)^-1 B_i``, and A has as many negative eigenvalues as all D_i
    together.

    Parameters
    ----------
    band : (bandwidth + 1, n)
        LAPACK upper banded storage.

    Returns
    -------
    count : int
    is_sure : bool
        False when some pivot is so close to singular that rounding may have decided its sign.
    """
    diagonals, besides = _blocks(_scaled(band))
    count, is_sure = 0, True
    correction = np.zeros_like(diagonals[0])
    for number, diagonal in enumerate(diagonals):
        values, axes = np.linalg.eigh(diagonal - correction)
        count += int(np.count_nonzero(values < 0.0))
        sizes = np.abs(values)
        is_sure &= bool(sizes.min() > _NEARLY_ZERO * max(1.0, sizes.max()))
        if number < len(besides):
            turned = axes.T @ besides[number]
            correction = turned.T @ (turned / np.where(values == 0.0, _TINY, values)[:, None])
    return count, is_sure


def _scaled(band: Array) -> Array:
    """Scale rows and columns alike to a diagonal of size 1; the inertia stays (congruence).

    Slopes and translations have other units; unscaled, the size of a pivot would say little.
    """
    diagonal = np.abs(band[-1])
    # A diagonal near zero would blow its row up; a thousandth in the scale is small enough.
    scale = 1.0 / np.sqrt(np.maximum(diagonal, 1e-6 * np.abs(band).max(axis=0)))
    result = band * scale
    height = band.shape[0]
    for row in range(height):
        offset = height - 1 - row
        result[row, offset:] *= scale[: len(scale) - offset]
    return result


def _blocks(band: Array) -> tuple[Array, Array]:
    """Return the diagonal blocks and the blocks on their right of a banded matrix.

    Blocks are as large as the bandwidth; the last one is filled up with the identity.

    Returns
    -------
    diagonals : (n_block, width, width)
    besides : (n_block - 1, width, width)
    """
    width = max(1, band.shape[0] - 1)
    count = -(-band.shape[1] // width)
    filled = np.zeros((width + 1, count * width))
    filled[width + 1 - band.shape[0] :, : band.shape[1]] = band
    filled[-1, band.shape[1] :] = 1.0
    i, j = np.arange(width)[:, None], np.arange(width)[None, :]
    start = width * np.arange(count)[:, None, None]
    upper = np.where(j >= i, filled[np.minimum(width - (j - i), width), start + j], 0.0)
    diagonals = upper + np.transpose(np.triu(upper, 1), (0, 2, 1))
    besides = np.where(j <= i, filled[np.maximum(i - j, 0), start[1:] + j], 0.0)
    return diagonals, besides


@dataclass(frozen=True, eq=False)
class BandedLU:
    """LU factor, with partial pivoting, of a symmetric indefinite or complex banded matrix.

    Attributes
    ----------
    factor : (3 bandwidth + 1, n)
        LAPACK general banded storage.
    pivots : (n,)
    """

    factor: NDArray[Any]
    pivots: NDArray[np.int32]

    @classmethod
    def of(cls, band: NDArray[Any]) -> BandedLU | None:
        """Factorise upper banded storage; None when the matrix is singular.

        Parameters
        ----------
        band : (bandwidth + 1, n)
            Upper banded storage of a matrix with ``A' = A`` (not conjugated).
        """
        from scipy.linalg.lapack import get_lapack_funcs

        width = band.shape[0] - 1
        (factorise,) = get_lapack_funcs(("gbtrf",), (band,))
        factor, pivots, info = factorise(_general(band), width, width, overwrite_ab=True)
        return None if info else cls(factor, pivots)

    def solve(self, rhs: NDArray[Any]) -> NDArray[Any]:
        """Solve for one ``(n,)`` or several ``(n, m)`` right-hand sides."""
        from scipy.linalg.lapack import get_lapack_funcs

        width = (self.factor.shape[0] - 1) // 3
        (back_substitute,) = get_lapack_funcs(("gbtrs",), (self.factor,))
        solution, info = back_substitute(self.factor, width, width, rhs, self.pivots)
        if info:
            raise ValueError(f"banded solve refused its arguments (LAPACK info {info})")
        return solution


def _general(band: NDArray[Any]) -> NDArray[Any]:
    """Return upper banded storage as LAPACK general banded storage with room for fill."""
    width, n = band.shape[0] - 1, band.shape[1]
    full = np.zeros((3 * width + 1, n), dtype=band.dtype, order="F")
    full[width : 2 * width + 1] = band
    for offset in range(1, width + 1):
        full[2 * width + offset, : n - offset] = band[width - offset, offset:]
    return full
