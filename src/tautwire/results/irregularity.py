"""The irregularities of a line as they were drawn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class DrawnIrregularities:
    """Irregularities of one line, ready to be computed with.

    Attributes
    ----------
    seed : int
        Seed of everything random in them.
    dropper_height : (n_dropper,) m
        Error of the height of the contact wire at the droppers, positive up; span by span.
    dropper_length : (n_dropper,) m
        Error of the dropper lengths; span by span.
    surface_start, surface_spacing : float m
        Position of the first ordinate of the running surface, and distance between them.
    surface_height : (n_ordinate,) m
        Height of the running surface relative to the wire, positive up; empty without unevenness.
    """

    seed: int
    dropper_height: Array
    dropper_length: Array
    surface_start: float
    surface_spacing: float
    surface_height: Array

    @property
    def surface_x(self) -> Array:
        """Longitudinal positions of the ordinates of the running surface [m]."""
        count = np.arange(len(self.surface_height), dtype=np.float64)
        return self.surface_start + self.surface_spacing * count

    @property
    def is_installed_wrong(self) -> bool:
        """True when there is any error of installation."""
        return bool(np.any(self.dropper_height) or np.any(self.dropper_length))

    @property
    def is_uneven(self) -> bool:
        """True when the running surface has any unevenness."""
        return bool(np.any(self.surface_height))
