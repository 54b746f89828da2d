"""Cells as numbers: decimal commas, units in the cell or in the heading, km+m, formula errors."""

from __future__ import annotations

import re
from math import isfinite

from tautwire.tables.columns import ANY, COUNT, DEGREES, TEXT
from tautwire.tables.sheets import UNCALCULATED, Cell
from tautwire.text import shortened, unprintable
from tautwire.units import UnitError, expectation, parse_quantity

ERRORS = ("#DIV/0!", "#N/A", "#NAME?", "#NULL!", "#NUM!", "#REF!", "#VALUE!")
NOTHING = ("", "-", "–", "—", "nan", "n/a", "k.a.", "k. a.", "s.o.", "n.d.", "无效")
_PLAIN = re.compile(r"[+-]?[0-9]+(?:\.[0-9]*)?(?:[eE][+-]?[0-9]+)?")
_LONGEST = 400
"""Characters of a number; the longest that is finite has 309 before its decimal point."""
_KM_M = re.compile(
    r"(?:(?:km|pk|kp|bau-km)\.?\s*)?([0-9]+)\s*\+\s*([0-9]+(?:\.[0-9]+)?)", re.IGNORECASE
)
_SIDES = {
    **dict.fromkeys(("l", "left", "links", "li", "i", "izq", "g", "gauche", "sx", "v"), 1.0),
    **dict.fromkeys(("r", "right", "rechts", "re", "d", "der", "dcha", "droite", "dx", "h"), -1.0),
}
"""Letters behind a lateral position, and its sign: positive to the left."""
_SIDED = re.compile(r"(?P<value>[0-9.,]+\s*(?:mm|cm|m)?)\s+(?P<side>[A-Za-z]+)\.?")
_THOUSANDS = re.compile(r"(?<![0-9])[0-9]{1,3}(\.[0-9]{3})+$")
_THOUSANDS_COMMA = re.compile(r"(?<![0-9])[0-9]{1,3}(,[0-9]{3})+$")
"""Groups of thousands before the decimal sign; with them it is plain which sign is which."""
_RATIO = {"‰": 1e-3, "per mille": 1e-3, "mm/m": 1e-3, "%": 1e-2}
_SPOKEN = {
    "N": {"kg": "kgf", "lb": "lbf", "lbs": "lbf"},
    "m/s^2": {"g": "9.80665 m/s^2"},
}
"""Units as tables write them, by the SI unit of what is meant."""
_LONG = {"kmh": "km/h", "kmph": "km/h", "km/std": "km/h", "sec": "s", "sek": "s", "msec": "ms",
         "ms2": "m/s^2", "mps": "m/s", "meter": "m", "metre": "m", "newton": "N"}  # fmt: skip
"""Units as programs and headings spell them, in small letters."""


class CellError(ValueError):
    """A cell does not hold what its column should."""


def ratio_of(unit: str) -> float | None:
    """Return what a unit of a share is worth; None for other units."""
    return _RATIO.get(unit.strip().lower())


def unit_fits(unit: str, wanted: str) -> bool:
    """Tell whether a heading's unit can be that of a field."""
    if wanted == ANY:
        return True
    if wanted == DEGREES:
        return unit in ("", "°", "deg")
    if wanted in (TEXT, COUNT):
        return not unit
    if not unit or unit.lower() == "km+m" or ratio_of(unit) is not None:
        return not unit or wanted == "m"
    try:
        factor_of(unit, wanted)
    except UnitError:
        return False
    return True


def factor_of(unit: str, wanted: str) -> float:
    """Return what one unit is in SI.

    Raises
    ------
    UnitError
        When it is no unit of what is wanted.
    """
    text = spoken(unit, wanted)
    is_value = text != unit and text[0].isdigit()
    return parse_quantity(text if is_value else f"1 {text}", wanted)


