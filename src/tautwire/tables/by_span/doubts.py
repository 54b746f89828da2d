"""Columns of droppers whose abbreviated headings may mean something else.

``H1`` is the length of hanger 1 to one author and the height of the contact wire at it to another,
``F1`` a pre-sag or a force. Such a column is believed where its unit and its values leave one
meaning; otherwise it is refused by name, since what is left aside would be replaced by a rule.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from tautwire.tables.by_span.headings import DROPPER, LENGTH, Spelling, numbers_of, read_of_one
from tautwire.tables.columns import Field
from tautwire.tables.headings import Reading
from tautwire.tables.sheets import Sheet
from tautwire.tables.values import ratio_of
from tautwire.text import shortened

_WORDS = {LENGTH: ("lengths of droppers", "length 1 [mm]"),
          "unstrained_length": ("lengths of droppers", "unstrained length 1 [mm]"),
          "presag": ("pre-sags", "pre-sag 1 [mm]")}  # fmt: skip
"""What a field holds, and a heading that leaves no doubt about it."""
_OTHERWISE = (
    "by a name of anything else, as in 'contact height 1' or 'dropper force 1', they are left aside"
)


@dataclass(frozen=True)
class NumberedColumn:
    """A column of a table with one row per span.

    Attributes
    ----------
    column : int
    heading : str
    unit_below : str
        From a row of units; empty where there is none.
    reading : Reading or None
        What it is read as; None where it is left aside.
    """

    column: int
    heading: str
    unit_below: str
    reading: Reading | None


def doubts(
    sheet: Sheet, row: int, columns: Sequence[NumberedColumn], fields: Sequence[Field]
) -> list[str]:
    """Return what is doubtful about the columns of a table with one row per span.

    Parameters
    ----------
    sheet
    row
        Of its headings.
    columns
        Those that are read, and those that are left aside.
    fields
        What a table of droppers may hold.
    """
    without_unit: dict[str, list[str]] = {}
    implausible: dict[str, list[tuple[str, list[float]]]] = {}
    by_name = {field.name: field for field in fields}
    for one in columns:
        if one.reading is None:
            meant = read_of_one(one.heading, one.unit_below, fields, Spelling.SHORT)
            if meant is not None and not meant.unit:
                name = LENGTH if meant.field.name == DROPPER else meant.field.name
                without_unit.setdefault(name, []).append(one.heading)
        elif (
            one.reading.field.name in _WORDS
            and not _is_spelt_out(one, one.reading, fields)
            and (values := _beyond(sheet, row, one.column, one.reading))
        ):
            name = one.reading.field.name
            implausible.setdefault(name, []).append((one.heading, values))
    found = [
        f"{_named(headings)} may hold {_WORDS[name][0]} or something else, which neither their "
        f"names nor a unit tell; call them {_WORDS[name][1]!r} and so on if they do; {_OTHERWISE}"
        for name, headings in without_unit.items()
    ]
    return found + [_implausible(by_name[name], dict(held)) for name, held in implausible.items()]


def _implausible(field: Field, held: Mapping[str, list[float]]) -> str:
    """Say that columns hold what the field cannot be."""
    assert field.plausible is not None
    _, low, high = field.plausible
    values = [value for own in held.values() for value in own]
    span = f"{min(values):g}" + (f" to {max(values):g}" if max(values) > min(values) else "")
    what, heading = _WORDS[field.name]
    return (
        f"{_named(list(held))} would be {what} by their names, but hold {span} m, and {what} lie "
        f"within {low:g} and {high:g} m; call them {heading!r} and so on, with their unit, if they "
        f"are; {_OTHERWISE}"
    )


def _named(headings: Sequence[str]) -> str:
    return f"the columns {shortened(', '.join(map(repr, headings)), 120)}"


def _is_spelt_out(one: NumberedColumn, reading: Reading, fields: Sequence[Field]) -> bool:
    """Tell whether a heading names what it holds in a word of its own."""
    found = read_of_one(one.heading, one.unit_below, fields, Spelling.WHOLE)
    return found is not None and found.field == reading.field


def _beyond(sheet: Sheet, row: int, column: int, reading: Reading) -> list[float]:
    """Return the values [m] of a column that its field cannot have; a share is no length."""
    if reading.field.plausible is None or ratio_of(reading.unit) is not None:
        return []
    _, low, high = reading.field.plausible
    values = [
        value
        for cells in sheet.rows[row + 1 :]
        for value in numbers_of(sheet, cells, [column], reading.unit, reading.field.unit)
    ]
    return [value for value in values if not low <= value <= high]
