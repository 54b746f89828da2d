"""Sheets: CSV files of any dialect and XLSX workbooks as rows of cells."""

from __future__ import annotations

import csv
import io
import re
import zipfile
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tautwire.errors import InputError

Cell = str | float | None
SUFFIXES = (".csv", ".txt", ".tsv", ".xlsx", ".xlsm")

UNCALCULATED = "#UNCALCULATED"
"""What a cell holds whose formula was never calculated: programs that write workbooks do not."""
MOST_BYTES = 20_000_000
"""Largest file that is read; also the most that a workbook may unpack to, ten times over."""
MOST_ROWS, MOST_COLUMNS = 20_000, 200
"""Rows and columns of a workbook that are read: a lone cell in a far corner costs nothing."""
LONGEST_CELL = 30_000
"""Characters of a cell that is written; a spreadsheet holds 32,767. Longer texts go on in the rows
below."""
MOST_CELLS = 1000
"""Columns of a text; recorders write some hundred channels at most."""
HEADING_ROWS = 40
"""Rows from the top among which the headings are looked for: titles and stamps stand above them."""
_QUOTED = re.compile(r'"[^"]*"')
_ENCODINGS = ("utf-8-sig", "cp1252")
"""Tried in this order; every byte is a letter of the second."""


@dataclass(frozen=True)
class Sheet:
    """A table as it stands.

    Attributes
    ----------
    label : str
        File, and sheet where it has several, in messages.
    name : str
        Name of the sheet; of a CSV file, its stem.
    rows : list of list
        Cells: texts, numbers, None for empty ones.
    numbers : list of int
        Row of the file in which each stands, from 1.
    decimal_comma : bool
        Whether "1,5" is one and a half.
    letters : bool
        Whether columns are named by letters, as in a workbook.
    separator : str
        What separates the cells of a text.
    """

    label: str
    name: str
    rows: list[list[Cell]]
    numbers: list[int] = field(default_factory=list)
    decimal_comma: bool = False
    letters: bool = False
    separator: str = ","

    def place(self, row: int, column: int) -> str:
        """Name a cell as its program does."""
        if self.letters:
            return f"{self.label}, cell {_letters(column)}{self.numbers[row]}"
        return f"{self.label}, line {self.numbers[row]}, column {column + 1}"


def read_sheets(path: Path, content: bytes, most_rows: int = MOST_ROWS) -> list[Sheet]:
    """Read every sheet of a file that holds anything.

    Parameters
    ----------
    path
        Names the file in messages, and by its end tells workbooks from texts.
    content
        All of the file.
    most_rows
        A longer text is refused before its cells are read; of a workbook no more rows are read.

    Raises
    ------
    InputError
        When the file cannot be read as a table.
    """
    if path.suffix.lower() in (".xlsx", ".xlsm"):
        sheets = workbook_sheets(path, content, most_rows)
    else:
        text = decoded(path, content)
        _refuse_long(path, text, most_rows)
        sheets = [text_sheet(path, text, path.stem)]
    filled = [sheet for sheet in sheets if len(sheet.rows) > 1]
    if not filled:
        what = "has a header but no rows" if any(sheet.rows for sheet in sheets) else "has no rows"
        raise InputError(
            f"{path}: {what}; a table has a row of headings, and below it one row per item"
        )
    return filled


def _refuse_long(path: Path, text: str, most_rows: int) -> None:
    """Refuse a text with very many lines, or lines with very many cells, before it is parsed."""
    lines = text.count("\n") - 1
    if lines > most_rows + HEADING_ROWS:
        raise InputError(f"{path}: has {lines:,} rows; at most {most_rows:,} are read")
    longest = max(text.splitlines(), key=len, default="")
    if max(longest.count(separator) for separator in ";\t|,") >= MOST_CELLS:
        raise InputError(f"{path}: has more than {MOST_CELLS} columns")


def text_sheet(path: Path, text: str, name: str) -> Sheet:
    """Read a text as one sheet.

    Raises
    ------
    InputError
        When it is no table.
    """
    separator = _separator(text)
    try:
        if separator == " ":
            rows = [line.split() for line in text.splitlines()]
        else:
            rows = list(csv.reader(io.StringIO(text, newline=""), delimiter=separator))
    except csv.Error as error:
        raise InputError(f"{path}: is not a table ({error})") from None
    numbers_seen = [c for row in rows[1:200] for c in row if _looks(c)]
    comma = separator != "," and not any("." in c for c in numbers_seen)
    kept, numbers = _filled([[cell.strip() or None for cell in row] for row in rows])
    return Sheet(str(path), name, kept, numbers, comma, separator=separator)


