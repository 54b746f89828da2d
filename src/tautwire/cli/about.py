"""Version and kernels in use."""

from __future__ import annotations

import sys

from tautwire import __version__


def kernels(choice: str = "auto") -> str:
    """Return which kernels a choice leads to, as a person reads it."""
    from tautwire.numerics.backend import backend_name

    name = backend_name(choice)
    return {"native": "native kernels", "reference": "NumPy kernels"}.get(name, name)


def show_version() -> None:
    """Print version and kernels."""
    sys.stdout.write(f"tautwire {__version__} ({kernels()})\n")
