"""Tables of droppers with one row per span: lengths, pre-sags and positions in numbered columns."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import openpyxl
import pytest

from tautwire.cli.app import run_command_line
from tautwire.errors import InputError
from tautwire.inputs.load import load_case

from ..lines import droppers_of

SPANS = (60.0, 45.0, 55.0)
POSITIONS = ((5.0, 20.0, 40.0, 55.0), (5.0, 22.5, 40.0), (5.0, 27.5, 50.0))
LENGTHS = ((1.21, 0.94, 0.95, 1.22), (1.25, 1.07, 1.24), (1.23, 1.01, 1.22))
MOST = 4


def line(path: Path, rows: list[list[Any]], sheet: str = "Droppers") -> Path:
    """Write a workbook of a line with a table of droppers."""
    book = openpyxl.Workbook()
    masts = book.active
    assert masts is not None
    masts.title = "Masts"
    along = [300.0 + sum(SPANS[:i]) for i in range(len(SPANS) + 1)]
    for row in [["Mast", "Chainage [m]"], *([f"M{i + 1}", x] for i, x in enumerate(along))]:
        masts.append(row)
    droppers = book.create_sheet(sheet)
    for row in rows:
        droppers.append(row)
    book.save(path)
    return path


def in_pairs(scale: float = 1.0) -> list[list[Any]]:
    """Return the rows with position and length of every dropper side by side."""
    rows: list[list[Any]] = []
    for number, (places, lengths) in enumerate(zip(POSITIONS, LENGTHS, strict=True), 1):
        cells = [value for pair in zip(places, lengths, strict=True) for value in pair]
        rows.append([number, *(v * (scale if i % 2 else 1.0) for i, v in enumerate(cells))])
    return rows


def in_blocks() -> list[list[Any]]:
    """Return the rows with all positions before all lengths."""

    def block(values: tuple[float, ...]) -> list[float | None]:
        return [*values, *(None for _ in range(MOST - len(values)))]

    rows = zip(POSITIONS, LENGTHS, strict=True)
    return [[f"M{i}", *block(row[0]), *block(row[1])] for i, row in enumerate(rows, 1)]


def numbered(*words: str) -> list[str]:
    return [word.replace("#", str(n)) for n in range(1, MOST + 1) for word in words]


@pytest.mark.parametrize(
    ("headings", "scale"),
    [
        ([["Span", *numbered("x#", "l#")]], 1.0),
        ([["Span no", *numbered("x# [m]", "L# [mm]")]], 1e3),
        ([["Feld", *numbered("Lage #", "Hänger # Länge [mm]")]], 1e3),
        ([["Feld Nr.", *numbered("Abstand # [m]", "Hängerlänge # [m]")]], 1.0),
        ([["Nº vano", *numbered("Posición #", "Longitud péndola # [mm]")]], 1e3),
        ([["N° portée", *numbered("Abscisse pendule #", "Longueur pendule # (mm)")]], 1e3),
        ([["Campata", *numbered("Distanza pendino #", "Lunghezza pendino # [cm]")]], 1e2),
        ([["Span", *numbered("D#", "")], [None, *("x [m]", "length [mm]") * MOST]], 1e3),
        ([["Span", *numbered("x#", "D#")], [None, *("m", "mm") * MOST]], 1e3),
    ],
    ids=range(9),
)
def test_pairs_of_columns(headings: list[list[str]], scale: float, tmp_path: Path) -> None:
    """Position and length of every dropper, in the words of five languages and in two rows of
    headings; spans with fewer droppers leave their last cells empty."""
    found = droppers_of(load_case(line(tmp_path / "a.xlsx", [*headings, *in_pairs(scale)])))
    assert found.positions_by_span(3) == POSITIONS
    assert found.mode == "length"
    lengths = found.lengths_by_span(3)
    assert lengths is not None
    assert all(own == pytest.approx(said) for own, said in zip(lengths, LENGTHS, strict=True))


@pytest.mark.parametrize(("before", "behind"), [("x#", "D#"), ("Pos #", "l#"), ("D#", "l#")])
def test_blocks_of_columns(before: str, behind: str, tmp_path: Path) -> None:
    """All positions, then all lengths; columns that are only called droppers are the lengths beside
    positions, and the positions beside lengths; the mast on the left names the span."""
    headings = ["Mast", *numbered(before), *numbered(behind)]
    found = droppers_of(load_case(line(tmp_path / "a.xlsx", [headings, *in_blocks()])))
    assert found.positions_by_span(3) == POSITIONS
    assert found.lengths_by_span(3) == LENGTHS


def test_positions_alone_and_presag(tmp_path: Path) -> None:
    """Columns that rise along every span are positions; a pre-sag may be in per mille."""
    rows = [["Span", *numbered("D#")], *([i + 1, *row] for i, row in enumerate(POSITIONS))]
    found = droppers_of(load_case(line(tmp_path / "a.xlsx", rows)))
    assert (found.positions_by_span(3), found.mode) == (POSITIONS, "height")
    headings = ["Span", *numbered("x#", "Durchhang # [‰]")]
    found = droppers_of(load_case(line(tmp_path / "b.xlsx", [headings, *in_pairs()])))
    assert found.presag is not None
    assert found.presag[1] == pytest.approx([45e-3 * v for v in LENGTHS[1]])


def test_mapping_is_shown_kept_and_used(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Every column is shown with its dropper; a mapping file that says otherwise is believed."""
    book = line(tmp_path / "a.xlsx", [["Span", *numbered("x#", "D#")], *in_pairs()])
    assert run_command_line(["check", str(book)]) == 0
    assert "length of dropper 2" in capsys.readouterr().out
    file = tmp_path / "a.mapping.yaml"
    text = file.read_text(encoding="utf-8")
    assert '"D4": {field: length, dropper: 4}' in text
    file.write_text(text.replace("field: length", "field: unstrained_length"), encoding="utf-8")
    assert droppers_of(load_case(book)).length_kind == "unstrained"


