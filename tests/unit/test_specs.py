"""Specs: what they accept, what they hold, how they change."""

from __future__ import annotations

import json
import math
from typing import Any

import pytest
from pydantic import ValidationError

from tautwire.inputs.load import load_case
from tautwire.inputs.paths import USE, find_target, parse_path
from tautwire.specs import (
    Arm,
    Case,
    Droppers,
    DropperStiffness,
    Integrator,
    Line,
    MeanForceLaw,
    Pantograph,
    RoofMotion,
    Scenario,
    Settings,
    Stage,
    Supports,
    SupportSpring,
    Wire,
    case_json_schema,
)
from tautwire.specs.schema import vocabulary
from tautwire.specs.schema.vocabulary import (
    Meaning,
    folded,
    meaning_of,
    words_for,
)
from tautwire.tables.columns import KINDS

STAGE = {"mass": 7.5, "stiffness": 7000.0, "damping": 45.0}


@pytest.fixture(scope="module")
def case() -> Case:
    """The reference line."""
    return load_case("ac-simple")


def message_of(spec: type, **fields: Any) -> str:
    """Return what validation says about fields."""
    with pytest.raises(ValidationError) as caught:
        spec(**fields)
    return str(caught.value)


def test_wire_takes_units_and_si() -> None:
    """A field holds SI whether it was given with a unit or without."""
    given: dict[str, Any] = {
        "tension": "22 kN",
        "mass": 1.35,
        "axial_stiffness": "15 MN",
        "bending_stiffness": "195 N m^2",
    }
    wire = Wire(**given)
    assert (wire.tension, wire.mass, wire.axial_stiffness) == (22e3, 1.35, 15e6)


def test_wave_speed_of_the_reference_contact_wire(case: Case) -> None:
    """The wave speed of 22 kN on 1.35 kg/m is 127.66 m/s (closed form sqrt(T/m))."""
    assert case.wires.contact.wave_speed() == pytest.approx(127.66, abs=0.005)


def test_specs_are_frozen(case: Case) -> None:
    """A spec cannot be changed in place, and unknown fields are refused."""
    with pytest.raises(ValidationError, match="frozen"):
        case.line.spans = 3
    assert "extra_forbidden" in message_of(Arm, lenght=1.0)


def test_with_revalidates(case: Case) -> None:
    """A change by dotted path converts units, checks ranges and contradictions."""
    changed = case.with_(**{"scenario.speed": "275 km/h", "line.ends.left": "weighted"})
    assert changed.scenario.speed == pytest.approx(275 / 3.6)
    assert (changed.line.ends.left, changed.line.ends.right) == ("weighted", "anchored")
    with pytest.raises(ValidationError, match="greater than 0"):
        case.with_(**{"wires.contact.mass": -1.0})
    with pytest.raises(ValidationError, match="wave speed"):
        case.with_(**{"scenario.speed": "500 km/h"})
    with pytest.raises(ValidationError, match="Extra inputs"):
        case.with_(colour="red")


def test_with_creates_an_optional_spec(case: Case) -> None:
    """A dotted path below an empty optional field creates it."""
    changed = case.supports.with_(**{"spring.stiffness": "300 N/m", "closure": "spring"})
    assert changed.spring == SupportSpring(stiffness=300.0)


def test_with_keeps_one_force(case: Case) -> None:
    """Setting the mean force clears the prescribed force and the reverse."""
    prescribed = case.with_(**{"scenario.uplift_force": 150.0})
    assert prescribed.scenario.mean_force is None
    tuned = prescribed.with_(**{"scenario.mean_force": "169 N"})
    assert (tuned.scenario.mean_force, tuned.scenario.uplift_force) == (169.0, None)


def test_case_survives_json(case: Case) -> None:
    """A case written as JSON and read again is equal and has the same hash."""
    again = Case.model_validate(json.loads(json.dumps(case.to_dict())))
    assert again == case
    assert again.hash() == case.hash()


