"""Version and backend in use."""

from __future__ import annotations

import sys

from tautwire import __version__


def program(choice: str = "auto") -> str:
    """Return name, version and the backend that a choice leads to.

    Parameters
    ----------
    choice
        ``settings.backend``.
    """
    from tautwire.numerics.backend import backend_name

    return f"tautwire {__version__}, backend {backend_name(choice)}"


def show_version() -> None:
    """Print version and backend."""
    sys.stdout.write(f"{program()}\n")
