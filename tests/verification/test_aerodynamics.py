"""Forces of the air on pantographs: parts over speed, per mass, direction, tunnel, wind along."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tautwire.model.passage import plan_passage
from tautwire.specs.case import Case

from ..lines import AC_SIMPLE, ac_simple, found

LAW = {"constant": "4 N", "per_speed": "0.2 N/(m/s)", "per_speed_squared": "0.01 N/(m/s)^2"}
BACK = {"per_speed_squared": 0.02}
SPEED = 50.0


def case_of(scenario: dict[str, float] | None = None, **pantograph: Any) -> Case:
    """Return the short line at 50 m/s with a pantograph whose own forces act."""
    stages = [dict(one) for one in AC_SIMPLE["pantographs"][0]["stages"]]
    stages[0] |= {"force": LAW, "force_reversed": BACK}
    stages[1] |= {"force": {"constant": 3.0}}
    own = {"name": "front", "stages": stages, "static_force": 70.0, "aerodynamic": LAW}
    given = {"speed": SPEED, "uplift_force": None, **(scenario or {})}
    return ac_simple(pantographs=[own | pantograph], scenario=given)


def law(speed: float, factor: float = 1.0) -> float:
    """Return the force of :data:`LAW` at a speed of the air [N]."""
    return 4.0 + factor * (0.2 * speed + 0.01 * speed * abs(speed))


@pytest.mark.parametrize(
    ("scenario", "speed", "factor"),
    [
        ({}, SPEED, 1.0),
        ({"headwind": 10.0}, SPEED + 10.0, 1.0),
        ({"headwind": -10.0}, SPEED - 10.0, 1.0),
        ({"tunnel_factor": 1.6}, SPEED, 1.6),
        ({"tunnel_factor": 1.6, "headwind": -60.0}, -10.0, 1.6),
    ],
)
def test_constant_linear_and_quadratic_part(
    scenario: dict[str, float], speed: float, factor: float
) -> None:
    """Uplift force and the force on a mass follow the speed of the air with its sign; a tunnel
    raises what depends on it and leaves the constant parts."""
    case = case_of(scenario)
    assert case.uplift_forces() == (pytest.approx(70.0 + law(speed, factor)),)
    on_stages = case.pantographs[0].stage_forces(case.scenario.air)
    assert on_stages == pytest.approx((law(speed, factor), 3.0, 0.0))


def test_other_direction() -> None:
    """A pantograph that runs the other way has the forces given for it, and its own where there are
    none."""
    forth = case_of(aerodynamic_reversed=BACK)
    back = case_of(aerodynamic_reversed=BACK, reversed=True)
    assert forth.uplift_forces() == (pytest.approx(70.0 + law(SPEED)),)
    assert back.uplift_forces() == (pytest.approx(70.0 + 0.02 * SPEED**2),)
    air = back.scenario.air
    assert back.pantographs[0].stage_forces(air) == pytest.approx((0.02 * SPEED**2, 3.0, 0.0))
    assert case_of(reversed=True).uplift_forces() == (pytest.approx(70.0 + law(SPEED)),)
    plain = case_of(aerodynamic="0.01 N/(m/s)^2", aerodynamic_reversed=0.0, reversed=True)
    assert plain.uplift_forces() == (70.0,)


def test_a_passage_has_the_forces_of_its_air() -> None:
    """What lifts the masses in a passage is what the laws give in the wind along the track; the
    speed of the train alone decides how fast it runs."""
    blown, still = case_of({"headwind": 10.0}), case_of()
    stages = []
    for case in (blown, still):
        model, shape, _ = found(case)
        (entering,) = plan_passage(model, shape, case.uplift_forces()).pantographs
        assert entering.velocity == SPEED
        stages.append(np.asarray(entering.stage_forces))
    change = law(SPEED + 10.0) - law(SPEED)
    assert stages[0] - stages[1] == pytest.approx([change, 0.0, change])
