"""``use: NAME`` in a case: what it gives, what changes it, what is recorded."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tautwire.catalogue.entries import copy_case
from tautwire.errors import InputError
from tautwire.inputs.load import load_case, make_case
from tautwire.specs.case import Case, Source


def write(folder: Path, text: str, name: str = "line.yaml") -> Path:
    path = folder / name
    path.write_text("schema: 1\ninclude: ac-simple\n" + text, encoding="utf-8")
    return path


def origin(case: Case, path: str) -> Source:
    (found,) = [source for source in case.sources if source.path == path]
    return found


def test_wire_by_name(tmp_path: Path) -> None:
    """A wire by name replaces mass, EA and EI of the included line, each with its source."""
    case = load_case(write(tmp_path, "wires: {contact: {use: RiM 120, tension: 27 kN}}"))
    wire = case.wires.contact
    assert (wire.tension, wire.mass, wire.axial_stiffness) == (27e3, 1.067, 14.4e6)
    assert wire.bending_stiffness == pytest.approx(137.51, abs=0.01)
    mass, stiffness = (origin(case, f"wires.contact.{k}") for k in ("mass", "axial_stiffness"))
    assert mass.source.startswith("Catalogue, AC-120 CuMg0.5: Contact-wire sheet")
    assert (mass.confidence, stiffness.confidence) == ("one source", "derived")
    assert stiffness.source.endswith("E x section = 120 GPa x 120 mm2")
    assert [s.path for s in case.sources if s.path == "wires.contact.tension"] == []


def test_further_keys_change_the_entry(tmp_path: Path) -> None:
    """A number given beside 'use' wins, and the entry's source for it is dropped."""
    case = load_case(write(tmp_path, "wires: {messenger: {use: BzII-70, mass: 0.62 kg/m}}"))
    assert case.wires.messenger is not None
    assert case.wires.messenger.mass == 0.62
    assert case.wires.messenger.tension == 16e3
    paths = {source.path for source in case.sources}
    assert "wires.messenger.mass" not in paths
    assert "wires.messenger.bending_stiffness" in paths


def test_rope_that_slips(tmp_path: Path) -> None:
    """'bending_stiffness: slip' takes the other value of a rope, with its own origin."""
    text = "wires: {messenger: {use: BzII-120, bending_stiffness: slip}}"
    case = load_case(write(tmp_path, text))
    assert case.wires.messenger is not None
    assert case.wires.messenger.bending_stiffness == pytest.approx(6.478, abs=1e-3)
    assert "slip" in origin(case, "wires.messenger.bending_stiffness").source


def test_benchmark_by_name_is_the_benchmark(tmp_path: Path) -> None:
    """The entries of the reference model give the numbers that the case ac-simple states."""
    text = (
        "wires:\n  contact: {use: benchmark contact}\n  messenger: {use: benchmark messenger}\n"
        "droppers: {use: [benchmark dropper, benchmark dropper clamps]}\n"
        "pantographs: [{use: benchmark-2015, name: front}]\n"
    )
    case, original = load_case(write(tmp_path, text)), load_case("ac-simple")
    for part in ("contact", "messenger"):
        ours, theirs = (getattr(c.wires, part).to_dict() for c in (case, original))
        stated = {name: value for name, value in theirs.items() if value is not None}
        assert {name: ours[name] for name in stated} == pytest.approx(stated)
    assert case.droppers == original.droppers
    assert case.pantographs == original.pantographs


def test_nested_entries(tmp_path: Path) -> None:
    """A cantilever brings its arm, which further keys of the arm change."""
    text = "supports: {use: light cantilever, arm: {mass: 0.9 kg/m, motion: swinging}}"
    supports = load_case(write(tmp_path, text)).supports
    assert (supports.arm.length, supports.arm.mass, supports.clamp) == (1.15, 0.9, 0.46)
    assert supports.arm.motion == "swinging"


def test_stages_share_one_source(tmp_path: Path) -> None:
    """The stages of a pantograph have one source, and those numbers their own that differ."""
    case = load_case(write(tmp_path, "pantographs: [{use: benchmark-2015, name: front}]"))
    found = {s.path: s.confidence for s in case.sources if s.path.startswith("pantographs")}
    assert found["pantographs[1].stages"] == "two sources"
    assert found["pantographs[1].stages[2].damping"] == "one source"
    assert "pantographs[1].stages[2].mass" not in found


def test_own_catalogue_file_comes_first(tmp_path: Path) -> None:
    """A name of an own file is found before that of the package, and its origin recorded."""
    (tmp_path / "own.yaml").write_text(
        "kind: contact wire\nentries:\n"
        "  - {name: Ri 100, summary: Worn., section: {value: 80 mm2, seen: survey 7},\n"
        "     mass: {value: 0.72 kg/m, seen: survey 7},\n"
        "     elasticity: {value: 120 GPa, memory: usual},\n"
        "     thermal_expansion: {value: 1.7e-5, memory: usual}}\n",
        encoding="utf-8",
    )
    text = "catalogue: own.yaml\nwires: {contact: {use: Ri 100}}"
    case = load_case(write(tmp_path, text))
    assert case.wires.contact.mass == 0.72
    assert case.wires.contact.axial_stiffness == pytest.approx(9.6e6)
    assert origin(case, "wires.contact.mass").source == "Catalogue, Ri 100: survey 7"


