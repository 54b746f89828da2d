"""Forces on supports, installation and distances to structures against closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tautwire.analyses.design.conditions import examine
from tautwire.analyses.design.masts import Masts, masts_of
from tautwire.analyses.design.supports import support_forces, totals
from tautwire.analyses.road.operate import operate
from tautwire.analyses.road.shape import find_design
from tautwire.errors import InputError
from tautwire.formulas.curve import radial_pull
from tautwire.inputs.load import make_case
from tautwire.model.build import build
from tautwire.specs.case import Case

from .test_conditions import EA, D, G, M, T, at, bare, catenary

WIND = {"speed": 15.0, "from": "right"}
ENDS = {"left": "anchored", "right": "weighted"}
PRESSURE = 0.5 * 1.25 * 15.0**2


def masts(case: Case) -> Masts:
    """Return forces and installation of the design and all conditions of a case."""
    model = build(case)
    design = find_design(model)
    names = (None, *(one.name for one in case.conditions))
    return masts_of(model, [examine(model, design, name, with_elasticity=False) for name in names])


@pytest.mark.parametrize("motion", ["swinging", "vertical"])
def test_forces_balance_weight_and_wind(motion: str) -> None:
    """In every state the forces on supports sum to the weight of the line, upwards negative, and
    to the wind on wires and droppers; along the track nothing is left over."""
    case = catenary(
        at(40.0, wind=WIND),
        {"name": "iced", "ice": {"mass": "0.5 kg/m"}},
        supports__arm={"motion": motion},
    )
    model = build(case)
    design = find_design(model)
    for name in (None, *(one.name for one in case.conditions)):
        own = replace(model, case=case.with_condition(name))
        shape = operate(own, design)
        force = np.array([[f.along, f.lateral, f.vertical] for f in support_forces(own, shape)])
        assert abs(force[:, 2].sum() + shape.weight) < 1e-2
        assert abs(force[:, 0].sum()) < 1e-2
        assert shape.operated is None or abs(force[0, 0]) > 1e4
        blown = 0.0
        if name == "40 degC":
            wires = sum(float(w.lengths.sum()) for w in shape.wires)
            blown = PRESSURE * D * (wires + float(shape.dropper_lengths.sum()))
        assert force[:, 1].sum() == pytest.approx(blown, rel=2e-3, abs=1e-2)


def on_fine_mesh(case: Case, name: str | None = None) -> tuple[float, float]:
    """Return lateral and vertical force on support 2, extrapolated to elements of no length: a
    slope-continuous wire is too stiff at a kink by an error that is linear in their length."""
    found = []
    for nodes in (39, 159):
        settings = case.settings.with_(nodes_between_droppers=nodes)
        model = build(case.with_(settings=settings, condition=name))
        support = totals(support_forces(model, operate(model, find_design(model))))[1]
        found.append((support.lateral, support.vertical))
    (y, z), (y_fine, z_fine) = found
    return (4.0 * y_fine - y) / 3.0, (4.0 * z_fine - z) / 3.0


def test_lateral_force_of_stagger_and_wind() -> None:
    """A single wire in zigzag pulls a support with ``4 T b / L`` towards the middle, and the wind
    adds ``q L``, within 0.05 %; what it carries is the weight of a span, longer by 0.01 % for its
    sag and zigzag."""
    case = bare({"name": "windy", "wind": WIND}, spans=3, stagger=0.2, ends=ENDS)
    (still, weight), windy = on_fine_mesh(case), on_fine_mesh(case, "windy")[0]
    assert weight == pytest.approx(-M * G * 60.0 / (1.0 + T / EA), rel=2e-4)
    assert still == pytest.approx(4.0 * T * 0.2 / 60.0, rel=5e-4)
    assert windy - still == pytest.approx(PRESSURE * D * 60.0, rel=5e-4)


@pytest.mark.parametrize("hand", ["left", "right"])
def test_radial_pull(hand: str) -> None:
    """In a curve a support is pulled to the inside with ``2 T sin(L / 2R)``, within 0.01 %."""
    radius, sign = 800.0, 1.0 if hand == "left" else -1.0
    track = [{"arc": 180.0, "radius": radius, "side": hand}]
    case = make_case(bare(spans=3, ends=ENDS).to_dict() | {"track": track})
    assert on_fine_mesh(case)[0] == pytest.approx(sign * radial_pull(T, 60.0, radius), rel=1e-4)


def test_installation_follows_the_travel() -> None:
    """Cantilevers stand off by alpha dT times their distance from the fixed end, weights sink by
    their ratio times the travel of the end."""
    ends = {"left": "anchored", "right": {"weights": {"ratio": 3.0}}}
    found = masts(bare(at(-20.0), at(40.0), spans=4, ends=ends))
    assert found.temperatures == (-20.0, 40.0)
    rows = {(one.support, one.what): one.offsets for one in found.installation}
    for number in (2, 3, 4):
        strain = np.array([-35.0, 25.0]) * 17e-6
        expected = strain * 60.0 * (number - 1)
        assert np.allclose(rows[number, "cantilever"], expected, rtol=1e-3)
        assert np.allclose(rows[5, "weight"], -3.0 * strain * 240.0, rtol=1e-3)


def test_requirements_are_named() -> None:
    """An arm that pulls more, or less, than it may is named with its place, and so is a bridge to
    which too little is left; what is kept is not."""
    bridge = {"name": "bridge", "at": 60.0, "length": 10.0, "height": 6.75, "uplift": 0.1}
    case = catenary(
        {"name": "windy", "wind": WIND},
        requirements={
            "arm_pull": {"least": 80.0, "most": [900.0, 340.0, 900.0, 900.0]},
            "structures": [bridge | {"clearance": 0.27}, bridge | {"clearance": 0.4}],
        },
    )
    found = masts(case)
    forces = {one.support: one for one in found.states[0].forces if one.held_by == "registration"}
    assert 80.0 < abs(forces[2].lateral) < 340.0
    design = [text for name, text in found.exceeded if name == "design"]
    assert len(design) == 1
    assert "bridge" in design[0]
    windy = [text for name, text in found.exceeded if name == "windy" and "arm" in text]
    assert len(windy) == 1
    assert "support 2, x = 55 m" in windy[0]
    assert "more than 340 N" in windy[0]
    kept, missed = found.states[0].clearances
    assert kept.is_kept
    assert not missed.is_kept
    assert kept.left_over == pytest.approx(6.75 - kept.height - 0.1)


def test_requirements_are_checked() -> None:
    """A list that is too short and a structure beyond the line are refused together."""
    with pytest.raises(InputError) as told:
        catenary(
            requirements={
                "arm_pull": {"most": [1.0, 2.0]},
                "structures": [
                    {"name": "b", "at": 160, "length": 20, "height": 7, "uplift": 0, "clearance": 0}
                ],
            }
        )
    assert "requirements.arm_pull.most" in str(told.value)
    assert "requirements.structures[1].at" in str(told.value)
