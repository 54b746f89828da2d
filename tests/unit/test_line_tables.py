"""Workbooks and tables of lines: headings by meaning, values as people write them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import openpyxl
import pytest

from tautwire.analyses.road.shape import find_shape
from tautwire.cli.app import run_command_line
from tautwire.errors import InputError
from tautwire.inputs.load import load_case
from tautwire.inputs.reading.survey import load_survey
from tautwire.inputs.reading.tables import open_sheets
from tautwire.model.build import build
from tautwire.specs.schema.vocabulary import Meaning, folded, meaning_of, words_for
from tautwire.tables.columns import KINDS, fields_of, role_of
from tautwire.tables.mapping import propose
from tautwire.tables.values import CellError, number_of

from ..lines import droppers_of

SPANS = (60.0, 58.0, 55.0, 61.0, 50.0, 60.0, 60.0, 52.0)
SUPPORTS: list[list[Any]] = [
    ["Valley line, sheet 4"],
    [],
    ["Mast no.", "Chainage [km+m]", "Stagger [mm]", "CW height [m]", "System height [m]", "Remark"],
    *(
        [f"4/{8 + i}", f"12+{300 + sum(SPANS[:i]):07.3f}", 200 * (-1) ** i, "5,30", 1.4, None]
        for i in range(len(SPANS) + 1)
    ),
]
WIRES: list[list[Any]] = [
    ["Wire", "Type", "Tension [kN]"],
    ["Contact wire", "Ri 100", 10],
    ["Catenary wire", "BzII-50", "10,0"],
]


def workbook(path: Path, **sheets: list[list[Any]]) -> Path:
    book = openpyxl.Workbook()
    assert book.active is not None
    book.remove(book.active)
    for name, rows in sheets.items():
        sheet = book.create_sheet(name)
        for row in rows:
            sheet.append(row)
    book.save(path)
    return path


def table(path: Path, text: str, encoding: str = "utf-8") -> Path:
    path.write_bytes(text.encode(encoding))
    return path


def test_workbook_becomes_a_case(tmp_path: Path) -> None:
    """Spans, staggers, heights, wires by name, mast names and chainage come from the sheets."""
    case = load_case(workbook(tmp_path / "valley.xlsx", Masts=SUPPORTS, Wires=WIRES))
    assert case.line.span_lengths() == SPANS
    assert case.line.masts is not None
    assert case.line.masts[4] == "4/12"
    assert case.line.place_of_support(4) == "mast 4/12, km 12.534"
    assert case.supports.contact_staggers(9)[:3] == (0.2, -0.2, 0.2)
    assert case.supports.contact_heights(9)[0] == pytest.approx(5.3)
    assert (case.wires.contact.tension, case.wires.contact.mass) == (10e3, 0.89)
    assert case.wires.messenger is not None
    assert case.wires.messenger.mass == 0.446
    sources = {source.path: source for source in case.sources}
    assert sources["line.span_length"].source == "Table valley.xlsx"
    assert sources["supports.closure"].template == "tautwire new"


def test_droppers_follow_unequal_spans(tmp_path: Path) -> None:
    """Without a table of droppers they are placed in every span by rule, and all of them pull."""
    case = load_case(workbook(tmp_path / "valley.xlsx", Masts=SUPPORTS, Wires=WIRES))
    rows = droppers_of(case).positions_by_span(len(SPANS))
    assert [row[0] for row in rows] == [4.5] * len(SPANS)
    assert [round(s - row[-1], 6) for s, row in zip(SPANS, rows, strict=True)] == [4.5] * len(SPANS)
    shape = find_shape(build(case.with_(**{"settings.nodes_between_droppers": 4})))
    assert shape.dropper_forces.min() > 0.0


@pytest.mark.parametrize(
    ("headings", "encoding", "separator"),
    [
        ("Mastnummer;Stationierung [m];Seitenlage [cm];Systemhöhe [m]", "cp1252", ";"),
        ("N° support;PK [km];Désaxement [mm];Encombrement [m]", "utf-8-sig", ";"),
        ("Poste\tPk [km]\tDescentramiento [cm]\tAltura del sistema [m]", "utf-16", "\t"),
        ("支柱号,里程 [km],拉出值 [mm],结构高度 [m]", "utf-8", ","),
        ("Stolpnr;Längdmätning [m];Sicksack [m];Systemhöjd [m]", "cp1252", ";"),
    ],
)
def test_tables_of_many_countries(
    headings: str, encoding: str, separator: str, tmp_path: Path
) -> None:
    """Headings in five languages, three encodings and separators mean the same line."""
    units = [part.partition("[")[2].rstrip("] ") for part in headings.split(separator)]
    scale = {"m": 1.0, "km": 1e-3, "cm": 100.0, "mm": 1e3, "": 1.0}
    lines = [headings]
    for i in range(5):
        cells = (20000.0 + 60.0 * i, 0.25 * (-1) ** i, 1.6)
        texts = [f"{v * scale[u]:.6g}" for v, u in zip(cells, units[1:], strict=True)]
        joined = separator.join([f"M{i}", *texts])
        lines.append(joined.replace(".", ",") if separator != "," else joined)
    path = table(tmp_path / "masts.csv", "\n".join(lines) + "\n", encoding)
    case = load_case(path)
    assert case.line.span_lengths() == pytest.approx((60.0,) * 4)
    assert case.line.chainage == pytest.approx([20000.0 + 60.0 * i for i in range(5)])
    assert case.supports.contact_staggers(5)[:2] == pytest.approx((0.25, -0.25))
    assert case.supports.encumbrances(5)[0] == pytest.approx(1.6)


def test_positions_that_do_not_begin_at_zero_are_chainage(tmp_path: Path) -> None:
    """A table whose x begins at 12.300 km keeps it as chainage, named in the case and alone."""
    masts = table(tmp_path / "m.csv", "support;x [km];encumbrance [m]\n1;12,3;1,4\n2;12,355;1,4\n")
    (tmp_path / "line.yaml").write_text(
        "schema: 1\ninclude: ac-simple\ntables: {supports: m.csv}\n", encoding="utf-8"
    )
    for path in (masts, tmp_path / "line.yaml"):
        line = load_case(path).line
        assert line.chainage == pytest.approx((12300.0, 12355.0))
        assert line.span_lengths() == pytest.approx((55.0,))
        assert line.place_of_support(1) == "km 12.355"


def test_falling_chainage_keeps_sides(tmp_path: Path) -> None:
    """Rows with falling chainage keep their order; staggers keep their side of rising chainage."""
    text = "Mast,Chainage [m],Stagger [m]\nA,500,0.2\nB,440,-0.2\nC,385,0.1\nD,330,0\n"
    case = load_case(table(tmp_path / "down.csv", text))
    assert case.line.span_lengths() == (60.0, 55.0, 55.0)
    assert case.line.masts == ("A", "B", "C", "D")
    assert case.supports.contact_staggers(4)[:3] == (-0.2, 0.2, -0.1)


def test_lengths_and_masts_in_a_dropper_table(tmp_path: Path) -> None:
    """Dropper lengths are held; the mast on the left says the span, once for its droppers."""
    droppers: list[list[Any]] = [["Mast", "Dropper", "Distance from support [m]", "Length [mm]"]]
    for i, span in enumerate(SPANS):
        droppers += [
            [f"4/{8 + i}" if k == 0 else None, k + 1, span * (k + 1) / 4, 900] for k in range(3)
        ]
    path = workbook(tmp_path / "v.xlsx", Masts=SUPPORTS, Droppers=droppers, Wires=WIRES)
    case = load_case(path)
    assert droppers_of(case).mode == "length"
    assert droppers_of(case).lengths_by_span(8)[7] == (0.9, 0.9, 0.9)
    assert droppers_of(case).positions_by_span(8)[1] == (14.5, 29.0, 43.5)


def test_presag_in_per_mille(tmp_path: Path) -> None:
    """A pre-sag in per mille is that share of its own span: 0.5 of 60 m is 30 mm."""
    masts = "Mast;Portée [m]\nA;60\nB;50\nC;60\nD;\n"
    assert load_case(table(tmp_path / "m.csv", masts)).line.span_lengths() == (60.0, 50.0, 60.0)
    rows: list[list[Any]] = [["Span no", "Position [m]", "Flecha [‰]"]]
    rows += [[s, x, "0,5"] for s in (1, 2, 3) for x in (10, 25, 40)]
    spans: list[list[Any]] = [["Mast", "Span [m]"], ["A", 60], ["B", 50], ["C", 60], ["D", None]]
    case = load_case(workbook(tmp_path / "w.xlsx", Masts=spans, Droppers=rows))
    presag = [row[0] for row in droppers_of(case).presag_by_span(3)]
    assert presag == pytest.approx([0.030, 0.025, 0.030])


def test_every_bad_cell_is_named(tmp_path: Path) -> None:
    """A formula error is named with its cell and never read as empty; other faults with it."""
    rows = [list(row) for row in SUPPORTS]
    rows[4][2], rows[5][3], rows[6][1] = "#DIV/0!", "high", None
    with pytest.raises(InputError) as caught:
        load_case(workbook(tmp_path / "bad.xlsx", Masts=rows, Wires=WIRES))
    told = "\n".join(caught.value.problems)
    assert "sheet 'Masts', cell C5 (Stagger [mm]): holds the formula error #DIV/0!" in told
    assert "cell D6 (CW height [m]): got 'high'; expected a length" in told
    assert "cell B7 (Chainage [km+m]): is empty" in told


def test_names_hold_no_control_characters(tmp_path: Path) -> None:
    """A mast whose name turns the direction of the text is refused with its cell."""
    text = "Mast;Chainage [m]\nA;0\n\u202eB;50\n"
    with pytest.raises(InputError, match=r"line 3, column .Mast.: .*control character U\+202E"):
        load_case(table(tmp_path / "t.csv", text))


def test_two_columns_of_one_meaning_are_not_guessed(tmp_path: Path) -> None:
    """Two columns that could be the same are refused by name."""
    text = "Mast;Chainage [m];Station [m]\nA;0;0\nB;60;60\n"
    (sheet,) = open_sheets(table(tmp_path / "t.csv", text))
    with pytest.raises(InputError, match=r"'Chainage \[m\]' and 'Station \[m\]' could both be"):
        propose(sheet)


def test_table_without_supports_is_refused(tmp_path: Path) -> None:
    """A file with no table of supports says what is needed."""
    with pytest.raises(InputError, match="one row per mast with its chainage or span"):
        load_case(workbook(tmp_path / "w.xlsx", Wires=WIRES))


def test_mapping_is_kept_and_used(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The command writes the proposed mapping; a changed one decides how the file is read."""
    path = workbook(tmp_path / "valley.xlsx", Masts=SUPPORTS, Wires=WIRES)
    assert run_command_line(["check", str(path)]) == 0
    out = capsys.readouterr().out
    assert "Stagger [mm]" in out
    assert "kept aside" in out
    mapping = tmp_path / "valley.mapping.yaml"
    text = mapping.read_text(encoding="utf-8")
    assert '"Remark": aside' in text
    assert load_case(path).supports.contact_staggers(9)[0] == 0.2
    mapping.write_text(text.replace("positive: left", "positive: right"), encoding="utf-8")
    assert load_case(path).supports.contact_staggers(9)[0] == -0.2
    mapping.write_text(text.replace("Stagger [mm]", "Zigzag"), encoding="utf-8")
    with pytest.raises(InputError, match="there is no column 'Zigzag'"):
        load_case(path)


