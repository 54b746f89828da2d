"""Merging of plain data: what stands locally completes or replaces what was included."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

EXCLUSIVE = (("mean_force", "uplift_force"), ("spring", "axial"))
"""Keys of one mapping that exclude each other: setting one takes the other away."""


def merge(base: Mapping[str, Any], local: Mapping[str, Any]) -> dict[str, Any]:
    """Merge two mappings; local values win, mappings are merged key by key, lists replaced."""
    merged = clear_excluded(base, local)
    for key, value in local.items():
        below = merged.get(key)
        if isinstance(below, Mapping) and isinstance(value, Mapping):
            merged[key] = merge(below, value)
        else:
            merged[key] = value
    return merged


def clear_excluded(base: Mapping[str, Any], local: Mapping[str, Any]) -> dict[str, Any]:
    """Return a copy of `base` without the keys that keys of `local` exclude."""
    dropped = {
        other
        for one, two in EXCLUSIVE
        for given, other in ((one, two), (two, one))
        if local.get(given) is not None and other not in local
    }
    return {key: value for key, value in base.items() if key not in dropped}


def with_table(values: Mapping[str, Any], table: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of a case with those of tables of its line in their place."""
    rest = {key: value for key, value in table.items() if key != "droppers"}
    merged = merge(values, rest)
    if "droppers" in table:
        merged["droppers"] = with_dropper_lists(values.get("droppers"), table["droppers"])
    return merged


def paths_of(table: Mapping[str, Any]) -> list[tuple[str | int, ...]]:
    """Return the paths of what tables of a line say; of sets of droppers the lists one by one."""
    paths: list[tuple[str | int, ...]] = []
    for section, values in table.items():
        if isinstance(values, Mapping):
            paths += [(section, key) for key in values]
        elif section == "droppers":
            paths += [(section, n, key) for n, one in enumerate(values) for key in one
                      if key != "set"]  # fmt: skip
        elif section != "sources":
            paths.append((section,))
    return paths


_LENGTHS = ("presag", "lengths")
"""Lists of a set of droppers of which a table replaces both where it has one."""


def with_dropper_lists(
    droppers: Any, table: Mapping[str, Any] | Sequence[Mapping[str, Any]]
) -> dict[str, Any] | list[dict[str, Any]]:
    """Return the droppers of a case with the lists of a table in them.

    Parameters
    ----------
    droppers
        One set, several, or None: what says how stiff and heavy they are.
    table
        The sets of the table. Each takes its other values from the set that it names by its number
        (``set``), else from the first one between the same wires, else from a single one.
    """
    given = droppers if isinstance(droppers, (list, tuple)) else [droppers]
    known = [one for one in given if isinstance(one, Mapping)]
    if isinstance(table, Mapping):
        return _with_lists(_set_of(known, table), table)
    return [_with_lists(_set_of(known, one), one) for one in table]


def _set_of(known: Sequence[Mapping[str, Any]], table: Mapping[str, Any]) -> Mapping[str, Any]:
    number = table.get("set")
    if isinstance(number, int) and 0 < number <= len(known):
        return known[number - 1]
    alike = [one for one in known if _between(one) == _between(table)]
    return next(iter(alike or known[:1]), {})


def _between(one: Mapping[str, Any]) -> tuple[Any, Any]:
    return one.get("from") or "messenger", one.get("to") or "contact"


def _with_lists(own: Mapping[str, Any], table: Mapping[str, Any]) -> dict[str, Any]:
    gone = {"about", *(_LENGTHS if any(key in table for key in _LENGTHS) else ())}
    kept = {key: value for key, value in own.items() if key not in gone}
    return {**kept, **{key: value for key, value in table.items() if key != "set"}}
