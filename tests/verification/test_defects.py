"""Defects: each at its place, the rest of the line with the lengths of its design."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tautwire.analyses.road.dynamics import simulate
from tautwire.analyses.road.elasticity import elasticity
from tautwire.analyses.road.operate import operate
from tautwire.analyses.road.shape import find_design, find_shape
from tautwire.errors import InputError
from tautwire.inputs.load import load_case, make_case
from tautwire.model.build import Model, build
from tautwire.results.equilibrium import Equilibrium

from ..lines import out_of_balance
from .test_conditions import at, bare, catenary

G = 9.81


def defective(*defects: dict[str, Any], **changes: Any) -> tuple[Model, Equilibrium, Equilibrium]:
    """Return model, design and state of AC simple with some defects."""
    case = catenary({"name": "broken", "defects": list(defects)}, **changes)
    model = build(case.with_condition("broken"))
    design = find_design(model)
    return model, design, operate(model, design)


def middle(shape: Equilibrium) -> slice:
    """Return the droppers of span 2."""
    rows = np.flatnonzero(shape.dropper_span == 2)
    return slice(int(rows[0]), int(rows[-1]) + 1)


def test_missing_dropper() -> None:
    """Without a dropper and its clamps all others keep their unstrained length to 1e-12 m, the
    balance holds to 1e-6 N, the weight is less by what is gone, the neighbours carry more."""
    model, design, shape = defective({"kind": "missing dropper", "span": 2, "dropper": 5})
    row = middle(design).start + 4
    assert shape.dropper_forces[row] == 0.0
    others = np.delete(np.arange(len(design.dropper_x)), row)
    change = shape.dropper_lengths_unstrained - design.dropper_lengths_unstrained
    assert np.abs(change[others]).max() < 1e-12
    assert np.array_equal(shape.cable_lengths, design.cable_lengths)
    gone = (0.165 + 0.195 + 0.117 * design.dropper_lengths_unstrained[row]) * G
    assert design.weight - shape.weight == pytest.approx(gone, abs=1e-9)
    assert shape.weight == pytest.approx(shape.reaction, abs=1e-6)
    assert shape.operated is not None
    assert out_of_balance(shape.operated.system, shape.position) < 1e-6
    near = shape.dropper_forces[[row - 1, row + 1]]
    assert (near > design.dropper_forces[[row - 1, row + 1]] + 5.0).all()
    height = shape.dropper_heights[row] - design.dropper_heights[row]
    assert -0.05 < height < -0.001
    points = elasticity(model, shape), elasticity(replace_condition(model), design)
    at_dropper = [i for i, k in enumerate(points[0].kind) if k == "dropper"][4]
    assert points[0].elasticity[at_dropper] > points[1].elasticity[at_dropper]


def replace_condition(model: Model) -> Model:
    """Return the model with the design chosen."""
    return replace(model, case=model.case.with_condition(None))


def test_slack_dropper_hangs() -> None:
    """A slack dropper carries nothing and weighs as before."""
    _, design, shape = defective({"kind": "slack dropper", "span": 2, "dropper": 2})
    assert shape.dropper_forces[middle(design).start + 1] == 0.0
    assert shape.weight == pytest.approx(design.weight, abs=1e-9)


def test_longer_dropper_carries_less() -> None:
    """A dropper longer by 5 mm lets the wire down and carries less, one shorter by 5 mm the
    reverse; the balance holds to 1e-6 N."""
    for change, sign in ((5e-3, -1.0), (-5e-3, 1.0)):
        defect = {"kind": "dropper length", "span": 2, "dropper": 3, "change": change}
        _, design, shape = defective(defect)
        row = middle(design).start + 2
        lengths = shape.dropper_lengths_unstrained - design.dropper_lengths_unstrained
        assert lengths[row] == pytest.approx(change, abs=1e-12)
        assert np.abs(np.delete(lengths, row)).max() < 1e-12
        assert sign * (shape.dropper_forces[row] - design.dropper_forces[row]) > 5.0
        assert sign * (shape.dropper_heights[row] - design.dropper_heights[row]) > 1e-3
        assert shape.weight == pytest.approx(shape.reaction, abs=1e-6)


def test_swapped_droppers() -> None:
    """Two droppers that hang in each other's place have each other's length."""
    _, design, shape = defective({"kind": "swapped droppers", "span": 2, "dropper": 1, "with": 3})
    one, other = middle(design).start, middle(design).start + 2
    before, now = design.dropper_lengths_unstrained, shape.dropper_lengths_unstrained
    assert (now[one], now[other]) == (before[other], before[one])
    assert shape.dropper_forces[one] > design.dropper_forces[one]


def test_broken_arm() -> None:
    """Where a steady arm is gone the wire runs straight past the support, 0.2 m to the side, and
    carries no half of the arm's weight."""
    model, design, shape = defective({"kind": "broken steady arm", "support": 3})
    node = model.mesh.node(model.line.registrations[1].at)
    moved = (shape.position - design.position).reshape(-1, 6)[node]
    assert abs(moved[1]) > 0.1
    assert shape.arm_forces[1] == 0.0
    assert shape.arm_forces[0] > 0.0
    assert design.weight - shape.weight == pytest.approx(0.5 * 0.73 * 1.22 * G, abs=1e-9)


