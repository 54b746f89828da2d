"""Lengths of a line that decide mesh, spectra and advice; each is computed here alone."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tautwire.line.pieces import Line

Array = NDArray[np.float64]

SAME_PLACE = 1e-9
"""Distance below which two points of a wire are one [m]."""

PAIR = 0.25
"""Share of the longest distance of droppers in a span below which two hang as a pair: pairs hang
0.3 to 1 m apart and 5 to 15 m from the next, single droppers differ by a factor of two at most."""

_DIGITS = 9
"""Decimals [m] to which differences of chainages are the distances that were given."""


@dataclass(frozen=True)
class Intervals:
    """Distances between neighbours on the contact wires within some spans.

    Attributes
    ----------
    spans : tuple of float m
    between : tuple of float m
        From dropper to dropper of the same span (DD).
    beside : tuple of float m
        From a support to the dropper next to it (SD).
    """

    spans: tuple[float, ...]
    between: tuple[float, ...]
    beside: tuple[float, ...]


def span_lengths(line: Line) -> tuple[float, ...]:
    """Return the distance from each mast to the next [m]."""
    return tuple(round(right - left, _DIGITS) for left, right in pairwise(line.masts))


def droppers_of_spans(line: Line, role: str = "contact") -> tuple[tuple[float, ...], ...]:
    """Return where droppers carry wires of a role, from the mast on the left, span by span [m].

    Droppers at the same place of several wires count once. What raises a wire at a support of an
    overlap is none of them: no pantograph comes there.
    """
    names = {run.name for run in line.runs if run.role == role}
    found: list[list[float]] = [[] for _ in line.masts[1:]]
    for hanger in line.hangers:
        if hanger.lower.run in names and not hanger.raises:
            found[hanger.label.span - 1].append(hanger.lower.s)
    return tuple(
        tuple(round(s - left, _DIGITS) for s in _distinct(places))
        for left, places in zip(line.masts, found, strict=False)
    )


def _distinct(places: list[float]) -> list[float]:
    kept: list[float] = []
    for s in sorted(places):
        if not kept or s > kept[-1] + SAME_PLACE:
            kept.append(s)
    return kept


def intervals(
    line: Line, first: int = 1, last: int | None = None, *, pairs_as_one: bool = False
) -> Intervals:
    """Return the distances between neighbours on the contact wires.

    Parameters
    ----------
    line
    first, last
        Spans, from 1, both included; the whole line by default.
    pairs_as_one
        Whether droppers close to each other count as one in their middle: a train feels the
        distance of the pairs.
    """
    chosen = slice(first - 1, last)
    between: list[float] = []
    beside: list[float] = []
    spans = span_lengths(line)[chosen]
    for length, own in zip(spans, droppers_of_spans(line)[chosen], strict=True):
        droppers = _pairs(own) if pairs_as_one else own
        between += [round(right - left, _DIGITS) for left, right in pairwise(droppers)]
        beside += [droppers[0], round(length - droppers[-1], _DIGITS)] if droppers else []
    return Intervals(spans, tuple(between), tuple(beside))


def _pairs(droppers: tuple[float, ...]) -> tuple[float, ...]:
    """Return the middles of groups of droppers that are close to each other."""
    gaps = [right - left for left, right in pairwise(droppers)]
    groups = [[droppers[0]]] if droppers else []
    for s, gap in zip(droppers[1:], gaps, strict=True):
        if gap < PAIR * max(gaps):
            groups[-1].append(s)
        else:
            groups.append([s])
    return tuple(sum(group) / len(group) for group in groups)


@dataclass(frozen=True)
class Recurring:
    """Lengths along the track that repeat within some spans.

    Attributes
    ----------
    span : float m
        Commonest span.
    between : float or None m
        Commonest distance of neighbouring droppers or pairs (DD); None without two in a span.
    beside : float or None m
        Commonest distance from a support to the dropper or pair next to it (SD); None without.
    shortest : float m
        Shortest of all DD and SD; the span where there are no droppers.
    """

    span: float
    between: float | None
    beside: float | None
    shortest: float


def recurring(line: Line, first: int, last: int) -> Recurring:
    """Return the lengths that repeat within some spans, droppers in pairs taken as one.

    Parameters
    ----------
    line
    first, last
        Spans, from 1, both included.
    """
    found = intervals(line, first, last, pairs_as_one=True)
    span = _commonest(found.spans)
    return Recurring(
        span,
        _commonest(found.between) if found.between else None,
        _commonest(found.beside) if found.beside else None,
        min([*found.between, *found.beside], default=span),
    )


def _commonest(values: tuple[float, ...]) -> float:
    """Return the value met most often (to the centimetre), the largest of equals."""
    rounded = np.round(values, 2)
    found, number = np.unique(rounded, return_counts=True)
    best = found[len(number) - 1 - int(number[::-1].argmax())]
    return float(np.asarray(values)[rounded == best][0])


def attachment_intervals(line: Line) -> tuple[float, float]:
    """Return the shortest and the longest distance between attachments of any wire [m]."""
    gaps = [
        round(right - left, _DIGITS)
        for run in line.runs
        for left, right in pairwise(line.points(run.name))
    ]
    return min(gaps), max(gaps)


def longest_hung_interval(line: Line) -> float:
    """Return the longest distance between neighbours in spans with droppers [m].

    The longest of all where nothing hangs.
    """
    found = intervals(line)
    _, longest = attachment_intervals(line)
    return max([*found.between, *found.beside], default=longest)


def contact_mass(line: Line, dropper_lengths: Array, first: int, last: int) -> float:
    """Return the mean mass of a contact wire within some spans as it moves [kg/m].

    It carries its dropper clamps and the lower halves of the droppers.

    Parameters
    ----------
    line
    dropper_lengths : (n_dropper,) m
        Of the hangers in their order.
    first, last
        Spans, from 1, both included.
    """
    run = line.of_role("contact")[0]
    left, right = line.masts[first - 1], line.masts[last]
    hung = [
        hanger.clamps[1] + 0.5 * hanger.mass * float(length)
        for hanger, length in zip(line.hangers, dropper_lengths, strict=True)
        if hanger.lower.run == run.name and left <= hanger.lower.s <= right
    ]
    return run.wire.mass + sum(hung) / (right - left)
