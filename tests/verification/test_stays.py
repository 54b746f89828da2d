"""Stays of wires: ropes, bars and struts to fixed points."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tautwire.cli.app import run_command_line
from tautwire.errors import InputError, ModelError
from tautwire.inputs.load import load_case, make_case
from tautwire.line.expand import expand
from tautwire.model.build import build
from tautwire.numerics.motion.backend import make_stepper
from tautwire.numerics.motion.stepper import StepOptions
from tautwire.numerics.network.system import System
from tautwire.numerics.newmark import Newmark
from tautwire.report.parts.fitting_words import stay_state, stays_of
from tautwire.specs.case import Case

from ..lines import HAS_CORE, ac_simple, entering, found, loaded, out_of_balance
from .test_bodies import alone
from .test_conditions import states

STAY = {"name": "wind stay", "wire": "contact", "span": 2, "at": 13.0, "stiffness": 3e4}
FAR = {"end_y": 30.0, "end_z": 5.26}
"""So far to the left that the stay hardly turns."""


def stayed(case: Case, **numbers: Any) -> Case:
    """Return a case with one stay."""
    return case.with_(stays=[{**STAY, **FAR, **numbers}])


def pushed(system: System, node: int, force: float) -> float:
    """Return how far a node moves to the left under a force to the left [m]."""
    load = np.zeros(system.dof_count)
    load[6 * node + 1] = force
    moved = loaded(system, load)
    return float((moved.position - system.position)[6 * node + 1])


def marked() -> Case:
    """Return a line that has a node at the place of the stay and nothing there."""
    return stayed(ac_simple(), law="strut", slack=1.0)


def test_the_design_stays_what_it_is() -> None:
    """A stay carries nothing in the design and moves nothing."""
    _, bare, _ = found(marked())
    _, shape, system = found(stayed(ac_simple(), law="bar"))
    assert np.abs(shape.position - bare.position).max() < 1e-9
    assert out_of_balance(system, system.position) < 1e-4
    assert shape.reaction == pytest.approx(shape.weight, rel=1e-8)


@pytest.mark.parametrize(("law", "acts"), [("rope", (-1,)), ("strut", (1,)), ("bar", (-1, 1))])
def test_a_stay_is_a_spring_on_its_sides(law: str, acts: tuple[int, ...]) -> None:
    """A stay to the left adds its stiffness to that of the wires where its law lets it act."""
    model, _, bare = found(marked())
    _, _, system = found(stayed(ac_simple(), law=law))
    node = model.mesh.node(model.line.stays[0].at)
    for side in (-1, 1):
        own, both = (20.0 / pushed(one, node, side * 20.0) for one in (bare, system))
        added = abs(both) - abs(own)
        assert added == pytest.approx(3e4 if side in acts else 0.0, rel=2e-3, abs=1.0), side


def test_slack_is_run_through_first() -> None:
    """With slack s the stay acts on the way beyond it: F = k_w u + k (u - s)."""
    slack = 5e-3
    model, _, bare = found(marked())
    _, _, system = found(stayed(ac_simple(), slack=slack))
    node = model.mesh.node(model.line.stays[0].at)
    wires = -20.0 / pushed(bare, node, -20.0)
    u = -pushed(system, node, -400.0)
    assert u > slack
    assert pytest.approx(wires * u + 3e4 * (u - slack), rel=5e-3) == 400.0


@pytest.mark.parametrize("law", ["rope", "strut", "bar"])
def test_a_stay_pulls_in_the_design(law: str) -> None:
    """A wire alone goes F a b/(T L) sideways where a stay pulls with F, and stays in balance."""
    force, at = 150.0, 20.0
    plain = alone(settings__nodes_between_droppers=41)
    case = plain.with_(stays=[{**STAY, **FAR, "at": at, "law": law, "force": force}])
    _, shape, system = found(case)
    assert out_of_balance(system, system.position) < 1e-4
    assert shape.reaction == pytest.approx(shape.weight, rel=1e-8)
    (stay,) = stays_of(case)
    sign = -1.0 if law == "strut" else 1.0
    assert stay_state(shape, stay)[1] == pytest.approx(sign * force, rel=1e-3)
    y = float(np.interp(55.0 + at, shape.contact.s, shape.contact.position[:, 1]))
    exact = sign * force * at * (55.0 - at) / (case.wires.contact.tension * 55.0)
    assert y == pytest.approx(exact, rel=0.01)  # slope-continuous elements round the kink off


def windy(**numbers: Any) -> Case:
    """Return a line in wind from the left with one stay, or with none that acts."""
    case = ac_simple(
        wires__contact__diameter=0.0132,
        wires__messenger__diameter=0.014,
        droppers__diameter=0.005,
        conditions=[{"name": "gust", "wind": {"speed": 25.0, "from": "left"}}],
    )
    return stayed(case, **numbers)


def test_a_wind_stay_holds_the_wire() -> None:
    """In wind from the left a rope to the left pulls as its way over its stiffness says."""
    (free,) = states(windy(law="strut", slack=1.0))[1].values()
    case = windy()
    (held,) = states(case)[1].values()
    (stay,) = stays_of(case)
    distance, force = stay_state(held, stay)
    assert held.operated is not None
    before, nothing = stay_state(held.operated.design, stay)
    assert nothing == 0.0
    assert force == pytest.approx(3e4 * (distance - before), rel=1e-9)
    row = int(np.abs(held.contact.s - stay.at.s).argmin())
    moved = [float(one.contact.position[row, 1]) for one in (free, held, held.operated.design)]
    assert moved[0] < moved[1] < moved[2]
    assert force > 20.0
    (lee,) = states(windy(end_y=-30.0))[1].values()
    assert np.abs(lee.position - free.position).max() < 1e-6


def test_a_stay_along_the_track_takes_tension() -> None:
    """A rope along a messenger wire takes k u when the wire travels by u."""
    stiffness = 4e3
    warm = {"line__ends": {"left": "anchored", "right": "weighted"}}
    expansion = dict.fromkeys(("contact", "messenger"), 17e-6)
    case = ac_simple(
        **warm,
        **{f"wires__{name}__thermal_expansion": value for name, value in expansion.items()},
        droppers__thermal_expansion=17e-6,
        conditions=[{"name": "warm", "temperature": 55.0, "reference": 15.0}],
    )
    along = {"wire": "messenger", "end_along": -40.0, "end_y": -0.2, "end_z": 6.1}
    (free,) = states(stayed(case, **along, law="strut", slack=1.0))[1].values()
    (held,) = states(stayed(case, **along, stiffness=stiffness))[1].values()
    (stay,) = stays_of(stayed(case, **along, stiffness=stiffness))
    row = held.wire_names.index("messenger")
    taken = free.end_pulls[0, row] - held.end_pulls[0, row]
    _, force = stay_state(held, stay)
    assert abs(taken) == pytest.approx(force, rel=0.02)
    assert force > 0.5 * stiffness * 17e-6 * 40.0 * 68.0


@pytest.mark.skipif(not HAS_CORE, reason="no compiled core here")
def test_both_backends() -> None:
    """Core and reference agree to 2e-5 N on a line held by a rope, a bar and a strut."""
    case = ac_simple(line__spans=2, settings__section=(1, 1))
    near = {"end_y": 1.0, "end_z": 4.6, "stiffness": 1e5, "span": 1}
    several = [
        {**STAY, **near, "at": 13.0},
        {**STAY, **near, "at": 24.0, "law": "bar", "wire": "messenger"},
        {**STAY, **near, "at": 8.0, "law": "strut", "end_z": 6.0},
    ]
    forces = []
    for stays, choice in ((several, "native"), (several, "reference"), ([], "native")):
        system, pantographs = entering(case.with_(stays=stays))
        options = StepOptions(Newmark(), 1e-3, contact_stiffness=2e5, tolerance=1e-11)
        one = make_stepper(system, pantographs, options, np.array([2, 14]), choice)
        forces.append(one.advance(200).contact_force)
    assert np.abs(forces[0] - forces[1]).max() < 2e-5
    assert np.abs(forces[0] - forces[2]).max() > 1.0


TABLE = """\
stay;wire;span;position [m];stiffness [kN/m];end_y [m];end_z [m];slack [mm];law
wind stay;contact;2;13;800;3.1;5.6;10;rope
tie;messenger;3;20;500;-3.0;6.5;;bar
"""
HEAD = "schema: 2\ninclude: ac-simple\nname: mine\nline: {spans: 4}\nsettings: {section: [2, 3]}\n"


def test_a_table_says_the_same_as_keys(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Rows of a table and a list in the case are the same stays, which ``static`` names."""
    (tmp_path / "stays.csv").write_text(TABLE, encoding="utf-8")
    path = tmp_path / "mine.yaml"
    path.write_text(HEAD + "tables: {stays: stays.csv}\n", encoding="utf-8")
    case = load_case(path)
    listed = (
        "stays:\n"
        "  - {name: wind stay, wire: contact, span: 2, at: 13 m, stiffness: 800 kN/m,\n"
        "     end_y: 3.1 m, end_z: 5.6 m, slack: 10 mm}\n"
        "  - {name: tie, wire: messenger, span: 3, at: 20 m, stiffness: 500 kN/m, end_y: -3 m,\n"
        "     end_z: 6.5 m, law: bar}\n"
    )
    path.write_text(HEAD + listed, encoding="utf-8")
    assert load_case(path).stays == case.stays
    assert run_command_line(["static", str(path), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)["shape"]["stays"]
    assert [(one["name"], one["wire"], one["force_n"]) for one in told] == [
        ("wind stay", "contact", 0.0),
        ("tie", "messenger", pytest.approx(0.0, abs=1e-3)),
    ]


def test_the_side_of_a_far_end_follows_the_chainage(tmp_path: Path) -> None:
    """Beside falling chainages the far ends of a table keep their side of rising chainage."""
    (tmp_path / "stays.csv").write_text(TABLE, encoding="utf-8")
    path = tmp_path / "mine.yaml"
    text = HEAD.replace("line: {spans: 4}\n", "")
    path.write_text(text + "tables: {stays: stays.csv, supports: masts.csv}\n", encoding="utf-8")
    found = []
    for chainages in ((0, 55, 110, 165, 220), (220, 165, 110, 55, 0)):
        rows = "".join(f"{n};{x};0.2\n" for n, x in enumerate(chainages, 1))
        table = f"support;chainage [m];contact_stagger [m]\n{rows}"
        (tmp_path / "masts.csv").write_text(table, encoding="utf-8")
        case = load_case(path)
        found.append([*(one.end_y for one in case.stays), case.supports.contact_staggers(5)[0]])
    assert found == [[3.1, -3.0, 0.2], [-3.1, 3.0, -0.2]]


REFUSED = {
    "slack bar": ({"law": "bar", "slack": 0.01}, "stays[1].slack (stay 'wind stay'): belongs to"),
    "slack and force": ({"force": 50.0, "slack": 0.01}, "one that is slack has no force"),
    "no such wire": ({"wire": "stitch"}, "stays[1].wire (stay 'wind stay'): got 'stitch'; there"),
    "no such law": ({"law": "chain"}, "stays[1].law (stay 'wind stay'): got 'chain'; choose"),
    "no stiffness": ({"stiffness": 0.0}, "stays[1].stiffness (stay 'wind stay'): got 0"),
    "no such span": ({"span": 9}, "stays[1].span (stay 'wind stay'): got 9; the line has 3"),
}


@pytest.mark.parametrize("fault", REFUSED)
def test_refused(fault: str) -> None:
    """A stay that cannot be is refused with place and cure."""
    numbers, words = REFUSED[fault]
    data = ac_simple().to_dict()
    data["stays"] = [{**STAY, **FAR, **numbers}]
    with pytest.raises(InputError) as caught:
        make_case(data)
    assert words in "\n".join(caught.value.problems)


def test_without_a_place() -> None:
    """A stay at an anchor, beside a dropper or with its far end at the wire is refused."""
    with pytest.raises(InputError, match="there is no wire 'contact' at 0 m"):
        expand(stayed(ac_simple(), span=1, at=0.0))
    with pytest.raises(InputError, match="20 mm beside something else on the wire"):
        expand(stayed(ac_simple(), at=10.27))
    assert len(build(stayed(ac_simple(), at=0.0)).line.stays) == 1
    with pytest.raises(ModelError, match=r"its far end is 0.0. m from the wire"):
        found(stayed(ac_simple(), end_y=-0.1, end_z=5.26))
