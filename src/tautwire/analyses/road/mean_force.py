"""Mean-force tuning: find the uplift force that gives the wanted mean contact force.

Far from the wanted force, passages with longer elements and a longer step are good enough to come
near: on AC simple their means differ by 0.1 to 0.2 % from those of the case's own mesh, and by
nearly the same share at neighbouring forces. What is left is corrected from the case's own
passages, so that the last of them, which is reported, meets the force by itself.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.force.statistics import contact_statistics
from tautwire.analyses.road.accuracy import coarser
from tautwire.analyses.road.dynamics import (
    FEW_FRAMES,
    Choices,
    Progress,
    Simulation,
    carried_out,
)
from tautwire.analyses.road.shape import find_shape
from tautwire.errors import ConvergenceError, InputError, ModelError
from tautwire.model.build import Model, build
from tautwire.numerics.motion.backend import Choice
from tautwire.results.equilibrium import Equilibrium
from tautwire.results.run import Run
from tautwire.specs.scenario import TUNING_TOLERANCE

Array = NDArray[np.float64]

MOST_PASSES = 8
"""Passages after which tuning gives up: AC simple takes 2."""

_FIRST_SLOPE = 0.93
"""Change of the mean force with the uplift force that the first correction expects: below 1 by what
the base spring takes back. On five spans of AC simple it takes 2 passages, 0.5, 0.8 and 1.0 take
3."""
_SLOPE_RANGE = (0.3, 1.5)
"""Slopes that are believed: a secant over small changes is mostly noise. Chosen; (0.6, 1.2) changes
nothing on AC simple."""
_CLOSE = 0.01
"""Miss of the mean force of coarse passages, as a share of it, after which one more step of the
secant ends their search, and within which they confirm a guess: about as much as they differ from
the case's own mesh where that is coarse itself."""
_CORRECTED = 0.02
"""Miss of a passage, as a share, that is corrected without another coarse one: with slopes that
coarse passages have given, known to 2 %, it leaves 0.07 N of 170 N."""
_PLAUSIBLE = 0.2
"""How far, as a share, a first guess may be from what the first slope expects to be tried on the
case's own mesh at once."""
_MOST_COARSE = 6
"""Coarse passages from which one force is found: secants from a third of the force take 3."""


class _Coarse:
    """Coarse passages of a case, and what they say about its mean force.

    Parameters
    ----------
    passage
        Mean forces of the coarse passage under uplift forces; None when it fails.
    slope : (n_pantograph,)
        Change of mean force with uplift force to begin with.

    Attributes
    ----------
    slope : (n_pantograph,)
        As known by now.
    has_slope : bool
        Whether it comes from passages.
    """

    def __init__(self, passage: Callable[[Array], Array | None], slope: Array) -> None:
        self._passage, self.slope, self.has_slope = passage, slope, False
        self._ratio = np.ones(len(slope))
        """Mean forces on the case's own mesh over those of the coarse passage."""

    def observe(self, forces: Array, means: Array) -> None:
        """Take the mean forces of a passage on the case's own mesh."""
        coarse = self._passage(forces)
        if coarse is not None and (coarse > 0.0).all():
            self._ratio = means / coarse

    def confirms(self, forces: Array, target: float) -> bool:
        """Tell whether the coarse passage has the wanted mean, as well as such a mesh can tell."""
        coarse = self._passage(forces)
        return coarse is not None and bool(np.abs(coarse - target).max() <= _CLOSE * target)

    def solve(self, forces: Array, target: float) -> Array:
        """Return forces whose coarse passage, corrected by the ratio, has the wanted mean.

        Where a coarse passage fails, those reached by then: the passage that follows judges them.
        """
        before: tuple[Array, Array] | None = None
        for _ in range(_MOST_COARSE):
            coarse = self._passage(forces)
            if coarse is None:
                break
            means = self._ratio * coarse
            if before is not None:
                self.slope = _secant_slope(forces - before[0], means - before[1], self.slope)
                self.has_slope = True
            before, missing = (forces, means), target - means
            forces = forces + missing / self.slope
            if np.abs(missing).max() <= _CLOSE * target:
                break
        return forces


