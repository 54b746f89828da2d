"""Defects: what is broken, out of place or too much, named by its place as people count."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from tautwire.specs.base import Problem, Quantity, Spec, Typical, refuse

Kind = Literal[
    "missing dropper",
    "slack dropper",
    "dropper length",
    "swapped droppers",
    "broken stitch wire",
    "broken steady arm",
    "displaced support",
    "extra mass",
    "seized tensioning device",
]
Number = Annotated[int, Field(ge=1, le=1001, strict=True)]
Shift = Annotated[float, Quantity("m", ge=-2.0, le=2.0, typical="-50 mm to 50 mm")]

_DROPPER = ("span", "dropper")
NEEDED: dict[Kind, tuple[str, ...]] = {
    "missing dropper": _DROPPER,
    "slack dropper": _DROPPER,
    "dropper length": (*_DROPPER, "change"),
    "swapped droppers": (*_DROPPER, "other"),
    "broken stitch wire": ("support",),
    "broken steady arm": ("support",),
    "displaced support": ("support",),
    "extra mass": ("span", "at", "wire", "mass"),
    "seized tensioning device": ("wire", "end"),
}
"""Fields that each kind needs."""
ALLOWED: dict[Kind, tuple[str, ...]] = {
    "displaced support": ("lateral", "vertical"),
    "extra mass": ("tension_length",),
    "seized tensioning device": ("tension_length",),
    "broken steady arm": ("wire",),
    "broken stitch wire": ("wire",),
} | dict.fromkeys(
    ("missing dropper", "slack dropper", "dropper length", "swapped droppers"), ("wire",)
)  # pyright: ignore[reportAssignmentType]
"""Fields that each kind may have besides."""
_WRITTEN = {"other": "with"}
"""Fields that are written otherwise in a file."""


class Defect(Spec):
    """One defect; places count from 1 and from left to right, as everywhere."""

    kind: Annotated[Kind, Typical("missing dropper")] = Field(
        description="'missing dropper' (gone with both clamps), 'slack dropper' (hangs, carries "
        "nothing), 'dropper length' (longer or shorter by 'change'), 'swapped droppers' (two of a "
        "span, each with the length of the other), 'broken stitch wire' (carries nothing, nor do "
        "its droppers), 'broken steady arm', 'displaced support' (arm ends and messenger wire "
        "moved by 'lateral' and 'vertical'), 'extra mass' (a clamp too many), 'seized tensioning "
        "device' (the end of a wire does not move)."
    )
    span: Number | None = Field(default=None, description="Number of the span.")
    dropper: Number | None = Field(default=None, description="Number of the dropper in its span.")
    other: Number | None = Field(
        default=None,
        alias="with",
        description="'swapped droppers': number of the other dropper in the same span.",
    )
    support: Number | None = Field(default=None, description="Number of the support.")
    wire: str | None = Field(
        default=None,
        description="Name of the wire: the one that droppers carry or that an arm holds where "
        "there are several, the one with the extra mass or the seized device.",
    )
    tension_length: str | None = Field(
        default=None, description="Name of the tension length where there are several."
    )
    end: Literal["left", "right"] | None = Field(
        default=None, description="'seized tensioning device': at which end of the wire."
    )
    at: Annotated[float, Quantity("m", ge=0.0, le=500.0, typical="20 m")] | None = Field(
        default=None, description="'extra mass': distance from the support on the left of the span."
    )
    change: Annotated[float, Quantity("m", ge=-0.5, le=0.5, typical="-10 mm to 10 mm")] | None = (
        Field(
            default=None,
            description="'dropper length': added to the unstrained length, positive when longer.",
        )
    )
    mass: Annotated[float, Quantity("kg", gt=0.0, le=500.0, typical="0.5 to 5 kg")] | None = Field(
        default=None, description="'extra mass': the mass."
    )
    lateral: Shift = Field(
        default=0.0, description="'displaced support': to the left of rising chainage."
    )
    vertical: Shift = Field(default=0.0, description="'displaced support': upwards.")

    @model_validator(mode="after")
    def _check_fields(self) -> Defect:
        needed, allowed = NEEDED[self.kind], ALLOWED.get(self.kind, ())
        given = self.model_fields_set - {"kind"}
        given = {name for name in given if getattr(self, name) not in (None, 0.0)}
        problems = [
            Problem((_WRITTEN.get(name, name),), f"is missing; a defect '{self.kind}' needs it")
            for name in needed
            if getattr(self, name) is None
        ]
        problems += [
            Problem((_WRITTEN.get(name, name),), f"does not belong to a defect '{self.kind}'")
            for name in sorted(given - {*needed, *allowed})
        ]
        refuse(problems)
        return self

    def __str__(self) -> str:
        if self.support is not None:
            return f"{self.kind}: {self._of_wire(f'support {self.support}')}{self._shift()}"
        if self.dropper is not None:
            other = "" if self.other is None else f" and {self.other}"
            change = "" if self.change is None else f", {1e3 * self.change:+g} mm"
            place = f"dropper {self.dropper}{other} of span {self.span}"
            return f"{self.kind}: {self._of_wire(place)}{change}"
        if self.mass is not None:
            place = f"span {self.span} at {self.at:g} m"
            return f"{self.kind}: {self.mass:g} kg on {self._wire()}, {place}"
        return f"{self.kind}: {self.end} end of {self._wire()}"

    def _wire(self) -> str:
        return f"{self.tension_length} {self.wire}" if self.tension_length else str(self.wire)

    def _of_wire(self, place: str) -> str:
        return f"{place} ({self.wire})" if self.wire else place

    def _shift(self) -> str:
        parts = (("lateral", self.lateral), ("vertical", self.vertical))
        told = [f"{name} {1e3 * value:+g} mm" for name, value in parts if value]
        return f", {', '.join(told)}" if told else ""
