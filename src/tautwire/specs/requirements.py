"""Requirements: what a line has to keep, given by those who design and maintain it."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from tautwire.specs.base import (
    LIST,
    MAPPING,
    SCALAR,
    Problem,
    Quantity,
    Spec,
    Typical,
    form_of,
    refuse,
)
from tautwire.specs.conditions.checks import missing_numbers
from tautwire.specs.conditions.condition import Condition, CrossWind
from tautwire.specs.line.catenary import Line
from tautwire.specs.line.dropper import Droppers
from tautwire.specs.line.support import Height
from tautwire.specs.line.wire import Wires
from tautwire.specs.span_table import HeadRule, Lateral

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


class Gauge(Spec):
    """The contact wire has to stay on the pantograph heads under wind from either side."""

    wind: CrossWind = Field(description="The wind, from the left and from the right in turn.")
    condition: str | None = Field(
        default=None,
        description="Name of the condition in which the line is otherwise; the design if left out.",
    )
    permissible: Annotated[
        Annotated[Lateral, Tag(SCALAR)] | Annotated[HeadRule, Tag(MAPPING)],
        Discriminator(form_of),
    ] = Field(
        description="Permissible distance of the wire from the middle of the track, a length "
        "(0.40 m for heads of 1600 mm and 0.55 m for 1950 mm are usual first values) or a "
        "calculation rule with a head, evaluated at every place with its height, radius and cant "
        "or deficiency at scenario.speed, the larger."
    )
    deflection: Annotated[float, Quantity("m", ge=0.0, le=1.0, typical="0 to 50 mm")] = Field(
        default=0.0, description="How far supports give way under the wind, to its lee."
    )
    tolerance: Annotated[float, Quantity("m", ge=0.0, le=1.0, typical="0 to 50 mm")] = Field(
        default=0.0,
        description="Tolerances of track and line that the permissible position does not contain.",
    )

    def state(self, conditions: tuple[Condition, ...], side: Literal["left", "right"]) -> Condition:
        """Return the condition with the wind from one side."""
        wind, name = self.wind.from_side(side), f"wind from the {side}"
        base = next((one for one in conditions if one.name == self.condition), None)
        return Condition(name=name, wind=wind) if base is None else base.with_(name=name, wind=wind)


class Requirements(Spec):
    """What the line has to keep in its design and in all conditions; nothing where left out."""

    arm_pull: ArmPull | None = Field(
        default=None, description="Limits of the lateral pull of steady arms."
    )
    gauge: Gauge | None = Field(
        default=None, description="Lateral position that the contact wire has to keep in wind."
    )
    heights: tuple[Height, Height] | None = Field(
        default=None,
        description="Least and largest height of the contact wire at rest in all conditions, in "
        "place of the limits of the package.",
    )
    shortest_dropper: (
        Annotated[float, Quantity("m", ge=0.0, le=5.0, typical="0.25 to 0.5 m")] | None
    ) = Field(default=None, description="Shortest dropper, in place of the limit of the package.")
    tension_share: Annotated[float, Quantity("", gt=0.0, le=1.0, typical="0.5 to 0.65")] | None = (
        Field(
            default=None,
            description="Largest tension over the breaking load that wear leaves, in place of the "
            "limit of the package.",
        )
    )
    uplift_space: Annotated[float, Quantity("m", gt=0.0, le=1.0, typical="120 mm")] | None = Field(
        default=None,
        description="Free space for uplift at the supports; by default the smallest gap of an "
        "uplift stop.",
    )
    structures: tuple[Structure, ...] = Field(
        default=(), description="Structures over the line, to which the wires keep a distance."
    )


def check_gauge(
    requirements: Requirements,
    conditions: tuple[Condition, ...],
    wires: Wires,
    droppers: Droppers | tuple[Droppers, ...],
) -> list[Problem]:
    """Check that the gauge names a condition that is there, and that wires meet its wind."""
    gauge = requirements.gauge
    if gauge is None:
        return []
    names = [one.name for one in conditions]
    if gauge.condition is not None and gauge.condition not in names:
        listed = ", ".join(names) if names else "none; describe them under 'conditions'"
        text = f"got {gauge.condition!r}; the conditions are: {listed}"
        return [Problem(("requirements", "gauge", "condition"), text)]
    told = {one.path for one in missing_numbers(conditions, wires, droppers)}
    missing = missing_numbers([gauge.state(conditions, "left")], wires, droppers)
    return [_asked_by_gauge(one) for one in missing if one.path not in told]


def _asked_by_gauge(problem: Problem) -> Problem:
    """Say that the gauge asks, in place of a condition that nobody wrote."""
    text = (
        "is missing: requirements.gauge has wind; give it, for example '12 mm', or take the "
        "catalogue's with 'use'"
    )
    return Problem(problem.path, text)


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
