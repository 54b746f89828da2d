"""From the text of a case file to plain data: includes, tables and sources put together."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

from tautwire.catalogue.entries import list_entries, read_entry
from tautwire.catalogue.shelf import Shelf, package_shelf
from tautwire.errors import InputError
from tautwire.inputs import inheritance
from tautwire.inputs.attached import with_image, with_limits
from tautwire.inputs.completion import chosen_variants, own_files, shelf_with, write_out
from tautwire.inputs.merge import merge, paths_of, with_table
from tautwire.inputs.paths import (
    USE,
    fields_by_key,
    find_target,
    format_path,
    spec_at,
    value_at,
)
from tautwire.inputs.paths import Path as ValuePath
from tautwire.inputs.reading.documents import SUFFIXES, parse_document
from tautwire.inputs.reading.files import did_you_mean, named, neighbours, read_case_text
from tautwire.inputs.reading.reach import Reach
from tautwire.inputs.reading.tables import (
    Cells,
    cells_by_list,
    line_sheet,
    line_tables,
    read_columns,
)
from tautwire.specs.base import Spec
from tautwire.specs.schema.upgrade import READ_VERSIONS, SCHEMA_VERSION, upgraded
from tautwire.tables.columns import KINDS, Field, named_field
from tautwire.tables.line import SECTIONS
from tautwire.tables.mapping import SheetMapping
from tautwire.text import shown

MAX_DOCUMENTS = 100
"""Documents that one case may be put together from."""
MAX_CHAIN = 8
"""Documents of which each includes the next."""

Sources = list[Any]
_OWN_KEYS = ("include", "tables", "schema", "sources", "use", "catalogue", "template")
"""Keys of a document that are no values of a case."""
_KEEPERS = {(): with_limits, ("project",): with_image}
"""By the place of a mapping: what takes the content of other files into it."""
TABLE = "table"
"""Key of a mapping whose columns stand in a CSV file."""


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
    cells
        By the path of a list that came from a table: what names the cell of each item.
    problems
        Sentences about tables that could not be used.
    incomplete
        Top-level keys that lack the content of such a table, and mappings that lack what they use.
    shelf
        The catalogue with the own files of the case.
    sheets
        The tables of the line that its documents name, their columns matched.
    """

    label: str
    values: dict[str, Any] = field(default_factory=dict)
    cells: dict[ValuePath, Cells] = field(default_factory=dict)
    problems: list[str] = field(default_factory=list)
    incomplete: set[str] = field(default_factory=set)
    shelf: Shelf = field(default_factory=package_shelf)
    sheets: list[SheetMapping] = field(default_factory=list)


def compose(name_or_path: str | Path) -> Composition:
    """Read a case with everything that it includes.

    Raises
    ------
    InputError
        When a file cannot be read or parsed, or an include cannot be resolved.
    """
    document = find_document(name_or_path, Path())
    composer = _Composer(Composition(document.label), Reach.of(document.folder))
    return composer.compose(document)