def test_lone_far_cell_costs_nothing(tmp_path: Path) -> None:
    """A cell in the last column and row of a sheet is not read and does no harm."""
    path = workbook(tmp_path / "far.xlsx", Masts=SUPPORTS, Wires=WIRES)
    book = openpyxl.load_workbook(path)
    book["Masts"]["XFD1048576"] = 1
    book.save(path)
    assert load_case(path).line.spans == len(SPANS)


@pytest.mark.parametrize(
    ("cell", "unit", "wanted", "value"),
    [
        ("12+300", "km+m", "m", 12300.0),
        ("12+3.5", "", "m", 12003.5),
        ("1.234,5", "", "m", 1234.5),
        ("5,3 m", "", "m", 5.3),
        (200, "mm", "m", 0.2),
        ("1575", "kg", "N", 1575 * 9.80665),
        ("-", "m", "m", None),
        (None, "m", "m", None),
        (3.0, "", "#", 3.0),
    ],
)
def test_values_as_written(cell: Any, unit: str, wanted: str, value: float | None) -> None:
    """Decimal commas, km+m, units in the cell, kg as a force, dashes for nothing."""
    found = number_of(cell, unit, wanted, decimal_comma=True)
    assert found == (None if value is None else pytest.approx(value))


def test_values_that_are_none() -> None:
    """What is no number is refused with what was got and expected."""
    with pytest.raises(CellError, match="got 'left'; expected a length"):
        number_of("left", "m", "m", decimal_comma=False)
    with pytest.raises(CellError, match="#REF!"):
        number_of("#REF!", "m", "m", decimal_comma=False)


