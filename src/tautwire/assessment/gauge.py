"""Calculation rules and pantograph heads for the permissible lateral position, from a data file."""

from __future__ import annotations

from functools import lru_cache
from typing import Literal, TypeVar

from pydantic import Field

from tautwire.assessment.data import Record, read_library
from tautwire.errors import InputError
from tautwire.formulas.pantograph_gauge import GaugeTerms


class Rule(Record):
    """One calculation rule and where it comes from."""

    id: str
    name: str
    source: str
    confidence: str
    verified: bool
    terms: GaugeTerms


class Head(Record):
    """The part of a pantograph head on which the wire may run."""

    id: str
    half_width: float
    source: str
    confidence: str


class GaugeData(Record):
    """The content of ``gauge.yaml``."""

    schema_version: Literal[1] = Field(alias="schema")
    rules: tuple[Rule, ...]
    heads: tuple[Head, ...]


Named = TypeVar("Named", Rule, Head)


def gauge_rule(name: str) -> Rule:
    """Return a calculation rule by name.

    Raises
    ------
    InputError
        When there is none; those that exist are named.
    """
    return _named("permissible.rule", name, gauge_data().rules)


def gauge_head(name: str) -> Head:
    """Return a pantograph head by name.

    Raises
    ------
    InputError
        When there is none; those that exist are named.
    """
    return _named("permissible.head", name, gauge_data().heads)


def _named(where: str, name: str, entries: tuple[Named, ...]) -> Named:
    for entry in entries:
        if entry.id == name:
            return entry
    known = ", ".join(entry.id for entry in entries)
    raise InputError(f"{where}: there is no {name!r}; there are: {known}")


@lru_cache(maxsize=1)
def gauge_data() -> GaugeData:
    """Return rules and heads of the package."""
    return read_library("gauge.yaml", GaugeData)