def compose_data(data: Mapping[str, Any], label: str = "case") -> Composition:
    """Put together a case given as plain data; what it includes is found where the program runs.

    Parameters
    ----------
    data
    label
        Where they come from, in messages.

    Raises
    ------
    InputError
        When an include cannot be resolved.
    """
    document = Document(label, "case", Path(), dict(data))
    return _Composer(Composition(label), Reach.of(Path())).compose(document)


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
            raise InputError(
                f"{named(path)}: is no case file; its name must end in {', '.join(SUFFIXES)}"
            )
        close = did_you_mean(str(reference), [*_library_names(), *neighbours(path)])
        raise InputError(
            f"{named(str(reference))}: there is no such case in the library and no such file"
            f"{close}; 'tautwire cases' lists the library"
        )
    content = parse_document(read_case_text(path), named(path), path.suffix)
    return Document(named(path), os.path.realpath(path), path.parent, content)


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

    def __init__(self, result: Composition, reach: Reach) -> None:
        self.result = result
        self._reach = reach
        self._documents = 0

    def compose(self, document: Document) -> Composition:
        """Compose the case that a document describes."""
        part = self.document(document, (), ())
        self.result.values = {**part.values}
        if part.sources:
            self.result.values.setdefault("sources", part.sources)
        return self.result

    def document(self, document: Document, at: ValuePath, trail: Trail) -> _Part:
        """Compose a whole document; the trail names the documents that include it."""
        self._refuse_endless(document, trail)
        _refuse_foreign(document, at)
        own = dict(document.content)
        _check_schema(own.get("schema", SCHEMA_VERSION), document.label)
        own = upgraded(own)
        if at:
            own.pop("schema", None)
        tables, template = own.pop("tables", None), own.pop("template", None)
        sources = _own_sources(own.pop("sources", []), at, document.label)
        outer = self.result.shelf
        self._take_own_catalogue(own.pop("catalogue", None), document)
        part = self._mapping(own, at, document, (*trail, document))
        line = _line_beside(part.values, trail)
        overlay, from_tables = self._tables(tables, own, document, line)
        if trail:
            self.result.shelf = outer
        values = with_table(part.values, overlay)
        kept = inheritance.still_true(part.sources, at, part.values, values)
        begun = self._of_template(template, values, at, document, trail)
        sources = inheritance.still_stated(sources, document.content, overlay, at)
        return _Part(values, inheritance.united(begun, kept, from_tables, sources))

    def _take_own_catalogue(self, given: Any, document: Document) -> None:
        """Put the own catalogue files of a document before what its includers brought."""
        if given is None:
            return
        try:
            paths = own_files(given, document.folder, document.label)
            for path in paths:
                self._reach.check(path, document.label)
            self.result.shelf = shelf_with(paths, self.result.shelf)
        except InputError as error:
            self.result.problems += error.problems

    def _of_template(
        self, name: Any, values: Mapping[str, Any], at: ValuePath, document: Document, trail: Trail
    ) -> Sources:
        """Return the sources of what a document still has in common with its template."""
        if name is None:
            return []
        if at or name not in _library_names():
            raise InputError(
                f"{document.label}: template: got {name!r}; it names the library case of which "
                f"the file is a copy: {', '.join(_library_names())}"
            )
        base = self.document(find_document(name, None), at, (*trail, document))
        return inheritance.marked(
            inheritance.still_true(base.sources, at, base.values, values), name
        )

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

    def _included(self, reference: str, document: Document) -> Document:
        if reference not in _library_names():
            self._reach.check((document.folder or Path()) / reference, document.label)
        return find_document(reference, document.folder)

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
                    f"{document.label}: {place}: got {shown(reference)}; give one library name or "
                    "file"
                )
            base = self.document(self._included(reference, document), at, trail)
            if not at:
                base = self._inherited(base, reference, document)
        own = self._with_columns(own, at, document)
        if keep := _KEEPERS.get(at):
            own, problems = keep(own, document.folder or Path(), self._reach, document.label)
            self.result.problems += problems
        used = self._used(own, at, document)
        values: dict[str, Any] = {}
        sources: Sources = []
        for key, value in chosen_variants(own, used.values).items():
            part = self._value(value, (*at, key), document, trail)
            values[key] = part.values[key]
            sources += part.sources
        return self._over(base, self._over(used, _Part(values, sources), at), at)

    def _inherited(self, base: _Part, reference: str, document: Document) -> _Part:
        """Leave out what a case never takes over, and mark what a user's case takes over."""
        values = inheritance.without_identity(base.values, document.label)
        from_library = reference in _library_names() and document.folder is not None
        sources = inheritance.marked(base.sources, reference) if from_library else base.sources
        return _Part(values, sources)

    def _used(self, own: dict[str, Any], at: ValuePath, document: Document) -> _Part:
        """Take the key 'use' out of a mapping and return what it gives."""
        if USE not in own:
            return _Part({}, [])
        try:
            return _Part(*write_out(own.pop(USE), own, at, self.result.shelf))
        except InputError as error:
            self.result.problems += [f"{document.label}: {text}" for text in error.problems]
            self.result.incomplete.add(format_path(at))
            return _Part({}, [])

    @staticmethod
    def _over(base: _Part, local: _Part, at: ValuePath) -> _Part:
        """Merge two parts of a mapping; sources of replaced numbers go."""
        merged = merge(base.values, local.values)
        kept = inheritance.still_true(base.sources, at, base.values, merged)
        return _Part(merged, inheritance.united(kept, local.sources))

    def _value(self, value: Any, at: ValuePath, document: Document, trail: Trail) -> _Part:
        """Compose one value; the part holds it under the last step of its path."""
        key = str(at[-1])
        if isinstance(value, Mapping):
            part = self._mapping(value, at, document, trail)
            return _Part({key: part.values}, part.sources)
        if isinstance(value, list):
            parts = [self._value(item, (*at, i), document, trail) for i, item in enumerate(value)]
            items = [part.values[str(i)] for i, part in enumerate(parts)]
            return _Part({key: items}, [source for part in parts for source in part.sources])
        return _Part({key: value}, [])

    def _with_columns(
        self, own: dict[str, Any], at: ValuePath, document: Document
    ) -> dict[str, Any]:
        """Put the columns of a table in the place of the key 'table', where the spec has some."""
        spec = spec_at(at)
        if TABLE not in own or spec is None or not spec.table_columns:
            return own
        names, place = spec.table_columns, format_path(at)
        rest = {key: value for key, value in own.items() if key != TABLE}
        if not isinstance(own[TABLE], str) or not rest.keys().isdisjoint(names):
            raise InputError(
                f"{document.label}: {place}: give either {{table: file.csv}} or "
                f"{' and '.join(names)}"
            )
        try:
            path = self._table_path(own[TABLE], document)
            found = read_columns(path, _fields_at(at, spec), spec.optional_columns)
        except InputError as error:
            self.result.problems += error.problems
            self.result.incomplete.add(place)
            return rest
        self.result.cells |= {(*at, name): cell for name, cell in found.cells.items()}
        return {**rest, **found.values}

    def _table_path(self, file: str, document: Document) -> Path:
        path = (document.folder or Path()) / file
        self._reach.check(path, document.label)
        return path

    def _tables(
        self,
        tables: object,
        own: Mapping[str, Any],
        document: Document,
        line: Mapping[str, Any],
    ) -> tuple[dict[str, Any], Sources]:
        """Read the tables of a document beside the line of its case.

        Returns what they say about the case, and the sources.
        """
        files, mappings = _table_files(tables, document.label), []
        for kind, file in files.items():
            try:
                mappings.append(line_sheet(kind, self._table_path(file, document)))
            except InputError as error:
                self._miss(error, (kind,))
        self.result.sheets += mappings
        try:
            found = line_tables(mappings, line)
        except InputError as error:
            self._miss(error, files)
            return {}, []
        file_of = {section: files[kind] for kind in files for section in SECTIONS[kind]}
        self.result.problems += _given_twice(found.values, own, file_of, document.label)
        self.result.cells |= cells_by_list(found.origins)
        sources: Sources = [
            {"path": format_path(path), "source": f"Table {file_of[str(path[0])]}",
             "confidence": "one source"}
            for path in paths_of(found.values)
        ]  # fmt: skip
        return found.values, sources

    def _miss(self, error: InputError, kinds: Iterable[str]) -> None:
        """Note why tables cannot be used, and which parts of the case lack their content."""
        self.result.problems += error.problems
        self.result.incomplete.update(section for kind in kinds for section in SECTIONS[kind])