@pytest.mark.parametrize(
    ("name", "role"),
    [("Fil de contact", "contact"), ("CÂBLE PORTEUR", "messenger"), ("承力索", "messenger")],
)
def test_wires_by_their_role(name: str, role: str) -> None:
    """Wires are known by what they are called in a table, whatever case and accents."""
    assert role_of(name) == role


@pytest.mark.parametrize(
    ("word", "key"),
    [
        ("Stützpunkt", "line.masts"),
        ("N° poteau", "line.masts"),
        ("Längsspannweite", "line.span_length"),
        ("Stationing", "line.chainage"),
        ("Systemhøyde", "supports.encumbrance"),
        ("Effort", "wires.contact.tension"),
        ("Tensile force", "wires.contact.tension"),
        ("Hängerlänge", "droppers.lengths"),
    ],
)
def test_headings_explain_unknown_keys(word: str, key: str) -> None:
    """What heads a column of a table explains the unknown key of a case too."""
    assert meaning_of(word) == Meaning(key=key)
    headings = {
        heading for kind in KINDS for field in fields_of(kind) for heading in field.headings
    }
    assert folded(word) in headings


SHARED = [*words_for("line.span_length"), *words_for("supports.encumbrance")]


@pytest.mark.parametrize("word", SHARED)
def test_words_of_keys_head_columns(word: str, tmp_path: Path) -> None:
    """Every word that explains an unknown key of the supports heads their column as well."""
    path = table(tmp_path / "t.csv", f"Mast;Chainage;{word}\nA;0;50\nB;50;50\n")
    mapping = propose(open_sheets(path)[0])
    assert mapping is not None
    assert not mapping.aside


