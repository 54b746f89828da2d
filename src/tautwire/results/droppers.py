"""Forces of droppers over time, each kept while a pantograph is near."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]


class Extremes(NamedTuple):
    """Least and largest forces [N], NaN where there is no sample, and slack times [s]."""

    least: Array
    largest: Array
    slack_time: Array


@dataclass(frozen=True, eq=False)
class DropperHistory:
    """Dropper forces over time; on long lines those near the pantographs only.

    Row k of a dropper belongs to the sample ``first + k``. Of the other samples at which a
    pantograph is in the analysed section, or half a span from it, the extremes are kept.

    Attributes
    ----------
    force : (n_kept, n_dropper) N
        Tension positive, zero while slack; NaN where a passage stopped before.
    first : (n_dropper,)
        Sample of the first row; 0 where all samples are kept.
    least, largest : (n_dropper,) N
        Over the samples that are not kept; NaN where there are none.
    slack_time : (n_dropper,) s
        Over the samples that are not kept.
    """

    force: NDArray[np.float32]
    first: NDArray[np.int64]
    least: Array
    largest: Array
    slack_time: Array

    @classmethod
    def of_every_sample(cls, force: Array) -> DropperHistory:
        """Return the history of droppers whose forces ``(n_time, n_dropper)`` are all kept."""
        count = force.shape[1]
        nowhere = np.full(count, np.nan)
        first = np.zeros(count, dtype=np.int64)
        return cls(force.astype(np.float32), first, nowhere, nowhere, np.zeros(count))

    def until(self, samples: int) -> DropperHistory:
        """Return the history of the first samples alone."""
        rows = samples - self.first
        if np.all(rows >= len(self.force)):
            return self
        force = self.force[: max(int(rows.max(initial=0)), 0)].copy()
        for dropper, end in enumerate(rows):
            force[max(int(end), 0) :, dropper] = np.nan
        return replace(self, force=force)

    def at(self, samples: Array) -> NDArray[np.float32]:
        """Return the forces at some samples, ``(n, n_dropper)`` [N]; NaN where not kept."""
        found = np.full((len(samples), len(self.first)), np.nan, dtype=np.float32)
        for dropper, first in enumerate(self.first):
            row = samples - first
            kept = (row >= 0) & (row < len(self.force))
            found[kept, dropper] = self.force[row[kept], dropper]
        return found

    def extremes(self, mask: NDArray[np.bool_], durations: Array, chosen: Array) -> Extremes:
        """Return extremes over some samples, and over those that were not kept.

        Parameters
        ----------
        mask : (n_time,) bool
            Samples that count.
        durations : (n_time,) s
            Time that each sample stands for.
        chosen : (n,)
            Numbers of the droppers from 0.
        """
        rows = []
        for dropper in chosen:
            begin = int(self.first[dropper])
            stop = min(begin + len(self.force), mask.size)
            counts = mask[begin:stop]
            force = self.force[: stop - begin, dropper][counts].astype(np.float64)
            slack = float(durations[begin:stop][counts] @ (force <= 0.0))
            ends = (force.min(), force.max()) if force.size else (np.nan, np.nan)
            rows.append((*ends, slack))
        least, largest, slack_time = np.array(rows, dtype=float).reshape(-1, 3).T
        return Extremes(
            np.fmin(least, self.least[chosen]),
            np.fmax(largest, self.largest[chosen]),
            slack_time + self.slack_time[chosen],
        )
