"""Results as plain data for JSON: mappings, lists, texts, finite numbers, nothing."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields
from typing import Any, ClassVar

_KEY, _FACTOR = "key", "factor"


def plain(value: Any, factor: float = 1.0) -> Any:
    """Return data that JSON knows; a number that is not finite becomes None.

    Parameters
    ----------
    value
        Mappings, sequences, texts, Python and NumPy numbers and arrays, objects that tell their
        content by ``as_dict``, nested as needed.
    factor
        What numbers are multiplied by, for a key that names another unit than SI.
    """
    if hasattr(value, "as_dict"):
        return value.as_dict()
    if isinstance(value, Mapping):
        return {str(key): plain(item, factor) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item, factor) for item in value]
    if hasattr(value, "tolist"):
        return plain(value.tolist(), factor)
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value if factor == 1.0 or not isinstance(value, int | float) else factor * value


class Plain:
    """A frozen dataclass that becomes plain data field by field.

    A field has its own name as key unless :func:`named` gives another one.
    """

    derived: ClassVar[tuple[str, ...]] = ()
    """Properties that are told after the fields."""

    untold: ClassVar[tuple[str, ...]] = ()
    """Fields that are left out."""

    def as_dict(self) -> dict[str, Any]:
        """Return the content as plain data for JSON, None in place of what is not finite."""
        content = {}
        for item in fields(self):  # pyright: ignore[reportArgumentType] - a mixin of dataclasses
            if item.name not in self.untold:
                key, factor = item.metadata.get(_KEY, item.name), item.metadata.get(_FACTOR, 1.0)
                content[key] = plain(getattr(self, item.name), factor)
        return {**content, **{name: plain(getattr(self, name)) for name in self.derived}}


def named(key: str, factor: float = 1.0) -> dict[str, Any]:
    """Return the metadata of a field whose key tells its unit.

    Parameters
    ----------
    key
        Its name in the plain data.
    factor
        Number of its units in one SI unit: 1e3 for a length in millimetres.

    Examples
    --------
    ``duration: float = field(metadata=named("duration_ms", 1e3))``
    """
    return {_KEY: key, _FACTOR: factor}
