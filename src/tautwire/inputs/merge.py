"""Merging of plain data: what stands locally completes or replaces what was included."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

EXCLUSIVE = (("mean_force", "uplift_force"), ("spring", "axial"))
"""Keys of one mapping that exclude each other: setting one takes the other away."""


def merge(base: Mapping[str, Any], local: Mapping[str, Any]) -> dict[str, Any]:
    """Merge two mappings; local values win, mappings are merged key by key, lists replaced."""
    merged = clear_excluded(base, local)
    for key, value in local.items():
        below = merged.get(key)
        if isinstance(below, Mapping) and isinstance(value, Mapping):
            merged[key] = merge(below, value)
        else:
            merged[key] = value
    return merged


def clear_excluded(base: Mapping[str, Any], local: Mapping[str, Any]) -> dict[str, Any]:
    """Return a copy of `base` without the keys that keys of `local` exclude."""
    dropped = {
        other
        for one, two in EXCLUSIVE
        for given, other in ((one, two), (two, one))
        if local.get(given) is not None and other not in local
    }
    return {key: value for key, value in base.items() if key not in dropped}
