"""What headings mean: the vocabulary file, and how a heading is compared with it."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from typing import Any

TEXT, COUNT = "text", "#"
KINDS = ("supports", "droppers", "wires")

_UNIT = re.compile(r"[\[(]\s*([^\[\]()]*?)\s*[\])]\s*$")


@dataclass(frozen=True)
class Field:
    """What a column of a table can be.

    Attributes
    ----------
    kind : str
        Kind of table.
    name : str
    unit : str
        SI unit, :data:`COUNT` or :data:`TEXT`.
    headings : frozenset of str
        What it is called, folded.
    """

    kind: str
    name: str
    unit: str
    headings: frozenset[str]


@lru_cache(maxsize=1)
def vocabulary() -> tuple[Field, ...]:
    """Return the fields of all kinds of table."""
    return tuple(
        Field(kind, name, entry["unit"], frozenset(map(folded, (name, *entry["headings"]))))
        for kind in KINDS
        for name, entry in _content()[kind].items()
    )


def role_of(text: str) -> str | None:
    """Return which wire a name in a table of wires means."""
    word = folded(text)
    for role, names in _content()["roles"].items():
        if word in map(folded, names):
            return role
    return None


def split_heading(heading: str) -> tuple[str, str]:
    """Return the words of a heading and the unit in its brackets."""
    match = _UNIT.search(heading)
    return (heading[: match.start()], match.group(1)) if match else (heading, "")


def folded(text: str) -> str:
    """Return a text without case, accents, spaces and punctuation; camel case and _ are spaces."""
    plain = unicodedata.normalize("NFKD", text.casefold())
    return "".join(c for c in plain if c.isalnum() and not unicodedata.combining(c))


@lru_cache(maxsize=1)
def _content() -> dict[str, Any]:
    import yaml

    text = files("tautwire.tables").joinpath("vocabulary.yaml").read_text(encoding="utf-8")
    return yaml.safe_load(text)
