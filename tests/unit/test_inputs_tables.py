"""CSV tables of supports, droppers, profiles, roof motion and measured runs."""

from __future__ import annotations

from pathlib import Path

import openpyxl
import pytest

from tautwire.errors import InputError
from tautwire.inputs.load import load_case
from tautwire.inputs.reading.grouping import SHOWN
from tautwire.specs import Case
from tautwire.specs.line.dropper import Droppers

SUPPORTS = """\
# as built
support, x [m], contact_height [m], encumbrance [mm], contact_stagger [mm]
1,0,5.30,1200,200
2,60,5.31,1250,-200
3,115,5.32,1200,
4,175,5.30,1200,200
"""
DROPPERS = """\
span;dropper;position;presag [mm]
1;1;5;0
1;2;25;12,5
1;3;45;0

2;1;5,5;0
2;2;49,5;0
3;1;30;-5
"""
HEAD = "schema: 1\ninclude: ac-simple\nname: mine\n"
SEPARATE = ("roof", "profile")
"""Tables that are named where their values stand."""


def load_with(folder: Path, text: str = "", **tables: str) -> Case:
    """Load a case file beside its tables."""
    for name, content in tables.items():
        (folder / f"{name}.csv").write_text(content, encoding="utf-8")
    listed = "".join(f"  {name}: {name}.csv\n" for name in tables if name not in SEPARATE)
    path = folder / "mine.yaml"
    path.write_text(f"{HEAD}{'tables:' if listed else ''}\n{listed}{text}", encoding="utf-8")
    return load_case(path)


def problems_of(folder: Path, text: str = "", **tables: str) -> str:
    """Return what is said about a case with tables."""
    with pytest.raises(InputError) as caught:
        load_with(folder, text, **tables)
    return str(caught.value)


def good_supports() -> str:
    """Return the table of supports without its empty cell."""
    return SUPPORTS.replace("1200,\n", "1200,150\n")


def test_tables_describe_a_line(tmp_path: Path) -> None:
    """Spans, heights, staggers and droppers come from the tables, units from their headers."""
    case = load_with(tmp_path, supports=good_supports(), droppers=DROPPERS)
    assert case.line.spans == 3
    assert case.line.span_lengths() == (60.0, 55.0, 60.0)
    assert case.supports.contact_heights(4) == (5.3, 5.31, 5.32, 5.3)
    assert case.supports.encumbrances(4) == (1.2, 1.25, 1.2, 1.2)
    assert case.supports.contact_staggers(4) == (0.2, -0.2, 0.15, 0.2)
    assert case.supports.messenger_staggers(4) == (0.2, -0.2, 0.15, 0.2)
    assert isinstance(case.droppers, Droppers)
    assert case.droppers.positions_by_span(3) == ((5.0, 25.0, 45.0), (5.5, 49.5), (30.0,))
    assert case.droppers.presag_by_span(3) == ((0.0, 0.0125, 0.0), (0.0, 0.0), (-0.005,))


def test_table_is_the_source_of_its_values(tmp_path: Path) -> None:
    """The report can say which file a number came from."""
    case = load_with(tmp_path, supports=good_supports())
    sources = {source.path: source.source for source in case.sources}
    assert sources["supports.contact_stagger"] == "Table supports.csv"
    assert sources["line.span_length"] == "Table supports.csv"


def test_span_lengths_instead_of_positions(tmp_path: Path) -> None:
    """A support may carry the length of the span it begins; the last one begins none."""
    table = "support\tspan_length\n1\t55\n2\t60,5\n3\t\n"
    assert load_with(tmp_path, supports=table).line.span_lengths() == (55.0, 60.5)


def test_lengths_and_presag_in_one_table(tmp_path: Path) -> None:
    """A dropper table may hold both; the mode says which is used."""
    table = "span,dropper,position,presag,length\n1,1,20,0.01,1.1\n"
    text = "line: {spans: 1}\ndroppers: {mode: length}\n"
    case = load_with(tmp_path, text, droppers=table)
    assert isinstance(case.droppers, Droppers)
    assert case.droppers.lengths_by_span(1) == ((1.1,),)
    assert case.droppers.presag_by_span(1) == ((0.01,),)


def test_arm_ends(tmp_path: Path) -> None:
    """The far ends of the arms are given per support, empty at the anchors."""
    table = "support,x,arm_end_y,arm_end_z\n1,0,,\n2,55,1.0,5.5\n3,110,,\n"
    case = load_with(tmp_path, "supports: {closure: arm}\n", supports=table)
    assert case.supports.arm_end_y == (None, 1.0, None)
    assert case.supports.arm_end_z == (None, 5.5, None)


