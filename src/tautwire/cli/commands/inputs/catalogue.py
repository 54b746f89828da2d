"""``catalogue``: wires, ropes, droppers, clamps, arms and pantographs by name."""

from __future__ import annotations

from pathlib import Path

from tautwire.catalogue.own_file import copy_part
from tautwire.catalogue.parts import KIND_NAMES, Part
from tautwire.catalogue.shelf import Shelf
from tautwire.cli.session import Answer
from tautwire.cli.views.catalogue_view import as_data, details, listing
from tautwire.cli.views.tables import heading
from tautwire.errors import InputError
from tautwire.inputs.completion import shelf_with
from tautwire.inputs.reading.files import did_you_mean


def show_catalogue(answer: Answer, words: str, kind: str | None, own: Path | None) -> None:
    """Show the entry of a name, or list those whose name or text holds all words."""
    shelf, kind = shelf_with([own] if own else []), _known_kind(kind)
    exact = _exact(shelf, words, kind)
    found = (exact,) if exact else shelf.search(words, kind)
    if not found:
        shelf.find(words, (kind,) if kind else KIND_NAMES)
    answer.document["entries"] = [as_data(part) for part in found]
    if len(found) == 1:
        answer.show(*details(found[0]), *_how_to_use(found[0]))
    else:
        answer.show(*listing(found), *_how_to_go_on())


def copy_entry(answer: Answer, name: str, path: Path, own: Path | None, *, force: bool) -> None:
    """Write an entry as an own catalogue file."""
    if not name:
        raise InputError(
            '--copy needs the name of what to copy, as in \'tautwire catalogue "AC-120 CuMg0.5" '
            "--copy my-wire.yaml'"
        )
    part = shelf_with([own] if own else []).find(name)
    written = copy_part(part, path, force=force)
    answer.document.update({"name": part.name, "file": str(written)})
    answer.show(
        f"{written} written. Edit it, name it in a case ('catalogue: {written.name}'), and write "
        f"'use: {written.stem}' there."
    )


def _known_kind(kind: str | None) -> str | None:
    if kind is None or kind in KIND_NAMES:
        return kind
    hint = did_you_mean(kind, KIND_NAMES) or f"; choose {', '.join(KIND_NAMES)}"
    raise InputError(f"--kind: there is no kind {kind!r}{hint}")


def _exact(shelf: Shelf, words: str, kind: str | None) -> Part | None:
    try:
        return shelf.find(words, (kind,) if kind else KIND_NAMES) if words else None
    except InputError:
        return None


def _how_to_use(part: Part) -> list[object]:
    return [
        heading("Next"),
        f"use: {part.name}    in a case, where a {part.kind} belongs\n"
        f'tautwire catalogue "{part.name}" --copy my-own.yaml    an own entry to change',
    ]


def _how_to_go_on() -> list[object]:
    return [
        heading("Next"),
        'tautwire catalogue "AC-120 CuMg0.5"    every number with its source\n'
        "tautwire catalogue bronze --kind rope  those that hold a word",
    ]