def test_by_override_and_in_python() -> None:
    """``--set wires.contact.use=...`` and plain data of Python take entries too."""
    case = load_case("ac-simple", ["wires.contact.use=AC-120 CuAg0.1"])
    assert case.wires.contact.mass == 1.067
    assert origin(case, "wires.contact.mass").source.startswith(
        "Set for this run: Catalogue, AC-120"
    )
    data: dict[str, Any] = {**load_case("ac-simple").to_dict()}
    data["wires"] = {**data["wires"], "contact": {"use": "AC-120 CuAg0.1", "tension": 20e3}}
    assert make_case(data).wires.contact.mass == 1.067


def test_every_fault_at_once(tmp_path: Path) -> None:
    """Unknown names, wrong kinds and places are told together with other faults."""
    text = (
        "wires: {contact: {use: RiX 120}, messenger: {use: BzII-10}}\n"
        "scenario: {use: fast, speed: 5000 km/h}\n"
    )
    with pytest.raises(InputError) as caught:
        load_case(write(tmp_path, text))
    told = "\n".join(caught.value.problems)
    assert "wires.contact.use: the catalogue has no contact wire or rope named 'RiX 120'" in told
    assert "did you mean 'Ri" in told
    assert "wires.messenger.use: 'BzII-10' is a dropper; a contact wire or rope is needed" in told
    assert "scenario.use: nothing of the catalogue belongs here" in told


def test_identity_is_not_inherited(tmp_path: Path) -> None:
    """A case that includes another has neither its title nor its description nor its name."""
    case = load_case(write(tmp_path, "wires: {contact: {tension: 25 kN}}", "valley.yaml"))
    assert (case.name, case.title, case.description) == ("valley", "", "")


def test_what_is_taken_over_is_marked(tmp_path: Path) -> None:
    """Numbers taken over from a library case say so; those given for the line do not."""
    case = load_case(write(tmp_path, "wires: {contact: {use: RiM 120, tension: 27 kN}}"))
    assert origin(case, "supports.encumbrance").template == "ac-simple"
    assert origin(case, "wires.contact.mass").template == ""
    assert all(source.template == "" for source in load_case("ac-simple-two-pantographs").sources)


def test_source_of_a_copy_dies_with_its_number(tmp_path: Path) -> None:
    """In a copy, a changed number loses the template's source; the others are marked."""
    path = copy_case("ac-simple", tmp_path / "own.yaml")
    text = path.read_text(encoding="utf-8")
    assert "World benchmark" not in text.split("line:")[1]
    path.write_text(text.replace("encumbrance: 1.2 m", "encumbrance: 1.4 m"), encoding="utf-8")
    case = load_case(path)
    assert [s for s in case.sources if s.path == "supports.encumbrance"] == []
    assert origin(case, "wires.contact.tension").template == "ac-simple"
    assert (case.title, case.description) == ("", "")


def test_source_that_states_its_value(tmp_path: Path) -> None:
    """A source with a value holds for that value only."""
    sources = (
        "sources:\n  - {path: supports.encumbrance, value: 1.4 m, source: drawing 1, "
        "confidence: one source}\n"
    )
    for height, count in (("1.4 m", 1), ("1.5 m", 0)):
        case = load_case(write(tmp_path, f"supports: {{encumbrance: {height}}}\n{sources}"))
        assert len([s for s in case.sources if s.source == "drawing 1"]) == count


def test_entries_named_otherwise() -> None:
    """A name under 'type' is told as 'use', and what the entry would give is not asked for."""
    data = {
        "schema": 2,
        "include": "ac-simple",
        "wires": {"contact-2": {"role": "contact", "type": "Ri 100"}},
        "pantograph": {"use": "DSA380"},
    }
    with pytest.raises(InputError) as caught:
        make_case(data)
    told = "\n".join(caught.value.problems)
    assert "wires.contact-2.type: unknown key; did you mean 'use'?" in told
    assert "wires.contact-2.tension: is missing:" in told
    assert "mass" not in told
    assert "pantograph: unknown key; did you mean 'pantographs'?" in told
    assert "nothing of the catalogue belongs here" not in told


def test_missing_numbers_may_come_from_the_catalogue() -> None:
    """A missing number that entries state says so; a tension, which none states, does not."""
    data = {"schema": 2, "include": "ac-simple", "wires": {"contact-2": {"role": "contact"}}}
    with pytest.raises(InputError) as caught:
        make_case(data)
    told = [text for text in caught.value.problems if "contact-2" in text]
    how = [text.split(": ")[1] for text in told if "an entry of the cat" in text]
    names = ("mass", "axial_stiffness", "bending_stiffness")
    assert how == [f"wires.contact-2.{name}" for name in names]
    assert len(told) == 4
