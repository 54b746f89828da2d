"""The documentation says what the program does."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
import yaml

import tautwire
from tautwire.specs.line.irregularity import Unevenness
from tautwire.specs.pantograph import RoofMotion
from tautwire.specs.schema import vocabulary
from tautwire.tables.columns import KINDS, fields_of

WORDS_OF_A_ROW = {
    "case",
    "quantity",
    "unit",
    "ours",
    "target",
    "tolerance",
    "source",
    "verdict",
    "note",
}


def test_every_refused_feature_is_on_the_page(root: Path) -> None:
    """``docs/not-modelled-yet.md`` names the features an input is refused for, and no other."""
    text = (root / "docs" / "not-modelled-yet.md").read_text(encoding="utf-8")
    rows = [line for line in text.splitlines() if line.startswith("| ")]
    listed = [row.split("|")[1].strip() for row in rows[1:]]
    assert listed == list(vocabulary._content()["features"])


def test_every_page_is_in_the_table_of_contents(root: Path) -> None:
    """No page of the documentation is orphaned."""
    docs = root / "docs"
    index = (docs / "index.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```\{toctree\}(.*?)```", index, re.DOTALL)
    words = {word for block in blocks for word in block.split()}
    listed = {word for word in words if (docs / f"{word}.md").exists()}
    assert listed == {path.stem for path in docs.glob("*.md")} - {"index"}


def test_validation_table_is_complete(root: Path) -> None:
    """Every stored row names its source, and a verdict outside is explained."""
    path = root / "docs" / "validation.json"
    if not path.exists():
        pytest.skip("no validation table stored yet")
    rows = json.loads(path.read_text(encoding="utf-8"))
    assert rows
    for row in rows:
        assert set(row) == WORDS_OF_A_ROW
        assert row["source"]
        assert row["verdict"] == "inside" or row["note"], row


def test_every_table_column_is_on_the_page(root: Path) -> None:
    """``docs/inputs.md`` names every column that a CSV table may have."""
    text = (root / "docs" / "inputs.md").read_text(encoding="utf-8")
    names = [field.name for kind in KINDS for field in fields_of(kind)]
    names += [*RoofMotion.table_columns, *Unevenness.table_columns]
    assert [name for name in names if f"`{name}`" not in text] == []


def test_own_line_page_describes_a_line_that_stands(root: Path, tmp_path: Path) -> None:
    """The pieces of ``docs/own-line.md`` make a line whose droppers and arms all pull."""
    text = (root / "docs" / "own-line.md").read_text(encoding="utf-8")
    pieces = re.findall(r"```yaml\n(.*?)```", text, re.DOTALL)
    case_file = tmp_path / "my-line.yaml"
    lines = ["include: ac-simple", "name: my-line", "scenario: {speed: 160 km/h}", *pieces[:2]]
    case_file.write_text("\n".join(lines), encoding="utf-8")
    shape = tautwire.find_shape(tautwire.build(tautwire.load_case(case_file)))
    assert len(shape.dropper_forces) == 14 * 5
    assert shape.dropper_forces.min() > 0.0
    assert shape.arm_forces.min() > 0.0


def test_tracks_of_the_inputs_page_are_tracks(root: Path) -> None:
    """The tracks written in ``docs/inputs.md`` reach under the line and bend as they say."""
    text = (root / "docs" / "inputs.md").read_text(encoding="utf-8")
    found = [
        tautwire.load_case("ac-simple", {"track": yaml.safe_load(piece)["track"]}).track
        for piece in re.findall(r"```yaml\n(track:\s.*?)```", text, re.DOTALL)
        if "table:" not in piece
    ]
    assert [track.pieces[-1].radius for track in found] == [1200.0, 900.0]
    assert found[1].profile[1].radius == 8000.0


def test_pantographs_of_the_inputs_page_are_pantographs(root: Path, tmp_path: Path) -> None:
    """The pantographs written in ``docs/inputs.md`` run where they say, with their stages."""
    text = (root / "docs" / "inputs.md").read_text(encoding="utf-8")
    case_file, found = tmp_path / "case.yaml", []
    for piece in re.findall(r"```yaml\n(pantographs:.*?)```", text, re.DOTALL):
        case_file.write_text(f"include: ac-simple\nname: case\n{piece}", encoding="utf-8")
        found.append(tautwire.load_case(case_file).pantographs)
    pair, own = found
    assert [one.behind for one in pair] == [0.0, 200.0]
    assert [one.mass for one in own[0].stages] == [7.5, 9.0, 6.0]


def test_included_variant_loads(root: Path, tmp_path: Path) -> None:
    """The include example of ``docs/inputs.md`` replaces what it names and keeps the rest."""
    text = (root / "docs" / "inputs.md").read_text(encoding="utf-8")
    (tmp_path / "variant.yaml").write_text(
        re.findall(r"```yaml\n(include.*?)```", text, re.DOTALL)[0], encoding="utf-8"
    )
    wires = tautwire.load_case(tmp_path / "variant.yaml").wires
    assert wires.contact.tension == 27e3
    assert wires.messenger is not None
    assert wires.messenger.tension == 16e3
