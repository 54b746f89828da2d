"""Own catalogue files: an entry written out so that it can be changed and used by its own name."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path

from tautwire.catalogue.numbers import Number
from tautwire.catalogue.parts import LumpedPantograph, Part, Rope
from tautwire.errors import InputError
from tautwire.files import write_text
from tautwire.text import as_name

_HEAD = """\
# Own catalogue, begun as a copy of {origin!r}. Change the numbers and say where yours come from:
# seen (a document), derived (how), memory, or choice (why). Lines that start with '#' are derived
# from the others; to state one, take the '#' away and give its origin.
#
# In a case beside this file:
#   catalogue: {file}
#   and 'use: {name}' where the {kind} belongs.
kind: {kind}
entries:
  - name: {quoted}
    summary: {summary}
"""


def copy_part(part: Part, path: str | os.PathLike[str], *, force: bool = False) -> Path:
    """Write an entry as an own catalogue file; complete or not at all.

    Parameters
    ----------
    part
        The entry.
    path
        File to write, ending in ``.yaml`` or ``.yml``; the entry takes its name.
    force
        Whether an existing file is replaced.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    InputError
        When the file exists or cannot be written.
    """
    target = Path(path)
    if target.suffix.lower() not in (".yaml", ".yml"):
        raise InputError(f"{target}: the copy is YAML; choose a name that ends in .yaml")
    if target.is_dir() or (target.exists() and not force):
        raise InputError(f"{target}: exists already; choose another name or remove it first")
    write_text(target, part_as_text(part, target))
    return target


def part_as_text(part: Part, target: Path) -> str:
    """Return an entry as the text of an own catalogue file under the name of the file."""
    name = as_name(target.stem)
    head = _HEAD.format(
        origin=part.name, file=target.name, name=name, kind=part.kind,
        quoted=json.dumps(name), summary=json.dumps(part.summary),
    )  # fmt: skip
    return head + "".join(f"{line}\n" for line in _lines(part))


def _lines(part: Part) -> Iterator[str]:
    derived = {rule[0] for rule in part.rules}
    if isinstance(part, Rope):
        yield f"    wires: {part.wires}"
    for key, number in part:
        if isinstance(number, Number):
            follows = key in derived and number.confidence == "derived"
            yield f"{'    # ' if follows else '    '}{key}: {_number(number)}"
    if isinstance(part, LumpedPantograph):
        yield "    stages:"
        for stage in part.stages:
            numbers = [f"{key}: {_number(number)}" for key, number in stage]
            yield "      - " + "\n        ".join(numbers)


def _number(number: Number) -> str:
    origins = number.origins[0] if len(number.origins) == 1 else list(number.origins)
    origin = json.dumps(origins, ensure_ascii=False)
    parts = [f"value: {number.text()}", f"{number.confidence}: {origin}"]
    if number.low is not None and number.high is not None:
        parts.append(f"range: [{number.in_words(number.low)}, {number.in_words(number.high)}]")
    if number.note:
        parts.append(f"note: {json.dumps(number.note)}")
    return "{" + ", ".join(parts) + "}"
