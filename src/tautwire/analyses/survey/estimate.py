"""Most probable values of the unknowns of a line under readings with errors and a prior.

Minimised is ``|(y - h(p))/s|^2 + |(p - m)/S|^2`` with readings ``y`` of accuracy ``s`` and a prior
of mean ``m`` and deviation ``S``, under the condition that no dropper pushes. Every step linearises
``h`` and the dropper forces at the equilibrium and solves the least squares under ``F >= 0``. A
dropper whose force ends at zero and whose prior and own length ask for more is slack from then on:
heights do not depend on its length any more, only on its not being shorter.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.survey.observations import Observations
from tautwire.analyses.survey.surveyed_line import Shape, SurveyedLine
from tautwire.errors import ConvergenceError

Array = NDArray[np.float64]
Index = NDArray[np.int64]

_STEPS = 12
"""Most linearisations: three suffice while no dropper changes between taut and slack."""
_SETTLED = 2e-5
"""Largest change of an unknown that counts as none [m]: a hundredth of what is measured."""
_SHARES = (1.0, 0.5, 0.1)
"""Shares of a step that are tried: a whole one finds an equilibrium unless droppers are hung far
from where the survey says."""


@dataclass(frozen=True, eq=False)
class Prior:
    """What is known before the survey.

    Attributes
    ----------
    mean, deviation : (n_unknown,) m
    """

    mean: Array
    deviation: Array


@dataclass(frozen=True, eq=False)
class Estimate:
    """The most probable line.

    Attributes
    ----------
    shape : Shape
    covariance : (n_unknown, n_unknown) m2
        Of the unknowns that the readings tell; a slack dropper keeps the variance of its prior.
    force_errors : (n_dropper,) N
        Standard errors of the dropper forces.
    bound_errors : (n_dropper,) m
        Standard errors of the distances between the clamps.
    residuals : (n,)
        Readings less their estimates, over their accuracy.
    cost : float
        What was minimised.
    is_reached : bool
        False where no equilibrium was found on the way to something better.
    """

    shape: Shape
    covariance: Array
    force_errors: Array
    bound_errors: Array
    residuals: Array
    cost: float
    is_reached: bool = True

    @property
    def errors(self) -> Array:
        """Standard errors of the unknowns [m]."""
        return np.sqrt(np.diag(self.covariance))


def estimate(
    line: SurveyedLine, observed: Observations, prior: Prior, start: Shape | None = None
) -> Estimate:
    """Find the most probable line.

    Parameters
    ----------
    line, observed, prior
    start
        Where to begin; at the mean of the prior by default.

    Returns
    -------
    Estimate
        The best one on the way. It is not reached where droppers hang so far from where the survey
        has them that no line in between is in equilibrium.

    Raises
    ------
    ConvergenceError
        When there is no equilibrium to begin with.
    """
    shape = start or line.at(prior.mean, line.design.taut)
    best: Estimate | None = None
    for _ in range(_STEPS):
        here, values = _step(line, observed, prior, shape)
        if best is None or here.cost < best.cost:
            best = here
        if np.abs(values - shape.values).max() < _SETTLED:
            break
        further = _towards(line, shape, values)
        if further is None:
            return replace(best, is_reached=False)
        shape = further
    assert best is not None
    return best


def _towards(line: SurveyedLine, shape: Shape, values: Array) -> Shape | None:
    """Return the line at some values, or as far on the way there as it can be followed."""
    for share in _SHARES:
        try:
            return line.at(shape.values + share * (values - shape.values), shape.taut)
        except ConvergenceError:
            continue
    return None


def _step(
    line: SurveyedLine, observed: Observations, prior: Prior, shape: Shape
) -> tuple[Estimate, Array]:
    """Return the estimate as it would be if this shape were the best one, and better values."""
    tangent, taut = line.tangent(shape), shape.taut
    slopes = observed.slopes(tangent) / observed.accuracies[:, None]
    misfit = (observed.values - observed.predicted(shape)) / observed.accuracies
    offset = (prior.mean - shape.values) / prior.deviation
    matrix = np.concatenate([slopes, np.diag(1.0 / prior.deviation)])
    change, active = constrained(
        matrix, np.concatenate([misfit, offset]), tangent.forces[taut], -shape.forces[taut]
    )
    values = shape.values + change
    loose: Index = np.flatnonzero(taut)[active]
    hanging = _hanging(line, observed, prior)
    loose = loose[hanging[loose] > values[loose]]
    values[loose] = hanging[loose]
    covariance: Array = np.asarray(np.linalg.inv(matrix.T @ matrix), dtype=np.float64)
    spread = np.sqrt(np.einsum("in,nm,im->i", tangent.forces, covariance, tangent.forces))
    bounds = np.sqrt(np.einsum("in,nm,im->i", tangent.distances, covariance, tangent.distances))
    cost = float(misfit @ misfit + offset @ offset)
    return Estimate(shape, covariance, spread, bounds, misfit, cost), values


def _hanging(line: SurveyedLine, observed: Observations, prior: Prior) -> Array:
    """Return the most probable lengths of droppers that carry nothing, ``(n_dropper,)`` [m].

    Their prior and what was measured of themselves is all that tells.
    """
    count = line.droppers
    precision, total = observed.measured_lengths(count)
    own = prior.deviation[:count] ** -2
    return (own * prior.mean[:count] + total) / (own + precision)


def constrained(
    matrix: Array, target: Array, rates: Array, least: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """Minimise ``|matrix x - target|`` where ``rates x >= least``.

    By the non-negative least squares of the least-distance problem (C. L. Lawson and R. J. Hanson,
    Solving Least Squares Problems, ch. 23, doi:10.1137/1.9781611971217; from memory).

    Parameters
    ----------
    matrix : (m, n)
        Of full column rank.
    target : (m,)
    rates : (k, n)
    least : (k,)

    Returns
    -------
    x : (n,)
    active : (k,) bool
        Conditions that hold it.

    Raises
    ------
    ConvergenceError
        When the conditions contradict each other.
    """
    from scipy.linalg import solve_triangular
    from scipy.optimize import nnls

    q, r = np.linalg.qr(matrix)
    free = q.T @ target
    rates = solve_triangular(r, rates.T, trans=1, check_finite=False).T
    scale = np.linalg.norm(rates, axis=1)
    scale[scale == 0.0] = 1.0
    rates, gap = rates / scale[:, None], least / scale - rates / scale[:, None] @ free
    active = np.zeros(len(gap), dtype=bool)
    step = np.zeros(len(free))
    if np.any(gap > 0.0):
        system = np.concatenate([rates.T, gap[None]])
        wanted = np.append(np.zeros(len(free)), 1.0)
        multipliers, _ = nnls(system, wanted, maxiter=30 * len(gap))
        left = system @ multipliers - wanted
        if abs(left[-1]) < 1e-12:  # rounding of a unit vector
            raise ConvergenceError("survey: no line without pushing droppers meets the conditions")
        step, active = -left[:-1] / left[-1], multipliers > 0.0
    return solve_triangular(r, free + step, check_finite=False), active
