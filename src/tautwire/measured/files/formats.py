"""Which reader a file needs, told by its first bytes."""

from __future__ import annotations

import logging
import zipfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from tautwire.errors import InputError
from tautwire.measured.files.arrays import ArraySource, Channel, flattened
from tautwire.measured.files.source import Column, Source, column_of_cells
from tautwire.measured.files.text import TextSource
from tautwire.results.layout import FORMAT
from tautwire.tables.sheets import Sheet, workbook_sheets

MOST_BOOK_ROWS = 1_048_576
"""Rows of a worksheet, the most that the format has."""


def open_source(path: Path) -> Source:
    """Open a file of a recorder.

    Raises
    ------
    InputError
        When it cannot be read, or a package for its format is missing, with the one to install.
    """
    with path.open("rb") as file:
        start = file.read(128)
    try:
        for magic, opened in _READERS:
            if start.startswith(magic):
                return opened(path)
        return TextSource(path)
    except InputError:
        raise
    except Exception as error:  # noqa: BLE001 - readers raise whatever damaged bytes lead them to
        what = " ".join(str(error).split())[:200]
        raise InputError(f"{path}: is damaged or of an unknown kind ({what})") from None


class BookSource:
    """A workbook.

    Parameters
    ----------
    path
    """

    is_one_record = False

    def __init__(self, path: Path) -> None:
        every = workbook_sheets(path, path.read_bytes(), MOST_BOOK_ROWS)
        self.sheets: list[Sheet] = [sheet for sheet in every if len(sheet.rows) > 1]
        if not self.sheets:
            raise InputError(f"{path}: holds no table")

    def read(self, sheet: Sheet, first_row: int, wanted: dict[int, bool]) -> dict[int, Column]:
        """See :class:`Source`."""
        rows = sheet.rows[first_row:]
        return {
            column: column_of_cells(
                [row[column] if column < len(row) else None for row in rows],
                as_text=is_text,
                decimal_comma=True,
            )
            for column, is_text in wanted.items()
        }


def _hdf5(path: Path) -> Source:
    import h5py

    with h5py.File(path, "r") as file:
        _refuse_run(path, file.attrs)
        return ArraySource(path, iter(list(flattened(_tree(file)))))


def _tree(group: Any, depth: int = 0) -> dict[str, Any]:
    """Return an HDF5 group as arrays and texts by name, with the attribute of the unit."""
    import h5py

    found: dict[str, Any] = {}
    for name, item in group.items():
        if name.startswith("#") or depth > 5:
            continue
        if isinstance(item, h5py.Group):
            found[name] = _tree(item, depth + 1)
            continue
        if item.attrs.get("MATLAB_class") == b"char":
            found[name] = "".join(map(chr, np.ravel(item[()])))
            continue
        unit = item.attrs.get("units", item.attrs.get("unit", ""))
        unit = unit.decode() if isinstance(unit, bytes) else str(unit)
        found[name] = {"data": item[()], "units": unit} if unit else item[()]
    return found


def is_computed(path: Path) -> bool:
    """Tell whether a file is a result of this program, and no recording."""
    import h5py

    try:
        with h5py.File(path, "r") as file:
            return file.attrs.get("format") == FORMAT
    except (OSError, RuntimeError, KeyError, ValueError):  # what HDF5 makes of damaged bytes
        return False


def _refuse_run(path: Path, attributes: Mapping[str, Any]) -> None:
    if attributes.get("format") == FORMAT:
        raise InputError(
            f"{path}: is a computed run, not a recording; 'tautwire report {path.name}' shows it"
        )


def _netcdf3(path: Path) -> Source:
    from scipy.io import netcdf_file

    with netcdf_file(path, "r", mmap=False) as file:
        tree = {
            name: {
                "data": np.array(variable[:]).astype(variable.data.dtype.newbyteorder("=")),
                "units": getattr(variable, "units", b"").decode("utf-8", errors="replace"),
            }
            for name, variable in file.variables.items()
        }
    return ArraySource(path, flattened(tree))


def _mat5(path: Path) -> Source:
    from scipy.io import loadmat

    content = loadmat(path, squeeze_me=True, struct_as_record=False)
    return ArraySource(path, flattened(_plain_mat(content)))


def _plain_mat(content: Mapping[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in content.items():
        if name.startswith("__"):
            continue
        fields = getattr(value, "_fieldnames", None)
        if fields is not None:
            found[name] = _plain_mat({field: getattr(value, field) for field in fields})
        else:
            found[name] = str(value) if np.asarray(value).dtype.kind == "U" else value
    return found


def _parquet(path: Path) -> Source:
    try:
        import pyarrow.parquet as parquet
    except ModuleNotFoundError:
        raise InputError(
            f"{path}: Parquet needs pyarrow; install it with 'pip install tautwire[parquet]', or "
            "save the recording as CSV"
        ) from None
    file = parquet.ParquetFile(path)
    channels = [
        Channel(
            field.name,
            (field.metadata or {}).get(b"unit", b"").decode(errors="replace"),
            file.read([field.name]).column(0).to_numpy(),  # one at a time: half the memory
        )
        for field in file.schema_arrow
    ]
    return ArraySource(path, iter(channels))


def _tdms(path: Path) -> Source:
    try:
        from nptdms import TdmsFile
    except ModuleNotFoundError:
        raise InputError(
            f"{path}: TDMS needs npTDMS (LGPL); install it with 'pip install tautwire[tdms]', or "
            "save the recording as CSV"
        ) from None
    logging.getLogger("nptdms").setLevel(logging.CRITICAL)  # it logs damaged bytes as they are
    return ArraySource(path, _tdms_channels(TdmsFile.read(path)))


def _tdms_channels(file: Any) -> Iterator[Channel]:
    """Yield the channels of all groups, and the time that their waveforms imply."""
    timed: set[int] = set()
    for group in file.groups():
        for channel in group.channels():
            values = channel[:]
            if len(values) < 2:
                continue
            properties = channel.properties
            step = properties.get("wf_increment", 0.0)
            if step and len(values) not in timed:
                timed.add(len(values))
                yield Channel("time", "s", step * np.arange(len(values)))
            unit = str(properties.get("unit_string", properties.get("NI_UnitDescription", "")))
            yield Channel(f"{group.name}.{channel.name}", unit, values)


def _book(path: Path) -> Source:
    if not zipfile.is_zipfile(path):
        raise InputError(f"{path}: is a damaged archive; a workbook is saved as .xlsx")
    return BookSource(path)


_READERS: tuple[tuple[bytes, Callable[[Path], Source]], ...] = (
    (b"PK\x03\x04", _book),
    (b"\x89HDF\r\n", _hdf5),
    (b"MATLAB 7.3", _hdf5),
    (b"MATLAB 5.0", _mat5),
    (b"CDF\x01", _netcdf3),
    (b"CDF\x02", _netcdf3),
    (b"PAR1", _parquet),
    (b"TDSm", _tdms),
)
