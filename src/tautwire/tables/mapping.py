"""Which column means what: proposed from the headings, kept in a small file, used again."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping as MappingType
from collections.abc import Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from pathlib import Path
from typing import Any, Literal

from tautwire.errors import InputError
from tautwire.specs.line.dropper import MOST_DROPPERS
from tautwire.specs.schema.vocabulary import folded
from tautwire.tables.by_span.doubts import NumberedColumn, doubts
from tautwire.tables.by_span.headings import POSITION, read_by_span, with_one_row_of_headings
from tautwire.tables.columns import (
    ANY,
    COUNT,
    KINDS,
    RECORDING,
    TEXT,
    Field,
    fields_of,
    sheet_names,
    split_heading,
)
from tautwire.tables.headings import Reading, read_heading
from tautwire.tables.sheets import HEADING_ROWS, Sheet
from tautwire.tables.values import unit_fits
from tautwire.text import shortened
from tautwire.units import expectation

ASIDE = "aside"
RENEW = "remove the mapping file to have a new one proposed"
Side = Literal["left", "right"]
ALIKE = 0.8
"""Likeness from which an unknown heading is a slip of the pen: one letter in five."""
NEEDS: dict[str, tuple[tuple[str, ...], ...]] = {
    "supports": (("chainage", "x", "span_length", "contact_stagger", "contact_height"),),
    "droppers": (("position",),),
    "wires": (("wire",), ("use", "tension", "mass")),
    "values": (("path",), ("value",)),
    "sources": (("path",), ("source",), ("confidence",)),
    "bodies": (("body",), ("wire",), ("position",)),
    "stays": (("stay",), ("wire",), ("position",), ("stiffness",)),
    "tension_lengths": (("tension_length",), ("first_mast",), ("last_mast",)),
    "overlaps": (("overlap", "separation", "anchor_rise"), ("rise", "separation")),
    RECORDING: (
        ("time", "position", "odometer"),
        ("force", "sensor_force", "acceleration", "height", "stagger", "thickness", "uplift"),
    ),
}
"""What a table must have to be of a kind: one field of each group."""
_NUMBERS = ("strip", "sensor", "dropper")
"""What tells columns of one field apart."""
_BY_UNIT = {"speed": ("speed",), "force": ("force", "sensor_force"), "time": ("time",)}
"""Fields of recordings that the only unread column in their unit is taken for, unless one of these
is there already."""


@dataclass(frozen=True)
class Use:
    """What one column is read as; numbers from 1 tell columns of one field apart.

    `strip` and `sensor` are those of channels, `dropper` that of a table with one row per span.
    """

    column: int
    heading: str
    field: Field
    unit: str
    strip: int | None = None
    sensor: int | None = None
    dropper: int | None = None


@dataclass(frozen=True)
class SheetMapping:
    """How one sheet is read.

    Attributes
    ----------
    sheet : Sheet
    kind : str
        One of :data:`tautwire.tables.columns.KINDS`, or ``recording``.
    heading_row, first_row : int
        Index of the row of headings and of the first row of values.
    uses : tuple of Use
    aside : tuple of str
        Headings of columns that are not read.
    positive : str
        Side of rising chainage on which staggers are positive.
    notes : tuple of str
        What was understood in a way that should be known.
    """

    sheet: Sheet
    kind: str
    heading_row: int
    first_row: int
    uses: tuple[Use, ...]
    aside: tuple[str, ...]
    positive: Side = "left"
    notes: tuple[str, ...] = ()

    def use(self, name: str, dropper: int | None = None) -> Use | None:
        """Return the column of a field, of one dropper where it has several; or None."""
        own = (use for use in self.uses if use.field.name == name)
        return next((use for use in own if None in (dropper, use.dropper)
                     or use.dropper == dropper), None)  # fmt: skip

    @property
    def droppers(self) -> tuple[int, ...]:
        """Numbers of the droppers of which one row tells; empty where each has its row."""
        return tuple(sorted({use.dropper for use in self.uses if use.dropper is not None}))

    @property
    def field_count(self) -> int:
        """How many fields the columns hold, those of several droppers counted once."""
        return len({(use.field.name, use.strip, use.sensor) for use in self.uses})

    def place(self, row: int, use: Use) -> str:
        """Name a cell, by the heading of its column too."""
        if self.sheet.letters:
            return f"{self.sheet.place(row, use.column)} ({use.heading})"
        heading = shortened(use.heading)
        return f"{self.sheet.label}, line {self.sheet.numbers[row]}, column {heading!r}"


def propose(sheet: Sheet, kinds: Sequence[str] = KINDS) -> SheetMapping | None:
    """Match the headings of a sheet by meaning; None when it is no table of these kinds.

    Raises
    ------
    InputError
        When two columns could be the same field: it is never guessed.
    """
    proposals = [match(sheet, kind, fields_of(kind), NEEDS[kind]) for kind in kinds]
    named = next((kind for kind in kinds if folded(sheet.name) in sheet_names(kind)), None)
    found = [one for one in proposals if one is not None and named in (None, one.kind)]
    if not found:
        if "droppers" in kinds and named in (None, "droppers"):
            _refuse_without_positions(sheet)
        if named is not None:
            _refuse_almost(sheet, named)
        return None
    best = max(found, key=lambda one: one.field_count)
    if best.kind == RECORDING:
        return _first_of_double(_with_units_alone(best))
    _refuse_double(best)
    _refuse_doubtful(best, fields_of(best.kind))
    return best


def _refuse_without_positions(sheet: Sheet) -> None:
    """Refuse a table with a column per dropper that does not tell where the droppers hang."""
    found = match(sheet, "droppers", fields_of("droppers"), ())
    if found is not None and found.droppers and (found.use("span") or found.use("mast")):
        own = ", ".join(use.heading for use in found.uses if use.dropper is not None)
        raise InputError(
            f"{sheet.label}: the columns {shortened(own, 120)} do not tell where the droppers "
            "hang; add columns 'x1', 'x2', ... with their distances from the mast on the left"
        )


def _refuse_almost(sheet: Sheet, kind: str) -> None:
    """Refuse a sheet that is named as a table of the line but lacks a column that it needs.

    Left aside it would be replaced by what the program chooses.
    """
    top = range(min(HEADING_ROWS, len(sheet.rows)))
    row = max(top, key=lambda number: sum(isinstance(cell, str) for cell in sheet.rows[number]))
    headings = [str(cell) for cell in sheet.rows[row] if cell is not None]
    known = {name for text in headings if (name := _named_field(text, fields_of(kind)))}
    missing = [group for group in NEEDS[kind] if not known & set(group)]
    if missing:
        needed = "; ".join(" or ".join(map(repr, group)) for group in missing)
        raise InputError(
            f"{sheet.label}: is named as a table of {kind}, but none of its columns is {needed}; "
            f"there are: {shortened(', '.join(headings), 200)}. Name the column so, or the sheet "
            "otherwise if it is none"
        )


def match(
    sheet: Sheet, kind: str, fields: Sequence[Field], needs: Sequence[Sequence[str]]
) -> SheetMapping | None:
    """Match the fullest row of headings near the top of a sheet.

    Parameters
    ----------
    sheet
    kind
        What the table is called.
    fields
        What it may hold.
    needs
        Groups of fields of each of which it must have one.
    """
    sheet = with_one_row_of_headings(sheet, fields)
    rows = range(min(HEADING_ROWS, len(sheet.rows) - 1))
    found = [_matched(sheet, row, kind, fields, needs) for row in rows]
    return max(filter(None, found), key=lambda one: len(one.uses), default=None)


def refuse_headings(
    sheet: Sheet,
    fields: Sequence[Field],
    needs: Sequence[Sequence[str]],
    mapping: SheetMapping | None,
) -> None:
    """Refuse a table that lacks columns, misspells them, or has them in units that do not fit.

    Columns that mean nothing here are left aside.

    Raises
    ------
    InputError
        Saying what is missing and what there is; of a file without any column that is known,
        nothing is quoted.
    """
    row = mapping.heading_row if mapping is not None else 0
    headings = [str(cell) for cell in sheet.rows[row] if cell is not None]
    used = {use.field.name for use in mapping.uses} if mapping is not None else set()
    read = {use.heading for use in mapping.uses} if mapping is not None else set()
    unread = [text for text in headings if text not in read]
    problems = [fault for text in unread if (fault := _fault_of(text, fields, used))]
    if mapping is None:
        if not problems and any(field.is_of_one_dropper for field in fields):
            _refuse_without_positions(sheet)
        known = {name for text in headings if (name := _named_field(text, fields))}
        there = f"; there are: {shortened(', '.join(headings), 200)}" if known or problems else ""
        problems += [
            f"a column {' or '.join(map(repr, group))} is missing{there}"
            for group in needs
            if not known & set(group)
        ]
    if problems:
        raise InputError([f"{sheet.label}: {text}" for text in problems])
    if mapping is not None:
        _refuse_double(mapping)
        _refuse_doubtful(mapping, fields)


def _named_field(heading: str, fields: Sequence[Field]) -> str | None:
    """Return the field that a heading names, whatever its unit."""
    word = folded(split_heading(heading)[0])
    return next((field.name for field in fields if word in field.headings), None)


def _fault_of(heading: str, fields: Sequence[Field], used: set[str]) -> str:
    """Return what is wrong with a heading that was not understood; empty where nothing is."""
    words, unit = split_heading(heading)
    name = _named_field(heading, fields)
    if name is None:
        left = [field.name for field in fields if field.name not in used]
        close = get_close_matches(words.strip().lower(), left, n=1, cutoff=ALIKE)
        return f"unknown column {heading!r}; did you mean {close[0]!r}?" if close else ""
    wanted = next(field.unit for field in fields if field.name == name)
    if unit_fits(unit, wanted):
        return ""
    if wanted in (TEXT, COUNT):
        return f"column {heading!r}: takes no unit"
    return f"column {heading!r}: the unit does not fit; expected {expectation(wanted)}"


def mapping_text(mappings: Sequence[SheetMapping], source: Path) -> str:
    """Return mappings as the text of a mapping file."""
    lines = [
        f"# How the columns of {source.name} are read. Change it and run again; '{ASIDE}' leaves a",
        "# column unread. Staggers are positive on the side named, seen along rising chainage.",
        "sheets:",
    ]
    for one in mappings:
        lines += [f"  {_quoted(one.sheet.name)}:", f"    table: {one.kind}",
                  f"    heading_row: {one.sheet.numbers[one.heading_row]}"]  # fmt: skip
        if one.use("contact_stagger") is not None or one.use("stagger") is not None:
            lines.append(f"    stagger_positive: {one.positive}")
        lines.append("    columns:")
        for use in one.uses:
            unit = use.unit and _quoted(use.unit)
            more = {"unit": unit} | {key: getattr(use, key) for key in _NUMBERS}
            said = "".join(f", {key}: {value}" for key, value in more.items() if value)
            lines.append(f"      {_quoted(use.heading)}: {{field: {use.field.name}{said}}}")
        lines += [f"      {_quoted(heading)}: {ASIDE}" for heading in one.aside]
    return "\n".join(lines) + "\n"


def apply_mapping(
    sheets: Sequence[Sheet], data: Any, label: str, kinds: Sequence[str] = KINDS
) -> list[SheetMapping]:
    """Read sheets as a mapping file says.

    Raises
    ------
    InputError
        Naming every entry of the file that leads to nothing.
    """
    entries = data.get("sheets") if isinstance(data, MappingType) else None
    if not isinstance(entries, MappingType):
        raise InputError(f"{label}: expected {{sheets: {{NAME: {{table: ..., columns: ...}}}}}}")
    by_name = {sheet.name: sheet for sheet in sheets}
    problems, mappings = [], []
    for name, entry in entries.items():
        if name not in by_name:
            there = ", ".join(by_name)
            problems.append(f"{label}: there is no sheet {name!r}; there are: {there}; {RENEW}")
            continue
        try:
            mappings.append(_as_said(by_name[name], entry, f"{label}: {name}", kinds))
        except InputError as error:
            problems += error.problems
    if problems:
        raise InputError(problems)
    return mappings


def _matched(
    sheet: Sheet, row: int, kind: str, fields: Sequence[Field], needs: Sequence[Sequence[str]]
) -> SheetMapping | None:
    units = _units_below(sheet, row)
    headings = {
        column: (cell, units.get(column, ""))
        for column, cell in enumerate(sheet.rows[row])
        if isinstance(cell, str)
    }
    found = {column: read_heading(*texts, fields) for column, texts in headings.items()}
    left = {column: texts for column, texts in headings.items() if found[column] is None}
    is_by_row = any(one is not None and one.field.name == POSITION for one in found.values())
    found |= read_by_span(sheet, row, left, fields, is_by_row=is_by_row)
    aside = [headings[column][0] for column, reading in found.items() if reading is None]
    uses = [
        _use(column, headings[column][0], reading)
        for column, reading in found.items()
        if reading is not None
    ]
    uses = _named_supports(sheet, row, uses, fields)
    names = {use.field.name for use in uses}
    if not all(any(name in names for name in group) for group in needs):
        return None
    first = row + (2 if units else 1)
    return SheetMapping(sheet, kind, row, first, tuple(uses), tuple(aside))


def _use(column: int, heading: str, reading: Reading) -> Use:
    return Use(column, heading, reading.field, reading.unit,
               reading.strip, reading.sensor, reading.dropper)  # fmt: skip


def _named_supports(
    sheet: Sheet, row: int, uses: Sequence[Use], fields: Sequence[Field]
) -> list[Use]:
    """Read a column of numbers of supports as names where it holds any other than numbers."""
    mast = next((field for field in fields if field.name == "mast"), None)
    if mast is None or any(use.field is mast for use in uses):
        return list(uses)
    rows = sheet.rows[row + 1 :]

    def is_name(use: Use) -> bool:
        cells = (cells[use.column] for cells in rows if use.column < len(cells))
        return any(isinstance(c, str) and re.search(r"[^0-9.,\s]", c) for c in cells)

    return [replace(use, field=mast) if use.field.name == "support" and is_name(use) else use
            for use in uses]  # fmt: skip


def _units_below(sheet: Sheet, row: int) -> dict[int, str]:
    """Return the units of a row of units below the headings; nothing where there is none."""
    cells = sheet.rows[row + 1] if row + 1 < len(sheet.rows) else []
    texts = {i: c.strip("[]() ") for i, c in enumerate(cells) if isinstance(c, str)}
    if not texts or len(texts) < len([c for c in cells if c is not None]):
        return {}
    wanted = {field.unit for kind in NEEDS for field in fields_of(kind)} - {TEXT, ANY}
    if not all(t == "-" or any(unit_fits(t, unit) for unit in wanted) for t in texts.values()):
        return {}
    return {i: text for i, text in texts.items() if text != "-"}


def _refuse_double(mapping: SheetMapping) -> None:
    seen: dict[tuple[str, int | None], Use] = {}
    for use in mapping.uses:
        other = seen.setdefault((use.field.name, use.dropper), use)
        if other is not use:
            raise InputError(
                f"{mapping.sheet.label}: the columns {other.heading!r} and {use.heading!r} could "
                f"both be {use.field.name}; rename one, or say in a mapping file which is meant"
            )


def _refuse_doubtful(mapping: SheetMapping, fields: Sequence[Field]) -> None:
    """Refuse columns of single droppers that may hold something else."""
    if not mapping.droppers:
        return
    sheet, row = mapping.sheet, mapping.heading_row
    units = _units_below(sheet, row)
    uses = {use.column: Reading(use.field, use.unit, dropper=use.dropper) for use in mapping.uses}
    columns = [
        NumberedColumn(column, cell, units.get(column, ""), uses.get(column))
        for column, cell in enumerate(sheet.rows[row])
        if isinstance(cell, str) and (column not in uses or uses[column].dropper is not None)
    ]
    if problems := doubts(sheet, row, columns, fields):
        raise InputError([f"{sheet.label}: {text}" for text in problems])


def _with_units_alone(mapping: SheetMapping) -> SheetMapping:
    """Add the columns of a recording that their unit alone tells."""
    uses, notes = list(mapping.uses), list(mapping.notes)
    units = _units_below(mapping.sheet, mapping.heading_row)
    fields = {field.name: field for field in fields_of(mapping.kind)}
    for name, others in _BY_UNIT.items():
        if any(use.field.name in others for use in uses):
            continue
        alone = [
            (column, str(cell), unit)
            for column, cell in enumerate(mapping.sheet.rows[mapping.heading_row])
            if cell in mapping.aside
            and (unit := split_heading(str(cell))[1] or units.get(column, ""))
            and unit_fits(unit, fields[name].unit)
        ]
        if len(alone) == 1:
            [(column, heading, unit)] = alone
            uses.append(Use(column, heading, fields[name], unit))
            notes.append(f"{heading!r} is taken for the {name} because of its unit")
    read = {use.heading for use in uses}
    aside = tuple(heading for heading in mapping.aside if heading not in read)
    return replace(mapping, uses=tuple(uses), aside=aside, notes=tuple(notes))


def _first_of_double(mapping: SheetMapping) -> SheetMapping:
    """Keep the first of several columns of a recording that mean the same channel, and say so."""
    kept: dict[tuple[str, int | None, int | None], Use] = {}
    aside, notes = list(mapping.aside), list(mapping.notes)
    for use in mapping.uses:
        first = kept.setdefault((use.field.name, use.strip, use.sensor), use)
        if first is not use:
            aside.append(use.heading)
            notes.append(
                f"{first.heading!r} and {use.heading!r} could both be the {use.field.name}; the "
                "first is read, the mapping file can say otherwise"
            )
    return replace(mapping, uses=tuple(kept.values()), aside=tuple(aside), notes=tuple(notes))


def _as_said(sheet: Sheet, entry: Any, label: str, kinds: Sequence[str]) -> SheetMapping:
    kind = entry.get("table") if isinstance(entry, MappingType) else None
    if not isinstance(kind, str) or kind not in kinds:
        raise InputError(f"{label}: table: got {kind!r}; choose {', '.join(kinds)}")
    sheet = with_one_row_of_headings(sheet, fields_of(kind))
    row_number, side = entry.get("heading_row", 1), entry.get("stagger_positive", "left")
    if row_number not in sheet.numbers or side not in ("left", "right"):
        raise InputError(
            f"{label}: heading_row {row_number!r} or stagger_positive {side!r} is not possible"
        )
    row = sheet.numbers.index(row_number)
    columns = {str(cell): i for i, cell in enumerate(sheet.rows[row]) if cell is not None}
    fields = {field.name: field for field in fields_of(kind)}
    uses, aside, problems = [], [], []
    for heading, said in (entry.get("columns") or {}).items():
        entry_of = said if isinstance(said, MappingType) else {"field": said}
        name, unit = entry_of.get("field"), str(entry_of.get("unit", ""))
        numbers = [entry_of.get(key) for key in _NUMBERS]
        if heading not in columns:
            problems.append(f"{label}: there is no column {heading!r}; {RENEW}")
        elif name == ASIDE:
            aside.append(heading)
        elif (
            name not in fields
            or not unit_fits(unit, fields[name].unit)
            or not all(
                number is None or number in range(1, MOST_DROPPERS + 1) for number in numbers
            )
        ):
            problems.append(
                f"{label}: {heading!r}: got {said!r}; a field is one of {', '.join(fields)} or "
                f"{ASIDE}, with a unit of its kind"
            )
        else:
            uses.append(Use(columns[heading], heading, fields[name], unit, *numbers))
    if problems:
        raise InputError(problems)
    new = [heading for heading in columns if heading not in (entry.get("columns") or {})]
    notes = tuple(
        f"{label}: does not name the column {heading!r}, which is left aside; {RENEW}"
        for heading in new
        if read_heading(heading, "", fields_of(kind)) is not None
    )
    first = row + (2 if _units_below(sheet, row) else 1)
    return SheetMapping(sheet, kind, row, first, tuple(uses), (*aside, *new), side, notes)


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)
