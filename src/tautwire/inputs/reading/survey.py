"""Surveys of a line from CSV tables and workbooks: one row per place, any heights and lengths."""

from __future__ import annotations

import math
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
    "lower wire": (TEXT, ("to", "to wire", "lower", "wire below", "seil unten", "unteres seil")),
    "tension length": (TEXT, ("tension section", "nachspannlänge", "canton", "canton de pose",
                              "锚段")),
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
    "elasticity": ("m/N", ("elastizität", "élasticité", "elasticidad", "elasticità", "elastisitet",
                           "elasticitet", "弹性")),
    "uplift": ("m", ("anhub", "soulèvement", "elevación", "sollevamento", "oppløft", "upplyft",
                     "抬升", "抬升量")),
    "point": (TEXT, ("point in span", "place", "stelle", "punkt", "punto", "emplacement")),
    "accuracy": ("m", ("standard deviation", "sigma", "genauigkeit", "précision")),
}  # fmt: skip
"""Unit and headings of each column; its own name is one too."""
_FIELDS = tuple(
    Field(name, unit, frozenset(map(folded, (name, *headings))))
    for name, (unit, headings) in _HEADINGS.items()
)
_QUANTITIES = (
    "contact height", "messenger height", "dropper length", "stagger", "elasticity", "uplift",
)  # fmt: skip
_POINTS = {
    "support": ("support", "mast", "stützpunkt", "poteau", "poste", "sostegno", "stolpe"),
    "middle": ("middle", "mid-span", "mid", "feldmitte", "mitte", "milieu", "centro", "mezzeria",
               "midt", "mitten"),
}  # fmt: skip
"""Words of the column ``point``: the left support of the span, and its middle."""
_WORDS = {folded(word): point for point, words in _POINTS.items() for word in words}
_LARGEST = {"elasticity": (0.05, "m/N", "mm/N"), "uplift": (1.0, "m", "mm")}
"""Values that no line has, five times and more what a contact wire alone does, and the unit that a
heading lacks then."""
MOST_ROWS = 500_000
"""Rows of a survey that are read: rows every 0.25 m of more than 100 km."""
_HEADING_ROWS = 10
"""Rows in which the headings of a sheet are sought, below titles."""


def load_survey(path: str | os.PathLike[str], case: Case, *, accuracy: float = ACCURACY) -> Survey:
    """Load what was measured of the geometry of a line.

    CSV of any dialect or a workbook. A row belongs to a dropper (columns ``span`` and
    ``dropper``, with ``lower wire`` or ``tension length`` where several have these numbers), to a
    support (``support`` or ``mast``), or to a place (``position`` from support 1, or ``chainage``),
    or to the support on the left or the middle of a span (``span`` and ``point``), and holds any of
    ``contact height``, ``messenger height``, ``dropper length``, ``stagger``, ``elasticity`` and
    ``uplift``; ``accuracy`` is its standard deviation.

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
            "'Messenger height [m]', 'Dropper length [mm]', 'Stagger [mm]', 'Elasticity [mm/N]', "
            "'Uplift [mm]')"
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
            _refuse_unlikely(cells)
            place = _place(cells, case)
        except CellError as error:
            problems.append(f"{where}: {error}")
            continue
        own = cells.get("accuracy")
        for name, value in values.items():
            spread = _spread(name, None if own is None else float(own), accuracy)
            quantity, size = cast("Quantity", name), float(value or 0.0)
            found.append(Reading(quantity, size, spread, **place, where=where))
    return found


def _spread(name: str, own: float | None, accuracy: float) -> float:
    """Return the accuracy of a reading, its own or that of all heights and lengths [m]."""
    if name == "elasticity" or (own is None and name == "uplift"):
        return math.nan
    return accuracy if own is None else own


def _refuse_unlikely(values: dict[str, float | str | None]) -> None:
    """Refuse values that no line has or that are in another unit than their heading says.

    Raises
    ------
    CellError
        Naming every such cell of the row.
    """
    problems = []
    own = values.get("accuracy")
    if own is not None and float(own) <= 0.0:
        problems.append(
            f"accuracy of {float(own):g} m; give the standard deviation of the reading, which is "
            "more than 0 (2 to 5 mm by laser), or leave it out for that of --accuracy"
        )
    for name, (largest, unit, usual) in _LARGEST.items():
        value = values.get(name)
        if value is not None and abs(float(value)) > largest:
            problems.append(
                f"{name} of {float(value):g} {unit} is more than any line has; say the unit in the "
                f"heading, as in '{name.capitalize()} [{usual}]'"
            )
        elif name == "elasticity" and value is not None and float(value) <= 0.0:
            problems.append(
                f"elasticity of {1e3 * float(value):g} mm/N; a wire gives way to a force from "
                "below, so that it is more than 0: give uplift by force, or leave the cell empty "
                "where nothing was measured"
            )
    if problems:
        raise CellError("; and ".join(problems))


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
        wire, length = cells.get("lower wire"), cells.get("tension length")
        return {"span": int(span), "dropper": int(dropper), "wire": wire, "tension_length": length}
    point = cells.get("point")
    if span is not None and point is not None:
        return _point(int(span), str(point), case)
    if support is not None:
        return {"support": int(support)}
    mast = cells.get("mast")
    if mast is not None:
        names = case.line.support_marks()
        if mast not in names:
            raise CellError(f"names mast {mast}, which the line does not have (line.masts)")
        if names.count(mast) > 1:
            raise CellError(
                f"names mast {mast}, as {names.count(mast)} supports are called; give the number "
                "of the support, in a column 'Support'"
            )
        return {"support": names.index(str(mast)) + 1}
    if cells.get("position") is not None:
        return {"s": float(cells["position"] or 0.0)}
    if cells.get("chainage") is not None:
        return {"s": case.line.distance(float(cells["chainage"] or 0.0))}
    raise CellError(
        "says no place; give span and dropper, span and point (support or mid-span), a support or "
        "mast, a position or a chainage"
    )


def _point(span: int, text: str, case: Case) -> dict[str, Any]:
    """Return where the left support or the middle of a span is.

    Raises
    ------
    CellError
        When the word is not known, or the line does not have the span.
    """
    point = _WORDS.get(folded(text))
    if point is None:
        raise CellError(f"the point {text!r} is neither 'support' nor 'mid-span'")
    if not 1 <= span <= case.line.spans:
        raise CellError(f"names span {span}; the line has {case.line.spans}")
    ends = case.line.support_positions()[span - 1 : span + 1]
    return {"support": span} if point == "support" else {"s": 0.5 * sum(ends)}
