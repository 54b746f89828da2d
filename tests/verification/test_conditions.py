"""Conditions against closed forms: temperature, ice, wind, wear, tensioning devices."""

from __future__ import annotations

import copy
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.optimize import brentq

from tautwire.analyses.road.dynamics import simulate
from tautwire.analyses.road.elasticity import elasticity
from tautwire.analyses.road.operate import operate
from tautwire.analyses.road.shape import find_design, find_shape
from tautwire.analyses.vibration.modes import modes
from tautwire.errors import InputError, ModelError
from tautwire.formulas.lateral import Blown, lateral_position
from tautwire.formulas.temperature import fixed_wire_tension, friction_loop
from tautwire.formulas.wear import bending_left, height_left
from tautwire.inputs.load import make_case
from tautwire.model.build import build
from tautwire.model.equations import equations
from tautwire.results.equilibrium import Equilibrium
from tautwire.specs.case import Case

from ..lines import AC_SIMPLE, out_of_balance, stretch_under

Array = NDArray[Any]

G, T, M, EA, ALPHA, D = 9.81, 10e3, 0.89, 12e6, 17e-6, 0.012
"""Gravity, tension, mass, axial stiffness, thermal expansion and diameter of a 100 mm2 wire."""


def wire(**changes: Any) -> dict[str, Any]:
    """Return a contact wire of 100 mm2."""
    return {
        "tension": T,
        "mass": M,
        "axial_stiffness": EA,
        "bending_stiffness": 0.0,
        "diameter": D,
        "thermal_expansion": ALPHA,
    } | changes


def bare(
    *conditions: dict[str, Any],
    spans: int = 1,
    span: float = 60.0,
    ends: Any = "anchored",
    stagger: float = 0.0,
) -> Case:
    """Return a single wire between supports that hold it sideways."""
    data = copy.deepcopy(AC_SIMPLE) | {
        "schema": 2,
        "line": {"spans": spans, "span_length": span, "ends": ends},
        "wires": {"contact": wire()},
        "supports": {
            "closure": "spring",
            "spring": {"stiffness": 1e4},
            "contact_stagger": stagger,
        },
        "droppers": [],
        "scenario": {"speed": 20.0, "uplift_force": 50.0},
        "conditions": list(conditions),
    }
    data["settings"] |= {"nodes_between_droppers": 41, "section": [1, 1]}
    return make_case(data)


def catenary(*conditions: dict[str, Any], **changes: Any) -> Case:
    """Return AC simple on a few spans with everything that conditions ask for."""
    data = copy.deepcopy(AC_SIMPLE) | {"schema": 2, "conditions": list(conditions)}
    data["line"] |= {"ends": {"left": "anchored", "right": "weighted"}}
    for part in (data["wires"]["contact"], data["wires"]["messenger"], data["droppers"]):
        part |= {"diameter": D, "thermal_expansion": ALPHA}
    return make_case(data, {name.replace("__", "."): value for name, value in changes.items()})


def states(case: Case) -> tuple[Equilibrium, dict[str, Equilibrium]]:
    """Return the design of a case and its state in every condition."""
    model = build(case)
    design = find_design(model)
    found = {
        one.name: operate(replace(model, case=case.with_condition(one.name)), design)
        for one in case.conditions
    }
    return design, found


def at(temperature: float, name: str = "", **more: Any) -> dict[str, Any]:
    """Return a condition at a temperature [degC]; the design is at 15 degC."""
    name = name or f"{temperature:g} degC"
    return {"name": name, "temperature": temperature, "reference": 15.0, **more}


def travel(shape: Equilibrium) -> float:
    """Return how far the right end of the first wire has moved outwards [m]."""
    assert shape.operated is not None
    return float(shape.operated.end_travel[1, 0])


def distance(horizontal: float, unstrained: float, weight: float) -> float:
    """Return the distance of the ends of an elastic catenary [m], ends level.

    A wire of unstrained length S and weight w per unstrained length under the horizontal force H:
    ``2 int_0^(S/2) H / N lambda(N) ds`` with ``N = sqrt(H^2 + (w s)^2)``.
    """

    def advance(s: float) -> float:
        force = float(np.hypot(horizontal, weight * s))
        return horizontal / force * stretch_under(force, EA)

    return 2.0 * quad(advance, 0.0, 0.5 * unstrained, epsabs=1e-12)[0]


