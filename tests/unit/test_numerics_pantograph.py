"""The pantograph chain and its exact elimination over a time step."""

from __future__ import annotations

import numpy as np
import pytest

from tautwire.numerics.motion.pantograph import PantographChain, PantographStep
from tautwire.numerics.motion.stepper import PantographInput, RoofMotion
from tautwire.numerics.newmark import HHT, Integrator, Newmark

BENCHMARK = PantographChain(
    np.array([7.5, 9.0, 6.0]),
    np.array([7000.0, 15500.0, 160.0]),
    np.array([45.0, 0.1, 100.0]),
)
INTEGRATORS: list[Integrator] = [Newmark(), HHT(-0.05), HHT(-0.3)]


def test_chain_matrix_joins_neighbours_and_the_roof() -> None:
    """Spring i joins stages i and i+1, the last one the roof (theory, section 4)."""
    expected = np.array([[2.0, -2.0, 0.0], [-2.0, 5.0, -3.0], [0.0, -3.0, 8.0]])
    assert np.array_equal(BENCHMARK.chain_matrix(np.array([2.0, 3.0, 5.0])), expected)


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_elimination_equals_the_direct_solution_of_the_step(integrator: Integrator) -> None:
    """Head height, stages and acceleration for any contact force F equal a dense solve of
    M a + (1 + alpha) g - alpha g_n = 0 with g = C v + K z - external + F on the head."""
    rng = np.random.default_rng(31)
    dt, force, force_before = 1e-3, 213.0, 150.0
    z, v, a, load_before, load = rng.normal(size=(5, 3)) * np.array([[1e-2], [1], [9], [99], [99]])
    step = PantographStep(BENCHMARK, integrator, dt)
    z_p, v_p, known = step.predict(z, v, a, step.internal(z, v, load_before), force_before)
    free = step.acceleration(z_p, v_p, known, load)
    end = free - (1.0 + integrator.alpha) * force * step.head_response

    k = BENCHMARK.chain_matrix(BENCHMARK.stiffness)
    c = BENCHMARK.chain_matrix(BENCHMARK.damping)
    head = np.array([1.0, 0.0, 0.0])
    alpha, beta, gamma = integrator.alpha, integrator.beta, integrator.gamma
    g_before = c @ v + k @ z - load_before + force_before * head
    z_known = z + dt * v + dt**2 * (0.5 - beta) * a
    v_known = v + dt * (1.0 - gamma) * a
    matrix = np.diag(BENCHMARK.mass) + (1.0 + alpha) * (gamma * dt * c + beta * dt**2 * k)
    known_force = c @ v_known + k @ z_known - load + force * head
    direct = np.linalg.solve(matrix, alpha * g_before - (1.0 + alpha) * known_force)
    assert np.allclose(end, direct, rtol=1e-10, atol=1e-10)
    head_free = z_p[0] + beta * dt**2 * free[0]
    head_direct = z_known[0] + beta * dt**2 * direct[0]
    assert head_free - step.compliance * force == pytest.approx(head_direct, rel=1e-12)


def test_compliance_of_a_short_step_is_that_of_the_head_mass() -> None:
    """As dt goes to 0 the head answers like a free mass: compliance = beta dt^2/m."""
    step = PantographStep(BENCHMARK, Newmark(), 1e-6)
    assert step.compliance == pytest.approx(0.25e-12 / 7.5, rel=1e-4)


def test_uplift_force_grows_along_half_a_cosine() -> None:
    """The forces are 0 at the start, half after half the ramp, whole after it, stage by stage."""
    given = PantographInput(BENCHMARK, 1.0, 5.0, 5.3, 80.0, np.array([0.0, 0.0, 120.0]), 0.5)
    times = (0.5, 1.0, 1.25, 1.5, 9.0)
    loads = np.array([given.external(t) for t in times])
    assert np.allclose(loads[:, 2], [0.0, 0.0, 60.0, 120.0, 120.0], atol=1e-12)
    assert np.abs(loads[:, :2]).max() == 0.0
    assert given.position(2.0) == pytest.approx(85.0)


def test_roof_motion_pulls_through_the_last_spring_and_damper() -> None:
    """A moving roof acts on the lowest stage as k h + c dh/dt, counted from the entry."""
    roof = RoofMotion(np.array([0.0, 1.0, 3.0]), np.array([0.0, 0.02, 0.0]))
    given = PantographInput(BENCHMARK, 1.0, 5.0, 5.3, 80.0, np.zeros(3), 0.0, roof)
    assert given.external(1.5)[2] == pytest.approx(160.0 * 0.01 + 100.0 * 0.02)
    assert given.external(3.0)[2] == pytest.approx(160.0 * 0.01 - 100.0 * 0.01)
    assert given.external(9.0)[2] == pytest.approx(0.0, abs=1e-12)
    assert given.external(9.0)[:2].tolist() == [0.0, 0.0]
