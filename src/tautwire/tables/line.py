"""Mapped sheets as parts of a case: spans, supports, droppers, wires, bodies, names, chainage."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from tautwire.errors import InputError
from tautwire.tables.columns import role_of
from tautwire.tables.mapping import SheetMapping
from tautwire.tables.rows import Rows
from tautwire.tables.values import ratio_of

Path = tuple[str | int, ...]
APART = 0.1
"""Difference of a span from the positions of its ends that is more than rounding to 0.1 m [m]."""
SECTIONS = {
    "supports": ("line", "supports"),
    "droppers": ("droppers",),
    "wires": ("wires",),
    "bodies": ("bodies",),
}
"""Parts of a case that a kind of table fills."""


@dataclass
class LineTables:
    """What the sheets say about a line.

    Attributes
    ----------
    values : dict
        Parts of a case as plain data in SI.
    origins : dict
        Cell from which each single value was read.
    notes : list of str
        What was understood in a way that should be known.
    """

    values: dict[str, Any] = field(default_factory=dict)
    origins: dict[Path, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    def told(self) -> Iterator[tuple[str, Any]]:
        """Yield dotted paths of what the sheets say, and the values; a list is one value."""
        for section, values in self.values.items():
            if isinstance(values, dict):
                yield from ((f"{section}.{key}", value) for key, value in values.items())
            else:
                yield section, values


def read_line(mappings: Sequence[SheetMapping]) -> LineTables:
    """Read the sheets of one line.

    Raises
    ------
    InputError
        Naming every cell that cannot be used.
    """
    result, problems = LineTables(), []
    order = {"supports": 0, "wires": 1, "droppers": 2, "bodies": 3}
    for mapping in sorted(mappings, key=lambda one: order[one.kind]):
        rows = Rows(mapping)
        try:
            _READERS[mapping.kind](rows, result)
        except InputError as error:
            problems += error.problems
        problems += rows.listed_problems()
    if problems:
        raise InputError(problems)
    return result


def _supports(rows: Rows, result: LineTables) -> None:
    count = len(rows.indices)
    if count < 2:
        raise InputError(f"{rows.sheet.label}: has {count} support; a line has at least two")
    _check_numbers(rows, "support", range(1, count + 1))
    lengths, column = _span_lengths(rows, result)
    line: dict[str, Any] = {"spans": count - 1, **_places(rows, result)}
    if lengths:
        line["span_length"] = lengths
        for index in range(len(lengths)):
            result.origins["line", "span_length", index] = rows.place(index, column)
    chainage = line.get("chainage", (0.0, 0.0))
    sign = -1.0 if (rows.mapping.positive == "right") != (chainage[-1] < chainage[0]) else 1.0
    supports: dict[str, Any] = {}
    for name in ("contact_height", "encumbrance", "contact_stagger", "messenger_stagger"):
        if (values := rows.full(name)) is not None:
            factor = sign if name.endswith("stagger") else 1.0
            supports[name] = [factor * value for value in values]
            for index in range(count):
                result.origins["supports", name, index] = rows.place(index, name)
    if (types := rows.texts("type")) is not None and any(types):
        supports["type"] = types
    for name in ("arm_end_y", "arm_end_z"):
        if (given := rows.numbers(name)) is not None and any(v is not None for v in given):
            supports[name] = given
    result.values |= {"line": line} | ({"supports": supports} if supports else {})


def _places(rows: Rows, result: LineTables) -> dict[str, Any]:
    """Return names and chainage of the supports, as far as the sheet has them."""
    places: dict[str, Any] = {}
    if (names := rows.texts("mast")) is not None:
        places["masts"] = [name or str(index + 1) for index, name in enumerate(names)]
    use = rows.mapping.use("chainage")
    if use is not None and (along := rows.full("chainage")) is not None:
        if not use.unit and abs(along[-1] - along[0]) < len(along):
            along = [1e3 * value for value in along]
            result.notes.append(f"{rows.sheet.label}: {use.heading!r} is taken as kilometres")
        places["chainage"] = along
        if along[-1] < along[0]:
            result.notes.append(
                f"{rows.sheet.label}: chainage falls; support 1 is the first row, and staggers are "
                "turned so that they keep their side of rising chainage"
            )
    elif (given := rows.full("x")) is not None and given[0] != 0.0:
        places["chainage"] = given  # not counted from the first support
    return places


def _span_lengths(rows: Rows, result: LineTables) -> tuple[list[float], str]:
    """Return span lengths from chainage, position or a column of spans.

    Spans beside chainages are right where these jump; beside positions they must agree.
    """
    given = rows.numbers("span_length")
    spans = [] if given is None else _column_of_spans(rows, given, result)
    places = _places(rows, LineTables())
    if rows.numbers("chainage") is not None:
        steps = _steps(rows, places["chainage"], "chainage")
        jumps = [n for n, (a, b) in enumerate(zip(steps, spans, strict=False), 1)
                 if abs(a - b) > APART]  # fmt: skip
        if jumps:
            named = ", ".join(map(str, jumps))
            result.notes.append(f"{rows.sheet.label}: the chainage jumps in the spans {named}")
            return spans, "span_length"
        return steps, "chainage"
    if (along := rows.full("x")) is not None:
        steps = _steps(rows, along, "x")
        for index, (step, span) in enumerate(zip(steps, spans, strict=False)):
            if abs(step - span) > APART:
                text = f"got {span:g} m; the column 'x' says {step:g} m; keep one of the two"
                rows.complain(index, "span_length", text)
                break
        return steps, "x"
    return spans, "span_length" if spans else ""


def _steps(rows: Rows, along: Sequence[float], name: str) -> list[float]:
    falling = along[-1] < along[0]
    steps = [(a - b if falling else b - a) for a, b in pairwise(along)]
    for index, step in enumerate(steps, 1):
        if step <= 0.0 and not rows.problems:
            text = f"got {along[index]:g} m after {along[index - 1]:g} m; must go on one way"
            rows.complain(index, name, text)
    return [round(step, 6) for step in steps]


def _column_of_spans(rows: Rows, spans: Sequence[float | None], result: LineTables) -> list[float]:
    on_right = spans[0] is None and spans[-1] is not None
    if on_right:
        result.notes.append(f"{rows.sheet.label}: each span stands on the row of its right mast")
    elif spans[-1] is not None:
        result.notes.append(f"{rows.sheet.label}: the span on the last row leads beyond the line")
    own = spans[1:] if on_right else spans[:-1]
    for index, value in enumerate(own, int(on_right)):
        if value is None:
            rows.complain(index, "span_length", "is empty; only one end may have no span")
    return [value or 0.0 for value in own]


def _droppers(rows: Rows, result: LineTables) -> None:
    positions = rows.full("position")
    if positions is None:
        raise InputError(f"{rows.sheet.label}: the column 'position' is empty")
    spans = _span_of_rows(rows, result)
    by_span: dict[int, list[int]] = {}
    for index, span in enumerate(spans):
        by_span.setdefault(span, []).append(index)
    _check_numbers(rows, "dropper", [by_span[s].index(i) + 1 for i, s in enumerate(spans)])
    count = result.values.get("line", {}).get("spans", max(by_span, default=0))
    missing = [str(span) for span in range(1, count + 1) if span not in by_span]
    if missing and not rows.problems:
        rows.problems.append(f"{rows.sheet.label}: no droppers for the spans {', '.join(missing)}")
    droppers: dict[str, Any] = {}
    columns = {"positions": positions, **_kinds_of_length(rows, result, spans)}
    names = {"positions": "position", "lengths": "length", "presag": "presag"}
    for key, values in columns.items():
        droppers[key] = [[values[i] for i in by_span[span]] for span in sorted(by_span)]
        for at, span in enumerate(sorted(by_span)):
            for number, index in enumerate(by_span[span]):
                result.origins["droppers", key, at, number] = rows.place(index, names[key])
    if "presag" not in columns and "lengths" in columns:
        droppers["mode"] = "length"
    result.values["droppers"] = droppers


def _kinds_of_length(
    rows: Rows, result: LineTables, spans: Sequence[int]
) -> dict[str, list[float]]:
    """Return lengths and pre-sags, a share of the span as a pre-sag in metres."""
    columns: dict[str, list[float]] = {}
    for key, name in (("lengths", "length"), ("presag", "presag")):
        if (values := rows.full(name)) is not None:
            columns[key] = values
    share = rows.mapping.use("presag")
    if share is not None and "presag" in columns and ratio_of(share.unit) is not None:
        lengths = result.values.get("line", {}).get("span_length", [])
        columns["presag"] = [
            value * lengths[span - 1] if 0 < span <= len(lengths) else value
            for value, span in zip(columns["presag"], spans, strict=True)
        ]
    return columns


def _check_numbers(rows: Rows, name: str, expected: Sequence[int]) -> None:
    """Complain of the first row that is not numbered in order, where rows are numbered."""
    numbers = rows.full(name) or []
    if rows.problems:
        return  # numbers that could not be read
    for index, (number, wanted) in enumerate(zip(numbers, expected, strict=False)):
        if number != wanted:
            rows.complain(index, name, f"got {number:g}, expected {wanted}; number them in order")
            return


def _span_of_rows(rows: Rows, result: LineTables) -> list[int]:
    """Return the span of every dropper from a span number or the mast on its left."""
    if (numbers := rows.numbers("span")) is not None:
        filled: list[int] = []
        for index, number in enumerate(numbers):
            if number is None and not filled:
                rows.complain(index, "span", "is empty in the first row")
            filled.append(int(number) if number is not None else (filled or [1])[-1])
        return filled
    masts = result.values.get("line", {}).get("masts", [])
    names = rows.texts("mast")
    if names is None:
        raise InputError(
            f"{rows.sheet.label}: neither a span number nor a mast; say to which span a dropper "
            "belongs"
        )
    spans, last = [], ""
    for index, name in enumerate(names):
        last = name or last
        if last not in masts:
            rows.complain(index, "mast", f"got {last!r}, which is not in the table of supports")
            spans.append(1)
        else:
            spans.append(masts.index(last) + 1)
    return spans


def _wires(rows: Rows, result: LineTables) -> None:
    wires: dict[str, Any] = {}
    columns: dict[str, Sequence[Any]] = {}
    for name in ("tension", "mass", "axial_stiffness", "bending_stiffness"):
        if (values := rows.numbers(name)) is not None:
            columns[name] = values
    if (types := rows.texts("use")) is not None:
        columns["use"] = types
    for index, name in enumerate(rows.texts("wire") or []):
        role = role_of(name or "")
        if role is None:
            rows.complain(index, "wire", f"got {name!r}; a wire is a contact wire or a messenger")
            continue
        given = {key: values[index] for key, values in columns.items()}
        wires[role] = {key: value for key, value in given.items() if value is not None}
    result.values["wires"] = wires


def _bodies(rows: Rows, result: LineTables) -> None:
    places = rows.full("position")
    if places is None:
        raise InputError(f"{rows.sheet.label}: the column 'position' is empty")
    columns: dict[str, Sequence[Any]] = {"span": _span_of_rows(rows, result), "at": places}
    for key, name in (("name", "body"), ("wire", "wire"), ("tension_length", "tension_length")):
        columns[key] = rows.texts(name) or ()
    for name in ("length", "mass", "end_mass", "axial_stiffness", "bending_stiffness"):
        columns[name] = rows.numbers(name) or ()
    bodies = [
        {key: values[index] for key, values in columns.items() if values}
        for index in range(len(places))
    ]
    result.values["bodies"] = [
        {key: value for key, value in body.items() if value is not None} for body in bodies
    ]
    for index in range(len(places)):
        result.origins["bodies", index] = rows.place(index, "position")


_READERS = {"supports": _supports, "droppers": _droppers, "wires": _wires, "bodies": _bodies}
