"""What headings mean: the columns of tables, and the words of the trade that name them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from typing import Any

from tautwire.specs.schema.vocabulary import folded, words_for

TEXT, COUNT, DEGREES, ANY = "text", "#", "deg", "any"
KINDS = ("supports", "droppers", "wires", "bodies", "stays", "tension_lengths", "overlaps")
"""Tables of a line."""
BOOK_KINDS = (*KINDS, "values", "sources")
"""Tables of a workbook that is a case."""
RECORDING = "recording"

_WORD = re.compile(r"[^\W\d_]+|\d+")
_UNIT = re.compile(r"[\[(]\s*([^\[\]()]*?)\s*[\])]\s*$")


@dataclass(frozen=True)
class Field:
    """What a column of a table can be.

    Attributes
    ----------
    name : str
    unit : str
        SI unit, :data:`COUNT`, :data:`TEXT`, :data:`DEGREES` or :data:`ANY`.
    headings : frozenset of str
        What it is called, folded.
    keys : frozenset of str
        The same by its words alone, as :func:`key_of` tells them.
    is_numbered : bool
        Whether a table may have several, told apart by numbers.
    repeated : frozenset of str
        What it is also called, folded, in a table with one row per span beside the number of a
        dropper; empty where it tells nothing of a single dropper.
    short : frozenset of str
        The same of words that mean other things as often, and are read with a unit only.
    with_unit : frozenset of str
        What it is called, folded, where its unit stands beside.
    plausible : (str, float, float) or None
        A statistic of the values and its usual bounds in SI.
    units : tuple of str
        Units that values without one may be in when they are not plausible.
    """

    name: str
    unit: str
    headings: frozenset[str]
    keys: frozenset[str] = frozenset()
    is_numbered: bool = False
    repeated: frozenset[str] = frozenset()
    short: frozenset[str] = frozenset()
    with_unit: frozenset[str] = frozenset()
    plausible: tuple[str, float, float] | None = None
    units: tuple[str, ...] = ()

    @property
    def is_of_one_dropper(self) -> bool:
        """Whether a column may tell it of one dropper in a table with one row per span."""
        return bool(self.repeated or self.short)


@lru_cache(maxsize=len(BOOK_KINDS) + 1)
def fields_of(kind: str) -> tuple[Field, ...]:
    """Return the fields of a kind of table."""
    return tuple(
        Field(
            name,
            entry["unit"],
            _headings(name, entry),
            _keys(name, entry),
            entry.get("numbered", False),
            frozenset(map(folded, entry.get("repeated", ()))),
            frozenset(map(folded, entry.get("short", ()))),
            frozenset(map(folded, entry.get("with_unit", ()))),
            tuple(entry["plausible"]) if "plausible" in entry else None,
            tuple(entry.get("units", ())),
        )
        for name, entry in _content()[kind].items()
    )


def named_field(name: str, unit: str) -> Field:
    """Return a field that goes by its own name alone."""
    return Field(name, unit, frozenset((folded(name),)))


@lru_cache(maxsize=1)
def places() -> dict[str, tuple[str, int]]:
    """Return what folded words in numbered headings mean: ``"left"`` is sensor 1."""
    return {
        folded(word): (what, int(number))
        for what, numbers in _content()["places"].items()
        for number, words in numbers.items()
        for word in words
    }


def role_of(text: str) -> str | None:
    """Return which wire a name in a table of wires means."""
    word = folded(text)
    roles = _content()["roles"].items()
    return next((role for role, entry in roles if word in _headings(role, entry)), None)


@lru_cache(maxsize=len(BOOK_KINDS) + 1)
def sheet_names(kind: str) -> frozenset[str]:
    """Return what a sheet with a kind of table is called, folded."""
    entry = _content()["sheets"].get(kind)
    return frozenset() if entry is None else _headings(kind, entry)


@lru_cache(maxsize=1)
def total_words() -> frozenset[str]:
    """Return what the first cell of a row of totals says, folded."""
    return frozenset(map(folded, _content()["totals"]))


def split_heading(heading: str) -> tuple[str, str]:
    """Return the words of a heading and the unit in its brackets."""
    match = _UNIT.search(heading)
    return (heading[: match.start()], match.group(1)) if match else (heading, "")


def key_of(words: str) -> str:
    """Return the words of a heading in one order, without articles and prepositions.

    Examples
    --------
    >>> key_of("Longitud de la péndola"), key_of("péndola, longitud")
    ('longitud pendola', 'longitud pendola')
    """
    small = _small_words()
    tokens = (folded(token) for token in _WORD.findall(words))
    return " ".join(sorted(token for token in tokens if token not in small))


@lru_cache(maxsize=1)
def _small_words() -> frozenset[str]:
    return frozenset(map(folded, _content()["small"].split()))


def _headings(name: str, entry: dict[str, Any]) -> frozenset[str]:
    """Return everything that a column may be called, folded."""
    barred = set(map(folded, entry.get("not", ())))
    return frozenset(map(folded, _words(name, entry))) - barred


def _keys(name: str, entry: dict[str, Any]) -> frozenset[str]:
    barred = set(map(key_of, entry.get("not", ())))
    return frozenset(map(key_of, _words(name, entry))) - barred - {""}


def _words(name: str, entry: dict[str, Any]) -> tuple[str, ...]:
    return (name, *(words_for(entry["key"]) if "key" in entry else ()), *entry.get("headings", ()))


@lru_cache(maxsize=1)
def _content() -> dict[str, Any]:
    import yaml

    text = files("tautwire.tables").joinpath("columns.yaml").read_text(encoding="utf-8")
    return yaml.safe_load(text)
