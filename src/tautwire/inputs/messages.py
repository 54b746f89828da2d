"""Faults found by validation, said in the user's words: where, what was got, what is allowed."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence, Set
from itertools import accumulate
from typing import Any

from pydantic import TypeAdapter, ValidationError
from pydantic_core import ErrorDetails

from tautwire.catalogue.parts import KINDS, Part
from tautwire.faults import BOUNDS, is_said_elsewhere, words_of
from tautwire.inputs.paths import (
    USE,
    Path,
    PathError,
    Target,
    fields_by_key,
    find_target,
    format_path,
    spec_at,
    unknown_key,
    value_at,
    without_forms,
    written_keys,
)
from tautwire.inputs.reading.files import did_you_mean
from tautwire.inputs.reading.grouping import pattern, thinned, with_count
from tautwire.inputs.reading.tables import Cells
from tautwire.specs.base import (
    LIST,
    MAPPING,
    SCALAR,
    TABLE,
    ContradictionError,
    Problem,
    Quantity,
)
from tautwire.specs.case import Case
from tautwire.specs.checks import find_contradictions
from tautwire.specs.line.catenary import MOST_SPANS
from tautwire.specs.schema.vocabulary import meaning_of
from tautwire.text import shown
from tautwire.units import UnitError, expectation, parse_quantity

Data = Mapping[str, Any]

NOT_MODELLED = "not modelled yet"
LOOKED_AT = 100
"""Faults of one type in one field that are put into words; the others are counted. The words for an
unknown key take a search for the likest one."""
_FORMS = {
    SCALAR: "a single value",
    LIST: "a list [...]",
    TABLE: "a list of lists, one per span",
    MAPPING: "a mapping {...}",
    "contact": "the word 'contact'",
}
_SLIPS = {"m": "mm", "m/s": "km/h", "s": "ms"}


def describe(error: ValidationError, data: Data, cells: Mapping[Path, Cells]) -> list[str]:
    """Write one sentence per fault, contradictions between the valid parts included.

    Parameters
    ----------
    error
        What validation of the case raised.
    data
        The case as plain data, as the user wrote it.
    cells
        By the path of a list that came from a table: what names the cell of each item.
    """
    every = [(fault, 0) for fault in error.errors(include_url=False)]
    faults = thinned(every, _kind_of_fault, LOOKED_AT)
    problems: dict[Problem, int] = {}
    for fault, more in faults:
        for problem in _problems(fault, data):
            problems[problem] = problems.get(problem, 0) + more
    if all(fault["loc"] for fault, _ in faults):
        for problem in _hidden_problems([fault for fault, _ in every], data):
            problems.setdefault(problem, 0)
    told = thinned(problems.items(), _kind_of_problem)
    told.sort(key=lambda item: not item[0].text.startswith(NOT_MODELLED))  # causes go first
    return [with_count(_sentence(problem, data, cells), more) for problem, more in told]


def _kind_of_fault(fault: ErrorDetails) -> tuple[str, ...]:
    """Tell which faults are alike: of one type, in the same field of whichever item of a list."""
    names = [step for step in fault["loc"] if isinstance(step, str)]
    return (fault["type"], *(names[:-1] if fault["type"] == "extra_forbidden" else names))


def _kind_of_problem(problem: Problem) -> tuple[str, ...]:
    names = [step for step in problem.path if isinstance(step, str)]
    is_unknown_key = problem.text.startswith(("unknown key", NOT_MODELLED))
    return (problem.text, *names[:-1]) if is_unknown_key else (pattern(problem.text), *names)


def place_of(path: Path, data: Data) -> str:
    """Say which dropper, support, span or stage a path means, with x where it is known."""
    match path:
        case ("droppers", "positions" | "presag" | "lengths", int(span), int(dropper)):
            return f"dropper {dropper + 1} of span {span + 1}{_dropper_x(data, span, dropper)}"
        case ("droppers", "positions" | "presag" | "lengths", int(item)):
            is_list = isinstance(value_at(data, path), (list, tuple))
            return f"span {item + 1}" if is_list else f"dropper {item + 1} of every span"
        case ("supports", str(), int(support)):
            return f"support {support + 1}{_support_x(data, support)}"
        case ("line", "span_length", int(span)):
            return f"span {span + 1}"
        case ("pantographs", int(number), "stages", int(stage), *_):
            return f"stage {stage + 1} of pantograph {_pantograph_name(data, number)}"
        case ("sources", int(), *_):
            entry = value_at(data, (*path[:2], "path"))
            return f"entry for {entry!r}" if isinstance(entry, str) else ""
        case (("bodies" | "stays") as group, int(number), *_):
            name = value_at(data, (group, number, "name"))
            word = "body" if group == "bodies" else "stay"
            return f"{word} {name!r}" if isinstance(name, str) else ""
        case ("pantographs", int(number), *_):
            return f"pantograph {_pantograph_name(data, number)}"
        case _:
            return ""


def _sentence(problem: Problem, data: Data, cells: Mapping[Path, Cells]) -> str:
    where = format_path(problem.path) or "the case"
    notes = (_cell_of(problem.path, cells), place_of(problem.path, data))
    note = "; ".join(filter(None, notes))
    return f"{where} ({note}): {problem.text}" if note else f"{where}: {problem.text}"


def _cell_of(path: Path, cells: Mapping[Path, Cells]) -> str:
    """Name the cell from which a value was read, or the item of a list that it belongs to."""
    for depth in range(len(path) - 1, -1, -1):
        step, cell_of = path[depth], cells.get(path[:depth])
        if isinstance(step, int) and cell_of is not None:
            return cell_of(step)
    return ""


def _problems(fault: ErrorDetails, data: Data) -> list[Problem]:
    """Return what one fault says; nothing for a list that is short because items are at fault."""
    path = without_forms(fault["loc"])
    context = fault.get("ctx", {})
    cause = context.get("error")
    if isinstance(cause, ContradictionError):
        return [problem.under(*path) for problem in cause.problems]
    if isinstance(cause, ValueError):
        return [Problem(_as_written(path, data), str(cause))]
    if is_said_elsewhere(fault):
        return []
    if fault["type"] == "missing" and _comes_with_entry(path, data):
        return []
    if fault["type"] == "missing" and isinstance(path[-1], int):
        path = path[:-1]
        return [Problem(path, f"has too few values. {_description(find_target(path))}")]
    return [Problem(_as_written(path, data), _text(fault, path, data))]


def _as_written(path: Path, data: Data) -> Path:
    """Shorten a path that goes on inside a word, such as ``line.ends.left`` in ``ends: fixed``."""
    for depth in range(1, len(path)):
        if isinstance(value_at(data, path[:depth]), (str, int, float)):
            return path[:depth]
    return path


def _text(fault: ErrorDetails, path: Path, data: Data) -> str:
    kind, limits = fault["type"], fault.get("ctx", {})
    if kind == "extra_forbidden":
        parent = find_target(path[:-1]).spec
        known = written_keys(parent) if parent is not None else ()
        return unknown_key(str(path[-1]), known, format_path(path[:-1]))
    target = find_target(path)
    if kind == "missing":
        how = " (or name an entry of the catalogue with 'use')" if _is_in_catalogue(path) else ""
        return f"is missing{how}: {_description(target)}{_wanted_quantity(target.quantity)}"
    written = value_at(data, path)
    got = f"got {shown(fault['input'] if written is None else written)}"
    if kind in BOUNDS:
        return got + _out_of_range(fault, target, written)
    if kind == "literal_error":
        words = str(limits["expected"])
        close = did_you_mean(str(fault["input"]), re.findall(r"'([^']*)'", words))
        return f"{got}; choose {words}{close}"
    if kind == "union_tag_invalid":
        return f"{got}; expected {_wanted_forms(limits)}{_wanted_quantity(target.quantity)}"
    if kind == "model_type" and target.spec is not None:
        return f"{got}; expected a mapping with the keys {', '.join(written_keys(target.spec))}"
    return words_of({**fault, "input": fault["input"] if written is None else written})


def _is_in_catalogue(path: Path) -> bool:
    """Tell whether entries that may stand beside a value state it."""
    spec = spec_at(path[:-1])
    kinds = spec.catalogue_kinds if spec is not None else ()
    own = (
        kind.model_fields.keys() - Part.model_fields.keys() for kind in KINDS if kind.kind in kinds
    )
    return any(path[-1] in keys for keys in own)


def _comes_with_entry(path: Path, data: Data) -> bool:
    """Tell whether a missing value comes with the entry that an unknown key beside it names."""
    spec, beside = spec_at(path[:-1]), value_at(data, path[:-1])
    if spec is None or not isinstance(beside, Mapping) or path[-1] in beside:
        return False
    meanings = [meaning_of(str(key)) for key in beside if key not in fields_by_key(spec)]
    names_entry = any(
        meaning is not None and meaning.key.endswith(f".{USE}") for meaning in meanings
    )
    return names_entry and _is_in_catalogue(path)


def _description(target: Target) -> str:
    return (target.field.description if target.field is not None else None) or "Give a value."


def _wanted_quantity(quantity: Quantity | None) -> str:
    return f" Expected: {expectation(quantity.unit)}" if quantity is not None else ""


def _wanted_forms(limits: Mapping[str, Any]) -> str:
    tags = [tag.strip("' ") for tag in str(limits["expected_tags"]).split(",")]
    return " or ".join(_FORMS.get(tag, tag) for tag in tags) + "."


def _out_of_range(fault: ErrorDetails, target: Target, written: Any) -> str:
    key, words = BOUNDS[fault["type"]]
    bound = fault.get("ctx", {})[key]
    quantity = target.quantity
    if quantity is None:
        return f"; must be {words} {bound}"
    si = f" ({fault['input']:g} {quantity.unit})" if isinstance(written, str) else ""
    typical = f" (typical: {quantity.typical})" if quantity.typical else ""
    allowed = f"; must be {words} {bound:g} {quantity.unit}".rstrip()
    slip = _slip(quantity, written) if key in ("lt", "le") else ""
    beyond = f"; {quantity.beyond}" if quantity.beyond and not slip else ""
    return f"{si}{allowed}{typical}{slip}{beyond}"


def _slip(quantity: Quantity, written: Any) -> str:
    """Suggest the everyday unit for a bare number that is too large in SI and fits in it."""
    unit = _SLIPS.get(quantity.unit)
    if unit is None or not isinstance(written, (int, float)):
        return ""
    text = f"{written:g} {unit}"
    value = parse_quantity(text, quantity.unit)
    low = max((b for b in (quantity.gt, quantity.ge) if b is not None), default=value)
    high = min((b for b in (quantity.lt, quantity.le) if b is not None), default=value)
    return f"; did you mean '{text}'?" if low <= value <= high else ""


def _hidden_problems(faults: Sequence[ErrorDetails], data: Data) -> Iterator[Problem]:
    """Yield what the faults hide: fields that are checked together only when each of them is valid.

    The case is looked at again without its unknown keys and without the faulty values that may be
    left out. What is then said about one of these values, or in its words, is not true of the case
    and is dropped.
    """
    removed = {path for fault in faults if (path := _removable(fault, data))}
    words = {str(path[-1]) for path in removed}
    for problem in _problems_of_rest(_without(data, removed)):
        above = {problem.path[:depth] for depth in range(1, len(problem.path) + 1)}
        is_told = not words.isdisjoint(re.findall(r"\w+", problem.text))
        if above.isdisjoint(removed) and not is_told and not _comes_with_entry(problem.path, data):
            yield problem


def _problems_of_rest(rest: Data) -> Iterator[Problem]:
    try:
        Case.model_validate(rest)
    except ValidationError as error:
        faults = [fault for fault in error.errors(include_url=False) if fault["loc"]]
        for fault, _ in thinned(((fault, 0) for fault in faults), _kind_of_fault, LOOKED_AT):
            yield from _problems(fault, rest)
        yield from find_contradictions(_valid_parts(rest))


def _removable(fault: ErrorDetails, data: Data) -> Path:
    """Return the path of what a case can do without: an unknown key, a value with a default."""
    path = _as_written(without_forms(fault["loc"]), data)
    if fault["type"] == "extra_forbidden":
        return path
    while path and isinstance(path[-1], int):
        path = path[:-1]
    try:
        field = find_target(path).field
    except PathError:
        return ()
    return path if field is not None and not field.is_required() else ()


def _without(node: Any, removed: Set[Path], at: Path = ()) -> Any:
    """Return plain data without the values at some paths."""
    if isinstance(node, Mapping):
        return {
            key: _without(value, removed, (*at, key))
            for key, value in node.items()
            if (*at, key) not in removed
        }
    if isinstance(node, (list, tuple)) and any(isinstance(item, Mapping) for item in node):
        return [_without(item, removed, (*at, number)) for number, item in enumerate(node)]
    return node


def _valid_parts(data: Data) -> dict[str, Any]:
    """Validate the parts of a case one by one and return those that are valid."""
    parts = {}
    for key, field in fields_by_key(Case).items():
        if key not in data:
            continue
        try:
            parts[key] = _validated(field.annotation, data[key])
        except ValidationError:
            continue
    return parts


def _validated(annotation: Any, value: Any) -> Any:
    return TypeAdapter(annotation).validate_python(value)


def _pantograph_name(data: Data, number: int) -> str:
    name = value_at(data, ("pantographs", number, "name"))
    return repr(name) if isinstance(name, str) else str(number + 1)


def _support_x(data: Data, support: int) -> str:
    try:
        place = f", x = {_span_starts(data)[support]:g} m"
    except (UnitError, IndexError):
        place = ""
    mast = value_at(data, ("line", "masts", support))
    return f"{place}, mast {mast}" if isinstance(mast, str) else place


def _dropper_x(data: Data, span: int, dropper: int) -> str:
    positions = value_at(data, ("droppers", "positions"))
    row = value_at(positions, (span,))
    value = value_at(row if isinstance(row, (list, tuple)) else positions, (dropper,))
    try:
        return f", x = {_span_starts(data)[span] + parse_quantity(value, 'm'):g} m"
    except (UnitError, IndexError):
        return ""


def _span_starts(data: Data) -> list[float]:
    """Return the position of every support, raising UnitError where the line is not valid."""
    length, spans = (value_at(data, ("line", key)) for key in ("span_length", "spans"))
    if not isinstance(length, (list, tuple)):
        length = [length] * (spans if isinstance(spans, int) and 0 < spans <= MOST_SPANS else 0)
    return list(accumulate((parse_quantity(item, "m") for item in length), initial=0.0))
