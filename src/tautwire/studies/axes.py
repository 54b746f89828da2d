"""Axes of a study written out: the values of each, as overrides and as coordinates."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin

import numpy as np

from tautwire.inputs.merge import EXCLUSIVE
from tautwire.inputs.paths import PathError, Target, find_target, parse_path
from tautwire.specs.study import MOST_VALUES, Range, Seeds, Spread, Study, Variants
from tautwire.studies import columns
from tautwire.text import shown
from tautwire.units import TEMPERATURE, UnitError, parse_quantity

Coordinate = float | int | str
SAMPLE, CASE = "sample", "case"

_WRITTEN = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*", re.DOTALL)
_RESERVED = frozenset({*columns.NAMES, *columns.TEXTS, CASE, SAMPLE})


@dataclass(frozen=True)
class AxisValues:
    """One axis of a study, written out.

    Attributes
    ----------
    name : str
        Short name, different for every axis: the last step of the path.
    path : str
        Path of the value in the case; the name of the axis for variants.
    unit : str
        SI unit of the coordinates; empty for numbers without unit and for texts.
    coordinates : tuple of float, int or str
        Value of every step: SI numbers, or texts for what is not a number.
    changes : tuple of mapping
        Overrides of every step, as the user wrote the values.
    """

    name: str
    path: str
    unit: str
    coordinates: tuple[Coordinate, ...]
    changes: tuple[Mapping[str, Any], ...]

    @property
    def is_numeric(self) -> bool:
        """True when every coordinate is a number."""
        return all(isinstance(value, (int, float)) for value in self.coordinates)


@dataclass(frozen=True)
class Dimension:
    """Axes that move together; the cases of a study are the product of its dimensions.

    Attributes
    ----------
    name : str
    axes : tuple of AxisValues
        All of the same length.
    """

    name: str
    axes: tuple[AxisValues, ...]

    @property
    def size(self) -> int:
        """Number of steps."""
        return len(self.axes[0].coordinates)


class AxisError(ValueError):
    """An axis cannot be written out; the message names it."""


def write_out(study: Study) -> tuple[tuple[Dimension, ...], list[str]]:
    """Write out the axes of a study.

    Parameters
    ----------
    study

    Returns
    -------
    dimensions : tuple of Dimension
        In the order of the study; empty when there are problems.
    problems : list of str
        Every fault of every axis.
    """
    problems: list[str] = []
    given: dict[str, Sequence[Any]] = {}
    drawn = [name for name, axis in study.axes.items() if isinstance(axis, Spread)]
    for path, axis in study.axes.items():
        try:
            given[path] = _values(path, axis)
        except (AxisError, PathError, UnitError) as error:
            problems.append(f"axes.{path}: {error}")
    if not problems and drawn:
        given |= _drawn(study, {path: given[path] for path in drawn})
    written: list[AxisValues] = []
    names = _short_names(list(study.axes))
    for path, values in given.items():
        try:
            written.append(_written_out(names[path], path, study.axes[path], values))
        except (AxisError, PathError, UnitError) as error:
            problems.append(f"axes.{path}: {error}")
    problems += _overlaps(list(given))
    problems += _size_problems(study, written, drawn) if not problems else []
    return (() if problems else _dimensions(study, written, drawn)), problems


def _values(path: str, axis: Any) -> Sequence[Any]:
    """Return the values of an axis as overrides take them; the two ends of an interval."""
    if isinstance(axis, Range):
        return _range(path, axis)
    if isinstance(axis, Spread):
        return _interval(path, axis)
    if isinstance(axis, Seeds):
        return range(axis.first, axis.first + axis.seeds)
    if isinstance(axis, Variants):
        return list(axis.variants)
    return axis


def _range(path: str, axis: Range) -> list[Any]:
    """Write out a range in the unit in which it is given, so that values are as one writes them.

    "200 km/h" to "320 km/h" by "40 km/h" gives "240 km/h", which is the case one gets by writing
    that speed by hand.
    """
    numbers, unit, is_whole = _numbers_of_range(path, axis)
    first, last = numbers[:2]
    if axis.count is not None:
        if axis.count == 1 and first != last:
            raise AxisError("has a count of 1 between two different ends; give 2 or more")
        if axis.scale == "log" and not (first > 0.0 and last > 0.0):
            raise AxisError("a 'log' scale needs ends above 0")
        spread = np.geomspace if axis.scale == "log" else np.linspace
        values = spread(first, last, axis.count).tolist()
    else:
        step = numbers[2]
        if step == 0.0 or (last - first) / step < -1e-9:
            raise AxisError("the step does not lead from 'from' to 'to'")
        count = math.floor((last - first) / step + 1e-9) + 1
        if count > MOST_VALUES:
            raise AxisError(f"has {count} values; at most {MOST_VALUES} cases are computed")
        values = [first + step * number for number in range(count)]
    return [_written(value, unit, is_whole=is_whole) for value in values]


def _numbers_of_range(path: str, axis: Range) -> tuple[list[float], str, bool]:
    """Return both ends and the step, if any; that of temperatures is a difference."""
    ends = [axis.first, axis.last]
    if axis.step is None:
        return _numbers(path, ends)
    quantity = find_target(parse_path(path)).quantity
    if quantity is not None and quantity.unit == TEMPERATURE:
        temperatures = [parse_quantity(end, TEMPERATURE) for end in ends]
        return [*temperatures, parse_quantity(axis.step, "K")], TEMPERATURE, False
    return _numbers(path, [*ends, axis.step])


def _interval(path: str, axis: Spread) -> list[Any]:
    numbers, unit, is_whole = _numbers(path, [axis.low, axis.high])
    if not numbers[0] < numbers[1]:
        raise AxisError("low must lie below high")
    if axis.scale == "log" and numbers[0] <= 0.0:
        raise AxisError("a 'log' scale needs a low end above 0")
    return [_written(value, unit, is_whole=is_whole) for value in numbers]


def _numbers(path: str, given: Sequence[Any]) -> tuple[list[float], str, bool]:
    """Return numbers, the unit they are in, and whether the field holds whole numbers."""
    target = find_target(parse_path(path))
    if target.quantity is None:
        if any(isinstance(value, str) for value in given):
            raise AxisError("holds no quantity; ranges need plain numbers here")
        return [float(value) for value in given], "", _holds_integers(target)
    parts = [_split(value) for value in given]
    units = {unit for _, unit in parts}
    if len(units) == 1:
        for value in given:
            parse_quantity(value, target.quantity.unit)
        return [number for number, _ in parts], units.pop(), False
    return [parse_quantity(value, target.quantity.unit) for value in given], "", False


def _split(value: Any) -> tuple[float, str]:
    if not isinstance(value, str):
        return float(value), ""
    match = _WRITTEN.fullmatch(value)
    if match is None:
        raise UnitError(f"got {shown(value)}, not a number with a unit")
    return float(match.group(1)), match.group(2)


def _written(value: float, unit: str, *, is_whole: bool) -> Any:
    if is_whole:
        if abs(value - round(value)) > 1e-9:
            raise AxisError(f"gives {value:g}; whole numbers are needed here")
        return round(value)
    number = float(f"{value:.12g}")
    return f"{number!r} {unit}" if unit else number


def _holds_integers(target: Target) -> bool:
    return target.field is not None and _is_whole(target.field.annotation)


def _is_whole(annotation: Any) -> bool:
    """Return whether a type, without its annotations or None beside it, is that of integers."""
    if get_origin(annotation) in (Union, UnionType, Annotated):
        return any(_is_whole(part) for part in get_args(annotation))
    return annotation is int


def _drawn(study: Study, ends: Mapping[str, Sequence[Any]]) -> dict[str, list[Any]]:
    """Draw the Latin hypercube of all axes with {low, high}.

    Each axis is cut into as many equal parts as there are samples, and every part is met once.
    """
    random, count = np.random.default_rng(study.seed), study.samples or 1
    order = np.stack([random.permutation(count) for _ in ends], axis=1)
    unit_cube = (order + random.random(order.shape)) / count
    drawn = {}
    for column, (path, pair) in zip(unit_cube.T, ends.items(), strict=True):
        numbers, unit, is_whole = _numbers(path, pair)
        low, high = numbers
        if is_whole:
            values = np.floor(low + (high - low + 1.0) * column)
        elif getattr(study.axes[path], "scale", "linear") == "log":
            values = low * (high / low) ** column
        else:
            values = low + (high - low) * column
        drawn[path] = [_written(value, unit, is_whole=is_whole) for value in values.tolist()]
    return drawn


def _written_out(name: str, path: str, axis: Any, values: Sequence[Any]) -> AxisValues:
    """Check an axis and attach overrides and coordinates."""
    if isinstance(axis, Variants):
        changes = tuple(axis.variants[str(label)] for label in values)
        for change in changes:
            for inner in change:
                find_target(parse_path(inner))
        return AxisValues(name, path, "", tuple(str(label) for label in values), changes)
    target = find_target(parse_path(path))
    coordinates = tuple(_coordinate(target, value) for value in values)
    unit = target.quantity.unit if target.quantity is not None else ""
    if not all(isinstance(value, (int, float)) for value in coordinates):
        unit, coordinates = "", tuple(_label(value) for value in values)
    repeated = [v for n, v in enumerate(coordinates) if v in coordinates[:n]]
    if repeated and not isinstance(axis, Spread):
        raise AxisError(f"holds {repeated[0]!r} twice; keep one")
    return AxisValues(name, path, unit, coordinates, tuple({path: value} for value in values))


def _coordinate(target: Target, value: Any) -> Coordinate:
    """Return an SI number where the field holds a quantity; a text for lists and words."""
    is_plain = isinstance(value, (int, float, str)) and not isinstance(value, bool)
    if target.quantity is not None and is_plain and not _is_word(value):
        return parse_quantity(value, target.quantity.unit)
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return value
    return _label(value)


def _is_word(value: Any) -> bool:
    return isinstance(value, str) and not re.match(r"\s*[+\-\u2212.\d]", value)


def _label(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False, default=str)


def _short_names(paths: Sequence[str]) -> dict[str, str]:
    """Return a name for every axis that is short and different from all others."""
    last = {path: _identifier(path.split(".")[-1]) for path in paths}
    taken = list(last.values())
    return {
        path: _identifier(path) if taken.count(name) > 1 or name in _RESERVED else name
        for path, name in last.items()
    }


def _identifier(text: str) -> str:
    return re.sub(r"\W+", "_", text).strip("_") or "axis"


def _overlaps(paths: Sequence[str]) -> list[str]:
    """Name the axes that overwrite each other."""
    problems = []
    for number, path in enumerate(paths):
        parent, _, name = path.rpartition(".")
        rivals = {f"{parent}.{b if name == a else a}" for a, b in EXCLUSIVE if name in (a, b)}
        for other in paths[number + 1 :]:
            inner, outer = sorted((path, other), key=len, reverse=True)
            if inner.startswith((f"{outer}.", f"{outer}[")) or other in rivals:
                problems.append(f"axes.{other}: replaces what axes.{path} sets; keep one of them")
    return problems


def _size_problems(study: Study, written: Sequence[AxisValues], drawn: Sequence[str]) -> list[str]:
    sizes = {axis.path: len(axis.coordinates) for axis in written}
    if study.design == "zip":
        if len(set(sizes.values())) > 1:
            listed = ", ".join(f"{path}: {size}" for path, size in sizes.items())
            return [f"axes: with 'design: zip' all need as many values ({listed})"]
        return []
    total = math.prod(size for path, size in sizes.items() if path not in drawn)
    total *= study.samples or 1
    if total > MOST_VALUES:
        return [f"axes: they give {total} cases; at most {MOST_VALUES} are computed"]
    return []


def _dimensions(
    study: Study, written: Sequence[AxisValues], drawn: Sequence[str]
) -> tuple[Dimension, ...]:
    order = {path: number for number, path in enumerate(study.axes)}
    axes = sorted(written, key=lambda axis: order[axis.path])
    if study.design == "zip":
        return (Dimension(CASE, tuple(axes)),)
    dimensions = [Dimension(axis.name, (axis,)) for axis in axes if axis.path not in drawn]
    if drawn:
        together = tuple(axis for axis in axes if axis.path in drawn)
        dimensions.append(Dimension(SAMPLE, together))
    return tuple(dimensions)
