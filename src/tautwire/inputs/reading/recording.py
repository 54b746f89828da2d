"""Recordings of measuring trains from files of any dialect, their columns known by meaning."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from tautwire.errors import InputError
from tautwire.inputs.reading.documents import parse_document
from tautwire.inputs.reading.files import named, read_case_text, size_of_regular_file
from tautwire.measured.channels import Channel, read_channels
from tautwire.measured.files.assembly import assemble
from tautwire.measured.files.formats import open_source
from tautwire.measured.files.rates import Rate, fastest, with_other_rates
from tautwire.measured.files.source import Source
from tautwire.measured.recording import Recording
from tautwire.tables.columns import RECORDING, fields_of
from tautwire.tables.mapping import SheetMapping, apply_mapping, mapping_text, match, propose
from tautwire.tables.sheets import Sheet
from tautwire.text import shortened

MAPPING = ".mapping.yaml"
MOST_BYTES = 4_000_000_000
"""Largest recording that is read: more does not fit into the memory of a usual machine."""
MOST_MAPPINGS = 200
"""Mapping files of a folder that are tried."""
FIELDS = fields_of(RECORDING)
TIMED = (("time",),)
"""What channels of another sampling rate must have."""


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
    others : tuple of Rate
        Channels of other sampling rates that were added.
    recording : Recording
    """

    path: Path
    mapping: SheetMapping
    mapping_file: Path
    is_proposed: bool
    channels: tuple[Channel, ...]
    others: tuple[Rate, ...]
    recording: Recording

    def mapping_text(self) -> str:
        """Return the mapping, with the units that were decided, as the text of its file."""
        sheets = [(self.mapping, self.channels)]
        sheets += [(one.mapping, one.channels) for one in self.others]
        decided = [
            replace(
                mapping,
                uses=tuple(
                    replace(one.use, unit=one.use.unit or one.unit.replace("SI", ""))
                    for one in channels
                ),
            )
            for mapping, channels in sheets
        ]
        return mapping_text(decided, self.path)


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
    mappings, said_by = _mappings_of(file, source, Path(mapping) if mapping is not None else None)
    for one in mappings:
        if one.first_row >= len(one.sheet.rows):
            raise InputError(f"{one.sheet.label}: has headings and no rows below them")
    try:
        rates = [Rate(one, tuple(read_channels(source, one))) for one in mappings]
    except (ValueError, IndexError, OSError, UnicodeError) as error:
        what = shortened(str(error), 200)
        raise InputError(f"{named(file)}: its rows do not fit its headings ({what})") from None
    main, others = fastest(rates)
    channels, added = with_other_rates(main, others)
    notes = [*main.mapping.notes, *added, *_unread(source, mappings)]
    recording = assemble(
        str(file), channels, speed=speed, positive=main.mapping.positive, notes=notes
    )
    target = said_by or file.with_name(file.stem + MAPPING)
    return RecordingFile(
        file, main.mapping, target, said_by is None, main.channels, tuple(others), recording
    )


def _mappings_of(
    file: Path, source: Source, given: Path | None
) -> tuple[list[SheetMapping], Path | None]:
    """Return the mappings: as given, of the file, of its neighbours, or from the headings.

    One but for files whose tables are channels of one record with several sampling rates.
    """
    own = file.with_name(file.stem + MAPPING)
    chosen = given or (own if own.is_file() else _neighbour(file, source))
    if chosen is not None:
        return _read_mapping(chosen, source), chosen
    proposals = [found for sheet in source.sheets if (found := propose(sheet, (RECORDING,)))]
    if not proposals:
        raise InputError(
            f"{named(file)}: is no recording that can be recognised; it needs a row of headings "
            "with a time or position and a force, acceleration, height or stagger, as in "
            f"'time [s]', 'position [m]', 'contact force [N]'"
        )
    if not source.is_one_record or not all(one.use("time") for one in proposals):
        return [max(proposals, key=lambda one: len(one.uses))], None
    read = [one.sheet for one in proposals]
    rest = [sheet for sheet in source.sheets if sheet not in read]
    timed = [found for sheet in rest if (found := match(sheet, RECORDING, FIELDS, TIMED))]
    return [*proposals, *timed], None


def _read_mapping(path: Path, source: Source) -> list[SheetMapping]:
    return _applied(_document(path), path, source)


def _document(path: Path) -> dict[str, Any]:
    return parse_document(read_case_text(path), str(path), ".yaml")


def _applied(data: dict[str, Any], path: Path, source: Source) -> list[SheetMapping]:
    found = apply_mapping(source.sheets, data, str(path), (RECORDING,))
    if len(found) != 1 and not (found and source.is_one_record):
        raise InputError(f"{path}: describes {len(found)} sheets; a recording is one")
    return found


def _neighbour(file: Path, source: Source) -> Path | None:
    """Return a mapping file of the folder that was made for the very columns of this file."""
    candidates = sorted(file.parent.glob(f"*{MAPPING}"))[:MOST_MAPPINGS]
    for path in candidates:
        try:
            data = _document(path)
            mappings = _applied(data, path, source)
        except InputError:
            continue
        if all(_named_columns(data, one) == _headings(one) for one in mappings):
            return path
    return None


def _named_columns(data: dict[str, Any], mapping: SheetMapping) -> set[str]:
    """Return the headings that a mapping file has an entry for, read or aside."""
    return set(data["sheets"][mapping.sheet.name].get("columns") or {})


def _headings(mapping: SheetMapping) -> set[str]:
    row = mapping.sheet.rows[mapping.heading_row]
    return {cell for cell in row if isinstance(cell, str)}


def _unread(source: Source, mappings: Sequence[SheetMapping]) -> list[str]:
    read = [one.sheet for one in mappings]
    others: list[Sheet] = [sheet for sheet in source.sheets if sheet not in read]
    if not others:
        return []
    heads = (", ".join(str(cell) for cell in sheet.rows[0] if cell) for sheet in others)
    names = (f"{sheet.name} ({shortened(head)})" for sheet, head in zip(others, heads, strict=True))
    return [f"not read: {'; '.join(names)}"]