# ---- fixed ends ---------------------------------------------------------------------------------

TEMPERATURES = (-40.0, 0.0, 40.0, 100.0)


def test_fixed_wire_is_the_elastic_catenary() -> None:
    """Between fixed ends the tension over temperature and ice is that of the elastic catenary
    within 0.01 %, with the wire's own law of stretch."""
    iced = [at(t, f"iced {t:g}", ice={"mass": "0.5 kg/m"}) for t in TEMPERATURES]
    design, found = states(bare(*(at(t) for t in TEMPERATURES), *iced))
    unstrained = float(design.cable_lengths.sum())
    for name, shape in found.items():
        assert shape.operated is not None
        condition = shape.operated.condition
        strain = ALPHA * ((condition.temperature or 0.0) - 15.0)
        ice = 0.5 * 60.0 / unstrained if condition.ice else 0.0
        weight = (M / (1.0 + strain) + ice) * G
        expected = brentq(
            lambda h, s=strain, w=weight: distance(h, unstrained * (1.0 + s), w) - 60.0,
            100.0, 1e5, xtol=1e-9,
        )  # fmt: skip
        assert shape.end_pulls[1, 0] == pytest.approx(expected, rel=1e-4), name


def test_fixed_wire_is_the_state_equation() -> None:
    """It is that of the state equation within 0.1 % too, and at 100 degrees, where the wire sags by
    2 % of its span, within the 0.13 % that the parabola is wrong there. The stiffness is that at
    the mean tension: the strain is Green's, whose wire is stiffer than Hooke's by three strains."""
    _, found = states(bare(*(at(t) for t in TEMPERATURES)))
    for t in TEMPERATURES:
        ours = float(found[f"{t:g} degC"].end_pulls[1, 0])
        stiffness = (ours - T) / (stretch_under(ours, EA) - stretch_under(T, EA))
        loads = (M * G, M * G)
        expected = fixed_wire_tension(T, 60.0, stiffness, loads, ALPHA * (t - 15.0))
        assert ours == pytest.approx(expected, rel=1e-3 if t < 100.0 else 1.3e-3)


def test_flat_wire_between_fixed_ends_goes_slack() -> None:
    """A flat wire of 10 kN between fixed ends is slack at 60 K more, and the message says that it
    loses its tension over T/(EA alpha) = 49 K, where it is worst, and what helps."""
    hot, warm = at(75.0, "hot"), at(45.0, "warm")
    case = catenary(hot, warm, line__ends="anchored", wires__contact=wire())
    model = build(case.with_condition("hot"))
    with pytest.raises(ModelError, match=r"(?s)'contact' is slack in span \d.* 49 K.*line\.ends"):
        find_shape(model)
    assert find_shape(build(case.with_condition("warm"))).end_pulls[1, 0] < 0.5 * T


# ---- weights and springs ------------------------------------------------------------------------


def test_weights_keep_the_tension_and_travel() -> None:
    """Weights keep the tension; the end travels alpha L dT within 0.1 %: 102 mm over 600 m and
    10 K, and weights of a wheel 1:5 rise by 34.85 cm over 410 m when it is 10 K colder."""
    ends = {"left": "anchored", "right": {"weights": {"ratio": 5}}}
    _, found = states(bare(at(25.0), spans=12, span=50.0, ends=ends))
    assert found["25 degC"].end_pulls[1, 0] == pytest.approx(T, rel=1e-9)
    assert travel(found["25 degC"]) == pytest.approx(0.102, rel=1e-3)
    _, found = states(bare(at(5.0), spans=10, span=41.0, ends=ends))
    assert 5.0 * travel(found["5 degC"]) == pytest.approx(-0.3485, rel=1e-3)


def test_both_ends_travel_from_the_fixed_point() -> None:
    """With weights at both ends each travels alpha L dT from the fixed point, within 0.1 %, and the
    fixed point stays."""
    ends = {"left": "weighted", "right": "weighted"}
    data = bare(at(45.0), spans=8, span=50.0).to_dict()
    data["tension_lengths"] = [{"name": "T1", "masts": [1, 9], "ends": ends, "fixed_point": 4}]
    shape = states(make_case(data))[1]["45 degC"]
    assert shape.operated is not None
    expected = ALPHA * 30.0 * np.array([150.0, 250.0])
    assert shape.operated.end_travel[:, 0] == pytest.approx(expected, rel=1e-3)
    wire = shape.wire("T1 contact")
    assert wire.position[np.searchsorted(wire.s, 150.0 - 1e-6), 0] == pytest.approx(150.0, abs=1e-9)


