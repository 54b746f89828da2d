"""What the program writes as tables it reads back without a change."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import fields, replace
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
import openpyxl
import pytest

from tautwire.analyses.road.shape import find_shape
from tautwire.catalogue.entries import list_entries
from tautwire.cli.app import run_command_line
from tautwire.errors import InputError
from tautwire.inputs.book.case_book import case_sheets, write_workbook
from tautwire.inputs.load import load_case
from tautwire.line.expand import expand
from tautwire.model.build import build
from tautwire.report.parts.tables import write_dropper_table
from tautwire.specs.case import MOST_LIMITS, Case
from tautwire.tables.columns import fields_of
from tautwire.tables.headings import read_heading
from tautwire.text import csv_text

from .test_line_tables import SPANS, SUPPORTS, WIRES, workbook

LIBRARY = [entry.name for entry in list_entries() if entry.kind == "case"]
COARSE = ["settings.nodes_between_droppers=4"]
TOPOLOGIES = ["ac-simple", "ac-simple-curve", "ac-stitched", "dc-twin", "compound",
              "ac-simple-overlap"]  # fmt: skip


def told(case: Case) -> dict[str, Any]:
    """Return a case with one value for all written out as the lists that it stands for."""
    data = case.to_dict()
    for sheet in ("supports", "droppers"):
        data.pop(sheet)
    data["line"].pop("span_length")
    return {**data, "sheets": {name: list(map(tuple, rows)) for name, rows in
                               case_sheets(case).items()}}  # fmt: skip


@pytest.mark.parametrize("name", LIBRARY)
def test_workbook_of_a_case_is_the_case(name: str, tmp_path: Path) -> None:
    """Every line of the library, written as a workbook and read back, has the same pieces and the
    same values; the workbook of what was read is the same workbook."""
    case = load_case(name)
    again = load_case(write_workbook(case, tmp_path / "line.xlsx"))
    assert told(again) == told(case)
    for one, other in ((expand(again), expand(case)),):
        assert one.runs == other.runs
        assert one.hangers == other.hangers
        assert one.joints == other.joints
        assert one.suspensions == other.suspensions
    third = load_case(write_workbook(again, tmp_path / "line2.xlsx"))
    assert third.to_dict() == again.to_dict()
    assert third.hash() == again.hash()


@pytest.mark.parametrize("name", TOPOLOGIES)
def test_rows_give_the_same_mesh(name: str, tmp_path: Path) -> None:
    """A line that rules made has, written as rows, the same mesh and the same arrays to the bit;
    bodies, stays and elastic cantilevers too."""
    case = load_case(name, COARSE)
    at = {"wire": "contact", "span": 3, "tension_length": None}
    if case.tension_lengths:
        at["tension_length"] = case.tension_lengths[0].name
    case = case.with_(
        bodies=[{**at, "name": "insulator", "at": 2.0, "length": 1.0, "mass": 7.5}],
        stays=[{**at, "name": "tie", "at": 3.5, "stiffness": 1e6, "end_y": 3.0, "end_z": 5.0}],
        **{"supports.cantilever": {"arm": {"lateral": 1e5}} if "swinging" in told_arms(case)
           else None},
    )  # fmt: skip
    one, other = build(case), build(load_case(write_workbook(case, tmp_path / "line.xlsx")))
    assert replace(one.line, track=other.line.track) == other.line
    ours, theirs = one.form.system, other.form.system
    assert np.array_equal(one.mesh.s, other.mesh.s)
    assert np.array_equal(ours.position, theirs.position)
    assert np.array_equal(ours.load, theirs.load)
    assert np.array_equal(ours.node_mass, theirs.node_mass)
    for part in ("cables", "ties", "clamps", "stays"):
        for item in fields(getattr(ours, part)):
            pair = (getattr(getattr(system, part), item.name) for system in (ours, theirs))
            assert np.array_equal(*pair, equal_nan=item.name == "axial"), (part, item.name)


@pytest.mark.parametrize("name", TOPOLOGIES)
def test_tables_of_wires_name_every_wire(name: str, tmp_path: Path) -> None:
    """Supports, droppers and wires of any topology from three CSV files give the same line and the
    same mesh to the bit, roles, sides and clamps of the wires included."""
    case = load_case(name, COARSE)
    numbers = ("tension", "mass", "axial_stiffness", "bending_stiffness", "side", "from_", "to",
               "clamp", "below")  # fmt: skip
    heads = ("wire", "wire role", "clamped_to", *(word.rstrip("_") for word in numbers))
    wires = [
        (wire_name, wire.role, wire.clamped_to, *(getattr(wire, word) for word in numbers))
        for wire_name, wire in case.wires.named()
    ]
    kept = ("droppers", "supports", "wires")
    sheets = {**case_sheets(case), "wires": [heads, *wires]}
    for kind in kept:
        text = csv_text(sheets[kind][0], [["" if v is None else v for v in row]
                                          for row in sheets[kind][1:]])  # fmt: skip
        (tmp_path / f"{kind}.csv").write_text(text, encoding="utf-8")
    data = {key: value for key, value in case.to_dict().items() if key != "wires"}
    named = dict(case.wires.named())
    for key in ("spans", "span_length", "masts", "chainage"):
        data["line"].pop(key)
    for one in data["droppers"] if isinstance(data["droppers"], list) else [data["droppers"]]:
        for key in ("positions", "presag", "lengths"):
            one.pop(key)
    for key in ("contact_height", "encumbrance", "contact_stagger", "messenger_stagger"):
        data["supports"].pop(key)
    data |= {"name": "mine", "tables": {kind: f"{kind}.csv" for kind in kept}, "sources": []}
    (tmp_path / "mine.json").write_text(json.dumps(data), encoding="utf-8")
    again = load_case(tmp_path / "mine.json")
    assert {key: wire.role for key, wire in again.wires.named()} == {
        key: wire.role for key, wire in named.items()
    }
    one, other = build(case), build(again)
    assert np.array_equal(one.mesh.s, other.mesh.s)
    assert np.array_equal(one.form.system.position, other.form.system.position)
    assert np.array_equal(one.form.system.load, other.form.system.load)


def told_arms(case: Case) -> set[str]:
    """Return how the steady arms of a case move."""
    return set() if case.supports.closure == "spring" else {case.supports.arm.motion}


def test_workbook_to_case_to_workbook(tmp_path: Path) -> None:
    """A user's workbook with unequal spans, mast names and chainage becomes a case whose workbook
    gives the very same case, names and chainage included."""
    case = load_case(workbook(tmp_path / "valley.xlsx", Masts=SUPPORTS, Wires=WIRES))
    again = load_case(write_workbook(case, tmp_path / "again.xlsx"))
    assert again == case
    assert again.line.masts == case.line.masts


def test_limits_that_no_cell_holds(tmp_path: Path) -> None:
    """A long file of limits, with blanks, line ends and number signs, comes back as it was."""
    note = "".join(f"# {n}  remark = '{n}' \n\n" for n in range(9000))[: MOST_LIMITS - 20]
    case = load_case("ac-simple").with_(limits=f"limits: []\n{note}\nend: 1")
    again = load_case(write_workbook(case, tmp_path / "long.xlsx"))
    assert again.limits == case.limits
    book = openpyxl.load_workbook(tmp_path / "long.xlsx")
    lengths = [len(str(cell)) for (cell,) in book["values"].iter_rows(min_col=2, max_col=2,
                                                                     values_only=True)]  # fmt: skip
    assert 20_000 < max(lengths) < 32_767


def test_falling_chainage_and_odd_numbers(tmp_path: Path) -> None:
    """Staggers beside falling chainage, chainages rounded to metres, numbers of 17 digits and names
    that look like formulas come back as they were."""
    case = load_case("ac-simple")
    spans = (58.123456789012345, 60.1, 0.1 + 0.2 + 55.0)
    odd = case.with_(
        line=case.line.with_(
            spans=3, span_length=spans, masts=("=1+2", "#7", "007", "-"),
            chainage=(1000.0, 942.0, 882.0, 827.0),
        ),
        **{
            "supports.contact_stagger": (0.2, -0.15, 0.0, 0.1),
            "supports.closure": "height",
            "settings.section": None,
        },
    )  # fmt: skip
    assert load_case(write_workbook(odd, tmp_path / "odd.xlsx")) == odd.with_(
        **{
            "supports.contact_height": (5.3,) * 4,
            "supports.encumbrance": (1.2,) * 4,
            "droppers.positions": (case.dropper_sets[0].positions,) * 3,
            "droppers.presag": (case.dropper_sets[0].presag,) * 3,
        }
    )


@pytest.mark.parametrize("name", TOPOLOGIES)
def test_written_dropper_table_is_read_back(name: str, tmp_path: Path) -> None:
    """The dropper table that the program writes gives the same heights back: 1 um, where 0.1 mm is
    promised; 0.01 N of dropper force."""
    case = load_case(name, COARSE)
    shape = find_shape(build(case))
    write_dropper_table(shape, case, tmp_path / "droppers.csv")
    (tmp_path / "again.yaml").write_text(
        f"schema: 2\ninclude: {name}\nname: again\ntables: {{droppers: droppers.csv}}\n",
        encoding="utf-8",
    )
    again = find_shape(build(load_case(tmp_path / "again.yaml", COARSE)))
    assert again.dropper_heights == pytest.approx(shape.dropper_heights, abs=1e-6)
    assert again.dropper_forces == pytest.approx(shape.dropper_forces, abs=1e-2)
    assert again.support_heights == pytest.approx(shape.support_heights, abs=1e-6)


def test_dropper_table_names_masts_and_chainage(tmp_path: Path) -> None:
    """A line with mast names and chainage has both beside every dropper."""
    case = load_case(workbook(tmp_path / "valley.xlsx", Masts=SUPPORTS, Wires=WIRES), COARSE)
    path = write_dropper_table(find_shape(build(case)), case, tmp_path / "droppers.csv")
    head, first, *rows = (line.split(",") for line in path.read_text("utf-8").splitlines())
    assert head[:6] == ["span", "dropper", "mast", "position [m]", "x [m]", "chainage [m]"]
    assert first[:6] == ["1", "1", "4/8", "4.500000", "4.5000", "12304.5000"]
    assert len(rows) + 1 == sum(map(len, case.dropper_sets[0].positions_by_span(len(SPANS))))


def test_values_in_a_workbook_complete_it(tmp_path: Path) -> None:
    """A sheet of paths and values sets what the tables do not say; wires follow its speed."""
    values = [["Setting", "Value"], ["scenario.speed", "230 km/h"], ["settings.band", 100]]
    case = load_case(workbook(tmp_path / "v.xlsx", Masts=SUPPORTS, Settings=values))
    assert case.scenario.speed == pytest.approx(230 / 3.6)
    assert case.settings.band == 100.0
    assert case.wires.contact.tension == 15e3
    assert {one.path: one.source for one in case.sources}["settings.band"] == "Table v.xlsx"


def test_bad_values_are_named(tmp_path: Path) -> None:
    """Paths that lead nowhere, stand twice or contradict a table are named with their cells."""
    values = [["Setting", "Value"], ["scenario.sped", 60], ["settings.band", 100],
              ["settings.band", 200], ["line.spans", 3], ["track.pieces[2].arc", 5]]  # fmt: skip
    with pytest.raises(InputError) as caught:
        load_case(workbook(tmp_path / "v.xlsx", Masts=SUPPORTS, Settings=values))
    text = "\n".join(caught.value.problems)
    assert "sheet 'Settings', cell B2 (Value): scenario.sped" in text
    assert "did you mean 'speed'" in text
    assert "cell B4 (Value): settings.band: is given twice" in text
    assert "cell B5 (Value): line.spans: got 3; another table of the workbook says" in text


def test_two_sheets_of_one_kind_are_refused(tmp_path: Path) -> None:
    """Of two sheets of supports neither is dropped without a word."""
    with pytest.raises(InputError, match=r"is a table of supports, as .Masts. is; keep one"):
        load_case(workbook(tmp_path / "v.xlsx", Masts=SUPPORTS, Old=SUPPORTS))


def test_misread_sheet_is_refused(tmp_path: Path) -> None:
    """A sheet named after droppers without a column of positions is not replaced by a rule."""
    droppers = [["Mast", "Dropper", "Where", "Length [m]"], ["4/8", 1, 5.0, 1.0]]
    with pytest.raises(InputError, match=r"named as a table of droppers, but none .* .position."):
        load_case(workbook(tmp_path / "v.xlsx", Masts=SUPPORTS, Droppers=droppers))


@pytest.mark.parametrize(
    ("heading", "field"),
    [
        ("Punto kilométrico", "chainage"),
        ("Strecken-km", "chainage"),
        ("Distance to next mast [m]", "span_length"),
        ("Luz del vano (m)", "span_length"),
        ("FD-Höhe [m]", "contact_height"),
        ("Altura del hilo de contacto (m)", "contact_height"),
        ("Contact wire stagger [mm]", "contact_stagger"),
        ("Descentramiento HC", "contact_stagger"),
        ("Remarks", None),
    ],
)
def test_headings_of_supports(heading: str, field: str | None) -> None:
    """What heads the tables of masts in several countries, and what is left aside."""
    reading = read_heading(heading, "", fields_of("supports"))
    assert (None if reading is None else reading.field.name) == field


def test_supports_by_name(tmp_path: Path) -> None:
    """A column "Support" with names is one of names; with 1, 2, 3 it counts."""
    rows = [["Support", "Chainage [m]"], ["A 12", 0], ["A 13", 50], ["A 14", 100]]
    assert load_case(workbook(tmp_path / "a.xlsx", Masts=rows)).line.masts == (
        "A 12",
        "A 13",
        "A 14",
    )
    rows = [["Support", "Chainage [m]"], [1, 0], [2, 50], [3, 100]]
    assert load_case(workbook(tmp_path / "b.xlsx", Masts=rows)).line.masts is None


@pytest.mark.parametrize(
    ("heading", "field"),
    [
        ("Vano nº", "span"),
        ("Mast-Nr.", "mast"),
        ("Nº de péndola", "dropper"),
        ("Longitud péndola [m]", "length"),
        ("Péndola, longitud [m]", "length"),
        ("Distance from mast [m]", "position"),
        ("Abstand zum Mast [m]", "position"),
    ],
)
def test_headings_in_any_order(heading: str, field: str, tmp_path: Path) -> None:
    """Words in another order, prepositions and what says "number" change no meaning."""
    reading = read_heading(heading, "", fields_of("droppers"))
    assert reading is not None
    assert reading.field.name == field


def test_library_case_as_a_workbook(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """``cases NAME --copy FILE.xlsx`` begins a line of one's own; what is taken over says so."""
    path = tmp_path / "mine.xlsx"
    assert run_command_line(["cases", "ac-simple", "--copy", str(path)]) == 0
    case = load_case(path)
    assert (case.name, case.title) == ("mine", "")
    assert {one.template for one in case.sources} == {"ac-simple"}
    assert openpyxl.load_workbook(path).sheetnames[:2] == ["supports", "droppers"]
    assert run_command_line(["cases", "ac-simple", "--copy", str(path)]) == 2
    assert "exists already" in capsys.readouterr().err


