"""Contact loss from the gap: instants between samples."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from tautwire.signals.losses import (
    clip_intervals,
    contact_changes,
    counted_intervals,
    intervals_between,
    loss_intervals,
)


def test_losses_of_a_sine_last_half_a_period() -> None:
    """A gap A sin(2 pi f t) is open for half of every period; the sampling does not matter."""
    time = np.arange(0.0, 1.0, 1e-3)
    start, end = loss_intervals(time, np.sin(2.0 * np.pi * 7.3 * (time - 0.0101)))
    whole = (start > time[0]) & (end < time[-1])
    assert end[whole] - start[whole] == pytest.approx(0.5 / 7.3, rel=1e-5)
    assert np.diff(start[whole]) == pytest.approx(1.0 / 7.3, rel=1e-5)


def test_duration_of_an_offset_sine() -> None:
    """A gap sin(w t) - a is open for (pi - 2 arcsin a) / w."""
    time = np.arange(0.0, 0.5, 1e-4)
    start, end = loss_intervals(time, np.sin(2.0 * np.pi * 10.0 * time) - 0.8)
    expected = (np.pi - 2.0 * np.arcsin(0.8)) / (2.0 * np.pi * 10.0)
    assert start.size == 5
    assert end - start == pytest.approx(expected, rel=1e-4)


def test_loss_shorter_than_a_step_is_timed() -> None:
    """Straight lines between samples give a loss of 0.6 ms in a record of 1 ms steps."""
    start, end = loss_intervals([0.0, 1.0, 2.0], [-2.0, 1.0, -3.0])
    assert start == pytest.approx([2.0 / 3.0])
    assert end == pytest.approx([1.25])


def test_losses_at_the_ends_of_the_record_count() -> None:
    """A loss under way at the start or at the end begins or ends there."""
    start, end = loss_intervals([0.0, 1.0, 2.0, 3.0], [1.0, -1.0, -1.0, 1.0])
    assert start == pytest.approx([0.0, 2.5])
    assert end == pytest.approx([0.5, 3.0])


@pytest.mark.parametrize("gap", [[-1.0, 0.0, -1.0], [-1.0, -2.0, -1.0], [0.0, -1.0, -1.0], []])
def test_touching_is_no_loss(gap: list[float]) -> None:
    """A gap that only reaches zero in one sample, or never, gives no event."""
    start, end = loss_intervals(np.arange(len(gap)), gap)
    assert start.size == 0
    assert end.size == 0


def test_open_all_the_time_is_one_loss() -> None:
    """A record without any contact is one loss from its first to its last sample."""
    start, end = loss_intervals([0.0, 1.0, 2.0], [1.0, 0.0, 2.0])
    assert start.tolist() == [0.0]
    assert end.tolist() == [2.0]


def test_losses_are_cut_at_the_window() -> None:
    """Losses across a limit count with their part inside; those outside are dropped."""
    start, end, is_cut = clip_intervals([0.0, 2.0, 4.0, 9.0], [1.0, 3.0, 6.0, 9.5], 0.5, 5.0)
    assert start.tolist() == [0.5, 2.0, 4.0]
    assert end.tolist() == [1.0, 3.0, 5.0]
    assert is_cut.tolist() == [True, False, True]


def test_unequal_columns_are_refused() -> None:
    """Time and gap of different lengths are refused."""
    with pytest.raises(ValueError, match="two equal columns"):
        loss_intervals([0.0, 1.0], [1.0])


@settings(max_examples=50, deadline=None)
@given(gap=arrays(np.float64, 60, elements=st.floats(-1.0, 1.0)))
def test_losses_and_contacts_share_the_record(gap: np.ndarray) -> None:
    """Events are ordered, do not overlap, and with the contacts they add up to the record."""
    time = np.linspace(0.0, 1.0, gap.size)
    start, end = loss_intervals(time, gap)
    contact_start, contact_end = loss_intervals(time, np.where(gap >= 0.0, -gap - 5e-324, -gap))
    assert np.all(end > start)
    assert np.all(start[1:] >= end[:-1])
    total = np.sum(end - start) + np.sum(contact_end - contact_start)
    assert total == pytest.approx(1.0, abs=1e-9)


@st.composite
def histories(draw: st.DrawFn) -> np.ndarray:
    """Gaps of a pantograph that enters somewhere in the record, in any state, or never."""
    before = draw(st.integers(0, 5))
    values = st.sampled_from([-1.0, -0.25, 0.0, 0.5, 2.0]) | st.floats(-1.0, 1.0)
    known = draw(st.lists(values, max_size=30))
    return np.array([np.nan] * before + known)


@settings(max_examples=300, deadline=None)
@given(gap=histories())
@example(gap=np.array([-0.75, 0.0]))  # the crossing rounds past its sample
def test_state_before_the_first_sample_is_that_of_the_first(gap: np.ndarray) -> None:
    """A head that enters without touching has lost contact since it entered: as many starts as
    ends, nothing before the entry, and the changes of contact tell the same intervals."""
    time = 0.1 * np.arange(gap.size)
    start, end = loss_intervals(time, gap)
    known = time[~np.isnan(gap)]
    assert start.shape == end.shape
    assert np.all(end > start)
    instant, opens = contact_changes(time, gap)
    assert np.all(opens[1:] != opens[:-1])
    if known.size:
        lost = gap[~np.isnan(gap)] >= 0.0
        limits = (float(known[0]), float(known[-1]))
        again = intervals_between(instant, opens, limits, begins_lost=bool(lost[0]))
        assert np.array_equal(again, (start, end))
        assert np.all((start >= known[0]) & (end <= known[-1]))
        for moment, is_lost in zip(known, lost, strict=True):
            inside = bool(np.any((start <= moment) & (moment <= end)))
            assert inside or not is_lost or known.size == 1 or moment in instant
    else:
        assert start.size == 0
    first, last = counted_intervals(time, gap)
    assert first.shape == last.shape
    assert np.sum(last - first) == pytest.approx(0.1 * np.sum(gap >= 0.0) * (known.size > 1))


@settings(max_examples=100, deadline=None)
@given(
    opens=st.lists(st.booleans(), max_size=12),
    begins_lost=st.booleans(),
)
def test_changes_in_any_order_give_whole_intervals(opens: list[bool], begins_lost: bool) -> None:
    """Also events that repeat themselves, as in a damaged record, give intervals that begin and
    end, in order, inside the record or at the instants given."""
    instant = 1.0 + np.arange(len(opens))
    record = (0.5, 20.0)
    start, end = intervals_between(instant, np.array(opens, bool), record, begins_lost=begins_lost)
    assert start.shape == end.shape
    assert np.all(end > start)
    assert np.all(start[1:] >= end[:-1])
    if not opens:
        assert start.size == int(begins_lost)
