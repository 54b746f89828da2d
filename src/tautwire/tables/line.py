"""Mapped sheets as parts of a case: spans, supports, droppers, wires, fittings, overlaps."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from itertools import pairwise
from typing import Any

from tautwire.errors import InputError
from tautwire.specs.line.wire import ROLES
from tautwire.tables.columns import role_of
from tautwire.tables.droppers import check_order, read_droppers, span_of_rows
from tautwire.tables.mapping import SheetMapping
from tautwire.tables.plan import LinePlan, known_line
from tautwire.tables.rows import LATERAL, Rows
from tautwire.tables.sheets import LONGEST_CELL, Cell
from tautwire.tables.values import CellError

Path = tuple[str | int, ...]
_DATE = re.compile(r"[0-9]{4}-[0-9]{2}-[0-9]{2} 00:00:00$")
"""What spreadsheets make of names such as 12/1."""
APART = 0.1
"""Difference of a span from the positions of its ends that is more than rounding to 0.1 m [m]."""
_WIRE_NUMBERS = ("tension", "mass", "axial_stiffness", "bending_stiffness", "diameter",
                 "thermal_expansion", "strength", "side", "from", "to", "clamp",
                 "below")  # fmt: skip
"""Columns of a table of wires that hold numbers."""
SECTIONS = {
    "supports": ("line", "supports"),
    "droppers": ("droppers",),
    "wires": ("wires",),
    "bodies": ("bodies",),
    "stays": ("stays",),
    "tension_lengths": ("tension_lengths",),
    "overlaps": ("overlaps",),
}
"""Parts of a case that a kind of table fills."""


@dataclass(frozen=True)
class Said:
    """One value of a case by its path, with the cell that it stands in."""

    path: str
    value: Cell
    place: str


@dataclass
class LineTables:
    """What the sheets say about a line.

    Attributes
    ----------
    values : dict
        Parts of a case as plain data in SI.
    said : list of Said
        Values by their paths, as a table of values has them.
    origins : dict
        Cell from which each single value was read.
    notes : list of str
        What was understood in a way that should be known.
    beside : dict
        What the case says about the line, which holds where no table does.
    """

    values: dict[str, Any] = field(default_factory=dict)
    said: list[Said] = field(default_factory=list)
    origins: dict[Path, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    beside: dict[str, Any] = field(default_factory=dict)

    @property
    def line(self) -> dict[str, Any]:
        """What is known about the line: spans and masts of the case, and what tables say."""
        return self.beside | self.values.get("line", {})


def read_line(mappings: Sequence[SheetMapping], beside: Any = None) -> LineTables:
    """Read the sheets of one line.

    Parameters
    ----------
    mappings
    beside
        The block ``line`` of the case that names the tables, as plain data; None without one.

    Raises
    ------
    InputError
        Naming every cell that cannot be used.
    """
    result, problems = LineTables(beside=known_line(beside)), _twice(mappings)
    order = list(_READERS)
    for mapping in sorted(mappings, key=lambda one: order.index(one.kind)):
        rows = Rows(mapping)
        try:
            _READERS[mapping.kind](rows, result)
        except InputError as error:
            problems += error.problems
        problems += rows.listed_problems()
        result.notes += [f"{rows.sheet.label}: row {number} sums up those above and is not read"
                         for number in rows.totals]  # fmt: skip
    if problems:
        raise InputError(problems)
    return result


def _twice(mappings: Sequence[SheetMapping]) -> list[str]:
    """Name sheets of one kind: only one of them could be used."""
    seen: dict[str, SheetMapping] = {}
    problems = []
    for one in mappings:
        first = seen.setdefault(one.kind, one)
        if first is not one:
            problems.append(
                f"{one.sheet.label}: is a table of {one.kind}, as {first.sheet.name!r} is; keep "
                "one of the two sheets"
            )
    return problems


def _supports(rows: Rows, result: LineTables) -> None:
    count = len(rows.indices)
    if count < 2:
        raise InputError(f"{rows.sheet.label}: has {count} support; a line has at least two")
    check_order(rows, "support", range(1, count + 1))
    lengths, column = _span_lengths(rows, result)
    line: dict[str, Any] = {"spans": count - 1, **_places(rows, result)}
    if lengths:
        line["span_length"] = lengths
        for index in range(len(lengths)):
            result.origins["line", "span_length", index] = rows.place(index, column)
    sign = _side(rows, result.beside | line)
    supports: dict[str, Any] = {}
    for name in ("contact_height", "encumbrance", "contact_stagger", "messenger_stagger", "hinge"):
        if (values := rows.full(name)) is not None:
            factor = sign if name in LATERAL else 1.0
            supports[name] = [factor * value + 0.0 for value in values]  # no -0.0
            for index in range(count):
                result.origins["supports", name, index] = rows.place(index, name)
    if (types := rows.texts("type")) is not None and any(types):
        supports["type"] = types
    for name in ("arm_end_y", "arm_end_z"):
        if (given := rows.numbers(name)) is not None and any(v is not None for v in given):
            factor = sign if name in LATERAL else 1.0
            supports[name] = [None if v is None else factor * v + 0.0 for v in given]
    result.values |= {"line": line} | ({"supports": supports} if supports else {})


def _side(rows: Rows, line: dict[str, Any]) -> float:
    """Return the sign that lateral positions of a sheet have to the left of rising distance."""
    chainage = line.get("chainage", (0.0, 0.0))
    return -1.0 if (rows.mapping.positive == "right") != (chainage[-1] < chainage[0]) else 1.0


def _places(rows: Rows, result: LineTables) -> dict[str, Any]:
    """Return names and chainage of the supports, as far as the sheet has them."""
    places: dict[str, Any] = {}
    if (names := rows.texts("mast")) is not None:
        places["masts"] = [name or str(index + 1) for index, name in enumerate(names)]
        for index, name in enumerate(names):
            if name is not None and _DATE.match(name):
                text = f"got the date {name}; format the column as text and write the name again"
                rows.complain(index, "mast", text)
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

    Of spans and chainages what is told to more decimals is right, and spans are where chainages
    jump; beside positions they must agree.
    """
    given = rows.numbers("span_length")
    spans = [] if given is None else _column_of_spans(rows, given, result)
    places = _places(rows, LineTables())
    if rows.numbers("chainage") is not None:
        along = places["chainage"]
        steps = _steps(rows, along, "" if spans else "chainage")
        jumps = [n for n, (a, b) in enumerate(zip(steps, spans, strict=False), 1)
                 if abs(a - b) > APART]  # fmt: skip
        if jumps:
            named = ", ".join(map(str, jumps))
            result.notes.append(f"{rows.sheet.label}: the chainage jumps in the spans {named}")
        if spans and (jumps or _decimals(spans) >= _decimals(along)):
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
        if step <= 0.0 and name and not rows.problems:
            text = f"got {along[index]:g} m after {along[index - 1]:g} m; must go on one way"
            rows.complain(index, name, text)
    return [round(step, 6) for step in steps]