def _refuse_foreign(document: Document, at: ValuePath) -> None:
    """Refuse a file that has no key of a case, without a word of its content."""
    spec = spec_at(at)
    own = fields_by_key(spec) if spec is not None else {}
    if own and document.content and not {*own, *_OWN_KEYS} & document.content.keys():
        raise InputError(
            f"{document.label}: holds none of the keys of {format_path(at) or 'a case'}, which are "
            f"{', '.join(own)}; check that it is the right file"
        )


def _line_beside(values: Mapping[str, Any], trail: Trail) -> dict[str, Any]:
    """Return the line of the case that a document is part of, without what tables say about it.

    Parameters
    ----------
    values
        What the document and those that it includes say.
    trail
        The documents that include it; the outermost wins.
    """
    line: dict[str, Any] = {}
    for content in (values, *(one.content for one in reversed(trail))):
        if isinstance(own := content.get("line"), Mapping):
            line = merge(line, own)
    return line


def _fields_at(at: ValuePath, spec: type[Spec]) -> list[Field]:
    quantities = [find_target((*at, name)).quantity for name in spec.table_columns]
    return [
        named_field(name, quantity.unit if quantity is not None else "")
        for name, quantity in zip(spec.table_columns, quantities, strict=True)
    ]


def _check_schema(version: object, label: str) -> None:
    if version not in READ_VERSIONS or isinstance(version, bool):
        raise InputError(
            f"{label}: schema: got {shown(version)}; this program reads versions 1 and "
            f"{SCHEMA_VERSION} of the input format. Write 'schema: {SCHEMA_VERSION}', and compare "
            "the file with the "
            "input reference if it was written for another version"
        )


def _table_files(tables: object, label: str) -> dict[str, str]:
    if tables is None:
        return {}
    if not isinstance(tables, dict):
        raise InputError(f"{label}: tables: expected {{supports: file.csv, droppers: file.csv}}")
    problems = []
    for name, file in tables.items():
        if name not in KINDS:
            hint = did_you_mean(name, KINDS) or f"; known are: {', '.join(KINDS)}"
            problems.append(f"{label}: tables.{name}: unknown table{hint}")
        elif not isinstance(file, str):
            problems.append(f"{label}: tables.{name}: got {shown(file)}; give the path of a table")
    if problems:
        raise InputError(problems)
    return tables


def _given_twice(
    table: Mapping[str, Any], own: Mapping[str, Any], files: Mapping[str, str], label: str
) -> list[str]:
    """Name the values that a document gives beside a table which says otherwise."""
    problems = []
    for path in paths_of(table):
        given, file = value_at(own, path), files[str(path[0])]
        if given is not None and given != value_at(table, path):
            problems.append(
                f"{label}: {format_path(path)}: is given here and in the table {file}; keep one"
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
