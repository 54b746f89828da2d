"""What a file of a recorder holds, whatever its format: sheets to look at, columns to read."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from tautwire.measured.recording import Array
from tautwire.tables.sheets import Cell, Sheet

NAME = "recording"
"""Name of the sheet of a file that has one: the mapping of one file serves the next."""
HEAD_ROWS = 200
"""Rows that are looked at to understand a file."""


@dataclass(frozen=True, eq=False)
class Column:
    """A column as it was read.

    Attributes
    ----------
    numbers : (n,) or None
        NaN where a cell holds no number; None for a column of texts.
    texts : (n,) bytes or None
        UTF-8.
    words : Counter
        What stood in cells that hold no number; ``""`` for empty ones.
    """

    numbers: Array | None = None
    texts: NDArray[np.bytes_] | None = None
    words: Counter[str] = field(default_factory=Counter)


class Source(Protocol):
    """An open file of a recorder."""

    @property
    def is_one_record(self) -> bool:
        """Whether its tables are channels of one record, sampled at different rates."""
        ...

    @property
    def sheets(self) -> Sequence[Sheet]:
        """The first rows of every table of the file."""
        ...

    def read(self, sheet: Sheet, first_row: int, wanted: dict[int, bool]) -> dict[int, Column]:
        """Read columns of one sheet.

        Parameters
        ----------
        sheet
        first_row
            Index, among the rows of the sheet, of the first one with values.
        wanted
            Columns by number from 0; True for columns of texts.

        Returns
        -------
        dict of int to Column
            All of the same length.
        """
        ...


def columns_of_texts(texts: NDArray[np.bytes_]) -> Column:
    """Turn texts into numbers as far as they are some.

    Parameters
    ----------
    texts : (n,) bytes
    """
    stripped = np.char.strip(texts)
    try:
        numbers = stripped.astype(np.float64)
    except ValueError:
        return _with_words(stripped)
    return Column(_finite(numbers))


def _with_words(texts: NDArray[np.bytes_]) -> Column:
    odd = np.zeros(len(texts), dtype=bool)
    width = texts.dtype.itemsize
    letters = np.ascontiguousarray(texts).view(np.uint8).reshape(len(texts), width)
    allowed = np.zeros(256, dtype=bool)
    allowed[list(b"0123456789+-.eE\0")] = True
    odd |= ~allowed[letters].all(axis=1) | (letters[:, 0] == 0)
    numbers = np.full(len(texts), np.nan)
    try:
        numbers[~odd] = texts[~odd].astype(np.float64)
    except ValueError:  # made of the right letters, and yet no number: "1-2", "+"
        for index in np.flatnonzero(~odd):
            try:
                numbers[index] = float(texts[index])
            except ValueError:
                odd[index] = True
    found, counts = np.unique(texts[odd], return_counts=True)
    words = {text_of(word): int(n) for word, n in zip(found, counts, strict=True)}
    return Column(_finite(numbers), words=Counter(words))


def text_of(content: bytes) -> str:
    """Return bytes as text: UTF-8, else cp1252."""
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError:
        return content.decode("cp1252", errors="replace")


def _finite(numbers: Array) -> Array:
    numbers[~np.isfinite(numbers)] = np.nan
    return numbers


def column_of_cells(cells: Sequence[Cell], *, as_text: bool, decimal_comma: bool) -> Column:
    """Return cells of a workbook as a column."""
    texts = ["" if cell is None else str(cell) for cell in cells]
    if decimal_comma and not as_text:
        texts = [text.replace(",", ".") for text in texts]
    encoded = np.array([text.encode() for text in texts], dtype=np.bytes_)
    return Column(texts=encoded) if as_text else columns_of_texts(encoded)
