"""What headings mean: the columns of tables, and the words of the trade that name them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from typing import Any

from tautwire.specs.vocabulary import folded, words_for

TEXT, COUNT = "text", "#"
KINDS = ("supports", "droppers", "wires")

_UNIT = re.compile(r"[\[(]\s*([^\[\]()]*?)\s*[\])]\s*$")


@dataclass(frozen=True)
class Field:
    """What a column of a table can be.

    Attributes
    ----------
    name : str
    unit : str
        SI unit, :data:`COUNT` or :data:`TEXT`.
    headings : frozenset of str
        What it is called, folded.
    """

    name: str
    unit: str
    headings: frozenset[str]


@lru_cache(maxsize=len(KINDS))
def fields_of(kind: str) -> tuple[Field, ...]:
    """Return the fields of a kind of table."""
    return tuple(
        Field(name, entry["unit"], _headings(name, entry))
        for name, entry in _content()[kind].items()
    )


def role_of(text: str) -> str | None:
    """Return which wire a name in a table of wires means."""
    word = folded(text)
    roles = _content()["roles"].items()
    return next((role for role, entry in roles if word in _headings(role, entry)), None)


def split_heading(heading: str) -> tuple[str, str]:
    """Return the words of a heading and the unit in its brackets."""
    match = _UNIT.search(heading)
    return (heading[: match.start()], match.group(1)) if match else (heading, "")


def _headings(name: str, entry: dict[str, Any]) -> frozenset[str]:
    """Return everything that a column may be called, folded."""
    shared = words_for(entry["key"]) if "key" in entry else ()
    barred = set(map(folded, entry.get("not", ())))
    return frozenset(map(folded, (name, *shared, *entry.get("headings", ())))) - barred


@lru_cache(maxsize=1)
def _content() -> dict[str, Any]:
    import yaml

    text = files("tautwire.tables").joinpath("columns.yaml").read_text(encoding="utf-8")
    return yaml.safe_load(text)
