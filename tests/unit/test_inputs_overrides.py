"""Values replaced from the command line."""

from __future__ import annotations

from typing import Any

import pytest

from tautwire.errors import InputError
from tautwire.inputs.load import load_case, make_case
from tautwire.inputs.overrides import apply_overrides
from tautwire.inputs.paths import PathError, find_target, format_path, parse_path
from tautwire.specs import Case

# Every stable path of the command line, with a value as typed and what the case then holds.
STABLE = [
    ("line.spans=12", lambda c: c.line.spans, 12),
    ("line.span_length=60 m", lambda c: c.line.length(), 17 * 60.0),
    ("line.ends=weighted", lambda c: (c.line.ends.left, c.line.ends.right), ("weighted",) * 2),
    ("wires.contact.tension=27 kN", lambda c: c.wires.contact.tension, 27e3),
    ("wires.contact.mass=1.08 kg/m", lambda c: c.wires.contact.mass, 1.08),
    ("wires.contact.bending_stiffness=150", lambda c: c.wires.contact.bending_stiffness, 150.0),
    ("wires.contact.axial_stiffness=14 MN", lambda c: c.wires.contact.axial_stiffness, 14e6),
    ("wires.messenger.tension=18 kN", lambda c: c.wires.messenger.tension, 18e3),
    ("supports.contact_stagger=0.3", lambda c: c.supports.contact_staggers(2), (0.3, -0.3)),
    ("supports.messenger_stagger=0", lambda c: c.supports.messenger_staggers(2), (0.0, 0.0)),
    ("supports.encumbrance=1.4 m", lambda c: c.supports.encumbrances(1), (1.4,)),
    ("supports.messenger_longitudinal=fixed", lambda c: c.supports.messenger_longitudinal, "fixed"),
    ("supports.closure=lift", lambda c: c.supports.closure, "lift"),
    ("droppers.stiffness=200 kN", lambda c: c.droppers.stiffness.axial, 2e5),
    ("droppers.mass=0", lambda c: c.droppers.mass, 0.0),
    ("droppers.clamp_contact=0.2 kg", lambda c: c.droppers.clamp_contact, 0.2),
    ("droppers.clamp_messenger=0", lambda c: c.droppers.clamp_messenger, 0.0),
    (
        "droppers.presag=[0, 1 mm, 2 mm, 3 mm, 4 mm, 3 mm, 2 mm, 1 mm, 0]",
        lambda c: c.dropper_sets[0].presag_by_span(17)[16][:3],
        (0.0, 0.001, 0.002),
    ),
    ("scenario.speed=275 km/h", lambda c: c.scenario.speed, 275 / 3.6),
    ("scenario.direction=-x", lambda c: c.scenario.direction, "-x"),
    ("scenario.mean_force=160 N", lambda c: c.scenario.mean_force, 160.0),
    ("scenario.uplift_force=[150]", lambda c: c.scenario.uplift_force, (150.0,)),
    ("settings.contact_stiffness=50 kN/m", lambda c: c.settings.contact_stiffness, 5e4),
    ("settings.nodes_between_droppers=15", lambda c: c.settings.nodes_between_droppers, 15),
    ("settings.time_step=0.5 ms", lambda c: c.settings.time_step, 5e-4),
    ("settings.section=[5, 6]", lambda c: c.resolved_section(), (5, 6)),
    ("settings.elasticity_force=200", lambda c: c.settings.elasticity_force, 200.0),
    ("settings.integrator=hht", lambda c: c.settings.integrator.alpha, -0.05),
    ("settings.integrator={method: hht}", lambda c: c.settings.integrator.alpha, -0.05),
    ("settings.seed=7", lambda c: c.settings.seed, 7),
    ("title=Another", lambda c: c.title, "Another"),
]


def changed(*overrides: str) -> Case:
    """Load the reference line with overrides."""
    return load_case("ac-simple", overrides)


def problems_of(*overrides: str) -> tuple[str, ...]:
    """Return what is said about overrides of the reference line."""
    with pytest.raises(InputError) as caught:
        changed(*overrides)
    return caught.value.problems


@pytest.mark.parametrize(("override", "read", "value"), STABLE)
def test_stable_path(override: str, read: Any, value: Any) -> None:
    """Every stable path sets its value."""
    assert read(changed(override)) == value


