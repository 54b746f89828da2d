"""What sits on a wire at one place: bodies in its line, and stays that hold it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Literal

from pydantic import Field, model_validator

from tautwire.specs.base import Problem, Quantity, Spec, Typical, refuse
from tautwire.specs.line.catenary import MOST_SPANS, Line
from tautwire.specs.line.tension import TensionLength
from tautwire.specs.line.wire import Wires

_WITH_LENGTH = ("axial_stiffness", "bending_stiffness", "end_mass")
"""What only a body with a length has."""


class Fitting(Spec):
    """A place on a wire."""

    name: Annotated[str, Typical("section insulator, wind stay")] = Field(
        min_length=1, max_length=60, description="What it is, as results call it."
    )
    wire: Annotated[str, Typical("contact")] = Field(description="Name of the wire.")
    tension_length: str | None = Field(
        default=None, description="Name of the tension length where there are several."
    )
    span: Annotated[int, Field(ge=1, le=MOST_SPANS, strict=True), Typical("4")] = Field(
        description="Number of the span."
    )
    at: Annotated[float, Quantity("m", ge=0.0, le=500.0, typical="20 m")] = Field(
        description="Distance from the support on the left of the span; of a body, to its middle."
    )


class Body(Fitting):
    """A body in the line of a wire: a splice, an insulator, a section insulator.

    With a length it stands in the place of that much of the wire, with its own mass and stiffness;
    without one it is a mass on the wire. Heights, tensions and dropper data stay as they are given.
    """

    length: Annotated[float, Quantity("m", ge=0.0, le=50.0, typical="0.3 to 2 m")] = Field(
        default=0.0, description="Length along the track, under tension; 0 for a mass alone."
    )
    mass: Annotated[float, Quantity("kg", gt=0.0, le=1000.0, typical="0.5 to 20 kg")] | None = (
        Field(
            default=None,
            description="With a length: mass in the place of the wire's, spread evenly; the wire's "
            "own if left out. Without: mass on the wire, needed.",
        )
    )
    end_mass: Annotated[float, Quantity("kg", ge=0.0, le=500.0, typical="0 to 2 kg")] = Field(
        default=0.0, description="Mass of the clamp at each of its ends, besides."
    )
    axial_stiffness: Annotated[float, Quantity("N", gt=0.0, le=1e10, typical="10 MN")] | None = (
        Field(default=None, description="Axial stiffness EA; the wire's own if left out.")
    )
    bending_stiffness: (
        Annotated[float, Quantity("N m^2", ge=0.0, le=1e6, typical="200 to 5000 N m^2")] | None
    ) = Field(default=None, description="Bending stiffness EI; the wire's own if left out.")

    @model_validator(mode="after")
    def _check_length(self) -> Body:
        if self.length > 0.0:
            return self
        problems = [
            Problem((name,), "belongs to a body with a length; give length too, or leave it out")
            for name in _WITH_LENGTH
            if getattr(self, name)
        ]
        if self.mass is None:
            text = "is missing; a body without a length is nothing but its mass"
            problems.append(Problem(("mass",), text))
        refuse(problems)
        return self


class Stay(Fitting):
    """A stay from a wire to a fixed point: a wind stay, a tie, a rope along the track.

    In the design it carries the force that is told, nothing if none is; from there it pulls,
    pushes, or both. It has no weight.
    """

    law: Literal["rope", "bar", "strut"] = Field(
        default="rope", description="'rope' (pulls only), 'bar' (both ways) or 'strut' (pushes)."
    )
    stiffness: Annotated[float, Quantity("N/m", gt=0.0, le=1e9, typical="0.1 to 5 MN/m")] = Field(
        description="Axial stiffness EA over length."
    )
    slack: Annotated[float, Quantity("m", ge=0.0, le=1.0, typical="0 to 50 mm")] = Field(
        default=0.0,
        description="Change of the distance from the design, until a rope or strut acts.",
    )
    force: Annotated[float, Quantity("N", ge=0.0, le=1e5, typical="0 to 2 kN")] = Field(
        default=0.0, description="Pull of a rope or bar, push of a strut, in the design."
    )
    end_along: Annotated[float, Quantity("m", ge=-500.0, le=500.0, typical="0 m")] = Field(
        default=0.0, description="Place of the far end ahead of 'at' along the track's tangent."
    )
    end_y: Annotated[float, Quantity("m", ge=-100.0, le=100.0, typical="3 m")] = Field(
        description="Lateral position of the far end, to the left of rising chainage."
    )
    end_z: Annotated[float, Quantity("m", ge=0.0, le=50.0, typical="5 to 8 m")] = Field(
        description="Height of the far end above the rails."
    )

    @model_validator(mode="after")
    def _check_slack(self) -> Stay:
        if self.slack and (self.law == "bar" or self.force):
            is_bar = self.law == "bar"
            text = "a bar acts both ways at once" if is_bar else "one that is slack has no force"
            refuse([Problem(("slack",), f"belongs to a rope or a strut without force; {text}")])
        return self


def check_fittings(
    line: Line,
    wires: Wires,
    tension_lengths: tuple[TensionLength, ...],
    bodies: tuple[Body, ...],
    stays: tuple[Stay, ...],
) -> list[Problem]:
    """Check that bodies and stays name spans, wires and tension lengths that exist."""
    groups: tuple[tuple[str, Sequence[Fitting]], ...] = (("bodies", bodies), ("stays", stays))
    return [
        problem.under(group, index)
        for group, fittings in groups
        for index, one in enumerate(fittings)
        for problem in _misplaced(line, dict(wires.named()), tension_lengths, one)
    ]


def _misplaced(
    line: Line, wires: dict[str, object], tension_lengths: tuple[TensionLength, ...], one: Fitting
) -> list[Problem]:
    problems, names = [], [each.name for each in tension_lengths]
    if one.wire not in wires:
        text = f"got {one.wire!r}; there are the wires {', '.join(wires)}"
        problems.append(Problem(("wire",), text))
    if one.span > line.spans:
        problems.append(Problem(("span",), f"got {one.span}; the line has {line.spans} spans"))
    elif one.at > (length := line.span_lengths()[one.span - 1]):
        text = f"got {one.at:g} m, outside the span of {length:g} m"
        problems.append(Problem(("at",), text))
    if one.tension_length is not None and one.tension_length not in names:
        listed = ", ".join(names) or "only one, without a name"
        text = f"got {one.tension_length!r}; tension lengths: {listed}"
        problems.append(Problem(("tension_length",), text))
    return problems
