"""Waves and vibrations of one taut wire against their closed forms (theory, section 9)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.sparse.linalg import eigsh

from tautwire.numerics.motion.stepper import PantographInput
from tautwire.numerics.network.banded import Pattern
from tautwire.numerics.network.system import System, lumped_mass, mass_parts, tangent_parts

from ..lines import CONTACT_WIRE, one_stage, stepper, straight_wire, stretch_under

Array = NDArray[np.float64]
Record = Callable[..., bool]

TENSION, BENDING = CONTACT_WIRE["tension"], CONTACT_WIRE["bending"]
STRETCH = stretch_under(TENSION, CONTACT_WIRE["axial"])
LINE_MASS = CONTACT_WIRE["mass"] / STRETCH
SPEED = float(np.sqrt(TENSION / LINE_MASS))
IMPEDANCE = 2.0 * float(np.sqrt(TENSION * LINE_MASS))
WIRE = "Closed forms, one wire"


def angular_frequency(k: Array, bending: float = BENDING) -> Array:
    """Return omega of the wave number k: omega^2 = (T k^2 + EI k^4)/m, m per stretched length."""
    return np.sqrt((TENSION * k**2 + bending * k**4) / LINE_MASS)


def eigenfrequencies(wire: System, count: int) -> Array:
    """Return the lowest vertical angular frequencies of a wire at rest."""
    pattern = Pattern(wire)
    k = pattern.csr(pattern.values(tangent_parts(wire, wire.position))).tocsc()
    m = pattern.csr(pattern.values(mass_parts(wire)), lumped_mass(wire)).tocsc()
    vertical = np.flatnonzero(~wire.fixed & (np.arange(wire.dof_count) % 3 == 2))
    values = eigsh(
        k[vertical][:, vertical],
        count,
        m[vertical][:, vertical],
        sigma=0.0,
        return_eigenvectors=False,
        v0=np.ones(len(vertical)),
    )
    return np.sqrt(np.sort(values))


def test_frequencies_of_a_tensioned_pinned_beam(record_validation: Record) -> None:
    """The first 20 frequencies of a wire of 50 m equal (n/2L) sqrt(T/m) sqrt(1 + n^2 pi^2 EI /
    (T L^2)) with stretched length and mass per stretched length, to 1e-4."""
    n = np.arange(1, 21)
    exact = n / 100.0 * np.sqrt(TENSION / LINE_MASS)
    exact *= np.sqrt(1.0 + n**2 * np.pi**2 * BENDING / (TENSION * 50.0**2))
    ours = eigenfrequencies(straight_wire(50.0, 70), 20) / (2.0 * np.pi)
    assert np.abs(ours / exact - 1.0).max() <= 1e-4
    for number in (1, 20):
        assert record_validation(
            WIRE,
            f"pinned beam of 50 m, mode {number}",
            ours=ours[number - 1],
            unit="Hz",
            target=exact[number - 1],
            relative=1e-4,
            source="(n/2L) √(T/m) √(1 + n²π²EI/(TL²))",
        )


def test_dispersion_by_bending() -> None:
    """Standing waves down to 0.25 m length, where bending decides, follow omega^2 = (T k^2 +
    EI k^4)/m to 1e-5; curvature per unstrained length makes the stiffness EI/|r'|."""
    k = np.pi / 5.0 * np.arange(1, 41)
    ours = eigenfrequencies(straight_wire(5.0, 400), 40)
    assert np.abs(ours / angular_frequency(k, BENDING / STRETCH) - 1.0).max() <= 1e-5
    assert np.abs(ours / angular_frequency(k) - 1.0).max() <= 1e-3
    assert angular_frequency(k)[-1] / (SPEED * k[-1]) > 2.0


def test_element_converges_with_order_4_in_frequency() -> None:
    """Frequencies of the bare wire converge with order 2 (p + 1 - m) = 4 where bending decides,
    within 0.15 (cubics, m = 2)."""
    exact = float(angular_frequency(np.array([8.0 * np.pi]), BENDING / STRETCH)[0])
    faults = [eigenfrequencies(straight_wire(1.0, n), 8)[-1] / exact - 1.0 for n in (16, 32, 64)]
    order = np.log2(np.array(faults[:-1]) / np.array(faults[1:]))
    assert order == pytest.approx(4.0, abs=0.15)


