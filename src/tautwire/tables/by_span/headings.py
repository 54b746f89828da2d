"""Tables of droppers with one row per span: whose dropper a column tells of, and what.

A heading holds the number of the dropper and a word: ``x1``, ``Länge 3``, ``D2 length``. A row of
words may also stand below one of droppers. What is only called a dropper, ``Péndola 4``, holds
lengths where other columns give positions, and positions where its numbers rise along every span.
Letters with several meanings, ``H1`` or ``F1``, need a unit of length.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from enum import IntEnum
from itertools import pairwise

from tautwire.specs.line.dropper import MOST_DROPPERS
from tautwire.specs.schema.vocabulary import folded
from tautwire.tables.columns import Field, key_of
from tautwire.tables.headings import NUMBER_WORD, Reading, spellings
from tautwire.tables.sheets import HEADING_ROWS, Cell, Sheet
from tautwire.tables.values import CellError, number_of, unit_fits

DROPPER, POSITION, LENGTH = "dropper", "position", "length"
FEWEST = 2
"""Numbered columns from which they are taken for one per dropper: a lone one may be anything."""
_TOKEN = re.compile(r"[^\W\d_]+|\d+")


class Spelling(IntEnum):
    """How plainly words of a heading say what a column holds: each takes those before it too."""

    WHOLE = 0
    REPEATED = 1
    SHORT = 2


def read_by_span(
    sheet: Sheet,
    row: int,
    headings: Mapping[int, tuple[str, str]],
    fields: Sequence[Field],
    *,
    is_by_row: bool = False,
) -> dict[int, Reading]:
    """Match the columns that tell of one dropper each; empty where there are none.

    Parameters
    ----------
    sheet
    row
        Of its headings.
    headings
        Heading, and unit from a row of units, of the columns that are not read otherwise.
    fields
        What a table of droppers may hold.
    is_by_row
        Whether another column has the position of the one dropper of every row: numbered columns
        are then of droppers only if they have positions too, which is refused later.
    """
    if not any(field.is_of_one_dropper for field in fields):
        return {}
    found = {
        column: reading
        for column, (heading, unit) in headings.items()
        if (reading := read_of_one(heading, unit, fields)) is not None
    }
    if len(found) < FEWEST:
        return {}
    has_positions = any(reading.field.name == POSITION for reading in found.values())
    return {} if is_by_row and not has_positions else _told_apart(sheet, row, found, fields)


def _told_apart(
    sheet: Sheet, row: int, found: Mapping[int, Reading], fields: Sequence[Field]
) -> dict[int, Reading]:
    """Say what the columns hold that are only called droppers."""
    bare = [column for column, reading in found.items() if reading.field.name == DROPPER]
    there = {reading.field.name for reading in found.values()}
    is_position = POSITION not in there and _rise(sheet, row, sorted(bare))
    meant = next(f for f in fields if f.name == (POSITION if is_position else LENGTH))
    taken = {
        column: replace(reading, field=meant) if column in bare else reading
        for column, reading in found.items()
    }
    return {column: one for column, one in taken.items() if unit_fits(one.unit, one.field.unit)}


def read_of_one(
    heading: str, unit_below: str, fields: Sequence[Field], spelling: Spelling | None = None
) -> Reading | None:
    """Match a heading of one dropper; ``field`` is the dropper where no other word stands.

    Parameters
    ----------
    heading, unit_below
        As for :func:`tautwire.tables.headings.read_heading`.
    fields
        What a table of droppers may hold.
    spelling
        Words that are believed; by default short ones where a unit stands with them.
    """
    for words, unit in spellings(heading, unit_below):
        tokens = _TOKEN.findall(NUMBER_WORD.sub(" ", unicodedata.normalize("NFKC", words)))
        numbers = [token for token in tokens if token.isdecimal()]
        names = [token for token in tokens if not token.isdecimal()]
        if len(numbers) != 1 or len(numbers[0]) > len(str(MOST_DROPPERS)) or not names:
            continue
        number = int(numbers[0])
        if not 1 <= number <= MOST_DROPPERS:
            continue
        usual = Spelling.SHORT if unit else Spelling.REPEATED
        field = _meant(names, fields, usual if spelling is None else spelling)
        if field is not None and (field.name == DROPPER or unit_fits(unit, field.unit)):
            return Reading(field, unit, dropper=number)
    return None


def _meant(names: Sequence[str], fields: Sequence[Field], spelling: Spelling) -> Field | None:
    """Return what words mean beside the number of a dropper, with or without its own name."""
    own = next((field for field in fields if field.name == DROPPER), None)
    if own is None:
        return None
    rest = [name for name in names if not _is_called(own, [name], Spelling.SHORT)]
    short = {word for field in fields for word in field.short}
    by_key = not any(folded(name) in short for name in names)  # which keys leave out
    for words in (names, rest):
        for field in fields:
            if field.is_of_one_dropper and _is_called(field, words, spelling, by_key=by_key):
                return field
    return None


def _is_called(
    field: Field, names: Sequence[str], spelling: Spelling, *, by_key: bool = True
) -> bool:
    word, key = folded("".join(names)), key_of(" ".join(names)) if by_key else ""
    known = (field.headings, field.repeated, field.short)[: spelling + 1]
    return any(word in words for words in known) or (key in field.keys and key != "")


def _rise(sheet: Sheet, row: int, columns: Sequence[int]) -> bool:
    """Tell whether the numbers of every row rise from column to column."""
    if len(columns) < FEWEST:
        return False
    rows = [numbers_of(sheet, cells, columns) for cells in sheet.rows[row + 1 :]]
    rows = [values for values in rows if len(values) >= FEWEST]
    return bool(rows) and all(left < right for values in rows for left, right in pairwise(values))


def numbers_of(
    sheet: Sheet, cells: Sequence[Cell], columns: Iterable[int], unit: str = "", wanted: str = ""
) -> list[float]:
    """Return the numbers of a row in some columns; cells without one are left out.

    Parameters
    ----------
    sheet
    cells
        Of the row.
    columns
    unit, wanted
        Unit of the columns and the SI unit of their field; numbers as they stand by default.
    """
    values = []
    for column in columns:
        cell = cells[column] if column < len(cells) else None
        try:
            value = number_of(cell, unit, wanted, decimal_comma=sheet.decimal_comma)
        except CellError:
            continue
        if value is not None:
            values.append(value)
    return values


def with_one_row_of_headings(sheet: Sheet, fields: Sequence[Field]) -> Sheet:
    """Join a row of droppers and the row of words below it: ``D1``, ``x [m]`` to ``D1 x [m]``.

    A sheet without such rows is returned as it is.
    """
    is_possible = any(field.is_of_one_dropper for field in fields)
    for row in range(min(HEADING_ROWS, len(sheet.rows) - 2) if is_possible else 0):
        above, below = sheet.rows[row], sheet.rows[row + 1]
        joined = _joined(above, below, fields)
        if joined is not None:
            rows = [*sheet.rows[:row], joined, *sheet.rows[row + 2 :]]
            return replace(sheet, rows=rows, numbers=sheet.numbers[:row] + sheet.numbers[row + 1 :])
    return sheet


def _joined(
    above: Sequence[Cell], below: Sequence[Cell], fields: Sequence[Field]
) -> list[Cell] | None:
    """Return one row of headings for two; None where they are not such a pair."""
    joined: list[Cell] = []
    group, count = "", 0
    for column in range(max(len(above), len(below))):
        over = above[column] if column < len(above) else None
        under = below[column] if column < len(below) else None
        if isinstance(over, str):
            reading = read_of_one(over, "", fields, Spelling.SHORT)
            group = over if reading is not None and reading.field.name == DROPPER else ""
        if group and isinstance(under, str):
            inner = read_of_one(f"{group} {under}", "", fields)
            count += inner is not None and inner.field.name != DROPPER
            joined.append(f"{group} {under}")
        else:
            joined.append(under if under is not None else over)
    return joined if count >= FEWEST else None
