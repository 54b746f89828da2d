"""Cells as numbers: decimal commas, units in the cell or in the heading, km+m, formula errors."""

from __future__ import annotations

import re
from math import isfinite

from tautwire.tables.columns import ANY, COUNT, DEGREES, TEXT
from tautwire.tables.sheets import Cell
from tautwire.text import shortened, unprintable
from tautwire.units import UnitError, expectation, parse_quantity

ERRORS = ("#DIV/0!", "#N/A", "#NAME?", "#NULL!", "#NUM!", "#REF!", "#VALUE!")
NOTHING = ("", "-", "–", "—", "nan", "n/a", "k.a.", "k. a.", "s.o.", "n.d.", "无效")
_PLAIN = re.compile(r"[+-]?[0-9]+(?:\.[0-9]*)?(?:[eE][+-]?[0-9]+)?")
_LONGEST = 400
"""Characters of a number; the longest that is finite has 309 before its decimal point."""
_KM_M = re.compile(r"([0-9]+)\s*\+\s*([0-9]+(?:\.[0-9]+)?)")
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


def _refuse_error(cell: Cell) -> None:
    if isinstance(cell, str) and cell.upper() in ERRORS:
        raise CellError(f"holds the formula error {cell}; mend the formula")


def _with_point(text: str, *, decimal_comma: bool) -> str:
    text = text.replace("\u00a0", " ").replace("\u2212", "-")
    if text.count(",") == 1 and "." not in text:
        return text.replace(",", ".")
    if decimal_comma and "," in text:
        return text.replace(".", "").replace(",", ".")
    return text
