"""Limits of the design of a line over speed, read from a data file."""

from __future__ import annotations

from functools import lru_cache
from typing import Literal

from pydantic import Field

from tautwire.assessment.data import Record, read_library
from tautwire.assessment.limits import Provenance, Sense
from tautwire.units import to_unit


class Bound(Record):
    """A value and the speeds to which it belongs [km/h]."""

    above: float | None = None
    up_to: float | None = None
    value: float

    def includes(self, speed: float) -> bool:
        """Say whether a speed [km/h] is one of them."""
        return (self.above is None or speed > self.above) and (
            self.up_to is None or speed <= self.up_to
        )


class DesignLimit(Provenance):
    """One limit of the design.

    Attributes
    ----------
    id, quantity : str
    sense : str
        ``"maximum"`` or ``"minimum"``.
    bounds : tuple of Bound
        The first that includes the speed counts.
    unit : str
    """

    id: str
    quantity: str
    sense: Sense
    bounds: tuple[Bound, ...]
    unit: Literal["m", "1"]

    def value(self, speed: float) -> float | None:
        """Return the limit at a speed [m/s]; None where there is none."""
        kmh = round(to_unit(speed, "km/h"), 6)
        return next((one.value for one in self.bounds if one.includes(kmh)), None)


class DesignLimits(Record):
    """The content of ``design-limits.yaml``."""

    schema_version: Literal[1] = Field(alias="schema")
    limits: tuple[DesignLimit, ...]


@lru_cache(maxsize=1)
def design_limits() -> dict[str, DesignLimit]:
    """Return the limits of the package by the quantity that they limit."""
    found = read_library("design-limits.yaml", DesignLimits)
    return {limit.quantity: limit for limit in found.limits}