def test_friction_loses_its_loop() -> None:
    """Weights with friction hold a wire still between T eta and T/eta; there and back the loop of
    tension over travel has the area T (1/eta - eta) per metre, within 0.1 %."""
    eta, way = 0.95, [15.0, 55.0, 53.0, -25.0, -23.0, 55.0]
    names = [f"step {number}" for number, _ in enumerate(way)]
    steps = [at(t, name) for t, name in zip(way, names, strict=True)]
    for before, after in pairwise(steps):
        after["after"] = before["name"]
    ends = {"left": "anchored", "right": {"weights": {"efficiency": eta}}}
    _, found = states(bare(*steps, spans=6, span=50.0, ends=ends))
    moved = [travel(found[name]) for name in names]
    pulls = [float(found[name].end_pulls[1, 0]) for name in names]
    assert moved[0] == 0.0
    assert pulls[1] == pytest.approx(T * eta, rel=1e-9)
    assert pulls[3] == pytest.approx(T / eta, rel=1e-9)
    assert moved[2] == pytest.approx(moved[1], abs=1e-12)
    assert T * eta < pulls[2] < T / eta
    assert pulls[5] == pytest.approx(T * eta, rel=1e-9)
    assert moved[5] == pytest.approx(moved[1], abs=1e-9)
    area = (pulls[3] - pulls[1]) * (moved[1] - moved[3])
    assert area / (moved[1] - moved[3]) == pytest.approx(friction_loop(T, eta), rel=1e-3)


def test_stops_hold_the_weights() -> None:
    """Weights that have sunk or risen to a stop hold the wire; its tension leaves that of the
    weights, downwards when warm and upwards when cold."""
    weights = {"ratio": 3, "sink": "0.3 m", "rise": "0.15 m"}
    ends = {"left": "anchored", "right": {"weights": weights}}
    cases = (at(25.0), at(65.0), at(-25.0))
    _, found = states(bare(*cases, spans=6, span=50.0, ends=ends))
    assert found["25 degC"].end_pulls[1, 0] == pytest.approx(T, rel=1e-9)
    hot, cold = found["65 degC"], found["-25 degC"]
    assert travel(hot) == pytest.approx(0.1, abs=1e-12)
    assert travel(cold) == pytest.approx(-0.05, abs=1e-12)
    assert hot.end_pulls[1, 0] < 0.9 * T
    assert cold.end_pulls[1, 0] > 1.1 * T
    assert hot.operated is not None
    assert hot.operated.end_words[1] == ("at the outer stop",)


def test_spring_gives_with_the_travel() -> None:
    """A spring loses its stiffness times the travel; beyond its range the end stands still."""
    ends = {"left": "anchored", "right": {"spring": {"stiffness": "15 kN/m", "travel": "0.1 m"}}}
    case = bare(at(30.0), at(65.0), spans=6, span=50.0, ends=ends)
    _, found = states(case)
    warm, hot = found["30 degC"], found["65 degC"]
    assert 0.0 < travel(warm) < 0.1
    assert warm.end_pulls[1, 0] == pytest.approx(T - 15e3 * travel(warm), rel=1e-9)
    assert travel(hot) == pytest.approx(0.1, abs=1e-12)
    assert hot.end_pulls[1, 0] < T - 15e3 * 0.1


