"""Inertia of banded matrices, and the banded LU factor, against dense algebra."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tautwire.numerics.vibration.eigen import BandedLU, negative_eigenvalues


def banded(size: int, width: int, seed: int, *, is_complex: bool = False) -> Any:
    """Return a random symmetric matrix, dense and in upper banded storage."""
    random = np.random.default_rng(seed)
    dense = random.standard_normal((size, size))
    if is_complex:
        dense = dense + 1j * random.standard_normal((size, size))
    dense = np.triu(np.tril(dense + dense.T, width), -width)
    band = np.zeros((width + 1, size), dtype=dense.dtype)
    for offset in range(width + 1):
        band[width - offset, offset:] = np.diagonal(dense, offset)
    return dense, band


@pytest.mark.parametrize(("size", "width"), [(1, 0), (7, 1), (40, 3), (41, 17), (100, 17), (5, 9)])
@pytest.mark.parametrize("seed", range(5))
def test_inertia(size: int, width: int, seed: int) -> None:
    """Block pivots have as many negative eigenvalues as the matrix (Sylvester)."""
    dense, band = banded(size, min(width, size - 1), seed)
    count, is_sure = negative_eigenvalues(band)
    assert is_sure
    assert count == int((np.linalg.eigvalsh(dense) < 0.0).sum())


def test_inertia_does_not_depend_on_units() -> None:
    """Rows and columns of other sizes (slopes beside translations) leave the count."""
    dense, band = banded(60, 5, 1)
    scale = 10.0 ** np.random.default_rng(2).uniform(-6.0, 6.0, 60)
    scaled = np.zeros_like(band)
    for offset in range(6):
        values = np.diagonal(dense * scale * scale[:, None], offset)
        scaled[5 - offset, offset:] = values
    assert negative_eigenvalues(scaled)[0] == negative_eigenvalues(band)[0]


def test_singular_pivot_is_not_sure() -> None:
    """A matrix that is singular to rounding is told."""
    band = np.zeros((2, 6))
    band[1] = 1.0
    band[1, 3] = 0.0
    band[0, 1:] = 1e-20
    assert not negative_eigenvalues(band)[1]


@pytest.mark.parametrize("is_complex", [False, True])
def test_banded_solve(is_complex: bool) -> None:
    """The banded LU solves indefinite and complex symmetric systems, one or several at once."""
    dense, band = banded(50, 6, 4, is_complex=is_complex)
    factor = BandedLU.of(band)
    assert factor is not None
    rhs: NDArray[Any] = np.random.default_rng(0).standard_normal((50, 3)).astype(dense.dtype)
    assert factor.solve(rhs) == pytest.approx(np.linalg.solve(dense, rhs), rel=1e-9)
    assert factor.solve(rhs[:, 0]) == pytest.approx(np.linalg.solve(dense, rhs[:, 0]), rel=1e-9)


def test_singular_matrix_has_no_factor() -> None:
    """A row of zeros is reported, not divided by."""
    _, band = banded(10, 2, 0)
    band[:, 4] = 0.0
    band[1, 5] = band[0, 6] = 0.0
    assert BandedLU.of(band) is None
