"""The touched point of the contact wire and the gradient of its height."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from tautwire.numerics.contact.path import ContactWirePath
from tautwire.numerics.elements.hermite import position_row

LENGTHS = np.array([0.7, 0.55, 0.9, 0.7])


def wavy_wire() -> tuple[ContactWirePath, NDArray[np.float64]]:
    """Return a wire of four elements with slopes in all directions."""
    rng = np.random.default_rng(21)
    q = np.zeros((5, 6))
    q[:, 0] = np.concatenate([[0.0], np.cumsum(LENGTHS)])
    q[:, 3] = 1.0
    q += 0.03 * rng.normal(size=q.shape)
    return ContactWirePath(np.arange(5), LENGTHS), q.ravel()


@pytest.mark.parametrize("x", [0.1, 0.9, 1.6, 2.7])
def test_point_lies_at_the_position_asked_for(x: float) -> None:
    """The local coordinate solves x(xi) = x to 1e-12 m and the height is z(xi) there (eq. 9)."""
    path, q = wavy_wire()
    point = path.locate(q, x)
    assert point is not None
    row = position_row(point.xi, LENGTHS[point.element])
    assert row @ q[point.dofs_x] == pytest.approx(x, abs=1e-12)
    assert point.height == pytest.approx(float(row @ q[point.dofs_z]), abs=1e-15)
    assert 0.0 <= point.xi <= 1.0


@pytest.mark.parametrize("x", [0.1, 0.9, 1.6, 2.7])
def test_gradient_of_the_height_includes_the_shift_of_the_point(x: float) -> None:
    """dz/dq = S on z and -(z'/x') S on x (theory, section 4): equal to central differences
    along random directions to 1e-7."""
    path, q = wavy_wire()
    point = path.locate(q, x)
    assert point is not None
    gradient = np.zeros(len(q))
    gradient[point.dofs_z] = point.row
    gradient[point.dofs_x] = -point.slope * point.row
    for seed in range(3):
        u = np.random.default_rng(seed).normal(size=len(q))
        ahead, behind = path.locate(q + 1e-6 * u, x), path.locate(q - 1e-6 * u, x)
        assert ahead is not None
        assert behind is not None
        difference = (ahead.height - behind.height) / 2e-6
        assert gradient @ u == pytest.approx(difference, rel=1e-7, abs=1e-8)


def test_hint_does_not_change_the_point() -> None:
    """Wherever the search starts, the same point is found; a hint off the wire is harmless."""
    path, q = wavy_wire()
    found = {path.locate(q, 1.6, hint).element for hint in range(-1, 7)}  # type: ignore[union-attr]
    assert len(found) == 1


def test_the_ends_belong_to_the_wire_and_nothing_beyond_does() -> None:
    """Both end nodes can be touched; a position beyond them gives None, not an extrapolation."""
    path, q = wavy_wire()
    first, last = q[0], q[24]
    start, end = path.locate(q, first), path.locate(q, last)
    assert start is not None
    assert end is not None
    assert (start.element, start.xi) == (0, pytest.approx(0.0, abs=1e-14))
    assert (end.element, end.xi) == (3, pytest.approx(1.0, abs=1e-14))
    assert path.locate(q, first - 1e-9) is None
    assert path.locate(q, last + 1e-9) is None
