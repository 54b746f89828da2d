"""Checks of the design: finite elements beside closed forms, limits with their sources."""

from __future__ import annotations

import math
from typing import Any

import pytest

from tautwire.analyses.design.conditions import examine
from tautwire.analyses.road.shape import find_design
from tautwire.assessment.design.checks import GIVEN, DesignCheck, design_checks
from tautwire.assessment.design.limits import design_limits
from tautwire.inputs.load import make_case
from tautwire.model.build import build
from tautwire.specs.case import Case

from .test_conditions import T, at, bare, catenary


def checked(case: Case, *, with_elasticity: bool = False) -> dict[str, DesignCheck]:
    """Return the checks of a case by their quantity."""
    model = build(case)
    design = find_design(model)
    names = (None, *(one.name for one in case.conditions))
    states = [examine(model, design, n, with_elasticity=with_elasticity) for n in names]
    return {one.quantity: one for one in design_checks(model, states)}


def test_estimates_beside_the_equilibrium() -> None:
    """Moments about mid-span give the sag of the messenger wire and the shortest dropper to the 15
    mm that droppers and arms weigh; a zigzag sweeps by 2 b / L."""
    found = checked(catenary(supports__contact_height=[5.3, 5.3, 5.32, 5.32]))
    dropper, sag = found["shortest_dropper"], found["messenger_sag"]
    assert dropper.value == pytest.approx(dropper.estimate, abs=0.015)
    assert sag.value == pytest.approx(sag.estimate, abs=0.015)
    assert found["sweep"].value == pytest.approx(0.4 / 55.0, rel=0.01)
    assert found["sweep"].estimate == pytest.approx(0.4 / 55.0)
    assert found["gradient"].value == pytest.approx(0.02 / 55.0, rel=1e-6)
    assert found["gradient"].estimate == pytest.approx(0.02 / 55.0)
    assert found["gradient_change"].place in ("support 2", "support 3")
    assert found["wave_speed_ratio"].estimate == pytest.approx(320 / 3.6 / math.sqrt(22e3 / 1.35))


def test_sweep_of_a_curve() -> None:
    """With the same stagger on both sides the wire sweeps by twice its bow L^2/8R per span."""
    ends = {"left": "anchored", "right": "weighted"}
    data = bare(spans=3, span=50.0, ends=ends).to_dict()
    track = [{"arc": 150.0, "radius": 800.0, "side": "left"}]
    found = checked(make_case(data | {"track": track}))["sweep"]
    expected = 2.0 * 50.0 / (8.0 * 800.0)
    assert found.estimate == pytest.approx(expected, rel=1e-3)
    assert found.value == pytest.approx(expected, rel=0.02)


def test_tension_against_what_wear_leaves() -> None:
    """Weights keep the tension while wear takes strength away; a colder line between anchors pulls
    harder, and the worst state is named."""
    worn = {"name": "worn", "wear": 0.2}
    ends = {"left": "anchored", "right": "weighted"}
    for conditions, fixed, factor in (([worn], ends, 1.25), ([worn, at(-5.0)], "anchored", 0.0)):
        data = bare(*conditions, ends=fixed).to_dict()
        data["wires"]["contact"]["strength"] = 40e3
        found = checked(make_case(data))["tension_share"]
        assert found.estimate == pytest.approx(T / 40e3)
        assert found.place == conditions[-1]["name"]
        expected = factor or (T + 0.85 * 12e6 * 17e-6 * 20.0) / T
        assert found.value == pytest.approx(expected * T / 40e3, rel=0.05)


def test_limits_follow_the_speed_and_the_case() -> None:
    """The gradient's limit is that of the speed; what a case gives stands in place of it; nothing
    of the package counts as verified."""
    limits = design_limits()
    assert limits["gradient"].value(50 / 3.6) == 0.025
    assert limits["gradient"].value(160 / 3.6) == 0.002
    assert limits["gradient"].value(300 / 3.6) == 0.0004
    assert limits["least_height"].value(200 / 3.6) is None
    assert not any(limit.verified for limit in limits.values())
    given: dict[str, Any] = {"shortest_dropper": 1.2, "heights": [5.0, 5.2], "uplift_space": 0.12}
    found = checked(catenary(requirements=given), with_elasticity=True)
    assert found["shortest_dropper"].within is False
    assert found["shortest_dropper"].source == GIVEN
    assert found["least_height"].within
    assert found["largest_height"].within is False
    assert found["doppler"].within is None
    uplift = found["uplift_share"]
    assert 0.1 < uplift.value < 1.0
    assert "not checked" in uplift.source
    stops = catenary(supports__stop__gap=0.12)
    stopped = checked(stops, with_elasticity=True)["uplift_share_with_stop"]
    assert stopped.value == pytest.approx(uplift.value, rel=1e-9)
    assert stopped.limit == pytest.approx(1.0 / 1.5, abs=1e-4)