def test_displaced_support() -> None:
    """A support 30 mm to the left and 20 mm lower takes the messenger wire with it, and the steady
    arm's end."""
    defect = {"kind": "displaced support", "support": 2, "lateral": 0.03, "vertical": -0.02}
    model, design, shape = defective(defect)
    node = model.mesh.node(model.line.suspensions[0].at)
    moved = (shape.position - design.position).reshape(-1, 6)[node]
    assert moved[1] == pytest.approx(0.03, abs=1e-12)
    assert moved[2] == pytest.approx(-0.02, abs=2e-3)
    assert shape.arm_ends[0, 1:] - design.arm_ends[0, 1:] == pytest.approx([0.03, -0.02], abs=1e-12)
    assert shape.arm_forces[0] > 0.0


def test_extra_mass() -> None:
    """A clamp of 3 kg lets the wire down where it sits, between two droppers, by its weight times
    the elasticity there, and the wire has a node for it."""
    defect = {"kind": "extra mass", "span": 2, "at": 13.0, "wire": "contact", "mass": 3.0}
    model, design, shape = defective(defect)
    wire = model.mesh.strand("contact")
    node = int(wire.nodes[wire.position(55.0 + 13.0)])
    assert wire.s[wire.position(55.0 + 13.0)] == pytest.approx(68.0, abs=1e-9)
    sunk = (design.position - shape.position)[6 * node + 2]
    points = elasticity(replace_condition(model), design, force=3.0 * G)
    there = np.interp(68.0, points.x, points.elasticity)
    assert sunk == pytest.approx(3.0 * G * there, rel=0.05)
    assert shape.weight - design.weight == pytest.approx(3.0 * G, abs=1e-9)


def test_seized_device() -> None:
    """A seized device holds its wire: a cold wire pulls as one between fixed ends."""
    ends = {"left": "anchored", "right": "weighted"}
    seized = {"kind": "seized tensioning device", "wire": "contact", "end": "right"}
    cold = at(-10.0, "seized", defects=[seized])
    pulls = []
    for how, name in ((ends, "seized"), ("anchored", "fixed")):
        one = cold if name == "seized" else at(-10.0, "fixed")
        case = bare(one, spans=3, span=50.0, ends=how).with_condition(name)
        pulls.append(find_shape(build(case)).end_pulls[1, 0])
    assert pulls[0] == pytest.approx(pulls[1], rel=1e-9)
    assert pulls[0] > 11e3


def test_broken_stitch_wire() -> None:
    """Without its stitch wire the contact wire sinks at the support, its stitch droppers carry
    nothing, and a passage runs on both engines alike."""
    data = load_case("ac-stitched").to_dict()
    data["line"] |= {"spans": 4, "span_length": 65.0}
    data["settings"] |= {"section": [2, 3], "nodes_between_droppers": 4, "time_step": 2e-3}
    data["settings"] |= {"start": 80.0}
    data["conditions"] = [
        {"name": "broken", "defects": [{"kind": "broken stitch wire", "support": 3}]}
    ]
    model = build(make_case(data).with_condition("broken"))
    design = find_design(model)
    shape = operate(model, design)
    near = np.abs(shape.dropper_x - 130.0) < 6.0
    assert near.sum() == 2
    assert (shape.dropper_forces[near] == 0.0).all()
    assert (design.dropper_forces[near] > 0.0).all()
    assert (shape.dropper_heights[near] < design.dropper_heights[near] - 1e-3).all()
    runs = [simulate(model, shape, backend=name) for name in ("reference", "native")]
    name = runs[0].pantographs[0].name
    forces = [run.contact_force(name).force for run in runs]
    assert np.sqrt(np.mean((forces[0] - forces[1]) ** 2)) < 0.05


def test_places_are_checked() -> None:
    """Places that the line does not have are told all together, with what there is."""
    defects = [
        {"kind": "missing dropper", "span": 2, "dropper": 12},
        {"kind": "broken stitch wire", "support": 2},
        {"kind": "seized tensioning device", "wire": "contact", "end": "left"},
    ]
    with pytest.raises(InputError) as refused:
        build(catenary({"name": "broken", "defects": defects}))
    text = str(refused.value)
    assert "conditions[1].defects[1]: got dropper 12; span 2 has 1 to 9" in text
    assert "defects[2]: there is no stitch wire at support 2" in text
    assert "defects[3]: the left end of 'contact' has no tensioning device" in text


def test_every_defect_is_told_with_its_place() -> None:
    """A defect in words names its kind and its place."""
    defects = [
        {"kind": "missing dropper", "span": 2, "dropper": 5},
        {"kind": "dropper length", "span": 1, "dropper": 2, "change": "-5 mm"},
        {"kind": "displaced support", "support": 2, "lateral": "30 mm"},
        {"kind": "extra mass", "span": 2, "at": "13 m", "wire": "contact", "mass": "3 kg"},
    ]
    case = catenary({"name": "broken", "defects": defects})
    assert [str(defect) for defect in case.conditions[0].defects] == [
        "missing dropper: dropper 5 of span 2",
        "dropper length: dropper 2 of span 1, -5 mm",
        "displaced support: support 2, lateral +30 mm",
        "extra mass: 3 kg on contact, span 2 at 13 m",
    ]
