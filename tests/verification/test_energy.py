"""Energy of undamped lines: kept while nothing slackens, never gained when droppers do."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from tautwire.numerics.motion import backend
from tautwire.numerics.motion.dispersion import wave_stiffening
from tautwire.numerics.motion.stepper import StepOptions
from tautwire.numerics.network.system import System
from tautwire.numerics.newmark import HHT, Integrator, Newmark
from tautwire.specs.case import Case
from tautwire.status import Status

from ..lines import (
    HAS_CORE,
    RUNNABLE,
    ac_simple,
    found,
    kinetic_energy,
    loaded,
    potential_energy,
    stepper,
)
from .test_general_lines import stitched

Array = NDArray[np.float64]


@cache
def undamped_line(spans: int = 2, **changes: object) -> System:
    """Return spans of AC simple without any damping."""
    case = ac_simple(
        line__spans=spans,
        line__damping={"mass": 0.0, "stiffness": 0.0},
        supports__messenger_damping=0.0,
        settings__section=(1, 1),
        **changes,
    )
    return found(case)[2]


def plucked(system: System, force: float) -> Array:
    """Return the coordinates under a vertical force in the first span, about to be released."""
    extra = np.zeros(system.dof_count)
    middle = system.position[0] + 27.5
    nodes = system.paths[0].nodes
    extra[6 * nodes[np.abs(system.position[6 * nodes] - middle).argmin()] + 2] = force
    response = loaded(system, extra)
    assert response.status is Status.DONE
    return response.position


class Vibration:
    """Energy over time of a line released from rest, per energy put in; and its least tension."""

    def __init__(
        self, q: Array, dt: float, duration: float, *, integrator: Integrator | None = None
    ) -> None:
        system = undamped_line()
        rest = potential_energy(system, system.position)
        run = stepper(system, dt, integrator=integrator, tolerance=1e-9)
        run.start_from(q, np.zeros_like(q))
        given = potential_energy(system, q) - rest
        energy, tension = [], []
        for _ in range(round(duration / dt / 20)):
            block = run.advance(20)
            stored = potential_energy(system, run.coordinates) - rest
            energy.append((stored + kinetic_energy(system, run.velocities)) / given)
            tension.append(block.dropper_force.min())
        self.energy, self.least_tension = np.array(energy), min(tension)
        self.time = run.time


def test_energy_is_kept_over_ten_seconds(record_validation: Callable[..., bool]) -> None:
    """Without damping, contact and slackening the energy of a plucked line (wires, droppers, arms,
    springs, weight and motion) drifts by at most 0.1 % of what was put in over 10 s."""
    vibration = Vibration(plucked(undamped_line(), 25.0), 4e-3, 10.0)
    drift = float(np.abs(vibration.energy - 1.0).max())
    assert vibration.time == pytest.approx(10.0)
    assert vibration.least_tension > 0.0
    assert record_validation(
        "Closed forms, whole line",
        "energy of an undamped plucked line over 10 s, largest drift",
        ours=100.0 * drift,
        unit="%",
        allowed=(0.0, 0.1),
        source="energy balance",
    )


def test_energy_balance_notices_an_error() -> None:
    """The balance is sharp: 5 % more clamp mass, a thousandth of the line's, would exceed 0.1 %."""
    system = undamped_line()
    q = plucked(system, 25.0)
    run = stepper(system, 2e-3)
    run.start_from(q, np.zeros_like(q))
    run.advance(120)
    heavier = system.with_(node_mass=1.05 * system.node_mass)
    given = potential_energy(system, q) - potential_energy(system, system.position)
    change = kinetic_energy(heavier, run.velocities) - kinetic_energy(system, run.velocities)
    assert change > 1e-3 * given


def test_slackening_droppers_never_feed_energy() -> None:
    """An undamped line plucked so hard that droppers go slack and taut again never holds more
    than 0.1 % above the energy put in."""
    vibration = Vibration(plucked(undamped_line(), 400.0), 1e-3, 0.4)
    assert vibration.least_tension == 0.0
    assert vibration.energy.max() <= 1.001
    assert vibration.energy.min() >= 0.99


def energies(system: System, duration: float) -> tuple[list[float], int]:
    """Return the energy over time in the compiled core, per energy put in by plucking with 400 N,
    and the number of steps with a slack dropper."""
    q = plucked(system, 400.0)
    rest = potential_energy(system, system.position)
    given = potential_energy(system, q) - rest
    options = StepOptions(Newmark(), 1e-3, 2e5, tolerance=3e-8)
    run = backend.make_stepper(system, (), options, np.array([2]), "native")
    run.start_from(q, np.zeros_like(q))  # type: ignore[attr-defined]
    energy, slack = [], 0
    for _ in range(round(50 * duration)):
        block = run.advance(20)
        assert block.status is Status.RUNNING
        slack += int((block.dropper_force == 0.0).any(axis=1).sum())
        stored = potential_energy(system, run.coordinates) - rest
        energy.append((stored + kinetic_energy(system, run.velocities)) / given)  # type: ignore[attr-defined]
    return energy, slack


