"""What a table of longest spans is asked for: wires, wind, curves, and what is permissible."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from tautwire.specs.base import (
    MAPPING,
    NOTHING,
    SCALAR,
    Problem,
    Quantity,
    Spec,
    Typical,
    form_of,
    refuse,
)
from tautwire.specs.pantograph import Name

STRAIGHT = "straight"
MOST_CURVES, MOST_WINDS = 500, 50
"""Rows and columns of a table: far more than one prints, and computed within a second."""

Stagger = Annotated[float, Quantity("m", ge=-1.0, le=1.0, typical="-0.3 to 0.3 m")]
Diameter = Annotated[float, Quantity("m", gt=0.0, le=0.2, typical="9 to 15 mm")]
Radius = Annotated[float, Quantity("m", ge=10.0, le=1e9, typical="250 to 10000 m")]
Lateral = Annotated[float, Quantity("m", gt=0.0, le=2.0, typical="0.40 or 0.55 m")]


class BlownWires(Spec):
    """The wires that the wind moves together."""

    tension: Annotated[float, Quantity("N", gt=0.0, le=1e6, typical="10 to 50 kN")] = Field(
        description="Tension that holds them: of the contact wire alone, or of contact and "
        "messenger wire together when the diameters of both are given."
    )
    diameters: Annotated[tuple[Diameter, ...], Field(min_length=1, max_length=10)] = Field(
        description="Diameter of each wire that the wind blows on."
    )
    pulling: Annotated[float, Quantity("N", gt=0.0, le=1e6, typical="10 to 30 kN")] | None = Field(
        default=None,
        description="Tension of all contact wires at one registration, for the radial pull; "
        "'tension' if left out.",
    )


class Wind(Spec):
    """Wind across the line."""

    speeds: Annotated[
        tuple[Annotated[float, Quantity("m/s", ge=0.0, le=100.0, typical="26 to 33 m/s")], ...],
        Field(min_length=1, max_length=MOST_WINDS),
    ] = Field(description="Wind speeds; one column of the table each.")
    density: Annotated[float, Quantity("kg/m^3", gt=0.0, le=5.0, typical="1.25 kg/m^3")] = Field(
        default=1.25, description="Density of the air (EN 1991-1-4, from memory)."
    )
    drag: Annotated[float, Field(gt=0.0, le=5.0), Typical("0.75 to 1.2")] = Field(
        description="Force coefficient of a wire."
    )
    factor: Annotated[float, Field(gt=0.0, le=5.0), Typical("1 to 1.2")] = Field(
        default=1.0, description="Gust, height and shelter factors of your rule, multiplied."
    )


class HeadRule(Spec):
    """Permissible lateral position by calculation, for a pantograph head."""

    rule: Annotated[str, Typical("en50367-2012-norway")] = Field(
        description="Name of the calculation rule in the catalogue (gauge.yaml)."
    )
    head: Annotated[str, Typical("1600"), BeforeValidator(str)] = Field(
        description="Pantograph head of the catalogue, by its width in mm."
    )


class GaugeRule(HeadRule):
    """Permissible lateral position by calculation, at one height of the wire."""

    height: Annotated[float, Quantity("m", gt=0.0, le=10.0, typical="5.3 m")] = Field(
        description="Height of the contact wire above the rails."
    )


def _form_of_radius(value: object) -> str:
    return STRAIGHT if value == STRAIGHT else SCALAR


class Curve(Spec):
    """One row of the table."""

    radius: Annotated[
        Annotated[Radius, Tag(SCALAR)] | Annotated[Literal["straight"], Tag(STRAIGHT)],
        Discriminator(_form_of_radius),
    ] = Field(description="Radius of the curve, or 'straight'.")
    stagger: Annotated[tuple[Stagger, Stagger], Typical("[0.3 m, 0.3 m]")] = Field(
        description="Stagger at both supports, positive to the outside of the curve."
    )
    cant: Annotated[float, Quantity("m", ge=0.0, le=0.3, typical="0 to 150 mm")] = Field(
        default=0.0, description="Cant or cant deficiency, the larger; used by a calculation rule."
    )
    permissible: Lateral | None = Field(
        default=None, description="Permissible lateral position in this row alone."
    )

    @property
    def radius_or_infinity(self) -> float:
        """Radius [m]; infinite on straight track."""
        return math.inf if self.radius == STRAIGHT else float(self.radius)


class SpanTable(Spec):
    """A table of longest spans over radius and wind."""

    schema_version: Annotated[Literal[1], Typical("1")] = Field(
        alias="schema", description="Version of the input format."
    )
    name: Annotated[Name, Typical("my-spans")] = Field(description="Short name.")
    title: Annotated[str, Field(max_length=200)] = Field(default="", description="One line.")
    wires: BlownWires = Field(description="The wires that the wind moves together.")
    wind: Wind = Field(description="Wind across the line.")
    permissible: Annotated[
        Annotated[Lateral, Tag(SCALAR)]
        | Annotated[GaugeRule, Tag(MAPPING)]
        | Annotated[None, Tag(NOTHING)],
        Discriminator(form_of),
    ] = Field(
        default=None,
        description="Permissible lateral position: a length, or a calculation rule.",
    )
    curves: Annotated[tuple[Curve, ...], Field(min_length=1, max_length=MOST_CURVES)] = Field(
        description="Radii with their stagger; one row of the table each."
    )
    longest: Annotated[float, Quantity("m", gt=0.0, le=500.0, typical="60 or 65 m")] | None = Field(
        default=None, description="Span that is never exceeded."
    )
    radial_pull: Annotated[float, Quantity("N", gt=0.0, le=1e5, typical="2.5 to 4 kN")] | None = (
        Field(default=None, description="Largest radial pull at one registration.")
    )

    @model_validator(mode="after")
    def _check_permissible(self) -> SpanTable:
        if self.permissible is None:
            refuse(
                [
                    Problem(
                        ("curves", number, "permissible"),
                        "is missing: give it here, or 'permissible' for the whole table "
                        "(0.40 m for 1600 mm and 0.55 m for 1950 mm heads are usual first values)",
                    )
                    for number, curve in enumerate(self.curves)
                    if curve.permissible is None
                ]
            )
        return self
