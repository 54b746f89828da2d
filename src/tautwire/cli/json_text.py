"""JSON that programs read strictly and people read easily."""

from __future__ import annotations

import json
from typing import Any

from tautwire.plain import plain


def to_json(value: Any) -> str:
    """Return JSON with one line per key and plain lists on one line.

    Parameters
    ----------
    value
        Mappings, sequences, texts, Python and NumPy numbers and arrays, nested as needed. A
        number that is not finite becomes null.
    """
    return _written(plain(value), "")


def _written(value: Any, margin: str) -> str:
    inner = margin + " "
    if isinstance(value, dict) and value:
        items = (f"{json.dumps(key)}: {_written(item, inner)}" for key, item in value.items())
        return "{\n" + ",\n".join(inner + item for item in items) + f"\n{margin}}}"
    if isinstance(value, list) and any(isinstance(item, dict | list) for item in value):
        lines = (inner + _written(item, inner) for item in value)
        return "[\n" + ",\n".join(lines) + f"\n{margin}]"
    return json.dumps(value, allow_nan=False)