@pytest.mark.parametrize(
    "device", [{"weights": {"ratio": 3, "inertia": True}}, {"spring": {"stiffness": "15 kN/m"}}]
)
def test_devices_in_a_passage(device: dict[str, Any]) -> None:
    """Weights that move with the wire have the mass T/(ratio g) and ratio times its travel, so that
    the wire feels ratio T/g; with them and with a spring the line is at rest in its design, and
    both engines give its passage alike."""
    case = catenary(line__ends={"left": "anchored", "right": device})
    case = case.with_(**{"settings.start": 40.0, "settings.time_step": 2e-3})
    model = build(case)
    shape = find_shape(model)
    system = equations(model, shape)
    assert out_of_balance(system, shape.position) < 1e-4
    end = shape.wire("contact").nodes[-1]
    mass = 3.0 * 22e3 / G if "weights" in device else 0.0
    assert system.node_mass[end] == pytest.approx(mass)
    at_end = system.grounds.stiffness[system.grounds.node == end]
    assert at_end.sum() == pytest.approx(0.0 if "weights" in device else 15e3)
    runs = [simulate(model, shape, backend=name) for name in ("reference", "native")]
    forces = [run.contact_force("front").force for run in runs]
    assert np.sqrt(np.mean((forces[0] - forces[1]) ** 2)) < 0.05


def test_other_tension() -> None:
    """A changed tension acts at the weights, or moves the right one of two anchors, which holds
    the wire again."""
    lower = {"name": "lower", "wires": {"contact": {"tension": "18 kN"}}}
    for ends in ({"left": "anchored", "right": "weighted"}, "anchored"):
        case = catenary(lower, line__ends=ends).with_condition("lower")
        shape = find_shape(build(case))
        assert shape.end_pulls[1, 0] == pytest.approx(18e3, rel=1e-6)
        assert travel(shape) < -0.01
        assert shape.operated is not None
        right = shape.wire("contact").nodes[-1]
        assert shape.operated.system.fixed[6 * right] == (ends == "anchored")


# ---- wind ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("stagger", [0.0, 0.2])
def test_blow_off_of_one_wire(side: str, stagger: float) -> None:
    """A wire in wind bows by w L^2/(8 H), with stagger to the extreme of its closed form, to the
    side that the wind blows to, within 0.1 %."""
    wind = {"speed": "25 m/s", "from": side, "gust": 1.1, "drag": 1.2}
    ends = {"left": "anchored", "right": "weighted"}
    case = bare({"name": "wind", "wind": wind}, ends=ends, stagger=stagger)
    middle = states(case)[1]["wind"].contact.position[:, 1]
    load = 0.5 * 1.25 * 25.0**2 * 1.1 * 1.2 * D
    towards = 1.0 if side == "right" else -1.0
    expected = lateral_position(Blown(T, load, np.inf, (-stagger, stagger)), 60.0, "inside")
    assert np.max(towards * middle) == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("side", ["left", "right"])
def test_blow_off_in_a_curve(side: str) -> None:
    """In a curve the wire bows by (T/R + w) L^2/(8 H) under wind to the inside and by T/R - w under
    wind to the outside, within 0.1 %."""
    wind = {"speed": "20 m/s", "from": side}
    data = bare(
        {"name": "wind", "wind": wind}, span=50.0, ends={"left": "anchored", "right": "weighted"}
    )
    curved = make_case(
        data.to_dict() | {"track": [{"arc": 100.0, "radius": 1000.0, "side": "left"}]}
    )
    y = states(curved)[1]["wind"].contact.position[:, 1]
    load = 0.5 * 1.25 * 20.0**2 * D
    towards = 1.0 if side == "right" else -1.0
    expected = (T / 1000.0 + towards * load) * 50.0**2 / (8.0 * T)
    assert y.max() == pytest.approx(expected, rel=1e-3)


def test_wide_curve_is_straight() -> None:
    """At a radius of 1e8 m a line under wind and warmth stands as on straight track; its arms pull
    otherwise by T L/R."""
    warm = at(40.0, "warm", wind={"speed": 5.0, "from": "left"})
    straight = catenary(warm)
    wide = {"track": [{"arc": 500.0, "radius": 1e8, "side": "left"}]}
    found = [states(case)[1]["warm"] for case in (straight, make_case(straight.to_dict() | wide))]
    assert found[0].end_pulls == pytest.approx(found[1].end_pulls, abs=1e-2)
    assert found[0].support_heights == pytest.approx(found[1].support_heights, abs=1e-6)
    assert found[0].arm_forces == pytest.approx(found[1].arm_forces, abs=0.013)
    assert travel(found[0]) == pytest.approx(travel(found[1]), abs=1e-7)


