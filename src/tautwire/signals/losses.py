"""Intervals of lost contact, located between samples."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def contact_changes(time: ArrayLike, gap: ArrayLike) -> tuple[Array, NDArray[np.bool_]]:
    """Locate separations and re-contacts by straight lines between samples.

    A record begins with the first sample that is a number, and the contact is before it as it is
    there: what a pantograph finds when it enters the line is no change of contact.

    Parameters
    ----------
    time : (n_time,) s
        Increasing instants; they need not be evenly spaced.
    gap : (n_time,) m
        Height of the wire above the head, negative in contact; NaN before the pantograph has
        entered.

    Returns
    -------
    instant : (n_change,) s
        In order.
    opens : (n_change,) bool
        True for a separation, False for a re-contact; in turn.
    """
    instants, height = _record(time, gap)
    lost = height >= 0.0
    left = np.flatnonzero(lost[1:] != lost[:-1])
    step = instants[left + 1] - instants[left]
    crossing = instants[left] - height[left] * step / (height[left + 1] - height[left])
    # Rounding may carry a crossing a bit past the sample at which the gap is zero.
    return np.clip(crossing, instants[left], instants[left + 1]), lost[left + 1]


def intervals_between(
    instant: Array, opens: NDArray[np.bool_], record: tuple[float, float], *, begins_lost: bool
) -> tuple[Array, Array]:
    """Turn changes of contact into intervals of lost contact.

    Parameters
    ----------
    instant : (n_change,) s
        In order.
    opens : (n_change,) bool
        True for a separation. A change that changes nothing is passed over.
    record : (first, last) s
        Limits of the record: a loss under way there begins or ends there.
    begins_lost : bool
        Whether the first sample is without contact. Where there are changes the first of them
        decides, because it may lie before the first sample.

    Returns
    -------
    start, end : (n_event,) s
        As many starts as ends; intervals without duration are left out.
    """
    before = not opens[0] if len(opens) else begins_lost
    is_change = np.diff(opens, prepend=before)
    instant, opens = instant[is_change], opens[is_change]
    after = bool(opens[-1]) if len(opens) else before
    start, end = instant[opens], instant[~opens]
    if before:
        start = np.concatenate([[record[0]], start])
    if after:
        end = np.concatenate([end, [record[1]]])
    real = end > start
    return start[real], end[real]


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
        Height of the wire above the head, negative in contact; NaN before the pantograph has
        entered, where the record has not begun.

    Returns
    -------
    start, end : (n_event,) s
    """
    instants, height = _record(time, gap)
    if instants.size == 0:
        return np.empty(0), np.empty(0)
    limits = (float(instants[0]), float(instants[-1]))
    changes = contact_changes(instants, height)
    return intervals_between(*changes, limits, begins_lost=bool(height[0] >= 0.0))


def _record(time: ArrayLike, gap: ArrayLike) -> tuple[Array, Array]:
    """Return time and gap from the first sample that is a number."""
    instants = np.asarray(time, dtype=np.float64)
    height = np.asarray(gap, dtype=np.float64)
    if instants.shape != height.shape or instants.ndim != 1:
        raise ValueError(f"time {instants.shape} and gap {height.shape} must be two equal columns")
    known = ~np.isnan(height)
    first = int(np.argmax(known)) if known.any() else height.size
    return instants[first:], height[first:]


def counted_intervals(time: ArrayLike, gap: ArrayLike) -> tuple[Array, Array]:
    """Find losses of contact by counting samples, each as the time step that follows it.

    Parameters
    ----------
    time : (n_time,) s
        Evenly spaced.
    gap : (n_time,) m
        Height of the wire above the head, negative in contact; NaN before the pantograph has
        entered.

    Returns
    -------
    start, end : (n_event,) s
    """
    instants, height = _record(time, gap)
    lost = height >= 0.0
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
