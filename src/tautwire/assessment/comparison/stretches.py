"""Both forces stretch by stretch: of every span, and of every tension length."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tautwire.measured.summary import stretch_statistics
from tautwire.plain import Plain
from tautwire.results.run import Run

Array = NDArray[np.float64]
_FIGURES = ("mean", "standard_deviation", "maximum", "minimum")


@dataclass(frozen=True)
class SpanFigures(Plain):
    """Mean, deviation and extremes of both forces in one span [N], NaN where nothing is common."""

    span: int
    place: str
    simulated: Mapping[str, float]
    measured: Mapping[str, float]
    measured_share: float


@dataclass(frozen=True)
class LengthFigures(Plain):
    """The same of one tension length, from its first to its last support, both from 1."""

    tension_length: int
    supports: tuple[int, int]
    simulated: Mapping[str, float]
    measured: Mapping[str, float]
    measured_share: float


def span_figures(
    run: Run, position: Array, simulated: Array, measured: Array
) -> tuple[SpanFigures, ...]:
    """Return both forces span by span, over what was measured of each.

    Parameters
    ----------
    run
    position : (n,) m
        Increasing.
    simulated, measured : (n,) N
        NaN where nothing was measured.
    """
    line, supports = run.case.line, run.equilibrium.mast_x
    first = int(np.searchsorted(supports, position[0], side="right"))
    last = int(np.searchsorted(supports, position[-1], side="left"))
    numbers = range(max(first, 1), min(last, len(supports) - 1) + 1)
    ends = [(supports[number - 1], supports[number]) for number in numbers]
    return tuple(
        SpanFigures(number, line.place_of_support(number - 1), *found)
        for number, found in zip(numbers, _both(position, (simulated, measured), ends), strict=True)
        if found[2] > 0.0
    )


def length_figures(
    run: Run, position: Array, simulated: Array, measured: Array
) -> tuple[LengthFigures, ...]:
    """Return both forces by tension length; nothing for a line of one.

    Parameters
    ----------
    run, position, simulated, measured
        As for :func:`span_figures`. Where tension lengths overlap, both have what lies there.
    """
    lengths, supports = run.case.tension_lengths, run.equilibrium.mast_x
    ends = [(supports[a - 1], supports[b - 1]) for a, b in (one.masts for one in lengths)]
    return tuple(
        LengthFigures(number, one.masts, *found)
        for number, (one, found) in enumerate(
            zip(lengths, _both(position, (simulated, measured), ends), strict=True), 1
        )
        if found[2] > 0.0
    )


def _both(
    position: Array, forces: tuple[Array, Array], ends: Sequence[tuple[float, float]]
) -> list[tuple[dict[str, float], dict[str, float], float]]:
    """Return the figures of both forces between some ends, and the share that was measured."""
    gaps, found = np.isnan(forces[1]), []
    for start, end in ends:
        simulated, measured = (
            stretch_statistics(
                position, np.where(gaps, np.nan, force), [float(start), float(end)], [""]
            )[0]
            for force in forces
        )
        told = [{name: getattr(one, name) for name in _FIGURES} for one in (simulated, measured)]
        found.append((told[0], told[1], measured.measured_share))
    return found
