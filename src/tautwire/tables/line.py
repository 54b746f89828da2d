"""Mapped sheets as parts of a case: spans, supports, droppers, wires, names and chainage."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from tautwire.errors import InputError
from tautwire.tables.columns import role_of
from tautwire.tables.mapping import SheetMapping, Use
from tautwire.tables.values import CellError, number_of, ratio_of, text_of

MOST_PROBLEMS = 30
"""Cells of which a sheet complains before the rest is only counted."""
Path = tuple[str | int, ...]


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


def read_line(mappings: Sequence[SheetMapping]) -> LineTables:
    """Read the sheets of one line.

    Raises
    ------
    InputError
        Naming every cell that cannot be used.
    """
    result, problems = LineTables(), []
    order = {"supports": 0, "wires": 1, "droppers": 2}
    for mapping in sorted(mappings, key=lambda one: order[one.kind]):
        rows = _Rows(mapping)
        try:
            _READERS[mapping.kind](rows, result)
        except InputError as error:
            problems += error.problems
        problems += rows.listed_problems()
    if problems:
        raise InputError(problems)
    return result


class _Rows:
    """The values of a mapped sheet, column by column, and the problems met."""

    def __init__(self, mapping: SheetMapping) -> None:
        self.mapping, self.sheet = mapping, mapping.sheet
        self.problems: list[str] = []
        last = len(self.sheet.rows)
        self.indices = [
            row
            for row in range(mapping.first_row, last)
            if any(self._cell(row, use.column) is not None for use in mapping.uses)
        ]

    def numbers(self, name: str) -> list[float | None] | None:
        """Return a column in SI; None where the sheet has none."""
        use = self.mapping.use(name)
        return None if use is None else [self._number(row, use) for row in self.indices]

    def full(self, name: str) -> list[float] | None:
        """Return a column that has a value in every row."""
        values = self.numbers(name)
        for index, value in enumerate(values or []):
            if value is None:
                self.complain(index, name, "is empty")
        return None if values is None else [0.0 if v is None else v for v in values]

    def texts(self, name: str) -> list[str | None] | None:
        """Return a column of names; None where the sheet has none."""
        use = self.mapping.use(name)
        return None if use is None else [self._text(row, use) for row in self.indices]

    def place(self, index: int, name: str) -> str:
        """Name a cell."""
        use = self.mapping.use(name)
        column = use.column if use is not None else 0
        heading = f" ({use.heading})" if use is not None else ""
        return self.sheet.place(self.indices[index], column) + heading

    def complain(self, index: int, name: str, text: str) -> None:
        """Note a problem of a cell."""
        self.problems.append(f"{self.place(index, name)}: {text}")

    def listed_problems(self) -> list[str]:
        """Return the problems, the rest counted where there are very many."""
        rest = len(self.problems) - MOST_PROBLEMS
        more = [f"{self.sheet.label}: {rest} more problems"] if rest > 0 else []
        return self.problems[:MOST_PROBLEMS] + more

    def _cell(self, row: int, column: int) -> Any:
        cells = self.sheet.rows[row]
        return cells[column] if column < len(cells) else None

    def _number(self, row: int, use: Use) -> float | None:
        share = ratio_of(use.unit)
        unit, wanted = ("", "") if share is not None else (use.unit, use.field.unit)
        try:
            value = number_of(
                self._cell(row, use.column), unit, wanted, decimal_comma=self.sheet.decimal_comma
            )
        except CellError as error:
            self.problems.append(f"{self.sheet.place(row, use.column)} ({use.heading}): {error}")
            return 0.0
        return value if value is None or share is None else value * share

    def _text(self, row: int, use: Use) -> str | None:
        try:
            return text_of(self._cell(row, use.column))
        except CellError as error:
            self.problems.append(f"{self.sheet.place(row, use.column)} ({use.heading}): {error}")
            return None


def _supports(rows: _Rows, result: LineTables) -> None:
    count = len(rows.indices)
    if count < 2:
        raise InputError(f"{rows.sheet.label}: has {count} support; a line has at least two")
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
    for name in ("arm_end_y", "arm_end_z"):
        if (given := rows.numbers(name)) is not None and any(v is not None for v in given):
            supports[name] = given
    result.values |= {"line": line} | ({"supports": supports} if supports else {})


def _places(rows: _Rows, result: LineTables) -> dict[str, Any]:
    """Return names and chainage of the supports, as far as the sheet has them."""
    places: dict[str, Any] = {}
    if (names := rows.texts("mast")) is not None:
        places["masts"] = [name or str(index + 1) for index, name in enumerate(names)]
    if (use := rows.mapping.use("chainage")) is not None:
        along = rows.full("chainage") or [0.0]
        if not use.unit and abs(along[-1] - along[0]) < len(along):
            along = [1e3 * value for value in along]
            result.notes.append(f"{rows.sheet.label}: {use.heading!r} is taken as kilometres")
        places["chainage"] = along
        if along[-1] < along[0]:
            result.notes.append(
                f"{rows.sheet.label}: chainage falls; support 1 is the first row, and staggers are "
                "turned so that they keep their side of rising chainage"
            )
    elif (along := rows.full("x")) and along[0] != 0.0:
        places["chainage"] = along  # not counted from the first support
    return places


def _span_lengths(rows: _Rows, result: LineTables) -> tuple[list[float], str]:
    """Return span lengths from chainage, position or a column of spans, in this order."""
    if rows.mapping.use("chainage") is not None:
        along = _places(rows, LineTables())["chainage"]
        return _steps(rows, along, "chainage"), "chainage"
    if rows.mapping.use("x") is not None:
        return _steps(rows, rows.full("x") or [], "x"), "x"
    if rows.mapping.use("span_length") is not None:
        return _column_of_spans(rows, result), "span_length"
    return [], ""


def _steps(rows: _Rows, along: Sequence[float], name: str) -> list[float]:
    falling = along[-1] < along[0]
    steps = [(a - b if falling else b - a) for a, b in pairwise(along)]
    for index, step in enumerate(steps, 1):
        if step <= 0.0 and not rows.problems:
            rows.complain(index, name, "does not go on in the direction of the first rows")
    return [round(step, 6) for step in steps]


def _column_of_spans(rows: _Rows, result: LineTables) -> list[float]:
    spans = rows.numbers("span_length") or []
    on_right = spans[0] is None and spans[-1] is not None
    if on_right:
        result.notes.append(f"{rows.sheet.label}: each span stands on the row of its right mast")
    own = spans[1:] if on_right else spans[:-1]
    for index, value in enumerate(own, int(on_right)):
        if value is None:
            rows.complain(index, "span_length", "is empty; only one end may have no span")
    return [value or 0.0 for value in own]


def _droppers(rows: _Rows, result: LineTables) -> None:
    positions = rows.full("position") or []
    spans = _span_of_rows(rows, result)
    by_span: dict[int, list[int]] = {}
    for index, span in enumerate(spans):
        by_span.setdefault(span, []).append(index)
    count = result.values.get("line", {}).get("spans", max(by_span, default=0))
    missing = [str(span) for span in range(1, count + 1) if span not in by_span]
    if missing and not rows.problems:
        rows.problems.append(f"{rows.sheet.label}: no droppers for the spans {', '.join(missing)}")
    droppers: dict[str, Any] = {}
    columns = {"positions": positions}
    for key, name in (("lengths", "length"), ("presag", "presag")):
        if rows.mapping.use(name) is not None:
            columns[key] = rows.full(name) or []
    share = rows.mapping.use("presag")
    if share is not None and ratio_of(share.unit) is not None:
        lengths = result.values.get("line", {}).get("span_length", [])
        columns["presag"] = [
            value * lengths[span - 1] if 0 < span <= len(lengths) else value
            for value, span in zip(columns["presag"], spans, strict=True)
        ]
    names = {"positions": "position", "lengths": "length", "presag": "presag"}
    for key, values in columns.items():
        droppers[key] = [[values[i] for i in by_span[span]] for span in sorted(by_span)]
        for at, span in enumerate(sorted(by_span)):
            for number, index in enumerate(by_span[span]):
                result.origins["droppers", key, at, number] = rows.place(index, names[key])
    if "presag" not in columns and "lengths" in columns:
        droppers["mode"] = "length"
    result.values["droppers"] = droppers


def _span_of_rows(rows: _Rows, result: LineTables) -> list[int]:
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


def _wires(rows: _Rows, result: LineTables) -> None:
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


_READERS = {"supports": _supports, "droppers": _droppers, "wires": _wires}
