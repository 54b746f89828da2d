"""A line as a workbook or CSV tables: mapped, completed to a case, every choice told."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tautwire.errors import InputError
from tautwire.inputs.merge import merge
from tautwire.inputs.own_line import Choice, Wish, as_data, presag_of, template
from tautwire.inputs.own_line import dropper_positions as usual_positions
from tautwire.inputs.reading.documents import parse_document
from tautwire.inputs.reading.files import read_case_text
from tautwire.inputs.reading.tables import line_tables, open_sheets
from tautwire.tables.line import LineTables
from tautwire.tables.mapping import SheetMapping, apply_mapping, mapping_text, propose
from tautwire.tables.sheets import SUFFIXES
from tautwire.text import as_name


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
    """

    path: Path
    mapping_file: Path
    mappings: tuple[SheetMapping, ...]
    unread: tuple[str, ...]
    is_proposed: bool

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
        mappings = apply_mapping(sheets, data, str(mapping_file))
    else:
        mappings = [found for sheet in sheets if (found := propose(sheet)) is not None]
    if not any(one.kind == "supports" for one in mappings):
        raise InputError(
            f"{path}: no sheet is a table of supports; one row per mast with its chainage or span "
            "is needed, with headings such as 'Mast no.', 'Chainage [m]', 'Stagger [mm]'"
        )
    used = {one.sheet.name for one in mappings}
    unread = tuple(sheet.name for sheet in sheets if sheet.name not in used)
    return Workbook(path, mapping_file, tuple(mappings), unread, not mapping_file.is_file())


def case_of(workbook: Workbook) -> tuple[dict[str, Any], LineTables]:
    """Return the case of a workbook as plain data, completed by the template of an own line.

    Raises
    ------
    InputError
        Naming every cell that cannot be used.
    """
    tables = line_tables(workbook.mappings)
    line = tables.values["line"]
    name = as_name(workbook.path.stem)
    lengths = line.get("span_length", [])
    wish = Wish(name, spans=line["spans"], span=max(lengths, default=None))
    choices = template(wish)
    if "droppers" not in tables.values and lengths:
        rows = [usual_positions(span) for span in lengths]
        tables.values["droppers"] = {"positions": rows, "presag": _presag(wish, lengths, rows)}
        tables.notes.append(f"{workbook.path}: no table of droppers; they are placed by rule")
    elif "presag" not in tables.values.get("droppers", {}) and lengths:
        droppers = tables.values.setdefault("droppers", {})
        if droppers.get("mode") != "length":
            droppers["presag"] = _presag(wish, lengths, droppers["positions"])
    data = as_data(choices)
    sources = _kept_sources(data.pop("sources"), choices, tables)
    merged = merge(_without_use(data, tables.values), tables.values)
    if tables.values.get("droppers", {}).get("mode") == "length":
        merged["droppers"].pop("presag", None)
    named = [
        {"path": path, "source": f"Table {workbook.path.name}", "confidence": "one source"}
        for path, _ in tables.told()
        if path != "droppers.mode"
    ]  # fmt: skip
    return {**merged, "sources": [*sources, *named]}, tables


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
    sources: list[dict[str, Any]], choices: tuple[Choice, ...], tables: LineTables
) -> list[dict[str, Any]]:
    """Drop the template's sources of what the tables say."""
    given = tables.values
    replaced = {path for path, _ in tables.told()}
    replaced |= {
        f"wires.{name}.{key}" for name, wire in given.get("wires", {}).items() for key in wire
    }
    replaced |= {c.path[0] for c in choices if len(c.path) == 1 and c.path[0] in given}
    return [source for source in sources if source["path"] not in replaced]
