"""The shelf: all entries at hand, of the package and of own files, found by name."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cached_property, lru_cache
from importlib.resources import files
from typing import Any

from pydantic import ValidationError

from tautwire.catalogue.parts import KIND_NAMES, KINDS, Part
from tautwire.errors import InputError
from tautwire.faults import words_of

_FILE_KEYS = ("kind", "sources", "profiles", "entries")
"""Keys of a catalogue file; ``profiles`` holds nothing but anchors for the entries."""

_SUGGESTIONS = 4
"""Names suggested for an unknown one: the two grooves of a contact wire in two alloys."""


@dataclass(frozen=True)
class Shelf:
    """Entries in the order in which they are looked up: those of own files first.

    Attributes
    ----------
    parts : tuple of Part
    """

    parts: tuple[Part, ...]

    def find(self, name: str, kinds: Iterable[str] = KIND_NAMES) -> Part:
        """Return the entry of a name or an alias; spaces, hyphens and case do not matter.

        Parameters
        ----------
        name : str
        kinds : iterable of str
            Kinds of which it may be.

        Raises
        ------
        InputError
            When there is none of these kinds, with the closest ones.
        """
        wanted = tuple(kinds)
        found = [part for part in self._by_name.get(_folded(name), ()) if part.kind in wanted]
        if found:
            return found[0]
        raise InputError(self._unknown(name, wanted))

    def search(self, words: str = "", kind: str | None = None) -> tuple[Part, ...]:
        """Return the entries whose name, aliases or summary contain all words."""
        asked = [_folded(word) for word in words.split()]
        return tuple(
            part
            for part in self.parts
            if kind in (None, part.kind) and all(word in _folded(_text(part)) for word in asked)
        )

    def of(self, kinds: Iterable[str]) -> tuple[Part, ...]:
        """Return the entries of some kinds."""
        wanted = tuple(kinds)
        return tuple(part for part in self.parts if part.kind in wanted)

    def with_own(self, parts: Iterable[Part]) -> Shelf:
        """Return a shelf on which the given entries are found first."""
        return Shelf((*parts, *self.parts))

    @cached_property
    def _by_name(self) -> dict[str, list[Part]]:
        names: dict[str, list[Part]] = {}
        for part in self.parts:
            for name in (part.name, *part.aliases):
                names.setdefault(_folded(name), []).append(part)
        return names

    def _unknown(self, name: str, kinds: tuple[str, ...]) -> str:
        other = self._by_name.get(_folded(name))
        wanted = "entry" if kinds == KIND_NAMES else " or ".join(kinds)
        if other:
            return f"{name!r} is a {other[0].kind}; a {wanted} is needed here"
        hint = ", ".join(map(repr, self._like(name, kinds)))
        cure = f"did you mean {hint}?" if hint else "'tautwire catalogue' lists what there is"
        return f"the catalogue has no {wanted} named {name!r}; {cure}"

    def _like(self, name: str, kinds: tuple[str, ...]) -> list[str]:
        """Return names near another one: those with all its words and numbers, else the likest."""
        names = [(p.name, *p.aliases) for p in self.of(kinds)]
        asked = re.findall(r"[^\W\d]+|[\d.]+", name.casefold().replace("_", " "))
        if asked:
            whole = ([n for n in own if all(word in _folded(n) for word in asked)] for own in names)
            if first := [found[0] for found in whole if found]:
                return first[:_SUGGESTIONS]
        folded = {_folded(n): n for own in names for n in own}
        close = get_close_matches(_folded(name), folded, n=_SUGGESTIONS, cutoff=0.5)
        return [folded[key] for key in close]


@lru_cache(maxsize=1)
def package_shelf() -> Shelf:
    """Return the entries that come with the program."""
    import yaml

    folder = files("tautwire.catalogue").joinpath("components")
    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    parts: list[Part] = []
    for resource in folder.iterdir():
        if resource.name.endswith(".yaml"):
            data = yaml.load(resource.read_text(encoding="utf-8"), loader)
            parts += read_parts(data, resource.name)
    parts.sort(key=lambda part: KIND_NAMES.index(part.kind))
    return Shelf(tuple(parts))


def read_parts(data: Mapping[str, Any], label: str) -> list[Part]:
    """Read the entries of a catalogue file from its plain data.

    Parameters
    ----------
    data : mapping
        ``kind``, ``sources`` (texts by a short name) and ``entries``; in place of one ``kind`` for
        all, every entry may have its own.
    label : str
        Name of the file in messages.

    Raises
    ------
    InputError
        Naming everything that is wrong.
    """
    problems = [
        f"{label}: unknown key {key!r}; known are: {', '.join(_FILE_KEYS)}"
        for key in data
        if key not in _FILE_KEYS
    ]
    entries, sources = data.get("entries"), data.get("sources") or {}
    if not isinstance(entries, list) or not entries:
        problems.append(f"{label}: entries: expected a list of entries, each with its name")
    if not isinstance(sources, Mapping) or not all(isinstance(t, str) for t in sources.values()):
        problems.append(f"{label}: sources: expected texts by short names, {{din: Vendor sheet}}")
    if problems:
        raise InputError(problems)
    parts: list[Part] = []
    for number, entry in enumerate(entries or [], 1):
        try:
            parts.append(_part(entry, data.get("kind"), sources, f"{label}: entry {number}"))
        except InputError as error:
            problems += error.problems
    problems += _twice(parts, label)
    if problems:
        raise InputError(problems)
    return parts


def _part(entry: Any, common: Any, sources: Mapping[str, str], label: str) -> Part:
    if not isinstance(entry, Mapping):
        raise InputError(f"{label}: got {entry!r}; expected a mapping with name, summary, numbers")
    own = dict(entry)
    place = f"{label} ({own['name']})" if isinstance(own.get("name"), str) else label
    kind = own.pop("kind", common)
    spec = next((one for one in KINDS if one.kind == kind), None)
    if spec is None:
        raise InputError(f"{place}: kind: got {kind!r}; choose {', '.join(KIND_NAMES)}")
    try:
        return spec.model_validate(own, context={"sources": sources})
    except ValidationError as error:
        raise InputError([_sentence(place, fault, spec) for fault in error.errors()]) from None


def _sentence(place: str, fault: Any, spec: type[Part]) -> str:
    path = ""
    for step in fault["loc"]:
        path += f"[{step + 1}]" if isinstance(step, int) else f".{step}"
    where = path.lstrip(".")
    if fault["type"] == "extra_forbidden":
        text = f"unknown key; a {spec.kind} has: {', '.join(spec.model_fields)}"
    elif fault["type"] == "missing":
        text = "is missing; write {value: ..., seen: SOURCE}"
    else:
        text = words_of(fault)
    return f"{place}: {where}: {text}" if where else f"{place}: {text}"


def _twice(parts: list[Part], label: str) -> list[str]:
    """Name the names that two entries of one kind and file share."""
    seen: dict[tuple[str, str], str] = {}
    problems = []
    for part in parts:
        for name in dict.fromkeys(_folded(n) for n in (part.name, *part.aliases)):
            other = seen.setdefault((part.kind, name), part.name)
            if other != part.name:
                problems.append(f"{label}: {part.name} and {other} share a name or an alias")
    return problems


def _folded(text: str) -> str:
    return "".join(c for c in text.casefold() if not (c.isspace() or c in "-_/"))


def _text(part: Part) -> str:
    return " ".join((part.name, *part.aliases, part.summary))
