"""Recordings of measuring trains from files of any dialect, their columns known by meaning."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path

from tautwire.errors import InputError
from tautwire.inputs.reading.documents import parse_document
from tautwire.inputs.reading.files import named, read_case_text, size_of_regular_file
from tautwire.measured.assembly import assemble
from tautwire.measured.channels import Channel, read_channels
from tautwire.measured.files.formats import open_source
from tautwire.measured.files.source import Source
from tautwire.measured.recording import Recording
from tautwire.tables.columns import RECORDING
from tautwire.tables.mapping import SheetMapping, apply_mapping, mapping_text, propose
from tautwire.tables.sheets import Sheet
from tautwire.text import shortened

MAPPING = ".mapping.yaml"
MOST_BYTES = 4_000_000_000
"""Largest recording that is read: more does not fit into the memory of a usual machine."""
MOST_MAPPINGS = 200
"""Mapping files of a folder that are tried."""


@dataclass(frozen=True, eq=False)
class RecordingFile:
    """A file of a recorder as it was understood.

    Attributes
    ----------
    path : Path
    mapping : SheetMapping
    mapping_file : Path
        What the mapping was read from, or would be written to.
    is_proposed : bool
        Whether the mapping was made from the headings.
    channels : tuple of Channel
    recording : Recording
    """

    path: Path
    mapping: SheetMapping
    mapping_file: Path
    is_proposed: bool
    channels: tuple[Channel, ...]
    recording: Recording

    def mapping_text(self) -> str:
        """Return the mapping, with the units that were decided, as the text of its file."""
        uses = tuple(
            replace(one.use, unit=one.use.unit or one.unit.replace("SI", ""))
            for one in self.channels
        )
        return mapping_text([replace(self.mapping, uses=uses)], self.path)


def load_recording(
    path: str | os.PathLike[str],
    *,
    mapping: str | os.PathLike[str] | None = None,
    speed: float | None = None,
) -> Recording:
    """Load what a measuring train recorded.

    CSV files of any dialect, XLSX, MAT, netCDF, HDF5; Parquet and TDMS with the extras ``parquet``
    and ``tdms``. Columns are recognised by name and unit, or as a mapping file says.

    Parameters
    ----------
    path
    mapping : path, optional
        Mapping file; by default the one beside the file, or another one of its folder whose
        columns are those of the file.
    speed : float m/s, optional
        Speed of the train where the file has neither time nor speed.

    Returns
    -------
    Recording
        With notes of all that was decided.

    Raises
    ------
    InputError
        Saying what is missing or wrong, and what to try.

    Examples
    --------
    >>> recording = load_recording("run.csv")  # doctest: +SKIP
    """
    return open_recording(path, mapping=mapping, speed=speed).recording


def open_recording(
    path: str | os.PathLike[str],
    *,
    mapping: str | os.PathLike[str] | None = None,
    speed: float | None = None,
) -> RecordingFile:
    """Load a recording with what is known about its file; see :func:`load_recording`."""
    file = Path(path)
    size = size_of_regular_file(file)
    if size == 0 or size > MOST_BYTES:
        what = "is empty" if size == 0 else f"has more than {MOST_BYTES / 1e9:g} GB"
        raise InputError(f"{named(file)}: {what}; give a recording, in parts if need be")
    source = open_source(file)
    found, said_by = _mapping_of(file, source, Path(mapping) if mapping is not None else None)
    if found.first_row >= len(found.sheet.rows):
        raise InputError(f"{found.sheet.label}: has headings and no rows below them")
    try:
        channels = read_channels(source, found)
    except (ValueError, IndexError, OSError, UnicodeError) as error:
        what = shortened(str(error), 200)
        raise InputError(f"{named(file)}: its rows do not fit its headings ({what})") from None
    notes = [*found.notes, *_unread(source, found)]
    recording = assemble(str(file), channels, speed=speed, positive=found.positive, notes=notes)
    target = said_by or file.with_name(file.stem + MAPPING)
    return RecordingFile(file, found, target, said_by is None, tuple(channels), recording)


def _mapping_of(file: Path, source: Source, given: Path | None) -> tuple[SheetMapping, Path | None]:
    """Return the mapping: as given, of the file, of its neighbours, or from the headings."""
    own = file.with_name(file.stem + MAPPING)
    chosen = given or (own if own.is_file() else _neighbour(file, source))
    if chosen is not None:
        return _read_mapping(chosen, source.sheets), chosen
    proposals = [found for sheet in source.sheets if (found := propose(sheet, (RECORDING,)))]
    if not proposals:
        raise InputError(
            f"{named(file)}: is no recording that can be recognised; it needs a row of headings "
            "with a time or position and a force, acceleration, height or stagger, as in "
            f"'time [s]', 'position [m]', 'contact force [N]'"
        )
    return max(proposals, key=lambda one: len(one.uses)), None


def _read_mapping(path: Path, sheets: object) -> SheetMapping:
    data = parse_document(read_case_text(path), str(path), ".yaml")
    assert isinstance(sheets, list)
    found = apply_mapping(sheets, data, str(path), (RECORDING,))
    if len(found) != 1:
        raise InputError(f"{path}: describes {len(found)} sheets; a recording is one")
    return found[0]


def _neighbour(file: Path, source: Source) -> Path | None:
    """Return a mapping file of the folder that was made for the very columns of this file."""
    candidates = sorted(file.parent.glob(f"*{MAPPING}"))[:MOST_MAPPINGS]
    for path in candidates:
        try:
            mapping = _read_mapping(path, source.sheets)
        except InputError:
            continue
        if {u.heading for u in mapping.uses} | set(mapping.aside) == _headings(mapping):
            return path
    return None


def _headings(mapping: SheetMapping) -> set[str]:
    row = mapping.sheet.rows[mapping.heading_row]
    return {cell for cell in row if isinstance(cell, str)}


def _unread(source: Source, mapping: SheetMapping) -> list[str]:
    others: list[Sheet] = [sheet for sheet in source.sheets if sheet is not mapping.sheet]
    if not others:
        return []
    heads = (", ".join(str(cell) for cell in sheet.rows[0] if cell) for sheet in others)
    names = (f"{sheet.name} ({shortened(head)})" for sheet, head in zip(others, heads, strict=True))
    return [f"not read: {'; '.join(names)}"]
