"""A mapped table of droppers as one or several sets of them."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

from tautwire.errors import InputError
from tautwire.tables.mapping import SheetMapping
from tautwire.tables.plan import LinePlan
from tautwire.tables.rows import Rows
from tautwire.tables.values import CellError, ratio_of
from tautwire.text import shortened

IDENTITY = ("tension_length", "from", "to")
"""What a dropper of a set has in common with the others, as a table tells it."""
SET = "set"
"""Number of a set in a table that a case was written to, from 1."""
_COLUMNS = {"positions": "position", "presag": "presag"}
UNSTRAINED = "unstrained_length"
NEAREST_LAST = 0.5
"""Share of the span beyond which the last of its droppers stands, where one row tells of a span:
even two droppers stand on both sides of the middle."""


@dataclass
class DropperTable:
    """What a table says about droppers.

    Attributes
    ----------
    values : dict, or list of dict
        One set, or several where rows name their wires, their tension length or their set.
    origins : dict
        Cells of single values by their path below ``droppers``.
    notes : list of str
    """

    values: dict[str, Any] | list[dict[str, Any]]
    origins: dict[tuple[str | int, ...], str]
    notes: list[str]


def read_droppers(rows: Rows, plan: LinePlan) -> DropperTable:
    """Read a table of droppers; what is wrong with its cells is kept by the rows.

    Raises
    ------
    InputError
        When it has no positions, or nothing tells to which span a dropper belongs.
    """
    _check_columns(rows.mapping)
    positions = rows.full("position")
    if positions is None:
        raise InputError(f"{rows.sheet.label}: the column 'position' is empty")
    supports = rows.numbers("about_support") or [None] * len(positions)
    places = _places_of_rows(rows, plan, supports)
    _check_rows_of_spans(rows, plan, places, positions)
    lengths = UNSTRAINED if rows.mapping.use(UNSTRAINED) is not None else "length"
    columns = {"positions": positions, **_kinds_of_length(rows, plan, places, lengths)}
    identity = _identity_of_rows(rows)
    check_order(rows, "dropper", _expected(identity, places))
    hung = [i for i, x in enumerate(positions) if supports[i] is not None or x != 0.0]
    notes = []
    if len(hung) < len(positions):
        notes.append(
            f"{rows.sheet.label}: droppers at a support follow from the rise of the wire there "
            "(overlaps); their rows are not used"
        )
    found = _Grouped(rows, plan, columns, places, supports, lengths)
    groups: dict[tuple[Any, ...], list[int]] = {}
    for i in hung:
        groups.setdefault((*identity[i], supports[i] is not None), []).append(i)
    _check_spans(rows, plan, places, supports)
    if list(groups) == [(None, *(None for _ in IDENTITY), False)]:
        return DropperTable(found.one(hung, ()), found.origins, notes)
    sets = [found.named(key, own, at) for at, (key, own) in enumerate(groups.items())]
    return DropperTable(sets, found.origins, notes)


@dataclass
class _Grouped:
    """Makes sets of the rows of a table."""

    rows: Rows
    plan: LinePlan
    columns: dict[str, list[float | None]]
    places: list[int]
    supports: Sequence[float | None]
    lengths: str

    def __post_init__(self) -> None:
        self.origins: dict[tuple[str | int, ...], str] = {}

    def one(self, own: Sequence[int], at: tuple[int, ...]) -> dict[str, Any]:
        """Return the lists of one set by span or, counted from supports, by support."""
        is_about = bool(own) and self.supports[own[0]] is not None
        count = self.plan.spans or max(self.places, default=0)
        numbers = range(2, count + 1) if is_about else range(1, count + 1)
        by_place = {number: [i for i in own if self.places[i] == number] for number in numbers}
        found: dict[str, Any] = {"about": "mast"} if is_about else {}
        filled = {key: values for key, values in self.columns.items()
                  if any(values[i] is not None for i in own)}  # fmt: skip
        for key, values in filled.items():
            self._complain_of_empty(key, values, own)
            found[key] = [[values[i] or 0.0 for i in items] for items in by_place.values()]
            for place, items in enumerate(by_place.values()):
                for number, i in enumerate(items):
                    cell = self.rows.place(i, self._column(key))
                    self.origins[(*at, key, place, number)] = cell
        return found | _kind_told(filled.keys(), self.lengths)

    def _complain_of_empty(
        self, key: str, values: Sequence[float | None], own: Sequence[int]
    ) -> None:
        for i in own:
            if values[i] is None:
                text = "is empty; fill the column or leave all of it empty"
                self.rows.complain(i, self._column(key), text)

    def _column(self, key: str) -> str:
        return self.lengths if key == "lengths" else _COLUMNS[key]

    def named(self, key: tuple[Any, ...], own: Sequence[int], at: int) -> dict[str, Any]:
        """Return one set of several with what tells it apart."""
        number, *names, _ = key
        told = {name: value for name, value in zip(IDENTITY, names, strict=True) if value}
        if number is not None:
            told[SET] = int(number)
        return {**told, **self.one(own, (at,))}


def _kind_told(columns: Collection[str], lengths: str) -> dict[str, str]:
    """Return what the columns of a table say about what is prescribed."""
    told = {}
    if "lengths" in columns and "presag" not in columns:
        told["mode"] = "length"
    if "lengths" in columns and lengths == UNSTRAINED:
        told["length_kind"] = "unstrained"
    return told


def _identity_of_rows(rows: Rows) -> list[tuple[Any, ...]]:
    """Return the number of the set, tension length and wires of every row, as far as told."""
    numbers = rows.numbers(SET)
    names = [rows.texts(name) for name in IDENTITY]
    return [
        tuple(None if column is None else column[i] for column in (numbers, *names))
        for i in range(len(rows.indices))
    ]


def _check_spans(
    rows: Rows, plan: LinePlan, places: Sequence[int], supports: Sequence[float | None]
) -> None:
    """Complain of spans without droppers where all are counted from the spans."""
    if any(support is not None for support in supports) or rows.problems:
        return
    filled = set(places)
    count = plan.spans or max(filled, default=0)
    missing = [str(span) for span in range(1, count + 1) if span not in filled]
    if missing:
        text = f"no droppers for the spans {shortened(', '.join(missing), 100)}"
        rows.problems.append(f"{rows.sheet.label}: {text}")
    beyond = sorted({span for span in filled if not 1 <= span <= count})
    for span in beyond:
        text = f"got {span}; the line has {count} span{'s' if count > 1 else ''}"
        rows.complain(places.index(span), "span", text)


def _check_columns(mapping: SheetMapping) -> None:
    """Refuse columns of droppers that are not numbered from 1 on, or not alike for every value.

    Raises
    ------
    InputError
        Naming the columns that are missing.
    """
    wanted = range(1, max(mapping.droppers, default=0) + 1)
    problems = []
    for name in dict.fromkeys(use.field.name for use in mapping.uses if use.dropper is not None):
        own = {use.dropper: use.heading for use in mapping.uses if use.field.name == name}
        if None in own:
            problems.append(
                f"{mapping.sheet.label}: the column {own.pop(None)!r} has the {name} of one "
                f"dropper per row, {next(iter(own.values()))!r} that of one of several; rename "
                "the one that is not meant"
            )
        missing = ", ".join(str(number) for number in wanted if number not in own)
        if missing:
            there = ", ".join(map(repr, own.values()))
            problems.append(
                f"{mapping.sheet.label}: no column with the {name.replace('_', ' ')} of dropper "
                f"{missing}; there are {shortened(there, 200)}"
            )
    if problems:
        raise InputError(problems)


def _check_rows_of_spans(
    rows: Rows, plan: LinePlan, places: Sequence[int], positions: Sequence[float]
) -> None:
    """Complain of spans that have two rows, and of distances that are not counted from the mast."""
    if not rows.mapping.droppers or rows.problems:
        return
    first_of = dict[int, int]()
    for index, (row, place) in enumerate(zip(rows.indices, places, strict=True)):
        if first_of.setdefault(place, row) != row:
            rows.complain(index, "span", f"span {place} has a row above; one row per span is read")
            return
    last = {place: index for index, place in enumerate(places)}
    for place, index in last.items():
        span = plan.span_length(place) or 0.0  # a line without any is refused with its case
        is_alone = index == 0 or places[index - 1] != place
        if not is_alone and 0.0 < positions[index] < NEAREST_LAST * span:
            text = (
                f"got {positions[index]:g} m for the last dropper of a span of {span:g} m; "
                "positions count from the mast on the left, not from one dropper to the next"
            )
            rows.complain(index, "position", text)
            return


def _expected(identity: Sequence[tuple[Any, ...]], places: Sequence[int]) -> list[int]:
    """Return the number that every dropper has in its span, those of each lower wire apart."""
    counts: dict[tuple[Any, ...], int] = {}
    expected = []
    for (number, length, _, lower), place in zip(identity, places, strict=True):
        key = (number, length, lower, place)
        counts[key] = counts.get(key, 0) + 1
        expected.append(counts[key])
    return expected


def check_order(rows: Rows, name: str, expected: Sequence[int]) -> None:
    """Complain of the first row that is not numbered in order, where rows are numbered."""
    numbers = rows.full(name) or []
    if rows.problems:
        return  # numbers that could not be read
    for index, (number, wanted) in enumerate(zip(numbers, expected, strict=False)):
        if number != wanted:
            rows.complain(index, name, f"got {number:g}, expected {wanted}; number them in order")
            return


def _places_of_rows(rows: Rows, plan: LinePlan, supports: Sequence[float | None]) -> list[int]:
    """Return the span of every dropper; of one that counts from a support, the number of that."""
    if all(support is None for support in supports):
        return span_of_rows(rows, plan)
    numbers = rows.numbers("span") or [None] * len(supports)
    return [int(s or n or 1) for s, n in zip(supports, numbers, strict=True)]


def span_of_rows(rows: Rows, plan: LinePlan) -> list[int]:
    """Return the span of every row from a span number or the mast on its left.

    Raises
    ------
    InputError
        When the table has neither.
    """
    if (numbers := rows.numbers("span")) is not None:
        filled: list[int] = []
        for index, number in enumerate(numbers):
            if number is None and not filled:
                rows.complain(index, "span", "is empty in the first row")
            filled.append(int(number) if number is not None else (filled or [1])[-1])
        return filled
    names = rows.texts("mast")
    if names is None:
        raise InputError(
            f"{rows.sheet.label}: neither a span number nor a mast; say to which span a row "
            "belongs, in a column 'Span no' or 'Mast' (the mast on its left)"
        )
    spans, last = [], ""
    for index, name in enumerate(names):
        last = name or last
        try:
            spans.append(plan.mast(last) if plan.masts else plan.support(last))
        except CellError as error:
            rows.complain(index, "mast", str(error))
            spans.append(1)
    return spans


def _kinds_of_length(
    rows: Rows, plan: LinePlan, places: Sequence[int], lengths: str
) -> dict[str, list[float | None]]:
    """Return lengths and pre-sags, a share of the span as a pre-sag in metres."""
    columns: dict[str, list[float | None]] = {}
    for key, name in (("lengths", lengths), ("presag", "presag")):
        if (values := rows.numbers(name)) is not None:
            columns[key] = values
    share = rows.mapping.use("presag")
    if share is not None and "presag" in columns and ratio_of(share.unit) is not None:
        columns["presag"] = [
            None if value is None else value * _span_of_share(rows, plan, index, span)
            for index, (value, span) in enumerate(zip(columns["presag"], places, strict=True))
        ]
    return columns


def _span_of_share(rows: Rows, plan: LinePlan, index: int, span: int) -> float:
    """Return the length [m] of the span of which a row tells shares."""
    length = plan.span_length(span)
    if length is None:
        text = (
            f"is a share of span {span}, of which neither the case nor a table of supports has the "
            "length; give line.span_length, or the pre-sag in mm"
        )
        rows.complain(index, "presag", text)
    return length or 0.0
