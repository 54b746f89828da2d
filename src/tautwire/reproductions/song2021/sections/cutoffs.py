"""Section IV.C, Fig. 15: the cut-off that covers a quarter of the dropper intervals."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.force.cutoff import advise_cutoff
from tautwire.reproductions.song2021 import published
from tautwire.reproductions.song2021.claims import (
    ALWAYS,
    Claim,
    Condition,
    Evidence,
    least,
    most,
    under,
)
from tautwire.reproductions.song2021.passages import (
    OTHER_MEAN,
    SPEEDS,
    TOP_SPEED,
    UNCALIBRATED,
    Scope,
    standard,
)
from tautwire.reproductions.song2021.sections.forces import Passages

Array = NDArray[np.float64]

CLOSE = 10.0
"""Largest share of σ(0-200) that a close cut-off may miss [%]."""

MUCH_LOWER = 10.0
"""Least share of the standard deviation at the suggested cut-off that 20 Hz miss [%]."""


@dataclass(frozen=True, eq=False)
class Curves:
    """Standard deviations over the speed.

    Attributes
    ----------
    cutoff : (n_speed,) Hz
        Suggested cut-off.
    low, suggested, high : (n_speed,) N
        Standard deviation to 20 Hz, to the suggested cut-off and to 200 Hz.
    """

    cutoff: Array
    low: Array
    suggested: Array
    high: Array


def gather(passages: Passages, scope: Scope) -> dict[Condition, Curves]:
    """Return Fig. 15 under every reading that was computed.

    Parameters
    ----------
    passages
    scope
    """
    found: dict[Condition, Curves] = {}
    for reading in scope.readings:
        names = [standard(scope.mesh, reading, v) for v in SPEEDS]
        if passages.has(*names):
            found[under(reading)] = _curves(passages, names)
    names = [standard(scope.mesh, UNCALIBRATED, v, None if v == TOP_SPEED else OTHER_MEAN)
             for v in SPEEDS]  # fmt: skip
    if passages.has(*names):
        text = f"{UNCALIBRATED}, mean force {OTHER_MEAN:g} N at all speeds"
        found[Condition(text, departs=True)] = _curves(passages, names)
    return found


def _curves(passages: Passages, names: list[str]) -> Curves:
    cutoff = np.array([advise_cutoff(passages.run(name).case).frequency for name in names])
    suggested = [passages.deviation(n, f) for n, f in zip(names, cutoff.tolist(), strict=True)]
    return Curves(
        cutoff,
        passages.deviations(names, 20.0),
        np.array(suggested),
        passages.deviations(names, 200.0),
    )


def claims(curves: Mapping[Condition, Curves]) -> list[Claim]:
    """Judge section IV.C.

    Parameters
    ----------
    curves
        By reading.
    """
    return [_frequencies(curves), _close(curves), _much_lower(curves)]


def _frequencies(curves: Mapping[Condition, Curves]) -> Claim:
    found: list[Evidence] = []
    for own in list(curves.values())[:1]:
        for speed, value in zip(SPEEDS, own.cutoff.tolist(), strict=True):
            wanted = published.CUTOFFS[speed]
            text = f"suggested cut-off at {speed} km/h"
            found.append(Evidence(ALWAYS, text, value, "Hz", wanted - 0.01, wanted + 0.01, wanted))
    text = "A quarter of SD needs 0.9 1/m: 50, 56.25, 62.5, 68.75 and 80 Hz at the five speeds."
    return Claim("cutoff-frequencies", "IV.C", text, tuple(found))


def _close(curves: Mapping[Condition, Curves]) -> Claim:
    found = _at_speeds(most, curves, "the suggested cut-off", CLOSE, "suggested", "high")
    text = "Standard deviations at the suggested cut-off are very close to those to 200 Hz."
    return Claim("cutoff-close", "IV.C, VI.4", text, found)


def _much_lower(curves: Mapping[Condition, Curves]) -> Claim:
    found = _at_speeds(least, curves, "20 Hz", MUCH_LOWER, "low", "suggested")
    text = "Standard deviations to 20 Hz are much lower than those at the suggested cut-off."
    return Claim("cutoff-20", "IV.C", text, found)


def _at_speeds(
    ask: Callable[[Condition, str, float, float], Evidence],
    curves: Mapping[Condition, Curves],
    cutoff: str,
    limit: float,
    below: str,
    above: str,
) -> tuple[Evidence, ...]:
    """Ask for the share of a standard deviation that a cut-off misses at every speed [%]."""
    return tuple(
        ask(condition, f"σ missed by {cutoff} at {speed} km/h", missed, limit)
        for condition, own in curves.items()
        for speed, missed in zip(
            SPEEDS, (100.0 * (1.0 - getattr(own, below) / getattr(own, above))).tolist(),
            strict=True,
        )
    )  # fmt: skip
