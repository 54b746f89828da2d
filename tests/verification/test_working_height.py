"""Forces on the stages over speed and height: what lifts a pantograph is what the line feels."""

from __future__ import annotations

import numpy as np
import pytest

import tautwire as tw
from tautwire.model.passage import plan_passage
from tautwire.specs.case import Case

from ..lines import ac_simple, found


def _line(stiffness: float = 160.0, **changes: object) -> Case:
    """Return six spans whose ends stand 0.25 m above the four spans of the running level."""
    stages = [
        {"mass": 7.5, "stiffness": 7000.0, "damping": 45.0},
        {"mass": 9.0, "stiffness": 15500.0, "damping": 0.1},
        {"mass": 6.0, "stiffness": stiffness, "damping": 100.0},
    ]
    return ac_simple(
        line__spans=6,
        supports__contact_height=(5.55, 5.3, 5.3, 5.3, 5.3, 5.3, 5.55),
        pantographs=({"name": "front", "stages": stages, **changes},),
        scenario__speed=30.0,
        settings__section=(3, 4),
        scenario__uplift_force=100.0,
    )


@pytest.mark.parametrize("stiffness", [0.0, 50.0, 160.0])
def test_mean_force_of_a_line_with_raised_ends(stiffness: float) -> None:
    """The mean force in the section is the uplift force less what the base spring takes over the
    uplift of the wire (a few centimetres), whatever the height at which the passage starts. With
    the spring slack at the start it would be 12 N too high at 50 N/m and 40 N at 160 N/m."""
    run = tw.run(_line(stiffness))
    record = run.pantographs[0]
    inside = (record.position > 110.0) & (record.position < 220.0)
    lift = record.stage_heights[inside, -1].mean()
    model, shape, _ = found(_line(stiffness))
    (given,) = plan_passage(model, shape, [100.0]).pantographs
    expected = given.stage_forces.sum() - stiffness * lift
    mean = record.contact_force[inside].mean()
    assert mean == pytest.approx(expected, abs=1.0)
    assert abs(mean - 100.0) < 1.0 + 0.05 * stiffness


def test_given_working_height() -> None:
    """Below its working height a base spring lifts by k times the distance."""
    low, high = (
        plan_passage(model, shape, [100.0]).pantographs[0].stage_forces
        for model, shape, _ in (found(_line(working_height=h)) for h in (5.3, 5.4))
    )
    assert (high - low).tolist() == pytest.approx([0.0, 0.0, 160.0 * 0.1])


def test_forces_on_stages() -> None:
    """Constant, linear and quadratic parts act on their own stage, besides the uplift force."""
    law = {"constant": 2.0, "per_speed": 0.5, "per_speed_squared": 0.01}
    stages = [
        {"mass": 7.5, "stiffness": 7000.0, "force": {"constant": -3.0}},
        {"mass": 9.0, "stiffness": 15500.0, "force": law},
        {"mass": 6.0, "stiffness": 0.0},
    ]
    model, shape, _ = found(_line(stages=stages))
    (given,) = plan_passage(model, shape, [70.0]).pantographs
    middle = 2.0 + 0.5 * 30.0 + 0.01 * 30.0**2
    assert given.stage_forces.tolist() == pytest.approx([-3.0, middle, 70.0])
    (lowered,) = plan_passage(model, shape, [0.0]).pantographs
    assert np.array_equal(lowered.stage_forces, np.zeros(3))


def test_base_spring_is_told() -> None:
    """A section whose wire rises by 0.25 m under a base spring of 160 N/m is warned about."""
    case = _line().with_(**{"settings.section": (1, 4)})
    model, shape, _ = found(case)
    (warning,) = plan_passage(model, shape, [100.0]).warnings
    assert "160 N/m" in warning
    level, flat, _ = found(_line())
    assert plan_passage(level, flat, [100.0]).warnings == ()
