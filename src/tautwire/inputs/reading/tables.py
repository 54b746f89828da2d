"""CSV tables: one row per support, per dropper, per time.

A table starts with one header row. A column is named ``name`` or ``name [unit]``; without a unit
its numbers are SI. Cells hold plain numbers. Columns are separated by commas, semicolons or tabs;
in a file with semicolons or tabs numbers may have a decimal comma. Lines that start with ``#`` and
empty lines are skipped. The text is UTF-8, with or without byte order mark.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from io import StringIO
from math import isfinite
from pathlib import Path

from tautwire.errors import InputError
from tautwire.inputs.reading.files import did_you_mean, named, read_table_text
from tautwire.inputs.reading.grouping import grouped
from tautwire.text import shortened
from tautwire.units import UnitError, expectation, parse_quantity

COUNT = "#"
MAX_COLUMNS = 1000
"""Columns of a table; recorders write some hundred channels at most."""
MAX_DIGITS = 400
"""Characters of a number; the longest that is finite has 309 before its decimal point."""
MAX_PROBLEMS = 1000
"""Problems of one table after which the rest of it is not looked at."""

_HEADER = re.compile(r"([^\[\]]+?)\s*(?:\[([^\[\]]*)\])?")
_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")


Cells = Callable[[int], str]
"""Names the cell from which an item of a list was read, by the number of the item from 0."""


@dataclass(frozen=True)
class Column:
    """A column that a table may have; the unit :data:`COUNT` stands for numbers 1, 2, 3 ..."""

    name: str
    unit: str
    required: bool = False


@dataclass
class Table:
    """The cells of a table as SI numbers, and the problems found so far.

    Attributes
    ----------
    label
        Name of the file in messages.
    lines
        Line of the file on which each row stands.
    columns
        Values by column name; None for an empty cell. Columns without any value are left out.
    titles
        Column headers as they stand in the file.
    decimal_comma
        Whether numbers may be written with a comma, because something else separates the cells.
    """

    label: str
    decimal_comma: bool = False
    lines: list[int] = field(default_factory=list)
    columns: dict[str, list[float | None]] = field(default_factory=dict)
    titles: dict[str, str] = field(default_factory=dict)
    problems: list[str] = field(default_factory=list)

    def cell(self, row: int, name: str) -> str:
        """Name a cell in the user's words."""
        return f"{self.label}, line {self.lines[row]}, column '{shortened(self.titles[name])}'"

    def complain(self, row: int, name: str, text: str) -> None:
        """Note a problem of one cell."""
        self.problems.append(f"{self.cell(row, name)}: {text}")

    def full_column(self, name: str) -> list[float]:
        """Return a column in which every cell must have a value."""
        values = self.columns.get(name, [])
        for row, value in enumerate(values):
            if value is None:
                self.complain(row, name, "is empty; fill the column or leave all of it empty")
        return [0.0 if value is None else value for value in values]

    def raise_problems(self) -> None:
        """Raise InputError when there is any problem."""
        if self.problems:
            is_cut = len(self.problems) >= MAX_PROBLEMS
            rest = [f"{self.label}: the rows after these were not looked at"] if is_cut else []
            raise InputError([*grouped(self.problems), *rest])


def read_table(
    path: Path,
    columns: Sequence[Column],
    *,
    most_rows: int,
) -> Table:
    """Read a table whose columns are known by name.

    Parameters
    ----------
    path
        CSV file.
    columns
        The columns the table may or must have.
    most_rows
        A longer table is refused before its cells are read.

    Returns
    -------
    Table
        Values in SI.

    Raises
    ------
    InputError
        Naming line and column of everything that is wrong; a file that has none of the columns is
        refused without a word of its content.
    """
    lines = _lines_with_content(read_table_text(path))
    if not lines:
        raise InputError(f"{named(path)}: has no header row; name the columns in the first line")
    separator = next((s for s in ";\t" if s in lines[0][1]), ",")
    table = Table(named(path), decimal_comma=separator != ",")
    try:
        if lines[0][1].count(separator) >= MAX_COLUMNS:
            raise InputError(f"{table.label}: has more than {MAX_COLUMNS} columns")
        titles = _cells(lines[0][1], separator)
        known = _read_header(table, titles, columns)
        if len(lines) == 1:
            raise InputError(f"{table.label}: has a header but no rows")
        if len(lines) - 1 > most_rows:
            raise InputError(
                f"{table.label}: has {len(lines) - 1:,} rows; at most {most_rows:,} are read"
            )
        table.columns = {entry.column.name: [] for entry in known if entry is not None}
        for number, line in lines[1:]:
            _read_row(table, number, _cells(line, separator), known)
            if len(table.problems) >= MAX_PROBLEMS:
                break
    except csv.Error as error:
        raise InputError(f"{table.label}: is not a table ({error})") from None
    table.raise_problems()
    _drop_empty_columns(table, columns)
    table.raise_problems()
    return table