def spoken(unit: str, wanted: str) -> str:
    """Return a unit as the program reads it; ``kg`` and ``lb`` of a tension are forces."""
    unit = _LONG.get(unit.lower(), unit)
    unit = unit.lower() if unit.lower() == "km/h" else unit
    return _SPOKEN.get(wanted, {}).get(unit, unit)


def text_of(cell: Cell) -> str | None:
    """Return a cell as a name; a whole number without its point."""
    if cell is None:
        return None
    _refuse_error(cell)
    if fault := unprintable(str(cell)):
        raise CellError(fault)
    return f"{cell:.15g}" if isinstance(cell, float) else str(cell)


def number_of(cell: Cell, unit: str, wanted: str, *, decimal_comma: bool) -> float | None:
    """Return a cell in SI.

    Parameters
    ----------
    cell
        A number, or a text such as ``"1,25"``, ``"12+300"``, ``"5,3 m"``.
    unit
        Unit of the column; empty for SI.
    wanted
        SI unit of the field, or :data:`COUNT`.
    decimal_comma
        Whether the file writes numbers with a comma; in a cell with one comma and no point it is
        one anyway.

    Raises
    ------
    CellError
        Saying what was got and what was expected.
    """
    if cell is None or (isinstance(cell, str) and cell.lower() in NOTHING):
        return None
    _refuse_error(cell)
    if isinstance(cell, (int, float)) and unit in ("", wanted) and wanted != COUNT:
        return float(cell)
    text = f"{cell:.15g}" if isinstance(cell, (int, float)) else cell
    if isinstance(cell, str):
        text = _with_point(text, decimal_comma=decimal_comma)
    if wanted == COUNT:
        if len(text) > _LONGEST or not re.fullmatch(r"[0-9]{1,6}(\.0*)?", text) or float(text) < 1:
            raise CellError(f"got {shortened(str(cell), 40)!r}; expected a number 1, 2, 3 ...")
        return float(text)
    if wanted == "m" and (match := _KM_M.fullmatch(text)):
        return 1e3 * float(match.group(1)) + float(match.group(2))
    if len(text) > _LONGEST:
        raise CellError(f"got {shortened(text, 40)!r}; expected {expectation(wanted)}")
    if unit in ("", wanted) and _PLAIN.fullmatch(text) and isfinite(value := float(text)):
        return value
    has_unit = bool(re.search(r"[^0-9.eE+\s-]", text))
    own = "" if has_unit or unit.lower() == "km+m" else f" {spoken(unit or wanted, wanted)}"
    try:
        return parse_quantity(text + own, wanted)
    except UnitError:
        raise CellError(
            f"got {shortened(repr(cell), 60)}; expected {expectation(wanted)}"
        ) from None


def side_of(cell: Cell) -> tuple[Cell, float]:
    """Return a lateral position without the letter of its side, and its sign.

    Examples
    --------
    >>> side_of("200 R"), side_of(-0.2)
    (('200', -1.0), (-0.2, 1.0))
    """
    match = _SIDED.fullmatch(cell) if isinstance(cell, str) else None
    sign = _SIDES.get(match["side"].lower()) if match is not None else None
    return (cell, 1.0) if match is None or sign is None else (match["value"].strip(), sign)


def _refuse_error(cell: Cell) -> None:
    if cell == UNCALCULATED:
        text = "holds a formula without a value; open the workbook in its program and save it"
        raise CellError(text)
    if isinstance(cell, str) and cell.upper() in ERRORS:
        raise CellError(f"holds the formula error {cell}; mend the formula")


def _with_point(text: str, *, decimal_comma: bool) -> str:
    text = text.replace("\u00a0", " ").replace("\u2212", "-")
    comma, point = text.rfind(","), text.rfind(".")
    if text.count(",") == 1 and (point < 0 or _THOUSANDS.search(text[:comma])):
        return text.replace(".", "").replace(",", ".")
    if decimal_comma and comma >= 0:
        return text.replace(".", "").replace(",", ".")
    if point > comma >= 0 and _THOUSANDS_COMMA.search(text[:point]):
        return text.replace(",", "")
    return text
