"""Values of a figure's data and layout, as arrays, colours and plain texts."""

from __future__ import annotations

import base64
import html
import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

POINTS_PER_PIXEL = 0.55
"""Of lines and symbols: a page is read from half the distance of a screen."""
DASHES: dict[str, Any] = {
    "solid": "-",
    "dash": (0, (5, 3)),
    "dot": (0, (1.2, 1.6)),
    "dashdot": (0, (5, 2, 1.2, 2)),
    "longdash": (0, (8, 3)),
    "longdashdot": (0, (8, 2, 1.2, 2)),
}
SYMBOLS = {
    "circle": "o",
    "square": "s",
    "diamond": "D",
    "triangle-up": "^",
    "x": "X",
    "cross": "P",
    "line-ns": "|",
    "line-ew": "_",
    "cross-thin": "+",
    "x-thin": "x",
}
_RGBA = re.compile(r"rgba?\(([^)]*)\)")


def array(value: Any) -> list[Any] | NDArray[Any]:
    """Return a list, or numbers that are packed as text, in the form they have in the data."""
    if isinstance(value, dict) and "bdata" in value:
        numbers = np.frombuffer(base64.b64decode(value["bdata"]), dtype=value["dtype"])
        shape = value.get("shape")
        return numbers.reshape([int(n) for n in str(shape).split(",")]) if shape else numbers
    return [] if value is None or isinstance(value, dict) else value


def numbers(value: Any) -> NDArray[np.float64]:
    """Return numbers, NaN where there is none."""
    found = array(value)
    if isinstance(found, np.ndarray):
        return found.astype(float)
    return np.array([np.nan if item is None else item for item in found], dtype=float)


def is_words(value: Any) -> bool:
    """Tell whether positions along an axis are names."""
    found = array(value)
    return isinstance(found, list) and any(isinstance(item, str) for item in found)


def plain(text: Any) -> str:
    """Return a text of a figure without its HTML; line breaks stay."""
    broken = re.sub(r"<br\s*/?>", "\n", str(text))
    # a dollar sign would begin a formula
    return html.unescape(re.sub(r"</?[a-zA-Z][^>]*>", "", broken)).replace("$", r"\$")


def colour(value: Any, default: str = "#16202b") -> Any:
    """Return a colour: a name, a number sign with digits, or red, green, blue and opacity."""
    if not isinstance(value, str):
        return default
    match = _RGBA.fullmatch(value.strip())
    if match is None:
        return value
    parts = [float(part) for part in match[1].split(",")]
    return (*(part / 255.0 for part in parts[:3]), *parts[3:])


def dash(value: Any) -> Any:
    """Return the dash of a line."""
    return DASHES.get(str(value), "-")


def symbol(value: Any) -> tuple[str, bool]:
    """Return a symbol, and whether it is hollow."""
    name = str(value or "circle")
    return SYMBOLS.get(name.removesuffix("-open"), "o"), name.endswith("-open")
