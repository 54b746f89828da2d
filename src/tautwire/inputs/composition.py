"""From the text of a case file to plain data: includes, tables and sources put together."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

from tautwire.catalogue.entries import list_entries, read_entry
from tautwire.errors import InputError
from tautwire.inputs.documents import SUFFIXES, parse_document
from tautwire.inputs.files import did_you_mean, neighbours, read_case_text
from tautwire.inputs.line_tables import (
    Overlay,
    read_dropper_table,
    read_profile_table,
    read_roof_table,
    read_support_table,
)
from tautwire.inputs.merge import merge
from tautwire.inputs.paths import Path as ValuePath
from tautwire.inputs.paths import PathError, format_path, parse_path, value_at
from tautwire.specs.upgrade import READ_VERSIONS, SCHEMA_VERSION, upgraded

MAX_DOCUMENTS = 100
"""Documents that one case may be put together from."""
MAX_CHAIN = 8
"""Documents of which each includes the next."""

Sources = list[Any]
_TABLES: dict[str, tuple[Callable[[Path], Overlay], tuple[str, ...]]] = {
    "supports": (read_support_table, ("line", "supports")),
    "droppers": (read_dropper_table, ("droppers",)),
}
_UNEVENNESS = ("irregularities", "unevenness")


@dataclass(frozen=True)
class Document:
    """A file of the user or of the library.

    Attributes
    ----------
    label
        Name in messages.
    identity
        The same for the same file, whatever the path that led to it.
    folder
        Where relative paths in it start; None for the library.
    content
        Its top-level mapping.
    """

    label: str
    identity: str
    folder: Path | None
    content: dict[str, Any]


Trail = tuple[Document, ...]
"""The documents that include each other down to the one at hand."""


@dataclass
class Composition:
    """A case put together as plain data, and what was wrong with its tables.

    Attributes
    ----------
    label
        Name of the case file in messages.
    values
        The case as plain data.
    origins
        Cells of tables from which single values were read.
    problems
        Sentences about tables that could not be used.
    incomplete
        Top-level keys that lack the content of such a table.
    """

    label: str
    values: dict[str, Any] = field(default_factory=dict)
    origins: dict[ValuePath, str] = field(default_factory=dict)
    problems: list[str] = field(default_factory=list)
    incomplete: set[str] = field(default_factory=set)


def compose(name_or_path: str | Path) -> Composition:
    """Read a case with everything that it includes.

    Raises
    ------
    InputError
        When a file cannot be read or parsed, or an include cannot be resolved.
    """
    document = find_document(name_or_path, Path())
    composer = _Composer(Composition(document.label))
    part = composer.document(document, (), ())
    result = composer.result
    result.values = {**part.values}
    if part.sources:
        result.values.setdefault("sources", part.sources)
    return result


def find_document(reference: str | Path, folder: Path | None) -> Document:
    """Read a library entry by name, or a file relative to a folder.

    Raises
    ------
    InputError
        When there is neither, with the closest name, or when it cannot be read.
    """
    if reference in _library_names():
        return _library_document(str(reference))
    path = (folder or Path()) / reference
    if path.suffix.lower() not in SUFFIXES and not os.path.isdir(path):  # noqa: PTH112
        if os.path.isfile(path):  # noqa: PTH113
            raise InputError(f"{path}: is no case file; its name must end in {', '.join(SUFFIXES)}")
        close = did_you_mean(str(reference), [*_library_names(), *neighbours(path)])
        raise InputError(
            f"{reference}: there is no such case in the library and no such file{close}; the "
            f"library holds: {', '.join(_library_names())}"
        )
    content = parse_document(read_case_text(path), str(path), path.suffix)
    return Document(str(path), os.path.realpath(path), path.parent, content)


@lru_cache(maxsize=8)
def _library_document(name: str) -> Document:
    content = parse_document(read_entry(name), name, ".yaml")
    return Document(name, name, None, content)


def _library_names() -> list[str]:
    return [entry.name for entry in list_entries()]


@dataclass(frozen=True)
class _Part:
    """Plain data of one mapping, and the sources of the numbers in it."""

    values: dict[str, Any]
    sources: Sources


class _Composer:
    """Walks through the documents of one case; ``at`` is where in the case a mapping stands."""

    def __init__(self, result: Composition) -> None:
        self.result = result
        self._documents = 0

    def document(self, document: Document, at: ValuePath, trail: Trail) -> _Part:
        """Compose a whole document; the trail names the documents that include it."""
        self._refuse_endless(document, trail)
        own = dict(document.content)
        _check_schema(own.get("schema", SCHEMA_VERSION), document.label)
        own = upgraded(own)
        if at:
            own.pop("schema", None)
        tables = own.pop("tables", None)
        sources = _own_sources(own.pop("sources", []), at, document.label)
        overlay = self._tables(tables, own, document)
        part = self._mapping(own, at, document, (*trail, document))
        values = merge(part.values, overlay)
        kept = _still_true(part.sources, at, part.values, values)
        return _Part(values, _united(kept, _sources_of_tables(tables, overlay), sources))

    def _refuse_endless(self, document: Document, trail: Trail) -> None:
        self._documents += 1
        chain = " -> ".join(one.label for one in (*trail, document))
        if any(one.identity == document.identity for one in trail):
            raise InputError(f"{document.label}: includes itself: {chain}; remove one 'include'")
        if len(trail) >= MAX_CHAIN or self._documents > MAX_DOCUMENTS:
            raise InputError(
                f"{document.label}: {MAX_DOCUMENTS} files in all, and {MAX_CHAIN} of which each "
                f"includes the next, are the limit: {chain}"
            )

    def _mapping(
        self, node: Mapping[str, Any], at: ValuePath, document: Document, trail: Trail
    ) -> _Part:
        own = dict(node)
        base = _Part({}, [])
        if "include" in own:
            reference = own.pop("include")
            if not isinstance(reference, str):
                place = format_path((*at, "include"))
                raise InputError(
                    f"{document.label}: {place}: got {reference!r}; give one library name or file"
                )
            base = self.document(find_document(reference, document.folder), at, trail)
        values: dict[str, Any] = {}
        sources: Sources = []
        for key, value in own.items():
            part = self._value(value, (*at, key), document, trail)
            values[key] = part.values[key]
            sources += part.sources
        merged = merge(base.values, values)
        return _Part(merged, _united(_still_true(base.sources, at, base.values, merged), sources))

    def _value(self, value: Any, at: ValuePath, document: Document, trail: Trail) -> _Part:
        """Compose one value; the part holds it under the last step of its path."""
        key = str(at[-1])
        if isinstance(value, Mapping):
            if "table" in value and at[-1] == "roof_motion":
                return _Part({key: self._roof(value, at, document)}, [])
            if "table" in value and at[:2] == _UNEVENNESS:
                return _Part({key: self._profile(value, at, document)}, [])
            part = self._mapping(value, at, document, trail)
            return _Part({key: part.values}, part.sources)
        if isinstance(value, list):
            parts = [self._value(item, (*at, i), document, trail) for i, item in enumerate(value)]
            items = [part.values[str(i)] for i, part in enumerate(parts)]
            return _Part({key: items}, [source for part in parts for source in part.sources])
        return _Part({key: value}, [])

    def _roof(self, value: Mapping[str, Any], at: ValuePath, document: Document) -> Any:
        table = value["table"]
        if not isinstance(table, str) or len(value) > 1:
            raise InputError(
                f"{document.label}: {format_path(at)}: give {{table: file.csv}} alone, or time "
                "and height"
            )
        return self._columns(read_roof_table, table, at, document)

    def _profile(self, value: Mapping[str, Any], at: ValuePath, document: Document) -> Any:
        table = value["table"]
        if not isinstance(table, str) or value.get("kind") != "profile" or len(value) > 2:
            raise InputError(
                f"{document.label}: {format_path(at)}: give {{kind: profile, table: file.csv}}, or "
                "kind, x and height"
            )
        columns = self._columns(read_profile_table, table, at, document)
        return {"kind": "profile", **columns} if columns else None

    def _columns(
        self,
        read: Callable[[Path], dict[str, list[float]]],
        table: str,
        at: ValuePath,
        document: Document,
    ) -> dict[str, list[float]] | None:
        """Read a table that stands for the columns of a mapping; None when it cannot be used."""
        try:
            return read((document.folder or Path()) / table)
        except InputError as error:
            self.result.problems += error.problems
            self.result.incomplete.add(str(at[0]))
            return None

    def _tables(self, tables: object, own: Mapping[str, Any], document: Document) -> dict[str, Any]:
        """Read the tables of a document and return what they say about the case."""
        overlay: dict[str, Any] = {}
        for name, file in _table_files(tables, document.label).items():
            read, parts = _TABLES[name]
            path = (document.folder or Path()) / file
            try:
                found = read(path)
            except InputError as error:
                self.result.problems += error.problems
                self.result.incomplete.update(parts)
                continue
            self.result.problems += _given_twice(found.values, own, path, document.label)
            self.result.origins.update(found.origins)
            overlay = merge(overlay, found.values)
        return overlay


def _check_schema(version: object, label: str) -> None:
    if version not in READ_VERSIONS or isinstance(version, bool):
        raise InputError(
            f"{label}: schema: got {version!r}; this program reads versions 1 and {SCHEMA_VERSION} "
            f"of the input format. Write 'schema: {SCHEMA_VERSION}', and compare the file with the "
            "input reference if it was written for another version"
        )


def _table_files(tables: object, label: str) -> dict[str, str]:
    if tables is None:
        return {}
    if not isinstance(tables, dict):
        raise InputError(f"{label}: tables: expected {{supports: file.csv, droppers: file.csv}}")
    problems = []
    for name, file in tables.items():
        if name not in _TABLES:
            hint = did_you_mean(name, _TABLES) or f"; known are: {', '.join(_TABLES)}"
            problems.append(f"{label}: tables.{name}: unknown table{hint}")
        elif not isinstance(file, str):
            problems.append(f"{label}: tables.{name}: got {file!r}; give the path of a CSV file")
    if problems:
        raise InputError(problems)
    return tables


def _given_twice(
    table: Mapping[str, Any], own: Mapping[str, Any], path: Path, label: str
) -> list[str]:
    """Name the values that a document gives beside a table which says otherwise."""
    problems = []
    for section, values in table.items():
        for key, value in values.items():
            given = value_at(own, (section, key))
            if given is not None and given != value:
                problems.append(
                    f"{label}: {section}.{key}: is given here and in the table {path}; keep one"
                )
    return problems


def _own_sources(sources: Any, at: ValuePath, label: str) -> Sources:
    """Return the sources of a document with their paths seen from the case."""
    if not isinstance(sources, list):
        raise InputError(
            f"{label}: sources: expected a list of {{path: ..., source: ..., confidence: ...}}"
        )
    if not at:
        return sources
    return [
        {**item, "path": f"{format_path(at)}.{item['path']}"}
        if isinstance(item, dict) and "path" in item
        else item
        for item in sources
    ]


def _sources_of_tables(tables: Any, overlay: Mapping[str, Any]) -> Sources:
    """Name the table files as sources of what they give."""
    if not overlay:
        return []
    file_of = {"line": tables.get("supports"), **tables}
    return [
        {
            "path": f"{section}.{key}",
            "source": f"Table {file_of[section]}",
            "confidence": "one source",
        }
        for section, values in overlay.items()
        for key in values
    ]


def _still_true(
    sources: Sources, at: ValuePath, before: Mapping[str, Any], after: Mapping[str, Any]
) -> Sources:
    """Keep the sources of values that were not replaced."""
    return [
        source
        for source in sources
        if (path := _path_of(source)) is None
        or value_at(before, path[len(at) :]) == value_at(after, path[len(at) :])
    ]


def _path_of(source: Any) -> ValuePath | None:
    try:
        return parse_path(source["path"])
    except (PathError, TypeError, KeyError, AttributeError):
        return None


def _united(*lists: Sources) -> Sources:
    """Join lists of sources; a later one replaces an earlier one of the same path."""
    joined: dict[Any, Any] = {}
    for number, source in enumerate(item for sources in lists for item in sources):
        path = _path_of(source)
        joined[path if path is not None else number] = source
    return list(joined.values())
