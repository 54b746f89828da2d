"""Channels of one record that were sampled at different rates, brought to one clock.

The clock is that of the most samples, so that nothing is thinned out and nothing aliases: slower
channels are interpolated linearly between their samples. Gaps stay gaps, and nothing is continued
beyond the first and the last sample of a channel.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tautwire.measured.channels import Channel
from tautwire.measured.recording import Array
from tautwire.tables.columns import RECORDING, TEXT
from tautwire.tables.mapping import NEEDS, SheetMapping

_APART = 10_000
"""Added to the numbers of the columns of each further table: no table has as many columns."""


@dataclass(frozen=True, eq=False)
class Rate:
    """Channels of one sampling rate.

    Attributes
    ----------
    mapping : SheetMapping
    channels : tuple of Channel
    """

    mapping: SheetMapping
    channels: tuple[Channel, ...]

    @property
    def count(self) -> int:
        """Number of samples."""
        return max((len(one.values) for one in self.channels), default=0)

    @property
    def time(self) -> Array | None:
        """Times of the samples, ``(n,)`` [s]; None without any."""
        return next((one.values for one in self.channels if one.use.field.name == "time"), None)

    @property
    def is_recording(self) -> bool:
        """Whether it has all that a recording needs."""
        names = {one.use.field.name for one in self.channels}
        return all(names & set(group) for group in NEEDS[RECORDING])


def fastest(rates: Sequence[Rate]) -> tuple[Rate, list[Rate]]:
    """Return the rate with the most samples, of those that are recordings, and the others."""
    whole = [one for one in rates if one.is_recording] or list(rates)
    main = max(whole, key=lambda one: one.count)
    return main, [one for one in rates if one is not main]


def with_other_rates(main: Rate, others: Sequence[Rate]) -> tuple[list[Channel], list[str]]:
    """Return the channels of a rate with those of other rates brought to its clock.

    Parameters
    ----------
    main
    others

    Returns
    -------
    channels : list of Channel
    notes : list of str
        What was interpolated, and what was left out.
    """
    channels, notes = list(main.channels), list[str]()
    clock = main.time
    for number, other in enumerate(others, 1):
        time, label = other.time, other.mapping.sheet.label
        known = None if time is None else ~np.isnan(time)
        if clock is None or time is None or known is None or known.sum() < 2:
            notes.append(f"{label}: has no clock of its own; not read")
            continue
        if np.any(np.diff(time[known]) <= 0.0):
            notes.append(f"{label}: its time does not go on; not read")
            continue
        new, told = [], []
        for one in _new(other, channels, notes):
            values = np.interp(clock, time[known], one.values[known], left=np.nan, right=np.nan)
            use = replace(one.use, column=one.use.column + number * _APART)
            new.append(replace(one, use=use, values=values))
            told.append(repr(one.use.heading))
        if told:
            step = float(np.median(np.diff(time[known])))
            notes.append(
                f"{', '.join(told)}: {1.0 / step:.4g} samples a second, interpolated linearly to "
                f"the {1.0 / float(np.nanmedian(np.diff(clock))):.4g} of the other channels"
            )
        channels += new
    return _within_way(channels, notes), notes


def _within_way(channels: list[Channel], notes: list[str]) -> list[Channel]:
    """Leave out rows before the first and after the last position of a slower channel."""
    kept = np.ones(max((len(one.values) for one in channels), default=0), dtype=bool)
    for one in channels:
        if one.use.column >= _APART and one.use.field.name in ("position", "odometer"):
            known = np.flatnonzero(~np.isnan(one.values))
            kept[: known[0]] = False
            kept[known[-1] + 1 :] = False
    if kept.all():
        return channels
    notes.append(f"{int((~kept).sum())} rows at the ends have no position yet and are left out")
    return [
        replace(
            one,
            values=one.values[kept] if len(one.values) else one.values,
            texts=None if one.texts is None else one.texts[kept],
        )
        for one in channels
    ]


def _new(other: Rate, there: Sequence[Channel], notes: list[str]) -> Iterator[Channel]:
    """Yield the channels that are not there yet; time and texts belong to their own rows."""
    known = {_key(one) for one in there}
    for one in other.channels:
        if one.use.field.name == "time" or one.use.field.unit == TEXT:
            continue
        if _key(one) in known:
            notes.append(f"{one.use.heading!r} is there at a higher rate too; that is read")
        elif not np.isnan(one.values).all():
            yield one


def _key(channel: Channel) -> tuple[str, int | None, int | None]:
    return channel.use.field.name, channel.use.strip, channel.use.sensor