def test_dropper_lists_in_lengths_mode() -> None:
    """Mode, positions and lengths can be given as lists, for all spans or span by span."""
    case = changed(
        "droppers.mode=lengths",
        "droppers.positions=[10, 27.5, 45]",
        f"droppers.lengths={[[1.0, 0.8, 1.0]] * 17}",
    )
    assert case.dropper_sets[0].lengths_by_span(17)[16] == (1.0, 0.8, 1.0)
    assert case.dropper_sets[0].positions_by_span(17)[0] == (10.0, 27.5, 45.0)


def test_overrides_as_a_mapping() -> None:
    """In Python values are given by path; specs and tuples are values like others."""
    case = load_case("ac-simple", {"scenario.speed": 80.0, "settings.section": (5, 6)})
    assert (case.scenario.speed, case.resolved_section()) == (80.0, (5, 6))


def test_one_text_is_one_override() -> None:
    """A single text is not taken apart into letters."""
    assert load_case("ac-simple", "line.spans=9").line.spans == 9


@pytest.mark.parametrize(
    ("override", "read", "value"),
    [
        ("droppers.presag[5]=60 mm", lambda c: c.dropper_sets[0].presag_by_span(17)[3][4], 0.06),
        ("droppers.positions[1]=5", lambda c: c.dropper_sets[0].positions_by_span(17)[16][0], 5.0),
        ("supports.encumbrance[3]=1.4", lambda c: c.supports.encumbrances(18)[1:3], (1.2, 1.4)),
        ("supports.contact_height[2]=5.4", lambda c: c.supports.contact_heights(18)[1], 5.4),
        (
            "supports.contact_stagger[3]=0.3",
            lambda c: c.supports.contact_staggers(18)[1:4],
            (-0.2, 0.3, -0.2),
        ),
        (
            "supports.messenger_stagger[2]=0",
            lambda c: c.supports.messenger_staggers(18)[:3],
            (0.2, 0.0, 0.2),
        ),
        ("line.span_length[17]=60 m", lambda c: c.line.span_lengths()[15:], (55.0, 60.0)),
        (
            "line.ends.left=weighted",
            lambda c: (c.line.ends.left, c.line.ends.right),
            ("weighted", "anchored"),
        ),
        ("pantographs[1].stages[2].mass=10", lambda c: c.pantographs[0].stages[1].mass, 10.0),
        ("pantographs[1].name=P", lambda c: c.pantographs[0].name, "P"),
        ("scenario.mean_force.constant=80", lambda c: c.scenario.mean_force.constant, 80.0),
        ("droppers.stiffness.axial=200 kN", lambda c: c.droppers.stiffness.axial, 2e5),
        ("scenario.uplift_guess[1]=180", lambda c: c.scenario.uplift_guess, (180.0,)),
    ],
)
def test_single_item(override: str, read: Any, value: Any) -> None:
    """One item of what holds for all is set, the others keep their value."""
    assert read(changed(override)) == value


def test_parameter_of_a_named_integrator() -> None:
    """The parameter of an integrator that was given as a word can be set."""
    case = changed("settings.integrator=hht", "settings.integrator.alpha=-0.1")
    assert (case.settings.integrator.method, case.settings.integrator.alpha) == ("hht", -0.1)


def test_one_presag_of_one_span() -> None:
    """One pre-sag of one span is set; the other spans keep theirs."""
    rows = changed("droppers.presag[9][5]=60 mm").dropper_sets[0].presag_by_span(17)
    assert rows[8][4] == 0.06
    assert rows[8][3] == rows[7][3] == 0.052
    assert rows[7][4] == 0.055


def test_number_below_a_mean_force() -> None:
    """A law can be made of a plain mean force."""
    law = "scenario.mean_force.per_speed_squared=0.001 N/(m/s)^2"
    case = changed("scenario.mean_force=70 N", law)
    assert case.scenario.target_mean_force() == pytest.approx(70 + 0.001 * (320 / 3.6) ** 2)


def test_a_force_clears_the_other() -> None:
    """mean_force tunes, uplift_force prescribes: setting one clears the other and its source."""
    prescribed = changed("scenario.uplift_force=150")
    assert prescribed.scenario.mean_force is None
    assert "scenario.mean_force" not in {source.path for source in prescribed.sources}
    tuned = load_case("en50318-2002", ["scenario.mean_force=120"])
    assert (tuned.scenario.mean_force, tuned.scenario.uplift_force) == (120.0, None)


