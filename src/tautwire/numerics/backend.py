"""Which kernels compute: the NumPy reference."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tautwire.errors import InputError
from tautwire.numerics.reference_stepper import ReferenceStepper
from tautwire.numerics.stepper import PantographInput, StepOptions, Stepper
from tautwire.numerics.system import System


def native_available() -> bool:
    """Tell whether the native kernels are installed."""
    return False


def backend_name(choice: str) -> str:
    """Return the name of the backend that ``choice`` leads to."""
    if choice == "native":
        raise InputError("settings.backend: the native kernels are not installed; use 'auto'")
    return "reference (NumPy)"


def make_stepper(
    system: System,
    pantographs: Sequence[PantographInput],
    options: StepOptions,
    observed: NDArray[np.int64],
    backend: str = "auto",
) -> Stepper:
    """Return a time integration with the chosen backend."""
    backend_name(backend)
    return ReferenceStepper(system, pantographs, options, observed)
