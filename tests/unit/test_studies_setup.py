"""Set-up shared by the cases of a study: never another line's, and never another bit."""

from __future__ import annotations

import dataclasses
import json
from typing import Any

import numpy as np
import pytest

from tautwire.analyses.road.shape import find_shape
from tautwire.inputs.load import load_case
from tautwire.model.build import build
from tautwire.results.equilibrium import Equilibrium
from tautwire.specs.case import Case
from tautwire.studies.execution import setup
from tautwire.studies.execution.setup import Lines, key_of_shape
from tautwire.studies.execution.task import simulate_case

BASE = {"line.spans": 3, "settings.nodes_between_droppers": 3, "settings.section": [2, 2]}
UNEVEN = [{"kind": "uniform", "spacing": "1 m", "amplitude": "0.5 mm"}]
INSTALLED = {"of": "height", "distribution": "uniform", "amplitude": "1 mm"}

SAME_LINE: list[dict[str, Any]] = [
    {"scenario.speed": "250 km/h"},
    {"scenario.direction": "-x"},
    {"settings.contact_stiffness": "50 kN/m"},
    {"settings.time_step": "2 ms"},
    {"settings.seed": 7},
    {"irregularities.unevenness": UNEVEN, "settings.seed": 7},
    {"pantographs[1].stages[1].mass": 7.5},
    {"line.damping.stiffness": 0.0},
    {"title": "Another title"},
]
OTHER_LINE: list[dict[str, Any]] = [
    {"settings.nodes_between_droppers": 4},
    {"wires.contact.tension": "20 kN"},
    {"wires.messenger.mass": 1.1},
    {"wires.contact.bending_stiffness": 140.0},
    {"supports.encumbrance": 1.25},
    {"supports.contact_stagger": 0.25},
    {"supports.closure": "lift", "supports.lift": "20 N"},
    {"droppers.stiffness": "150 kN/m"},
    {"line.gravity": 9.8},
    {"line.spans": 4},
    {"irregularities.installation": INSTALLED, "settings.seed": 1},
    {"irregularities.installation": INSTALLED, "settings.seed": 2},
    {"irregularities.installation": {**INSTALLED, "of": "length"}, "settings.seed": 2},
]


def case_of(changes: dict[str, Any]) -> Case:
    return load_case("ac-simple", {**BASE, **changes})


def equal(one: Any, other: Any) -> bool:
    """Say whether two shapes, or parts of them, agree to the last bit."""
    if not dataclasses.is_dataclass(one):
        return np.array_equal(one, other)
    return all(
        equal(getattr(one, field.name), getattr(other, field.name))
        for field in dataclasses.fields(one)
    )


def test_shapes_are_those_found_afresh(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever is changed, in whatever order: the shape is that of the case, to the last bit."""
    lines, solved = Lines(), 0

    def counted(model: Any) -> Equilibrium:
        nonlocal solved
        solved += 1
        return find_shape(model)

    monkeypatch.setattr(setup, "find_shape", counted)
    for changes in ({}, *SAME_LINE, *OTHER_LINE, *SAME_LINE[:3], {}):
        case = case_of(changes)
        model, shape = lines.at_rest(case)
        assert model.case == case
        assert equal(shape, find_shape(build(case))), changes
    damped = 1  # damping is part of the line: it costs a solution, and is none
    assert solved == 1 + damped + len(OTHER_LINE)


def test_keys_tell_lines_apart() -> None:
    """Every change of the line has a key of its own, what is no change of it has none."""
    keys = [key_of_shape(build(case_of(changes))) for changes in ({}, *OTHER_LINE)]
    assert len(set(keys)) == len(keys)
    for changes in SAME_LINE:
        same = key_of_shape(build(case_of(changes))) == keys[0]
        assert same is ("line.damping.stiffness" not in changes), changes


def test_the_oldest_are_forgotten(monkeypatch: pytest.MonkeyPatch) -> None:
    """No more shapes are kept than asked for; the one used last stays."""
    found: list[int] = []
    monkeypatch.setattr(
        setup, "find_shape", lambda model: found.append(model.case.line.spans) or find_shape(model)
    )
    lines = Lines(most=2)
    for spans in (3, 4, 3, 5, 3, 4):
        lines.at_rest(case_of({"line.spans": spans}))
    assert found == [3, 4, 5, 4]


def test_kept_histories_change_no_number() -> None:
    """A case whose histories are kept, and which so has pictures 20 ms apart, gives the very
    numbers of one whose are not, tuned mean force and error bars among them."""
    case = case_of({"settings.error": "estimate", "scenario.mean_force": 120.0})
    kept, image = simulate_case(case, True)
    plain, nothing = simulate_case(case, False)
    assert image is not None
    assert nothing is None
    assert kept["tuning_passes"] > 1
    assert json.dumps(kept) == json.dumps(plain)
