"""Surveys of a line from CSV tables and workbooks: one row per place, any heights and lengths."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

from tautwire.errors import InputError
from tautwire.inputs.reading.tables import open_sheets
from tautwire.measured.survey import Quantity, Reading, Survey
from tautwire.specs.case import Case
from tautwire.specs.schema.vocabulary import folded
from tautwire.tables.columns import COUNT, TEXT, Field
from tautwire.tables.headings import Reading as Heading
from tautwire.tables.headings import read_heading
from tautwire.tables.sheets import Sheet
from tautwire.tables.values import CellError, number_of, text_of

ACCURACY = 0.003
"""Standard deviation of a reading where none is given [m]. From memory: surveys of contact wires
by laser are good to 2 to 5 mm."""

_HEADINGS = {
    "span": (COUNT, ("span no", "span number", "feld", "spannfeld", "portée", "vano", "campata")),
    "dropper": (COUNT, ("dropper no", "dropper number", "hänger", "hänger nr", "pendule",
                        "péndola", "pendino")),
    "support": (COUNT, ("support no", "support number", "stützpunkt")),
    "mast": (TEXT, ("mast no", "mast number", "mast nr", "poteau", "poste", "palo")),
    "position": ("m", ("x", "distance", "abstand", "distanza", "distancia")),
    "chainage": ("m", ("km", "kilometre", "kilometer", "kilometrierung", "location", "pk")),
    "contact height": ("m", ("height", "wire height", "fahrdrahthöhe", "fahrdrahthoehe",
                             "contact wire height", "hauteur", "altura", "altezza")),
    "messenger height": ("m", ("catenary height", "tragseilhöhe", "messenger wire height",
                               "hauteur porteur")),
    "dropper length": ("m", ("length", "hängerlänge", "länge", "longueur", "longitud")),
    "stagger": ("m", ("contact stagger", "zickzack", "seitenlage", "désaxement",
                      "descentramiento")),
    "accuracy": ("m", ("standard deviation", "sigma", "genauigkeit", "précision")),
}  # fmt: skip
"""Unit and headings of each column; its own name is one too."""
_FIELDS = tuple(
    Field(name, unit, frozenset(map(folded, (name, *headings))))
    for name, (unit, headings) in _HEADINGS.items()
)
_QUANTITIES = ("contact height", "messenger height", "dropper length", "stagger")
MOST_ROWS = 500_000
"""Rows of a survey that are read: rows every 0.25 m of more than 100 km."""
_HEADING_ROWS = 10
"""Rows in which the headings of a sheet are sought, below titles."""


def load_survey(path: str | os.PathLike[str], case: Case, *, accuracy: float = ACCURACY) -> Survey:
    """Load what was measured of the geometry of a line.

    CSV of any dialect or a workbook. A row belongs to a dropper (columns ``span`` and
    ``dropper``), to a support (``support`` or ``mast``), or to a place (``position`` from support
    1, or ``chainage``), and holds any of ``contact height``, ``messenger height``, ``dropper
    length`` and ``stagger``; ``accuracy`` is its standard deviation.

    Parameters
    ----------
    path
    case
        The line, for the names of its masts and its chainage.
    accuracy : float m
        Standard deviation of readings without one of their own.

    Returns
    -------
    Survey

    Raises
    ------
    InputError
        Naming every cell that cannot be used.
    """
    problems: list[str] = []
    readings: list[Reading] = []
    notes = []
    for sheet in open_sheets(Path(path), MOST_ROWS):
        table = _table(sheet)
        if table is None:
            notes.append(f"{sheet.label}: no columns of a survey; left out")
            continue
        unread = [str(sheet.rows[table.row][column]) for column in table.unread]
        notes += [f"{sheet.label}: the column {name!r} is not used" for name in unread]
        readings += _readings(table, case, accuracy, problems)
    if not readings and not problems:
        problems.append(
            f"{path}: no sheet is a survey; a row needs a place ('Span' and 'Dropper', 'Support', "
            "'Mast', 'Position [m]' or 'Chainage [m]') and a value ('Contact height [m]', "
            "'Messenger height [m]', 'Dropper length [mm]', 'Stagger [mm]')"
        )
    if problems:
        raise InputError(problems)
    return Survey(str(path), tuple(readings), tuple(notes))


@dataclass(frozen=True)
class _Table:
    """A sheet whose headings are known.

    Attributes
    ----------
    sheet : Sheet
    row : int
        Of the headings.
    first : int
        Of the values.
    columns : dict
        Columns by field, with their units.
    unread : tuple of int
    """

    sheet: Sheet
    row: int
    first: int
    columns: dict[str, tuple[int, Heading]]
    unread: tuple[int, ...]


def _table(sheet: Sheet) -> _Table | None:
    for row in range(min(_HEADING_ROWS, len(sheet.rows) - 1)):
        below = sheet.rows[row + 1]
        has_units = not any(_is_number(cell) for cell in below) and any(below)
        columns: dict[str, tuple[int, Heading]] = {}
        unread = []
        for column, cell in enumerate(sheet.rows[row]):
            if not isinstance(cell, str):
                continue
            unit = str(below[column] or "") if has_units and column < len(below) else ""
            found = read_heading(cell, unit.strip("[]() "), _FIELDS)
            if found is None or found.field.name in columns:
                unread.append(column)
            else:
                columns[found.field.name] = column, found
        if any(name in columns for name in _QUANTITIES) and len(columns) > 1:
            return _Table(sheet, row, row + 1 + has_units, columns, tuple(unread))
    return None


def _is_number(cell: object) -> bool:
    text = str(cell or "").replace(",", ".").replace("+", "")
    return isinstance(cell, float | int) or text.replace(".", "", 1).lstrip("-").isdigit()


def _readings(table: _Table, case: Case, accuracy: float, problems: list[str]) -> list[Reading]:
    """Return the readings of a sheet; what is wrong is added to the problems."""
    found = []
    for row in range(table.first, len(table.sheet.rows)):
        where = f"{table.sheet.label}, row {table.sheet.numbers[row]}"
        try:
            cells = {name: _value(table, row, name) for name in table.columns}
            values = {name: cells[name] for name in _QUANTITIES if cells.get(name) is not None}
            if not values:
                continue
            place = _place(cells, case)
        except CellError as error:
            problems.append(f"{where}: {error}")
            continue
        own = cells.get("accuracy")
        found += [
            Reading(cast("Quantity", name), float(value), float(own or accuracy), **place,
                    where=where)
            for name, value in values.items()
            if value is not None
        ]  # fmt: skip
    return found


def _value(table: _Table, row: int, name: str) -> float | str | None:
    column, heading = table.columns[name]
    cells = table.sheet.rows[row]
    cell = cells[column] if column < len(cells) else None
    if heading.field.unit == TEXT:
        return text_of(cell)
    return number_of(
        cell, heading.unit, heading.field.unit, decimal_comma=table.sheet.decimal_comma
    )


def _place(cells: dict[str, float | str | None], case: Case) -> dict[str, Any]:
    """Return where a row belongs.

    Raises
    ------
    CellError
        When it says nowhere, or a place that the line does not have.
    """
    span, dropper, support = (cells.get(name) for name in ("span", "dropper", "support"))
    if span is not None and dropper is not None:
        return {"span": int(span), "dropper": int(dropper)}
    if support is not None:
        return {"support": int(support)}
    mast = cells.get("mast")
    if mast is not None:
        names = case.line.support_marks()
        if mast not in names:
            raise CellError(f"names mast {mast}, which the line does not have (line.masts)")
        return {"support": names.index(str(mast)) + 1}
    if cells.get("position") is not None:
        return {"s": float(cells["position"] or 0.0)}
    if cells.get("chainage") is not None:
        return {"s": case.line.distance(float(cells["chainage"] or 0.0))}
    raise CellError(
        "says no place; give span and dropper, a support or mast, a position or a chainage"
    )
