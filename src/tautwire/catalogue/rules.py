"""How numbers of the catalogue follow from others; each rule says itself in words.

The rules work on the plain data of an entry before it is validated: what is stated is left alone,
what is missing and can be derived is added with its rule as its origin.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from tautwire.units import UnitError, parse_quantity

Rule = tuple[str, tuple[str, ...], Callable[..., tuple[float, str]]]
"""What is derived, what it needs, and the function that returns the value and how."""

COPPER_DENSITY = 8900.0
"""Density of hard-drawn copper and its low alloys [kg/m3], as vendors' sheets use it on the nominal
section (8.89 to 8.9; Chinese sheets 8.94 on the computed section)."""
LAY = {7: 1.014, 19: 1.018, 37: 1.020}
"""Extra length of the wires by their number: mass per metre of DIN 48201-1 copper ropes over
section and density (50/7, 120/19 and 185/37)."""
STRENGTH_FACTOR = 0.97
"""Least breaking load over nominal section times least tensile strength: gives every breaking load
that the sheet with the table of EN 50149 prints (36.3, 38.4, 45.1 and 41.9 kN)."""

_UNITS = {
    "section": "m^2",
    "elasticity": "Pa",
    "tensile_strength": "Pa",
    "wire_strength": "Pa",
    "wire_diameter": "m",
}


def axial_stiffness(elasticity: float, section: float) -> tuple[float, str]:
    """Return EA [N]."""
    return elasticity * section, f"E x section = {_gpa(elasticity)} x {_mm2(section)}"


def bending_of_circle(elasticity: float, section: float) -> tuple[float, str]:
    """Return E A^2 / 4 pi [N m2], the bending stiffness of the circle of equal area."""
    how = f"E A^2 / 4 pi, circle of equal area: {_gpa(elasticity)}, {_mm2(section)}"
    return elasticity * section**2 / (4.0 * math.pi), how


def breaking_load(section: float, tensile_strength: float) -> tuple[float, str]:
    """Return the least breaking load of a contact wire [N]."""
    how = f"{STRENGTH_FACTOR} x {_mm2(section)} x {tensile_strength / 1e6:g} N/mm2"
    return STRENGTH_FACTOR * section * tensile_strength, how


def rope_section(wires: int, wire_diameter: float) -> tuple[float, str]:
    """Return the section of all wires of a rope [m2]."""
    how = f"{wires} wires of {1e3 * wire_diameter:g} mm"
    return wires * math.pi * wire_diameter**2 / 4.0, how


def rope_diameter(wires: int, wire_diameter: float) -> tuple[float, str]:
    """Return the outer diameter [m]: a core wire and full layers around it."""
    layers = len(layers_of(wires)) - 1
    how = f"{2 * layers + 1} wires of {1e3 * wire_diameter:g} mm side by side"
    return (2 * layers + 1) * wire_diameter, how


def rope_mass(wires: int, section: float) -> tuple[float, str]:
    """Return the mass of a copper rope [kg/m], its wires longer than the rope by their lay."""
    lay = LAY.get(wires, LAY[37])
    how = f"{_mm2(section)} x {COPPER_DENSITY / 1e3:g} kg/dm3 x {lay:g} for the lay"
    return section * COPPER_DENSITY * lay, how


def rope_strength(section: float, wire_strength: float) -> tuple[float, str]:
    """Return the breaking load of a rope [N], all wires alike."""
    return section * wire_strength, f"{_mm2(section)} x {wire_strength / 1e6:g} N/mm2"


def slip_bending(wires: int, wire_diameter: float, elasticity: float) -> tuple[float, str]:
    """Return n E pi d^4 / 64 [N m2]: every wire bends about its own axis."""
    own = math.pi * wire_diameter**4 / 64.0
    return wires * elasticity * own, f"{wires} wires that slip: n E pi d^4 / 64"


def stick_bending(wires: int, wire_diameter: float, elasticity: float) -> tuple[float, str]:
    """Return the bending stiffness [N m2] of a rope that bends as one body.

    A layer k of m wires with their axes at the radius k d adds m A (k d)^2 / 2 to the second moment
    of the wires themselves; lay and contact are neglected.
    """
    area = math.pi * wire_diameter**2 / 4.0
    second = wires * math.pi * wire_diameter**4 / 64.0
    for k, m in enumerate(layers_of(wires)):
        second += m * area * (k * wire_diameter) ** 2 / 2.0
    how = f"{wires} wires that stick, {_gpa(elasticity)}: n E pi d^4 / 64 + sum m E A (k d)^2 / 2"
    return elasticity * second, how


def layers_of(wires: int) -> list[int]:
    """Return the wires of each layer, the core wire first.

    Raises
    ------
    ValueError
        When they do not fill the layers 1, 6, 12, 18 ...
    """
    layers = [1]
    while sum(layers) < wires:
        layers.append(6 * len(layers))
    if sum(layers) != wires:
        raise ValueError(
            f"wires: {wires} do not fill the layers 1 + 6 + 12 + 18 ...; state section, diameter, "
            "mass and both bending stiffnesses"
        )
    return layers


_EA: Rule = ("axial_stiffness", ("elasticity", "section"), axial_stiffness)
CONTACT_WIRE: tuple[Rule, ...] = (
    _EA,
    ("bending_stiffness", ("elasticity", "section"), bending_of_circle),
    ("strength", ("section", "tensile_strength"), breaking_load),
)
ROPE: tuple[Rule, ...] = (
    ("section", ("wires", "wire_diameter"), rope_section),
    ("diameter", ("wires", "wire_diameter"), rope_diameter),
    ("mass", ("wires", "section"), rope_mass),
    ("strength", ("section", "wire_strength"), rope_strength),
    _EA,
    ("bending_stiffness", ("wires", "wire_diameter", "elasticity"), stick_bending),
    ("bending_stiffness_slip", ("wires", "wire_diameter", "elasticity"), slip_bending),
)
DROPPER: tuple[Rule, ...] = (_EA,)


def complete(data: Any, rules: tuple[Rule, ...]) -> Any:
    """Return the data of an entry with what its rules add to it.

    Parameters
    ----------
    data
        Plain data of one entry; returned as it is when it is no mapping.
    rules
        In the order in which they are tried.
    """
    if not isinstance(data, Mapping):
        return data
    result = dict(data)
    for name, needs, rule in rules:
        if name in result or not all(need in result for need in needs):
            continue
        known = {need: _plain(need, result[need]) for need in needs}
        if all(value is not None for value in known.values()):
            value, how = rule(**known)
            result[name] = {"value": value, "derived": how}
    return result


def _plain(name: str, stated: Any) -> float | None:
    """Return a stated value in SI; None when it is not valid, which validation tells."""
    if name == "wires":
        return stated if isinstance(stated, int) else None
    try:
        return parse_quantity(stated["value"], _UNITS[name])
    except (UnitError, TypeError, KeyError):
        return None


def _gpa(value: float) -> str:
    return f"{value / 1e9:g} GPa"


def _mm2(value: float) -> str:
    return f"{value * 1e6:.5g} mm2"
