"""CSV tables: one row per support, per dropper, per time.

A table starts with one header row. A column is named ``name`` or ``name [unit]``; without a unit
its numbers are SI. Cells hold plain numbers. Columns are separated by commas, semicolons or tabs;
in a file with semicolons or tabs numbers may have a decimal comma. Lines that start with ``#`` and
empty lines are skipped. The text is UTF-8, with or without byte order mark.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from io import StringIO
from pathlib import Path

from tautwire.errors import InputError
from tautwire.inputs.files import did_you_mean, read_table_text
from tautwire.units import UnitError, expectation, parse_quantity

COUNT = "#"
MAX_PROBLEMS = 30
"""Problems of one table that are listed; the rest is counted."""

_HEADER = re.compile(r"([^\[\]]+?)\s*(?:\[([^\[\]]*)\])?")
_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")


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
    """

    label: str
    lines: list[int] = field(default_factory=list)
    columns: dict[str, list[float | None]] = field(default_factory=dict)
    titles: dict[str, str] = field(default_factory=dict)
    problems: list[str] = field(default_factory=list)

    def cell(self, row: int, name: str) -> str:
        """Name a cell in the user's words."""
        return f"{self.label}, line {self.lines[row]}, column {self.titles[name]!r}"

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
            listed = self.problems[:MAX_PROBLEMS]
            more = len(self.problems) - len(listed)
            raise InputError([*listed, f"{self.label}: {more} more problems"] if more else listed)


def read_table(path: Path, columns: Sequence[Column], *, others_allowed: bool = False) -> Table:
    """Read a table whose columns are known by name.

    Parameters
    ----------
    path
        CSV file.
    columns
        The columns the table may or must have.
    others_allowed
        Whether further columns are ignored; otherwise they are refused.

    Returns
    -------
    Table
        Values in SI.

    Raises
    ------
    InputError
        Naming line and column of everything that is wrong.
    """
    text = read_table_text(path)
    try:
        rows = list(_split(text))
    except csv.Error as error:
        raise InputError(f"{path}: is not a table ({error})") from None
    table = Table(str(path))
    if not rows:
        raise InputError(f"{path}: has no header row; name the columns in the first line")
    decimal_comma = rows[0].separator in ";\t"
    known = _read_header(table, rows[0].cells, columns, others_allowed=others_allowed)
    table.raise_problems()
    if len(rows) == 1:
        raise InputError(f"{path}: has a header but no rows")
    table.columns = {entry[0].name: [] for entry in known if entry is not None}
    for row in rows[1:]:
        table.lines.append(row.line)
        _read_row(table, row.cells, known, decimal_comma=decimal_comma)
    table.raise_problems()
    _drop_empty_columns(table, columns)
    table.raise_problems()
    return table


@dataclass(frozen=True)
class _Row:
    line: int
    cells: list[str]
    separator: str


def _split(text: str) -> Iterator[_Row]:
    separator = ""
    for number, line in enumerate(StringIO(text, newline=None), start=1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        separator = separator or next((s for s in ";\t" if s in line), ",")
        cells = [cell.strip() for cell in next(csv.reader([line], delimiter=separator))]
        if any(cells):
            yield _Row(number, cells, separator)


Known = tuple[Column, str] | None
"""A known column and the unit of its cells; None for a column to be ignored."""


def _read_header(
    table: Table, cells: list[str], columns: Sequence[Column], *, others_allowed: bool
) -> list[Known]:
    by_name = {column.name: column for column in columns}
    known: list[Known] = []
    for title in cells:
        match = _HEADER.fullmatch(title)
        name = match.group(1).strip().lower() if match else title
        known.append(None)
        if name not in by_name:
            if not others_allowed:
                hint = did_you_mean(name, by_name) or f"; known are: {', '.join(by_name)}"
                table.problems.append(f"{table.label}: unknown column {title!r}{hint}")
        elif name in table.titles:
            table.problems.append(f"{table.label}: the column {name!r} is given twice")
        else:
            table.titles[name] = title
            known[-1] = (by_name[name], _unit_of(table, match, by_name[name]))
    table.problems += [
        f"{table.label}: the column {column.name!r} is missing; there are: {', '.join(cells)}"
        for column in columns
        if column.required and column.name not in table.titles
    ]
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


def _read_row(
    table: Table, cells: list[str], known: Sequence[Known], *, decimal_comma: bool
) -> None:
    row = len(table.lines) - 1
    if len(cells) > len(known) and any(cells[len(known) :]):
        table.problems.append(
            f"{table.label}, line {table.lines[row]}: has {len(cells)} cells for {len(known)} "
            "columns; check separators and decimal commas"
        )
    for index, entry in enumerate(known):
        if entry is None:
            continue
        column, unit = entry
        cell = cells[index] if index < len(cells) else ""
        text = cell.replace(",", ".", 1) if decimal_comma else cell
        table.columns[column.name].append(_number(table, row, column, text, unit))


def _number(table: Table, row: int, column: Column, text: str, unit: str) -> float | None:
    if not text:
        return None
    if column.unit == COUNT:
        if text.isdecimal() and 0 < int(text[:9]) < 10**6:
            return float(text)
        table.complain(row, column.name, f"got {text[:40]!r}; expected a number 1, 2, 3 ...")
    elif not _NUMBER.fullmatch(text):
        table.complain(
            row,
            column.name,
            f"got {text[:40]!r}; cells hold plain numbers, and the unit stands in the header, as "
            f"in '{column.name} [{column.unit}]'",
        )
    else:
        try:
            return parse_quantity(f"{text} {unit}", column.unit)
        except UnitError as error:
            table.complain(row, column.name, str(error))
    return 0.0


def _drop_empty_columns(table: Table, columns: Sequence[Column]) -> None:
    for column in columns:
        if column.name in table.columns and all(v is None for v in table.columns[column.name]):
            del table.columns[column.name]
            if column.required:
                table.problems.append(f"{table.label}: the column {column.name!r} is empty")
