"""Statistics of a passage: contact force, contact loss, uplift at supports, dropper forces."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from tautwire.errors import InputError
from tautwire.plain import Plain, named, plain
from tautwire.text import Told, marked

Array = NDArray[np.float64]

ARC_DURATION = 0.005
"""Shortest loss that counts as an arc [s] (EN 50367 as quoted by Song et al. 2021)."""


LOSS_CLASSES = (0.0, 1e-3, ARC_DURATION, 1e-2, 2e-2)
"""Limits of the classes of loss durations [s]."""

LOSS_BAND = 200.0
"""Highest frequency that losses of contact depend on [Hz]: they last some milliseconds; the widest
band of Song et al. (2021)."""

_ROUNDING = 1e-6
"""Share by which a frequency may be missed that counts as carried: lengths are rounded."""

ARC_NOTE = (
    "Losses of contact are a surrogate for measured arcing: no arc is modelled, and it may burn "
    "shorter or longer than the mechanical loss."
)


@dataclass(frozen=True)
class Section(Plain):
    """The analysed part of the line.

    Attributes
    ----------
    first_span, last_span : int
        1-based, both included.
    start, end : float m
        Position of the first support of the first span and of the last support of the last span.
    """

    first_span: int
    last_span: int
    start: float = field(metadata=named("start_m"))
    end: float = field(metadata=named("end_m"))

    def contains(self, position: Array) -> NDArray[np.bool_]:
        """Mark the positions inside the section, limits included; (n,) m to (n,) bool."""
        return (position >= self.start) & (position <= self.end)


@dataclass(frozen=True, eq=False)
class Histogram(Plain):
    """Share of the samples per force class.

    Attributes
    ----------
    edges : (n_class + 1,) N
    share : (n_class,)
        Fraction of the samples; adds up to 1 (empty when there are no samples).
    """

    edges: Array = field(metadata=named("edges_n"))
    share: Array


@dataclass(frozen=True)
class SpanStatistics(Plain):
    """Contact force within one span, by default low-passed at 20 Hz.

    Attributes
    ----------
    span : int
        1-based.
    start, end : float m
    mean, standard_deviation, maximum, minimum : float N
        NaN where the pantograph was never in the span.
    """

    untold: ClassVar[tuple[str, ...]] = ("start", "end")

    span: int
    start: float
    end: float
    mean: float = field(metadata=named("mean_n"))
    standard_deviation: float = field(metadata=named("std_n"))
    maximum: float = field(metadata=named("max_n"))
    minimum: float = field(metadata=named("min_n"))


@dataclass(frozen=True, eq=False)
class FilteredStatistics:
    """Contact force of one pantograph over the section, seen through one filter.

    Mean, extremes, percentiles, histogram and per-span values are those of the force low-passed
    at the filter's cut-off (20 Hz by default). Standard deviations divide by the number of
    samples (ddof 0).

    Attributes
    ----------
    kind : str
        ``"sharp"`` or ``"butterworth"``.
    description : str
        The filter with every number.
    cutoff : float Hz
    mean, maximum, minimum : float N
    standard_deviations : mapping of str to float N
        By band, ``"0_2"`` for 0 to 2 Hz; NaN where the band reaches the Nyquist frequency.
    standard_deviation : float N
        Of the force low-passed at the filter's cut-off.
    percentiles : mapping of float to float N
        Force not exceeded in so many percent of the samples.
    histogram : Histogram
    per_span : tuple of SpanStatistics
    carried : float Hz
        Highest frequency that mesh and time step carry; figures above it are marked.
    """

    kind: str
    description: str
    cutoff: float
    mean: float
    maximum: float
    minimum: float
    standard_deviations: Mapping[str, float]
    standard_deviation: float
    percentiles: Mapping[float, float]
    histogram: Histogram
    per_span: tuple[SpanStatistics, ...]
    carried: float = math.inf

    def carries(self, band: str) -> bool:
        """Return whether mesh and time step carry a band, ``"0_200"`` for 0 to 200 Hz."""
        return float(band.split("_")[1]) <= self.carried * (1.0 + _ROUNDING)

    @property
    def statistical_maximum(self) -> float:
        """Mean plus three standard deviations [N]."""
        return self.mean + 3.0 * self.standard_deviation

    @property
    def statistical_minimum(self) -> float:
        """Mean minus three standard deviations [N]."""
        return self.mean - 3.0 * self.standard_deviation

    def as_dict(self) -> dict[str, Any]:
        """Return the numbers as plain data for JSON, None in place of NaN."""
        bands = {f"std_{k}_n": plain(v) for k, v in self.standard_deviations.items()}
        return {
            "filter": self.description,
            "mean_n": plain(self.mean),
            **bands,
            "not_carried": [f"std_{k}_n" for k in self.standard_deviations if not self.carries(k)],
            "max_n": plain(self.maximum),
            "min_n": plain(self.minimum),
            "statistical_max_n": plain(self.statistical_maximum),
            "statistical_min_n": plain(self.statistical_minimum),
            "percentiles_n": {f"{k:g}": plain(v) for k, v in self.percentiles.items()},
            "histogram": self.histogram.as_dict(),
            "spans": [span.as_dict() for span in self.per_span],
        }


@dataclass(frozen=True)
class LossEvent(Plain):
    """One loss of contact inside the section.

    Attributes
    ----------
    start : float s
        Instant of separation (or of entering the section when it was already lost there).
    duration : float s
        Part of the loss inside the section.
    position : float m
        Position of the pantograph at `start`.
    place : str
        Nearest support or dropper, ``"dropper 3 of span 7"``.
    is_cut : bool
        True when a limit of the section or of the record cut the loss.
    """

    start: float = field(metadata=named("start_s"))
    duration: float = field(metadata=named("duration_ms", 1e3))
    position: float = field(metadata=named("position_m"))
    place: str
    is_cut: bool


@dataclass(frozen=True)
class LossClass(Plain):
    """Losses from one duration to the next.

    Attributes
    ----------
    low, high : float s
        Shortest duration, and the first one that is too long.
    count : int
    """

    low: float = field(metadata=named("from_ms", 1e3))
    high: float = field(metadata=named("to_ms", 1e3))
    count: int


@dataclass(frozen=True)
class ContactLoss:
    """Contact loss of one pantograph inside the section, from the unfiltered gap.

    Attributes
    ----------
    pantograph : str
    observed : float s
        Time the pantograph was in the section.
    events : tuple of LossEvent
        In order of time.
    carried : float Hz
        Highest frequency that mesh and time step carry.
    """

    pantograph: str
    observed: float
    events: tuple[LossEvent, ...]
    carried: float = math.inf

    @property
    def is_carried(self) -> bool:
        """Whether mesh and time step carry what losses depend on (:data:`LOSS_BAND`)."""
        return self.carried * (1.0 + _ROUNDING) >= LOSS_BAND

    @property
    def count(self) -> int:
        """Number of losses."""
        return len(self.events)

    @property
    def percent(self) -> float:
        """Lost time in percent of the time in the section; NaN when it was never there."""
        return self.percent_over(0.0)

    @property
    def longest(self) -> float:
        """Duration of the longest loss [s]; 0 without losses."""
        return max((event.duration for event in self.events), default=0.0)

    def count_over(self, duration: float = ARC_DURATION) -> int:
        """Count the losses that last at least `duration` [s]."""
        return sum(event.duration >= duration for event in self.events)

    def percent_over(self, duration: float = ARC_DURATION) -> float:
        """Time in losses of at least `duration` [s], in percent of the time in the section."""
        lost = sum(event.duration for event in self.events if event.duration >= duration)
        return 100.0 * lost / self.observed if self.observed > 0.0 else float("nan")

    def classes(self) -> tuple[LossClass, ...]:
        """Sort the losses into classes of duration (:data:`LOSS_CLASSES`)."""
        limits = (*LOSS_CLASSES, math.inf)
        return tuple(
            LossClass(low, high, sum(low <= event.duration < high for event in self.events))
            for low, high in pairwise(limits)
        )

    def as_dict(self) -> dict[str, Any]:
        """Return the losses as plain data for JSON."""
        return {
            "count": self.count,
            "is_carried": self.is_carried,
            "percent": plain(self.percent),
            "longest_ms": 1e3 * self.longest,
            "count_over_5_ms": self.count_over(),
            "percent_over_5_ms": plain(self.percent_over()),
            "observed_s": self.observed,
            "classes": [part.as_dict() for part in self.classes()],
            "events": [event.as_dict() for event in self.events],
        }


@dataclass(frozen=True, eq=False)
class PantographStatistics:
    """Everything about one pantograph over the section.

    Attributes
    ----------
    name : str
    uplift_force : float N
    target_mean : float N or None
    filtered : mapping of str to FilteredStatistics
        By kind of filter; ``"sharp"`` and ``"butterworth"`` are always there.
    headline_kind : str
        The kind that the case (or the call) asked for.
    contact_loss : ContactLoss
    contact_height_range : float m
        Largest minus smallest height of the contact point over the section.
    """

    name: str
    uplift_force: float
    target_mean: float | None
    filtered: Mapping[str, FilteredStatistics]
    headline_kind: str
    contact_loss: ContactLoss
    contact_height_range: float

    @property
    def headline(self) -> FilteredStatistics:
        """Statistics seen through the filter that was asked for."""
        return self.filtered[self.headline_kind]

    @property
    def sharp(self) -> FilteredStatistics:
        """Statistics seen through the sharp filter."""
        return self.filtered["sharp"]

    @property
    def butterworth(self) -> FilteredStatistics:
        """Statistics seen through the Butterworth filter."""
        return self.filtered["butterworth"]

    def as_dict(self) -> dict[str, Any]:
        """Return the pantograph's numbers as plain data for JSON."""
        return {
            "name": self.name,
            "uplift_force_n": self.uplift_force,
            "target_mean_n": self.target_mean,
            "headline": self.headline_kind,
            **{kind: part.as_dict() for kind, part in self.filtered.items()},
            "contact_loss": self.contact_loss.as_dict(),
            "contact_height_range_mm": plain(1e3 * self.contact_height_range),
        }


