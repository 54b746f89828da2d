"""The touched point of the contact wire and the gradient of its height."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from tautwire.numerics.contact.path import ContactWirePath
from tautwire.numerics.elements.hermite import position_row
from tautwire.numerics.track import Frames, Track

LENGTHS = np.array([0.7, 0.55, 0.9, 0.7])


def wavy_wire() -> tuple[ContactWirePath, NDArray[np.float64]]:
    """Return a wire of four elements with slopes in all directions."""
    rng = np.random.default_rng(21)
    q = np.zeros((5, 6))
    q[:, 0] = np.concatenate([[0.0], np.cumsum(LENGTHS)])
    q[:, 3] = 1.0
    q += 0.03 * rng.normal(size=q.shape)
    return ContactWirePath(np.arange(5), LENGTHS), q.ravel()


def across(x: float) -> Frames:
    """Return the plane across a straight track at x."""
    return Track.straight().frames(x)


def inclined(s: float) -> Frames:
    """Return the plane across a canted track that bends and rises."""
    level = np.full((1, 2), 1.0)
    climb = np.array([[0.0], [0.01], [0.02], [0.0]])
    return Track(np.array([0.0, 10.0]), 0.02 * level, 0.1 * level, climb, np.zeros(3)).frames(s)


@pytest.mark.parametrize("plane", [across(1.6), inclined(1.6), inclined(0.4)])
def test_push_is_one_newton_normal_to_the_rails(plane: Frames) -> None:
    """The nodal loads of a unit of contact force are b in sum and do the work of the height of a
    translation along b; a translation across b does none."""
    path, q = wavy_wire()
    point = path.locate(q, plane)
    assert point is not None
    assert point.push[::2].sum(axis=0) == pytest.approx(plane.axes[2], abs=1e-12)
    work = (plane.axes @ point.push[::2].sum(axis=0)).tolist()
    assert work == pytest.approx([0.0, 0.0, 1.0], abs=1e-12)


@pytest.mark.parametrize("x", [0.1, 0.9, 1.6, 2.7])
def test_point_lies_at_the_position_asked_for(x: float) -> None:
    """The local coordinate solves x(xi) = x to 1e-12 m and the height is z(xi) there (eq. 9)."""
    path, q = wavy_wire()
    point = path.locate(q, across(x))
    assert point is not None
    row = position_row(point.xi, LENGTHS[point.element])
    assert row @ q[point.dofs] == pytest.approx([x, point.lateral, point.height], abs=1e-12)
    assert 0.0 <= point.xi <= 1.0


@pytest.mark.parametrize("plane", [across(0.1), across(0.9), across(2.7), inclined(1.6)])
def test_gradient_of_the_height_includes_the_shift_of_the_point(plane: Frames) -> None:
    """dh/dq = S (b - (r'.b / r'.t) t) (theory, section 10): equal to central differences along
    random directions to 1e-7, in planes across a straight track and across an inclined one."""
    path, q = wavy_wire()
    point = path.locate(q, plane)
    assert point is not None
    gradient = np.zeros(len(q))
    gradient[point.dofs] = point.gradient
    for seed in range(3):
        u = np.random.default_rng(seed).normal(size=len(q))
        ahead, behind = path.locate(q + 1e-6 * u, plane), path.locate(q - 1e-6 * u, plane)
        assert ahead is not None
        assert behind is not None
        difference = (ahead.height - behind.height) / 2e-6
        assert gradient @ u == pytest.approx(difference, rel=1e-7, abs=1e-8)


def test_hint_does_not_change_the_point() -> None:
    """Wherever the search starts, the same point is found; a hint off the wire is harmless."""
    path, q = wavy_wire()
    found = {path.locate(q, across(1.6), hint).element for hint in range(-1, 7)}  # type: ignore[union-attr]
    assert len(found) == 1


def test_the_ends_belong_to_the_wire_and_nothing_beyond_does() -> None:
    """Both end nodes can be touched; a position beyond them gives None, not an extrapolation."""
    path, q = wavy_wire()
    first, last = q[0], q[24]
    start, end = path.locate(q, across(first)), path.locate(q, across(last))
    assert start is not None
    assert end is not None
    assert (start.element, start.xi) == (0, pytest.approx(0.0, abs=1e-14))
    assert (end.element, end.xi) == (3, pytest.approx(1.0, abs=1e-14))
    assert path.locate(q, across(first - 1e-9)) is None
    assert path.locate(q, across(last + 1e-9)) is None
