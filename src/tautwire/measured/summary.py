"""Statistics of a measured force per stretch of line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tautwire.measured.recording import Array


@dataclass(frozen=True)
class StretchStatistics:
    """Figures of one stretch: a span, a tension length, a kilometre.

    Attributes
    ----------
    label : str
    start, end : float m
    mean, standard_deviation, maximum, minimum : float N
        NaN where nothing was measured.
    measured_share : float
        Share of the stretch with a force; figures of a stretch with gaps are those of the rest.
    """

    label: str
    start: float
    end: float
    mean: float
    standard_deviation: float
    maximum: float
    minimum: float
    measured_share: float


def stretch_statistics(
    position: Array, force: Array, edges: Sequence[float], labels: Sequence[str]
) -> tuple[StretchStatistics, ...]:
    """Evaluate a force stretch by stretch.

    Parameters
    ----------
    position : (n,) m
        Evenly spaced, increasing.
    force : (n,) N
        NaN where not measured.
    edges : (n_stretch + 1,) m
        Increasing ends of the stretches; a sample on an edge belongs to the stretch it begins.
    labels : (n_stretch,)
    """
    found = []
    for label, start, end in zip(labels, edges[:-1], edges[1:], strict=True):
        values = force[(position >= start) & (position < end)]
        known = values[~np.isnan(values)]
        share = len(known) / len(values) if len(values) else 0.0
        known = known if len(known) else np.array([np.nan])
        found.append(
            StretchStatistics(
                label=label,
                start=start,
                end=end,
                mean=float(known.mean()),
                standard_deviation=float(known.std()),
                maximum=float(known.max()),
                minimum=float(known.min()),
                measured_share=share,
            )
        )
    return tuple(found)