LENGTHS = """name;from mast;to mast;left;right;mid-point anchor
T1;1;12;weighted;weighted;6
T2;9;20;weighted;weighted;15
"""
OVERLAPS = "kind;separation [mm];rise [mm];anchor rise\nthree-span;400;350;1.0\n"
OVERLAPPING = """schema: 2
include: ac-simple
name: mine
line: {spans: 19}
supports: {closure: height}
tables: {tension_lengths: lengths.csv, overlaps: overlaps.csv}
"""


def test_tension_lengths_and_overlaps(tmp_path: Path) -> None:
    """Two tables say what the library case with an overlap says; a cell without mast is named."""
    path = tmp_path / "mine.yaml"
    path.write_text(OVERLAPPING, encoding="utf-8")
    (tmp_path / "lengths.csv").write_text(LENGTHS, encoding="utf-8")
    (tmp_path / "overlaps.csv").write_text(OVERLAPS, encoding="utf-8")
    case, known = load_case(path), load_case("ac-simple-overlap")
    assert case.tension_lengths == known.tension_lengths
    assert case.overlaps == known.overlaps
    (tmp_path / "lengths.csv").write_text(LENGTHS.replace("T2;9;", "T2;B9;"), encoding="utf-8")
    with pytest.raises(InputError, match="line 3, column 'from mast': got 'B9'; the masts have no"):
        load_case(path)
    named = "line: {spans: 19, masts: [" + ", ".join(f"M{n}" for n in range(1, 21)) + "]}"
    path.write_text(OVERLAPPING.replace("line: {spans: 19}", named), encoding="utf-8")
    with pytest.raises(InputError, match=r"B9"):
        load_case(path)


FIXED = "name;from mast;to mast;left;right;fixed point\nT1;{};{};weighted;weighted;{}\n"
EVEN = "Mast;Chainage [m]\n" + "".join(f"{2 * n};{55 * n}\n" for n in range(1, 7))


def lengths_of(folder: Path, masts: str, *cells: str) -> Path:
    """Write a case with a table of supports and one of a single tension length."""
    (folder / "masts.csv").write_text(masts, encoding="utf-8")
    (folder / "lengths.csv").write_text(FIXED.format(*cells), encoding="utf-8")
    path = folder / "case.yaml"
    path.write_text(
        "schema: 2\ninclude: ac-simple\nname: a\nsupports: {closure: height}\n"
        "tables: {supports: masts.csv, tension_lengths: lengths.csv}\n", encoding="utf-8",
    )  # fmt: skip
    return path


def test_numbers_that_are_names_of_masts_mean_masts(tmp_path: Path) -> None:
    """Where masts have numbers for names, a number is the mast of that name."""
    case = load_case(lengths_of(tmp_path, EVEN, "2", "12", "6"))
    (found,) = case.tension_lengths
    assert (found.masts, found.fixed_point) == ((1, 6), 3)


