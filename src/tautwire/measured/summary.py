"""Statistics of a measured force per stretch of line, and the events in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

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


@dataclass(frozen=True)
class ForceEvent:
    """A stretch of time in which the force was beyond a level.

    Attributes
    ----------
    kind : str
        ``"loss"`` or ``"high force"``.
    start, end : float s
    position : float m
        Where it begins.
    extreme : float N
    """

    kind: Literal["loss", "high force"]
    start: float
    end: float
    position: float
    extreme: float


def force_events(
    time: Array,
    position: Array,
    force: Array,
    *,
    loss_below: float,
    high_above: float,
    shortest: float = 0.0,
) -> tuple[ForceEvent, ...]:
    """List losses of contact and forces above a limit, in the order of time.

    Parameters
    ----------
    time, position, force : (n,) s, m, N
    loss_below : float N
        A force at or below it counts as loss; sensors rarely return to exactly zero.
    high_above : float N
    shortest : float s
        Events that are shorter are left out.
    """
    found: list[ForceEvent] = []
    kinds: tuple[tuple[Literal["loss", "high force"], NDArray[np.bool_]], ...] = (
        ("loss", force <= loss_below),
        ("high force", force > high_above),
    )
    for kind, beyond in kinds:
        edges = np.flatnonzero(np.diff(np.concatenate([[False], beyond, [False]]).astype(np.int8)))
        for first, after in edges.reshape(-1, 2):
            end = time[min(after, len(time) - 1)]
            if end - time[first] < shortest:
                continue
            values = force[first:after]
            extreme = values.min() if kind == "loss" else values.max()
            found.append(
                ForceEvent(kind, float(time[first]), float(end), float(position[first]),
                           float(extreme))
            )  # fmt: skip
    return tuple(sorted(found, key=lambda event: event.start))
