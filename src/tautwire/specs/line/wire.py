"""Wires: what a contact wire or a messenger wire is made of."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar

from pydantic import Field

from tautwire.specs.base import Quantity, Spec


class Wire(Spec):
    """A tensioned wire, uniform along the line."""

    catalogue_kinds: ClassVar[tuple[str, ...]] = ("contact wire", "rope")

    tension: Annotated[float, Quantity("N", gt=0.0, le=1e6, typical="10 kN to 30 kN")] = Field(
        description="Mechanical tension, applied at the ends of the wire."
    )
    mass: Annotated[float, Quantity("kg/m", gt=0.0, le=100.0, typical="0.6 to 1.4 kg/m")] = Field(
        description="Mass per unstrained length, without clamps."
    )
    axial_stiffness: Annotated[float, Quantity("N", gt=0.0, le=1e10, typical="10 to 17 MN")] = (
        Field(description="Axial stiffness EA.")
    )
    bending_stiffness: Annotated[
        float, Quantity("N m^2", ge=0.0, le=1e6, typical="100 to 200 N m^2")
    ] = Field(
        description="Bending stiffness EI, the same in both directions; 0 for a rope that has none."
    )

    def wave_speed(self) -> float:
        """Return the speed of transverse waves sqrt(T/m) [m/s], bending neglected."""
        return math.sqrt(self.tension / self.mass)


class Wires(Spec):
    """The two wires of a simple catenary."""

    contact: Wire = Field(description="Contact wire, on which the pantograph runs.")
    messenger: Wire = Field(description="Messenger wire, which carries the droppers.")