def test_supports_without_positions(tmp_path: Path) -> None:
    """A table without positions sets the number of spans; their length stays."""
    table = "support,contact_height\n1,5.3\n2,5.4\n3,5.3\n"
    case = load_with(tmp_path, supports=table)
    assert case.line.span_lengths() == (55.0, 55.0)


def test_empty_optional_column_is_left_out(tmp_path: Path) -> None:
    """A column without any value says nothing; what was included stays."""
    table = "support,x,encumbrance\n1,0,\n2,55,\n"
    assert load_with(tmp_path, supports=table).supports.encumbrance == 1.2


def test_byte_order_mark_and_line_ends(tmp_path: Path) -> None:
    """Files as spreadsheets write them, with byte order mark and CRLF, are read."""
    table = "\ufeff" + good_supports().replace("\n", "\r\n")
    assert load_with(tmp_path, supports=table).line.spans == 3


def test_number_of_spans_may_agree(tmp_path: Path) -> None:
    """The number of spans may be given beside the table when it is the same."""
    case = load_with(tmp_path, "line: {spans: 3}\n", supports=good_supports())
    assert case.line.spans == 3


@pytest.mark.parametrize(
    ("table", "words"),
    [
        (SUPPORTS, "supports.csv, line 5, column 'contact_stagger [mm]': is empty; fill the"),
        ("support\n1\n2\n", "or 'contact_height' is missing; there are: support"),
        ("support,contact_hight\n1,2\n", "column 'contact_hight'; did you mean 'contact_height'?"),
        ("support,zzz\n1,2\n", "is missing; there are: support, zzz"),
        ("support,x,x\n1,2,3\n", "the columns 'x' and 'x' could both be x; rename one"),
        ("support,x [s]\n1,2\n", "column 'x [s]': the unit does not fit; expected a length [m]"),
        ("support,x [foo]\n1,2\n", "column 'x [foo]': the unit does not fit; expected a length"),
        ("support [m],x\n1,2\n", "column 'support [m]': takes no unit"),
        ("support,x\n", "has a header but no rows"),
        ("# nothing\n", "has no rows; a table has a row of headings, and below it"),
        ("  \n", "is empty; a table has a header row and one row per item"),
        ("support,x\n1,0\n", "has 1 support; a line has at least two"),
        ("support,x\n1,0\n3,50\n", "line 3, column 'support': got 3, expected 2; number them"),
        ("support,x\n1,0\n2,a\n", "line 3, column 'x': got 'a'; expected a length [m]"),
        ("support,x\n1,0\n2,50 kg\n", "got '50 kg'; expected a length [m]"),
        ("support,x\n1,0\n2,nan\n", "line 3, column 'x': is empty; fill the column"),
        ("support,x\n1,0\n2,1e999\n", "line 3, column 'x': got '1e999'; expected a length"),
        ("support,x\n1,0\n1.5,50\n", "column 'support': got '1.5'; expected a number 1, 2, 3"),
        ("support,x\n1,0\n2,50,7\n", "line 3: has 3 cells for 2 columns; check separators"),
        ("support;x\n1;0\n2;1.23,45\n", "line 3, column 'x': got '1.23,45'"),
        ("support,x\n1,50\n2,50\n", "line 3, column 'x': got 50 m after 50 m; must go on one way"),
        ("support,x,span_length\n1,0,6\n2,5,\n", "got 6 m; the column 'x' says 5 m; keep one"),
        (
            "support,span_length\n1,\n2,\n3,5\n",
            "line 3, column 'span_length': is empty",
        ),
        ("support,x\n1,0\n2," + '"' + "5" * 200_000 + "\n", "is not a table (field larger than"),
    ],
    ids=range(24),
)
def test_bad_support_table(table: str, words: str, tmp_path: Path) -> None:
    """A message names file, line and column."""
    told = problems_of(tmp_path, supports=table)
    assert words in told
    assert "supports.csv" in told


