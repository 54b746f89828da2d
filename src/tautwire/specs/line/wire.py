"""Wires: what a contact wire or a messenger wire is made of."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, Any, ClassVar, Literal

from pydantic import ConfigDict, Field, model_validator

from tautwire.specs.base import Problem, Quantity, Spec, refuse

Role = Literal["contact", "messenger", "auxiliary", "stitch"]
Offset = Annotated[float, Quantity("m", ge=-50.0, le=50.0, typical="-9 m, 9 m")]
Distance = Annotated[float, Quantity("m", gt=0.0, le=5.0, typical="0.5 to 0.7 m")]

Expansion = Annotated[float, Quantity("1/K", gt=0.0, le=1e-3, typical="17e-6 1/K")]
Diameter = Annotated[float, Quantity("m", gt=0.0, le=0.2, typical="5 to 16 mm")]

ROLES: tuple[Role, ...] = ("contact", "messenger", "auxiliary", "stitch")


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
    diameter: Diameter | None = Field(
        default=None,
        description="Outer diameter, which wind and ice meet; needed by conditions with either.",
    )
    thermal_expansion: Expansion | None = Field(
        default=None,
        description="Thermal expansion of the unstrained length; needed by conditions at another "
        "temperature.",
    )

    strength: Annotated[float, Quantity("N", gt=0.0, le=1e7, typical="30 kN to 70 kN")] | None = (
        Field(
            default=None,
            description="Least breaking load of the new wire, against which its tension is "
            "checked.",
        )
    )

    role: Role | None = Field(
        default=None,
        description="What the wire is: 'contact' (pantographs run on it), 'messenger', 'auxiliary' "
        "(hangs on a messenger wire and carries contact wires) or 'stitch' (clamped to a messenger "
        "wire about every support). Wires named after their role need none.",
    )
    side: Annotated[float, Quantity("m", ge=-1.0, le=1.0, typical="-20 mm, 20 mm")] = Field(
        default=0.0,
        description="Contact wires: lateral distance from the stagger, positive to the left of "
        "rising chainage.",
    )
    from_: Offset | None = Field(
        default=None,
        alias="from",
        description="Stitch wires: left end, from every support between the anchors.",
    )
    to: Offset | None = Field(
        default=None,
        description="Stitch wires: right end, from every support between the anchors.",
    )
    clamped_to: str | None = Field(
        default=None, description="Stitch wires: name of the wire that holds the ends."
    )
    clamp: Annotated[float, Quantity("kg", ge=0.0, le=10.0, typical="0.38 kg")] = Field(
        default=0.0, description="Stitch wires: mass of the clamp at each end."
    )
    below: Distance | None = Field(
        default=None,
        description="Auxiliary wires: depth below the messenger wire at the supports; between them "
        "the wire runs straight (its droppers are cut for that).",
    )

    @model_validator(mode="after")
    def _check_stitch(self) -> Wire:
        problems = []
        needed = {"stitch": ("from_", "to", "clamped_to"), "auxiliary": ("below",)}
        for role, names in needed.items():
            for name in names:
                given, path = getattr(self, name) is not None, (name.rstrip("_"),)
                if self.role == role and not given:
                    problems.append(Problem(path, f"is missing; a wire of role '{role}' needs it"))
                elif self.role != role and given:
                    problems.append(Problem(path, f"belongs to wires of role '{role}' only"))
        if self.clamp and self.role != "stitch":
            problems.append(Problem(("clamp",), "belongs to wires of role 'stitch' only"))
        if self.from_ is not None and self.to is not None and self.from_ >= self.to:
            problems.append(Problem(("to",), f"got {self.to:g} m, not right of {self.from_:g} m"))
        refuse(problems)
        return self

    def wave_speed(self) -> float:
        """Return the speed of transverse waves sqrt(T/m) [m/s], bending neglected."""
        return math.sqrt(self.tension / self.mass)


class Wires(Spec):
    """The wires of a tension length, by any name; ``contact`` and ``messenger`` are the usual ones.

    Every wire hangs over the whole tension length, except stitch wires, which hang about every
    support.
    """

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, Wire]  # pyright: ignore[reportIncompatibleVariableOverride]
    named_items: ClassVar[type[Spec] | None] = Wire

    contact: Wire = Field(description="Contact wire, on which the pantograph runs.")
    messenger: Wire | None = Field(
        default=None,
        description="Messenger wire, which carries the droppers; none for a contact wire alone.",
    )

    @model_validator(mode="before")
    @classmethod
    def _name_roles(cls, data: Any) -> Any:
        """Give wires that are named after their role this role."""
        if not isinstance(data, dict):
            return data
        return {
            name: {**wire, "role": name}
            if name in ROLES and isinstance(wire, dict) and wire.get("role") is None
            else wire
            for name, wire in data.items()
        }

    @model_validator(mode="after")
    def _check_roles(self) -> Wires:
        problems = [
            Problem(
                (name, "role"),
                "is missing; a wire that is not named after its role needs one of "
                f"{', '.join(ROLES)}",
            )
            for name, wire in self.named()
            if wire.role is None
        ]
        names = [name for name, _ in self.named()]
        problems += [
            Problem(
                (name, "clamped_to"),
                f"got {wire.clamped_to!r}; there are the wires {', '.join(names)}",
            )
            for name, wire in self.named()
            if wire.clamped_to is not None and wire.clamped_to not in names
        ]
        refuse(problems)
        return self

    def named(self) -> Iterator[tuple[str, Wire]]:
        """Yield names and wires, contact wires first."""
        yield "contact", self.contact
        if self.messenger is not None:
            yield "messenger", self.messenger
        yield from (self.model_extra or {}).items()

    def of_role(self, *roles: Role) -> tuple[tuple[str, Wire], ...]:
        """Return names and wires with one of some roles."""
        return tuple((name, wire) for name, wire in self.named() if wire.role in roles)