def test_two_wires_in_wind_are_two_strings() -> None:
    """Droppers share the wind between the wires as pendulums, F/l each: the two coupled strings
    within 0.3 %, and neither wire as far as or less than it would go alone."""
    wind = {"speed": "8 m/s", "from": "left"}
    shelter = {"messenger": {"shelter": 0.3}}
    spring = {"closure": "spring", "spring": {"stiffness": 1e4}, "encumbrance": 1.2}
    mesh = {"nodes_between_droppers": 9, "graded_mesh": True}
    case = catenary({"name": "wind", "wind": wind, "wires": shelter}, supports=spring)
    case = case.with_(
        **{f"settings.{name}": value for name, value in mesh.items()},
        **{"line.spans": 1, "settings.section": (1, 1)},
    )
    design, found = states(case)
    shape = found["wind"]
    places = np.concatenate([[0.0], design.dropper_x, [55.0]])
    coupling = design.dropper_forces / design.dropper_lengths
    pressure = -0.5 * 1.25 * 8.0**2 * D
    rope = 0.5 * pressure * design.dropper_lengths
    expected = two_strings(places, (22e3, 16e3), (pressure, 0.3 * pressure), coupling, rope)
    for number, name in enumerate(("contact", "messenger")):
        now, before = shape.wire(name), design.wire(name)
        own = np.searchsorted(before.s, places[1:-1] - 1e-6)
        moved = now.position[own, 1] - before.position[own, 1]
        assert moved == pytest.approx(expected[number], rel=3e-3), name


def two_strings(
    places: Array, tensions: tuple[float, float], loads: tuple[float, float], k: Array, rope: Array
) -> tuple[Array, Array]:
    """Return the lateral positions of two strings at the springs between them.

    ``T (y_i - y_(i-1))/h_i - T (y_(i+1) - y_i)/h_(i+1) + k_i (y_i - y'_i) = q (h_i + h_(i+1))/2``
    holds exactly at the springs for strings under even loads q; ``rope`` acts there besides.
    """
    h, count = np.diff(places), len(k)
    matrix, right = np.zeros((2 * count, 2 * count)), np.zeros(2 * count)
    for wire, (tension, load) in enumerate(zip(tensions, loads, strict=True)):
        for i in range(count):
            row, other = wire * count + i, (1 - wire) * count + i
            matrix[row, row] = tension * (1.0 / h[i] + 1.0 / h[i + 1]) + k[i]
            matrix[row, other] = -k[i]
            if i:
                matrix[row, row - 1] = -tension / h[i]
            if i < count - 1:
                matrix[row, row + 1] = -tension / h[i + 1]
            right[row] = 0.5 * load * (h[i] + h[i + 1]) + rope[i]
    found = np.linalg.solve(matrix, right)
    return found[:count], found[count:]


# ---- nothing, and back again --------------------------------------------------------------------


def test_nothing_changes_nothing() -> None:
    """A condition that changes nothing gives the design back to 1e-9 m, and so does one at the
    temperature of the design after a hot one."""
    back = at(15.0, "back", after="60 degC")
    design, found = states(catenary({"name": "nothing"}, at(60.0), back))
    for name in ("nothing", "back"):
        assert np.abs(found[name].position - design.position).max() < 1e-9
    assert np.abs(found["60 degC"].position - design.position).max() > 0.1


def test_weight_is_carried() -> None:
    """Under ice, wear and wind the supports carry the weight, and ice weighs what it should."""
    iced = {"name": "iced", "ice": {"thickness": "5 mm"}, "wind": {"speed": 5.0, "from": "left"}}
    design, found = states(catenary(iced, {"name": "worn", "wear": 0.2}))
    for shape in found.values():
        assert shape.weight == pytest.approx(shape.reaction, abs=1e-6)
    mass = 900.0 * 0.25 * np.pi * ((D + 0.01) ** 2 - D**2)
    length = 2.0 * 165.0 + float(design.dropper_lengths.sum())
    assert found["iced"].weight - design.weight == pytest.approx(mass * length * G, rel=2e-3)
    assert found["worn"].weight - design.weight == pytest.approx(-0.2 * 1.35 * 165.0 * G, rel=2e-3)