def _coarse_passage(
    model: Model,
    backend: Choice | None,
    watch: Callable[[int | str, Progress], bool] | None,
) -> Callable[[Array], Array | None]:
    """Return the function that gives the mean forces of coarse passages under uplift forces."""
    line: list[tuple[Model, Equilibrium]] = []  # built when the first is asked for
    known: dict[tuple[float, ...], Array] = {}
    name = "coarse passage of the mean-force tuning"
    told = None if watch is None else lambda progress: watch(name, progress)

    def means(forces: Array) -> Array | None:
        given = tuple(forces.tolist())
        if given in known:
            return known[given]
        try:
            if not line:
                coarse = build(coarser(model.case))
                line.append((coarse, find_shape(coarse)))
            choices = Choices(uplift_forces=given, backend=backend, frame_interval=FEW_FRAMES)
            run = carried_out(Simulation(*line[0], choices), told)
        except (ConvergenceError, InputError, ModelError):
            return None
        if run.status != "done":
            raise KeyboardInterrupt
        known[given] = mean_forces(run)
        return known[given]

    return means


def tune_mean_force(
    model: Model,
    shape: Equilibrium,
    *,
    backend: Choice | None = None,
    watch: Callable[[int | str, Progress], bool] | None = None,
    frame_interval: float | None = None,
) -> Run:
    """Repeat the passage until the mean force in the analysed section is the wanted one.

    The base spring takes part of the uplift force and droppers make the line nonlinear, so the
    uplift force is found by a secant iteration, for each pantograph on its own; far from the wanted
    force on a coarse mesh. From first guesses within a factor of three it takes two passages of
    the case's own mesh, one where the guess is right.

    Parameters
    ----------
    model
        The line; its scenario must name a mean force.
    shape
        Its static state.
    backend
        ``"auto"``, ``"native"`` or ``"reference"``.
    watch
        Called with the number of the passage (from 1), or the name of a coarse one, and its
        progress; True stops the run.
    frame_interval : float s, optional
        Time between pictures.

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
    coarse = _Coarse(_coarse_passage(model, backend, watch), np.full(len(forces), _FIRST_SLOPE))
    is_expected = np.abs(_FIRST_SLOPE * forces - target).max() <= _PLAUSIBLE * target
    if not is_expected and not coarse.confirms(forces, target):
        forces = coarse.solve(forces, target)
    previous: tuple[Array, Array] | None = None
    finished: Run | None = None
    means: Array | None = None
    for number in range(1, MOST_PASSES + 1):
        try:
            choices = Choices(
                uplift_forces=tuple(forces.tolist()),
                backend=backend,
                frame_interval=frame_interval,
            )
            run = carried_out(Simulation(model, shape, choices), _numbered(watch, number))
            run = replace(run, counters={**run.counters, "tuning_passes": number})
            if run.status != "done":
                return run if finished is None else _unfinished(finished, means, target)
            finished, means = run, None
            means = mean_forces(run)
            if np.abs(means - target).max() <= TUNING_TOLERANCE:
                return run
            forces, previous = _next(coarse, previous, (forces, means), target), (forces, means)
        except KeyboardInterrupt:
            if finished is None:
                raise
            return _unfinished(finished, means, target)
        except ConvergenceError as error:
            if finished is None:
                raise
            kept = _unfinished(finished, means, target)
            raise ConvergenceError(f"{error} {kept.message}", partial=kept) from error
    assert finished is not None
    assert means is not None
    raise ConvergenceError(_missed(means, target), partial=finished)


def _next(
    coarse: _Coarse,
    previous: tuple[Array, Array] | None,
    found: tuple[Array, Array],
    target: float,
) -> Array:
    """Return the forces of the next passage from forces and means of the last two."""
    forces, means = found
    if previous is not None:
        coarse.slope = _secant_slope(forces - previous[0], means - previous[1], coarse.slope)
    nearer = forces + (target - means) / coarse.slope
    if coarse.has_slope and np.abs(target - means).max() <= _CORRECTED * target:
        return nearer
    coarse.observe(forces, means)
    return coarse.solve(nearer, target)


def _numbered(
    watch: Callable[[int | str, Progress], bool] | None, number: int
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
