"""The checksum of a result file: one line of text behind the last byte of the netCDF file.

HDF5 knows where its file ends and passes over what follows, so that every netCDF reader opens a
sealed file as it is. A program that changes the file cuts the line off, and the file is then
read like one without a seal.
"""

from __future__ import annotations

import hashlib
import re
from enum import Enum

_MARK = b"tautwire sha256 "
_LINE = re.compile(rb"\n" + _MARK + rb"([0-9a-f]{64})\n")
_LENGTH = len(_MARK) + 64 + 2
_SEARCHED = 4096
"""Bytes at the end among which a damaged seal is recognised: a disk's block."""


class Seal(Enum):
    """What the seal says about a file."""

    WHOLE = "whole"
    BROKEN = "broken"
    NONE = "none"


def sealed(content: bytes) -> bytes:
    """Return a file's bytes with the line of their checksum (SHA-256) behind them."""
    return content + b"\n" + _MARK + hashlib.sha256(content).hexdigest().encode() + b"\n"


def seal_of(content: bytes) -> Seal:
    """Compare the bytes of a file with its checksum.

    Parameters
    ----------
    content : bytes
        All of the file.

    Returns
    -------
    Seal
        ``BROKEN`` also where only part of a seal is left, ``NONE`` where there never was one.
    """
    found = _LINE.fullmatch(content[-_LENGTH:])
    if found is None:
        return Seal.BROKEN if _MARK.strip() in content[-_SEARCHED:] else Seal.NONE
    is_same = hashlib.sha256(content[:-_LENGTH]).hexdigest().encode() == found.group(1)
    return Seal.WHOLE if is_same else Seal.BROKEN
