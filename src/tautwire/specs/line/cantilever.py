"""Cantilevers that give way: what holds a messenger wire or the heel of a steady arm."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator

from tautwire.specs.base import Problem, Quantity, Spec, refuse

Stiffness = Annotated[
    float, Quantity("N/m", gt=0.0, le=1e9, typical="50 to 500 kN/m across, 1 to 20 kN/m along")
]
DIRECTIONS = ("lateral", "vertical", "along")


class Elastic(Spec):
    """What gives way at a place of a cantilever, in the frame of the track.

    In the design the wires are where they are told to be, the cantilever bent under its load; from
    there it moves by the change of the force over the stiffness. Stiffnesses are chosen by the
    user; no measured ones are known to the package.
    """

    lateral: Stiffness | None = Field(
        default=None,
        description="Stiffness across the track (radial in a curve); rigid if left out.",
    )
    vertical: Stiffness | None = Field(
        default=None,
        description="Steady arms: vertical stiffness at the heel; rigid if left out. That of the "
        "messenger wire is supports.messenger_stiffness.",
    )
    along: Stiffness | None = Field(
        default=None,
        description="Stiffness along the track, against which wires travel in conditions; left "
        "out, the cantilever follows them.",
    )
    damping: Annotated[float, Quantity("N s/m", ge=0.0, le=1e6, typical="0 to 1000 N s/m")] = Field(
        default=0.0, description="Damping in each direction that has a stiffness here."
    )
    mass: Annotated[float, Quantity("kg", ge=0.0, le=500.0, typical="0 to 20 kg")] = Field(
        default=0.0,
        description="Mass of the cantilever that moves there; its weight is the mast's.",
    )

    @model_validator(mode="after")
    def _check_any(self) -> Elastic:
        if all(getattr(self, name) is None for name in DIRECTIONS):
            text = f"has no stiffness; give {', '.join(DIRECTIONS)}, or leave all of it out"
            refuse([Problem((), text)])
        return self

    def told(self) -> str:
        """Return the directions with their stiffness in words."""
        given = ((name, getattr(self, name)) for name in DIRECTIONS)
        return ", ".join(f"{name} {1e-3 * value:g} kN/m" for name, value in given if value)


class Cantilever(Spec):
    """Where cantilevers give way; rigid where left out."""

    messenger: Elastic | None = Field(
        default=None, description="Where the messenger wire is suspended."
    )
    arm: Elastic | None = Field(default=None, description="The heel (far end) of the steady arm.")

    @model_validator(mode="after")
    def _check_places(self) -> Cantilever:
        problems = []
        if self.messenger is None and self.arm is None:
            problems.append(Problem((), "says nothing; give messenger, arm or both"))
        if self.messenger is not None and self.messenger.vertical is not None:
            text = "is supports.messenger_stiffness for the messenger wire; give it there"
            problems.append(Problem(("messenger", "vertical"), text))
        refuse(problems)
        return self

    def told(self) -> str:
        """Return what gives way in words."""
        parts = (("messenger", self.messenger), ("arm", self.arm))
        return "; ".join(f"{name}: {one.told()}" for name, one in parts if one is not None)
