"""Tables that a case names: of its line, and of lists that belong to one mapping.

Texts of any dialect and workbooks; columns are known by their headings in any spelling, their units
stand in the headings (SI without one), and what means nothing here is left aside.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from tautwire.errors import InputError
from tautwire.inputs.paths import Path as ValuePath
from tautwire.inputs.reading.files import read_table_bytes
from tautwire.inputs.reading.grouping import grouped
from tautwire.specs.line.catenary import MOST_SPANS
from tautwire.tables.columns import Field, fields_of
from tautwire.tables.line import LineTables, read_line
from tautwire.tables.mapping import NEEDS, SheetMapping, match, refuse_headings
from tautwire.tables.rows import Rows
from tautwire.tables.sheets import Sheet, read_sheets

MOST_LINE_ROWS = 50 * MOST_SPANS
"""Rows of a table of a line: fifty droppers to a span are more than twice as many as are built."""
MOST_ROWS = 200_000
"""Rows of a table that stands for lists: 20 km of a profile at 0.1 m, 200 s of a roof at 1 kHz."""

Cells = Callable[[int], str]
"""Names the cell from which an item of a list was read, by the number of the item from 0."""


@dataclass(frozen=True)
class Columns:
    """Lists read from the columns of a table.

    Attributes
    ----------
    values
        Numbers by column name.
    cells
        What names the cell of each number.
    """

    values: dict[str, list[float]]
    cells: dict[str, Cells]


def open_sheets(path: Path, most_rows: int = MOST_LINE_ROWS) -> list[Sheet]:
    """Read the sheets of a file of at most 20 MB.

    Raises
    ------
    InputError
        When it cannot be read as a table.
    """
    return read_sheets(path, read_table_bytes(path), most_rows)


def line_sheet(kind: str, path: Path) -> SheetMapping:
    """Return the sheet of a file that is a table of a kind, its columns matched.

    Raises
    ------
    InputError
        When there is none, naming what is missing and what is misspelt.
    """
    return _matched(open_sheets(path), kind, fields_of(kind), NEEDS[kind])


def line_tables(mappings: Sequence[SheetMapping], beside: Any = None) -> LineTables:
    """Read matched sheets of one line, beside what the case says about it.

    Raises
    ------
    InputError
        Naming every cell that cannot be used, those of a kind counted.
    """
    try:
        return read_line(mappings, beside)
    except InputError as error:
        raise InputError(grouped(error.problems)) from None


def read_columns(path: Path, fields: Sequence[Field], optional: Iterable[str] = ()) -> Columns:
    """Read a table that stands for lists of one mapping, such as the motion of a roof over time.

    Parameters
    ----------
    path
    fields
        What the table holds.
    optional
        Names of the fields that it may lack.

    Raises
    ------
    InputError
        Naming line and column of everything that is wrong.
    """
    needs = [(field.name,) for field in fields if field.name not in set(optional)]
    rows = Rows(_matched(open_sheets(path, MOST_ROWS), "columns", fields, needs))
    found = {use.field.name: rows.full(use.field.name) for use in rows.mapping.uses}
    try:
        rows.raise_problems()
    except InputError as error:
        raise InputError(grouped(error.problems)) from None
    for (name,) in needs:
        if found[name] is None:
            raise InputError(f"{path}: the column {name!r} is empty")
    values = {name: column for name, column in found.items() if column is not None}
    return Columns(values, {name: partial(rows.place, name=name) for name in values})


def cells_by_list(origins: Mapping[ValuePath, str]) -> dict[ValuePath, Cells]:
    """Return what names the cells of each list, from the cells of single values by their paths."""
    by_list: dict[ValuePath, dict[int, str]] = {}
    for (*above, item), cell in origins.items():
        by_list.setdefault(tuple(above), {})[int(item)] = cell
    return {path: partial(_named_cell, cells) for path, cells in by_list.items()}


def _named_cell(cells: Mapping[int, str], item: int) -> str:
    return cells.get(item, "")


def _matched(
    sheets: Sequence[Sheet], kind: str, fields: Sequence[Field], needs: Sequence[Sequence[str]]
) -> SheetMapping:
    found = [(sheet, match(sheet, kind, fields, needs)) for sheet in sheets]
    sheet, mapping = max(found, key=lambda one: len(one[1].uses) if one[1] is not None else 0)
    refuse_headings(sheet, fields, needs, mapping)
    if mapping is None:  # lacks nothing in its first row, but has no rows of values
        raise InputError(f"{sheet.label}: has no table of {kind}")
    return mapping