def test_hash_is_stable(case: Case) -> None:
    """The hash depends on values, not on the way they were written, and changes with them."""
    same = case.with_(**{"scenario.speed": 320 / 3.6})
    other = case.with_(**{"scenario.speed": "321 km/h"})
    assert len(case.hash()) == 64
    assert same.hash() == case.hash() != other.hash()


def test_default_section_of_the_reference_line(case: Case) -> None:
    """The analysed section of 17 spans is 4 to 13, both included."""
    assert case.settings.section is None
    assert case.resolved_section() == (4, 13)


@pytest.mark.parametrize(
    ("spans", "section"), [(1, (1, 1)), (3, (1, 3)), (4, (2, 3)), (10, (4, 7)), (100, (4, 96))]
)
def test_default_section(case: Case, spans: int, section: tuple[int, int]) -> None:
    """The default section leaves out up to 3 spans at the start and 4 at the end."""
    assert case.with_(**{"line.spans": spans}).resolved_section() == section


def test_given_section(case: Case) -> None:
    """A given section is taken as it is."""
    assert case.with_(**{"settings.section": [5, 6]}).resolved_section() == (5, 6)


def test_mean_force_law(case: Case) -> None:
    """70 N + 0.00097 v^2 is 169.33 N at 320 km/h and 143.36 N at 275 km/h."""
    slower = case.with_(**{"scenario.speed": "275 km/h"})
    assert case.scenario.target_mean_force() == pytest.approx(169.328)
    assert slower.scenario.target_mean_force() == pytest.approx(143.356, abs=1e-3)
    assert MeanForceLaw(constant=70.0, per_speed_squared=0.01).at(10.0) == pytest.approx(71.0)


@pytest.mark.parametrize(
    ("changes", "forces"),
    [
        ({"scenario.uplift_force": 150.0}, (150.0, 150.0)),
        ({"scenario.uplift_force": [150.0, 0.0]}, (150.0, 0.0)),
        ({"scenario.uplift_guess": [170.0, 180.0]}, (170.0, 180.0)),
        ({"scenario.mean_force": 160.0, "scenario.uplift_guess": None}, (160.0, 160.0)),
    ],
)
def test_uplift_forces(changes: dict[str, Any], forces: tuple[float, float]) -> None:
    """Forces are prescribed, guessed, or start from the mean force that is asked for."""
    pair = load_case("ac-simple-two-pantographs").with_(**changes)
    assert pair.uplift_forces() == forces


def test_uplift_force_of_the_pantograph(case: Case) -> None:
    """Without a force in the scenario the static and aerodynamic force acts."""
    front = case.pantographs[0].with_(static_force="70 N", aerodynamic="0.01 N/(m/s)^2")
    own = case.with_(
        pantographs=[front], **{"scenario.mean_force": None, "scenario.speed": "50 m/s"}
    )
    assert own.uplift_forces() == (pytest.approx(95.0),)


def test_lifted_stage(case: Case) -> None:
    """The uplift force acts on the lowest stage unless another is named, 1 being the head."""
    front = case.pantographs[0]
    assert front.lifted_stage() == 2
    assert front.with_(force_stage=1).lifted_stage() == 0


def test_spans_from_a_list() -> None:
    """A list of span lengths sets the number of spans; supports follow."""
    line = Line.model_validate({"span_length": [50, "55 m", 60]})
    assert line.spans == 3
    assert line.support_positions() == (0.0, 50.0, 105.0, 165.0)
    assert line.length() == 165.0


def test_staggers_alternate() -> None:
    """A single stagger alternates from support 1, a list is taken as it is."""
    supports = Supports(closure="height", encumbrance=1.2, contact_stagger=0.2)
    assert supports.contact_staggers(3) == (0.2, -0.2, 0.2)
    assert supports.messenger_staggers(3) == (0.2, -0.2, 0.2)
    assert supports.with_(messenger_stagger=0).messenger_staggers(2) == (0.0, 0.0)
    assert supports.with_(contact_stagger=[0.1, 0, -0.3]).contact_staggers(3) == (0.1, 0.0, -0.3)
    assert supports.encumbrances(2) == (1.2, 1.2)
    assert supports.with_(contact_height=[5.3, 5.4]).contact_heights(2) == (5.3, 5.4)