def test_table_that_a_case_names(tmp_path: Path) -> None:
    """The same as CSV beside a case, with decimal commas."""
    text = "Feld;x1;l1;x2;l2\n" + "".join(
        f"{n};5,0;1,2;{span - 5:g};1,2\n" for n, span in enumerate(SPANS, 1)
    )
    (tmp_path / "d.csv").write_text(text, encoding="utf-8")
    case = tmp_path / "case.yaml"
    case.write_text(
        "schema: 2\ninclude: ac-simple\nname: a\nline: {spans: 3, span_length: [60, 45, 55]}\n"
        "tables: {droppers: d.csv}\n",
        encoding="utf-8",
    )
    found = droppers_of(load_case(case))
    assert found.positions_by_span(3) == ((5.0, 55.0), (5.0, 40.0), (5.0, 50.0))


def problem(tmp_path: Path, rows: list[list[Any]], sheet: str = "Droppers") -> str:
    with pytest.raises(InputError) as caught:
        load_case(line(tmp_path / "bad.xlsx", rows, sheet))
    return "\n".join(caught.value.problems)


PAIRS = [["Span", *numbered("x#", "l#")], *in_pairs()]


def changed(row: int, column: int, value: Any) -> list[list[Any]]:
    rows = [list(cells) for cells in PAIRS]
    rows[row][column] = value
    return rows


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (
            [["Span", *numbered("D#")], *([n, 1.2, 0.9, 1.2] for n in (1, 2, 3))],
            "D1, D2, D3, D4 do not tell where the droppers hang; add columns 'x1', 'x2'",
        ),
        (
            [row[:5] + row[6:] for row in PAIRS],
            "no column with the position of dropper 3; there are 'x1', 'x2', 'x4'",
        ),
        (changed(1, 4, None), "cell E2 (l2)) is empty; fill the column or leave all"),
        (changed(2, 3, None), "cell D3 (x2)) is empty; fill the column or leave all"),
        (changed(3, 1, "five"), "cell B4 (x1)) got 'five'; expected a length [m]"),
        (changed(2, 0, 1), "cell A3 (Span)) span 1 has a row above; one row per span is read"),
        (changed(3, 0, 4), "got 4; the line has 3 spans"),
        (changed(1, 5, 19.0), "cell F2 (x3); dropper 3 of span 1, x = 19 m): got 19 m, less than"),
        ([["No", *PAIRS[0][1:]], *PAIRS[1:]], "neither a span number nor a mast"),
        (
            [["Span", *numbered("x#", "l#"), "x2"], *([*row, 3] for row in in_pairs())],
            "the columns 'x2' and 'x2' could both be position; rename one",
        ),
        (
            [["Span", *numbered("x#")], *([n, 5, 10, 11, 12] for n in (1, 2, 3))],
            "cell E2 (x4)) got 12 m for the last dropper of a span of 60 m; positions count from",
        ),
    ],
    ids=range(11),
)
def test_bad_tables_are_refused(rows: list[list[Any]], words: str, tmp_path: Path) -> None:
    """What is wrong is named with its cell and what to do."""
    told = problem(tmp_path, rows)
    assert words.replace(")) ", "): ") in told
    assert "bad.xlsx, sheet 'Droppers'" in told


