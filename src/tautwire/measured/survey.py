"""A survey of a line: heights, lengths, staggers, elasticity and uplift at places."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Quantity = Literal[
    "contact height", "messenger height", "dropper length", "stagger", "elasticity", "uplift"
]


@dataclass(frozen=True)
class Reading:
    """One measured value.

    Attributes
    ----------
    quantity : str
    value : float m
        Elasticity in m/N.
    accuracy : float m
        Standard deviation of its error; NaN for elasticity and uplift that have none of their own.
    span, dropper : int or None
        Of the dropper at which it was taken, both from 1.
    support : int or None
        Number of the support at which it was taken, from 1.
    s : float or None m
        Distance from support 1, where it was taken at neither.
    where : str
        Row of the table, for messages.
    wire, tension_length : str or None
        Of the lower wire of the dropper, where several droppers of a line have its numbers.
    """

    quantity: Quantity
    value: float
    accuracy: float
    span: int | None = None
    dropper: int | None = None
    support: int | None = None
    s: float | None = None
    where: str = ""
    wire: str | None = None
    tension_length: str | None = None


@dataclass(frozen=True)
class Survey:
    """All readings of a survey.

    Attributes
    ----------
    label : str
    readings : tuple of Reading
    notes : tuple of str
        What was decided while it was read.
    """

    label: str
    readings: tuple[Reading, ...]
    notes: tuple[str, ...] = ()

    def of(self, *quantities: Quantity) -> tuple[Reading, ...]:
        """Return the readings of some quantities."""
        return tuple(one for one in self.readings if one.quantity in quantities)
