"""Small kernels: bar, Hermite rows, quadrature, node rotation."""

from __future__ import annotations

import numpy as np
import pytest

from tautwire.numerics.elements.bar import bar_state, bar_tangent
from tautwire.numerics.elements.hermite import derivative_tables, position_row, slope_row
from tautwire.numerics.elements.quadrature import gauss_unit
from tautwire.numerics.motion.corotation import NodeRotation, unit_tangents

STEP = 1e-30


def test_bar_direction_and_length() -> None:
    """The direction points from b to a with unit length; a 3-4-12 bar is 13 long."""
    state = bar_state(np.array([[3.0], [4.0], [12.0]]), np.zeros((3, 1)))
    assert state.length[0] == pytest.approx(13.0, rel=1e-15)
    assert np.allclose(state.direction[:, 0], np.array([3.0, 4.0, 12.0]) / 13.0, rtol=1e-15)


def test_bar_tangent_is_the_derivative_of_its_force() -> None:
    """k t t' + N/l (I - t t') equals the complex-step derivative of k (l - L0) t to 1e-9."""
    rng = np.random.default_rng(7)
    a, b = rng.normal(size=(2, 3, 6))
    k, rest = rng.uniform(1e3, 1e5, 6), rng.uniform(0.5, 1.5, 6)
    state = bar_state(a, b)
    block = bar_tangent(state, k, k * (state.length - rest))
    for i in range(3):
        moved = a.astype(complex)
        moved[i] += 1j * STEP
        there = bar_state(moved, b)
        column = (k * (there.length - rest) * there.direction).imag / STEP
        assert np.abs(column - block[:, i]).max() <= 1e-9 * np.abs(block).max()


def test_bar_tangent_is_invariant_to_the_order_of_its_ends() -> None:
    """Exchanging the ends of a bar leaves the block of its tangent unchanged."""
    rng = np.random.default_rng(8)
    a, b = rng.normal(size=(2, 3, 4))
    k, axial = np.full(4, 2e5), np.full(4, 50.0)
    there, back = bar_state(a, b), bar_state(b, a)
    assert np.array_equal(bar_tangent(there, k, axial), bar_tangent(back, k, axial))


def test_hermite_rows_interpolate_ends_and_slopes() -> None:
    """The rows return r1, r2 at the ends and L0 r1', L0 r2' as slopes there (paper eq. 3)."""
    e = np.array([1.3, -0.4, 2.1, 0.9])
    length = 0.7
    assert position_row(0.0, length) @ e == e[0]
    assert position_row(1.0, length) @ e == pytest.approx(e[2], rel=1e-15)
    assert slope_row(0.0, length) @ e == pytest.approx(length * e[1], rel=1e-15)
    assert slope_row(1.0, length) @ e == pytest.approx(length * e[3], rel=1e-15)


def test_hermite_rows_reproduce_cubics() -> None:
    """A cubic polynomial is interpolated exactly, so the element converges with order 4."""
    length, xi = 0.7, np.linspace(0.0, 1.0, 9)
    cubic = np.polynomial.Polynomial([0.2, -1.0, 3.0, -2.0])
    slope = cubic.deriv()
    e = np.array([cubic(0.0), slope(0.0), cubic(length), slope(length)])
    assert np.allclose(position_row(xi, length) @ e, cubic(length * xi), rtol=0.0, atol=1e-14)


def test_slope_row_is_the_derivative_of_the_position_row() -> None:
    """slope_row = d(position_row)/dxi by complex step."""
    xi = np.linspace(0.0, 1.0, 7)
    derivative = position_row(xi + 1j * STEP, 0.6).imag / STEP
    assert np.allclose(slope_row(xi, 0.6), derivative, rtol=1e-13, atol=1e-15)


def test_derivative_tables_agree_with_the_rows() -> None:
    """r' and L0 r'' on (d, r1', r2') equal the rows' derivatives with d = (r2 - r1)/L0."""
    xi, length = np.linspace(0.0, 1.0, 7), 0.6
    e = np.array([1.3, -0.4, 2.1, 0.9])
    reduced = np.array([(e[2] - e[0]) / length, e[1], e[3]])
    first, second = derivative_tables(xi)
    curvature = slope_row(xi + 1j * STEP, length).imag / STEP @ e
    assert np.allclose(first @ reduced, slope_row(xi, length) @ e / length, rtol=1e-13)
    assert np.allclose(second @ reduced, curvature / length, rtol=1e-12)


@pytest.mark.parametrize("count", [1, 2, 3, 5])
def test_gauss_rule_is_exact_to_its_degree(count: int) -> None:
    """n points integrate polynomials up to degree 2n - 1 on [0, 1] exactly, degree 2n not."""
    points, weights = gauss_unit(count)
    degrees = np.arange(2 * count + 1)
    errors = np.abs(weights @ points[:, None] ** degrees - 1.0 / (degrees + 1.0))
    assert errors[:-1].max() <= 1e-15
    assert errors[-1] > 1e-6
    assert (weights > 0.0).all()


def _tangents(seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    vectors = np.array([1.0, 0.0, 0.0])[:, None] + 0.2 * rng.normal(size=(3, 8))
    return vectors / np.linalg.norm(vectors, axis=0)


def test_rotation_carries_reference_tangents_onto_current_ones() -> None:
    """The rotation of a node maps its reference tangent onto the current one."""
    reference, current = _tangents(1), _tangents(2)
    q = np.concatenate([reference.T, reference.T], axis=1).ravel()
    turned = NodeRotation(reference, current).forward(q).reshape(-1, 2, 3)
    assert np.allclose(turned[:, 0], current.T, rtol=0.0, atol=1e-15)
    assert np.allclose(turned[:, 1], current.T, rtol=0.0, atol=1e-15)


def test_rotation_is_orthogonal_and_smallest() -> None:
    """Backward undoes forward, lengths are kept, and the axis of the rotation does not move."""
    reference, current = _tangents(3), _tangents(4)
    rotation = NodeRotation(reference, current)
    x = np.random.default_rng(5).normal(size=48)
    forward = rotation.forward(x)
    axis = np.cross(reference, current, axis=0).T
    still = np.concatenate([axis, axis], axis=1).ravel()
    assert np.allclose(rotation.backward(forward), x, rtol=0.0, atol=1e-14)
    lengths = np.linalg.norm(forward.reshape(-1, 3), axis=1)
    assert np.allclose(lengths, np.linalg.norm(x.reshape(-1, 3), axis=1), rtol=1e-14)
    assert np.allclose(rotation.forward(still), still, rtol=0.0, atol=1e-15)


def test_unit_tangents_are_the_normalised_slopes() -> None:
    """unit_tangents reads r' of every node and scales it to one."""
    q = np.array([0.0, 0.0, 0.0, 3.0, 4.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 2.0])
    assert np.allclose(unit_tangents(q), np.array([[0.6, 0.0], [0.8, 0.0], [0.0, 1.0]]))
