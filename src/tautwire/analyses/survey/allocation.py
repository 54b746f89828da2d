"""Droppers hung in the wrong place, told apart from scatter by the likelihood of the survey.

Each hypothesis says which lengths a span got instead of its own: two of them exchanged, all in
reverse order, or those of another span. It moves the mean of the prior. To first order, with ``r``
the readings less what the design would give, ``J`` their slopes, ``d`` the moved mean and
``S = J P J' + R``, the logarithm of how likely the survey is grows by
``d'J'S^-1 r - d'J'S^-1 J d / 2``. Those that stand out are estimated in full, slack droppers
included, and reported where they are likelier than plain scatter by more than the number of
hypotheses lets chance do.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.survey.estimate import Estimate, Prior, estimate
from tautwire.analyses.survey.observations import Observations
from tautwire.analyses.survey.surveyed_line import SurveyedLine
from tautwire.errors import ConvergenceError

Array = NDArray[np.float64]

DIFFERENCE = 0.010
"""Least change of a length that is looked for [m]: twice the usual scatter of installation; less
is no error of allocation that anybody would set right."""
_FALSE_PER_DROPPER = 1e-3
"""Reports that chance may make, per dropper."""
_STANDS_OUT = 1.0
"""Least gain by a linear measure that is estimated in full: far below what is reported."""
_MOST_IN_FULL = 5
"""Most hypotheses of a span that are estimated in full: the best by the linear measures. On random
lines the likeliest was among the best three."""
_UNKNOWN = 0.2
"""Deviation of a dropper length of which nothing is known [m]: lengths of a span differ by less."""
_AS_LIKELY = 3.0
"""Loss of gain up to which another hypothesis is told as well: it is twenty times less likely."""
_MOST_ERRORS = 20
"""Most errors of allocation that are sought one after another in a line."""


@dataclass(frozen=True)
class Hypothesis:
    """What may have gone wrong in a span.

    Attributes
    ----------
    kind : str
        ``swapped``, ``reversed`` or ``other span``.
    span : int
        From 1.
    droppers : tuple of int
        Rows of the droppers.
    sources : tuple of int
        Rows of the droppers whose lengths they got.
    text : str
    """

    kind: str
    span: int
    droppers: tuple[int, ...]
    sources: tuple[int, ...]
    text: str


@dataclass(frozen=True, eq=False)
class Allocation:
    """An error of allocation that was found.

    Attributes
    ----------
    hypothesis : Hypothesis
    gain : float
        Logarithm of how much likelier it makes the survey.
    alternatives : tuple of Hypothesis
        Others that the survey hardly tells from it.
    threshold : float
        What chance alone hardly exceeds.
    """

    hypothesis: Hypothesis
    gain: float
    alternatives: tuple[Hypothesis, ...]
    threshold: float


def find_allocation_errors(
    line: SurveyedLine, observed: Observations, prior: Prior, plain: Estimate
) -> tuple[tuple[Allocation, ...], Prior, Estimate]:
    """Find errors of allocation, the likeliest first.

    Parameters
    ----------
    line, observed, prior
    plain
        Estimate without any.

    Returns
    -------
    errors : tuple of Allocation
    prior : Prior
        With the lengths that were hung where they should not be.
    estimate : Estimate
        Under it.
    """
    hypotheses = list(_hypotheses(line, prior.mean))
    found: list[Allocation] = []
    design = prior.mean
    for _ in range(_MOST_ERRORS):
        threshold = _threshold(line, len(hypotheses))
        tried = _tried(line, observed, prior, plain, hypotheses, design)
        if not tried or tried[0].gain < threshold:
            break
        best = tried[0]
        own = set(best.hypothesis.droppers)
        others = tuple(
            one.hypothesis
            for one in tried[1:]
            if one.gain > best.gain - _AS_LIKELY and own & set(one.hypothesis.droppers)
        )
        found.append(Allocation(best.hypothesis, best.gain, others, threshold))
        prior, plain = best.prior, best.estimate
        hypotheses = [one for one in hypotheses if not own & set(one.droppers)]
    return tuple(found), prior, plain


def _threshold(line: SurveyedLine, count: int) -> float:
    """Return the gain that chance exceeds as often as is allowed, over all hypotheses.

    Without the error, the gain of a hypothesis at a distance ``d`` has the mean ``-d^2/2`` and the
    deviation ``d``; it exceeds ``t`` most often at ``d^2 = 2 t``, with the probability
    ``Q(sqrt(2 t))`` of a normal deviate.
    """
    from scipy.stats import norm

    often = _FALSE_PER_DROPPER * line.droppers / max(count, 1)
    return 0.5 * float(norm.isf(min(often, 0.5))) ** 2


def _hypotheses(line: SurveyedLine, mean: Array) -> Iterator[Hypothesis]:
    """Yield everything that would change a length by enough to matter."""
    rows: dict[int, list[int]] = {}
    for row, hanger in enumerate(line.model.line.hangers):
        rows.setdefault(hanger.label.span, []).append(row)
    for span, own in rows.items():
        for a, b in combinations(own, 2):
            if abs(mean[a] - mean[b]) >= DIFFERENCE:
                names = [line.model.line.hangers[row].label.number for row in (a, b)]
                text = f"droppers {names[0]} and {names[1]} of span {span} are exchanged"
                yield Hypothesis("swapped", span, (a, b), (b, a), text)
        yield from _tables(span, own, rows, mean)


def _tables(
    span: int, own: list[int], rows: dict[int, list[int]], mean: Array
) -> Iterator[Hypothesis]:
    """Yield whole tables that a span may have got: its own in reverse, or another span's."""
    told: list[Array] = [mean[own]]
    others = [(f"the droppers of span {span} are numbered from the wrong end", "reversed",
               own[::-1])]  # fmt: skip
    others += [
        (f"span {span} has the droppers of span {other}", "other span", table)
        for other, table in sorted(rows.items(), key=lambda item: abs(item[0] - span))
        if other != span and len(table) == len(own)
    ]
    for text, kind, table in others:
        if all(np.abs(mean[table] - known).max() >= DIFFERENCE for known in told):
            told.append(mean[table])
            yield Hypothesis(kind, span, tuple(own), tuple(table), text)