def with_columns(word: str, value: float) -> list[list[Any]]:
    """Return rows with positions and three more columns that hold one value."""
    rows = [[n, *(v for x in (5, 20, 40) for v in (x, value))] for n in (1, 2, 3)]
    return [["Span", *numbered("x#", word)[:6]], *rows]


@pytest.mark.parametrize(
    ("word", "value", "words"),
    [
        ("H#", 5.3, "'H1', 'H2', 'H3' may hold lengths of droppers or something else"),
        ("H#", 1.2, "'H1', 'H2', 'H3' may hold lengths of droppers or something else"),
        ("H# [m]", 5.3, "would be lengths of droppers by their names, but hold 5.3 m"),
        ("D#", 10.0, "'D1', 'D2', 'D3' would be lengths of droppers by their names"),
        ("l#", 1210.0, "but hold 1210 m, and lengths of droppers lie within 0.05 and 3 m"),
        ("Hänger #", 5.3, "would be lengths of droppers by their names"),
        ("F#", 90.0, "'F1', 'F2', 'F3' may hold pre-sags or something else"),
        ("F#", 0.09, "'F1', 'F2', 'F3' may hold pre-sags or something else"),
        ("F# [m]", 0.9, "would be pre-sags by their names, but hold 0.9 m"),
        ("Dropper # F", 0.09, "may hold pre-sags or something else"),
        ("P#", 0.12, "'P1', 'P2', 'P3' may hold lengths of droppers or something else"),
    ],
)
def test_columns_of_several_meanings_are_refused(
    word: str, value: float, words: str, tmp_path: Path
) -> None:
    """A height of the contact wire is no dropper length and a force no pre-sag: letters that mean
    either need a unit of length and values of that kind, and the columns are named."""
    told = problem(tmp_path, with_columns(word, value))
    assert words in told
    assert "are left aside" in told


@pytest.mark.parametrize(
    ("word", "value", "mode"),
    [("H# [mm]", 1200.0, "length"), ("H# [m]", 1.2, "length"), ("length # [mm]", 1200.0, "length"),
     ("unstrained length # [mm]", 1200.0, "length"), ("F# [mm]", 20.0, "height"),
     ("pre-sag # [mm]", 20.0, "height"), ("contact height #", 5.3, "height"),
     ("dropper force #", 90.0, "height"), ("F# [N]", 90.0, "height"), ("F# [kN]", 0.09, "height")],
)  # fmt: skip
def test_unit_or_word_decides_what_columns_hold(
    word: str, value: float, mode: str, tmp_path: Path
) -> None:
    """With a unit or a word of its own a column is read; what is named otherwise is left aside."""
    found = droppers_of(load_case(line(tmp_path / "a.xlsx", with_columns(word, value))))
    assert found.mode == mode
    if mode == "length":
        assert found.lengths_by_span(3) == ((1.2,) * 3,) * 3
    elif "[mm]" in word:
        assert found.presag_by_span(3) == ((0.02,) * 3,) * 3