def travelling_pulse(wire: System, centre: float, width: float) -> tuple[Array, Array]:
    """Return coordinates and velocities of a small Gaussian pulse that runs to the right."""
    q = wire.position.reshape(-1, 6).copy()
    v = np.zeros_like(q)
    x = q[:, 0] - centre
    shape = 1e-3 * np.exp(-((x / width) ** 2))
    slope = -2.0 * x / width**2 * shape
    bend = (4.0 * x**2 / width**4 - 2.0 / width**2) * shape
    q[:, 2], q[:, 5] = shape, STRETCH * slope
    v[:, 2], v[:, 5] = -SPEED * slope, -SPEED * STRETCH * bend
    return q.ravel(), v.ravel()


def test_wave_speed_on_a_bare_wire(record_validation: Record) -> None:
    """A Gaussian pulse runs at sqrt(T/m) within 0.5 % over 50 m: its centroid exactly so, its
    peak a little ahead of it by bending."""
    wire = straight_wire(100.0, 140)
    q, v = travelling_pulse(wire, 25.0, 2.5)
    run = stepper(wire, 1e-3)
    run.start_from(q, v)
    run.advance(round(50.0 / SPEED / 1e-3))
    x, z = run.coordinates.reshape(-1, 6)[:, [0, 2]].T
    centroid = float(x @ z / z.sum())
    top = int(z.argmax())
    parabola = np.polyfit(x[top - 1 : top + 2] - x[top], z[top - 1 : top + 2], 2)
    peak = float(x[top] - parabola[1] / (2.0 * parabola[0]))
    assert record_validation(
        WIRE,
        "wave speed, centroid of a pulse",
        ours=3.6 * (centroid - 25.0) / run.time,
        unit="km/h",
        target=3.6 * SPEED,
        relative=0.005,
        source="√(T/m)",
    )
    assert (centroid - 25.0) / run.time == pytest.approx(SPEED, rel=1e-5)
    assert (peak - 25.0) / run.time == pytest.approx(SPEED, rel=0.005)


def test_frequency_in_time() -> None:
    """A standing wave of 1 m in time has omega of the dispersion relation, shifted by Newmark as
    tan(w dt/2) = omega dt/2, within a phase of 1e-3 after 12 periods."""
    length, dt, steps = 3.0, 2e-4, 400
    wire = straight_wire(length, 60)
    k = 6.0 * np.pi / length
    q = wire.position.reshape(-1, 6).copy()
    q[:, 2] = 1e-5 * np.sin(k * q[:, 0])
    q[:, 5] = 1e-5 * STRETCH * k * np.cos(k * q[:, 0])
    omega = float(angular_frequency(np.array([k]), BENDING / STRETCH)[0])
    shifted = 2.0 / dt * np.arctan(0.5 * omega * dt)
    run = stepper(wire, dt, observed=np.array([6 * 5 + 2]), tolerance=1e-13)
    run.start_from(q.ravel(), np.zeros(wire.dof_count))
    block = run.advance(steps)
    expected = q[5, 2] * np.cos(shifted * block.time)
    assert omega * dt > 0.15
    assert np.abs(block.observed[:, 0] - expected).max() <= 1e-3 * q[5, 2]


def force_at(position: float, velocity: float, force: float, ramp: float) -> PantographInput:
    """Return a pantograph so light that it applies a constant force."""
    return PantographInput(one_stage(1e-4), 0.0, position, 0.0, velocity, np.array([force]), ramp)


def test_point_impedance(record_validation: Record) -> None:
    """A constant force F moves its point of a long wire with F/(2 sqrt(T m)) until the first
    reflection returns, within 0.1 %."""
    run = stepper(straight_wire(100.0, 140), 1e-3, pantographs=(force_at(50.0, 0.0, 20.0, 0.02),))
    block = run.advance(350)
    late = block.time > 0.1
    rate = np.polyfit(block.time[late], block.wire_height[late, 0], 1)[0]
    assert block.contact_force[late, 0] == pytest.approx(20.0, abs=1e-3)
    assert record_validation(
        WIRE,
        "point impedance of a long wire",
        ours=20.0 / rate,
        unit="N s/m",
        target=IMPEDANCE,
        relative=1e-3,
        source="2 √(T m)",
    )


