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

_FIRST_SLOPE = 0.93
_SLOPE_RANGE = (0.3, 1.5)


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
        The last passage, with ``tuning_passes`` among its counters.

    Raises
    ------
    ConvergenceError
        When the mean force is not met within :data:`MOST_PASSES` passages.
    """
    target = model.case.scenario.target_mean_force()
    if target is None:
        raise ModelError("mean-force tuning needs scenario.mean_force")
    forces = np.array(model.case.uplift_forces())
    slope = np.full(len(forces), _FIRST_SLOPE)
    previous: tuple[Array, Array] | None = None
    number = 0
    while True:
        number += 1
        run = simulate(
            model,
            shape,
            uplift_forces=forces.tolist(),
            backend=backend,
            watch=None if watch is None else lambda p, n=number: watch(n, p),
        )
        run = replace(run, counters={**run.counters, "tuning_passes": number})
        if run.status != "done":
            return run
        means = mean_forces(run)
        if np.abs(means - target).max() <= TUNING_TOLERANCE:
            return run
        if previous is not None:
            slope = _secant_slope(forces - previous[0], means - previous[1], slope)
        if number == MOST_PASSES:
            raise ConvergenceError(_missed(means, target), partial=run)
        previous = (forces, means)
        forces = forces + (target - means) / slope


def _missed(means: Array, target: float) -> str:
    reached = ", ".join(f"{m:.1f} N" for m in means)
    return (
        f"mean-force tuning: after {MOST_PASSES} passages the mean forces are {reached} instead of "
        f"{target:.1f} N. Check scenario.mean_force, or prescribe scenario.uplift_force."
    )


def mean_forces(run: Run) -> Array:
    """Return the mean contact force of each pantograph in the analysed section [N].

    Sharp low-pass at 20 Hz, which hardly moves the mean.
    """
    statistics = contact_statistics(run)
    return np.array([p.filtered["sharp"].mean for p in statistics.pantographs])


def _secant_slope(force_change: Array, mean_change: Array, slope: Array) -> Array:
    """Update the slopes d(mean)/d(uplift) where the force has moved enough to tell."""
    moved = np.abs(force_change) > 1e-3
    secant = np.divide(mean_change, force_change, out=slope.copy(), where=moved)
    return np.clip(secant, *_SLOPE_RANGE)