def test_numbered_columns_beside_single_droppers_stay_aside(tmp_path: Path) -> None:
    """In a table with one row per dropper, numbered columns do not make several of each row."""
    heads = ["Span", "Position [m]", "Length [m]", "D1", "D2"]
    rows = [[n, x, 1.2, 1.0, 1.1] for n in (1, 2, 3) for x in (5.0, 40.0)]
    found = droppers_of(load_case(line(tmp_path / "a.xlsx", [heads, *rows])))
    assert found.positions_by_span(3) == ((5.0, 40.0),) * 3
    both = [[*heads[:3], "x1", "x2"], *rows]
    assert "'Position [m]' has the position of one dropper per row" in problem(tmp_path, both)


BESIDE = (
    "schema: 2\ninclude: ac-simple\nname: a\ndroppers: {presag: [0, 0]}\n"
    "tables: {droppers: d.csv}\n"
)
FROM_ONE_TO_THE_NEXT = "Span,x1,x2,x3,l1,l2,l3\n" + "".join(
    f"{n},5,10,11,1.2,1,1.2\n" for n in (1, 2, 3)
)


@pytest.mark.parametrize(
    "spans",
    ["line: {spans: 3, span_length: 60}\n", "line: {span_length: [60 m, 60, 60]}\n",
     "line: {spans: 3}\n"],
)  # fmt: skip
def test_positions_are_checked_against_the_spans_of_the_case(spans: str, tmp_path: Path) -> None:
    """Distances from one dropper to the next are told where only the case, what it includes, or
    what includes it says how long the spans are."""
    (tmp_path / "d.csv").write_text(FROM_ONE_TO_THE_NEXT, encoding="utf-8")
    (tmp_path / "case.yaml").write_text(BESIDE + spans, encoding="utf-8")
    with pytest.raises(InputError, match="positions count from the mast on the left"):
        load_case(tmp_path / "case.yaml")
    (tmp_path / "case.yaml").write_text(BESIDE, encoding="utf-8")
    (tmp_path / "outer.yaml").write_text(
        f"schema: 2\ninclude: case.yaml\nname: b\n{spans}", encoding="utf-8"
    )
    with pytest.raises(InputError, match="positions count from the mast on the left"):
        load_case(tmp_path / "outer.yaml")


def test_shares_of_the_spans_of_the_case(tmp_path: Path) -> None:
    """A pre-sag in per mille is a share of the span that the case has; masts are found by the names
    that it gives."""
    rows = "".join(f"{mast},5,0.5\n{mast},50,0.5\n" for mast in "ABC")
    (tmp_path / "d.csv").write_text("Mast,Position [m],Pre-sag [‰]\n" + rows, encoding="utf-8")
    text = BESIDE.replace("droppers: {presag: [0, 0]}\n", "")
    text += "line: {spans: 3, span_length: [60, 55, 60], masts: [A, B, C, D]}\n"
    (tmp_path / "case.yaml").write_text(text, encoding="utf-8")
    found = droppers_of(load_case(tmp_path / "case.yaml")).presag_by_span(3)
    assert found[1] == pytest.approx((0.0275, 0.0275))


def test_unnamed_sheet_without_positions_is_refused_too(tmp_path: Path) -> None:
    """A sheet of another name with lengths by dropper is not left aside in silence."""
    rows = [["Feld", *numbered("l#")], *([n, 1.2, 0.9, 0.9, 1.2] for n in (1, 2, 3))]
    assert "do not tell where the droppers hang" in problem(tmp_path, rows, "Blatt 2")


def test_numbered_columns_of_supports_stay_aside(tmp_path: Path) -> None:
    """Numbered columns beside those of a table of supports make no table of droppers of it."""
    path = tmp_path / "masts.csv"
    path.write_text(
        "Mast;Chainage [m];Stagger [m];D1;D2;D3\nA;300;0.2;5;20;55\nB;360;-0.2;5;20;55\n"
        "C;420;0.2;5;20;55\n", encoding="utf-8",
    )  # fmt: skip
    assert load_case(path).line.span_lengths() == (60.0, 60.0)