def test_droppers_by_span() -> None:
    """One list holds for every span, a list of lists span by span."""
    droppers = Droppers.model_validate(
        {"positions": [5, 10], "presag": [[0, "10 mm"], [0, "20 mm"]], "stiffness": "200 kN/m"}
    )
    assert droppers.positions_by_span(2) == ((5.0, 10.0), (5.0, 10.0))
    assert droppers.presag_by_span(2) == ((0.0, 0.01), (0.0, 0.02))
    assert droppers.lengths_by_span(2) == ()


def test_line_without_droppers() -> None:
    """An empty list of positions describes a wire without droppers."""
    droppers = Droppers.model_validate({"positions": [], "presag": [], "stiffness": 2e5})
    assert droppers.positions_by_span(2) == ((), ())


@pytest.mark.parametrize("word", ["length", "lengths"])
def test_length_mode(word: str) -> None:
    """Mode 'lengths' is 'length'; pre-sag is then not needed."""
    droppers = Droppers.model_validate(
        {"mode": word, "positions": [5], "lengths": ["1.017 m"], "stiffness": 2e5}
    )
    assert droppers.mode == "length"
    assert droppers.lengths_by_span(1) == ((1.017,),)
    assert droppers.presag_by_span(1) == ()


@pytest.mark.parametrize(
    ("given", "at_half_a_metre"),
    [
        ("200 kN/m", 2e5),
        (2e5, 2e5),
        ("200 kN", 4e5),
        ({"spring": "100 kN/m"}, 1e5),
        ({"axial": 1e5}, 2e5),
        (DropperStiffness(axial=1e5), 2e5),
    ],
)
def test_dropper_stiffness(given: Any, at_half_a_metre: float) -> None:
    """A stiffness in N/m is a spring, one in N is EA and is divided by the length."""
    droppers = Droppers.model_validate({"positions": [], "presag": [], "stiffness": given})
    assert droppers.stiffness.of_length(0.5) == at_half_a_metre


@pytest.mark.parametrize(
    ("given", "method", "alpha"),
    [
        ("newmark", "newmark", 0.0),
        ("hht", "hht", -0.05),
        ({"method": "hht", "alpha": -0.1}, "hht", -0.1),
        (Integrator(method="hht", alpha=-1 / 3), "hht", -1 / 3),
    ],
)
def test_integrator_forms(given: Any, method: str, alpha: float) -> None:
    """An integrator is a word or a mapping; HHT has a default alpha."""
    settings = Settings.model_validate({"contact_stiffness": 2e5, "integrator": given})
    assert (settings.integrator.method, settings.integrator.alpha) == (method, alpha)


CONTRADICTIONS = [
    (DropperStiffness, {}, "exactly one of spring"),
    (DropperStiffness, {"spring": 1e5, "axial": 1e5}, "exactly one of spring"),
    (Droppers, {"positions": [5], "stiffness": 2e5}, "mode 'height' needs one value per dropper"),
    (
        Droppers,
        {"mode": "length", "positions": [5], "presag": [0], "stiffness": 2e5},
        "mode 'length' needs one value per dropper",
    ),
    (Droppers, {"positions": [], "presag": [], "stiffness": "5 kg"}, "or an axial stiffness EA"),
    (Supports, {"closure": "spring", "encumbrance": 1.2}, "closure 'spring' needs it"),
    (Supports, {"closure": "arm", "encumbrance": 1.2}, "closure 'arm' needs arm.angle"),
    (
        Supports,
        {"closure": "arm", "encumbrance": 1.2, "arm_end_y": [None, 1.0, None]},
        "give both or neither",
    ),
    (Line, {"spans": 3, "span_length": [50, 55]}, "has 2 values for 3 spans"),
    (Scenario, {"speed": 50, "mean_force": 100, "uplift_force": 100}, "keep mean_force"),
    (Settings, {"contact_stiffness": 2e5, "section": [6, 5]}, r"write [first, last] span"),
    (Integrator, {"method": "newmark", "alpha": -0.1}, "belongs to 'method: hht' only"),
    (RoofMotion, {"time": [0, 1], "height": [0, 0, 0]}, "has 3 values for 2 times"),
    (RoofMotion, {"time": [0, 1, 1], "height": [0, 0, 0]}, "times must increase"),
    (Pantograph, {"name": "a", "stages": [STAGE], "force_stage": 2}, "has 1 stages"),
    (
        Pantograph,
        {"name": "a", "stages": [{**STAGE, "stiffness": 0}, STAGE]},
        "only the lowest stage",
    ),
]


