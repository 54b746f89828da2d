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

    Droppers at the same place of several wires count once.
    """
    names = {run.name for run in line.runs if run.role == role}
    found: list[list[float]] = [[] for _ in line.masts[1:]]
    for hanger in line.hangers:
        if hanger.lower.run in names:
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


def intervals(line: Line, first: int = 1, last: int | None = None) -> Intervals:
    """Return the distances between neighbours on the contact wires.

    Parameters
    ----------
    line
    first, last
        Spans, from 1, both included; the whole line by default.
    """
    chosen = slice(first - 1, last)
    between: list[float] = []
    beside: list[float] = []
    spans = span_lengths(line)[chosen]
    for length, droppers in zip(spans, droppers_of_spans(line)[chosen], strict=True):
        between += [round(right - left, _DIGITS) for left, right in pairwise(droppers)]
        beside += [droppers[0], round(length - droppers[-1], _DIGITS)] if droppers else []
    return Intervals(spans, tuple(between), tuple(beside))


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
