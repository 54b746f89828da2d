"""The map of the wire's velocity from stored shapes."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from tautwire.analyses.vibration.space_time import wire_velocity
from tautwire.errors import InputError
from tautwire.results.run import Run

from .synthetic import both_wires, make_case, make_run

SPEED, LENGTH, HEIGHT = 120.0, 30.0, 0.02


def run_with_a_wave() -> Run:
    """Return a run in which a smooth wave runs along both wires."""
    case = make_case(spans=4)
    case = case.with_(**{"settings.store_shapes": True})
    run = make_run(case)
    time, x = np.arange(0.0, 1.0, 0.005), np.arange(0.0, 200.0, 1.0)
    phase = 2.0 * np.pi * (x[None, :] - SPEED * time[:, None]) / LENGTH
    wave = (5.3 + HEIGHT * np.sin(phase)).astype(np.float32)
    return dataclasses.replace(run, snapshots=both_wires(time, x, wave, wave + np.float32(1.2)))


def test_travelling_wave() -> None:
    """A wave of amplitude a, speed c and length l moves the wire at 2 pi a c/l."""
    motion = wire_velocity(run_with_a_wave())
    expected = 2.0 * np.pi * HEIGHT * SPEED / LENGTH
    assert motion.velocity[5:-5].max() == pytest.approx(expected, rel=0.02)
    phase = 2.0 * np.pi * (motion.x[50] - SPEED * motion.time) / LENGTH
    assert motion.velocity[5:-5, 50] == pytest.approx(
        -expected * np.cos(phase)[5:-5], abs=0.03 * expected
    )


def test_paths_follow_the_pantographs() -> None:
    """The map knows where each pantograph was when each shape was stored."""
    run = run_with_a_wave()
    motion = wire_velocity(run, "messenger")
    record = run.pantographs[0]
    known = np.isfinite(motion.paths[record.name])
    expected = np.interp(motion.time[known], run.time, record.position)
    assert known.any()
    assert motion.paths[record.name][known] == pytest.approx(expected)


def test_run_without_shapes_is_refused() -> None:
    """Without stored shapes the cure is told; an unknown wire is refused."""
    with pytest.raises(InputError, match="store_shapes"):
        wire_velocity(make_run(make_case(spans=3), duration=0.2))
    with pytest.raises(InputError, match="choose one of"):
        wire_velocity(run_with_a_wave(), "third")
