"""Text files of any dialect, read block by block so that long ones fit into memory."""

from __future__ import annotations

import io
import re
import warnings
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from tautwire.measured.files.source import HEAD_ROWS, NAME, Column, columns_of_texts
from tautwire.tables.sheets import Sheet, decoded, text_sheet

_HEAD_BYTES = 400_000
"""Bytes in which the first rows are looked for: 200 rows of 2 kB."""
_BLOCK_BYTES = 16_000_000
"""Bytes of whole lines that are parsed at a time."""
_COMMENT = re.compile(rb"(?m)^#(?!N/A|DIV|VAL|REF|NUM|NAM|NUL).*(?:\n|\Z)")
_NUMBER_WIDTH, _TEXT_WIDTH = 32, 80
"""Bytes of a number and of a text that are kept."""


class TextSource:
    """A text file with one table.

    Parameters
    ----------
    path
    """

    is_one_record = False

    def __init__(self, path: Path) -> None:
        self.path = path
        with self._opened() as file:
            head = file.read(_HEAD_BYTES)
        text = decoded(path, head[: head.rfind(b"\n") + 1] or head)
        lines = text.splitlines(keepends=True)[:HEAD_ROWS]
        self.sheets: list[Sheet] = [text_sheet(path, "".join(lines), NAME)]

    def read(self, sheet: Sheet, first_row: int, wanted: dict[int, bool]) -> dict[int, Column]:
        """See :class:`Source`; lines that are cut short are left out."""
        parts: dict[int, list[Column]] = {column: [] for column in wanted}
        for block in self._blocks(sheet.numbers[first_row]):
            for column, part in _parsed(block, sheet, wanted).items():
                parts[column].append(part)
        return {column: _joined(pieces) for column, pieces in parts.items()}

    def _opened(self) -> BinaryIO:
        """Open the file; UTF-16 becomes UTF-8 first."""
        with self.path.open("rb") as file:
            start = file.read(2)
        if start in (b"\xff\xfe", b"\xfe\xff"):
            return io.BytesIO(self.path.read_bytes().decode("utf-16", errors="replace").encode())
        return self.path.open("rb")

    def _blocks(self, first_line: int) -> Iterator[bytes]:
        with self._opened() as file:
            for _ in range(first_line - 1):
                file.readline()
            while block := file.read(_BLOCK_BYTES):
                block += file.readline()
                if block.startswith(b"#") or b"\n#" in block:
                    block = _COMMENT.sub(b"", block)
                if block.strip():
                    yield block


def _parsed(block: bytes, sheet: Sheet, wanted: dict[int, bool]) -> dict[int, Column]:
    """Parse whole lines: as numbers if all cells are some, else cell by cell."""
    if sheet.decimal_comma:
        block = block.replace(b",", b".")
    try:
        table = _loaded(block, sheet.separator, wanted, "f8")
    except ValueError:
        try:
            table = _loaded(block, sheet.separator, wanted, f"S{_NUMBER_WIDTH}")
        except ValueError:  # a line is cut short
            whole = _whole_lines(block, sheet.separator, max(wanted))
            table = _loaded(whole, sheet.separator, wanted, f"S{_NUMBER_WIDTH}")
    columns = {}
    for column, is_text in wanted.items():
        values = table[f"c{column}"]
        if is_text:
            columns[column] = Column(texts=np.char.strip(values))
        elif values.dtype.kind == "f":
            numbers = np.ascontiguousarray(values)
            numbers[~np.isfinite(numbers)] = np.nan
            columns[column] = Column(numbers)
        else:
            columns[column] = columns_of_texts(values)
    return columns


def _loaded(block: bytes, separator: str, wanted: dict[int, bool], number: str) -> Any:
    kinds = [
        (f"c{column}", f"S{_TEXT_WIDTH}" if is_text else number)
        for column, is_text in wanted.items()
    ]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # a block may hold nothing but white space
        return np.loadtxt(
            io.StringIO(block.decode("latin-1")),
            dtype=kinds,
            delimiter=None if separator == " " else separator,
            usecols=list(wanted),
            quotechar='"' if b'"' in block else None,
            comments=None,
            ndmin=1,
        )


def _whole_lines(block: bytes, separator: str, last: int) -> bytes:
    mark = separator.encode()
    lines = (line for line in block.split(b"\n") if line.count(mark) >= last)
    return b"\n".join(lines)


def _joined(parts: list[Column]) -> Column:
    words: Counter[str] = Counter()
    for part in parts:
        words.update(part.words)
    numbers = [part.numbers for part in parts if part.numbers is not None]
    texts = [part.texts for part in parts if part.texts is not None]
    return Column(
        np.concatenate(numbers) if numbers else None,
        np.concatenate(texts) if texts else None,
        words,
    )