def test_worn_section_is_a_circle_above_a_chord() -> None:
    """Half a circle keeps half its height and 1 - 64/(9 pi^2) of half its second moment; nothing
    worn keeps all."""
    assert height_left(0.5) == pytest.approx(0.5)
    assert bending_left(0.5) == pytest.approx(0.5 * (1.0 - 64.0 / (9.0 * np.pi**2)))
    assert (height_left(0.0), bending_left(0.0)) == pytest.approx((1.0, 1.0))


# ---- what runs from there -----------------------------------------------------------------------

COLD = {
    "name": "cold",
    "temperature": -20.0,
    "reference": 15.0,
    "wind": {"speed": 8.0, "from": "left"},
    "ice": {"thickness": "3 mm"},
}


def test_everything_runs_from_the_condition() -> None:
    """The line under a condition is at rest with its wind and ice on, both engines give its
    passage alike, and its elasticity differs from that of the design."""
    quick = {"settings__start": 40.0, "settings__time_step": 2e-3, "settings__tolerance": 1e-9}
    case = catenary(COLD, **quick).with_condition("cold")
    model = build(case)
    shape = find_shape(model)
    system = equations(model, shape)
    assert out_of_balance(system, shape.position) < 1e-4
    runs = [simulate(model, shape, backend=name) for name in ("reference", "native")]
    forces = [run.contact_force("front").force for run in runs]
    assert np.sqrt(np.mean((forces[0] - forces[1]) ** 2)) < 0.05
    plain = build(case.with_condition(None))
    other = elasticity(plain, find_shape(plain)).elasticity
    assert np.abs(elasticity(model, shape).elasticity / other - 1.0).max() > 0.005


def test_modes_run_from_the_condition() -> None:
    """A cold wire between fixed ends swings sideways as a string under the tension that it has
    there, sqrt(T/m)/(2 L) within 0.1 %, 42 % above that of the design."""
    case = bare(at(-40.0)).with_condition("-40 degC")
    model = build(case)
    shape = find_shape(model)
    expected = float(np.sqrt(shape.end_pulls[1, 0] / M) / 120.0)
    found = modes(model, shape, near=expected, count=1)
    assert found.frequencies[0] == pytest.approx(expected, rel=1e-3)
    assert expected > 1.4 * np.sqrt(T / M) / 120.0


def test_state_and_case_must_agree() -> None:
    """A static state of the design is refused where the case asks for a condition."""
    model = build(catenary(COLD))
    design = find_shape(model)
    other = replace(model, case=model.case.with_condition("cold"))
    with pytest.raises(ModelError, match=r"of the design, the case asks for the condition 'cold'"):
        elasticity(other, design)


# ---- what cannot be -----------------------------------------------------------------------------


def test_arm_in_compression_is_refused() -> None:
    """Wind that takes the wire from its steady arms names every one of them."""
    case = catenary({"name": "storm", "wind": {"speed": 33.0, "from": "left"}})
    with pytest.raises(ModelError, match=r"'storm': the steady arm at support \d, x = .* push"):
        find_shape(build(case.with_condition("storm")))


def test_messenger_below_the_contact_wire_is_refused() -> None:
    """A messenger wire that sags below the contact wire is refused with the span."""
    heavy = {"name": "heavy", "wires": {"messenger": {"ice": {"mass": "6 kg/m"}}}}
    case = catenary(heavy, supports__encumbrance=0.9)
    with pytest.raises(ModelError, match=r"'messenger' hangs \d+ mm below 'contact'.* span \d"):
        find_shape(build(case.with_condition("heavy")))


def test_slow_waves_are_refused() -> None:
    """A tension with which waves are slower than the train is refused where it is given."""
    with pytest.raises(InputError, match=r"conditions\[1\].wires.contact.tension: got 9 kN, .*"):
        catenary({"name": "low", "wires": {"contact": {"tension": "9 kN"}}})


def test_missing_numbers_are_asked_for() -> None:
    """Without thermal expansion and diameter no temperature and no wind: every wire is named."""
    data = copy.deepcopy(AC_SIMPLE) | {"schema": 2}
    data["conditions"] = [at(35.0, wind={"speed": "20 m/s", "from": "left"})]
    with pytest.raises(InputError) as refused:
        make_case(data)
    text = str(refused.value)
    for part in ("wires.contact", "wires.messenger", "droppers"):
        assert f"{part}.thermal_expansion: is missing" in text
        assert f"{part}.diameter: is missing" in text
