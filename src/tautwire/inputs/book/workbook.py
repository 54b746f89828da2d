"""A line as a workbook or CSV tables: mapped, completed to a case, every choice told."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tautwire.errors import InputError
from tautwire.inputs.book.values import said_values
from tautwire.inputs.merge import merge, paths_of, with_table
from tautwire.inputs.own_line import Choice, Wish, as_data, presag_of, template
from tautwire.inputs.own_line import dropper_positions as usual_positions
from tautwire.inputs.paths import format_path, value_at
from tautwire.inputs.reading.documents import parse_document
from tautwire.inputs.reading.files import read_case_text
from tautwire.inputs.reading.tables import line_tables, open_sheets
from tautwire.tables.columns import BOOK_KINDS
from tautwire.tables.line import LineTables
from tautwire.tables.mapping import RENEW, SheetMapping, apply_mapping, mapping_text, propose
from tautwire.tables.sheets import SUFFIXES, Sheet
from tautwire.text import as_name
from tautwire.units import UnitError, parse_quantity


@dataclass(frozen=True)
class Workbook:
    """A workbook as it is understood.

    Attributes
    ----------
    path, mapping_file : Path
    mappings : tuple of SheetMapping
    unread : tuple of str
        Sheets that are no tables of a line.
    is_proposed : bool
        Whether the mapping was made from the headings.
    notes : tuple of str
        What the mapping file does not name but might mean.
    """

    path: Path
    mapping_file: Path
    mappings: tuple[SheetMapping, ...]
    unread: tuple[str, ...]
    is_proposed: bool
    notes: tuple[str, ...] = ()

    def mapping_text(self) -> str:
        """Return the mapping as the text of its file."""
        return mapping_text(self.mappings, self.path)


def is_workbook(reference: object) -> bool:
    """Tell whether a case is asked for from a table."""
    return Path(str(reference)).suffix.lower() in SUFFIXES


def open_workbook(path: Path) -> Workbook:
    """Read a workbook and its mapping file, or propose one from the headings.

    Raises
    ------
    InputError
        When the file is no table, or no sheet of it is a table of supports.
    """
    sheets = open_sheets(path)
    mapping_file = path.with_name(path.stem + ".mapping.yaml")
    if mapping_file.is_file():
        data = parse_document(read_case_text(mapping_file), str(mapping_file), ".yaml")
        mappings = apply_mapping(sheets, data, str(mapping_file), BOOK_KINDS)
    else:
        proposals = (propose(sheet, BOOK_KINDS) for sheet in sheets)
        mappings = [found for found in proposals if found is not None]
    if not any(one.kind == "supports" for one in mappings):
        raise InputError(
            f"{path}: no sheet is a table of supports; one row per mast with its chainage or span "
            "is needed, with headings such as 'Mast no.', 'Chainage [m]', 'Stagger [mm]'"
        )
    used = {one.sheet.name for one in mappings}
    unread = tuple(sheet.name for sheet in sheets if sheet.name not in used)
    is_kept = mapping_file.is_file()
    notes = [note for one in mappings for note in one.notes]
    notes += _new_sheets(sheets, unread, mapping_file) if is_kept else []
    return Workbook(path, mapping_file, tuple(mappings), unread, not is_kept, tuple(notes))


def _new_sheets(sheets: Sequence[Sheet], unread: Sequence[str], file: Path) -> list[str]:
    """Name sheets that could be tables of the line but are not in the mapping file."""
    found = []
    for sheet in sheets:
        if sheet.name in unread and (one := propose(sheet, BOOK_KINDS)) is not None:
            what = f"could be a table of {one.kind}, but {file} does not name it"
            found.append(f"{sheet.label}: {what}; {RENEW}")
    return found


def case_of(workbook: Workbook) -> tuple[dict[str, Any], LineTables]:
    """Return the case of a workbook as plain data.

    One with a table of values that gives the schema is the whole case; any other is completed by
    the template of an own line.

    Raises
    ------
    InputError
        Naming every cell that cannot be used.
    """
    tables = line_tables(workbook.mappings, _line_said(workbook))
    said = said_values(tables)
    if "schema" in said:
        return with_table(said, tables.values), tables
    return _completed(workbook, said, tables), tables


def _line_said(workbook: Workbook) -> Any:
    """Return what the tables of values say about the line; faults in them are told later."""
    try:
        found = line_tables([one for one in workbook.mappings if one.kind == "values"])
        return said_values(found).get("line")
    except InputError:
        return None


def _completed(workbook: Workbook, said: dict[str, Any], tables: LineTables) -> dict[str, Any]:
    """Complete what a workbook says by the template of an own line."""
    line = tables.values["line"]
    lengths = line.get("span_length", [])
    wish = Wish(
        as_name(workbook.path.stem),
        spans=line["spans"],
        span=max(lengths, default=None),
        speed=_speed(said),
    )
    choices = template(wish)
    if "droppers" not in tables.values and lengths:
        rows = [usual_positions(span) for span in lengths]
        tables.values["droppers"] = {"positions": rows, "presag": _presag(wish, lengths, rows)}
        tables.notes.append(f"{workbook.path}: no table of droppers; they are placed by rule")
    elif lengths and _lacks_presag(tables.values.get("droppers")):
        droppers = tables.values["droppers"]
        droppers["presag"] = _presag(wish, lengths, droppers["positions"])
        tables.notes.append(
            f"{workbook.path}: the table of droppers has neither lengths nor pre-sag; a pre-sag by "
            "rule is used"
        )
    data = as_data(choices)
    given = with_table(said, tables.values)
    sources = _kept_sources(data.pop("sources"), choices, given)
    merged = with_table(merge(_without_use(data, given), said), tables.values)
    return {**merged, "sources": [*sources, *_named(tables, workbook.path.name)]}


def _lacks_presag(droppers: Any) -> bool:
    is_one = isinstance(droppers, dict)
    return is_one and "presag" not in droppers and droppers.get("mode") != "length"


def _speed(said: dict[str, Any]) -> float | None:
    """Return the speed that a table of values gives; what is no speed is refused later."""
    try:
        return parse_quantity(value_at(said, ("scenario", "speed")), "m/s")
    except UnitError:
        return None


def _named(tables: LineTables, file: str) -> list[dict[str, str]]:
    """Return the workbook as the source of what its tables say."""
    origin = {"source": f"Table {file}", "confidence": "one source"}
    paths = [path for path in paths_of(tables.values) if path[-1] != "mode"]
    return [{"path": format_path(path), **origin} for path in paths] + [
        {"path": one.path, **origin} for one in tables.said
    ]


def _presag(wish: Wish, lengths: list[float], rows: list[list[float]]) -> list[list[float]]:
    return [presag_of(wish, span, row) for span, row in zip(lengths, rows, strict=False)]


def _without_use(data: dict[str, Any], given: dict[str, Any]) -> dict[str, Any]:
    """Leave out the template's wire where the table gives the numbers of its own."""
    wires = {
        name: {k: v for k, v in wire.items() if not (k == "use" and "mass" in given.get(name, {}))}
        for name, wire in data["wires"].items()
    }
    return {**data, "wires": wires}


def _kept_sources(
    sources: list[dict[str, Any]], choices: tuple[Choice, ...], given: dict[str, Any]
) -> list[dict[str, Any]]:
    """Drop the template's sources of what the tables say."""
    replaced = {format_path(path) for path in paths_of(given)}
    replaced |= {
        f"wires.{name}.{key}" for name, wire in given.get("wires", {}).items() for key in wire
    }
    replaced |= {c.path[0] for c in choices if len(c.path) == 1 and c.path[0] in given}
    return [source for source in sources if source["path"] not in replaced]
