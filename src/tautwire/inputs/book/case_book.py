"""A case as a workbook, from which the same case is read."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from tautwire.files import write_bytes
from tautwire.inputs.book.values import rows_of
from tautwire.specs.case import Case
from tautwire.specs.line.dropper import Droppers
from tautwire.tables.sheets import Cell
from tautwire.tables.writing import Row, workbook_bytes

_WIRES = {
    "tension": "tension [N]",
    "mass": "mass [kg/m]",
    "axial_stiffness": "axial_stiffness [N]",
    "bending_stiffness": "bending_stiffness [N m^2]",
}
_SUPPORTS = ("contact_height", "encumbrance", "contact_stagger", "messenger_stagger", "hinge",
             "type", "arm_end_y", "arm_end_z")  # fmt: skip
_LATERAL = ("contact_stagger", "messenger_stagger", "hinge", "arm_end_y")
_LINE = ("spans", "span_length", "masts", "chainage")
_DROPPERS = ("positions", "presag", "lengths")


def case_sheets(case: Case) -> dict[str, list[Row]]:
    """Return the sheets of a case: supports, droppers, wires, all other values by their paths.

    One value that holds for all spans or supports stands in every row. Staggers are positive to the
    left of rising chainage, as everywhere in tables.
    """
    data = case.to_dict()
    sources = data.pop("sources")
    sheets = {"supports": _support_rows(case), "droppers": _dropper_rows(case),
              "wires": _wire_rows(case)}  # fmt: skip
    for key in _LINE:
        data["line"].pop(key)
    for key in _told_by_supports(case):
        data["supports"].pop(key)
    for wire in filter(None, data["wires"].values()):
        for key in _WIRES:
            wire.pop(key)
    for one in data["droppers"] if isinstance(data["droppers"], list) else [data["droppers"]]:
        for key in _DROPPERS:
            one.pop(key)
    sheets["values"] = [("path", "value"), *rows_of(data)]
    names = ("path", "source", "confidence", "template")
    sheets["sources"] = [names, *([one[name] or None for name in names] for one in sources)]
    return {name: rows for name, rows in sheets.items() if len(rows) > 1}


def write_workbook(case: Case, path: str | os.PathLike[str]) -> Path:
    """Write a case as a workbook (XLSX), completely or not at all; ``load_case`` reads it back.

    Parameters
    ----------
    case
    path
        File to write; its name ends in .xlsx.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    return write_bytes(path, workbook_bytes(case_sheets(case)))


def _told_by_supports(case: Case) -> list[str]:
    """Return the keys of the supports that their table tells."""
    values = {name: getattr(case.supports, name) for name in _SUPPORTS}
    return [name for name, value in values.items() if value not in (None, "contact")]


def _support_rows(case: Case) -> list[Row]:
    line, supports = case.line, case.supports
    count = line.spans + 1
    falling = line.chainage is not None and line.chainage[-1] < line.chainage[0]
    columns: dict[str, Sequence[Cell]] = {"support no": range(1, count + 1)}
    if line.masts is not None:
        columns["mast"] = line.masts
    if line.chainage is not None:
        columns["chainage [m]"] = line.chainage
    columns["span_length [m]"] = [*line.span_lengths(), None]
    lists = {
        "contact_height": supports.contact_heights(count),
        "encumbrance": supports.encumbrances(count),
        "contact_stagger": supports.contact_staggers(count),
        "messenger_stagger": supports.messenger_staggers(count),
        "hinge": supports.hinges(count) or (),
        "type": supports.type or (),
        "arm_end_y": supports.arm_end_y or (),
        "arm_end_z": supports.arm_end_z or (),
    }
    for name in _told_by_supports(case):
        sign = -1.0 if falling and name in _LATERAL else 1.0
        heading = name if name == "type" else f"{name} [m]"
        columns[heading] = [v if v is None or isinstance(v, str) else sign * v + 0.0
                            for v in lists[name]]  # fmt: skip
    return [tuple(columns), *zip(*columns.values(), strict=True)]


def _wire_rows(case: Case) -> list[Row]:
    rows: list[Row] = [("wire", *_WIRES.values())]
    for name, wire in case.wires.named():
        rows.append((name, *(getattr(wire, key) for key in _WIRES)))
    return rows


def _dropper_rows(case: Case) -> list[Row]:
    sets = case.dropper_sets
    heads = ["set", "tension_length", "from", "to", "about_support", "span", "mast", "dropper",
             "position [m]", "presag [m]", "length [m]"]  # fmt: skip
    rows = [row for number, one in enumerate(sets, 1) for row in _rows_of_set(case, one, number)]
    if not isinstance(case.droppers, tuple):
        rows = [(None, None, None, None, *row[4:]) for row in rows]
    used = [at for at in range(len(heads)) if any(row[at] is not None for row in rows)]
    return [[heads[at] for at in used], *([row[at] for at in used] for row in rows)]


def _rows_of_set(case: Case, one: Droppers, number: int) -> Iterator[Row]:
    is_about = one.about == "mast"
    count = case.line.spans - is_about
    named = (number, one.tension_length, one.from_, one.to)
    positions = one.positions_by_span(count)
    presags = one.presag_by_span(count) if one.presag is not None else ()
    lengths = one.lengths_by_span(count)
    for place, row in enumerate(positions):
        support = place + 1 if is_about else place
        mast = case.line.masts[support] if case.line.masts is not None else None
        at: tuple[Any, ...] = (support + 1, None, mast) if is_about else (None, place + 1, mast)
        for index, position in enumerate(row):
            presag = presags[place][index] if presags else None
            length = lengths[place][index] if lengths else None
            yield (*named, *at, index + 1, position, presag, length)
