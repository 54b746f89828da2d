"""What the catalogue gives to a case: own catalogue files, and ``use: NAME`` written out."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from tautwire.catalogue.parts import Part
from tautwire.catalogue.shelf import Shelf, package_shelf, read_parts
from tautwire.errors import InputError
from tautwire.inputs.documents import parse_document
from tautwire.inputs.files import read_case_text


def shelf_with(own: Iterable[Path]) -> Shelf:
    """Return the catalogue, with the entries of own files found first.

    Parameters
    ----------
    own
        YAML, TOML or JSON files; the first ones win.

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
    return package_shelf().with_own(parts) if parts else package_shelf()
