"""Lines that nobody chose: what holds for every line holds for them, and every command runs."""

from __future__ import annotations

import numpy as np
import pytest

from tautwire.analyses.design.supports import support_forces
from tautwire.inputs.load import make_case

from ..lines import found, out_of_balance
from ..random_lines import random_line
from .test_equalities import entering, force, mirrored

SEEDS = range(30)
SLOW = [pytest.param(seed, marks=pytest.mark.slow) for seed in SEEDS]
IMPOSSIBLE = {16}
"""Where the wires of an overlap rise more steeply than their span allows."""


@pytest.mark.parametrize("seed", [seed for seed in SEEDS if seed not in IMPOSSIBLE])
def test_line_is_in_balance(seed: int) -> None:
    """Found in at most 12 iterations; at rest in balance to 1e-4 N; forces on the supports together
    are the weight, downwards, to 1e-6 of it."""
    model, shape, system = found(make_case(random_line(seed)))
    assert shape.iterations <= 12
    assert shape.reaction == pytest.approx(shape.weight, rel=1e-8)
    assert out_of_balance(system, system.position) < 1e-4
    rows = support_forces(model, shape)
    rails = model.line.track.frames(np.array([row.x for row in rows])).axes[:, 0]
    left = np.stack([-rails[:, 1], rails[:, 0], 0.0 * rails[:, 0]], axis=1)
    left /= np.linalg.norm(left, axis=1, keepdims=True)
    parts = np.array([[row.along, row.lateral, row.vertical] for row in rows]).T[..., None]
    total = (parts[0] * rails + parts[1] * left + parts[2] * [0.0, 0.0, 1.0]).sum(axis=0)
    assert total == pytest.approx([0.0, 0.0, -shape.weight], abs=1e-6 * shape.weight)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [seed for seed in SEEDS if seed not in IMPOSSIBLE])
def test_mirrored_line_gives_the_same_force(seed: int) -> None:
    """With left and right exchanged the first half second is the same to 1e-5 N."""
    data = random_line(seed) | {"track": []}
    data["supports"]["contact_stagger"] = 0.2
    system, given, _ = entering(data)
    forces = [force(line, given, 0.5, tolerance=1e-12) for line in (system, mirrored(system))]
    assert np.abs(forces[0] - forces[1]).max() <= 1e-5
    assert np.ptp(forces[0]) > 10.0
