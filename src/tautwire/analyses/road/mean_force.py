"""Mean-force tuning: find the uplift force that gives the wanted mean contact force."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.force.statistics import contact_statistics
from tautwire.analyses.road.dynamics import Progress, simulate
from tautwire.errors import ConvergenceError, ModelError
from tautwire.model.build import Model
from tautwire.numerics.motion.backend import Choice
from tautwire.results.equilibrium import Equilibrium
from tautwire.results.run import Run
from tautwire.specs.scenario import TUNING_TOLERANCE

Array = NDArray[np.float64]

MOST_PASSES = 8
"""Passages after which tuning gives up: AC simple takes 2 or 3."""

_FIRST_SLOPE = 0.93
"""Change of the mean force with the uplift force that the first correction expects: below 1 by what
the base spring takes back. On five spans of AC simple it takes 2 passages, 0.5, 0.8 and 1.0 take
3."""
_SLOPE_RANGE = (0.3, 1.5)
"""Slopes that are believed: a secant over small changes is mostly noise. Chosen; (0.6, 1.2) changes
nothing on AC simple."""


def tune_mean_force(
    model: Model,
    shape: Equilibrium,
    *,
    backend: Choice | None = None,
    watch: Callable[[int, Progress], bool] | None = None,
) -> Run:
    """Repeat the passage until the mean force in the analysed section is the wanted one.

    The base spring takes part of the uplift force and droppers make the line nonlinear, so the
    uplift force is found by a secant iteration, for each pantograph on its own.

    Parameters
    ----------
    model
        The line; its scenario must name a mean force.
    shape
        Its static state.
    backend
        ``"auto"``, ``"native"`` or ``"reference"``.
    watch
        Called with the number of the passage (from 1) and its progress; True stops the run.

    Returns
    -------
    Run
        The last passage, with ``tuning_passes`` among its counters. When the tuning is stopped
        the last passage that reached its end, or the stopped one where there was none before it,
        with status ``"partial"``.

    Raises
    ------
    ConvergenceError
        When the mean force is not met within :data:`MOST_PASSES` passages, or a passage fails;
        ``error.partial`` is the last passage that reached its end, if there is one.
    """
    target = model.case.scenario.target_mean_force()
    if target is None:
        raise ModelError("mean-force tuning needs scenario.mean_force")
    forces = np.array(model.case.uplift_forces())
    slope = np.full(len(forces), _FIRST_SLOPE)
    previous: tuple[Array, Array] | None = None
    finished: Run | None = None
    means: Array | None = None
    for number in range(1, MOST_PASSES + 1):
        try:
            run = simulate(
                model,
                shape,
                uplift_forces=forces.tolist(),
                backend=backend,
                watch=_numbered(watch, number),
            )
            run = replace(run, counters={**run.counters, "tuning_passes": number})
            if run.status != "done":
                return run if finished is None else _unfinished(finished, means, target)
            finished, means = run, None
            means = mean_forces(run)
        except KeyboardInterrupt:
            if finished is None:
                raise
            return _unfinished(finished, means, target)
        except ConvergenceError as error:
            if finished is None:
                raise
            kept = _unfinished(finished, means, target)
            raise ConvergenceError(f"{error} {kept.message}", partial=kept) from error
        if np.abs(means - target).max() <= TUNING_TOLERANCE:
            return run
        if previous is not None:
            slope = _secant_slope(forces - previous[0], means - previous[1], slope)
        previous = (forces, means)
        forces = forces + (target - means) / slope
    assert finished is not None
    assert means is not None
    raise ConvergenceError(_missed(means, target), partial=finished)


def _numbered(
    watch: Callable[[int, Progress], bool] | None, number: int
) -> Callable[[Progress], bool] | None:
    return None if watch is None else lambda progress: watch(number, progress)


def _unfinished(finished: Run, means: Array | None, target: float) -> Run:
    """Return the last passage that reached its end, of a tuning that was stopped after it.

    Its histories are whole; what a stopped passage has beyond them is a part of the line under a
    force that is closer to the wanted one.
    """
    number = finished.counters["tuning_passes"]
    reached = "" if means is None else f", with a mean force of {_reached(means)}"
    message = (
        f"The mean-force tuning was interrupted after passage {number}, which is kept as a whole"
        f"{reached} instead of {target:.1f} N. Start it again to tune the force."
    )
    return replace(finished, status="partial", message=message)


def _reached(means: Array) -> str:
    return ", ".join(f"{m:.1f} N" for m in means)


def _missed(means: Array, target: float) -> str:
    return (
        f"mean-force tuning: after {MOST_PASSES} passages the mean forces are {_reached(means)} "
        f"instead of {target:.1f} N. Check scenario.mean_force, or prescribe scenario.uplift_force."
    )


def mean_forces(run: Run) -> Array:
    """Return the mean contact force of each pantograph in the analysed section [N].

    Sharp low-pass at 20 Hz, which hardly moves the mean.
    """
    statistics = contact_statistics(run)
    return np.array([p.filtered["sharp"].mean for p in statistics.pantographs])


def _secant_slope(force_change: Array, mean_change: Array, slope: Array) -> Array:
    """Update the slopes d(mean)/d(uplift) where the force has moved enough to tell."""
    moved = np.abs(force_change) > 0.01 * TUNING_TOLERANCE  # less moves the mean by rounding alone
    secant = np.divide(mean_change, force_change, out=slope.copy(), where=moved)
    return np.clip(secant, *_SLOPE_RANGE)
