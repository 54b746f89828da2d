"""A recording of a measuring train, as arrays in SI units."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Recording:
    """What the sensors of one pantograph said over one run.

    Samples that are missing are NaN; nothing is filled in.

    Attributes
    ----------
    label : str
        Name of the file.
    time : (n,) s
        Increasing; NaN throughout for a survey of the wire without time or speed.
    forces : (n_sensor, n) N
        Each sensor's share of the force between head and frame, positive when the wire is lifted.
    force_strips : (n_sensor,)
        Number of the collector strip that each sensor carries, from 1.
    accelerations : (n_accelerometer, n) m/s2
        Of the strips, positive upwards.
    acceleration_strips : (n_accelerometer,)
    speed : (n,) m/s or None
    distance : (n,) m or None
        Way run since the first sample, increasing.
    stagger : (n,) m or None
        Lateral position of the wire, positive to the left.
    height : (n,) m or None
    contact_force : (n,) N or None
        As the recorder computed it from its sensors; None where a single force is all there is.
    uplift : (n,) m or None
        Height of the wire above its static position, at the pantograph.
    thickness : (n,) m or None
        Height of what is left of the worn contact wire.
    chainage : (n,) m or None
        Recorded position, rising or falling.
    latitude, longitude : (n,) degrees or None
    arc : (n,) or None
        Signal of an arc detector, as recorded.
    comments : tuple of (float, str)
        Times [s] and texts.
    notes : tuple of str
        What was understood, decided or left out while the file was read.
    jumps : tuple of (float, float)
        Way [m] at which the recorded position jumped, and by how much [m]; the positions here are
        counted on.
    mark_times, mark_chainages : (n_mark,) s, m
        Instants at which the train passed a known chainage, such as a mast.
    """

    label: str
    time: Array
    forces: Array
    force_strips: NDArray[np.int64]
    accelerations: Array
    acceleration_strips: NDArray[np.int64]
    speed: Array | None = None
    distance: Array | None = None
    stagger: Array | None = None
    height: Array | None = None
    contact_force: Array | None = None
    uplift: Array | None = None
    thickness: Array | None = None
    chainage: Array | None = None
    latitude: Array | None = None
    longitude: Array | None = None
    arc: Array | None = None
    comments: tuple[tuple[float, str], ...] = ()
    notes: tuple[str, ...] = ()
    jumps: tuple[tuple[float, float], ...] = ()
    mark_times: Array = field(default_factory=lambda: np.empty(0))
    mark_chainages: Array = field(default_factory=lambda: np.empty(0))

    def with_(self, **changes: Any) -> Recording:
        """Return a copy with some arrays replaced."""
        return replace(self, **changes)

    @property
    def interval(self) -> float:
        """Usual time between two samples [s]."""
        return float(np.median(np.diff(self.time)))

    @property
    def spacing(self) -> float:
        """Usual way between two samples [m]; NaN where no way is known."""
        if self.distance is None:
            return float("nan")
        return float((self.distance[-1] - self.distance[0]) / (len(self.distance) - 1))

    @property
    def is_rising(self) -> bool:
        """Whether the train ran towards rising chainage; True where none was recorded."""
        return self.chainage is None or bool(self.chainage[-1] >= self.chainage[0])

    @property
    def highest_frequency(self) -> float:
        """Frequency up to which the samples hold at least 90 % of the force [Hz].

        A mean over the way or time of one sample keeps ``sin(pi f T) / (pi f T)``, which is 0.9 at
        ``f T = 1/4``; that a row is a mean, and not the value of an instant, is the worse case.
        """
        return 0.25 / self.interval

    def strips(self) -> list[int]:
        """Return the numbers of the strips that carry force sensors."""
        return sorted({int(strip) for strip in self.force_strips})

    def sensors_of(self, strip: int) -> NDArray[np.int64]:
        """Return the rows of the sensors below one strip."""
        return np.flatnonzero(self.force_strips == strip)

    @property
    def is_live(self) -> NDArray[np.bool_]:
        """Which accelerometers say anything, ``(n_accelerometer,)``: two readings that differ."""
        least, most = (ends.reduce(self.accelerations, axis=1) for ends in (np.fmin, np.fmax))
        return most > least

    def accelerometer_name(self, row: int) -> str:
        """Name an accelerometer by its strip and its number there, both from 1."""
        strip = int(self.acceleration_strips[row])
        number = np.count_nonzero(self.acceleration_strips[: row + 1] == strip)
        return f"accelerometer {number} of strip {strip}"

    def strip_acceleration(self, strip: int) -> Array | None:
        """Return the mean of the live accelerometers of one strip; None where it has none.

        Each counts from its own median, so that one whose readings are missing for a while makes
        no step: ``a = mean(m_i) + mean over those that read (a_i - m_i)``.

        Returns
        -------
        (n,) m/s2
            NaN where none of them reads.
        """
        values = self.accelerations[(self.acceleration_strips == strip) & self.is_live]
        if not len(values):
            return None
        median = np.nanmedian(values, axis=1, keepdims=True)
        reads = ~np.isnan(values)
        count, total = reads.sum(axis=0), np.where(reads, values - median, 0.0).sum(axis=0)
        mean = np.divide(total, count, out=np.full(len(count), np.nan), where=count > 0)
        return mean + median.mean()


@dataclass(frozen=True)
class Step:
    """One step of processing that was done.

    Attributes
    ----------
    name : str
    parameters : mapping
        Everything that decides its result.
    """

    name: str
    parameters: Mapping[str, Any]
