"""Reference cases and pantographs that come with the program, as commented YAML files."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Literal

from tautwire.errors import InputError

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
    library is still found there.

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
    if target.is_dir() or (target.exists() and not force):
        raise InputError(f"{target}: exists already; choose another name or remove it first")
    write_whole(
        target, f"# Copied from '{name}' of the tautwire library.\n" + _renamed(text, target)
    )
    return target


@lru_cache(maxsize=1)
def _index() -> dict[Entry, Traversable]:
    index: dict[Entry, Traversable] = {}
    root = files("tautwire.catalogue")
    for kind, folder, ending in _FOLDERS:
        resources = [r for r in root.joinpath(folder).iterdir() if r.name.endswith(".yaml")]
        for resource in sorted(resources, key=lambda r: r.name.removesuffix(".yaml")):
            first = resource.read_text(encoding="utf-8").partition("\n")[0]
            name = resource.name.removesuffix(".yaml") + ending
            index[Entry(name, kind, first.lstrip("# "))] = resource
    return index


def _renamed(text: str, target: Path) -> str:
    """Give the copy the name of its file, so that its results are not taken for the original's."""
    name = re.sub(r"[^A-Za-z0-9._+-]", "-", target.stem)[:60]
    return re.sub(r"^name: .*$", f'name: "{name}"', text, count=1, flags=re.MULTILINE)


def write_whole(target: Path, text: str) -> None:
    """Write a text file completely or not at all.

    Raises
    ------
    InputError
        When it cannot be written.
    """
    draft = target.with_name(f".{target.name}.{os.getpid()}.part")
    try:
        draft.write_text(text, encoding="utf-8")
        draft.replace(target)
    except OSError as error:
        raise InputError(
            f"{target}: cannot be written ({error.strerror or error}); check that the folder "
            "exists and may be written to"
        ) from None
    finally:
        draft.unlink(missing_ok=True)
