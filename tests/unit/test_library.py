"""The library: reference cases, pantographs, copies to edit."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from tautwire.catalogue.entries import copy_case, list_entries, read_entry
from tautwire.errors import InputError
from tautwire.inputs.load import load_case
from tautwire.inputs.paths import parse_path
from tautwire.specs.case import Case

from ..lines import droppers_of, messenger_of

CASES = [entry.name for entry in list_entries() if entry.kind == "case"]


def test_what_the_library_holds() -> None:
    """The library holds 18 cases and two pantographs, each with a summary."""
    assert [entry.name for entry in list_entries()] == [
        "ac-simple",
        "ac-simple-curve",
        "ac-simple-overlap",
        "ac-simple-plane",
        "ac-simple-two-pantographs",
        "ac-stitched",
        "adif-c350",
        "adif-c350-tr200",
        "adif-ca160-3kv",
        "adif-ca200-25kv",
        "adif-ca220-25kv",
        "adif-ca220-3kv",
        "adif-low-bridge",
        "compound",
        "dc-twin",
        "en50318-2002",
        "sicat-h1",
        "tram",
        "benchmark-2015-pantograph",
        "en50318-2002-pantograph",
    ]
    assert all(entry.summary.endswith(".") for entry in list_entries())


def test_reference_line_2015() -> None:
    """AC simple has the inputs of the world benchmark 2015 (two public codes of the model)."""
    case = load_case("ac-simple")
    contact, messenger = case.wires.contact, messenger_of(case)
    assert (case.line.spans, case.line.span_lengths()[0]) == (17, 55.0)
    assert (contact.tension, contact.mass, contact.bending_stiffness) == (22e3, 1.35, 195.0)
    assert (messenger.tension, messenger.mass, messenger.bending_stiffness) == (16e3, 1.08, 131.7)
    assert (contact.axial_stiffness, messenger.axial_stiffness) == (15e6, 11.64e6)
    assert droppers_of(case).positions_by_span(1)[0][:5] == (4.5, 10.25, 16.0, 21.75, 27.5)
    assert droppers_of(case).presag_by_span(1)[0][:5] == (0.0, 0.024, 0.041, 0.052, 0.055)
    assert (droppers_of(case).mass, droppers_of(case).clamp_contact) == (0.117, 0.165)
    assert (droppers_of(case).clamp_messenger, droppers_of(case).stiffness.spring) == (0.195, 2e5)
    assert (case.supports.arm.length, case.supports.arm.mass) == (1.22, 0.73)
    assert (case.supports.closure, case.supports.arm.motion) == ("arm", "swinging")
    assert case.supports.arm.angle == pytest.approx(math.radians(10.0))
    assert case.settings.contact_stiffness == 5e4
    assert [stage.mass for stage in case.pantographs[0].stages] == [7.5, 9.0, 6.0]
    assert [stage.stiffness for stage in case.pantographs[0].stages] == [7e3, 15.5e3, 160.0]
    assert [stage.damping for stage in case.pantographs[0].stages] == [45.0, 0.1, 100.0]


def test_reference_line_2002() -> None:
    """EN 50318:2002 has the inputs of its one public code, and 120 N from memory."""
    case = load_case("en50318-2002")
    assert (case.line.spans, case.line.span_lengths()[0]) == (14, 60.0)
    assert case.resolved_section() == (5, 6)
    assert (case.wires.contact.tension, case.wires.contact.mass) == (20e3, 1.35)
    assert (messenger_of(case).tension, messenger_of(case).mass) == (16e3, 1.07)
    assert droppers_of(case).positions_by_span(1)[0] == (5, 10.5, 17, 23.5, 30, 36.5, 43, 49.5, 55)
    assert case.supports.spring is not None
    assert (case.supports.spring.stiffness, case.supports.spring.mass) == (300.0, 0.0)
    assert case.uplift_forces() == (120.0,)
    assert [stage.mass for stage in case.pantographs[0].stages] == [7.2, 15.0]


def test_two_pantographs() -> None:
    """The case with two pantographs is the reference line with a second one 200 m behind."""
    single, pair = load_case("ac-simple"), load_case("ac-simple-two-pantographs")
    assert [p.behind for p in pair.pantographs] == [0.0, 200.0]
    assert pair.pantographs[0] == single.pantographs[0]
    assert pair.line == single.line
    assert pair.settings == single.settings


def test_nothing_in_the_reference_line_is_calibrated() -> None:
    """No number of AC simple was selected to meet a result; the plane reading has one that was."""
    assert "calibrated" not in {source.confidence for source in load_case("ac-simple").sources}
    plane = load_case("ac-simple-plane")
    known = {source.path: source.confidence for source in plane.sources}
    assert known["settings.contact_stiffness"] == "calibrated"
    assert (plane.supports.closure, plane.supports.arm.motion) == ("height", "vertical")
    assert plane.settings.contact_stiffness == 2e5
    assert plane.wires == load_case("ac-simple").wires
    assert plane.droppers == load_case("ac-simple").droppers


SUPPORTS_OF_A_MESSENGER = ("encumbrance", "messenger_stiffness", "messenger_damping")
NUMBERS_OF_A_WIRE = ("tension", "mass", "axial_stiffness", "bending_stiffness")


def _dropper_paths(case: Case) -> list[str]:
    if isinstance(case.droppers, tuple):
        return [f"droppers[{number + 1}]" for number in range(len(case.droppers))]
    return ["droppers"]


@pytest.mark.parametrize("name", CASES)
def test_numbers_have_sources(name: str) -> None:
    """Every number of a library case that is not a matter of course has its source."""
    case = load_case(name)
    covered = [parse_path(source.path) for source in case.sources]
    expected = [
        *(f"wires.{name}.{key}" for name, _ in case.wires.named() for key in NUMBERS_OF_A_WIRE),
        *(f"supports.{key}" for key in ("contact_stagger", "closure")),
        *(f"pantographs[{n + 1}].stages" for n in range(len(case.pantographs))),
        *("line.spans", "line.span_length", "line.damping.mass", "line.damping.stiffness"),
        *("scenario.mean_force",) * (case.scenario.mean_force is not None),
        "settings.contact_stiffness",
    ]
    if case.wires.messenger is not None:
        expected += [f"supports.{key}" for key in SUPPORTS_OF_A_MESSENGER]
    for place, one in zip(_dropper_paths(case), case.dropper_sets, strict=True):
        keys = ["positions", "stiffness", "mass", "clamp_contact", "clamp_messenger"]
        keys += ["presag"] * (one.presag is not None)
        expected += [f"{place}.{key}" for key in keys]
    paths = [parse_path(path) for path in expected]
    assert not [p for p in paths if not any(p[: len(c)] == c for c in covered)]


@pytest.mark.parametrize(
    ("name", "path", "confidence"),
    [
        ("ac-simple", "settings.contact_stiffness", "memory"),
        ("ac-simple", "supports.closure", "memory"),
        ("ac-simple", "supports.arm.angle", "memory"),
        ("ac-simple", "supports.arm.motion", "memory"),
        ("ac-simple-plane", "supports.arm.motion", "choice"),
        ("ac-simple", "supports.arm", "memory"),
        ("ac-simple", "supports.arm.axial_stiffness", "choice"),
        ("ac-simple", "supports.contact_stagger", "memory"),
        ("ac-simple", "supports.messenger_stagger", "memory"),
        ("ac-simple", "line.damping", "memory"),
        ("ac-simple", "scenario.mean_force", "memory"),
        ("ac-simple", "droppers.stiffness", "choice"),
        ("ac-simple-two-pantographs", "pantographs[2].behind", "memory"),
        ("en50318-2002", "scenario.uplift_force", "memory"),
        ("en50318-2002", "supports.encumbrance", "memory"),
        ("en50318-2002", "droppers.presag", "memory"),
        ("en50318-2002", "supports.messenger_stiffness", "choice"),
        ("en50318-2002", "settings.section", "choice"),
    ],
)
def test_weak_numbers_are_marked(name: str, path: str, confidence: str) -> None:
    """What is remembered, calibrated or chosen says so."""
    found = {source.path: source.confidence for source in load_case(name).sources}
    assert found[path] == confidence


@pytest.mark.parametrize("name", CASES)
def test_copy_can_be_loaded(name: str, tmp_path: Path) -> None:
    """A copy is a commented file that loads to the same line, marked as taken over."""
    path = copy_case(name, tmp_path / "my-line.yaml")
    text = path.read_text(encoding="utf-8")
    original, copy = load_case(name), load_case(path)
    assert copy.name == "my-line"
    its_own = {"title": "", "description": "", "sources": ()}
    assert copy.with_(name=name, **its_own) == original.with_(**its_own)
    assert {source.path for source in copy.sources} == {s.path for s in original.sources}
    assert {source.template for source in copy.sources} <= {*CASES, ""}
    assert text.startswith(f"# Copied from '{name}' of the tautwire library.\n")
    assert text.count("#") > 5
    assert [entry.name for entry in tmp_path.iterdir()] == ["my-line.yaml"]


def test_copied_pantograph_can_be_included(tmp_path: Path) -> None:
    """A pantograph is copied and included like a case."""
    copy_case("benchmark-2015-pantograph", tmp_path / "own.yaml")
    path = tmp_path / "case.yaml"
    path.write_text(
        "schema: 1\ninclude: ac-simple\npantographs: [{include: own.yaml, name: front}]\n",
        encoding="utf-8",
    )
    assert load_case(path).pantographs == load_case("ac-simple").pantographs


def test_strange_file_name_makes_a_valid_case_name(tmp_path: Path) -> None:
    """A copy under any file name can be loaded."""
    path = copy_case("ac-simple", tmp_path / 'My line "ü".yaml')
    assert load_case(path).name == "My-line----"


def test_copy_does_not_overwrite(tmp_path: Path) -> None:
    """An existing file is kept unless it is to be replaced."""
    path = tmp_path / "my.yaml"
    path.write_text("mine", encoding="utf-8")
    with pytest.raises(InputError, match="exists already; choose another name"):
        copy_case("ac-simple", path)
    assert path.read_text(encoding="utf-8") == "mine"
    copy_case("ac-simple", path, force=True)
    assert load_case(path).name == "my"


@pytest.mark.parametrize(
    ("name", "file", "words"),
    [
        (
            "ac-simpel",
            "my.yaml",
            "the library holds nothing named 'ac-simpel'; it holds: ac-simple",
        ),
        ("ac-simple", "my.txt", "the copy is YAML; choose a name that ends in .yaml"),
        ("ac-simple", "no/folder/my.yaml", "no/folder does not exist; create it"),
        ("ac-simple", "folder.yaml", "exists already"),
    ],
)
def test_bad_copy(name: str, file: str, words: str, tmp_path: Path) -> None:
    """A copy that cannot be made is refused with the reason and leaves nothing behind."""
    (tmp_path / "folder.yaml").mkdir()
    with pytest.raises(InputError) as caught:
        copy_case(name, tmp_path / file, force=file == "folder.yaml")
    assert words in str(caught.value)
    assert [entry.name for entry in tmp_path.iterdir()] == ["folder.yaml"]


def test_library_text_is_commented() -> None:
    """A library file can be read as it stands."""
    assert read_entry("ac-simple").startswith("# AC simple: simple catenary")
