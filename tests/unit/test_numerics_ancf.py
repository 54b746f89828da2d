"""The ANCF cable element: derivatives, invariance, mass, weight, straight and patch states."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from tautwire.numerics.elements import ancf
from tautwire.numerics.elements.hermite import position_row
from tautwire.numerics.elements.quadrature import gauss_unit

STEP = 1e-30
COUNT = 12


def random_elements() -> tuple[NDArray[np.float64], ancf.CableSection]:
    """Return bent and stretched elements of a contact wire, ``(4, 3, n)``."""
    rng = np.random.default_rng(20240)
    length = rng.uniform(0.3, 1.0, COUNT)
    tangent = np.array([1.0, 0.1, 0.05])[:, None] + 0.1 * rng.normal(size=(3, COUNT))
    e = np.empty((4, 3, COUNT))
    e[0] = rng.normal(size=(3, COUNT))
    e[1] = tangent + 0.1 * rng.normal(size=(3, COUNT))
    e[2] = e[0] + length * (tangent + 0.02 * rng.normal(size=(3, COUNT)))
    e[3] = tangent + 0.1 * rng.normal(size=(3, COUNT))
    return e, ancf.CableSection(length, np.full(COUNT, 15e6), np.full(COUNT, 195e3))


def perturbed(e: NDArray[np.float64], i: int, a: int) -> NDArray[np.complex128]:
    """Return the coordinates with an imaginary step on one of them."""
    moved = e.astype(complex)
    moved[i, a] += 1j * STEP
    return moved


def rotation() -> NDArray[np.float64]:
    """Return a rotation by 2.1 rad about a skew axis (Rodrigues' formula)."""
    axis = np.array([0.3, -0.8, 0.52])
    x, y, z = axis / np.linalg.norm(axis)
    w = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(2.1) * w + (1.0 - np.cos(2.1)) * w @ w


def test_force_is_the_gradient_of_the_energy() -> None:
    """Q = dU/de (paper eq. 5), by complex step to 1e-9 of each element's largest force."""
    e, section = random_elements()
    q = ancf.force(e, section)
    gradient = np.empty_like(q)
    for i in range(4):
        for a in range(3):
            gradient[i, a] = ancf.energy(perturbed(e, i, a), section).imag / STEP
    assert (np.abs(gradient - q) <= 1e-9 * np.abs(q).max(axis=(0, 1))).all()


def test_tangent_is_the_derivative_of_the_force() -> None:
    """K_T = dQ/de (paper eq. 6), by complex step to 1e-9 of each element's largest entry."""
    e, section = random_elements()
    k = ancf.tangent(e, section)
    derivative = np.empty_like(k)
    for i in range(4):
        for a in range(3):
            derivative[:, :, i, a] = ancf.force(perturbed(e, i, a), section).imag / STEP
    assert (np.abs(derivative - k) <= 1e-9 * np.abs(k).max(axis=(0, 1, 2, 3))).all()


def test_length_derivative_is_the_derivative_of_the_force() -> None:
    """K_L = dQ/dL0 at fixed coordinates (paper eq. 6), by complex step to 1e-9 relative."""
    e, section = random_elements()
    k_l = ancf.length_derivative(e, section)
    longer = section._replace(length=section.length + 1j * STEP)
    derivative = ancf.force(e.astype(complex), longer).imag / STEP
    assert (np.abs(derivative - k_l) <= 1e-9 * np.abs(k_l).max(axis=(0, 1))).all()


def test_blocks_change_no_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tangent and length derivative formed 5 elements at a time are those of all 12 at once."""
    e, section = random_elements()
    whole = ancf.tangent(e, section), ancf.length_derivative(e, section)
    monkeypatch.setattr(ancf, "_BLOCK", 5)
    assert np.array_equal(ancf.tangent(e, section), whole[0])
    assert np.array_equal(ancf.length_derivative(e, section), whole[1])


def test_tangent_is_symmetric() -> None:
    """The tangent of an energy is symmetric: K[ia, jb] = K[jb, ia] to 1e-12 relative."""
    e, section = random_elements()
    k = ancf.tangent(e, section)
    assert np.abs(k - k.transpose(2, 3, 0, 1, 4)).max() <= 1e-12 * np.abs(k).max()


def test_translation_changes_nothing() -> None:
    """A translation of 1 m leaves energy and forces unchanged to rounding of the coordinates."""
    e, section = random_elements()
    moved = e.copy()
    moved[[0, 2]] += np.array([1.0, -0.7, 0.4])[:, None]
    assert np.allclose(ancf.energy(moved, section), ancf.energy(e, section), rtol=1e-12)
    q = ancf.force(e, section)
    assert np.abs(ancf.force(moved, section) - q).max() <= 1e-12 * np.abs(q).max()


def test_finite_rotation_turns_the_forces() -> None:
    """A rotation R by 2.1 rad keeps the energy and turns forces and tangent: Q(R e) = R Q(e)."""
    e, section = random_elements()
    r = rotation()
    turned = np.einsum("ab,ibn->ian", r, e)
    assert np.allclose(ancf.energy(turned, section), ancf.energy(e, section), rtol=1e-12)
    q = np.einsum("ab,ibn->ian", r, ancf.force(e, section))
    assert np.abs(ancf.force(turned, section) - q).max() <= 1e-12 * np.abs(q).max()
    k = np.einsum("ab,ibjcn,dc->iajdn", r, ancf.tangent(e, section), r)
    assert np.abs(ancf.tangent(turned, section) - k).max() <= 1e-12 * np.abs(k).max()


def test_element_forces_balance() -> None:
    """Internal forces have no resultant and no moment: sum Q_r = 0, sum r x Q_r + r' x Q_r' = 0."""
    e, section = random_elements()
    q = ancf.force(e, section)
    largest = np.abs(q).max()
    moment = sum(np.cross(e[i], q[i], axis=0) for i in range(4))
    assert np.abs(q[0] + q[2]).max() <= 1e-12 * largest
    assert np.abs(moment).max() <= 1e-11 * largest


def test_rigidly_moved_unstrained_element_is_free_of_force() -> None:
    """A straight unstrained element in any orientation has no strain energy and no force."""
    direction = rotation()[:, 0]
    length = np.array([0.5])
    e = np.stack([np.ones(3), direction, np.ones(3) + 0.5 * direction, direction])[:, :, None]
    section = ancf.CableSection(length, np.array([15e6]), np.array([195.0]))
    assert ancf.energy(e, section)[0] <= 1e-12
    assert np.abs(ancf.force(e, section)).max() <= 1e-7


@pytest.mark.parametrize("stretch", [1.0, 1.0015])
def test_straight_wire_is_safe(stretch: float) -> None:
    """On a straight wire the curvature is 0/0 free: kernels stay finite, bending forces vanish."""
    length = np.array([0.7, 0.5])
    t = np.array([stretch, 0.0, 0.0])[:, None] * np.ones(2)
    e = np.stack([np.zeros((3, 2)), t, length * t, t])
    section = ancf.CableSection(length, np.full(2, 15e6), np.full(2, 195.0))
    q = ancf.force(e, section)
    strain = 0.5 * (stretch**2 - 1.0)
    assert np.isfinite(ancf.tangent(e, section)).all()
    assert np.isfinite(ancf.length_derivative(e, section)).all()
    assert np.abs(q[:, 1:]).max() == 0.0
    assert np.allclose(q[2, 0], 15e6 * strain * stretch, rtol=1e-9, atol=1e-6)


def test_uniform_stretch_passes_the_patch_test() -> None:
    """Unequal elements in one line, uniformly stretched, balance inside and give EA eps |r'|."""
    direction, stretch = rotation()[:, 1], 1.002
    length = np.array([0.3, 0.7, 0.45, 1.1])
    nodes = np.concatenate([[0.0], np.cumsum(length)])[:, None] * direction * stretch
    t = np.broadcast_to(stretch * direction[:, None], (3, 4))
    e = np.stack([nodes[:-1].T, t, nodes[1:].T, t])
    section = ancf.CableSection(length, np.full(4, 15e6), np.full(4, 195.0))
    q = ancf.force(e, section)
    tension = 15e6 * 0.5 * (stretch**2 - 1.0) * stretch
    assert np.abs(q[2, :, :-1] + q[0, :, 1:]).max() <= 1e-6
    assert np.abs(q[3, :, :-1] + q[1, :, 1:]).max() <= 1e-6
    assert np.allclose(q[2, :, -1], tension * direction, rtol=1e-10)
    assert np.allclose(ancf.axial_force(e, section), tension, rtol=1e-10)


def test_mass_matrix_is_the_integral_of_the_shape_functions() -> None:
    """The closed form equals m int S_i S_j dchi by a Gauss rule that is exact for it."""
    length, mass = np.array([0.4, 1.3]), np.array([1.35, 1.08])
    points, weights = gauss_unit(4)
    rows = np.stack([position_row(points, value) for value in length], axis=-1)
    integral = np.einsum("g,gin,gjn->ijn", weights, rows, rows) * (mass * length)
    assert np.allclose(ancf.mass_matrix(length, mass), integral, rtol=1e-13, atol=0.0)


def test_mass_matrix_holds_all_mass() -> None:
    """Moved rigidly, the element has its whole mass: the position entries sum to m L0."""
    length, mass = np.array([0.4, 1.3]), np.array([1.35, 1.08])
    m = ancf.mass_matrix(length, mass)
    assert np.allclose(m[[0, 0, 2, 2], [0, 2, 0, 2]].sum(axis=0), mass * length, rtol=1e-14)


def test_weight_is_the_integral_of_the_shape_functions() -> None:
    """G_i = -m g int S_i dchi by a Gauss rule; the position entries carry all weight."""
    length, mass = np.array([0.4, 1.3]), np.array([1.35, 1.08])
    points, weights = gauss_unit(3)
    rows = np.stack([position_row(points, value) for value in length], axis=-1)
    g = ancf.weight(length, mass, 9.81)
    assert np.allclose(g, -9.81 * np.einsum("g,gin->in", weights, rows) * mass * length)
    assert np.allclose(g[0] + g[2], -9.81 * mass * length, rtol=1e-14)


def test_weight_length_derivative() -> None:
    """dG/dL0 equals the complex-step derivative of G to 1e-12."""
    length, mass = np.array([0.4, 1.3]), np.array([1.35, 1.08])
    derivative = ancf.weight(length + 1j * STEP, mass, 9.81).imag / STEP
    assert np.allclose(ancf.weight_length_derivative(length, mass, 9.81), derivative, rtol=1e-12)


def test_bending_energy_of_a_circular_arc() -> None:
    """A 1 m element bent to a circle of 20 m radius stores EI L/(2 R^2) within 1e-5."""
    radius, length = 20.0, 1.0
    angle = length / radius
    e = np.array(
        [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [radius * np.sin(angle), 0.0, radius * (1.0 - np.cos(angle))],
            [np.cos(angle), 0.0, np.sin(angle)],
        ]
    )[:, :, None]
    section = ancf.CableSection(np.array([length]), np.array([1e-6]), np.array([195.0]))
    assert ancf.energy(e, section)[0] == pytest.approx(195.0 / (2.0 * radius**2), rel=1e-5)
