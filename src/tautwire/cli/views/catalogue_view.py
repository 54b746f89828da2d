"""Entries of the catalogue as tables and as plain data."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import groupby
from typing import Any

from tautwire.catalogue.numbers import Number
from tautwire.catalogue.parts import Part
from tautwire.cli.views.tables import facts, heading, table
from tautwire.units import to_unit

_COLUMNS: dict[str, tuple[str, ...]] = {
    "contact wire": ("diameter", "mass", "axial_stiffness", "bending_stiffness", "strength"),
    "rope": ("diameter", "mass", "axial_stiffness", "bending_stiffness", "strength"),
    "dropper": ("mass", "axial_stiffness", "stiffness"),
    "dropper clamps": ("clamp_contact", "clamp_messenger"),
    "clamp": ("mass",),
    "steady arm": ("length", "mass"),
    "cantilever": ("arm_length", "arm_mass", "clamp"),
    "pantograph": ("static_force",),
}
"""Numbers shown in the list, by kind."""
_HEADS = {
    "axial_stiffness": "EA",
    "bending_stiffness": "EI",
    "bending_stiffness_slip": "EI, wires slip",
    "clamp_contact": "at contact wire",
    "clamp_messenger": "at messenger",
}
_UNITS = {
    "diameter": "mm",
    "mass": "kg/m",
    "axial_stiffness": "MN",
    "strength": "kN",
    "bending_stiffness": "N m^2",
    "stiffness": "kN/m",
}
"""Units of the columns of the list; others carry theirs in every cell."""
_SHORT = {"diameter": "d"}
_PURE = {"thermal_expansion": "1/K"}
"""Units that a number does not carry in its text."""


def listing(parts: Iterable[Part]) -> list[Any]:
    """Return one table per kind."""
    shown: list[Any] = []
    for kind, group in groupby(parts, key=lambda part: part.kind):
        columns = _COLUMNS[kind]
        units = [_unit(kind, column) for column in columns]
        heads = [f"{_SHORT.get(c) or _head(c)}\n{u}" for c, u in zip(columns, units, strict=True)]
        rows = [_row(part, columns, units) for part in group]
        title = "also called, or what it is"
        grid = table(("name", *heads, title), "l" + "r" * len(columns) + "L", rows)
        shown += [heading(kind), grid]
    return shown


def details(part: Part) -> list[Any]:
    """Return every number of an entry with its origin; documents are numbered below."""
    pairs = [("kind", part.kind), ("what", part.summary)]
    if part.aliases:
        pairs.append(("also called", ", ".join(part.aliases)))
    marks: dict[str, str] = {}
    rows = []
    for key, number in part.numbers().items():
        if number.confidence == "seen":
            named = [marks.setdefault(text, f"[{len(marks) + 1}]") for text in number.origins]
            origin = " ".join((*named, number.note)).rstrip()
        else:
            origin = "; ".join(filter(None, (number.source, number.note)))
        rows.append((_head(key), _value(key, number), number.confidence, origin))
    numbers = table(("", "value", "", "where from"), "lllL", rows)
    documents = [heading("Sources"), facts((mark, text) for text, mark in marks.items())]
    return [heading(part.name), facts(pairs), numbers, *(documents if marks else [])]


def as_data(part: Part) -> dict[str, Any]:
    """Return an entry as plain data in SI units."""
    numbers = {
        key: {
            "value": number.value,
            "unit": number.unit or _PURE.get(key, ""),
            "confidence": number.confidence,
            "source": number.source,
            "range": None if number.low is None else [number.low, number.high],
            "note": number.note,
        }
        for key, number in part.numbers().items()
    }
    return {
        "name": part.name,
        "kind": part.kind,
        "aliases": list(part.aliases),
        "summary": part.summary,
        "numbers": numbers,
    }


def _row(part: Part, columns: Sequence[str], units: Sequence[str]) -> tuple[str, ...]:
    numbers = part.numbers()
    cells = []
    for column, unit in zip(columns, units, strict=True):
        number = numbers.get(column)
        if number is None:
            cells.append("")
        else:
            cells.append(f"{to_unit(number.value, unit):.4g}" if unit else number.text())
    return part.name, *cells, ", ".join(part.aliases) or part.summary.rstrip(".")


def _unit(kind: str, column: str) -> str:
    return "kg" if (kind, column) == ("clamp", "mass") else _UNITS.get(column, "")


def _value(key: str, number: Number) -> str:
    value, _, unit = number.text().partition(" ")
    text = f"{float(value):.5g} {unit or _PURE.get(key, '')}".rstrip()
    if number.low is None or number.high is None:
        return text
    low, high = (number.in_words(v).partition(" ")[0] for v in (number.low, number.high))
    return f"{text} ({low} to {high})"


def _head(key: str) -> str:
    return _HEADS.get(key, key.replace("_", " "))
