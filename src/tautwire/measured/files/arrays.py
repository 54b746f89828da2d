"""Files of arrays: MAT of all versions, netCDF, HDF5, Parquet, TDMS, as sheets of channels."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tautwire.errors import InputError
from tautwire.measured.files.source import NAME, Column, columns_of_texts
from tautwire.tables.sheets import Cell, Sheet

_SAMPLE_ROWS = 50
"""Rows from which the kind of a column is told."""
_VALUES = ("data", "values", "value", "y")
_UNITS = ("unit", "units", "unit_string")
MOST_COLUMNS = 64
"""Columns of a matrix that are taken for channels; a larger one is a picture."""
_DEEPEST = 5
"""Nesting of structures that is looked into."""


@dataclass(frozen=True, eq=False)
class Channel:
    """An array with its name and unit; the unit is empty where the file names none."""

    name: str
    unit: str
    values: Any


class ArraySource:
    """Channels of a file; those of equal length make up a sheet.

    Parameters
    ----------
    path
    channels
    """

    is_one_record = True

    def __init__(self, path: Path, channels: Iterator[Channel]) -> None:
        by_length: dict[int, list[Channel]] = {}
        for channel in channels:
            by_length.setdefault(len(channel.values), []).append(channel)
        long = {length: every for length, every in by_length.items() if length > 1}
        if not long:
            raise InputError(f"{path}: holds no channels; a recording has arrays of equal length")
        self._channels: dict[str, list[Channel]] = {}
        self.sheets: list[Sheet] = []
        for number, (length, every) in enumerate(long.items(), 1):
            name = NAME if number == 1 else f"{NAME} {number}"
            self._channels[name] = every
            label = str(path) if len(long) == 1 else f"{path}, channels of {length} samples"
            rows = _sample(every)
            self.sheets.append(Sheet(label, name, rows, list(range(1, len(rows) + 1))))

    def read(self, sheet: Sheet, first_row: int, wanted: dict[int, bool]) -> dict[int, Column]:
        """See :class:`Source`."""
        start = first_row - 1  # the first row of the sheet holds the names
        return {
            column: _column(self._channels[sheet.name][column].values[start:], as_text=is_text)
            for column, is_text in wanted.items()
        }


def _sample(channels: list[Channel]) -> list[list[Cell]]:
    heads: list[Cell] = [f"{c.name} [{c.unit}]" if c.unit else c.name for c in channels]
    rows: list[list[Cell]] = [heads]
    count = min(_SAMPLE_ROWS, len(channels[0].values))
    rows += [[_cell(channel.values[index]) for channel in channels] for index in range(count)]
    return rows


def _cell(value: Any) -> Cell:
    if isinstance(value, bytes):
        return value.decode("utf-8", errors="replace")
    return float(value) if np.issubdtype(np.asarray(value).dtype, np.number) else str(value)


def _column(values: Any, *, as_text: bool) -> Column:
    array = np.asarray(values)
    if array.dtype.kind == "M":
        seconds = (array - array[0]) / np.timedelta64(1, "ns") * 1e-9
        return Column(seconds.astype(np.float64))
    if array.dtype.kind in "bifu" and not as_text:
        numbers = array.astype(np.float64)
        numbers[~np.isfinite(numbers)] = np.nan
        return Column(numbers)
    texts = np.array([str(_cell(value)).encode() for value in array], dtype=np.bytes_)
    return Column(texts=texts) if as_text else columns_of_texts(texts)


def flattened(tree: Mapping[str, Any], above: str = "", depth: int = 0) -> Iterator[Channel]:
    """Yield the channels of nested structures.

    A structure with values and a unit is a channel; a matrix has a channel per column.

    Parameters
    ----------
    tree
        Arrays, texts and further mappings by name.
    above
        Name of what they are in.
    depth
    """
    unit = next((tree[key] for key in _UNITS if isinstance(tree.get(key), str)), "")
    for name, value in tree.items():
        path = f"{above}.{name}" if above else name
        if isinstance(value, Mapping):
            if depth < _DEEPEST:
                yield from flattened(value, path, depth + 1)
        elif not isinstance(value, str):
            is_values = name.lower() in _VALUES and above
            yield from _channels(above if is_values else path, unit if is_values else "", value)


def _channels(name: str, unit: str, value: Any) -> Iterator[Channel]:
    array = np.squeeze(np.asarray(value))
    if array.ndim == 1 and array.dtype.kind in "bifuMSUO" and len(array) > 1:
        yield Channel(name, unit, array)
    elif array.ndim == 2 and array.dtype.kind in "bifu" and min(array.shape) <= MOST_COLUMNS:
        columns = array if array.shape[0] >= array.shape[1] else array.T
        for number, column in enumerate(columns.T, 1):
            yield Channel(f"{name}_{number}", unit, column)