def _lines_with_content(text: str) -> list[tuple[int, str]]:
    """Return the lines that are neither empty nor comments, with their numbers."""
    return [
        (number, line)
        for number, line in enumerate(StringIO(text, newline=None), start=1)
        if line.strip(" \t\n,;") and not line.lstrip().startswith("#")
    ]


def _cells(line: str, separator: str) -> list[str]:
    quoted = '"' in line
    cells = next(csv.reader([line], delimiter=separator)) if quoted else line.split(separator)
    return [cell.strip() for cell in cells]


@dataclass(frozen=True)
class _Known:
    """A column that is read, and the unit of its cells."""

    column: Column
    unit: str


def _read_header(table: Table, titles: list[str], columns: Sequence[Column]) -> list[_Known | None]:
    """Return what is known about each column, None for one to be ignored."""
    by_name = {column.name: column for column in columns}
    matches = [_HEADER.fullmatch(title) for title in titles]
    names = [m.group(1).strip().lower() if m else "" for m in matches]
    if not by_name.keys() & set(names):
        raise InputError(
            f"{table.label}: is not a table with the columns {', '.join(by_name)}; the first line "
            "names the columns, at least one of these"
        )
    known: list[_Known | None] = []
    for title, match, name in zip(titles, matches, names, strict=True):
        known.append(None)
        if name not in by_name:
            hint = did_you_mean(name, by_name) or f"; known are: {', '.join(by_name)}"
            table.problems.append(f"{table.label}: unknown column '{shortened(title)}'{hint}")
        elif name in table.titles:
            table.problems.append(f"{table.label}: the column {name!r} is given twice")
        else:
            table.titles[name] = title
            known[-1] = _Known(by_name[name], _unit_of(table, match, by_name[name]))
    there = shortened(", ".join(titles), 200)
    table.problems += [
        f"{table.label}: the column {column.name!r} is missing; there are: {there}"
        for column in columns
        if column.required and column.name not in table.titles
    ]
    table.raise_problems()
    return known


def _unit_of(table: Table, header: re.Match[str] | None, column: Column) -> str:
    """Return the unit of a column's cells, the SI unit where none is given."""
    unit = header.group(2) if header is not None else None
    if unit is None or header is None:
        return column.unit
    if column.unit == COUNT:
        table.problems.append(f"{table.label}: column {header.group()!r}: takes no unit")
        return column.unit
    try:
        parse_quantity(f"1 {unit}", column.unit)
    except UnitError:
        table.problems.append(
            f"{table.label}: column {header.group()!r}: the unit does not fit; expected "
            f"{expectation(column.unit)}"
        )
        return column.unit
    return unit


def _read_row(table: Table, line: int, cells: list[str], known: Sequence[_Known | None]) -> None:
    row = len(table.lines)
    table.lines.append(line)
    if len(cells) > len(known) and any(cells[len(known) :]):
        table.problems.append(
            f"{table.label}, line {line}: has {len(cells)} cells for {len(known)} columns; check "
            "separators and decimal commas"
        )
    for index, entry in enumerate(known):
        if entry is not None:
            text = cells[index] if index < len(cells) else ""
            value = _number(table, row, entry, text) if text else None
            table.columns[entry.column.name].append(value)


def _number(table: Table, row: int, known: _Known, text: str) -> float:
    column = known.column
    if column.unit == COUNT:
        if text.isdecimal() and 0 < int(text[:9]) < 10**6:
            return float(text)
        table.complain(row, column.name, f"got {text[:40]!r}; expected a number 1, 2, 3 ...")
        return 0.0
    digits = text.replace(",", ".", 1) if table.decimal_comma else text
    if len(digits) > MAX_DIGITS or not _NUMBER.fullmatch(digits):
        table.complain(
            row,
            column.name,
            f"got {text[:40]!r}; cells hold plain numbers, and the unit stands in the header, as "
            f"in '{column.name} [{column.unit}]'",
        )
        return 0.0
    if known.unit == column.unit and isfinite(value := float(digits)):
        return value
    try:
        return parse_quantity(f"{digits} {known.unit}", column.unit)
    except UnitError as error:
        table.complain(row, column.name, str(error))
        return 0.0


def _drop_empty_columns(table: Table, columns: Sequence[Column]) -> None:
    for column in columns:
        if column.name in table.columns and all(v is None for v in table.columns[column.name]):
            del table.columns[column.name]
            if column.required:
                table.problems.append(f"{table.label}: the column {column.name!r} is empty")
