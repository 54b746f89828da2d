"""Conditions: what differs from the line as it was designed, at one temperature in still air."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal

from pydantic import ConfigDict, Field, model_validator
from typing_extensions import override

from tautwire.specs.base import Problem, Quantity, Spec, Typical, refuse
from tautwire.specs.conditions.defect import Defect
from tautwire.units import TEMPERATURE

Name = Annotated[
    str, Field(min_length=1, max_length=30, pattern=r"^[^/\\\x00-\x1f]+$"), Typical("warm")
]
Temperature = Annotated[
    float, Quantity(TEMPERATURE, ge=-90.0, le=300.0, typical="-30 degC to 80 degC")
]
Shelter = Annotated[float, Quantity("", ge=0.0, le=1.0, typical="0.8")]
Drag = Annotated[float, Quantity("", ge=0.0, le=5.0, typical="1.0 to 1.2")]


class CrossWind(Spec):
    """Steady wind across the track, from whichever side."""

    speed: Annotated[float, Quantity("m/s", ge=0.0, le=100.0, typical="15 m/s to 33 m/s")] = Field(
        description="Speed at the height of the wires, across the track."
    )
    density: Annotated[float, Quantity("kg/m^3", gt=0.0, le=3.0, typical="1.25 kg/m^3")] = Field(
        default=1.25,
        description="Density of the air; by default that of EN 1991-1-4 at sea level, from memory.",
    )
    gust: Annotated[float, Quantity("", gt=0.0, le=10.0, typical="1.0 to 2.0")] = Field(
        default=1.0, description="Factor of the pressure for gusts and height above ground."
    )
    drag: Drag = Field(
        default=1.0,
        description="Drag coefficient of wires and droppers; by default that of EN 50119 for round "
        "wires, from memory.",
    )
    shelter: Shelter = Field(
        default=1.0, description="Share of the pressure that reaches wires and droppers."
    )

    def __str__(self) -> str:
        factors = (("gust", self.gust), ("drag", self.drag), ("shelter", self.shelter))
        told = [f"{name} {value:g}" for name, value in factors if value != 1.0]
        return ", ".join([self._told_speed(), *told])

    def _told_speed(self) -> str:
        return f"wind {self.speed:g} m/s"

    def from_side(self, side: Literal["left", "right"]) -> Wind:
        """Return it as the wind from one side."""
        own = {name: getattr(self, name) for name in CrossWind.model_fields}
        return Wind.model_validate({**own, "from": side})


class Wind(CrossWind):
    """Steady wind across the track, with the load ``rho v^2 / 2 * gust * drag * d * shelter``."""

    from_: Literal["left", "right"] = Field(
        alias="from", description="Side that it comes from, looking along rising chainage."
    )

    @override
    def _told_speed(self) -> str:
        return f"{super()._told_speed()} from the {self.from_}"

    @property
    def pressure(self) -> float:
        """Pressure with gusts [N/m2], positive when it pushes to the left of rising chainage."""
        towards = 1.0 if self.from_ == "right" else -1.0
        return towards * 0.5 * self.density * self.speed**2 * self.gust


class Ice(Spec):
    """Ice around wires: its thickness, or its mass per length."""

    thickness: Annotated[float, Quantity("m", ge=0.0, le=0.2, typical="5 mm to 20 mm")] | None = (
        Field(default=None, description="Thickness all around.")
    )
    mass: Annotated[float, Quantity("kg/m", ge=0.0, le=20.0, typical="0.2 to 1.5 kg/m")] | None = (
        Field(default=None, description="Mass per length of wire.")
    )
    density: Annotated[float, Quantity("kg/m^3", gt=0.0, le=920.0, typical="300 to 900 kg/m^3")] = (
        Field(default=900.0, description="Density of the ice; by default that of glaze.")
    )

    @model_validator(mode="after")
    def _check_one_given(self) -> Ice:
        if (self.thickness is None) == (self.mass is None):
            refuse([Problem((), "give exactly one of thickness ('10 mm') and mass ('0.5 kg/m')")])
        return self

    def __str__(self) -> str:
        size = (
            f"{1e3 * self.thickness:g} mm" if self.thickness is not None else f"{self.mass:g} kg/m"
        )
        return f"ice {size} ({self.density:g} kg/m3)"

    def around(self, diameter: float) -> tuple[float, float]:
        """Return the mass per length [kg/m] and the outer diameter [m] of the ice on a wire."""
        area = 0.25 * math.pi * self.density
        if self.thickness is not None:
            outer = diameter + 2.0 * self.thickness
            return area * (outer**2 - diameter**2), outer
        mass = self.mass or 0.0
        return mass, math.sqrt(diameter**2 + mass / area)


class Exposure(Spec):
    """What one wire, or the droppers, meet in place of what the condition says for all."""

    temperature: Temperature | None = Field(default=None, description="Its own temperature.")
    ice: Ice | None = Field(default=None, description="Its own ice.")
    drag: Drag | None = Field(default=None, description="Its own drag coefficient.")
    shelter: Shelter | None = Field(
        default=None, description="Its own share of the pressure of the wind."
    )

    def told(self) -> list[str]:
        """Return in words what is its own."""
        found = [] if self.temperature is None else [f"{self.temperature:g} degC"]
        found += [] if self.ice is None else [str(self.ice)]
        found += [] if self.drag is None else [f"drag {self.drag:g}"]
        return found + ([] if self.shelter is None else [f"shelter {self.shelter:g}"])


class WireChange(Exposure):
    """What differs for one wire."""

    wear: Annotated[float, Quantity("", ge=0.0, lt=0.5, typical="0.1 to 0.2")] | None = Field(
        default=None,
        description="Contact wires: share of the section that is worn away, from below.",
    )
    tension: Annotated[float, Quantity("N", gt=0.0, le=1e6, typical="10 kN to 30 kN")] | None = (
        Field(
            default=None,
            description="Tension in place of that of the design, at the same temperature as the "
            "condition: other weights, another setting of a spring, or the anchor on the right "
            "moved.",
        )
    )

    @override
    def told(self) -> list[str]:
        worn = [] if self.wear is None else [f"worn by {100 * self.wear:g} %"]
        tension = [] if self.tension is None else [f"{1e-3 * self.tension:g} kN"]
        return [*super().told(), *worn, *tension]


class WireChanges(Spec):
    """What differs for single wires, by their names."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, WireChange]  # pyright: ignore[reportIncompatibleVariableOverride]
    named_items: ClassVar[type[Spec] | None] = WireChange

    def named(self) -> Iterator[tuple[str, WireChange]]:
        """Yield names and changes."""
        yield from (self.model_extra or {}).items()


