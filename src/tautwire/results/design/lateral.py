"""Where the contact wires stand over the track under wind from either side."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Side = Literal["left", "right"]

SIDES: tuple[Side, Side] = ("left", "right")
"""Sides that the wind pushes to, in the order of the first axis of arrays."""


@dataclass(frozen=True, eq=False)
class LateralSweep:
    """Contact wires at running height under wind towards the left, then towards the right.

    Attributes
    ----------
    x : (n,) m
        Places along the track from support 1.
    wire : (n,)
        Number of the wire.
    wire_names : tuple of str
    masts : (n_span + 1,) m
        Places of the supports; the wire at a support belongs to both spans beside it.
    position, height : (2, n) m
        Distance from the middle of the track towards the lee (negative on the other side), and
        height above the rails, of the finite-element equilibrium.
    radius : (n,) m
        Infinite where the track is straight.
    cant : (n,) m
        Cant or deficiency at the speed of the scenario, the larger.
    alone, together : (2, n_span) m
        Estimates of the largest distance in a span: the contact wire by itself, and with the
        messenger wire as one wire.
    faults : (str, str)
        Why there is no such state; empty where there is one.
    """

    x: Array
    wire: NDArray[np.int64]
    wire_names: tuple[str, ...]
    masts: Array
    position: Array
    height: Array
    radius: Array
    cant: Array
    alone: Array
    together: Array
    faults: tuple[str, str]