@pytest.mark.parametrize(
    ("table", "words"),
    [
        (
            "span,dropper,position\n1,1,5\n",
            "has 9 values for 1 droppers",
        ),
        ("span,dropper,position,presag\n1,1,,0\n", "the column 'position' is empty"),
        (
            "span,dropper,position,presag\n1,1,5,0\n1,2,,0\n",
            "line 3, column 'position': is empty",
        ),
        (
            "span,dropper,position,presag\n1,1,5,0\n3,1,5,0\n",
            "droppers.csv, line 3, column 'span': got 3; the line has 1 span",
        ),
        (
            "span,dropper,position,presag\n1,1,5,0\n1,3,9,0\n",
            "line 3, column 'dropper': got 3, expected 2; number them in order",
        ),
        (
            "span,dropper,position,presag\n1,1,5,24\n",
            "droppers.csv, line 2, column 'presag'; dropper 1 of span 1, x = 5 m): got 24",
        ),
        (
            "span,dropper,position,presag\n1,1,75,0\n",
            "droppers.csv, line 2, column 'position'; dropper 1 of span 1, x = 75 m): got 75 m",
        ),
    ],
    ids=range(7),
)
def test_bad_dropper_table(table: str, words: str, tmp_path: Path) -> None:
    """A message names file, line and column, also for values that only the line refuses."""
    assert words in problems_of(tmp_path, "line: {spans: 1}\n", droppers=table)


def test_number_of_spans_must_agree(tmp_path: Path) -> None:
    """A dropper table for another number of spans is refused."""
    told = problems_of(tmp_path, droppers=DROPPERS)
    assert "droppers.csv: no droppers for the spans 4, 5, 6" in told


def test_value_in_file_and_table(tmp_path: Path) -> None:
    """What is given twice with different values is refused."""
    told = problems_of(tmp_path, "supports: {encumbrance: 1.3}\n", supports=good_supports())
    assert "supports.encumbrance: is given here and in the table" in told


def test_faults_of_both_tables_and_of_the_case(tmp_path: Path) -> None:
    """Faults of tables and of values elsewhere come together, without their consequences."""
    told = problems_of(
        tmp_path,
        "wires: {contact: {tension: 22 kg}}\n",
        supports="support,x\n1,a\n2,b\n",
        droppers="span,dropper,position,presag\n1,1,c,0\n",
    )
    assert len(told.splitlines()) == 4
    assert "wires.contact.tension" in told


def test_long_lists_of_faults_are_cut(tmp_path: Path) -> None:
    """A table full of faults is answered with the first ones and a count."""
    rows = "".join(f"{number},x\n" for number in range(1, 101))
    told = problems_of(tmp_path, supports="support,x\n" + rows)
    assert len(told.splitlines()) == SHOWN
    assert told.endswith("(and 95 more like this)")


def test_huge_table(tmp_path: Path) -> None:
    """A table of 100 MB is refused unread; the message names size and limit."""
    with (tmp_path / "huge.csv").open("wb") as stream:
        stream.truncate(100_000_000)
    told = problems_of(tmp_path, "tables: {supports: huge.csv}\n")
    assert "has 100.0 MB; at most 20 MB are read as a table; split the file" in told


def test_roof_motion(tmp_path: Path) -> None:
    """The motion of the roof may come from a table."""
    text = (
        "pantographs:\n- include: benchmark-2015-pantograph\n  name: front\n"
        "  roof_motion: {table: roof.csv}\n"
    )
    roof = "time [ms];height [mm]\n0;0\n500;-1,5\n"
    motion = load_with(tmp_path, text, roof=roof).pantographs[0].roof_motion
    assert motion is not None
    assert (motion.time, motion.height) == ((0.0, 0.5), (0.0, -0.0015))
    told = problems_of(tmp_path, text, roof="time;height\n0;0\n1;\n")
    assert told.endswith(
        "line 3, column 'height': is empty; fill the column or leave all of it empty"
    )


PROFILE = "irregularities:\n  unevenness:\n  - {kind: profile, table: profile.csv}\n"


def test_profile_of_the_running_surface(tmp_path: Path) -> None:
    """A measured profile may come from a table, with units in its header."""
    table = "# measured\nx [km];height [mm]\n0,1;0\n0,2;-1,5\n0,3;2\n"
    (part,) = load_with(tmp_path, PROFILE, profile=table).irregularities.unevenness
    assert part.kind == "profile"
    assert part.x == pytest.approx((100.0, 200.0, 300.0))
    assert part.height == pytest.approx((0.0, -1.5e-3, 2e-3))


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("x,height\n1,0\n2,\n", "line 3, column 'height': is empty; fill the column"),
        ("x,height [mm]\n1,0\n1,1\n", "line 3, column 'x'): got 1 after 1; must increase"),
        ("x,height\n1,0\n", "irregularities.unevenness[1].x: has 1 values; give at least 2"),
        ("x,height [kg]\n1,0\n", "the unit does not fit; expected a length [m]"),
        ("x,heigth\n1,0\n", "unknown column 'heigth'; did you mean 'height'?"),
        ("x,height [mm]\n1,a\n", "line 2, column 'height [mm]': got 'a'; expected a length"),
        (
            "x,height\n1,0\n2,0.7\n",
            "line 3, column 'height'): got 0.7; must be at most 0.5 m",
        ),
    ],
    ids=range(7),
)
def test_bad_profile(table: str, words: str, tmp_path: Path) -> None:
    """A message names file, line and column of what is wrong with a profile."""
    assert words in problems_of(tmp_path, PROFILE, profile=table)


