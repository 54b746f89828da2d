"""Requirements: what a line has to keep, given by those who design and maintain it."""

from __future__ import annotations

from typing import Annotated

from pydantic import Discriminator, Field, Tag, model_validator

from tautwire.specs.base import LIST, SCALAR, Problem, Quantity, Spec, Typical, form_of, refuse
from tautwire.specs.line.catenary import Line

Pull = Annotated[float, Quantity("N", ge=0.0, le=1e5, typical="80 N to 2.5 kN")]
PullPerSupport = Annotated[
    Annotated[Pull, Tag(SCALAR)] | Annotated[tuple[Pull, ...], Tag(LIST)],
    Discriminator(form_of),
]


class ArmPull(Spec):
    """How much steady arms have to pull, and may; one value for all, or one per support."""

    least: PullPerSupport | None = Field(
        default=None, description="Least lateral pull, below which an arm may come loose."
    )
    most: PullPerSupport | None = Field(
        default=None, description="Largest lateral pull that an arm and its clamp bear."
    )

    @model_validator(mode="after")
    def _check_any(self) -> ArmPull:
        if self.least is None and self.most is None:
            text = "says nothing; give least ('80 N'), most ('2.5 kN') or both"
            refuse([Problem((), text)])
        return self

    def limits(self, support: int) -> tuple[float | None, float | None]:
        """Return least and largest pull at a support, numbered from 1 [N]."""

        def of(value: float | tuple[float, ...] | None) -> float | None:
            return value[support - 1] if isinstance(value, tuple) else value

        return of(self.least), of(self.most)


class Structure(Spec):
    """A structure over the line: a bridge, the roof of a tunnel."""

    name: Annotated[str, Field(min_length=1, max_length=60), Typical("road bridge")] = Field(
        description="Its name."
    )
    at: Annotated[float, Quantity("m", ge=0.0, le=1e6, typical="312 m")] = Field(
        description="Where it begins, along the track from support 1."
    )
    length: Annotated[float, Quantity("m", ge=0.0, le=1e5, typical="12 m")] = Field(
        default=0.0, description="Its length along the track."
    )
    height: Annotated[float, Quantity("m", gt=0.0, le=100.0, typical="6.5 m")] = Field(
        description="Height of its lower edge above the rails."
    )
    uplift: Annotated[float, Quantity("m", ge=0.0, le=1.0, typical="50 to 120 mm")] = Field(
        description="How far passing pantographs lift the wires there."
    )
    clearance: Annotated[float, Quantity("m", ge=0.0, le=10.0, typical="150 to 270 mm")] = Field(
        description="Distance to live parts that has to be left; that of your rules."
    )


class Requirements(Spec):
    """What the line has to keep in its design and in all conditions; nothing where left out."""

    arm_pull: ArmPull | None = Field(
        default=None, description="Limits of the lateral pull of steady arms."
    )
    structures: tuple[Structure, ...] = Field(
        default=(), description="Structures over the line, to which the wires keep a distance."
    )


def check_requirements(line: Line, requirements: Requirements) -> list[Problem]:
    """Check that lists have one value per support and structures stand over the line."""
    problems, count, length = [], line.spans + 1, line.length()
    for name in ("least", "most"):
        values = None if requirements.arm_pull is None else getattr(requirements.arm_pull, name)
        if isinstance(values, tuple) and len(values) != count:
            text = (
                f"has {len(values)} values; {line.spans} spans have {count} supports, both anchors "
                "included: give one value per support"
            )
            problems.append(Problem(("requirements", "arm_pull", name), text))
    for number, one in enumerate(requirements.structures):
        if one.at + one.length > length:
            end = one.at + one.length
            text = f"got {one.at:g} to {end:g} m; the line is {length:g} m long"
            problems.append(Problem(("requirements", "structures", number, "at"), text))
    return problems