class MovingForce:
    """A force that grows along half a cosine and moves along a pinned beam: modal series.

    Mode n obeys q'' + omega_n^2 q = (2/(m L)) F(t) sin(n pi v t/L); a force of sines is answered
    exactly, so ramp and constant part are joined without numerical integration.
    """

    def __init__(self, length: float, velocity: float, force: float, ramp: float) -> None:
        self.k = np.arange(1, 601)[:, None] * np.pi / length
        self.omega = angular_frequency(self.k)
        self.velocity, self.ramp = velocity, ramp
        pass_by, turn = self.k * velocity, np.pi / ramp
        gain = 2.0 * force / (LINE_MASS * length)
        self._ramp = (
            (0.5 * gain, pass_by, 0.0),
            (-0.25 * gain, pass_by + turn, 0.0),
            (-0.25 * gain, pass_by - turn, 0.0),
        )
        self._constant = ((gain, pass_by, pass_by * ramp),)

    def _answer(self, t: Array, start: tuple[Array, Array], terms: tuple) -> tuple[Array, Array]:
        """Return q and dq/dt at t after a start (q, dq/dt) under sum a sin(f t + phase)."""
        gains = [(a / (self.omega**2 - f**2), f, phase) for a, f, phase in terms]
        q0 = start[0] - sum(g * np.sin(phase) for g, _, phase in gains)
        v0 = start[1] - sum(g * f * np.cos(phase) for g, f, phase in gains)
        c, s = np.cos(self.omega * t), np.sin(self.omega * t)
        q = q0 * c + v0 / self.omega * s + sum(g * np.sin(f * t + p) for g, f, p in gains)
        v = v0 * c - self.omega * q0 * s + sum(g * f * np.cos(f * t + p) for g, f, p in gains)
        return q, v

    def modes(self, time: Array) -> Array:
        """Return the modal amplitudes, ``(n_mode, n_time)``."""
        rest = (np.zeros_like(self.omega),) * 2
        grown = self._answer(np.full((1, 1), self.ramp), rest, self._ramp)
        early = self._answer(time[None], rest, self._ramp)[0]
        late = self._answer(time[None] - self.ramp, grown, self._constant)[0]
        return np.where(time < self.ramp, early, late)

    def under_the_force(self, time: Array) -> Array:
        """Return the height of the wire under the force."""
        return (self.modes(time) * np.sin(self.k * self.velocity * time)).sum(axis=0)

    def along(self, x: Array, time: float) -> Array:
        """Return the shape of the wire at one time."""
        return (self.modes(np.array([time])) * np.sin(self.k * x)).sum(axis=0)


@pytest.mark.parametrize("velocity", [35.0, 60.0])
def test_moving_constant_force(velocity: float, record_validation: Record) -> None:
    """A constant force of 20 N moving along a wire of 50 m lifts the wire under itself, and all
    along it, as the modal series says, within 0.5 % and 2 % of the largest uplift."""
    run = stepper(straight_wire(50.0, 60), 1e-3, pantographs=(force_at(0.0, velocity, 20.0, 0.02),))
    exact = MovingForce(50.0, velocity, 20.0, 0.02)
    block = run.advance(round(30.0 / velocity / 1e-3))
    ours, theirs = block.wire_height[:, 0], exact.under_the_force(block.time)
    x, z = run.coordinates.reshape(-1, 6)[:, [0, 2]].T
    worst = float(np.abs(ours - theirs).max() / theirs.max())
    assert block.contact_force[40:, 0] == pytest.approx(20.0, rel=0.005)
    assert record_validation(
        WIRE,
        f"moving force at {3.6 * velocity:.0f} km/h: uplift under it, largest difference",
        ours=100.0 * worst,
        unit="%",
        allowed=(0.0, 0.5),
        source="modal series",
    )
    assert np.abs(z - exact.along(x, run.time)).max() <= 0.02 * theirs.max()