def _decimals(values: Sequence[float]) -> int:
    """Return to how many decimals lengths are told, up to a nanometre."""
    return max(-int(Decimal(repr(round(value, 9))).normalize().as_tuple().exponent)
               for value in values)  # fmt: skip


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


def _plan(result: LineTables) -> LinePlan:
    line = result.line
    return LinePlan(line.get("span_length", ()), line.get("masts", ()), line.get("spans", 0))


def _droppers(rows: Rows, result: LineTables) -> None:
    found = read_droppers(rows, _plan(result))
    result.values["droppers"] = found.values
    result.origins |= {("droppers", *path): cell for path, cell in found.origins.items()}
    result.notes += found.notes


def _values(rows: Rows, result: LineTables) -> None:
    paths = rows.texts("path") or []
    for index, (path, value) in enumerate(zip(paths, rows.cells("value"), strict=True)):
        if path is None and _goes_on(result.said, value):
            last = result.said[-1]
            result.said[-1] = Said(last.path, f"{last.value}{value}", last.place)
        elif path is None:
            rows.complain(index, "path", "is empty")
        elif value is not None:
            result.said.append(Said(path, value, rows.place(index, "value")))


def _goes_on(said: Sequence[Said], value: Cell) -> bool:
    """Tell whether a row without a path goes on with a text that no cell holds."""
    text = said[-1].value if said else None
    return isinstance(value, str) and isinstance(text, str) and len(text) > LONGEST_CELL // 2


def _sources(rows: Rows, result: LineTables) -> None:
    names = ("path", "source", "confidence", "template")
    columns = {name: given for name in names if (given := rows.texts(name)) is not None}
    result.values["sources"] = [
        {name: given[index] for name, given in columns.items() if given[index] is not None}
        for index in range(len(rows.indices))
    ]


