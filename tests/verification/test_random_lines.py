"""Lines that nobody chose: what holds for every line holds for them, and every command runs."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from tautwire.analyses.design.supports import support_forces
from tautwire.cli.app import run_command_line
from tautwire.errors import ModelError
from tautwire.inputs.load import make_case

from ..lines import entering, found, out_of_balance
from ..random_lines import KINDS, random_line
from .test_equalities import force, mirrored

SEEDS = range(30)
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


@pytest.mark.parametrize("seed", sorted(IMPOSSIBLE))
def test_an_impossible_line_stands_after_its_cure(seed: int) -> None:
    """Wires that rise too steeply are refused by dropper; a lower rise, as it is told, helps."""
    data = random_line(seed)
    with pytest.raises(ModelError, match=r"would have to push .*; lower overlaps.rise, or"):
        found(make_case(data))
    data["overlaps"][0] |= {"rise": 0.5 * data["overlaps"][0]["rise"]}
    _, shape, _ = found(make_case(data))
    assert shape.dropper_forces.min() > 0.0


@pytest.mark.slow
@pytest.mark.parametrize("seed", [seed for seed in SEEDS if seed not in IMPOSSIBLE])
def test_mirrored_line_gives_the_same_force(seed: int) -> None:
    """With left and right exchanged the first half second is the same to 1e-5 N."""
    data = random_line(seed) | {"track": []}
    data["supports"]["contact_stagger"] = 0.2
    system, (given, *_) = entering(make_case(data))
    forces = [force(line, given, 0.5, tolerance=1e-12) for line in (system, mirrored(system))]
    assert np.abs(forces[0] - forces[1]).max() <= 1e-5
    assert np.ptp(forces[0]) > 10.0


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_every_command_takes_the_line(
    seed: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Check, statics with conditions, passage, modes, losses, report, study and plan end well on a
    line of every kind; advice on one of two wires, whose answers take the longest."""
    case, study, run = (tmp_path / name for name in ("case.json", "study.json", "run"))
    case.write_text(json.dumps(random_line(seed)))
    plan = {"schema": 1, "name": "s", "base": "case.json", "axes": {"scenario.speed": [30.0, 40.0]}}
    study.write_text(json.dumps(plan))
    lines: list[tuple[object, ...]] = [
        ("check", case),
        ("static", case, "--out", tmp_path / "static"),
        ("run", case, "--out", run),
        ("modes", case, "--count", "4"),
        ("losses", run / "run.nc"),
        ("report", run / "run.nc", "--out", tmp_path / "report.html"),
        ("study", study, "--workers", "1", "--out", tmp_path / "study"),
        ("draw", case, "--out", tmp_path / "plan.svg"),
    ]
    if seed % len(KINDS) == 0:
        lines.append(("advise", case))
    for words in lines:
        code = run_command_line([str(word) for word in words])
        told = capsys.readouterr()
        assert code == 0, f"{words[0]}: {told.err}"
