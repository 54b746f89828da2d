"""Case files: formats, includes, sources, round trips."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import yaml

from tautwire.errors import InputError
from tautwire.inputs.load import load_case, make_case
from tautwire.inputs.merge import merge
from tautwire.inputs.reading.documents import parse_document, parse_value
from tautwire.specs import Case

HEAD = "schema: 1\ninclude: ac-simple\nname: mine\n"


def load_text(folder: Path, text: str) -> Case:
    """Load a case file that completes the reference line."""
    path = folder / "mine.yaml"
    path.write_text(HEAD + text, encoding="utf-8")
    return load_case(path)


def sources_of(case: Case) -> dict[str, str]:
    """Return the confidence of each source by its path."""
    return {source.path: source.confidence for source in case.sources}


def test_scalars_are_those_of_yaml_1_2() -> None:
    """Only true and false are booleans; 1e-4 is a number; times and dates are texts."""
    text = "{a: 1e-4, b: yes, c: 1:30, d: 2015-01-01, e: ~, f: 010, g: -.5, h: +x, i: 0x10, j: on}"
    values = list(parse_document(text, "text", ".yaml").values())
    assert values == [1e-4, "yes", "1:30", "2015-01-01", None, 10, -0.5, "+x", "0x10", "on"]


def test_aliases_are_allowed() -> None:
    """An alias repeats what its anchor holds."""
    document = parse_document("a: &one {b: 1}\nc: *one\n", "text", ".yaml")
    assert document == {"a": {"b": 1}, "c": {"b": 1}}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("275 km/h", "275 km/h"),
        ("[4, 13]", [4, 13]),
        ("[[0, 24 mm], [0]]", [[0, "24 mm"], [0]]),
        ("{constant: 70 N}", {"constant": "70 N"}),
        ("null", None),
        ("-x", "-x"),
        ("1e-3", 1e-3),
        ("0.00097 N/(km/h)^2", "0.00097 N/(km/h)^2"),
    ],
)
def test_value_on_the_command_line(text: str, value: object) -> None:
    """A value is read as in a file, units included."""
    assert parse_value(text) == value


@pytest.mark.parametrize("text", ["[1", "a: b: c", "{a: 1, a: 2}", "[" * 5000, "*x"])
def test_malformed_value(text: str) -> None:
    """A malformed value is a ValueError that quotes it."""
    with pytest.raises(ValueError, match="is malformed"):
        parse_value(text)


@pytest.mark.parametrize("suffix", [".yaml", ".yml", ".json", ".toml", ".YAML"])
def test_formats_agree(suffix: str, tmp_path: Path) -> None:
    """The same case in YAML, JSON and TOML is the same case."""
    changes = {"schema": 1, "include": "ac-simple", "name": "mine", "line": {"spans": 9}}
    texts = {
        ".json": json.dumps(changes),
        ".toml": 'schema = 1\ninclude = "ac-simple"\nname = "mine"\n[line]\nspans = 9\n',
    }
    path = tmp_path / f"mine{suffix}"
    path.write_text(texts.get(suffix, yaml.safe_dump(changes)), encoding="utf-8")
    assert load_case(path).hash() == load_text(tmp_path, "line: {spans: 9}").hash()


@pytest.mark.parametrize("name", ["ac-simple", "en50318-2002", "ac-simple-two-pantographs"])
def test_case_survives_a_file(name: str, tmp_path: Path) -> None:
    """A case written as plain YAML is read back equal, with the same hash."""
    case = load_case(name)
    path = tmp_path / "again.yaml"
    path.write_text(yaml.safe_dump(case.to_dict(), allow_unicode=True), encoding="utf-8")
    again = load_case(path)
    assert again == case
    assert again.hash() == case.hash()


def test_plain_data_makes_a_case() -> None:
    """Plain data is validated like a file, with overrides, without 'schema'."""
    data = load_case("ac-simple").to_dict()
    del data["schema"]
    assert make_case(data) == load_case("ac-simple")
    assert make_case(data, {"line.spans": 9}).line.spans == 9
    with pytest.raises(InputError, match=r"case: line\.spans: got 0; must be at least 1"):
        make_case(data, {"line.spans": 0})


def test_local_values_win(tmp_path: Path) -> None:
    """A local key replaces the included one, its neighbours stay."""
    case = load_text(tmp_path, "wires: {contact: {tension: 27 kN}}\n")
    assert case.name == "mine"
    assert case.wires.contact.tension == 27e3
    assert case.wires.contact.mass == 1.35


def test_merge_keeps_one_of_two_exclusive_keys() -> None:
    """A prescribed force takes an included mean force away, and EA a spring."""
    base = {"mean_force": 169.0, "speed": 80.0, "stiffness": {"spring": 1e5}}
    local = {"uplift_force": 150.0, "stiffness": {"axial": 2e5}}
    assert merge(base, local) == {
        "speed": 80.0,
        "uplift_force": 150.0,
        "stiffness": {"axial": 2e5},
    }


def test_include_is_relative_to_its_file(tmp_path: Path) -> None:
    """A path in an included file starts at that file; a library name works everywhere."""
    folder = tmp_path / "parts"
    folder.mkdir()
    (folder / "wire.yaml").write_text("mass: 1.07 kg/m\ntension: 20 kN\n", encoding="utf-8")
    (folder / "wires.yaml").write_text("contact: {include: wire.yaml}\n", encoding="utf-8")
    case = load_text(tmp_path, "wires: {include: parts/wires.yaml}\n")
    assert (case.wires.contact.mass, case.wires.contact.tension) == (1.07, 20e3)
    assert case.wires.contact.bending_stiffness == 195.0


def test_local_keys_complete_an_included_pantograph(tmp_path: Path) -> None:
    """A pantograph of the library takes a name, a distance and a force where it is used."""
    case = load_text(
        tmp_path,
        "pantographs: [{include: benchmark-2015-pantograph, name: a},\n"
        "  {include: en50318-2002-pantograph, name: b, behind: 100 m, static_force: 60 N}]\n",
    )
    assert [len(pantograph.stages) for pantograph in case.pantographs] == [3, 2]
    assert case.pantographs[1].static_force == 60.0


def test_sources_of_a_part_get_its_path(tmp_path: Path) -> None:
    """Sources in an included pantograph stand in the case with the path of that pantograph."""
    case = load_text(
        tmp_path,
        "pantographs: [{include: benchmark-2015-pantograph, name: a},\n"
        "  {include: en50318-2002-pantograph, name: b, behind: 100 m}]\n",
    )
    assert sources_of(case)["pantographs[2].static_force"] == "memory"
    assert sources_of(case)["pantographs[1].stages[3].damping"] == "one source"


def test_source_of_a_replaced_value_is_dropped(tmp_path: Path) -> None:
    """An included source does not vouch for a local number; a local source replaces it."""
    case = load_text(
        tmp_path,
        "wires: {contact: {tension: 27 kN, mass: 1.08}}\n"
        "sources: [{path: wires.contact.mass, source: data sheet, confidence: one source}]\n",
    )
    assert "wires.contact.tension" not in sources_of(case)
    assert sources_of(case)["wires.contact.mass"] == "one source"
    assert sources_of(case)["wires.messenger.mass"] == "two sources"


def test_malformed_sources_of_a_part_are_told(tmp_path: Path) -> None:
    """An entry that is no mapping is refused where the sources are listed."""
    (tmp_path / "wire.yaml").write_text("sources: [5]\n", encoding="utf-8")
    with pytest.raises(
        InputError, match=r"sources\[\d+\]: got 5; expected a mapping with the keys"
    ):
        load_text(tmp_path, "wires: {contact: {include: wire.yaml}}\n")


def test_schema_of_a_part(tmp_path: Path) -> None:
    """An included part may name its schema, which is checked."""
    part = tmp_path / "wire.yaml"
    part.write_text("schema: 1\nmass: 1.07\n", encoding="utf-8")
    text = "wires: {contact: {include: wire.yaml}}\n"
    assert load_text(tmp_path, text).wires.contact.mass == 1.07
    part.write_text("schema: 3\nmass: 1.07\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"wire\.yaml: schema: got 3"):
        load_text(tmp_path, text)
