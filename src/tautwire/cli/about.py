"""Version and backend in use."""

from __future__ import annotations

import sys
from typing import Literal

from tautwire.cli.progress import duration
from tautwire.cli.session import REFUSED
from tautwire.errors import InputError
from tautwire.model.resolution import Size
from tautwire.version import __version__


def backend(choice: Literal["auto", "native", "reference"] = "auto") -> str:
    """Return the name of the backend that a choice leads to.

    Parameters
    ----------
    choice
        ``settings.backend``.

    Raises
    ------
    InputError
        When it asks for compiled kernels that are not here.
    """
    from tautwire.numerics.motion.backend import backend_name

    return backend_name(choice)


def program(choice: Literal["auto", "native", "reference"] = "auto") -> str:
    """Return name, version and backend."""
    return f"tautwire {__version__}, backend {backend(choice)}"


def computation(amount: Size, choice: Literal["auto", "native", "reference"]) -> str:
    """Return how large a computation is, and about how long it takes with the backend chosen."""
    is_compiled = choice != "reference" and backend().startswith("native")
    return (
        f"{amount.dof} degrees of freedom, {amount.steps} steps per passage, about "
        f"{duration(amount.cpu_s(is_compiled=is_compiled))} of CPU time each with "
        f"{'the compiled core' if is_compiled else 'NumPy'}"
    )


def show_version() -> int:
    """Print version and backend; return the exit code."""
    try:
        sys.stdout.write(f"{program()}\n")
    except InputError as error:
        sys.stderr.write(f"error: {error}\n")
        return REFUSED
    return 0
