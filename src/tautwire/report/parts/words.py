"""Numbers and enumerations as a person reads them."""

from __future__ import annotations

import math
from collections.abc import Sequence

from tautwire.results.accuracy import last_place

MISSING = "–"
SPACE = "\N{NO-BREAK SPACE}"


def band(name: str) -> str:
    """Return a band named ``"5_20"`` as it is read, 5–20 Hz."""
    return f"{name.replace('_', '–')}{SPACE}Hz"


def number(value: float | None, digits: int = 1) -> str:
    """Return a number with a fixed count of decimals, a dash where there is none."""
    if value is None or not math.isfinite(value):
        return MISSING
    text = f"{value:.{digits}f}"
    if float(text) == 0.0:
        text = text.lstrip("-")
    return text.replace("-", "\N{MINUS SIGN}")


def quantity(value: float | None, unit: str, digits: int = 1, error: float = math.nan) -> str:
    """Return a number with its numerical error and its unit, a dash where there is none."""
    text = with_error(value, error, digits)
    return text if text == MISSING or not unit else f"{text}{SPACE}{unit}"


def with_error(value: float | None, error: float, digits: int = 1) -> str:
    """Return a number with its numerical error, and no digit that the error makes worthless.

    Parameters
    ----------
    value : float or None
    error : float
        Half width of the error bar, rounded up to one digit (two where the first is 1); NaN where
        none is known, for a number by itself.
    digits : int
        Most decimals.

    Examples
    --------
    >>> with_error(52.378, 0.32, 2)
    '52.4 ± 0.4'
    >>> with_error(294.3, 12.0)
    '294 ± 12'
    """
    if value is None or not math.isfinite(value) or not math.isfinite(error):
        return number(value, digits)
    place = max(last_place(error), -digits) if error > 0.0 else -digits
    unit = 10.0**place
    width = math.ceil(error / unit - 1e-9) * unit  # what rounding has added is taken off first
    decimals = max(0, -place)
    return f"{number(round(value / unit) * unit, decimals)} ± {number(width, decimals)}"


def readable(value: float | None, unit: str, error: float = math.nan) -> str:
    """Return an SI number in the unit people use for it.

    Parameters
    ----------
    value : float or None
    unit : str
        ``"N"``, ``"m"``, ``"%"`` or ``"1"``.
    error : float
        Half width of the numerical error bar in the same unit; NaN where none is known.
    """
    if unit == "m":
        return quantity(None if value is None else 1e3 * value, "mm", 1, 1e3 * error)
    if unit == "m/N":
        return quantity(None if value is None else 1e3 * value, "mm/N", 4, 1e3 * error)
    if unit == "%":
        return quantity(value, "%", 2, error)
    if unit == "1":
        return quantity(value, "", 3, error)
    return quantity(value, unit, 1, error)


def speed(value: float) -> str:
    """Return a speed in km/h."""
    return f"{round(3.6 * value, 2):g}{SPACE}km/h"


def compact(value: float) -> str:
    """Return a number without superfluous digits."""
    return f"{value:.7g}"


def listing(items: Sequence[str], last: str = "and") -> str:
    """Join items as in a sentence."""
    if len(items) < 2:
        return "".join(items)
    return f"{', '.join(items[:-1])} {last} {items[-1]}"


def counted(count: int, noun: str) -> str:
    """Return a count with its noun in singular or plural."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"
