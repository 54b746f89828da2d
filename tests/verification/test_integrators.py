"""Newmark and HHT-alpha as coded: amplification, order, equality of HHT(0) and Newmark."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from tautwire.numerics.network.system import System, weight_load
from tautwire.numerics.newmark import HHT, Integrator, Newmark

from ..lines import ac_simple, oscillator, passage, rope, stepper, wire_elements

Array = NDArray[np.float64]
METHODS: list[Integrator] = [Newmark(), HHT(-0.05), HHT(-0.3)]
NAMES = ["newmark", "hht-0.05", "hht-0.3"]


def amplification(method: Integrator, omega_dt: float, damping: float = 0.0) -> Array:
    """Return the matrix A of (q, dt v, dt^2 a) over one step of a linear oscillator.

    From Hilber, Hughes and Taylor 1977, eqs. 1-4, with a viscous damping ratio.
    """
    alpha, beta, gamma = method.alpha, method.beta, method.gamma
    w2, c = omega_dt**2, 2.0 * damping * omega_dt
    left = np.array(
        [
            [1.0, 0.0, -beta],
            [0.0, 1.0, -gamma],
            [(1.0 + alpha) * w2, (1.0 + alpha) * c, 1.0],
        ]
    )
    right = np.array([[1.0, 1.0, 0.5 - beta], [0.0, 1.0, 1.0 - gamma], [alpha * w2, alpha * c, 0]])
    return np.linalg.solve(left, right)


@pytest.mark.parametrize("damping", [0.0, 0.1])
@pytest.mark.parametrize("omega_dt", [0.1, 1.0, 30.0])
@pytest.mark.parametrize("method", METHODS, ids=NAMES)
def test_amplification_matrix(method: Integrator, omega_dt: float, damping: float) -> None:
    """A free oscillator follows the powers of the closed-form amplification matrix to 1e-9."""
    omega, dt, steps = 10.0, omega_dt / 10.0, 40
    system = oscillator(2.0, 2.0 * omega**2, 4.0 * damping * omega)
    q, v = system.position.copy(), np.zeros(system.dof_count)
    q[14], v[14] = 0.01, 0.03
    run = stepper(system, dt, integrator=method, observed=np.array([14]), tolerance=1e-15)
    run.start_from(q, v)
    block = run.advance(steps)
    state = np.array([0.01, dt * 0.03, -(omega_dt**2) * 0.01 - 2 * damping * omega_dt * dt * 0.03])
    expected = []
    for _ in range(steps):
        state = amplification(method, omega_dt, damping) @ state
        expected.append(state[0])
    assert np.abs(block.observed[:, 0] - expected).max() <= 1e-9 * np.abs(expected).max() + 1e-15


def test_newmark_has_no_dissipation() -> None:
    """Average acceleration: spectral radius 1 at every frequency; phase 2 atan(omega dt/2)."""
    for omega_dt in (0.01, 0.5, 2.0, 100.0):
        values = np.linalg.eigvals(amplification(Newmark(), omega_dt))
        principal = values[np.abs(values) > 0.5]
        phase = 2.0 * np.arctan(0.5 * omega_dt)
        assert np.abs(principal) == pytest.approx(1.0, abs=1e-12)
        assert np.abs(np.angle(principal)) == pytest.approx(phase, rel=1e-9)


@pytest.mark.parametrize("alpha", [-0.05, -0.2, -1.0 / 3.0])
def test_hht_dissipates_high_frequencies_only(alpha: float) -> None:
    """HHT: spectral radius (1 + alpha)/(1 - alpha) at infinite frequency and 1 - O((w dt)^3) at
    low ones (Hilber, Hughes and Taylor 1977)."""
    high = np.abs(np.linalg.eigvals(amplification(HHT(alpha), 1e5))).max()
    low = [1.0 - np.abs(np.linalg.eigvals(amplification(HHT(alpha), x))).max() for x in (0.2, 0.1)]
    assert high == pytest.approx((1.0 + alpha) / (1.0 - alpha), rel=1e-3)
    assert 0.0 < low[1] < -alpha * 0.1**3
    assert np.log2(low[0] / low[1]) == pytest.approx(4.0, abs=0.15)


@cache
def pendulum() -> tuple[System, Array]:
    """Return a mass on an elastic string (a dropper) under gravity, and where it starts."""
    base = oscillator(1.0, 0.0)
    free = base.fixed.copy()
    free[12:15] = False
    load = np.zeros(18)
    load[14] = -9.81
    system = base.with_(
        fixed=free,
        load=load,
        ties=rope(1, 2, length=0.9, stiffness=300.0),
    )
    q = system.position.copy()
    q[12:15] = [1.55, 0.2, -0.72]
    return system, q


@cache
def whip() -> tuple[System, Array]:
    """Return a soft wire of two elements, pinned at one end and falling, and its start."""
    wire = wire_elements(np.full(2, 0.5), axial=40.0, bending=0.05, mass=1.0)
    fixed = np.zeros(wire.dof_count, dtype=bool)
    fixed[:3] = True
    return wire.with_(fixed=fixed, load=weight_load(wire, 9.81)), wire.position


@pytest.mark.parametrize("problem", [pendulum, whip])
@pytest.mark.parametrize("method", METHODS, ids=NAMES)
def test_order_on_a_nonlinear_problem(method: Integrator, problem: object) -> None:
    """Halving the step divides the error by 2^order, order 2 within 0.1, on large rotations of an
    elastic pendulum and of a falling wire (self-convergence)."""
    assert callable(problem)
    system, q = problem()
    ends = []
    for dt in (4e-3, 2e-3, 1e-3):
        run = stepper(system, dt, integrator=method, tolerance=1e-13)
        run.start_from(q, np.zeros(system.dof_count))
        run.advance(round(0.2 / dt))
        ends.append(run.coordinates[system.translations])
    change = np.linalg.norm(np.diff(ends, axis=0), axis=1)
    assert np.linalg.norm(ends[-1] - q[system.translations]) > 0.1
    assert np.log2(change[0] / change[1]) == pytest.approx(method.order, abs=0.1)


def test_hht_with_alpha_zero_is_newmark() -> None:
    """On a passage with contact and droppers HHT(0) gives the very same numbers as Newmark."""
    case = ac_simple(line__spans=2, settings__section=[1, 1])
    newmark = passage(case, integrator=Newmark()).advance(150)
    hht = passage(case, integrator=HHT(0.0)).advance(150)
    assert np.array_equal(newmark.contact_force, hht.contact_force)
    assert np.array_equal(newmark.stages, hht.stages)
    assert newmark.contact_force.max() > 100.0


def test_hht_stays_close_to_newmark_at_low_frequency() -> None:
    """On a smooth start HHT(-0.05) and Newmark differ by their second-order errors only: the
    difference falls by about four when the step is halved."""
    differences = []
    for dt in (4e-3, 2e-3):
        case = ac_simple(line__spans=2, settings__section=[1, 1], settings__time_step=dt)
        steps = round(0.2 / dt)
        a = passage(case, integrator=Newmark()).advance(steps)
        b = passage(case, integrator=HHT(-0.05)).advance(steps)
        differences.append(np.abs(a.wire_height - b.wire_height).max())
    assert differences[0] / differences[1] == pytest.approx(4.0, rel=0.3)


def test_alpha_outside_its_range_is_refused() -> None:
    """HHT is unconditionally stable and second order for -1/3 <= alpha <= 0 only."""
    for alpha in (-0.4, 0.1):
        with pytest.raises(ValueError, match="alpha"):
            HHT(alpha)
