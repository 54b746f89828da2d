"""Whether a recording goes on from one row to the next where its position does not.

What the head meets changes slowly along the line: force, height and stagger differ little from row
to row, and as much as they ever do between places that lie far apart. Where the position jumps and
they go on, the train has not moved by the jump.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tautwire.measured.recording import Array

WIDTHS = (1, 3, 8)
"""Rows whose mean and rise are compared on either side: more of them against noise, fewer of what
changes fast; of each channel those count that tell places that lie apart best."""
SURE = 2.0
"""Logarithm of the odds from which a recording goes on: seven to one. Chosen: with 1 two of twenty
second passages are taken for jumps, with 2 none, and no more jumps are missed."""
_FARTHEST = 0.25
"""Largest lag that is looked at, as a share of the rows."""


def goes_on(channels: Sequence[Array], row: int, rows: int) -> bool:
    """Tell whether readings go on from a row to the next as if no way lay between.

    Two normal laws of the difference of means are compared, with its variance from row to row and
    over the rows of the jump, and their logarithmic odds summed over the channels.

    Parameters
    ----------
    channels : sequence of (n,)
        Independent of each other: the force, the height and the stagger of the wire.
    row : int
        Before the jump, from 0.
    rows : int
        Rows that would lie in the jump.
    """
    return sum(_odds(values, row, rows) for values in channels) > SURE


def _odds(values: Array, row: int, rows: int) -> float:
    """Return the logarithmic odds of one channel: of its level, and of its slope."""
    total = 0.0
    for sides in (_levels, _slopes):
        best, odds = 1.0, 0.0
        for width in WIDTHS:
            lag = int(np.clip(rows, 2 * width, max(2 * width, _FARTHEST * len(values))))
            before, after = sides(values, width)
            near = _mean_square(after[1:] - before[:-1])
            far = _mean_square(after[1 + lag :] - before[: -1 - lag])
            here = float(after[row + 1] - before[row])
            if np.isfinite(here) and near > 0.0 and far / near > best:
                best = far / near
                odds = 0.5 * float(np.log(best) - here**2 * (1.0 / near - 1.0 / far))
        total += odds
    return total


def _levels(values: Array, width: int) -> tuple[Array, Array]:
    """Return the means of some rows that end, and of some that begin, at every row."""
    means = _windows(values, width).mean(axis=1)
    return means[: len(values)], means[width - 1 :]


def _slopes(values: Array, width: int) -> tuple[Array, Array]:
    """Return by how much they rise, per row."""
    windows = _windows(values, width + 1)
    rises = (windows[:, -1] - windows[:, 0]) / width
    return rises[: len(values)], rises[width:]


def _windows(values: Array, width: int) -> Array:
    none = np.full(width - 1, np.nan)
    filled = np.concatenate([none, values, none])
    return np.lib.stride_tricks.sliding_window_view(filled, width)


def _mean_square(differences: Array) -> float:
    known = differences[np.isfinite(differences)]
    return float(np.mean(known**2)) if len(known) else 0.0
