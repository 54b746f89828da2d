"""Assembly of a whole line: banded against dense, tangent and damping against derivatives."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from tautwire.numerics.network.banded import BandedCholesky, Pattern
from tautwire.numerics.network.parts import (
    BOTH_WAYS,
    COMPRESSION_ONLY,
    TENSION_ONLY,
    Clamps,
    Grounds,
    Rayleigh,
    Stays,
)
from tautwire.numerics.network.system import (
    System,
    internal_force,
    lumped_mass,
    mass_parts,
    tangent_parts,
    tie_axial_force,
    weight_load,
)

from ..lines import ac_simple, found, potential_energy, rope

STEP = 1e-30


@cache
def line() -> System:
    """Return two spans of AC simple at rest."""
    return found(ac_simple(line__spans=2))[2]


@cache
def sprung_line() -> System:
    """Return two spans of AC simple whose supports are springs of 300 N/m with 5 Ns/m."""
    spring = {"stiffness": 300.0, "damping": 5.0}
    return found(ac_simple(line__spans=2, supports__closure="spring", supports__spring=spring))[2]


def dense(pattern: Pattern, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Add every entry of the element matrices to a dense matrix, one by one."""
    matrix = np.zeros((pattern.size, pattern.size))
    np.add.at(matrix, (pattern.rows, pattern.cols), values)
    return matrix


def moved_state(system: System) -> NDArray[np.float64]:
    """Return coordinates away from equilibrium."""
    rng = np.random.default_rng(11)
    return system.position + 1e-3 * rng.normal(size=system.dof_count)


def test_band_of_the_line_is_17() -> None:
    """Numbered along the track with both wires side by side, the semi-bandwidth is 17."""
    assert Pattern(line()).bandwidth == 17


def test_compressed_storage_equals_dense_assembly() -> None:
    """The CSR matrix is the sum of the element matrices, with the diagonal added."""
    system = line()
    pattern = Pattern(system)
    values = pattern.values(mass_parts(system))
    expected = dense(pattern, values) + np.diag(lumped_mass(system))
    assert np.allclose(pattern.csr(values, lumped_mass(system)).toarray(), expected, atol=1e-15)


def test_banded_storage_equals_dense_assembly() -> None:
    """Banded storage holds the free rows of the dense matrix; fixed rows are the identity."""
    system = line()
    pattern = Pattern(system)
    values = pattern.values(tangent_parts(system, system.position))
    diagonal = np.linspace(1.0, 2.0, system.dof_count)
    band = pattern.upper_band(values, diagonal)
    expected = dense(pattern, values) + np.diag(diagonal)
    expected[system.fixed] = 0.0
    expected[:, system.fixed] = 0.0
    expected[system.fixed, system.fixed] = 1.0
    unfolded = np.zeros_like(expected)
    for offset in range(pattern.bandwidth + 1):
        row = band[pattern.bandwidth - offset, offset:]
        unfolded += np.diag(row, offset) + (np.diag(row, -offset) if offset else 0.0)
    assert np.allclose(unfolded, expected, rtol=1e-14, atol=1e-6)


def test_banded_cholesky_solves_like_dense() -> None:
    """The banded factor solves for one and for several right-hand sides like a dense solver."""
    system = line()
    pattern = Pattern(system)
    values = pattern.values(tangent_parts(system, system.position))
    factor = BandedCholesky.of(pattern.upper_band(values))
    free = np.flatnonzero(~system.fixed)
    matrix = dense(pattern, values)[np.ix_(free, free)]
    rhs = np.zeros((system.dof_count, 2))
    rhs[free] = np.random.default_rng(12).normal(size=(len(free), 2))
    assert factor is not None
    x = factor.solve(rhs)
    expected = np.linalg.solve(matrix, rhs[free])
    assert np.abs(x[free] - expected).max() <= 1e-7 * np.abs(expected).max()
    assert np.array_equal(x[:, 0], factor.solve(rhs[:, 0]))
    assert np.abs(x[system.fixed]).max() == 0.0


def test_indefinite_matrix_is_reported() -> None:
    """A matrix that is not positive definite has no Cholesky factor: None, never a wrong one."""
    assert BandedCholesky.of(np.array([[0.0, 2.0], [1.0, 1.0]])) is None


@pytest.mark.parametrize("system", [line, sprung_line])
def test_line_tangent_is_the_derivative_of_the_internal_force(system: object) -> None:
    """K u = dQ along random u by complex step, for wires, droppers, arms and springs at once."""
    assert callable(system)
    s: System = system()
    q = moved_state(s)
    u = np.random.default_rng(13).normal(size=s.dof_count)
    pattern = Pattern(s)
    k = pattern.csr(pattern.values(tangent_parts(s, q, pushing=True)))
    derivative = internal_force(s, q + 1j * STEP * u, slackening=False).nodal.imag / STEP
    assert np.abs(k @ u - derivative).max() <= 1e-9 * np.abs(derivative).max()


def test_slack_droppers_carry_nothing() -> None:
    """A dropper shorter than its unstrained length pulls with 0 N; a taut one with k (l - L0)."""
    s = line()
    elongation = s.ties.state(s.position).length - s.ties.length
    longer = s.ties.length + np.where(np.arange(18) % 2, 0.1, 0.0)
    slack = s.with_(ties=s.ties.with_(length=longer))
    force = tie_axial_force(slack, s.position)
    assert (force[1::2] == 0.0).all()
    assert np.allclose(force[::2], 2e5 * elongation[::2], rtol=1e-12)