def _wires(rows: Rows, result: LineTables) -> None:
    wires: dict[str, Any] = {}
    columns: dict[str, Sequence[Any]] = {
        name: values for name in _WIRE_NUMBERS if (values := rows.numbers(name)) is not None
    }
    for key, name in (("use", "use"), ("clamped_to", "clamped_to"), ("role", "wire_role")):
        if (texts := rows.texts(name)) is not None:
            columns[key] = texts
    named = {one.path.split(".")[1] for one in result.said if one.path.startswith("wires.")}
    for index, name in enumerate(rows.texts("wire") or []):
        given = {key: values[index] for key, values in columns.items() if values[index] is not None}
        is_own = name in named or name in ROLES or (name and "role" in given)
        known = name if is_own else role_of(name or "")
        if known is None:
            text = (
                f"got {name!r}; a wire is a contact wire or a messenger, or has a role: "
                f"{', '.join(ROLES)} (column 'wire role')"
            )
            rows.complain(index, "wire", text)
        else:
            wires[known] = given
    result.values["wires"] = wires


def _bodies(rows: Rows, result: LineTables) -> None:
    numbers = ("length", "mass", "end_mass", "axial_stiffness", "bending_stiffness")
    _fittings(rows, result, {"name": "body"}, numbers)


def _stays(rows: Rows, result: LineTables) -> None:
    numbers = ("stiffness", "slack", "force", "end_along", "end_y", "end_z")
    _fittings(rows, result, {"name": "stay", "law": "law"}, numbers)


def _fittings(
    rows: Rows, result: LineTables, texts: dict[str, str], numbers: Sequence[str]
) -> None:
    """Read what sits on wires, one per row; cells that are empty say nothing."""
    places = rows.full("position")
    if places is None:
        raise InputError(f"{rows.sheet.label}: the column 'position' is empty")
    columns: dict[str, Sequence[Any]] = {"span": span_of_rows(rows, _plan(result)), "at": places}
    for key, name in (texts | {"wire": "wire", "tension_length": "tension_length"}).items():
        columns[key] = rows.texts(name) or ()
    for name in numbers:
        sign = _side(rows, result.line) if name in LATERAL else 1.0
        values = rows.numbers(name) or ()
        columns[name] = [None if value is None else sign * value + 0.0 for value in values]
    kind = rows.mapping.kind
    result.values[kind] = [
        {key: values[index] for key, values in columns.items()
         if values and values[index] is not None}
        for index in range(len(places))
    ]  # fmt: skip
    for index in range(len(places)):
        result.origins[kind, index] = rows.place(index, "position")


def _tension_lengths(rows: Rows, result: LineTables) -> None:
    """Read one tension length per row; an end that is not told is anchored, as in a case."""
    plan = _plan(result)
    names, ends = rows.texts("tension_length") or [], {}
    for side in ("left", "right"):
        ends[side] = rows.texts(f"{side}_end") or [None] * len(names)
    masts = {name: rows.texts(name) or [None] * len(names)
             for name in ("first_mast", "last_mast", "fixed_point")}  # fmt: skip
    found: list[dict[str, Any]] = []
    for index, name in enumerate(names):
        number = {key: _support(rows, index, key, values[index], plan)
                  for key, values in masts.items()}  # fmt: skip
        told = {side: words[index] for side, words in ends.items() if words[index] is not None}
        found.append({"masts": [number["first_mast"], number["last_mast"]]}
                     | ({} if name is None else {"name": name})
                     | ({"ends": told} if told else {})
                     | ({"fixed_point": number["fixed_point"]} if number["fixed_point"] else {})
                     )  # fmt: skip
        result.origins["tension_lengths", index] = rows.place(index, "first_mast")
    result.values["tension_lengths"] = found


def _support(rows: Rows, index: int, name: str, text: str | None, plan: LinePlan) -> int | None:
    """Return the number of a support from its name, or from itself."""
    if text is None:
        if name != "fixed_point":
            rows.complain(index, name, "is empty")
        return None
    try:
        return plan.support(text)
    except CellError as error:
        rows.complain(index, name, str(error))
        return None


def _overlaps(rows: Rows, result: LineTables) -> None:
    columns: dict[str, Sequence[Any]] = {"kind": rows.texts("overlap") or ()}
    for name in ("separation", "rise", "anchor_rise"):
        columns[name] = rows.numbers(name) or ()
    result.values["overlaps"] = [
        {key: values[index] for key, values in columns.items()
         if values and values[index] is not None}
        for index in range(len(rows.indices))
    ]  # fmt: skip
    for index in range(len(rows.indices)):
        result.origins["overlaps", index] = rows.place(index, "rise")


_READERS = {
    "values": _values,
    "sources": _sources,
    "supports": _supports,
    "wires": _wires,
    "droppers": _droppers,
    "bodies": _bodies,
    "stays": _stays,
    "tension_lengths": _tension_lengths,
    "overlaps": _overlaps,
}
"""Reader of every kind of table, in the order in which they need each other."""
