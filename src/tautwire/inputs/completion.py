"""What the catalogue gives to a case: own catalogue files, and ``use: NAME`` written out.

``use`` works in every mapping whose spec names kinds of the catalogue. The entry's numbers that the
spec has fields for are put in, each with its source and confidence; further keys of the mapping
change them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from tautwire.catalogue.numbers import Number
from tautwire.catalogue.parts import Part
from tautwire.catalogue.shelf import Shelf, package_shelf, read_parts
from tautwire.errors import InputError
from tautwire.inputs.merge import merge
from tautwire.inputs.paths import USE, PathError, fields_by_key, find_target, format_path
from tautwire.inputs.paths import Path as ValuePath
from tautwire.inputs.reading.documents import parse_document
from tautwire.inputs.reading.files import read_case_text

Sources = list[dict[str, str]]


def shelf_with(own: Iterable[Path], below: Shelf | None = None) -> Shelf:
    """Return the catalogue, with the entries of own files found first.

    Parameters
    ----------
    own
        YAML, TOML or JSON files; the first ones win.
    below
        What is found after them; by default the entries of the package.

    Raises
    ------
    InputError
        When a file cannot be read or holds what it should not; every fault is named.
    """
    parts: list[Part] = []
    problems: list[str] = []
    for path in own:
        try:
            data = parse_document(read_case_text(path), str(path), path.suffix)
            parts += read_parts(data, str(path))
        except InputError as error:
            problems += error.problems
    if problems:
        raise InputError(problems)
    shelf = below or package_shelf()
    return shelf.with_own(parts) if parts else shelf


def own_files(given: Any, folder: Path | None, label: str) -> list[Path]:
    """Return the files that the key ``catalogue`` of a document names.

    Raises
    ------
    InputError
        When it holds anything but file names.
    """
    names = given if isinstance(given, list) else [given]
    if not all(isinstance(name, str) and name for name in names):
        raise InputError(f"{label}: catalogue: got {given!r}; give a file, or a list of files")
    return [(folder or Path()) / name for name in names]


def write_out(
    names: Any, own: Mapping[str, Any], at: ValuePath, shelf: Shelf
) -> tuple[dict[str, Any], Sources]:
    """Return what the entries named by ``use`` give to a mapping, and the sources of it.

    Parameters
    ----------
    names
        What stands after ``use``: a name, or a list of names of which later ones complete earlier
        ones.
    own
        The other keys of the mapping; a word in place of a number chooses a variant of it, as in
        ``bending_stiffness: slip``.
    at
        Path of the mapping in the case.
    shelf
        Where the names are looked up.

    Raises
    ------
    InputError
        When a name is unknown, or nothing of the catalogue belongs here.
    """
    place = format_path((*at, USE))
    try:
        spec = find_target(at).spec
    except PathError:  # the key above is unknown: validation says so, with the likely one
        return {}, []
    if spec is None or not spec.catalogue_kinds:
        raise InputError(
            f"{place}: nothing of the catalogue belongs here; 'use' stands in a wire, in "
            "droppers, supports, an arm or a pantograph"
        )
    listed = names if isinstance(names, list) else [names]
    if not listed or not all(isinstance(name, str) for name in listed):
        raise InputError(f"{place}: got {names!r}; give the name of a catalogue entry")
    values: dict[str, Any] = {}
    sources: Sources = []
    for name in listed:
        try:
            part = shelf.find(name, spec.catalogue_kinds)
        except InputError as error:
            raise InputError(f"{place}: {error}") from None
        filling = {k: v for k, v in part.filling().items() if k in fields_by_key(spec)}
        filling |= _variants(part, own)
        values = merge(values, _plain(filling))
        sources += _sources(part, filling, at)
    return values, sources


def chosen_variants(own: Mapping[str, Any], given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keys of a mapping without the words that chose variants of what was given."""
    return {
        key: value
        for key, value in own.items()
        if not (isinstance(value, str) and value in _WORDS and key in given)
    }


_WORDS = {"slip": "bending_stiffness_slip", "stick": "bending_stiffness"}
"""Words that stand for a number, and the number of the entry that they stand for."""


def _variants(part: Part, own: Mapping[str, Any]) -> dict[str, Number]:
    numbers = part.numbers()
    return {
        key: numbers[_WORDS[word]]
        for key, word in own.items()
        if isinstance(word, str)
        and _WORDS.get(word, "").startswith(key)
        and _WORDS[word] in numbers
    }


def _plain(node: Any) -> Any:
    """Return a filling with every number as its SI value."""
    if isinstance(node, Number):
        return node.value
    if isinstance(node, Mapping):
        return {key: _plain(value) for key, value in node.items()}
    return [_plain(item) for item in node]


def _sources(part: Part, filling: Mapping[str, Any], at: ValuePath) -> Sources:
    """Return one source per number; a list has one for all, and one for each that differs."""
    sources: Sources = []
    for key, value in filling.items():
        numbers = dict(_leaves(value, (*at, key)))
        if isinstance(value, list):
            (usual, _), *_ = Counter((n.source, n.trust()) for n in numbers.values()).most_common(1)
            sources.append(_source(part, (*at, key), *usual))
            numbers = {p: n for p, n in numbers.items() if (n.source, n.trust()) != usual}
        sources += [_source(part, path, n.source, n.trust()) for path, n in numbers.items()]
    return sources


def _source(part: Part, path: ValuePath, origin: str, trust: str) -> dict[str, str]:
    text = f"Catalogue, {part.name}: {origin}"
    return {"path": format_path(path), "source": text, "confidence": trust}


def _leaves(node: Any, at: ValuePath) -> Iterator[tuple[ValuePath, Number]]:
    if isinstance(node, Number):
        yield at, node
        return
    items = node.items() if isinstance(node, Mapping) else enumerate(node)
    for key, value in items:
        yield from _leaves(value, (*at, key))