@dataclass(frozen=True, eq=False)
class _Tried:
    """A hypothesis that was estimated in full."""

    hypothesis: Hypothesis
    gain: float
    prior: Prior
    estimate: Estimate


def _tried(
    line: SurveyedLine,
    observed: Observations,
    prior: Prior,
    plain: Estimate,
    hypotheses: Sequence[Hypothesis],
    design: Array,
) -> list[_Tried]:
    """Return the hypotheses that stand out, estimated in full, the likeliest first."""
    found = []
    moves = [_moved(one, prior.mean, design) for one in hypotheses]
    gains = np.maximum(
        _about_plain(line, observed, prior, plain, moves),
        _about_unknown(line, observed, prior, plain, moves),
    )
    for number in _standing_out(gains, hypotheses):
        other = replace(prior, mean=moves[number])
        values = plain.shape.values + other.mean - prior.mean
        try:
            one = estimate(line, observed, other, line.at(values, plain.shape.taut))
        except ConvergenceError:  # no such line hangs: it is not the one that was surveyed
            continue
        if not one.is_reached:
            continue
        gain = 0.5 * (plain.cost - one.cost)
        found.append(_Tried(hypotheses[number], gain, other, one))
    return sorted(found, key=lambda one: -one.gain)


def _moved(one: Hypothesis, mean: Array, design: Array) -> Array:
    """Return the mean of the prior under a hypothesis."""
    found = mean.copy()
    found[list(one.droppers)] = design[list(one.sources)]
    return found


def _standing_out(gains: Array, hypotheses: Sequence[Hypothesis]) -> list[int]:
    """Return the numbers of the hypotheses that may explain the readings better."""
    chosen: dict[int, list[int]] = {}
    for number in np.argsort(-gains).tolist():
        of_span = chosen.setdefault(hypotheses[number].span, [])
        if gains[number] > _STANDS_OUT and len(of_span) < _MOST_IN_FULL:
            of_span.append(number)
    return [number for of_span in chosen.values() for number in of_span]


def _about_plain(
    line: SurveyedLine,
    observed: Observations,
    prior: Prior,
    plain: Estimate,
    moves: Sequence[Array],
) -> Array:
    """Return gains to first order about the line that scatter alone explains."""
    slopes = observed.slopes(line.tangent(plain.shape))
    scatter = (slopes * prior.deviation**2) @ slopes.T + np.diag(observed.accuracies**2)
    missed = observed.values - observed.predicted(plain.shape)
    missed += slopes @ (plain.shape.values - prior.mean)
    score = slopes.T @ np.linalg.solve(scatter, missed)
    information = slopes.T @ np.linalg.solve(scatter, slopes)
    gains = []
    for mean in moves:
        own = np.flatnonzero(mean != prior.mean)
        moved = mean[own] - prior.mean[own]
        gains.append(moved @ score[own] - 0.5 * moved @ information[np.ix_(own, own)] @ moved)
    return np.array(gains)


def _about_unknown(
    line: SurveyedLine,
    observed: Observations,
    prior: Prior,
    plain: Estimate,
    moves: Sequence[Array],
) -> Array:
    """Return gains to first order about the line that the readings alone ask for.

    Droppers that are slack there and whose length was not measured may have any length above the
    distance between their clamps.
    """
    deviation = prior.deviation.copy()
    deviation[: line.droppers] = _UNKNOWN
    free = estimate(line, observed, replace(prior, deviation=deviation), plain.shape)
    told = free.shape.taut | (free.errors[: line.droppers] < 0.5 * _UNKNOWN)
    spread = free.covariance[: line.droppers, : line.droppers]
    spread = spread + np.diag(prior.deviation[: line.droppers] ** 2)
    weight = np.linalg.inv(spread[np.ix_(told, told)])
    loose = np.flatnonzero(~told)
    errors = np.hypot(free.bound_errors[loose], prior.deviation[loose])

    def cost(mean: Array) -> float:
        apart = (free.shape.values - mean)[: line.droppers][told]
        short = np.maximum(free.shape.distances[loose] - mean[loose], 0.0) / errors
        return float(apart @ weight @ apart + short @ short)

    known = cost(prior.mean)
    return np.array([0.5 * (known - cost(mean)) for mean in moves])