def test_tables_as_people_own_them(tmp_path: Path) -> None:
    """A case takes tables in another language, encoding and dialect; other columns are aside."""
    supports = "Mastnummer;Kilometrierung [km];Seitenlage [cm];Bemerkung\n"
    supports += "4/1;12,300;20;\n4/2;12,360;-20;Weiche\n4/3;12,415;20;\n"
    (tmp_path / "masts.csv").write_bytes(supports.encode("cp1252"))
    droppers = "von Mast\tHängernr\tposition\tpresag [mm]\n4/1\t1\t30\t5\n4/2\t1\t25,5\t0\n"
    (tmp_path / "hangers.txt").write_bytes(droppers.encode("cp1252"))
    case = load_with(tmp_path, "tables: {supports: masts.csv, droppers: hangers.txt}\n")
    assert case.line.masts == ("4/1", "4/2", "4/3")
    assert case.line.chainage == pytest.approx((12300.0, 12360.0, 12415.0))
    assert case.supports.contact_staggers(3) == pytest.approx((0.2, -0.2, 0.2))
    assert isinstance(case.droppers, Droppers)
    assert case.droppers.positions_by_span(2) == ((30.0,), (25.5,))
    assert case.droppers.presag_by_span(2) == ((0.005,), (0.0,))


def test_column_that_tells_a_side_is_no_wire(tmp_path: Path) -> None:
    """A column "wire" with L and R names no wires of the case and is kept aside."""
    table = "span;dropper;position [m];presag [mm];wire\n1;1;5,25;0;L\n1;2;27,5;0;R\n1;3;50;0;L\n"
    (tmp_path / "d.csv").write_text(table, encoding="utf-8")
    case = load_with(tmp_path, "line: {spans: 1}\ntables: {droppers: d.csv}\n")
    assert isinstance(case.droppers, Droppers)
    assert case.droppers.positions_by_span(1) == ((5.25, 27.5, 50.0),)


def test_workbook_as_a_table(tmp_path: Path) -> None:
    """A sheet of a workbook stands for a table of a case."""
    book = openpyxl.Workbook()
    sheet = book.create_sheet("Droppers")
    for row in (["span", "position [m]", "length [m]"], [1, 20, 1.1], [2, 30, 1.05]):
        sheet.append(row)
    book.save(tmp_path / "line.xlsx")
    case = load_with(tmp_path, "line: {spans: 2}\ntables: {droppers: line.xlsx}\n")
    assert isinstance(case.droppers, Droppers)
    assert case.droppers.mode == "length"
    assert case.droppers.lengths_by_span(2) == ((1.1,), (1.05,))


def test_chainage_that_jumps(tmp_path: Path) -> None:
    """Where chainage jumps, the spans beside it tell how long the line is."""
    table = "support,chainage [m],span_length\n1,1000,60\n2,1060,60\n3,1220,60\n4,1280,\n"
    case = load_with(tmp_path, supports=table)
    assert case.line.span_lengths() == (60.0, 60.0, 60.0)
    assert case.line.chainage == (1000.0, 1060.0, 1220.0, 1280.0)


def test_types_of_supports_in_a_table(tmp_path: Path) -> None:
    """A column tells which type stands at which mast; empty cells are supports as all are."""
    table = "mast;x [m];support type\nA;0;\nB;60;push-off\nC;115;\nD;175;\n"
    text = "supports: {types: [{name: push-off, stop: {gap: 90 mm}}]}\n"
    supports = load_with(tmp_path, text, supports=table).supports
    assert supports.type == (None, "push-off", None, None)
    assert [s.stop.gap if s.stop else None for s in map(supports.at, range(4))] == [
        None, 0.09, None, None
    ]  # fmt: skip
    assert len(supports.kinds()) == 2
