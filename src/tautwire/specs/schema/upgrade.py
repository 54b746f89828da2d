"""Input of older versions of the format, turned into the present one.

Pure functions on plain data, one per version, applied to every document before it is validated.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

SCHEMA_VERSION = 2
READ_VERSIONS = (1, 2)
"""Versions that are read; every version but the last is upgraded step by step."""


def from_1(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return schema 2 data for schema 1 data.

    Every key of schema 1 keeps its meaning in schema 2, so only the number changes.
    """
    return {**data, "schema": 2}


def upgraded(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return the data of a document in the present version; other versions are left as they are."""
    return from_1(data) if data.get("schema") == 1 else dict(data)
