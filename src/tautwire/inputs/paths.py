"""Paths such as ``droppers.presag[9][5]``: how people write them and what they lead to.

Inside the program a path is a tuple of field names and 0-based indices; people count from 1.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, get_args, get_origin

from pydantic import Tag
from pydantic.fields import FieldInfo

from tautwire.inputs.reading.files import did_you_mean
from tautwire.specs.base import FORMS, MAPPING, Quantity, Spec, Typical
from tautwire.specs.case import Case
from tautwire.specs.schema.vocabulary import PAGE, meaning_of

Path = tuple[str | int, ...]
USE = "use"
"""Key that names an entry of the catalogue."""
_STEP = re.compile(r"([A-Za-z_][\w-]*)((?:\[[0-9]{1,6}\])*)", re.ASCII)


class PathError(ValueError):
    """A path is malformed or leads to nothing."""


@dataclass(frozen=True)
class Target:
    """What a path leads to: a field, its quantity, and the spec it may hold."""

    field: FieldInfo | None
    spec: type[Spec] | None

    @property
    def quantity(self) -> Quantity | None:
        """Unit and range of the field, if it holds a quantity."""
        return next((m for m in self._marks() if isinstance(m, Quantity)), None)

    @property
    def typical(self) -> str:
        """Typical value of the field; empty if there is none."""
        marks = (m for m in self._marks() if isinstance(m, (Quantity, Typical)))
        return next((m.typical if isinstance(m, Quantity) else m.text for m in marks), "")

    def holds_list(self) -> bool:
        """Tell whether the field can be given as a list."""
        return self.field is not None and any(
            get_origin(part) is tuple for part in _parts(self.field.annotation)
        )

    def holds_mapping(self) -> bool:
        """Tell whether the field can be given as a mapping instead of a list."""
        return self.field is not None and any(
            isinstance(part, Tag) and part.tag == MAPPING for part in _parts(self.field.annotation)
        )

    def _marks(self) -> Iterator[Any]:
        if self.field is not None:
            yield from self.field.metadata
            yield from _parts(self.field.annotation)


def format_path(path: Sequence[str | int]) -> str:
    """Write a path as people read it: ``("a", 0, "b")`` is ``a[1].b``."""
    text = ""
    for step in path:
        text += f"[{step + 1}]" if isinstance(step, int) else f".{step}"
    return text.lstrip(".")


def parse_path(text: str) -> Path:
    """Read a path with 1-based indices.

    Raises
    ------
    PathError
        When the text is not a path.
    """
    path: list[str | int] = []
    for part in text.strip().split("."):
        match = _STEP.fullmatch(part)
        if match is None:
            raise PathError(
                f"{text!r} is not a path; write names joined by dots, with [1], [2] ... for the "
                "items of a list, as in 'droppers.presag[5]'"
            )
        path.append(match.group(1))
        for digits in re.findall(r"[0-9]+", match.group(2)):
            if int(digits) == 0:
                raise PathError(f"{text!r}: items are numbered from 1")
            path.append(int(digits) - 1)
    return tuple(path)


def without_forms(location: Sequence[str | int]) -> Path:
    """Drop the names of union branches from the location of a validation error."""
    return tuple(step for step in location if step not in FORMS)


def find_target(path: Path) -> Target:
    """Follow a path through the specs, from the case.

    Raises
    ------
    PathError
        When a name does not exist, with the closest one.
    """
    field: FieldInfo | None = None
    spec: type[Spec] | None = Case
    for depth, step in enumerate(path):
        if isinstance(step, int):
            continue
        fields = fields_by_key(spec) if spec is not None else {}
        if step not in fields and spec is not None and spec.named_items is not None:
            field, spec = None, spec.named_items
            continue
        if step not in fields:
            known = written_keys(spec) if spec is not None else ()
            place = format_path(path[: depth + 1])
            raise PathError(f"{place}: {unknown_key(step, known, format_path(path[:depth]))}")
        field = fields[step]
        spec = next(iter(_specs(field.annotation)), None)
    return Target(field, spec)


def spec_at(path: Path) -> type[Spec] | None:
    """Return the spec of the mapping at a path; None where the path leads to none."""
    try:
        return find_target(path).spec
    except PathError:
        return None


_HOW = {"wires": ", each wire by a name and a role of its own, as in 'contact-2: {role: contact}'"}
"""What a key alone does not say, by key."""


def unknown_key(key: str, allowed: Collection[str], above: str) -> str:
    """Say that a key is unknown, and what may be meant.

    Parameters
    ----------
    key
        As it was written.
    allowed
        Keys that may stand in its place.
    above
        Path of the mapping in which it stands; empty at the top.
    """
    meaning = meaning_of(key, above)
    if meaning is not None and meaning.feature:
        return f"not modelled yet: {meaning.feature}; see the page '{PAGE}'"
    if not allowed:
        return "unknown key; nothing can be given below this value"
    own = meaning.key.rpartition(".")[2] if meaning is not None else ""
    if own in allowed:
        return f"unknown key; did you mean {own!r}?"
    if meaning is not None:
        return f"unknown key; it is given as {meaning.key}{_HOW.get(meaning.key, '')}"
    listed = ", ".join(allowed)
    return f"unknown key{did_you_mean(key, allowed) or f'; known here are: {listed}'}"


def fields_by_key(spec: type[Spec]) -> dict[str, FieldInfo]:
    """Return the fields of a spec by the key that is written in a file."""
    return {field.alias or name: field for name, field in spec.model_fields.items()}


def written_keys(spec: type[Spec]) -> tuple[str, ...]:
    """Return the keys that may be written in the mapping of a spec, 'use' among them."""
    return (*fields_by_key(spec), *((USE,) if spec.catalogue_kinds else ()))


def value_at(data: Any, path: Path) -> Any:
    """Return the value at a path in plain data, or None where the path leads to nothing."""
    for step in path:
        if isinstance(step, str) and isinstance(data, Mapping):
            data = data.get(step)
        elif isinstance(step, int) and isinstance(data, (list, tuple)) and step < len(data):
            data = data[step]
        else:
            return None
    return data


def _parts(annotation: Any) -> Iterator[Any]:
    """Yield an annotation and everything nested in it, metadata included."""
    yield annotation
    for argument in get_args(annotation):
        yield from _parts(argument)


def _specs(annotation: Any) -> Iterator[type[Spec]]:
    for part in _parts(annotation):
        if isinstance(part, type) and issubclass(part, Spec):
            yield part
