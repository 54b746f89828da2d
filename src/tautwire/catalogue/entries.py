"""Reference cases and pantographs that come with the program, as commented YAML files."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Literal

from tautwire.errors import InputError
from tautwire.files import write_text
from tautwire.text import as_name

Kind = Literal["case", "pantograph"]
_FOLDERS: tuple[tuple[Kind, str, str], ...] = (
    ("case", "cases", ""),
    ("pantograph", "pantographs", "-pantograph"),
)
"""Kind of entry, its folder, and the ending of its names."""


@dataclass(frozen=True)
class Entry:
    """One file of the library.

    Attributes
    ----------
    name
        What a user writes: ``ac-simple``, ``benchmark-2015-pantograph``.
    kind
        Whether it is a whole case or a pantograph to include in one.
    summary
        First line of the file.
    """

    name: str
    kind: Kind
    summary: str


def list_entries() -> tuple[Entry, ...]:
    """Return everything the library holds, cases first."""
    return tuple(_index())


def read_entry(name: str) -> str:
    """Return the text of a library file.

    Parameters
    ----------
    name
        Name of the case or pantograph.

    Raises
    ------
    InputError
        When the library holds nothing of that name.
    """
    for entry, resource in _index().items():
        if entry.name == name:
            return resource.read_text(encoding="utf-8")
    names = ", ".join(entry.name for entry in _index())
    raise InputError(f"the library holds nothing named {name!r}; it holds: {names}")


def copy_case(name: str, path: str | os.PathLike[str], *, force: bool = False) -> Path:
    """Write a library file to a place where it can be edited; complete or not at all.

    The copy takes the name of the file and can be loaded as it is; what it includes from the
    library is still found there. The copy of a case names its template: sources hold for what it
    still has in common with it, its title and description are left to the user.

    Parameters
    ----------
    name
        Name of the case or pantograph.
    path
        File to write, ending in ``.yaml`` or ``.yml``.
    force
        Whether an existing file is replaced.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    InputError
        When the name is unknown, the file exists, or it cannot be written.
    """
    text, target = read_entry(name), Path(path)
    if target.suffix.lower() not in (".yaml", ".yml"):
        raise InputError(f"{target}: the copy is YAML; choose a name that ends in .yaml")
    if os.path.lexists(target) and (target.is_dir() or not force):
        raise InputError(f"{target}: exists already; choose another name, or --force")
    write_text(
        target, f"# Copied from '{name}' of the tautwire library.\n" + _as_own(text, name, target)
    )
    return target


@lru_cache(maxsize=1)
def _index() -> dict[Entry, Traversable]:
    index: dict[Entry, Traversable] = {}
    root = files("tautwire.catalogue")
    for kind, folder, ending in _FOLDERS:
        resources = _yaml_files(root.joinpath(folder))
        for resource in sorted(resources, key=lambda r: r.name.removesuffix(".yaml")):
            first = resource.read_text(encoding="utf-8").partition("\n")[0]
            name = resource.name.removesuffix(".yaml") + ending
            index[Entry(name, kind, first.lstrip("# "))] = resource
    return index


def _yaml_files(folder: Traversable) -> Iterator[Traversable]:
    """Yield the files of a folder and of its sub-folders, which only keep it easy to survey."""
    for resource in folder.iterdir():
        if resource.is_dir():
            yield from _yaml_files(resource)
        elif resource.name.endswith(".yaml"):
            yield resource


def _as_own(text: str, origin: str, target: Path) -> str:
    """Give a copy a name and a template in place of the title and sources of its origin."""
    name = as_name(target.stem)
    identity = (
        f'name: "{name}"\n'
        f"template: {origin}       # numbers left as they are count as taken over from it\n"
        '# title: ...\n# description: ...\n'
    )  # fmt: skip
    if not re.search(r"^name: ", text, re.MULTILINE):
        return text
    text = re.sub(r"^(title|description): .*\n(?:[ ]+.*\n)*", "", text, flags=re.MULTILINE)
    text = re.sub(r"(?m)(?:^#.*\n)*^sources:(?s:.*)\Z", lambda _: _OWN_SOURCES, text)
    return re.sub(r"^name: .*\n", lambda _: identity, text, count=1, flags=re.MULTILINE)


_OWN_SOURCES = """\
# Where your numbers come from, shown in the report:
# sources:
#   - {path: wires.contact.tension, source: drawing 123, confidence: one source}
"""
