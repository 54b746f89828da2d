"""Contact between pantograph and wire: bouncing, roof motion, separation, action and reaction."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from tautwire.numerics.motion.pantograph import PantographChain
from tautwire.numerics.motion.stepper import PantographInput, RoofMotion, StepBlock
from tautwire.numerics.network.system import System
from tautwire.numerics.newmark import HHT, Integrator, Newmark

from ..lines import ac_simple, entering, moved, one_stage, passage, stepper, straight_wire

Array = NDArray[np.float64]


@cache
def rigid_wire() -> System:
    """Return a wire whose middle node cannot move."""
    wire = straight_wire(10.0, 2)
    fixed = np.ones((3, 6), dtype=bool)
    fixed[2, 5] = False
    return wire.with_(fixed=fixed.ravel())


class Bounce:
    """A mass under a constant force F that starts h below a rigid stop with a spring k.

    Free flight under F/m; in contact z = F/k + A sin(omega t + phase) with
    A^2 = (F/k)^2 + (v/omega)^2 and the impact speed v = sqrt(2 F h/m).
    """

    mass, force, gap, stiffness = 7.5, 150.0, 0.02, 5e4

    def __init__(self) -> None:
        omega = np.sqrt(self.stiffness / self.mass)
        sag, reach = self.force / self.stiffness, np.sqrt(2 * self.force * self.gap / self.mass)
        self.impact = float(np.sqrt(2.0 * self.gap * self.mass / self.force))
        self.contact = float(2.0 * (np.pi - np.arctan(reach / omega / sag)) / omega)
        self.flight = 2.0 * self.impact
        self.peak = float(self.force + self.stiffness * np.hypot(sag, reach / omega))

    def computed(self, dt: float, duration: float) -> StepBlock:
        """Return the time integration."""
        given = PantographInput(
            one_stage(self.mass), 0.0, 5.0, -self.gap, 0.0, np.array([self.force]), 0.0
        )
        run = stepper(rigid_wire(), dt, pantographs=(given,), contact_stiffness=self.stiffness)
        return run.advance(round(duration / dt))


def crossings(block: StepBlock) -> Array:
    """Return the times at which the gap changes sign, by linear interpolation."""
    gap, time = block.gap[:, 0], block.time
    i = np.flatnonzero(np.sign(gap[:-1]) != np.sign(gap[1:]))
    return time[i] + (time[i + 1] - time[i]) * gap[i] / (gap[i] - gap[i + 1])


def test_bouncing_mass(record_validation: Callable[..., bool]) -> None:
    """A mass bouncing against a stiff stop: contacts and their peak force within 0.02 %, flights
    within 0.05 %, rebounds within 0.1 % after three impacts; the first impact comes half a step
    late, because a pantograph starts without acceleration."""
    exact, dt = Bounce(), 4e-4
    block = exact.computed(dt, 0.46)
    times = crossings(block)
    durations = np.diff(times)
    peaks = [block.gap[:, 0][(block.time > a) & (block.time < b)].max()
             for a, b in zip(times[1:-1:2], times[2::2], strict=True)]  # fmt: skip
    assert times[0] == pytest.approx(exact.impact + 0.5 * dt, abs=0.1 * dt)
    assert durations[1::2] == pytest.approx(exact.flight, rel=5e-4)
    assert len(peaks) >= 3
    assert peaks == pytest.approx([exact.gap] * len(peaks), rel=1e-3)
    for name, unit, ours, target in (
        ("duration of a contact", "ms", 1e3 * durations[::2].mean(), 1e3 * exact.contact),
        ("peak force", "N", block.contact_force.max(), exact.peak),
    ):
        assert record_validation(
            "Closed forms, contact",
            f"mass bouncing on a stop: {name}",
            ours=float(ours),
            unit=unit,
            target=target,
            relative=2e-4,
            source="free flight and half an oscillation, joined",
        )


def test_force_is_stiffness_times_penetration() -> None:
    """F = k_s max(0, -gap) at every step (paper eq. 9); no force across an open gap."""
    block = Bounce().computed(1e-3, 0.2)
    expected = Bounce.stiffness * np.maximum(0.0, -block.gap)
    assert block.contact_force == pytest.approx(expected, abs=1e-6)
    assert (block.contact_force[block.gap > 0.0] == 0.0).all()
    assert block.contact_force.max() > 0.0


@pytest.mark.parametrize("integrator", [Newmark(), HHT(-0.1)], ids=["newmark", "hht"])
def test_roof_motion_moves_the_force(integrator: Integrator) -> None:
    """Under a wire that cannot move, a roof raised by h adds the stiffness of base, frame, head and
    contact in series times h to the contact force once the pantograph has come to rest."""
    chain = PantographChain(
        np.array([7.5, 9.0, 6.0]),
        np.array([7000.0, 15500.0, 160.0]),
        np.array([450.0, 300.0, 400.0]),
    )
    roof = RoofMotion(np.array([0.0, 0.1]), np.array([0.0, 0.05]))
    lift = np.array([0.0, 0.0, 120.0])
    forces = []
    for given in (None, roof):
        panto = PantographInput(chain, 0.0, 5.0, 0.0, 0.0, lift, 0.1, given)
        run = stepper(rigid_wire(), 8e-3, pantographs=(panto,), integrator=integrator)
        forces.append(run.advance(225).contact_force[-1, 0])
    above = 1.0 / 2e5 + 1.0 / 7000.0 + 1.0 / 15500.0
    assert forces[0] == pytest.approx(120.0 / (1.0 + 160.0 * above), rel=1e-4)
    assert forces[1] - forces[0] == pytest.approx(0.05 / (1.0 / 160.0 + above), rel=1e-3)


def test_moving_roof_is_felt_on_the_line() -> None:
    """A roof that rises by 20 mm within 0.2 s changes the contact force of a passage, and only
    from then on."""
    case = ac_simple(line__spans=2, settings__section=(1, 1))
    table = {"time": [0.0, 0.1, 0.3], "height": [0.0, 0.0, 0.02]}
    rear = case.pantographs[0].with_(roof_motion=table)
    calm = passage(case).advance(300)
    moved_roof = passage(case.with_(pantographs=(rear,))).advance(300)
    change = np.abs(moved_roof.contact_force - calm.contact_force)[:, 0]
    assert change[:99].max() == 0.0
    assert change[150:].max() > 1.0


def test_lowered_pantograph_leaves_the_line_at_rest() -> None:
    """A pantograph that never touches has no force, and the line does not move."""
    case = ac_simple(line__spans=2, settings__section=(1, 1))
    system, (given,) = entering(case)
    low = moved(given, start_height=given.start_height - 0.5, stage_forces=np.zeros(3))
    run = stepper(system, 1e-3, pantographs=(low,), tolerance=1e-12)
    block = run.advance(60)
    assert (block.contact_force == 0.0).all()
    assert block.gap[:, 0].min() > 0.4
    assert np.abs(run.coordinates - system.position).max() <= 1e-9


def test_pantograph_momentum_balance() -> None:
    """Action equals reaction: the momentum of a one-stage pantograph changes by the integral of
    uplift force less contact force, exactly as the trapezoidal rule of Newmark sums it."""
    case = ac_simple(line__spans=2, settings__section=(1, 1))
    system, (benchmark,) = entering(case)
    given = moved(
        benchmark, chain=one_stage(16.0), stage_forces=benchmark.stage_forces.sum(keepdims=True)
    )
    run = stepper(system, 1e-3, pantographs=(given,), tolerance=1e-12)
    block = run.advance(200)
    net = np.array([given.external(t)[0] for t in block.time]) - block.contact_force[:, 0]
    acceleration = np.concatenate([[0.0], net]) / 16.0
    velocity = np.cumsum(0.5e-3 * (acceleration[1:] + acceleration[:-1]))
    step = np.diff(np.concatenate([[0.0], block.stages[:, 0]]))
    middle = 1e-3 * (np.concatenate([[0.0], velocity[:-1]])) + 0.25e-6 * (
        acceleration[1:] + acceleration[:-1]
    )
    assert step == pytest.approx(middle, abs=1e-11)
    assert np.ptp(block.stages) > 1e-3


def test_momentum_balance_with_changing_steps() -> None:
    """The same balance holds exactly when every step has another size: changing the step gives and
    takes no momentum."""
    case = ac_simple(line__spans=2, settings__section=(1, 1))
    system, (benchmark,) = entering(case)
    given = moved(
        benchmark, chain=one_stage(16.0), stage_forces=benchmark.stage_forces.sum(keepdims=True)
    )
    run = stepper(system, 1e-3, pantographs=(given,), tolerance=1e-12)
    sizes = 1e-3 / 2.0 ** np.random.default_rng(2).integers(0, 4, 120)
    blocks = [run.advance(1, float(size)) for size in sizes]
    force = np.array([block.contact_force[0, 0] for block in blocks])
    height = np.array([0.0, *(block.stages[0, 0] for block in blocks)])
    net = np.array([given.external(block.time[0])[0] for block in blocks]) - force
    acceleration = np.concatenate([[0.0], net]) / 16.0
    mean = 0.5 * (acceleration[1:] + acceleration[:-1])
    velocity = np.concatenate([[0.0], np.cumsum(sizes * mean)])
    step = sizes * velocity[:-1] + 0.5 * sizes**2 * mean
    assert np.diff(height) == pytest.approx(step, abs=1e-11)
    assert force.max() > 1.0
