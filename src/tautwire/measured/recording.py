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
        Increasing.
    forces : (n_sensor, n) N
        Each sensor's share of the force between head and frame, positive when the wire is lifted.
    force_strips : (n_sensor,)
        Number of the collector strip that each sensor carries, from 1.
    accelerations : (n_accelerometer, n) m/s2
        Of the strips, positive upwards.
    acceleration_strips : (n_accelerometer,)
    speed : (n,) m/s or None
    distance : (n,) m or None
        Odometer, increasing.
    stagger : (n,) m or None
        Lateral position of the wire, positive to the left.
    height : (n,) m or None
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
    mark_times: Array = field(default_factory=lambda: np.empty(0))
    mark_chainages: Array = field(default_factory=lambda: np.empty(0))

    def with_(self, **changes: Any) -> Recording:
        """Return a copy with some arrays replaced."""
        return replace(self, **changes)

    @property
    def interval(self) -> float:
        """Usual time between two samples [s]."""
        return float(np.median(np.diff(self.time)))

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
