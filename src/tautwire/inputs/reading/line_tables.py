"""Tables that describe a line: supports, droppers, running surface, and the motion of a roof."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

from tautwire.inputs.paths import Path as ValuePath
from tautwire.inputs.reading.tables import COUNT, Cells, Column, Table, read_table
from tautwire.specs.line.catenary import MOST_SPANS

SUPPORT_COLUMNS = (
    Column("support", COUNT, required=True),
    Column("x", "m"),
    Column("span_length", "m"),
    Column("contact_height", "m"),
    Column("encumbrance", "m"),
    Column("contact_stagger", "m"),
    Column("messenger_stagger", "m"),
    Column("arm_end_y", "m"),
    Column("arm_end_z", "m"),
)
DROPPER_COLUMNS = (
    Column("span", COUNT, required=True),
    Column("dropper", COUNT, required=True),
    Column("position", "m", required=True),
    Column("presag", "m"),
    Column("length", "m"),
    # The columns that the program's own dropper table has besides.
    Column("x", "m"),
    Column("unstrained length", "m"),
    Column("stretched length", "m"),
    Column("force", "N"),
    Column("contact wire height", "m"),
)
MOST_DROPPER_ROWS = 50 * MOST_SPANS
"""Rows of a dropper table: fifty to a span are more than twice as many as any built line has."""
MOST_ROWS = 200_000
"""Rows of a table that stands for lists: 20 km of a profile at 0.1 m, 200 s of a roof at 1 kHz."""


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


@dataclass(frozen=True)
class Overlay:
    """What a table says about a case.

    Attributes
    ----------
    values
        Part of a case as plain data, to be merged into it.
    cells
        By the path of a list: what names the cell of each of its items.
    """

    values: dict[str, Any]
    cells: dict[ValuePath, Cells]


_DROPPER_KEYS = (
    ("position", "positions"),
    ("presag", "presag"),
    ("unstrained length", "lengths"),
    ("length", "lengths"),
)
"""Columns of a dropper table and the keys that they fill; a later one wins."""


def read_support_table(path: Path) -> Overlay:
    """Read ``supports.csv``: one row per support, both anchors included.

    Columns: ``support`` (1, 2, 3 ...), and as far as they are known ``x`` or ``span_length`` (of
    the span that begins at the support; empty in the last row), ``contact_height``,
    ``encumbrance``, ``contact_stagger``, ``messenger_stagger``, ``arm_end_y``, ``arm_end_z``
    (both empty at the anchors).

    Raises
    ------
    InputError
        Naming line and column of everything that is wrong.
    """
    table = read_table(path, SUPPORT_COLUMNS, most_rows=MOST_SPANS + 1)
    _check_count(table, "support", table.full_column("support"))
    lengths, length_name = _span_lengths(table)
    names = [
        column.name
        for column in SUPPORT_COLUMNS
        if column.name in table.columns and column.name not in ("support", "x", "span_length")
    ]
    supports: dict[str, Any] = {}
    cells: dict[ValuePath, Cells] = {}
    for name in names:
        is_arm = name.startswith("arm_end")
        supports[name] = table.columns[name] if is_arm else table.full_column(name)
        cells["supports", name] = partial(table.cell, name=name)
    table.raise_problems()
    line: dict[str, Any] = {"spans": len(table.lines) - 1}
    if length_name:
        line["span_length"] = lengths
        cells["line", "span_length"] = partial(table.cell, name=length_name)
    if length_name == "x" and table.columns["x"][0] != 0.0:
        line["chainage"] = table.full_column("x")  # not counted from the first support
    return Overlay({"line": line} | ({"supports": supports} if supports else {}), cells)


def read_dropper_table(path: Path) -> Overlay:
    """Read ``droppers.csv``: one row per dropper, span by span, from left to right.

    Columns: ``span``, ``dropper`` (1, 2, 3 ... in each span), ``position`` from the left support,
    and ``presag`` or ``length`` or both (``droppers.mode`` says which is used). The dropper table
    that the program writes is such a table: its unstrained lengths are the lengths.

    Raises
    ------
    InputError
        Naming line and column of everything that is wrong.
    """
    table = read_table(path, DROPPER_COLUMNS, most_rows=MOST_DROPPER_ROWS)
    numbers = [int(n) for n in table.full_column("dropper")]
    spans = _check_order(table, [int(n) for n in table.full_column("span")], numbers)
    droppers: dict[str, Any] = {}
    cells: dict[ValuePath, Cells] = {}
    for name, key in _DROPPER_KEYS:
        if name not in table.columns:
            continue
        values = table.full_column(name)
        droppers[key] = [[values[row] for row in rows] for rows in spans]
        for span, rows in enumerate(spans):
            cells["droppers", key, span] = partial(_cell_of, table, rows, name)
    if "presag" not in droppers and "lengths" not in droppers:
        table.problems.append(
            f"{path}: has neither a column 'presag' nor a column 'length'; add one of them"
        )
    table.raise_problems()
    return Overlay({"droppers": droppers}, cells)


def _cell_of(table: Table, rows: Sequence[int], name: str, number: int) -> str:
    return table.cell(rows[number], name)


def read_columns(path: Path, columns: Sequence[Column]) -> Columns:
    """Read a table that stands for lists of one mapping, such as the motion of a roof over time.

    Parameters
    ----------
    path
        CSV file.
    columns
        Those that the table may or must have.

    Raises
    ------
    InputError
        Naming line and column of everything that is wrong.
    """
    table = read_table(path, columns, most_rows=MOST_ROWS)
    values = {name: table.full_column(name) for name in table.columns}
    table.raise_problems()
    return Columns(values, {name: partial(table.cell, name=name) for name in values})


def _check_count(table: Table, name: str, numbers: Sequence[float]) -> None:
    if len(numbers) < 2:
        table.problems.append(f"{table.label}: has one row; a line has at least two supports")
    for row, number in enumerate(numbers):
        if number != row + 1:
            table.complain(row, name, f"got {number:g}, expected {row + 1}; number them in order")
            return


def _span_lengths(table: Table) -> tuple[list[float], str]:
    """Return the span lengths and the column they come from; nothing where neither is given."""
    if "x" in table.columns and "span_length" in table.columns:
        table.problems.append(
            f"{table.label}: has both columns 'x' and 'span_length'; keep one of them"
        )
        return [], ""
    if "x" in table.columns:
        x = table.full_column("x")
        for row in range(1, len(x)):
            if x[row] <= x[row - 1]:
                table.complain(row, "x", f"got {x[row]:g} m after {x[row - 1]:g} m; must increase")
        return [right - left for left, right in pairwise(x)], "x"
    if "span_length" in table.columns:
        *lengths, last = table.columns["span_length"]
        for row, length in enumerate(lengths):
            if length is None:
                table.complain(row, "span_length", "is empty; only the last support begins no span")
        if last is not None:
            table.complain(
                len(lengths), "span_length", "must be empty: the last support begins no span"
            )
        return [0.0 if length is None else length for length in lengths], "span_length"
    return [], ""


def _check_order(table: Table, spans: Sequence[int], numbers: Sequence[int]) -> list[list[int]]:
    """Return the rows of each span, noting rows that are missing, repeated or out of order."""
    rows: list[list[int]] = []
    for row, (span, number) in enumerate(zip(spans, numbers, strict=True)):
        if span == len(rows) + 1:
            rows.append([])
        if span != len(rows):
            table.complain(
                row,
                "span",
                f"got {span}, expected {max(len(rows), 1)} or {len(rows) + 1}; list "
                "the droppers span by span",
            )
            return rows
        rows[-1].append(row)
        if number != len(rows[-1]):
            table.complain(
                row,
                "dropper",
                f"got {number}, expected {len(rows[-1])}; number the droppers of "
                "each span 1, 2, 3 ... from left to right",
            )
            return rows
    return rows
