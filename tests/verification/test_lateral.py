"""The lateral position along a line against the closed form, and what is permissible of it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tautwire.analyses.design.lateral import lateral_sweep
from tautwire.analyses.road.shape import find_design
from tautwire.assessment.design.lateral import LateralCheck, lateral_check
from tautwire.errors import InputError
from tautwire.formulas.lateral import Blown, lateral_position
from tautwire.inputs.load import load_case, make_case
from tautwire.model.build import build
from tautwire.specs.case import Case

from .test_conditions import D, T, at, bare, catenary

WIND = {"speed": "20 m/s", "gust": 1.1}
LOAD = 0.5 * 1.25 * 20.0**2 * 1.1 * D


def checked(case: Case) -> LateralCheck:
    """Return the lateral position along the line of a case and what is permissible of it."""
    gauge = case.requirements.gauge
    assert gauge is not None
    model = build(case)
    return lateral_check(lateral_sweep(model, find_design(model), gauge), gauge)


def single(gauge: dict[str, Any], **changes: Any) -> Case:
    """Return a single wire on three spans with weights at one end."""
    ends = {"left": "anchored", "right": "weighted"}
    data = bare(spans=3, ends=ends, **changes).to_dict()
    track = [{"arc": 400.0, "radius": 1000.0, "side": "right"}]
    return make_case(data | {"track": track, "requirements": {"gauge": {"wind": WIND, **gauge}}})


@pytest.mark.parametrize("side", ["left", "right"])
def test_single_wire_in_a_curve(side: str) -> None:
    """Along a curve the finite elements, extrapolated to elements of no length, and the closed form
    agree within 0.1 % on both sides, and the estimates of both kinds are the closed form."""
    case = single({"permissible": 0.5}, span=50.0, stagger=0.1)
    found, fine = (
        checked(case.with_(settings=case.settings.with_(nodes_between_droppers=nodes)))
        for nodes in (39, 159)
    )
    is_inside = side == "right"  # of a curve to the right
    wire = Blown(T, LOAD, 1000.0, (-0.1, 0.1))
    expected = lateral_position(wire, 50.0, "inside" if is_inside else "outside")
    (place,) = [one for one in found.places if one.span == 2 and one.towards == side]
    (near,) = [one for one in fine.places if one.span == 2 and one.towards == side]
    extrapolated = (4.0 * near.position - place.position) / 3.0
    assert extrapolated == pytest.approx(expected, rel=1e-3)
    assert place.alone == pytest.approx(expected, rel=1e-12)
    assert place.together == place.alone
    assert place.margin == pytest.approx(0.5 - place.position)
    assert place.radius == pytest.approx(1000.0)


def test_wires_coupled_by_droppers_lie_between_the_estimates() -> None:
    """Droppers equalise: the contact wire, which has more wind per tension alone, stands between
    the estimate for itself and that for both wires as one."""
    case = catenary(
        **{"wires__contact__tension": 9e3, "wires__messenger__tension": 20e3},
        supports__contact_stagger=[0.2] * 4,
        scenario__speed=40.0,
        track=[{"arc": 200.0, "radius": 900.0, "side": "right"}],
        requirements={"gauge": {"wind": {"speed": 18.0}, "permissible": 0.6}},
    )
    (place,) = [one for one in checked(case).places if (one.span, one.towards) == (2, "right")]
    assert place.together < place.alone - 0.01
    assert place.together < place.position < place.alone


def test_what_is_permissible_follows_height_radius_and_cant() -> None:
    """A rule with a head takes radius and cant deficiency of the place; deflection and tolerance
    are deducted; the condition that is named stays on."""
    gauge = {"permissible": {"rule": "en50367-2012-norway", "head": 1600}}
    plain = checked(single(gauge, span=50.0))
    given = checked(single(gauge | {"deflection": 0.02, "tolerance": "10 mm"}, span=50.0))
    speed = 20.0
    deficiency = 1.5 * speed**2 / 9.81 / 1000.0
    for one, other in zip(plain.places, given.places, strict=True):
        assert other.margin == pytest.approx(one.margin - 0.03)
        assert one.cant == pytest.approx(deficiency, rel=1e-6)
        sway = 0.110 + 0.04 * (one.height - 4.75)
        assert one.permissible == pytest.approx(0.6 - sway - 2.5 / 1000.0 - 0.0275, abs=1e-9)
    assert "not checked against the standard" in plain.notes[0]


def test_condition_stays_on() -> None:
    """Wind is added to the condition that is named: ice makes the wire thicker."""
    iced = {"name": "iced", "ice": {"thickness": "5 mm"}}
    for name, factor in ((None, 1.0), ("iced", (D + 0.01) / D)):
        gauge = {"wind": WIND, "permissible": 0.5, "condition": name}
        case = bare(iced, at(30.0), span=50.0, ends={"left": "anchored", "right": "weighted"})
        data = case.to_dict() | {"requirements": {"gauge": gauge}}
        place = checked(make_case(data)).places[0]
        assert place.position == pytest.approx(factor * LOAD * 50.0**2 / (8.0 * T), rel=2e-3)


def test_impossible_wind_is_told_with_its_place() -> None:
    """Wind that would push a steady arm ends in a message with its support, not in a position."""
    wind = {"speed": "35 m/s"}
    found = checked(catenary(requirements={"gauge": {"wind": wind, "permissible": 0.4}}))
    assert any("steady arm at support" in fault for fault in found.faults)
    assert not found.places
    assert np.isnan(found.sweep.position).all()


@pytest.mark.parametrize(
    ("gauge", "told"),
    [
        ({"permissible": {"rule": "nobody", "head": "1600"}}, "there is no 'nobody'"),
        ({"permissible": 0.4, "condition": "frost"}, "requirements.gauge.condition"),
    ],
)
def test_refusals(gauge: dict[str, Any], told: str) -> None:
    """An unknown rule or condition is refused with those that exist."""
    with pytest.raises(InputError, match=told):
        checked(single(gauge))


@pytest.mark.parametrize(
    "conditions", [[], [{"name": "storm", "wind": {"speed": 20, "from": "left"}}]]
)
def test_wind_of_the_gauge_asks_once_for_a_diameter(conditions: list[dict[str, Any]]) -> None:
    """A wire without a diameter is told once, by what the user wrote."""
    changes = {
        "wires.contact.diameter": None,
        "conditions": conditions,
        "requirements": {"gauge": {"wind": WIND, "permissible": 0.4}},
    }
    with pytest.raises(InputError) as caught:
        load_case("ac-simple", changes)
    told = [one for one in caught.value.problems if "wires.contact.diameter" in one]
    assert len(told) == 1
    assert ("'storm' has wind" if conditions else "requirements.gauge has wind") in told[0]
    assert "wind from the" not in told[0]
