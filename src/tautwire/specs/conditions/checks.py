"""Checks of conditions against the rest of the case."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import starmap

from tautwire.specs.base import Problem
from tautwire.specs.conditions.condition import Condition, Exposure, WireChange
from tautwire.specs.conditions.defect import Defect
from tautwire.specs.line.catenary import Line
from tautwire.specs.line.dropper import Droppers
from tautwire.specs.line.tension import TensionLength
from tautwire.specs.line.wire import Wire, Wires
from tautwire.specs.scenario import Scenario

Path = tuple[str | int, ...]
Part = tuple[Path, Wire | Droppers, Exposure]
_EXAMPLES = {"thermal_expansion": "'17e-6 1/K'", "diameter": "'12 mm'"}


def check_conditions(
    conditions: tuple[Condition, ...],
    condition: str | None,
    wires: Wires,
    droppers: Droppers | tuple[Droppers, ...],
) -> list[Problem]:
    """Check names, and that the wires say what temperature, wind and ice need."""
    names = [one.name for one in conditions]
    problems = [
        Problem(("conditions", number, "name"), f"got {name!r} again")
        for number, name in enumerate(names)
        if name in names[:number]
    ]
    if condition is not None and condition not in names:
        listed = ", ".join(names) if names else "none; describe them under 'conditions'"
        problems.append(Problem(("condition",), f"got {condition!r}; the conditions are: {listed}"))
    for number, one in enumerate(conditions):
        path: Path = ("conditions", number)
        if one.after is not None and one.after not in names[:number]:
            text = f"got {one.after!r}; name a condition that is listed before this one"
            problems.append(Problem((*path, "after"), text))
        problems += _check_wire_names(one, wires, path)
    return problems + missing_numbers(conditions, wires, droppers)


def _check_wire_names(one: Condition, wires: Wires, path: Path) -> list[Problem]:
    known, problems = dict(wires.named()), []
    for name, change in one.changed_wires:
        if name not in known:
            text = f"is no wire of the case; there are {', '.join(known)}"
            problems.append(Problem((*path, "wires", name), text))
        elif change.wear is not None and known[name].role != "contact":
            problems.append(
                Problem((*path, "wires", name, "wear"), "belongs to contact wires only")
            )
        elif change.tension is not None and known[name].role == "stitch":
            text = "belongs to wires with ends of their own; a stitch wire is clamped"
            problems.append(Problem((*path, "wires", name, "tension"), text))
    for index, defect in enumerate(one.defects):
        if defect.wire is not None and defect.wire not in known:
            text = f"got {defect.wire!r}; there are the wires {', '.join(known)}"
            problems.append(Problem((*path, "defects", index, "wire"), text))
    return problems


def _parts(
    one: Condition, wires: Wires, droppers: Droppers | tuple[Droppers, ...]
) -> Iterator[Part]:
    """Yield every wire and set of droppers with its path and what is said for it alone."""
    changes = dict(one.changed_wires)
    for name, wire in wires.named():
        yield ("wires", name), wire, changes.get(name, WireChange())
    if isinstance(droppers, tuple):
        for index, many in enumerate(droppers):
            yield ("droppers", index), many, one.droppers
    else:
        yield ("droppers",), droppers, one.droppers


def missing_numbers(
    conditions: Sequence[Condition], wires: Wires, droppers: Droppers | tuple[Droppers, ...]
) -> list[Problem]:
    """Return what wires do not say and conditions ask for, each once; it is never assumed."""
    asked: dict[Path, dict[str, list[str]]] = {}
    for one in conditions:
        for at, part, change in _parts(one, wires, droppers):
            ice = one.ice_on(change, is_dropper=isinstance(part, Droppers))
            needs = (
                ("thermal_expansion", one.warming(change) != 0.0, "another temperature"),
                ("diameter", one.wind_pressure(change) != 0.0, "wind"),
                ("diameter", ice is not None, "ice"),
            )
            for field, is_needed, reason in needs:
                if is_needed and getattr(part, field) is None:
                    asked.setdefault((*at, field), {}).setdefault(reason, []).append(one.name)
    return [
        Problem(
            path,
            f"is missing: {', '.join(starmap(_told, reasons.items()))}; give it, for example "
            f"{_EXAMPLES[str(path[-1])]}, or take the catalogue's with 'use'",
        )
        for path, reasons in asked.items()
    ]


def _told(reason: str, names: list[str]) -> str:
    """Return which conditions have a reason to ask for a number."""
    quoted = ", ".join(repr(name) for name in names)
    return (
        f"the condition{'s'[: len(names) > 1]} {quoted} {'have' if names[1:] else 'has'} {reason}"
    )


def check_slowed_waves(
    conditions: tuple[Condition, ...], wires: Wires, scenario: Scenario
) -> list[Problem]:
    """Check that no condition slows the waves on a contact wire below the train."""
    problems = []
    known = dict(wires.named())
    for number, one in enumerate(conditions):
        for name, change in one.changed_wires:
            wire = known.get(name)
            if wire is None or wire.role != "contact" or change.tension is None:
                continue
            speed = math.sqrt(change.tension / wire.mass)
            if scenario.speed >= speed:
                text = (
                    f"got {1e-3 * change.tension:g} kN, with which waves run at "
                    f"{3.6 * speed:.0f} km/h, not faster than the train at "
                    f"{3.6 * scenario.speed:.0f} km/h; raise it or lower scenario.speed"
                )
                path = ("conditions", number, "wires", name, "tension")
                problems.append(Problem(path, text))
    return problems


def check_places(
    line: Line, tension_lengths: tuple[TensionLength, ...], conditions: tuple[Condition, ...]
) -> list[Problem]:
    """Check that defects name spans, supports and tension lengths that exist."""
    problems = []
    names = [one.name for one in tension_lengths]
    for number, one in enumerate(conditions):
        for index, defect in enumerate(one.defects):
            found = _misplaced(line, names, defect)
            problems += [problem.under("conditions", number, "defects", index) for problem in found]
    return problems


def _misplaced(line: Line, names: list[str], defect: Defect) -> list[Problem]:
    problems = []
    if defect.span is not None and defect.span > line.spans:
        problems.append(Problem(("span",), f"got {defect.span}; the line has {line.spans} spans"))
    elif defect.span is not None and defect.at is not None:
        length = line.span_lengths()[defect.span - 1]
        if defect.at > length:
            text = f"got {defect.at:g} m, outside the span of {length:g} m"
            problems.append(Problem(("at",), text))
    if defect.support is not None and not 1 < defect.support <= line.spans:
        text = f"got {defect.support}; between the anchors are the supports 2 to {line.spans}"
        problems.append(Problem(("support",), text))
    if defect.tension_length is not None and defect.tension_length not in names:
        listed = ", ".join(names) or "only one, without a name"
        text = f"got {defect.tension_length!r}; tension lengths: {listed}"
        problems.append(Problem(("tension_length",), text))
    elif defect.tension_length is None and defect.end is not None and len(names) > 1:
        text = f"is missing; there are the tension lengths {', '.join(names)}"
        problems.append(Problem(("tension_length",), text))
    return problems