def edited(tmp_path: Path, change: Callable[[Any], None]) -> Path:
    """Return a workbook of masts, droppers and wires that somebody has changed."""
    droppers: list[list[Any]] = [["Mast", "Dropper", "Distance from mast [m]", "Length [mm]"]]
    for i, span in enumerate(SPANS):
        droppers += [
            [f"4/{8 + i}" if k == 0 else None, k + 1, span * (k + 1) / 5, 1000] for k in range(4)
        ]
    path = workbook(tmp_path / "v.xlsx", Masts=SUPPORTS, Droppers=droppers, Wires=WIRES)
    book = openpyxl.load_workbook(path)
    change(book)
    book.save(path)
    return path


def _each(book: Any, column: str, write: Callable[[float, int], Any]) -> None:
    """Write the cells of a column of the masts anew from chainage or stagger and number."""
    for i in range(len(SPANS) + 1):
        value = 12300.0 + sum(SPANS[:i]) if column == "B" else 200.0 * (-1) ** i
        book["Masts"][f"{column}{i + 4}"] = write(value, i)


def _total(book: Any) -> None:
    book["Masts"].append(["Summe", None, None, None, sum(SPANS)])


def _formula(book: Any) -> None:
    book["Masts"]["C5"] = "=-C4"


def _date(book: Any) -> None:
    book["Masts"]["A4"] = datetime(2026, 4, 9)


