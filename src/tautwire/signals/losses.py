"""Intervals of lost contact, located between samples."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def loss_intervals(time: ArrayLike, gap: ArrayLike) -> tuple[Array, Array]:
    """Find when contact is lost from the unfiltered gap between wire and pantograph head.

    Contact is lost while the gap is not negative (a contact that only pushes then carries no
    force). The instants of separation and re-contact are those where the straight line between
    two samples crosses zero, so durations are not whole numbers of steps. A loss that is under
    way at an end of the record starts or ends there. Touching without separating is no loss.

    Parameters
    ----------
    time : (n_time,) s
        Increasing instants; they need not be evenly spaced.
    gap : (n_time,) m
        Height of the wire above the head, negative in contact.

    Returns
    -------
    start, end : (n_event,) s
    """
    instants = np.asarray(time, dtype=np.float64)
    height = np.asarray(gap, dtype=np.float64)
    if instants.shape != height.shape or instants.ndim != 1:
        raise ValueError(f"time {instants.shape} and gap {height.shape} must be two equal columns")
    if instants.size == 0:
        return np.empty(0), np.empty(0)
    lost = height >= 0.0
    left = np.flatnonzero(lost[1:] != lost[:-1])
    step = instants[left + 1] - instants[left]
    crossing = instants[left] - height[left] * step / (height[left + 1] - height[left])
    begins = lost[left + 1]
    start = np.concatenate([instants[:1][lost[:1]], crossing[begins]])
    end = np.concatenate([crossing[~begins], instants[-1:][lost[-1:]]])
    real = end > start
    return start[real], end[real]


def counted_intervals(time: ArrayLike, gap: ArrayLike) -> tuple[Array, Array]:
    """Find losses of contact by counting samples, each as the time step that follows it.

    Parameters
    ----------
    time : (n_time,) s
        Evenly spaced.
    gap : (n_time,) m
        Height of the wire above the head, negative in contact.

    Returns
    -------
    start, end : (n_event,) s
    """
    instants = np.asarray(time, dtype=np.float64)
    lost = np.asarray(gap, dtype=np.float64) >= 0.0
    if instants.size < 2:
        return np.empty(0), np.empty(0)
    edges = np.diff(np.concatenate([[False], lost, [False]]).astype(np.int8))
    first, count = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    start = instants[first]
    return start, start + (count - first) * (instants[1] - instants[0])


def clip_intervals(
    start: ArrayLike, end: ArrayLike, first: float, last: float
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Cut intervals to a window and drop those outside it.

    Parameters
    ----------
    start, end : (n_event,) s
    first, last : float s
        Limits of the window.

    Returns
    -------
    start, end : (n_kept,) s
    is_cut : (n_kept,) bool
        True where the window shortened the interval.
    """
    begin = np.asarray(start, dtype=np.float64)
    finish = np.asarray(end, dtype=np.float64)
    clipped_begin, clipped_finish = np.maximum(begin, first), np.minimum(finish, last)
    kept = clipped_finish > clipped_begin
    is_cut = (begin < first) | (finish > last)
    return clipped_begin[kept], clipped_finish[kept], is_cut[kept]
