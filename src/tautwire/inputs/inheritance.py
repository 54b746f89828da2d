"""What a case takes over from another: never its identity, and no source without its number."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tautwire.inputs.paths import Path as ValuePath
from tautwire.inputs.paths import PathError, format_path, parse_path, value_at
from tautwire.text import LONGEST_NAME

IDENTITY = ("title", "description", "project")
"""Keys that speak of the case as a whole and hold for no other."""


def without_identity(values: Mapping[str, Any], label: str) -> dict[str, Any]:
    """Return the values of an included case without its title, description and project.

    Parameters
    ----------
    values
        The included case.
    label
        Name of the document that includes it; without a name of its own, the case takes this one.
    """
    kept = {key: value for key, value in values.items() if key not in IDENTITY}
    return kept | ({"name": Path(label).stem[:LONGEST_NAME]} if "name" in kept else {})


def marked(sources: list[Any], template: str) -> list[Any]:
    """Return sources that say from which template their numbers were taken over."""
    return [
        {**source, "template": template} if isinstance(source, Mapping) else source
        for source in sources
    ]


def still_stated(
    sources: list[Any], written: Mapping[str, Any], replaced: Mapping[str, Any], at: ValuePath
) -> list[Any]:
    """Drop the sources that state another value than the document has; forget what the rest state.

    Parameters
    ----------
    sources
        Entries of ``sources``; one with the key ``value`` holds for that value only. A source of a
        ``use`` becomes one of the mapping in which it stands.
    written
        The document as it is written.
    replaced
        What a table says in its place.
    at
        Path of the document in the case.
    """
    kept = []
    for source in sources:
        if isinstance(source, Mapping) and "value" in source:
            path = _path_of(source)
            if path is not None:
                own = path[len(at) :]
                if value_at(replaced, own) is not None or value_at(written, own) != source["value"]:
                    continue
                if path[-1] == "use":
                    source = {**source, "path": format_path(path[:-1])}
            source = {key: value for key, value in source.items() if key != "value"}
        kept.append(source)
    return kept


def still_true(
    sources: list[Any], at: ValuePath, before: Mapping[str, Any], after: Mapping[str, Any]
) -> list[Any]:
    """Keep the sources of values that were not replaced."""
    return [
        source
        for source in sources
        if (path := _path_of(source)) is None
        or value_at(before, path[len(at) :]) == value_at(after, path[len(at) :])
    ]


def united(*lists: list[Any]) -> list[Any]:
    """Join lists of sources; a later one replaces an earlier one of the same path."""
    joined: dict[Any, Any] = {}
    for number, source in enumerate(item for sources in lists for item in sources):
        path = _path_of(source)
        joined[path if path is not None else number] = source
    return list(joined.values())


def _path_of(source: Any) -> ValuePath | None:
    """Return the path of a source; None when it is malformed, which validation tells."""
    try:
        return parse_path(source["path"])
    except (PathError, TypeError, KeyError, AttributeError):
        return None
