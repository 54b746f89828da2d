"""What users bring: each row of the table of first attempts, with an input of the same kind.

Recordings, workbooks and curves have tests of their own.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tautwire.analyses.road.elasticity import elasticity
from tautwire.analyses.road.pipeline import run_case
from tautwire.analyses.road.shape import find_shape
from tautwire.analyses.vibration.wavelengths import line_lengths
from tautwire.errors import InputError
from tautwire.inputs.load import make_case
from tautwire.line.expand import expand
from tautwire.model.build import build
from tautwire.model.plausibility import implausible_inputs, implausible_shape
from tautwire.model.preflight import preflight
from tautwire.model.resolution import resolution
from tautwire.specs.case import Case
from tautwire.specs.pantograph import Air

PANTOGRAPH: dict[str, Any] = {
    "name": "metro",
    "stages": [
        {"mass": "7 kg", "stiffness": "9 kN/m", "damping": "12 N s/m"},
        {"mass": "14 kg", "stiffness": "50 N/m", "damping": "65 N s/m"},
    ],
    "static_force": "75 N",
}
SIMPLE: dict[str, Any] = {
    "schema": 2,
    "name": "metro",
    "line": {"spans": 7, "span_length": "50 m"},
    "wires": {
        "contact": {
            "tension": "14 kN", "mass": "1.07 kg/m", "axial_stiffness": "14 MN",
            "bending_stiffness": "130 N m^2",
        },
        "messenger": {
            "tension": "14 kN", "mass": "0.85 kg/m", "axial_stiffness": "9.5 MN",
            "bending_stiffness": "60 N m^2",
        },
    },
    "supports": {
        "contact_height": "5.1 m", "encumbrance": "1.3 m", "contact_stagger": "0.25 m",
        "closure": "lift",
    },
    "droppers": {
        "mode": "height", "positions": [5, 15, 25, 35, 45], "presag": [0, 0, 0, 0, 0],
        "stiffness": "150 kN/m",
    },
    "pantographs": [PANTOGRAPH],
    "scenario": {"speed": "150 km/h"},
    "settings": {"section": [3, 5]},
}  # fmt: skip


def case_of(**changes: Any) -> Case:
    """Return the simple line with some values replaced, two underscores for a dot."""
    return make_case(SIMPLE, {path.replace("__", "."): value for path, value in changes.items()})


def refusals(**changes: Any) -> list[str]:
    """Return the problems for which a changed line is refused."""
    with pytest.raises(InputError) as caught:
        case_of(**changes)
    return list(caught.value.problems)


def test_published_line_without_numerical_choices() -> None:
    """No paper gives contact stiffness, mesh or step: stated defaults for all (01, 02)."""
    case = case_of(wires__contact__tension="1430 kgf")
    assert case.wires.contact.tension == pytest.approx(1430 * 9.80665)
    assert resolution(case, expand(case)).carries(200.0)
    assert [item.topic for item in preflight(case)] == ["uplift force", "contact stiffness"]
    problems = refusals(wires__contact__mass="1.07 kN", scenario__speed="fast")
    assert len(problems) == 2


def test_trolley_wire_alone() -> None:
    """One wire on span wires: elasticity at supports and between them, the mesh by length (03)."""
    data = {key: value for key, value in SIMPLE.items() if key != "droppers"}
    data |= {"wires": {"contact": SIMPLE["wires"]["contact"]}, "line": {"spans": 5,
             "span_length": "35 m"}, "settings": {"section": [3, 3], "band": "50 Hz"}}  # fmt: skip
    data["supports"] = {
        "contact_height": "5.5 m", "contact_stagger": "0.2 m", "closure": "spring",
        "spring": {"stiffness": "2 kN/m"},
    }  # fmt: skip
    case = make_case(data)
    model = build(case)
    found = elasticity(model, find_shape(model))
    assert found.kind == ("support", "middle", "support")
    assert found.elasticity[1] > found.elasticity[0]
    longest = max(np.diff(strand.s).max() for strand in model.mesh.strands)
    assert longest < 2.0


def test_second_wires_are_described_by_name() -> None:
    """Two contact wires by a count, a stitch wire by its length: what to write instead (04, 05)."""
    text = "\n".join(refusals(wires__contact__count=2, wires__contact__spacing="40 mm"))
    assert "wires.contact.count: unknown key; it is given as wires, each wire by a name" in text
    assert "wires.contact.spacing: unknown key; did you mean 'side'?" in text
    stitch = {"tension": "2.8 kN", "mass": "0.3 kg/m", "length": "18 m", "role": "stitch"}
    assert "did you mean 'from'?" in "\n".join(refusals(wires__stitch=stitch))


@pytest.mark.slow
def test_raised_ends_keep_the_mean_force() -> None:
    """Ends that rise to the anchors leave the mean force at what acts, within 5 % (09)."""
    heights = [5.6, 5.3, *[5.1] * 4, 5.3, 5.6]
    case = case_of(supports__contact_height=heights, supports__encumbrance="1.5 m",
                   settings__band="20 Hz", settings__time_step="2 ms")  # fmt: skip
    run = run_case(case)
    record = run.pantographs[0]
    inside = (record.position > 100.0) & (record.position < 250.0)
    assert record.contact_force[inside].mean() == pytest.approx(75.0, rel=0.05)
    assert not [text for text in run.warnings if text.startswith("mean force")]


def test_forces_on_two_stages() -> None:
    """A static force below and an aerodynamic one on the head act together (10)."""
    stages = [{**PANTOGRAPH["stages"][0], "force": {"constant": "5 N", "per_speed": "0.1 N/(m/s)"}},
              PANTOGRAPH["stages"][1]]  # fmt: skip
    case = case_of(pantographs=[{**PANTOGRAPH, "stages": stages}])
    assert case.pantographs[0].stages[0].force.at(Air(40.0)) == pytest.approx(9.0)


def test_rigid_rail_is_named_first() -> None:
    """A conductor rail is refused by its name before what is missing because of it (13)."""
    data = {key: value for key, value in SIMPLE.items() if key not in ("wires", "droppers")}
    with pytest.raises(InputError) as caught:
        make_case({**data, "conductor_rail": {"mass": "18 kg/m"}})
    assert "conductor_rail: not modelled yet" in caught.value.problems[0]


@pytest.mark.parametrize(
    ("path", "answer"),
    [
        ("line__ice_thickness", "conditions"),
        ("line__y_rope", "wires"),
        ("supports__system_height", "encumbrance"),
        ("supports__wire_height", "contact_height"),
        ("supports__registration_arm", "arm"),
        ("line__section_insulators", "bodies"),
        ("supports__uplift_stop", "stop"),
    ],
)
def test_words_of_the_trade(path: str, answer: str) -> None:
    """Words for keys or for what is not modelled are answered with the key or by name (14)."""
    (problem,) = refusals(**{path: 1})
    assert answer in problem
    assert "known here are" not in problem


def test_us_units() -> None:
    """Feet, inches, pounds per foot and pounds of force are read (18)."""
    case = case_of(line__span_length="160 ft", wires__contact__tension="3.1 kip",
                   wires__contact__mass="0.72 lb/ft", supports__encumbrance="52 in",
                   scenario__speed="60 mph")  # fmt: skip
    assert case.line.span_lengths()[0] == pytest.approx(48.768)
    assert case.wires.contact.tension == pytest.approx(13789.5, rel=1e-4)
    assert case.wires.contact.mass == pytest.approx(1.0715, rel=1e-3)
    assert case.scenario.speed == pytest.approx(26.8224)


def test_published_line_with_height_is_warned() -> None:
    """Low tension and wide first gaps: steep arms are told, 'lift' cures them (30, 33)."""
    low = {"wires__contact__tension": "9 kN", "settings__band": "20 Hz",
           "droppers__positions": [8, 19, 31, 42]}  # fmt: skip
    texts = {}
    for closure in ("height", "lift"):
        case = case_of(
            **low, supports__closure=closure, droppers__presag=[0.002, 0.01, 0.01, 0.002]
        )
        texts[closure] = [str(a) for a in implausible_shape(case, find_shape(build(case)))]
    assert any(text.startswith("steady arms: ") for text in texts["height"])
    assert texts["lift"] == []


def test_pairs_of_droppers() -> None:
    """Pairs half a metre apart: DD is theirs, and rounding is told where it decides (32)."""
    positions = [5, 15, 15.5, 24.75, 25.25, 34.5, 35, 45]
    case = case_of(droppers__positions=positions, wires__contact__tension="26 kN",
                   droppers__presag=["0 mm", *["6 mm"] * 6, "0 mm"])  # fmt: skip
    assert line_lengths(case).dropper_interval == pytest.approx(9.75, abs=0.51)
    assert any(item.topic == "pre-sag" for item in implausible_inputs(case))


def test_ropes_without_bending_stiffness() -> None:
    """A thin rope may have no bending stiffness; the line is found (33)."""
    case = case_of(wires__messenger__bending_stiffness=0, settings__band="20 Hz")
    assert find_shape(build(case)).residual < 1e-4


def test_low_encumbrance_is_one_message() -> None:
    """An encumbrance too small is one message with the one that is needed (37)."""
    (problem,) = refusals(supports__encumbrance="0.2 m")
    assert "supports.encumbrance: is too small" in problem
    assert "give at least" in problem
