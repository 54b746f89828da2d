"""What validation found, in the words of a person: what was got and what is allowed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tautwire.text import shown

BOUNDS = {
    "greater_than": ("gt", "greater than"),
    "greater_than_equal": ("ge", "at least"),
    "less_than": ("lt", "less than"),
    "less_than_equal": ("le", "at most"),
}
"""By type of fault: the limit's name, and the words before it."""
EXPECTED = {
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "int_parsing": "a whole number",
    "float_type": "a number",
    "float_parsing": "a number",
    "finite_number": "a finite number",
    "bool_type": "true or false",
    "bool_parsing": "true or false",
    "string_type": "a text (put a number in quotes)",
    "tuple_type": "a list, as in [1, 2, 3]",
    "list_type": "a list, as in [1, 2, 3]",
    "dict_type": "a mapping, as in {key: value}",
    "model_type": "a mapping, as in {key: value}",
    "string_too_short": "a text that is not empty",
    "string_too_long": "a shorter text",
    "string_pattern_mismatch": "a name without control characters",
}
"""By type of fault: what should stand there."""


def is_said_elsewhere(fault: Mapping[str, Any]) -> bool:
    """Tell that a list is short only because its items are at fault, of which each is told."""
    limits = fault.get("ctx", {})
    return fault["type"] == "too_short" and len(fault["input"]) >= limits["min_length"]


def words_of(fault: Mapping[str, Any]) -> str:
    """Say one fault of pydantic without its place.

    Parameters
    ----------
    fault
        As ``ValidationError.errors()`` lists it.

    Examples
    --------
    >>> words_of({"type": "less_than_equal", "input": 7, "ctx": {"le": 5.0}, "msg": ""})
    'got 7; must be at most 5'
    """
    kind, limits = fault["type"], fault.get("ctx", {})
    got = f"got {shown(fault['input'])}"
    if isinstance(limits.get("error"), ValueError):
        return str(limits["error"])
    if kind == "missing":
        return "is missing"
    if kind == "extra_forbidden":
        return "unknown key"
    if kind in BOUNDS:
        name, words = BOUNDS[kind]
        return f"{got}; must be {words} {limits[name]:g}"
    if kind == "literal_error":
        return f"{got}; choose {limits['expected']}"
    if kind in ("too_short", "too_long"):
        bound = limits.get("min_length", limits.get("max_length"))
        if not limits["actual_length"]:
            return f"is empty; give at least {bound}"
        side = "at least" if kind == "too_short" else "at most"
        return f"has {limits['actual_length']} values; give {side} {bound}"
    if kind in EXPECTED:
        return f"{got}; expected {EXPECTED[kind]}"
    return f"{got}; {fault['msg'][:1].lower()}{fault['msg'][1:]}"
