"""Values of a case by their paths, as a table of a workbook has them: read and written."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

from tautwire.errors import InputError
from tautwire.inputs.paths import Path, PathError, find_target, format_path, parse_path, value_at
from tautwire.inputs.reading.documents import parse_value
from tautwire.inputs.reading.grouping import grouped
from tautwire.tables.line import LineTables
from tautwire.tables.sheets import LONGEST_CELL, Cell

_GAP = object()


def said_values(tables: LineTables) -> dict[str, Any]:
    """Return the values that a workbook gives by their paths, as nested plain data.

    Raises
    ------
    InputError
        Naming every cell whose path leads to nothing or that says again what another table says.
    """
    result: dict[str, Any] = {}
    problems = []
    for one in tables.said:
        try:
            path = parse_path(one.path)
            if path != ("schema",):
                find_target(path)
            value = _value_of(one.value)
            _refuse_other(tables.values, path, value)
            _put(result, path, value)
        except (PathError, ValueError) as error:
            problems.append(f"{one.place}: {error}")
    if not problems:
        problems = [
            f"{format_path(path)}: an item of the list is missing" for path in _gaps(result)
        ]
    if problems:
        raise InputError(grouped(problems))
    return result


def rows_of(data: Mapping[str, Any]) -> list[tuple[str | None, Cell]]:
    """Return plain data of a case as paths and cells, from which the same data are read."""
    return [row for path, cell in _leaves(data, ()) for row in _in_pieces(format_path(path), cell)]


def _in_pieces(path: str, cell: Cell) -> Iterator[tuple[str | None, Cell]]:
    """Yield a value, a text that no cell holds in pieces, of which only the first has the path.

    No piece begins or ends where a reader of sheets would take something away, or takes a row for a
    comment.
    """
    rest, told = cell, path
    while isinstance(rest, str) and len(rest) > LONGEST_CELL:
        at = LONGEST_CELL
        while rest[at - 1].isspace() or rest[at].isspace() or rest[at] == "#":
            at -= 1
        yield told, rest[:at]
        rest, told = rest[at:], None
    yield told, rest


def _refuse_other(tables: Mapping[str, Any], path: Path, value: Any) -> None:
    other = value_at(tables, path)
    if other is not None and other != value:
        text = "another table of the workbook says otherwise; keep one"
        raise PathError(f"{format_path(path)}: got {value!r}; {text}")


def _value_of(cell: Cell) -> Any:
    if isinstance(cell, str):
        return parse_value(cell)
    return int(cell) if isinstance(cell, float) and cell.is_integer() else cell


def _put(node: Any, path: Path, value: Any) -> None:
    """Put a value into nested mappings and lists, which grow as needed."""
    for step, after in zip(path, (*path[1:], None), strict=True):
        if isinstance(step, int):
            node.extend([_GAP] * (step + 1 - len(node)))
        elif not isinstance(node, dict):
            raise PathError(f"{format_path(path)}: what stands above it is given as a whole")
        there = node[step] if isinstance(step, int) else node.get(step, _GAP)
        if after is None:
            if there is not _GAP:
                raise PathError(f"{format_path(path)}: is given twice; keep one")
            node[step] = value
            return
        if there is _GAP:
            there = node[step] = [] if isinstance(after, int) else {}
        if not isinstance(there, list if isinstance(after, int) else dict):
            raise PathError(f"{format_path(path)}: what stands above it is given as a whole")
        node = there


def _gaps(node: Any, at: Path = ()) -> Iterator[Path]:
    if node is _GAP:
        yield at
    items = (
        node.items()
        if isinstance(node, dict)
        else enumerate(node)
        if (isinstance(node, list))
        else ()
    )
    for key, value in items:
        yield from _gaps(value, (*at, key))


def _leaves(node: Any, at: Path) -> Iterator[tuple[Path, Cell]]:
    """Yield every value; lists of plain values as one text, in pieces where it is too long."""
    if isinstance(node, Mapping) and node:
        for key, value in node.items():
            yield from _leaves(value, (*at, key))
    elif isinstance(node, (list, tuple)) and node and not _is_short(node):
        for index, value in enumerate(node):
            yield from _leaves(value, (*at, index))
    elif node not in (None, "", [], {}) or at == ("droppers",):
        yield at, _cell_of(node)


def _is_short(items: Any) -> bool:
    is_plain = not any(isinstance(item, (Mapping, list, tuple)) for item in items)
    return is_plain and len(json.dumps(items)) <= LONGEST_CELL


def _cell_of(value: Any) -> Cell:
    """Return a value as a cell: numbers as they are, texts that would be read otherwise quoted."""
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return value
    if isinstance(value, str) and _reads_back(value):
        return value
    return json.dumps(value, ensure_ascii=False)


def _reads_back(text: str) -> bool:
    try:
        return bool(text) and text == text.strip() and parse_value(text) == text
    except ValueError:
        return False