def _double(book: Any) -> None:
    book["Masts"]["A6"] = "4/9"


def _german(value: float, _: int) -> str:
    return f"{value:,.2f}".translate(str.maketrans(",.", ".,"))


@pytest.mark.parametrize(
    "change",
    [
        lambda book: _each(book, "B", lambda v, _: f"km {v // 1000:.0f}+{v % 1000:07.3f}"),
        lambda book: _each(book, "B", _german),
        lambda book: _each(book, "B", lambda v, _: f"{v:,.2f}"),
        lambda book: _each(book, "C", lambda v, _: f"{abs(v):g} {'L' if v > 0 else 'R'}"),
        lambda book: _each(book, "C", lambda v, _: f"{abs(v):g} {'izq.' if v > 0 else 'der.'}"),
        _total,
        lambda book: book["Masts"].insert_rows(2),
    ],
    ids=["km", "german", "english", "sides", "lados", "total", "gap"],
)
def test_workbooks_as_people_write_them(change: Callable[[Any], None], tmp_path: Path) -> None:
    """Kilometres before km+m, thousands in groups, sides as letters and rows of totals mean the
    line that plain numbers mean."""
    plain = load_case(edited(tmp_path, lambda _: None))
    assert load_case(edited(tmp_path, change)) == plain


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (_formula, "cell C5 (Stagger [mm]): holds a formula without a value; open the workbook"),
        (_date, "cell A4 (Mast no.): got the date 2026-04-09 00:00:00; format the column as text"),
        (_double, "(Mast): got '4/9', a name that 2 supports have"),
    ],
    ids=["formula", "date", "double"],
)
def test_what_spreadsheets_do_is_told(
    change: Callable[[Any], None], words: str, tmp_path: Path
) -> None:
    """A formula never calculated, a name that became a date, a name that stands twice."""
    with pytest.raises(InputError) as caught:
        load_case(edited(tmp_path, change))
    assert words in "\n".join(caught.value.problems)