@dataclass(frozen=True, eq=False)
class UpliftStatistics:
    """Largest uplift of the contact wire at the supports of the section.

    Attributes
    ----------
    supports : (n,)
        1-based numbers of the supports of the section, its limits included.
    position : (n,) m
    uplift : (n,) m
        Largest vertical displacement from the static state; NaN when nothing passed.
    """

    supports: NDArray[np.int64]
    position: Array
    uplift: Array

    @property
    def maximum(self) -> float:
        """Largest uplift at any support of the section [m]; NaN when nothing passed."""
        known = self.uplift[np.isfinite(self.uplift)]
        return float(known.max()) if known.size else float("nan")

    def as_dict(self) -> dict[str, Any]:
        """Return the uplift as plain data for JSON."""
        pairs = zip(self.supports.tolist(), self.uplift.tolist(), strict=True)
        return {
            "max_mm": plain(1e3 * self.maximum),
            "supports": [{"support": n, "mm": plain(1e3 * u)} for n, u in pairs],
        }


@dataclass(frozen=True, eq=False)
class DropperStatistics:
    """Force range and slack time of the droppers of the section, left to right.

    Attributes
    ----------
    span, number : (n,)
        1-based span, and 1-based number within it.
    position : (n,) m
    static_force, maximum, minimum : (n,) N
    slack_time : (n,) s
        Time with a force of zero or less, counted in samples.
    observed : float s
        Time over which the droppers were watched.
    """

    span: NDArray[np.int64]
    number: NDArray[np.int64]
    position: Array
    static_force: Array
    maximum: Array
    minimum: Array
    slack_time: Array
    observed: float

    def as_dict(self) -> list[dict[str, Any]]:
        """Return one plain row per dropper for JSON."""
        return [
            {
                "span": int(self.span[i]),
                "dropper": int(self.number[i]),
                "static_n": plain(self.static_force[i]),
                "max_n": plain(self.maximum[i]),
                "min_n": plain(self.minimum[i]),
                "slack_s": plain(self.slack_time[i]),
            }
            for i in range(self.span.size)
        ]