@pytest.mark.parametrize(("spec", "fields", "message"), CONTRADICTIONS)
def test_contradiction_is_refused(spec: type, fields: dict[str, Any], message: str) -> None:
    """Fields that do not go together are refused with the way out."""
    assert message in message_of(spec, **fields)


@pytest.mark.parametrize("value", [math.nan, math.inf, True, "1e999 kg", None])
def test_mass_must_be_a_finite_number(value: object) -> None:
    """No field accepts what is not a finite number."""
    assert "mass" in message_of(Stage, **{**STAGE, "mass": value})


def test_json_schema_takes_number_or_text() -> None:
    """In the JSON Schema a quantity is a number or a text and carries unit and typical value."""
    tension = case_json_schema()["$defs"]["Wire"]["properties"]["tension"]
    assert [branch["type"] for branch in tension["anyOf"]] == ["number", "string"]
    assert tension["unit"] == "N"
    assert tension["typical"]
    assert tension["anyOf"][0]["exclusiveMinimum"] == 0.0


def test_json_schema_knows_includes_and_tables() -> None:
    """A mapping may be included instead of given, and tables may be named."""
    schema = case_json_schema()
    assert {"required": ["include"]} in schema["$defs"]["Pantograph"]["anyOf"]
    assert tuple(schema["properties"]["tables"]["properties"]) == KINDS
    assert {"required": ["table"]} in schema["$defs"]["RoofMotion"]["anyOf"]
    assert schema["properties"]["schema"]["enum"] == [1, 2]
    assert "oneOf" not in json.dumps(schema)


FEATURES, RENAMED = vocabulary._content()["features"], vocabulary._content()["keys"]


@pytest.mark.parametrize("feature", FEATURES)
def test_features_are_found_by_their_words(feature: str) -> None:
    """Every feature is recognised by each of its words, in any spelling, one or several."""
    for entry in words_for(feature):
        above, _, word = entry.rpartition(".")
        for spelling in (word, word.upper(), word.replace("_", "-"), word.replace("_", " ")):
            assert meaning_of(spelling, f"{above}.contact") == Meaning(feature=feature), spelling
        assert meaning_of(f"{word}s", above) == Meaning(feature=feature)
    assert meaning_of("tension") is None


def test_words_for_keys_lead_to_keys() -> None:
    """Every path of the vocabulary exists, and no word stands for two things."""
    words = [word for name in (*FEATURES, *RENAMED) for word in words_for(name)]
    assert len(words) == len({".".join(map(folded, word.split("."))) for word in words})
    for path in map(parse_path, RENAMED):
        if path[-1] == USE:
            spec = find_target(path[:-1]).spec
            assert spec is not None
            assert spec.catalogue_kinds
        else:
            assert find_target(path).field is not None
    assert meaning_of("Systemhöhe") == Meaning(key="supports.encumbrance")
    assert meaning_of("systemHeight") == Meaning(key="supports.encumbrance")


def test_no_field_is_called_not_modelled() -> None:
    """No key of the input format is a word for what is not modelled."""
    schema = case_json_schema()
    keys = {
        key for spec in [schema, *schema["$defs"].values()] for key in spec.get("properties", {})
    }
    assert not [key for key in keys if (found := meaning_of(key)) and found.feature]