def _separator(text: str) -> str:
    """Return what separates the cells: what stands equally often in most of the last lines.

    Titles and stamps above a table hold none or fewer; where cells have decimal commas, these
    stand equally often too, so that commas come last but for blanks.
    """
    lines = [line for line in text.splitlines()[:200] if line.strip() and line[0] != "#"]
    lines = [_QUOTED.sub("", line) for line in lines[len(lines) // 2 :]]
    for separator in ";\t|,":
        counts = Counter(line.count(separator) for line in lines)
        often, times = max(counts.items(), key=lambda item: (item[1], item[0]), default=(0, 0))
        if often and times > 0.7 * len(lines):
            return separator
    fullest = max(";\t|,", key=lambda s: sum(line.count(s) for line in lines))
    if any(fullest in line for line in lines):
        return fullest
    return " " if any(len(line.split()) > 1 for line in lines) else ","


def _looks(cell: str) -> bool:
    """Tell whether a cell is a number written with a point or a comma."""
    return cell.strip().lstrip("+-").replace(".", "", 1).replace(",", "", 1).isdigit()


def decoded(path: Path, content: bytes) -> str:
    """Return the text of a file in UTF-8, UTF-16 or cp1252.

    Raises
    ------
    InputError
        When it is no text.
    """
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return content.decode("utf-16", errors="replace")
    for encoding in _ENCODINGS:
        try:
            text = content.decode(encoding)
        except UnicodeDecodeError:
            continue
        if "\0" not in text:
            return text
    raise InputError(f"{path}: is a binary file; give a CSV file or an .xlsx workbook")


def workbook_sheets(path: Path, content: bytes, most_rows: int) -> list[Sheet]:
    """Read the sheets of a workbook.

    Raises
    ------
    InputError
        When it is none, or openpyxl is missing.
    """
    try:
        import openpyxl
    except ModuleNotFoundError:
        raise InputError(
            f"{path}: workbooks need openpyxl; install it ('pip install openpyxl'), or save the "
            "sheets as CSV"
        ) from None
    _refuse_bomb(path, content)
    try:
        book = openpyxl.load_workbook(io.BytesIO(content), read_only=True, data_only=True)
        formulas = _formulas(content, most_rows)
        sheets = []
        for sheet in book.worksheets:
            cells = sheet.iter_rows(
                max_row=most_rows, max_col=MOST_COLUMNS, values_only=True
            )  # fmt: skip
            read = [[_cell(value) for value in row] for row in cells]
            _mark_uncalculated(read, formulas[sheet.title] if formulas is not None else None)
            rows, numbers = _filled(read)
            label = f"{path}, sheet {sheet.title!r}"
            sheets.append(Sheet(label, sheet.title, rows, numbers, letters=True))
    except (ValueError, KeyError, OSError, zipfile.BadZipFile, SyntaxError) as error:
        raise InputError(f"{path}: is not a workbook that can be read ({error})") from None
    return sheets


def _formulas(content: bytes, most_rows: int) -> dict[str, list[tuple[Any, ...]]] | None:
    """Return the cells with their formulas by sheet; None for a workbook without any."""
    import openpyxl

    archive = zipfile.ZipFile(io.BytesIO(content))
    sheets = [name for name in archive.namelist() if name.startswith("xl/worksheets/")]
    if not any(b"<f" in archive.read(name) for name in sheets if name.endswith(".xml")):
        return None
    book = openpyxl.load_workbook(io.BytesIO(content), read_only=True)
    return {
        sheet.title: list(
            sheet.iter_rows(max_row=most_rows, max_col=MOST_COLUMNS, values_only=True)
        )
        for sheet in book.worksheets
    }


def _mark_uncalculated(rows: list[list[Cell]], formulas: list[tuple[Any, ...]] | None) -> None:
    """Mark empty cells that have a formula."""
    for row, told in zip(rows, formulas or (), strict=False):
        for column, formula in enumerate(told[: len(row)]):
            is_formula = isinstance(formula, str) and formula.startswith("=")
            if row[column] is None and (is_formula or type(formula).__name__.endswith("Formula")):
                row[column] = UNCALCULATED


def _refuse_bomb(path: Path, content: bytes) -> None:
    """Refuse archives that unpack to too much, and XML with definitions of its own."""
    try:
        archive = zipfile.ZipFile(io.BytesIO(content))
        size = sum(entry.file_size for entry in archive.infolist())
    except zipfile.BadZipFile:
        raise InputError(f"{path}: is not a workbook; save it as .xlsx") from None
    if size > 10 * MOST_BYTES:
        raise InputError(f"{path}: unpacks to {size / 1e6:.0f} MB; thin it out")
    for entry in archive.infolist():
        if entry.filename.endswith(".xml") and b"<!DOCTYPE" in archive.open(entry).read(2000):
            raise InputError(f"{path}: holds a DOCTYPE, which no workbook needs; save it again")


def _cell(value: Any) -> Cell:
    if value is None or (isinstance(value, str) and not value.strip()):
        return None
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        return str(value)
    return value.strip() if isinstance(value, str) else value


def _filled(rows: Iterable[list[Cell]]) -> tuple[list[list[Cell]], list[int]]:
    """Return the rows that hold anything and are no comments, with their numbers."""
    kept, numbers = [], []
    for number, row in enumerate(rows, 1):
        first = next((cell for cell in row if cell is not None), None)
        if first is not None and not str(first).startswith("#"):
            kept.append(row)
            numbers.append(number)
        elif first is not None and str(first).startswith("#") and str(first)[1:2].isupper():
            kept.append(row)  # a formula error such as #DIV/0! in the first column
            numbers.append(number)
    return kept, numbers


def _letters(column: int) -> str:
    text, rest = "", column + 1
    while rest:
        rest, digit = divmod(rest - 1, 26)
        text = chr(65 + digit) + text
    return text