@dataclass(frozen=True, eq=False, repr=False)
class RunStatistics(Told, Plain):
    """Result of :func:`tautwire.contact_statistics`.

    Attributes
    ----------
    case_name : str
    speed : float m/s
    section : Section
    pantographs : tuple of PantographStatistics
    uplift : UpliftStatistics
    droppers : DropperStatistics
    notes : tuple of str
        What the reader must know: bands without value, a section that was not covered.
    """

    case_name: str
    speed: float
    section: Section
    pantographs: tuple[PantographStatistics, ...]
    uplift: UpliftStatistics
    droppers: DropperStatistics
    notes: tuple[str, ...]

    untold: ClassVar[tuple[str, ...]] = ("case_name", "speed")

    def pantograph(self, name: str | None = None) -> PantographStatistics:
        """Return the statistics of the named pantograph, of the leading one without a name.

        Raises
        ------
        InputError
            When no pantograph has that name.
        """
        if name is None:
            return self.pantographs[0]
        for entry in self.pantographs:
            if entry.name == name:
                return entry
        names = ", ".join(entry.name for entry in self.pantographs)
        raise InputError(f"no pantograph named {name!r} in these statistics; there are: {names}")

    def facts(self) -> dict[str, str]:
        """Return the contact force of every pantograph and the largest uplift in words."""
        first, last = self.section.first_span, self.section.last_span
        told = {"case": f"{self.case_name} at {3.6 * self.speed:g} km/h, spans {first} to {last}"}
        for entry in self.pantographs:
            force, loss = entry.headline, entry.contact_loss
            told[entry.name] = (
                f"mean {force.mean:.1f} N, sigma {force.standard_deviation:.1f} N, "
                f"{force.minimum:.0f} to {force.maximum:.0f} N (0 to {force.cutoff:g} Hz), "
                f"{marked(str(loss.count), is_carried=loss.is_carried)} losses of contact"
            )
        told["largest uplift"] = f"{1e3 * self.uplift.maximum:.1f} mm"
        return told | ({"notes": " ".join(self.notes)} if self.notes else {})

    def __str__(self) -> str:
        """Return a short table with one column per pantograph and filter."""
        part = self.section
        lines = [f"contact force, spans {part.first_span} to {part.last_span} [N]"]
        for entry in self.pantographs:
            for kind, values in entry.filtered.items():
                lines.append(f"{entry.name}, {values.description}")
                mark = "  (headline)" if kind == entry.headline_kind else ""
                lines.append(
                    f"  mean {values.mean:.2f}  sigma {values.standard_deviation:.2f}  "
                    f"max {values.maximum:.2f}  min {values.minimum:.2f}{mark}"
                )
            loss = entry.contact_loss
            count = marked(str(loss.count), is_carried=loss.is_carried)
            lines.append(
                f"  contact loss: {count} events, {loss.percent:.3f} % of the time, "
                f"longest {1e3 * loss.longest:.2f} ms"
            )
        lines.append(f"largest uplift at a support {1e3 * self.uplift.maximum:.1f} mm")
        return "\n".join([*lines, *self.notes])
