"""Reading of text files, with a reason and a cure for everything that can be wrong with one."""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Iterable
from difflib import get_close_matches
from pathlib import Path

from tautwire.errors import InputError, cure_of
from tautwire.text import shortened

MAX_CASE_BYTES = 1_000_000
"""The largest number of values takes about half; more is no case file."""
MAX_TABLE_BYTES = 20_000_000
"""An hour of a recording at 100 Hz, or a profile of 20 km; reading takes seconds."""


def read_case_text(path: Path) -> str:
    """Read a case file (YAML, TOML, JSON) of at most 1 MB.

    Raises
    ------
    InputError
        When the file cannot be read as text.
    """
    use = "a case file; keep long tables in CSV files ('tables')"
    text = _decoded(path, _read(path, MAX_CASE_BYTES, use))
    if not text.strip():
        raise InputError(
            f"{named(path)}: is empty; 'tautwire cases ac-simple --copy my-line.yaml' writes a "
            "file to start from"
        )
    return text


def read_table_bytes(path: Path) -> bytes:
    """Read a table, a text or a workbook, of at most 20 MB.

    Raises
    ------
    InputError
        When the file cannot be read.
    """
    content = _read(path, MAX_TABLE_BYTES, "a table; split the file or thin out its rows")
    if not content.strip():
        raise InputError(f"{named(path)}: is empty; a table has a header row and one row per item")
    return content


def read_image(path: Path, limit: int) -> bytes:
    """Read an image file of at most ``limit`` bytes.

    Raises
    ------
    InputError
        When the file cannot be read or is larger.
    """
    size = size_of_regular_file(path)
    if size > limit:
        raise InputError(
            f"{named(path)}: has {size / 1e3:.0f} kB; at most {limit / 1e3:g} kB are kept in every "
            "result; save the image smaller"
        )
    try:
        return _read_bytes(path, limit) if size else b""
    except OSError as error:
        raise InputError(_unreadable(path, error)) from None


def named(path: Path | str) -> str:
    """Return a path as messages name it: complete, unless it is far too long."""
    return shortened(str(path), 300)


def did_you_mean(word: str, candidates: Iterable[str]) -> str:
    """Return ``"; did you mean 'x'?"`` for the closest candidate, or an empty text."""
    lowered = {candidate.lower(): candidate for candidate in candidates}
    close = get_close_matches(word.lower(), lowered, n=1, cutoff=0.6)
    return f"; did you mean {lowered[close[0]]!r}?" if close else ""


def neighbours(path: Path) -> list[str]:
    """Return the names of the files beside a path, for suggestions; empty when unreadable."""
    try:
        return [entry.name for entry in path.parent.iterdir() if entry.is_file()]
    except OSError:
        return []


def _read(path: Path, limit: int, use: str) -> bytes:
    size = size_of_regular_file(path)
    if size > limit:
        raise InputError(
            f"{named(path)}: has {size / 1e6:.1f} MB; at most {limit / 1e6:g} MB are read as {use}"
        )
    try:
        return _read_bytes(path, limit) if size else b""
    except OSError as error:
        raise InputError(_unreadable(path, error)) from None


def _read_bytes(path: Path, limit: int) -> bytes:
    """Read a file that was regular a moment ago, without waiting for anything.

    Files of the kernel, as in ``/proc``, say that they are empty and are not read at all: some
    wait for events, some never end.
    """
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    with open(os.open(path, flags), "rb") as stream:  # noqa: PTH123
        if not stat.S_ISREG(os.fstat(stream.fileno()).st_mode):
            raise OSError(errno.EINVAL, "not a regular file")
        return stream.read(limit)


def size_of_regular_file(path: Path) -> int:
    """Return the size of a file.

    Raises
    ------
    InputError
        When there is none, or it is no regular one.
    """
    try:
        status = path.stat()
    except FileNotFoundError:
        hint = did_you_mean(path.name, neighbours(path))
        where = f"{named(path)}: there is no such file"
        raise InputError(f"{where}{hint or '; check the path'}") from None
    except (OSError, ValueError) as error:
        raise InputError(_unreadable(path, error)) from None
    if stat.S_ISDIR(status.st_mode):
        raise InputError(f"{named(path)}: is a directory; give the path of a file in it")
    if not stat.S_ISREG(status.st_mode):
        raise InputError(f"{named(path)}: is not a regular file; give the path of a text file")
    return status.st_size


def _unreadable(path: Path, error: Exception) -> str:
    reason = getattr(error, "strerror", None) or str(error)
    return f"{named(path)}: cannot be read ({reason}); {cure_of(error)}"


def _decoded(path: Path, content: bytes) -> str:
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(
            f"{named(path)}: is not UTF-8 text (byte {error.start + 1}); save it as UTF-8, and "
            "check that it is a text file"
        ) from None
    if "\0" in text:
        raise InputError(f"{named(path)}: is a binary file; a text file is needed")
    return text
