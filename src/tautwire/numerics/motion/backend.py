"""The choice between the compiled core and the NumPy reference; nothing else loads the core."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import replace
from functools import cache
from types import ModuleType
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from tautwire.errors import InputError
from tautwire.numerics.elements import ancf
from tautwire.numerics.motion.extrapolated_stepper import ExtrapolatedStepper
from tautwire.numerics.motion.native_line import NotAChainError
from tautwire.numerics.motion.native_stepper import NativeStepper
from tautwire.numerics.motion.reference_stepper import ReferenceStepper
from tautwire.numerics.motion.stepper import PantographInput, StepOptions, Stepper
from tautwire.numerics.network.system import System
from tautwire.numerics.newmark import Extrapolated

Array = NDArray[Any]
Index = NDArray[np.int64]
Choice = Literal["auto", "native", "reference"]

SIMD_VARIABLE = "TAUTWIRE_SIMD"
"""Environment variable that chooses the instruction set of the compiled core."""

THREADS_VARIABLE = "TAUTWIRE_THREADS"
"""Environment variable that says how many threads a time integration may use."""

_threads: ContextVar[int] = ContextVar("threads", default=1)

_INSTRUCTION_SETS = {
    "v4": "AVX-512",
    "v3": "AVX2",
    "v2": "SSE4.2",
    "generic": "2 lanes",
    "plain": "no vector types",
}


class NativeCoreMissingError(InputError):
    """Compiled kernels were asked for by name that are not here or cannot compute the line."""


@cache
def _load() -> tuple[ModuleType | None, str]:
    """Return the compiled core, or None and the reason why it cannot be loaded."""
    try:
        from tautwire._native import _core
    except (ImportError, RuntimeError) as error:
        return None, str(error)
    return _core, ""


def _native(choice: Choice) -> ModuleType | None:
    """Return the core that ``choice`` calls for, set to the instruction set that is wanted.

    None stands for the NumPy reference.
    """
    if choice == "reference":
        return None
    core, reason = _load()
    wanted = os.environ.get(SIMD_VARIABLE, "")
    if core is None and (choice == "native" or wanted):
        asked = f"{SIMD_VARIABLE}: got {wanted!r}, but" if wanted else "settings.backend:"
        raise NativeCoreMissingError(
            f"{asked} the compiled core is not available ({reason}); install tautwire with a C++20 "
            "compiler at hand or from a binary wheel, or choose the backend 'reference'"
        )
    if core is None:
        return None
    if wanted and wanted not in core.runnable:
        raise NativeCoreMissingError(
            f"{SIMD_VARIABLE}: got {wanted!r}; this installation has the kernels "
            f"{', '.join(core.built)}, of which this processor runs {', '.join(core.runnable)}; "
            "name one of these, or leave the variable out to use the fastest"
        )
    core.use(wanted or core.runnable[0])
    return core


@contextmanager
def sharing(threads: int) -> Iterator[None]:
    """Let the time integrations that are set up inside use several threads each.

    Outside, as in the workers of studies, each uses one; the environment variable
    TAUTWIRE_THREADS comes before both. Results do not depend on it.

    Parameters
    ----------
    threads
        At most; a time integration has work for two.
    """
    token = _threads.set(threads)
    try:
        yield
    finally:
        _threads.reset(token)


def thread_count() -> int:
    """Return how many threads a time integration that is set up now may use.

    Raises
    ------
    InputError
        TAUTWIRE_THREADS is no count.
    """
    wanted = os.environ.get(THREADS_VARIABLE, "")
    if not wanted:
        return _threads.get()
    if not (wanted.isascii() and wanted.isdigit() and int(wanted) > 0):
        raise InputError(
            f"{THREADS_VARIABLE}: got {wanted!r}; give a number of threads, 1 or more, or leave "
            "the variable out"
        )
    return int(wanted)


def backend_name(choice: Choice = "auto") -> str:
    """Describe the kernels that a choice leads to, for example ``native (AVX-512)``.

    Parameters
    ----------
    choice
        'native', 'reference', or 'auto' for the fastest available.

    Raises
    ------
    NativeCoreMissingError
        Kernels were asked for by name that are not there.
    """
    core = _native(choice)
    if core is None:
        return "reference (NumPy)"
    return f"native ({_INSTRUCTION_SETS[core.instruction_set()]})"


def make_stepper(
    system: System,
    pantographs: Sequence[PantographInput],
    options: StepOptions,
    observed: Index,
    backend: Choice = "auto",
) -> Stepper:
    """Set up a time integration with the chosen kernels.

    With 'auto', wires that branch or form rings, which the core cannot lay end to end, are
    integrated by the reference; ``counters.notes`` says so.

    Parameters
    ----------
    system
        The line in its static state.
    pantographs
        Their chains and ways along the line.
    options
        Integrator, step, tolerance.
    observed
        Degrees of freedom whose coordinates are recorded at every step.
    backend
        'native', 'reference', or 'auto' for the fastest available.

    Raises
    ------
    NativeCoreMissingError
        'native' was asked for and is not there or cannot compute the line, or TAUTWIRE_SIMD names
        kernels that are not there.
    InputError
        TAUTWIRE_THREADS is no count.
    """
    if isinstance(options.integrator, Extrapolated):
        base, usual = options.integrator.base, options.time_step

        def part(count: int) -> Stepper:
            own = replace(options, integrator=base, time_step=usual / count)
            return make_stepper(system, pantographs, own, observed, backend)

        return ExtrapolatedStepper(part)
    core = _native(backend)
    if core is None:
        return ReferenceStepper(system, pantographs, options, observed)
    try:
        threads = min(thread_count(), core.most_threads)
        return NativeStepper(core, system, pantographs, options, observed, threads)
    except NotAChainError as error:
        if backend == "native":
            raise NativeCoreMissingError(
                f"settings.backend: 'native' cannot compute this line, because {error}; choose "
                "'auto' or 'reference'"
            ) from error
        stepper = ReferenceStepper(system, pantographs, options, observed)
        stepper.counters.notes["general_solver"] = str(error)
        return stepper


def backend_of(stepper: Stepper) -> str:
    """Describe the kernels that a time integration uses, as :func:`backend_name` does."""
    own = stepper.parts[0] if isinstance(stepper, ExtrapolatedStepper) else stepper
    return backend_name("native" if isinstance(own, NativeStepper) else "reference")


def cable_force(e: Array, section: ancf.CableSection, backend: Choice = "auto") -> Array:
    """Return the elastic nodal forces of wire elements; see :func:`ancf.force`.

    Parameters
    ----------
    e : (4, 3, n)
        r1 [m], r1', r2 [m], r2' of each element.
    section
        Lengths and stiffnesses.
    backend
        Which kernels to use.
    """
    core = _native(backend)
    if core is None or np.iscomplexobj(e):
        return ancf.force(e, section)
    out = np.empty((4, 3, e.shape[-1]))
    core.cable_force(np.ascontiguousarray(e), *_contiguous(section), out)
    return out


def cable_tangent(e: Array, section: ancf.CableSection, backend: Choice = "auto") -> Array:
    """Return the tangent stiffness of wire elements; see :func:`ancf.tangent`.

    Parameters
    ----------
    e : (4, 3, n)
        r1 [m], r1', r2 [m], r2' of each element.
    section
        Lengths and stiffnesses.
    backend
        Which kernels to use.
    """
    core = _native(backend)
    if core is None or np.iscomplexobj(e):
        return ancf.tangent(e, section)
    out = np.empty((4, 3, 4, 3, e.shape[-1]))
    core.cable_tangent(np.ascontiguousarray(e), *_contiguous(section), out)
    return out


def _contiguous(section: ancf.CableSection) -> list[Array]:
    return [np.ascontiguousarray(part, dtype=float) for part in section]
