"""Damped Newton iteration."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.status import Status

Array = NDArray[Any]


@dataclass(frozen=True)
class NewtonSettings:
    """When to stop.

    Parameters
    ----------
    increment
        Largest scaled increment accepted as converged.
    residual
        Largest residual accepted as converged; both conditions must hold.
    iterations
        Most iterations allowed.
    """

    increment: float
    residual: float
    iterations: int = 40  # lines of the library take 4 or 5; halved steps need more


@dataclass(frozen=True, eq=False)
class NewtonResult:
    """Outcome of :func:`damped_newton`.

    Attributes
    ----------
    status : Status
    x : (n,)
        Last iterate.
    iterations : int
        Linear solves made.
    residual : float
        Largest residual at ``x``.
    increments : tuple of float
        Largest scaled increment of every iteration.
    """

    status: Status
    x: Array
    iterations: int
    residual: float
    increments: tuple[float, ...]


def damped_newton(
    x: Array,
    residual: Callable[[Array], Array],
    direction: Callable[[Array, Array], Array | None],
    limits: Array,
    settings: NewtonSettings,
) -> NewtonResult:
    """Solve ``residual(x) = 0``; a step never moves a component further than its limit.

    Parameters
    ----------
    x : (n,)
        First guess.
    residual
        Returns the residual at ``x``.
    direction
        Returns the Newton increment for ``x`` and its residual; None when the tangent is singular.
    limits : (n,)
        Largest step of each component. An increment is measured in units of these limits.
    settings
        Stopping rule.
    """
    r = residual(x)
    increments: list[float] = []
    for count in range(settings.iterations):
        dx = direction(x, r)
        if dx is None:
            return NewtonResult(Status.SINGULAR, x, count, _norm(r), tuple(increments))
        size = _norm(dx / limits)
        if not np.isfinite(size):
            return NewtonResult(Status.NOT_FINITE, x, count, _norm(r), tuple(increments))
        x = x + dx / max(1.0, size)
        r = residual(x)
        increments.append(size)
        if size <= settings.increment and _norm(r) <= settings.residual:
            return NewtonResult(Status.DONE, x, count + 1, _norm(r), tuple(increments))
    return NewtonResult(Status.NOT_CONVERGED, x, settings.iterations, _norm(r), tuple(increments))


def _norm(v: Array) -> float:
    return float(np.abs(v).max(initial=0.0))