@pytest.mark.parametrize(
    ("masts", "cells", "words"),
    [
        (EVEN, ("2", "12", "5"), r"line 2, column 'fixed point': got '5', which no mast is called"),
        (EVEN, ("2", "9", "6"), r"line 2, column 'to mast': got '9', which .* there are: 2, 4, 6"),
        (EVEN, ("2", "1Z", "6"), r"got '1Z', which no mast is called; did you mean '12'"),
        (
            EVEN.replace("8;", "4;"),
            ("2", "12", "4"),
            "got '4', a name that 2 supports have; rename",
        ),
        ("Mast;Chainage [m]\nA;0\nB;55\nC;110\n", ("A", "4", "B"), "has the supports 1 to 3"),
        ("Mast;Chainage [m]\nA;0\nB;55\nC;110\n", ("A", "0", "B"), "has the supports 1 to 3"),
    ],
    ids=range(6),
)
def test_unknown_masts_are_named_at_their_cell(
    masts: str, cells: tuple[str, ...], words: str, tmp_path: Path
) -> None:
    """No number is taken for that of a support where masts are called by numbers, and none leads
    beyond the line; a name of two masts is no place."""
    with pytest.raises(InputError, match=words):
        load_case(lengths_of(tmp_path, masts, *cells))


def test_spacing_is_no_position(tmp_path: Path) -> None:
    """A distance from dropper to dropper is not read as a position along the span."""
    assert meaning_of("spacing") == Meaning(key="droppers.positions")
    path = table(tmp_path / "t.csv", "Span no;Position [m];Spacing [m]\n1;5;5\n1;10;5\n")
    mapping = propose(open_sheets(path)[0])
    assert mapping is not None
    assert mapping.aside == ("Spacing [m]",)


US_LINE = """
schema: 2
name: us-line
include: ac-simple
line: {span_length: 180 ft}
wires:
  contact: {tension: 4950 lbf, mass: 0.907 lb/ft}
scenario: {speed: 150 mph}
"""


def test_line_in_units_of_us_practice(tmp_path: Path) -> None:
    """Feet, inches, pounds and miles: a case and a table of masts, units in a row of their own."""
    case = load_case(table(tmp_path / "us.yaml", US_LINE))
    assert case.line.span_lengths()[0] == pytest.approx(54.864)
    assert case.wires.contact.tension == pytest.approx(22018.7, abs=0.1)
    assert case.wires.contact.mass == pytest.approx(1.34977, abs=1e-5)
    assert case.scenario.speed == pytest.approx(67.056)
    masts: list[list[Any]] = [["Pole", "Span", "Stagger", "System depth"], ["-", "ft", "in", "ft"],
                              *([f"E{i}", 180, 8 * (-1) ** i, 4] for i in range(5)),
                              ["E5", None, -8, 4]]  # fmt: skip
    wires: list[list[Any]] = [["Wire", "Mass [lb/ft]", "Tension [lb]"],
                              ["Trolley wire", 0.907, 4950], ["Messenger", 0.71, 3600]]  # fmt: skip
    read = load_case(workbook(tmp_path / "us.xlsx", Poles=masts, Wires=wires))
    assert read.line.span_lengths() == pytest.approx((54.864,) * 5)
    assert read.line.masts == ("E0", "E1", "E2", "E3", "E4", "E5")
    assert read.supports.contact_staggers(6)[:2] == pytest.approx((0.2032, -0.2032))
    assert read.supports.encumbrances(6)[0] == pytest.approx(1.2192)
    assert read.wires.contact.mass == case.wires.contact.mass
    assert read.wires.contact.tension == case.wires.contact.tension
    with pytest.raises(InputError, match=r"unknown key; it is given as line\.span_length"):
        load_case(table(tmp_path / "bad.yaml", US_LINE + "bay: 180 ft\n"))


def test_survey_of_a_mast_whose_name_stands_twice(tmp_path: Path) -> None:
    """A reading at a name that two masts have is not given to the first of them."""
    names = ["M1", "M2", "M2", "M4"]
    case = load_case("ac-simple", {"line.spans": 3, "line.masts": names})
    path = table(tmp_path / "s.csv", "Mast;Contact height [m]\nM4;5.3\nM2;5.3\n")
    with pytest.raises(InputError, match="mast M2, as 2 supports are called; give the number"):
        load_survey(path, case)
    path = table(tmp_path / "s.csv", "Support;Contact height [m]\n4;5.3\n2;5.3\n")
    assert [one.support for one in load_survey(path, case).readings] == [4, 2]
