"""What the workshop does to droppers: clamps, loops, the step to which it cuts."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from tautwire.specs.base import Quantity, Spec

Deduction = Annotated[float, Quantity("m", ge=0.0, le=0.5, typical="0 to 60 mm")]


class Workshop(Spec):
    """How droppers are cut and counted; it changes no result of the line.

    The axes of the wires are those of the model. No maker's drawing is known to the program, so
    nothing is deducted or added unless it is given.
    """

    upper_clamp: Deduction = Field(
        default=0.0,
        description="Deduction at the upper end: from the axis of the wire above to where the "
        "dropper bears in its clamp, as the maker draws it. Chosen default: nothing.",
    )
    lower_clamp: Deduction = Field(
        default=0.0,
        description="The same at the lower end, down to the axis of the wire below.",
    )
    loop: Annotated[float, Quantity("m", ge=0.0, le=1.0, typical="0 to 200 mm")] = Field(
        default=0.0,
        description="Rope that the loop and its ferrule take at each end, besides. Chosen default: "
        "nothing.",
    )
    step: Annotated[float, Quantity("m", ge=0.0, le=0.1, typical="1 mm to 5 mm")] = Field(
        default=1e-3,
        description="Step to which droppers are cut; 0 cuts them as computed. Chosen default: the "
        "scale of a tape.",
    )
    length_class: Annotated[float, Quantity("m", gt=0.0, le=5.0, typical="50 mm to 200 mm")] = (
        Field(
            default=0.1,
            description="Width of the classes in which droppers are counted; a choice of this "
            "program.",
        )
    )