@pytest.mark.slow
@pytest.mark.skipif(not HAS_CORE, reason="no compiled core here")
def test_a_stitched_line_feeds_no_energy(record_validation: Callable[..., bool]) -> None:
    """Four undamped spans with stitch wires, plucked so that droppers slacken, never hold more
    than 0.1 % above the energy put in over 10 s (nine nodes between droppers; with four, too coarse
    for 1 ms, slackening leaves 0.15 %, at 0.5 ms 0.02 %)."""
    data = stitched()
    data["line"] |= {"spans": 4, "damping": {"mass": 0.0, "stiffness": 0.0}}
    data["supports"]["messenger_damping"] = 0.0
    data["settings"]["nodes_between_droppers"] = 9
    energy, slack = energies(found(Case.model_validate(data))[2], 10.0)
    assert slack > 100
    assert min(energy) > 0.97
    assert record_validation(
        "Closed forms, whole line",
        "energy of an undamped plucked stitched line with slackening droppers over 10 s, "
        "largest gain",
        ours=100.0 * (max(energy) - 1.0),
        unit="%",
        allowed=(-100.0, 0.1),
        source="energy balance",
    )


@pytest.mark.slow
@pytest.mark.skipif(not HAS_CORE, reason="no compiled core here")
@pytest.mark.parametrize("nodes", [9, 15, 18])
def test_compiled_core_feeds_no_energy(nodes: int, record_validation: Callable[..., bool]) -> None:
    """The compiled core at its default tolerance: six undamped spans, plucked by 17 cm so that
    droppers slacken, never hold more than 0.1 % above the energy put in over 20 s."""
    energy, slack = energies(undamped_line(6, settings__nodes_between_droppers=nodes), 20.0)
    assert slack > 100
    assert min(energy) > 0.97
    assert record_validation(
        "Closed forms, whole line",
        f"energy of an undamped plucked line with slackening droppers over 20 s, NAD {nodes}, "
        "largest gain",
        ours=100.0 * (max(energy) - 1.0),
        unit="%",
        allowed=(-100.0, 0.1),
        source="energy balance",
    )


@pytest.mark.slow
@pytest.mark.parametrize("kernels", [name for name in RUNNABLE if name != "plain"])
def test_no_kernels_feed_energy(kernels: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nor with lanes of any width, which divide the line otherwise and choose other rows."""
    monkeypatch.setenv("TAUTWIRE_SIMD", kernels)
    energy, slack = energies(undamped_line(6, settings__nodes_between_droppers=9), 20.0)
    assert slack > 100
    assert 0.97 < min(energy) <= max(energy) <= 1.001


@pytest.mark.parametrize("corrects_waves", [False, True], ids=["plain", "waves corrected"])
def test_changing_the_step_creates_no_energy(corrects_waves: bool) -> None:
    """An undamped plucked line whose step changes at random between 1, 1/2 and 1/4 ms, as an
    adaptive step does, keeps its energy within 0.1 % over 1 s; so it does where wires are stiffened
    by the square of the step, which changes with it."""
    system, random = undamped_line(), np.random.default_rng(5)
    q = plucked(system, 25.0)
    rest = potential_energy(system, system.position)
    given = potential_energy(system, q) - rest
    newmark = Newmark()
    stiffening = wave_stiffening(system, newmark) if corrects_waves else None
    run = stepper(system, 1e-3, tolerance=1e-9, stiffening=stiffening)
    run.start_from(q, np.zeros_like(q))
    energy = []
    while run.time < 1.0:
        run.advance(int(random.integers(5, 40)), 1e-3 / 2 ** int(random.integers(0, 3)))
        stored = potential_energy(system, run.coordinates) - rest
        energy.append((stored + kinetic_energy(system, run.velocities)) / given)
    assert len(energy) > 30
    assert np.abs(np.array(energy) - 1.0).max() < 1e-3


def test_hht_only_takes_energy_away() -> None:
    """HHT(-0.1) on the same line: the energy ends below its start, above 90 % of it after 1 s."""
    vibration = Vibration(plucked(undamped_line(), 25.0), 2e-3, 1.0, integrator=HHT(-0.1))
    assert 0.9 < vibration.energy[-1] < 0.9999
    assert vibration.energy.max() < 1.0


def test_line_at_rest_stays_at_rest() -> None:
    """Started in its static shape with no pantograph, the line moves by less than 1e-9 m."""
    system = undamped_line()
    run = stepper(system, 2e-3, tolerance=1e-12)
    run.advance(100)
    assert np.abs(run.coordinates - system.position).max() <= 1e-9
