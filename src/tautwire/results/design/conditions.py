"""The states of a line in its conditions, side by side."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

from tautwire.plain import Plain, named
from tautwire.results.equilibrium import Elasticity, Equilibrium


@dataclass(frozen=True)
class EndOfWire(Plain):
    """What one end of a wire does.

    Attributes
    ----------
    wire, side : str
    state : str
        In words.
    tension : float N
        Along the track.
    travel : float m
        Away from the wire; positive when it grows.
    sinking : float m
        How far weights have sunk; NaN without weights.
    """

    wire: str
    side: str
    state: str
    tension: float = field(metadata=named("tension_n"))
    travel: float = field(metadata=named("travel_m"))
    sinking: float = field(metadata=named("weights_sunk_m"))


@dataclass(frozen=True)
class Extreme(Plain):
    """An extreme value and where it is.

    Attributes
    ----------
    value : float m
    span : int
    x : float m
    """

    value: float = field(metadata=named("value_m"))
    span: int
    x: float = field(metadata=named("x_m"))


@dataclass(frozen=True, eq=False)
class ConditionState(Plain):
    """A line in one condition, over the spans of the analysed section.

    What cannot be has a fault and no figures.

    Attributes
    ----------
    name : str
    told : tuple of str
        In what it differs from the design.
    fault : str
        Why there is no such state; empty when there is.
    heights : tuple of float m
        Lowest and highest contact wire.
    left, right : Extreme or None
        Contact wire farthest to the left (positive) and to the right (negative).
    dropper_forces : tuple of float N
        Smallest and largest of those that carry.
    slack : tuple of str
        Droppers that carry nothing, by their places.
    arm_forces : tuple of float N
    ends : tuple of EndOfWire
    elasticity_range : (float, float) m/N
        Smallest and largest; NaN when it was not computed.
    nonuniformity : float
    shape : Equilibrium or None
    elasticity : Elasticity or None
    """

    untold: ClassVar[tuple[str, ...]] = ("shape", "elasticity")

    name: str
    told: tuple[str, ...] = ()
    fault: str = ""
    heights: tuple[float, ...] = field(default=(), metadata=named("contact_heights_m"))
    left: Extreme | None = None
    right: Extreme | None = None
    dropper_forces: tuple[float, ...] = field(default=(), metadata=named("dropper_forces_n"))
    slack: tuple[str, ...] = field(default=(), metadata=named("slack_droppers"))
    arm_forces: tuple[float, ...] = field(default=(), metadata=named("arm_forces_n"))
    ends: tuple[EndOfWire, ...] = ()
    elasticity_range: tuple[float, ...] = field(
        default=(), metadata=named("elasticity_mm_per_n", 1e3)
    )
    nonuniformity: float = float("nan")
    shape: Equilibrium | None = None
    elasticity: Elasticity | None = None