class Condition(Spec):
    """A state of the line in which it keeps the unstrained lengths of its design.

    What is not said is as in the design: its temperature, no wind, no ice, new wires.
    """

    name: Name = Field(description="Short name, by which it is chosen.")
    after: str | None = Field(
        default=None,
        description="Condition listed before, from which the line comes: tensioning devices with "
        "friction move from where they stood in it; from the design if left out.",
    )
    temperature: Temperature | None = Field(
        default=None, description="Temperature of all wires and droppers."
    )
    reference: Temperature | None = Field(
        default=None, description="Temperature of the design; needed with any temperature."
    )
    wind: Wind | None = Field(default=None, description="Wind across the track.")
    ice: Ice | None = Field(
        default=None,
        description="Ice on all wires; on droppers too where it is given by its thickness.",
    )
    wear: Annotated[float, Quantity("", ge=0.0, lt=0.5, typical="0.1 to 0.2")] = Field(
        default=0.0,
        description="Share of the section of all contact wires that is worn away, from below.",
    )
    wires: WireChanges | None = Field(
        default=None, description="What differs for single wires, by their names."
    )
    droppers: Exposure = Field(default=Exposure(), description="What differs for droppers.")
    defects: tuple[Defect, ...] = Field(default=(), description="Defects, each at its place.")

    @model_validator(mode="after")
    def _check_reference(self) -> Condition:
        parts = (self, self.droppers, *(change for _, change in self.changed_wires))
        if self.reference is None and any(part.temperature is not None for part in parts):
            text = "is missing; the temperature of the design, for example '15 degC'"
            refuse([Problem(("reference",), text)])
        return self

    def told(self) -> list[str]:
        """Return in words everything in which it differs from the design, defects last."""
        found = [] if self.after is None else [f"after {self.after!r}"]
        if self.temperature is not None:
            found.append(f"{self.temperature:g} degC (design {self.reference:g} degC)")
        found += [str(part) for part in (self.wind, self.ice) if part is not None]
        found += [f"contact wires worn by {100 * self.wear:g} %"] if self.wear else []
        for name, part in (*self.changed_wires, ("droppers", self.droppers)):
            told = part.told()
            found += [f"{name}: {', '.join(told)}"] if told else []
        return [*found, *map(str, self.defects)]

    @property
    def changed_wires(self) -> tuple[tuple[str, WireChange], ...]:
        """Names of wires of which more is said, and what."""
        return () if self.wires is None else tuple(self.wires.named())

    def of_wire(self, name: str) -> WireChange:
        """Return what is said for one wire alone."""
        return dict(self.changed_wires).get(name, WireChange())

    def warming(self, part: Exposure) -> float:
        """Return how much warmer than in the design a wire or the droppers are [K]."""
        temperature = self.temperature if part.temperature is None else part.temperature
        if temperature is None or self.reference is None:
            return 0.0
        return temperature - self.reference

    def ice_on(self, part: Exposure, *, is_dropper: bool = False) -> Ice | None:
        """Return the ice on a wire or on the droppers."""
        if part.ice is not None:
            return part.ice
        is_on_wires_only = self.ice is not None and self.ice.thickness is None
        return None if is_dropper and is_on_wires_only else self.ice

    def wind_pressure(self, part: Exposure) -> float:
        """Return pressure times drag and shelter for a wire or the droppers [N/m2].

        Positive when it pushes to the left of rising chainage.
        """
        if self.wind is None:
            return 0.0
        drag = self.wind.drag if part.drag is None else part.drag
        shelter = self.wind.shelter if part.shelter is None else part.shelter
        return self.wind.pressure * drag * shelter
