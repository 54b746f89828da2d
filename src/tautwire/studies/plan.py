"""From a study to its cases: every combination, validated and keyed."""

from __future__ import annotations

import hashlib
import itertools
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from tautwire.errors import InputError
from tautwire.inputs.composition import compose
from tautwire.inputs.load import make_case
from tautwire.specs.case import Case
from tautwire.specs.project import Project
from tautwire.specs.study import Study
from tautwire.studies.axes import Coordinate, Dimension, write_out
from tautwire.version import __version__

ROW_FORMAT = 1
"""Changes with what is computed per case; rows of another format are computed again."""


@dataclass(frozen=True)
class Point:
    """One combination of values.

    Attributes
    ----------
    number : int
        From 1, the last axis varying fastest.
    index : tuple of int
        0-based position on every dimension.
    changes : mapping
        Overrides of the base case.
    key : str
        What identifies its result; empty when validation refused the combination.
    problems : tuple of str
        Why it was refused.
    """

    number: int
    index: tuple[int, ...]
    changes: Mapping[str, Any]
    key: str
    problems: tuple[str, ...] = ()


@dataclass(frozen=True)
class Shard:
    """One of several parts of a study, for processes that know nothing of each other.

    Attributes
    ----------
    number : int
        From 1.
    count : int
        Parts in all.
    """

    number: int
    count: int

    @classmethod
    def parse(cls, text: str) -> Shard:
        """Return the part that a text like ``"3/16"`` names.

        Raises
        ------
        InputError
            When it names none.
        """
        match = re.fullmatch(r"\s*(\d{1,6})\s*/\s*(\d{1,6})\s*", text)
        if match is None or not 1 <= int(match[1]) <= int(match[2]):
            raise InputError(f"--shard: got {text!r}; expected I/N with I from 1 to N, as in 3/16")
        return cls(int(match[1]), int(match[2]))

    def __str__(self) -> str:
        return f"{self.number}/{self.count}"

    def of(self, keys: Iterable[str]) -> list[str]:
        """Return its keys: every n-th one, so that parts are alike along every axis."""
        return list(keys)[self.number - 1 :: self.count]


WHOLE = Shard(1, 1)
"""The only part of a study that is not divided."""


@dataclass(frozen=True)
class Plan:
    """A study written out.

    Attributes
    ----------
    study : Study
    dimensions : tuple of Dimension
    points : tuple of Point
        In row-major order of the dimensions.
    base : mapping
        The base case as plain data.
    """

    study: Study
    dimensions: tuple[Dimension, ...]
    points: tuple[Point, ...]
    base: Mapping[str, Any] = field(repr=False)

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of steps of every dimension."""
        return tuple(dimension.size for dimension in self.dimensions)

    @cached_property
    def by_key(self) -> dict[str, Point]:
        """The first point of every key, in order; equal cases are computed once."""
        found: dict[str, Point] = {}
        for point in self.points:
            if point.key:
                found.setdefault(point.key, point)
        return found

    def case(self, point: Point) -> Case:
        """Return the case of a point; cases are made when they are needed, to save memory."""
        return make_case(self.base, point.changes)

    @cached_property
    def project(self) -> Project:
        """Project block of the base case; empty where no combination is valid."""
        first = next((point for point in self.points if point.key), None)
        return Project() if first is None else self.case(first).project

    def coordinates(self, point: Point) -> dict[str, Coordinate]:
        """Return the values of all axes at a point by short name."""
        return {
            axis.name: axis.coordinates[index]
            for dimension, index in zip(self.dimensions, point.index, strict=True)
            for axis in dimension.axes
        }


def plan_study(study: Study) -> Plan:
    """Write a study out into cases, each validated.

    A combination that validation refuses stays in the plan with its reasons.

    Parameters
    ----------
    study

    Returns
    -------
    Plan

    Raises
    ------
    InputError
        When the base case cannot be read, an axis is at fault, or no combination is valid.
    """
    base, problems = _base(study)
    dimensions, faults = write_out(study)
    problems += [f"{study.name}: {fault}" for fault in faults]
    if problems:
        raise InputError(problems)
    ranges = [range(dimension.size) for dimension in dimensions]
    points = []
    for number, index in enumerate(itertools.product(*ranges), 1):
        points.append(_point(study, base, dimensions, number, index))
    if all(point.problems for point in points):
        raise InputError(_common_reasons(study, points))
    return Plan(study, dimensions, tuple(points), base)


def key_of(case: Case, *, keep_runs: bool = False) -> str:
    """Return what identifies the result of a case: input, program version, what is computed."""
    text = f"{case.hash()} {__version__} {ROW_FORMAT} {'runs' if keep_runs else ''}"
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def _base(study: Study) -> tuple[Mapping[str, Any], list[str]]:
    reference: str | Path = study.base
    try:
        composition = compose(reference)
    except InputError as error:
        return {}, [f"{study.name}: base: {problem}" for problem in error.problems]
    if "schema" not in composition.values:
        return {}, [f"{study.name}: base: {composition.label}: schema: is missing"]
    return composition.values, [f"{study.name}: base: {p}" for p in composition.problems]


def _point(
    study: Study,
    base: Mapping[str, Any],
    dimensions: tuple[Dimension, ...],
    number: int,
    index: tuple[int, ...],
) -> Point:
    changes: dict[str, Any] = dict(study.overrides)
    for dimension, at in zip(dimensions, index, strict=True):
        for axis in dimension.axes:
            changes |= axis.changes[at]
    try:
        case = make_case(base, changes)
    except InputError as error:
        texts = (problem.removeprefix("case: ") for problem in error.problems)
        return Point(number, index, changes, "", tuple(texts))
    return Point(number, index, changes, key_of(case, keep_runs=study.keep_runs))


def _common_reasons(study: Study, points: list[Point]) -> list[str]:
    """Say why no case is valid, the commonest reasons first."""
    reasons = Counter(text for point in points for text in point.problems)
    first = f"{study.name}: none of the {len(points)} cases is valid"
    listed = reasons.most_common(20)
    return [first, *(f"{study.name}: {text} ({count} cases)" for text, count in listed)]


def pending(plan: Plan, finished: set[str], shard: Shard = WHOLE) -> Iterator[Point]:
    """Yield the first point of every key that has no result yet.

    Parameters
    ----------
    plan
    finished
        Keys with a result.
    shard
        The part of the study that is wanted.
    """
    for key in shard.of(plan.by_key):
        if key not in finished:
            yield plan.by_key[key]