def test_dropper_damping_is_the_rate_of_its_elastic_force() -> None:
    """The damping share is b_R k dl/dt: b_R times the rate of the elastic force, only while taut
    (theory, section 4)."""
    s = line().with_(damping=Rayleigh(stiffness=1e-4))
    v = np.random.default_rng(14).normal(size=s.dof_count)
    state = s.ties.state(s.position + 1j * STEP * v)
    elastic = s.ties.stiffness * (state.length - s.ties.length)
    expected = np.maximum(elastic.real + 1e-4 * elastic.imag / STEP, 0.0)
    assert np.allclose(tie_axial_force(s, s.position, v), expected, rtol=1e-12)
    assert (tie_axial_force(s, s.position, 1e4 * v) >= 0.0).all()


def test_mass_of_the_line_is_complete() -> None:
    """A uniform motion in z feels the mass of wires, clamps, droppers and a third of each arm.

    An arm turns about its far end: its wire end carries m/3 of a bar of mass m.
    """
    case = ac_simple(line__spans=2)
    _, shape, s = found(case)
    pattern = Pattern(s)
    matrix = pattern.csr(pattern.values(mass_parts(s)), lumped_mass(s))
    up = np.zeros(s.dof_count)
    up[2::6] = 1.0
    wires = s.cables.mass @ s.cables.length
    droppers = 0.117 * shape.dropper_lengths_unstrained.sum() + 18 * (0.165 + 0.195)
    arm = 0.73 * 1.22 / 3.0
    assert up @ (matrix @ up) == pytest.approx(wires + droppers + arm, rel=1e-12)


def test_weight_of_wires_and_droppers() -> None:
    """The vertical loads of wires and droppers add up to their weight."""
    s = line()
    load = weight_load(s, 9.81)
    mass = s.cables.mass @ s.cables.length + 0.117 * s.ties.length.sum()
    assert load[2::6].sum() == pytest.approx(-9.81 * mass, rel=1e-12)


def test_static_state_of_the_line_is_in_balance() -> None:
    """The shape that was found is an equilibrium of the equations of motion, to 1e-4 N."""
    for s in (line(), sprung_line()):
        r = internal_force(s, s.position).nodal - s.load
        assert np.abs(r[~s.fixed]).max() <= 1e-4


def knotted_line() -> System:
    """Return a line with everything that a system can hold, at a state without symmetry."""
    s = line()
    count = s.node_count
    random = np.random.default_rng(11)
    hosts = np.array([4, 4, 9])
    matrix = random.normal(size=(2, 3, 3))
    stays = Stays(
        node=np.array([6, 6, 12]),
        end=random.normal(size=(3, 3)) + s.position.reshape(-1, 6)[[6, 6, 12], :3],
        length=np.array([0.1, 9.0, 0.2]),
        stiffness=np.array([2e3, 3e3, 4e3]),
        mass=np.array([1.0, 0.0, 2.0]),
        law=np.array([TENSION_ONLY, COMPRESSION_ONLY, BOTH_WAYS]),
    )
    twice = s.ties.nodes[[0, 0]] + np.array([[0, 0], [0, 2]])
    ties = rope(0, 1, length=1.0, stiffness=1.0).with_(nodes=twice, law=np.array([0, 2]))
    ties = ties.with_(
        **{n: np.tile(getattr(ties, n), 2) for n in ("length", "stiffness", "axial", "mass")}
    )
    return s.with_(
        clamps=Clamps(
            np.stack([hosts, np.array([7, 11, 14])], axis=1),
            np.array([1e4, 2e4, 3e4]),
            random.normal(size=(3, 3)),
        ),
        stays=stays,
        ties=ties.with_(length=np.array([0.5, 9.0]), stiffness=np.array([3e4, 2e3])),
        grounds=Grounds(
            np.array([3, 3]),
            matrix @ np.swapaxes(matrix, 1, 2),
            np.zeros((2, 3, 3)),
            random.normal(size=(2, 3)),
        ),
        position=s.position + 1e-3 * random.normal(size=6 * count),
    )


def test_tangent_of_clamps_stays_and_grounds_is_the_derivative_of_their_force() -> None:
    """K u is the complex-step derivative of Q with clamps that share a node, stays of every law,
    full 3x3 grounds and several ties at one node."""
    s = knotted_line()
    u = np.random.default_rng(12).normal(size=s.dof_count)
    pattern = Pattern(s)
    k = pattern.csr(pattern.values(tangent_parts(s, s.position)))
    derivative = internal_force(s, s.position + 1j * STEP * u).nodal.imag / STEP
    assert np.abs(k @ u - derivative).max() <= 1e-9 * np.abs(derivative).max()


def test_force_of_every_part_is_the_gradient_of_its_energy() -> None:
    """Q - load is the gradient of the potential energy, clamps, stays, grounds and ties included
    (central differences)."""
    s = knotted_line()
    u = np.random.default_rng(13).normal(size=s.dof_count)
    rate = (
        potential_energy(s, s.position + 1e-6 * u) - potential_energy(s, s.position - 1e-6 * u)
    ) / 2e-6
    force = internal_force(s, s.position).nodal - s.load
    assert force @ u == pytest.approx(rate, rel=1e-7)
