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

    def strip_acceleration(self, strip: int) -> Array | None:
        """Return the mean of the accelerometers of one strip; None where it has none."""
        rows = np.flatnonzero(self.acceleration_strips == strip)
        return self.accelerations[rows].mean(axis=0) if len(rows) else None


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
