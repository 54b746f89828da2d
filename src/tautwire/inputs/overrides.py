"""Single values of a case replaced from the command line or from Python."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from tautwire.catalogue.shelf import Shelf, package_shelf
from tautwire.errors import InputError
from tautwire.inputs.completion import USE, write_out
from tautwire.inputs.merge import clear_excluded
from tautwire.inputs.paths import Path, PathError, find_target, format_path, parse_path, value_at
from tautwire.inputs.reading.documents import parse_value
from tautwire.specs.line.catenary import MOST_SPANS
from tautwire.units import UnitError, parse_quantity

Overrides = Mapping[str, Any] | Iterable[str]
Data = dict[str, Any]

PROTECTED = ("schema", "sources")
OVERRIDDEN = "Set for this run"


def apply_overrides(
    data: Mapping[str, Any], overrides: Overrides, shelf: Shelf | None = None
) -> tuple[Data, list[str]]:
    """Return the case with some values replaced, and the problems met.

    Parameters
    ----------
    data
        The case as plain data; it is left as it is.
    overrides
        Values by path, or texts ``path=value``. Indices count from 1. Setting
        ``scenario.mean_force`` clears ``scenario.uplift_force`` and the reverse. A value that holds
        for all spans, supports or pantographs is spread out when one item of it is set. Setting
        ``use`` sets every number of the catalogue entry named.
    shelf
        The catalogue; by default that of the package.
    """
    result, problems = dict(data), []
    pairs, malformed = _pairs(overrides)
    problems += malformed
    for text, value in pairs:
        try:
            path = parse_path(text)
            if path[-1] == USE:
                result = _with_entry(result, path[:-1], value, shelf or package_shelf())
                continue
            _check_path(path)
            result = _replaced(result, path, value)
        except (PathError, UnitError, InputError) as error:
            problems.append(f"override {error}")
    return result, problems


def _with_entry(data: Data, at: Path, name: Any, shelf: Shelf) -> Data:
    """Set what a catalogue entry gives to the mapping at a path."""
    values, sources = write_out(name, {}, at, shelf)
    for key, value in values.items():
        _check_path((*at, key))
        data = _replaced(data, (*at, key), value)
    named = [{**source, "source": f"{OVERRIDDEN}: {source['source']}"} for source in sources]
    replaced = {format_path((*at, key)) for key in values}
    kept = [source for source in data["sources"] if source["path"] not in replaced]
    return {**data, "sources": [*kept, *named]}


def _pairs(overrides: Overrides) -> tuple[list[tuple[str, Any]], list[str]]:
    if isinstance(overrides, Mapping):
        return list(overrides.items()), []
    pairs, problems = [], []
    for text in [overrides] if isinstance(overrides, str) else overrides:
        path, equals, value = text.partition("=")
        if not equals or not value.strip():
            problems.append(f"override {text!r}: write path=value, as in scenario.speed='275 km/h'")
            continue
        try:
            pairs.append((path, parse_value(value)))
        except ValueError as error:
            problems.append(f"override {path.strip()}: {error}")
    return pairs, problems


def _check_path(path: Path) -> None:
    if path[0] in PROTECTED:
        raise PathError(f"{format_path(path)}: cannot be overridden; edit the file")
    for depth in range(1, len(path)):
        above, target = format_path(path[:depth]), find_target(path[:depth])
        is_list = target.holds_list()
        if isinstance(path[depth], int) and not is_list:
            raise PathError(f"{above}: is not a list; leave out the index")
        if isinstance(path[depth], str) and isinstance(path[depth - 1], str) and is_list:
            if target.holds_mapping():
                continue
            item = format_path((*path[:depth], 0, path[depth]))
            raise PathError(f"{above}: is a list; say which item, as in {item}")
    find_target(path)


def _replaced(data: Data, path: Path, value: Any) -> Data:
    result = _set(data, (), path, value, data)
    sources = result.get("sources", [])
    if not isinstance(sources, (list, tuple)):
        return result
    kept = [source for source in sources if not _is_outdated(source, path, data, result)]
    mark = {"path": format_path(path), "source": OVERRIDDEN, "confidence": "choice"}
    return {**result, "sources": [*kept, mark]}


def _is_outdated(source: Any, replaced: Path, before: Data, after: Data) -> bool:
    """Tell whether a source speaks of a value that was replaced or taken away."""
    try:
        path = parse_path(source["path"])
    except (PathError, TypeError, KeyError, AttributeError):
        return False
    gone = value_at(before, path) is not None and value_at(after, path) is None
    return gone or path[: len(replaced)] == replaced


def _set(node: Any, at: Path, rest: Path, value: Any, case: Data) -> Any:
    """Return a copy of a node with the value at the rest of the path replaced."""
    if not rest:
        return value
    step, after = rest[0], rest[1:]
    if isinstance(step, int):
        items = _as_list(node, at, after, case)
        if step >= len(items):
            place = format_path((*at, step))
            raise PathError(f"{place}: the list has {len(items)} values, numbered from 1")
        items[step] = _set(items[step], (*at, step), after, value, case)
        return items
    mapping = _as_mapping(node, at)
    changed = _set(mapping.get(step), (*at, step), after, value, case)
    return {**clear_excluded(mapping, {step: changed}), step: changed}


def _as_mapping(node: Any, at: Path) -> dict[str, Any]:
    """Return a node as a mapping, written out where a word or a number stands for one."""
    if isinstance(node, Mapping):
        return dict(node)
    match at:
        case ("line", "ends") if isinstance(node, str):
            return {"left": node, "right": node}
        case ("settings", "integrator") if isinstance(node, str):
            return {"method": node}
        case ("scenario", "mean_force") if node is not None:
            return {"constant": node, "per_speed_squared": 0.0}
        case _:
            return {}


def _as_list(node: Any, at: Path, after: Path, case: Data) -> list[Any]:
    """Return a node as a list, spread out where one value or one list holds for all items."""
    is_list = isinstance(node, (list, tuple))
    if at in _DROPPER_LISTS and after and is_list and _is_flat(node):
        return [list(node) for _ in range(_spans(case))]
    if is_list:
        return list(node)
    spread = _SPREAD.get(at)
    if spread is None or node is None:
        raise PathError(f"{format_path(at)}: holds no list; give the whole list first")
    return spread(node, case)


def _is_flat(node: Any) -> bool:
    return not any(isinstance(item, (list, tuple)) for item in node)


def _spans(case: Data) -> int:
    spans, lengths = (value_at(case, ("line", key)) for key in ("spans", "span_length"))
    if isinstance(lengths, (list, tuple)):
        return len(lengths)
    if not isinstance(spans, int) or not 0 < spans <= MOST_SPANS:
        raise PathError("line.spans: is needed to set a single item; give it first")
    return spans


def _per_span(value: Any, case: Data) -> list[Any]:
    return [value] * _spans(case)


def _per_support(value: Any, case: Data) -> list[Any]:
    return [value] * (_spans(case) + 1)


def _alternating(value: Any, case: Data) -> list[Any]:
    if value == "contact":
        return list(_as_list(value_at(case, _STAGGER), _STAGGER, (), case))
    stagger = parse_quantity(value, "m")
    return [stagger if i % 2 == 0 else -stagger for i in range(_spans(case) + 1)]


def _per_pantograph(value: Any, case: Data) -> list[Any]:
    return [value] * len(case.get("pantographs") or [])


_STAGGER: Path = ("supports", "contact_stagger")
_DROPPER_LISTS = {("droppers", name) for name in ("positions", "presag", "lengths")}
_SPREAD: dict[Path, Callable[[Any, Data], list[Any]]] = {
    ("line", "span_length"): _per_span,
    ("supports", "contact_height"): _per_support,
    ("supports", "encumbrance"): _per_support,
    _STAGGER: _alternating,
    ("supports", "messenger_stagger"): _alternating,
    ("scenario", "uplift_force"): _per_pantograph,
    ("scenario", "uplift_guess"): _per_pantograph,
}
"""How one value for all is spread out into a list."""