def test_override_is_its_own_source() -> None:
    """A replaced number loses its source and says that it was set for this run."""
    sources = {source.path: source for source in changed("wires.contact.mass=1.08").sources}
    assert sources["wires.contact.mass"].source == "Set for this run"
    assert sources["wires.contact.mass"].confidence == "choice"
    assert sources["wires.contact.tension"].confidence == "two sources"


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("scenario.spede=1", "override scenario.spede: unknown key; did you mean 'speed'?"),
        ("scenery.speed=1", "override scenery: unknown key; did you mean 'scenario'?"),
        ("scenario.speed.x=1", "unknown key; nothing can be given below this value"),
        ("line.turnout=1", "override line.turnout: not modelled yet: crossing or turnout wire"),
        ("scenario.speed", "override 'scenario.speed': write path=value, as in scenario.speed="),
        ("scenario.speed=", "override 'scenario.speed=': write path=value"),
        ("scenario.speed=[1", "override scenario.speed: the value '[1' is malformed"),
        ("scenario..speed=1", "'scenario..speed' is not a path; write names joined by dots"),
        ("droppers.presag[0]=1", "'droppers.presag[0]': items are numbered from 1"),
        ("droppers.presag[10]=1", "droppers.presag[10]: the list has 9 values, numbered from 1"),
        ("droppers.presag[18][1]=0", "droppers.presag[18]: the list has 17 values"),
        ("droppers.lengths[1]=1", "droppers.lengths: holds no list; give the whole list first"),
        ("supports.arm_end_y[2]=1", "supports.arm_end_y: holds no list; give the whole list"),
        ("scenario.speed[1]=1", "override scenario.speed: is not a list; leave out the index"),
        (
            "pantographs.behind=5",
            "override pantographs: is a list; say which item, as in pantographs[1].behind",
        ),
        ("schema=2", "override schema: cannot be overridden; edit the file"),
        ("sources[1].source=x", "override sources[1].source: cannot be overridden"),
        ("wires.contact.mass=-1", "wires.contact.mass: got -1; must be greater than 0 kg/m"),
        ("settings.section=[4, 99]", "settings.section: got [4, 99]; the line has 17 spans"),
        ("pantographs[2].behind=9", "pantographs[2]: the list has 1 values, numbered from 1"),
    ],
)
def test_bad_override(override: str, words: str) -> None:
    """A message names the path and the cure."""
    told = problems_of(override)
    assert len(told) == 1
    assert words in told[0]


def test_all_bad_overrides_at_once() -> None:
    """Faults of overrides and of values come together."""
    assert len(problems_of("scenario.spede=1", "line.spans=0", "x=1", "wires.contact.mass=-1")) == 4


def test_single_item_of_an_unknown_number_of_spans() -> None:
    """One item can only be set where the number of items is known."""
    data = load_case("ac-simple").to_dict()
    del data["line"]["spans"]
    with pytest.raises(InputError, match=r"line\.spans: is needed to set a single item"):
        make_case(data, ["supports.encumbrance[2]=1.3"])


def test_spread_of_a_bad_stagger() -> None:
    """A stagger that is no length is told when one item of it is set."""
    data = load_case("ac-simple").to_dict()
    data["supports"]["contact_stagger"] = "0.2 s"
    with pytest.raises(InputError, match="which is a time"):
        make_case(data, ["supports.contact_stagger[2]=0.1"])


def test_data_is_left_alone() -> None:
    """Overrides work on a copy."""
    data = load_case("ac-simple").to_dict()
    before = repr(data)
    apply_overrides(data, ["droppers.presag[2][3]=0", "pantographs[1].stages[1].mass=1"])
    assert repr(data) == before


def test_odd_sources_survive_overrides() -> None:
    """Entries that are no sources are left for validation to refuse."""
    data, problems = apply_overrides({"sources": [5, {"path": "a b"}]}, ["line.spans=3"])
    assert not problems
    assert data["sources"][:2] == [5, {"path": "a b"}]
    assert apply_overrides({"sources": 5}, ["line.spans=3"])[0]["sources"] == 5


@pytest.mark.parametrize("text", ["droppers.presag[9][5]", "pantographs[1].stages[2].mass", "name"])
def test_path_round_trip(text: str) -> None:
    """A path is written as it was read."""
    assert format_path(parse_path(text)) == text


def test_targets() -> None:
    """A path leads to its field with unit, range and typical value."""
    target = find_target(parse_path("droppers.presag[9][5]"))
    assert target.quantity is not None
    assert (target.quantity.unit, target.typical) == ("m", "0 to 60 mm")
    assert find_target(parse_path("settings.seed")).typical == "0"
    assert find_target(parse_path("line.ends")).typical == ""
    with pytest.raises(PathError, match="unknown key"):
        find_target(parse_path("line.x"))
