"""What a result shows that is made by rooms above it, found by name when it is asked for.

The package, which knows all rooms, says where it is made; results depend on none of them.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

_homes: dict[str, tuple[str, str]] = {}


def register(name: str, module: str, maker: str) -> None:
    """Say that `maker` of a module makes what results show as `name`."""
    _homes[name] = module, maker


def made(name: str, result: object) -> Any:
    """Return what a result shows as `name`."""
    module, maker = _homes[name]
    return getattr(import_module(module), maker)(result)
