"""The catalogue: numbers that fit together, origins, names, own files, the command."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from tautwire.catalogue.own_file import copy_part
from tautwire.catalogue.parts import KIND_NAMES, ContactWire, Part, Rope
from tautwire.catalogue.shelf import package_shelf, read_parts
from tautwire.cli.app import run_command_line
from tautwire.errors import InputError
from tautwire.inputs.completion import shelf_with

SHELF = package_shelf()
STRANDS = [part for part in SHELF.parts if isinstance(part, ContactWire | Rope)]
CONTACT_WIRES = [part for part in STRANDS if isinstance(part, ContactWire)]
ROPES = [part for part in STRANDS if isinstance(part, Rope)]


def named(part: Part) -> str:
    return part.name


def value(name: str, number: str, kind: str) -> float:
    return SHELF.find(name, [kind]).numbers()[number].value


def test_every_kind_is_on_the_shelf() -> None:
    """Wires, ropes, droppers, clamps, arms, cantilevers and pantographs are all there."""
    assert {part.kind for part in SHELF.parts} == set(KIND_NAMES)


@pytest.mark.parametrize("material", ["Cu", "CuAg0.1", "CuMg0.2", "CuMg0.5", "CuSn0.2"])
@pytest.mark.parametrize("profile", ["AC-80", "AC-100", "AC-120", "AC-150", "BC-107", "BC-150"])
def test_designations_of_the_standard(profile: str, material: str) -> None:
    """A contact wire is found by groove, section and material, as EN 50149 names it."""
    wire = SHELF.find(f"{profile} {material}", ["contact wire"])
    assert wire.numbers()["section"].value == pytest.approx(1e-6 * int(profile[3:]))


@pytest.mark.parametrize(
    ("alias", "name"),
    [
        ("Ri 100", "AC-100 Cu"),
        ("ris120", "AC-120 CuAg0.1"),
        ("RiM-120", "AC-120 CuMg0.5"),
        ("HC 107", "BC-107 Cu"),
        ("CTMH120", "CTMH 120"),
        ("ctah-150", "CTAH 150"),
        ("BzII-120", "Bz II 120/19"),
        ("Cu 50", "Cu 50/19"),
    ],
)
def test_other_names(alias: str, name: str) -> None:
    """Older and foreign names lead to the same entry; spaces, hyphens and case do not matter."""
    assert SHELF.find(alias).name == name


@pytest.mark.parametrize("part", STRANDS, ids=named)
def test_mass_is_density_times_section(part: ContactWire | Rope) -> None:
    """Copper and its low alloys have 8.7 to 9.15 kg/dm3; the lay of a rope adds 1 to 2 %."""
    lay = {7: 1.014, 19: 1.018, 37: 1.020}[part.wires] if isinstance(part, Rope) else 1.0
    density = part.mass.value / part.section.value / lay
    assert 8700.0 < density < 9150.0


@pytest.mark.parametrize("part", STRANDS, ids=named)
def test_stiffness_is_modulus_times_section(part: ContactWire | Rope) -> None:
    """EA is E times the section in every entry, the stated ones included."""
    product = part.elasticity.value * part.section.value
    assert part.axial_stiffness.value == pytest.approx(product, rel=1e-6)


@pytest.mark.parametrize("part", [w for w in CONTACT_WIRES if w.diameter], ids=named)
def test_grooved_wire_is_wider_than_its_circle(part: ContactWire) -> None:
    """Grooves make the diameter 3 to 9 % larger than that of the circle of equal area."""
    assert part.diameter is not None
    ratio = part.diameter.value / math.sqrt(4.0 * part.section.value / math.pi)
    assert 1.03 < ratio < 1.09


@pytest.mark.parametrize("part", ROPES, ids=named)
def test_rope_fits_its_wires(part: Rope) -> None:
    """Section and diameter are those of the wires, within the rounding of sheets (3 %)."""
    d = part.wire_diameter.value
    layers = {7: 1, 19: 2, 37: 3}[part.wires]
    assert part.section.value == pytest.approx(part.wires * math.pi * d * d / 4.0, rel=0.03)
    assert part.diameter is not None
    assert part.diameter.value == pytest.approx((2 * layers + 1) * d, rel=0.01)


@pytest.mark.parametrize("part", ROPES, ids=named)
def test_rope_sticks_by_default(part: Rope) -> None:
    """The stick value is 8 (7 wires) to 48 (37 wires) times the slip value and is the one given."""
    ratio = part.bending_stiffness.value / part.bending_stiffness_slip.value
    assert 7.5 < ratio < 50.0
    assert part.filling()["bending_stiffness"] is part.bending_stiffness
    assert "bending_stiffness_slip" not in part.filling()


def test_stick_value_of_the_reference_messenger() -> None:
    """19 wires of 2.8 mm at 97 GPa that stick have the 131.7 N m2 of the reference models."""
    entry = {
        "name": "rope",
        "summary": "Rope.",
        "wires": 19,
        "wire_diameter": {"value": "2.8 mm", "memory": "test"},
        "elasticity": {"value": "97 GPa", "memory": "test"},
        "thermal_expansion": {"value": 1.7e-5, "memory": "test"},
    }
    (rope,) = read_parts({"kind": "rope", "entries": [entry]}, "test")
    assert rope.numbers()["bending_stiffness"].value == pytest.approx(131.7, abs=0.4)


@pytest.mark.parametrize(
    ("name", "kilonewton"),
    [("BC-107 Cu", 36.3), ("AC-120 Cu", 38.4), ("AC-150 Cu", 45.1), ("AC-120 CuAg0.1", 41.9)],
)
def test_breaking_loads_of_the_printed_table(name: str, kilonewton: float) -> None:
    """0.97 x section x tensile strength is the breaking load that the table of EN 50149 prints."""
    assert value(name, "strength", "contact wire") == pytest.approx(1e3 * kilonewton, abs=60.0)


@pytest.mark.parametrize(
    ("name", "kilonewton"), [("Bz II 120/19", 66.3), ("Cu 185 Adif", 67.1), ("Cu 95/19", 37.39)]
)
def test_breaking_loads_of_ropes(name: str, kilonewton: float) -> None:
    """Breaking loads of ropes agree with NAE 108, NAE 116 and DIN 48201-1 within 4 %."""
    assert value(name, "strength", "rope") == pytest.approx(1e3 * kilonewton, rel=0.04)


@pytest.mark.parametrize("part", SHELF.parts, ids=named)
def test_every_number_says_where_it_comes_from(part: Part) -> None:
    """Every number has an origin in words, and lies in the range stated with it."""
    assert part.numbers()
    for key, number in part.numbers().items():
        assert all(len(text) > 5 for text in number.origins), key
        if number.low is not None and number.high is not None:
            assert number.low <= number.value <= number.high, key


def test_names_lead_to_one_entry() -> None:
    """No name or alias belongs to two entries."""
    owners: dict[str, set[str]] = {}
    for part in SHELF.parts:
        for name in (part.name, *part.aliases):
            owners.setdefault(name.casefold().replace(" ", "").replace("-", ""), set()).add(
                part.name
            )
    assert [names for names in owners.values() if len(names) > 1] == []


def test_unknown_name_and_wrong_kind() -> None:
    """A wrong name is answered with close ones, a wrong kind with what is needed."""
    with pytest.raises(InputError, match=r"no contact wire named 'AC-130 Cu'; did you mean 'AC-1"):
        SHELF.find("AC-130 Cu", ["contact wire"])
    every = r"'AC-150 CuMg0.2', 'BC-150 CuMg0.2', 'AC-150 CuMg0.5', 'BC-150 CuMg0.5'\?"
    with pytest.raises(InputError, match=f"did you mean {every}"):
        SHELF.find("CuMg 150", ["contact wire"])
    with pytest.raises(InputError, match=r"'BzII-10' is a dropper; a contact wire is needed"):
        SHELF.find("BzII-10", ["contact wire"])


def test_faults_of_an_own_file_are_all_told() -> None:
    """Every fault of an own catalogue file is named with its entry and its key."""
    number = {"value": "100 mm2", "seen": "sheet"}
    data = {
        "kind": "contact wire",
        "entries": [
            {"name": "a", "summary": "A.", "section": {"value": "100 mm", "seen": "sheet"}},
            {"name": "b", "summary": "B.", "section": {"value": "100 mm2"}, "colour": "red"},
            {"name": "c", "kind": "tube", "section": number},
        ],
    }
    with pytest.raises(InputError) as caught:
        read_parts(data, "own.yaml")
    text = "\n".join(caught.value.problems)
    assert "own.yaml: entry 1 (a): section: got '100 mm', which is a length" in text
    assert "own.yaml: entry 2 (b): section: needs exactly one origin" in text
    assert "own.yaml: entry 2 (b): colour: unknown key" in text
    assert "own.yaml: entry 3 (c): kind: got 'tube'; choose contact wire, rope" in text


@pytest.mark.parametrize("part", SHELF.parts, ids=named)
def test_copy_holds_the_same_numbers(part: Part, tmp_path: Path) -> None:
    """A copied entry, read as an own file, has the numbers and origins of its original."""
    path = copy_part(part, tmp_path / "my-own.yaml")
    copy = shelf_with([path]).find("my-own")
    assert copy.kind == part.kind
    for key, number in part.numbers().items():
        other = copy.numbers()[key]
        assert other.value == pytest.approx(number.value, rel=1e-5)
        assert (other.origins, other.confidence) == (number.origins, number.confidence)


def test_copy_never_replaces_a_file_unasked(tmp_path: Path) -> None:
    """An existing file is left as it is unless --force is given."""
    path = tmp_path / "own.yaml"
    path.write_text("mine", encoding="utf-8")
    part = SHELF.find("Ri 100")
    with pytest.raises(InputError, match="exists already"):
        copy_part(part, path)
    assert path.read_text(encoding="utf-8") == "mine"
    copy_part(part, path, force=True)
    assert "AC-100 Cu" in path.read_text(encoding="utf-8")


def test_changed_section_changes_what_follows(tmp_path: Path) -> None:
    """In an own file EA and EI follow a changed section: 10 % more gives 10 % and 21 % more."""
    path = copy_part(SHELF.find("Ri 100"), tmp_path / "own.yaml")
    text = path.read_text(encoding="utf-8").replace("value: 100 mm2", "value: 110 mm2")
    path.write_text(text, encoding="utf-8")
    numbers = shelf_with([path]).find("own").numbers()
    assert numbers["axial_stiffness"].value == pytest.approx(1.1 * 12.0e6)
    assert numbers["bending_stiffness"].value == pytest.approx(1.21 * 95.493, rel=1e-4)


def test_command_lists_searches_and_shows(capsys: pytest.CaptureFixture[str]) -> None:
    """The command shows an entry by name, those that hold a word, and all of a kind."""

    def names(*arguments: str) -> list[str]:
        assert run_command_line(["catalogue", *arguments, "--json"]) == 0
        return [entry["name"] for entry in json.loads(capsys.readouterr().out)["entries"]]

    assert names("RiM", "120") == ["AC-120 CuMg0.5"]
    assert names("tin 107") == ["AC-107 CuSn0.2", "BC-107 CuSn0.2"]
    assert names("--kind", "clamp") == ["steady-arm clamp", "stitch-wire clamp"]
    assert len(names()) == len(SHELF.parts)


def test_command_tells_what_is_wrong(capsys: pytest.CaptureFixture[str]) -> None:
    """An unknown name or kind is refused with exit code 2 and a suggestion."""
    assert run_command_line(["catalogue", "BzIII-120"]) == 2
    assert "did you mean 'BzII-120'" in capsys.readouterr().err
    assert run_command_line(["catalogue", "--kind", "ropes"]) == 2
    assert "did you mean 'rope'?" in capsys.readouterr().err


def test_list_fits_a_terminal(capsys: pytest.CaptureFixture[str], monkeypatch) -> None:
    """At 80 columns no number of the list is cut."""
    monkeypatch.setenv("COLUMNS", "80")
    assert run_command_line(["catalogue", "--kind", "rope"]) == 0
    out = capsys.readouterr().out
    assert max(map(len, out.splitlines())) <= 80
    row = next(line for line in out.splitlines() if line.startswith("Bz II 120/19"))
    assert row.split()[3:8] == ["14", "1.06", "13.22", "153.8", "68.67"]