def test_wire_that_is_unknown_names_the_workbook(tmp_path: Path) -> None:
    """A wire type that the catalogue lacks is told with the file, not as part of 'case'."""
    wires = [["Wire", "Type"], ["Contact wire", "Ri 99"]]
    with pytest.raises(InputError, match=r"^.*v\.xlsx: wires\.contact\.use: the catalogue has no"):
        load_case(workbook(tmp_path / "v.xlsx", Masts=SUPPORTS, Wires=wires))


def test_mapping_file_that_is_older_than_the_workbook(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Columns and sheets that came after the mapping was written are told, not dropped in silence;
    what went is told with the cure."""
    path = edited(tmp_path, lambda book: book.remove(book["Droppers"]))
    assert run_command_line(["check", str(path)]) == 0
    capsys.readouterr()
    kept = (tmp_path / "v.mapping.yaml").read_text(encoding="utf-8")

    def grown(book: Any) -> None:
        book["Masts"]["G3"] = "Type"
        book["Masts"]["G5"] = None

    edited(tmp_path, grown)
    assert run_command_line(["check", str(path)]) == 0
    told = " ".join(capsys.readouterr().err.split())
    assert "does not name the column 'Type', which is left aside; remove the mapping" in told
    assert "sheet 'Droppers': could be a table of droppers, but" in told
    assert (tmp_path / "v.mapping.yaml").read_text(encoding="utf-8") == kept
    (tmp_path / "v.mapping.yaml").write_text(kept.replace("Stagger", "Zigzag"), encoding="utf-8")
    with pytest.raises(
        InputError, match=r"no column .*; remove the mapping file to have a new one"
    ):
        load_case(path)
