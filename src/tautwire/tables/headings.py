"""What a heading says: the field, its unit, and the numbers that tell channels of a kind apart."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from tautwire.specs.schema.vocabulary import folded
from tautwire.tables.columns import COUNT, TEXT, Field, key_of, places, split_heading
from tautwire.tables.values import unit_fits

_GROUP = re.compile(r"^.*(?:\.(?! )|[|:\\])|^.*/(?=[^/]*[^\W\d_]{2})")
"""What stands before a name: the device in ``PI.F_1_1``, the group in ``Group/Force``. A
point with a blank behind it ends an abbreviation."""
_TRAILING_UNIT = re.compile(r"^(.*?[^\s_/,;])(?:\s*[/,;]\s+|[\s_]+in\s+|[\s_]+)([^\s_]+)$")
NUMBER_WORD = re.compile(
    r"(?<![^\W\d_])(?:no|nos|nr|num|number|n[º°o]|n|nummer|numero|número|numéro|id|#)\.?(?![^\W\d_])",
    re.IGNORECASE,
)
"""What says that a column holds numbers or names of something: "Vano nº", "Mast-Nr."."""
_TOKEN = re.compile(r"[^\W\d_]+|\d+")


@dataclass(frozen=True)
class Reading:
    """What a heading was understood as.

    Attributes
    ----------
    field : Field
    unit : str
    strip, sensor : int or None
        Numbers of a numbered channel, from 1.
    dropper : int or None
        Number of the dropper of a table with one row per span, from 1.
    """

    field: Field
    unit: str
    strip: int | None = None
    sensor: int | None = None
    dropper: int | None = None


def read_heading(heading: str, unit_below: str, fields: Sequence[Field]) -> Reading | None:
    """Match a heading by meaning; None when it means no field.

    Parameters
    ----------
    heading
        As it stands: ``"PI.F_1_2 [N]"``, ``"Kraft vorne links / N"``, ``"speed_kmh"``.
    unit_below
        Unit from a row of units; empty where there is none.
    fields
        What the table may hold.
    """
    spelt = list(spellings(heading, unit_below))
    return _by_name(spelt, fields) or _by_number(spelt, fields)


def _by_name(spelt: Sequence[tuple[str, str]], fields: Sequence[Field]) -> Reading | None:
    """Match the words as they stand, in another order, or without what says that they count."""
    counted = [field for field in fields if field.unit in (TEXT, COUNT)]
    for words, unit in spelt:
        word = folded(words)
        for field in fields:
            known = field.headings | field.with_unit if unit else field.headings
            if word in known and unit_fits(unit, field.unit):
                return Reading(field, unit)
    for words, unit in spelt:
        for key, chosen in ((key_of(words), fields), (_counting(words), counted)):
            for field in chosen:
                if key in field.keys and unit_fits(unit, field.unit):
                    return Reading(field, unit)
    return None


def _by_number(spelt: Sequence[tuple[str, str]], fields: Sequence[Field]) -> Reading | None:
    """Match the words of a channel of which a table has several, told apart by numbers."""
    numbered = [field for field in fields if field.is_numbered]
    for words, unit in spelt if numbered else ():
        strip, sensor, names = _numbers(words)
        for field in numbered:
            if names & field.headings and unit_fits(unit, field.unit):
                return Reading(field, unit, strip, sensor)
    return None


def _counting(words: str) -> str:
    """Return the key of a heading without what says that it counts or names things."""
    return key_of(NUMBER_WORD.sub(" ", words))


def spellings(heading: str, unit_below: str) -> Iterator[tuple[str, str]]:
    """Yield words and unit: as they stand, without a group before, with a unit at the end."""
    words, unit = split_heading(heading)
    unit = unit or unit_below
    bare = _GROUP.sub("", words)
    for name in dict.fromkeys((words, bare)):
        yield name, unit
    if unit:
        return
    for name in dict.fromkeys((words, bare)):
        match = _TRAILING_UNIT.match(name)
        if match is not None and not unit_fits(match.group(2), TEXT):
            yield match.group(1), match.group(2)


_LONGEST_NUMBER = 3
"""Digits of the number of a strip or sensor; a longer one belongs to the name. Chosen: trains have
fewer than a thousand of them."""


def _numbers(words: str) -> tuple[int | None, int | None, frozenset[str]]:
    """Return strip, sensor and the names that are left: all words, and ends of them."""
    known = places()
    found: dict[str, int] = {}
    letters, digits = [], []
    for token in _TOKEN.findall(words):
        place = known.get(folded(token))
        if token.isdecimal() and len(token) <= _LONGEST_NUMBER:
            digits.append(int(token))
        elif place is not None:
            found[place[0]] = place[1]
        else:
            letters.append(token)
    if len(digits) == 1 and 11 <= digits[0] <= 44:  # F12 is sensor 2 of strip 1
        digits = list(divmod(digits[0], 10))
    if len(digits) >= 2:
        found = {"strip": digits[-2], "sensor": digits[-1], **found}
    elif digits:
        found.setdefault("sensor" if "sensor" not in found else "strip", digits[0])
    names = frozenset(folded("".join(letters[at:])) for at in range(len(letters)))
    return found.get("strip"), found.get("sensor"), names if found else frozenset()
