"""Pantographs: lumped stages on the roof of a moving train."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

from pydantic import Discriminator, Field, Tag, model_validator

from tautwire.specs.base import (
    MAPPING,
    SCALAR,
    Problem,
    Quantity,
    Spec,
    Typical,
    form_of,
    refuse,
)
from tautwire.text import LONGEST_NAME

Time = Annotated[float, Quantity("s", ge=0.0, le=1e6)]
RoofHeight = Annotated[float, Quantity("m", ge=-1.0, le=1.0, typical="-20 to 20 mm")]
Name = Annotated[str, Field(min_length=1, max_length=LONGEST_NAME, pattern=r"^[^\x00-\x1f\x7f]+$")]


class ForceLaw(Spec):
    """A vertical force over speed: constant + per_speed * v + per_speed_squared * v^2.

    The speed is that of the air; a tunnel raises the parts that depend on it.
    """

    constant: Annotated[float, Quantity("N", ge=-1e3, le=1e3, typical="0 N")] = Field(
        default=0.0, description="Part that does not depend on the speed."
    )
    per_speed: Annotated[float, Quantity("N s/m", ge=-100.0, le=100.0)] = Field(
        default=0.0, description="Increase with the speed, in N per m/s."
    )
    per_speed_squared: Annotated[
        float, Quantity("N/(m/s)^2", ge=-1.0, le=1.0, typical="0.00097 N/(km/h)^2")
    ] = Field(default=0.0, description="Increase with the speed squared.")

    def at(self, air: Air) -> float:
        """Return the force in a flow of air [N]."""
        flow = self.per_speed * air.speed + self.per_speed_squared * air.speed * abs(air.speed)
        return self.constant + air.factor * flow


@dataclass(frozen=True)
class Air:
    """The air that a pantograph meets.

    Attributes
    ----------
    speed : float m/s
        Against the train; negative when a tail wind is faster than it.
    factor : float
        Of the forces that depend on it: 1 in the open, larger in a tunnel.
    """

    speed: float
    factor: float = 1.0


Aerodynamic = Annotated[
    Annotated[
        float,
        Quantity("N/(m/s)^2", ge=-1.0, le=1.0, typical="0.00097 N/(km/h)^2"),
        Tag(SCALAR),
    ]
    | Annotated[ForceLaw, Tag(MAPPING)],
    Discriminator(form_of),
]


class Stage(Spec):
    """One lumped mass with the spring and the damper below it."""

    mass: Annotated[float, Quantity("kg", gt=0.0, le=1000.0, typical="5 to 15 kg")] = Field(
        description="Mass of the stage."
    )
    stiffness: Annotated[float, Quantity("N/m", ge=0.0, le=1e9, typical="50 to 15500 N/m")] = Field(
        description="Stiffness to the stage below; of the last stage, to the roof."
    )
    damping: Annotated[float, Quantity("N s/m", ge=0.0, le=1e7, typical="0 to 100 N s/m")] = Field(
        default=0.0, description="Damping to the stage below; of the last stage, to the roof."
    )
    force: ForceLaw = Field(
        default=ForceLaw(),
        description="Force on this stage over speed, upwards, such as the aerodynamic force of a "
        "frame; it acts besides the uplift force.",
    )
    force_reversed: ForceLaw | None = Field(
        default=None,
        description="The same where the pantograph runs the other way (pantographs.reversed); "
        "'force' if left out.",
    )


class RoofMotion(Spec):
    """Prescribed vertical motion of the roof, linear between the points of a table.

    Before the first and after the last point the nearest value holds.
    """

    table_columns: ClassVar[tuple[str, ...]] = ("time", "height")

    time: tuple[Time, ...] = Field(
        min_length=2, description="Times since the start, strictly increasing."
    )
    height: tuple[RoofHeight, ...] = Field(
        min_length=2, description="Height of the roof at these times, from its starting position."
    )

    @model_validator(mode="after")
    def _check_table(self) -> RoofMotion:
        problems = []
        if len(self.time) != len(self.height):
            problems.append(
                Problem(
                    ("height",),
                    f"has {len(self.height)} values for {len(self.time)} times; give one per time",
                )
            )
        for index in range(1, len(self.time)):
            if self.time[index] <= self.time[index - 1]:
                problems.append(
                    Problem(
                        ("time", index),
                        f"got {self.time[index]:g} s after {self.time[index - 1]:g} s; times "
                        "must increase",
                    )
                )
                break
        refuse(problems)
        return self


class Pantograph(Spec):
    """A pantograph: stages from the head down, and the forces that lift it."""

    catalogue_kinds: ClassVar[tuple[str, ...]] = ("pantograph",)

    name: Name = Field(description="Name used in results, different for each pantograph.")
    behind: Annotated[float, Quantity("m", ge=0.0, le=1e5, typical="0; 200 m")] = Field(
        default=0.0, description="Distance behind the leading pantograph; 0 for the first."
    )
    stages: tuple[Stage, ...] = Field(
        min_length=1, max_length=20, description="Lumped stages, collector head first."
    )
    static_force: Annotated[float, Quantity("N", ge=0.0, le=1e3, typical="70 N (AC)")] = Field(
        default=0.0,
        description="Static part of the uplift force; used when the scenario gives no force.",
    )
    aerodynamic: Aerodynamic = Field(
        default=0.0,
        description="Aerodynamic part over the speed of the air: a force per speed squared, or "
        "{constant: ..., per_speed: ..., per_speed_squared: ...}; used with static_force.",
    )
    aerodynamic_reversed: Aerodynamic | None = Field(
        default=None,
        description="The same where the pantograph runs the other way; 'aerodynamic' if left out.",
    )
    reversed: bool = Field(
        default=False,
        description="Whether the pantograph runs with its knuckle the other way than its first "
        "aerodynamic forces are given for.",
    )
    force_stage: Annotated[int, Field(ge=1, strict=True), Typical("the lowest")] | None = Field(
        default=None,
        description="Stage on which the uplift force acts, 1 being the head; the lowest if left "
        "out.",
    )
    working_height: (
        Annotated[float, Quantity("m", ge=0.0, le=20.0, typical="5.0 to 5.5 m")] | None
    ) = Field(
        default=None,
        description="Height of the head at which the spring on the roof carries nothing, in the "
        "height system of the line; the mean height of the contact wire in the analysed section "
        "if left out.",
    )
    head_length: Annotated[float, Quantity("m", gt=0.0, le=4.0, typical="1.6 to 1.95 m")] = Field(
        default=1.6,
        description="Length of the head across the track: of several contact wires it touches "
        "those within half of it from the middle of the track.",
    )
    roof_motion: RoofMotion | None = Field(
        default=None, description="Prescribed motion of the roof; none if left out."
    )

    @model_validator(mode="after")
    def _check_stages(self) -> Pantograph:
        problems = [
            Problem(
                ("stages", index, "stiffness"),
                "got 0 N/m; only the lowest stage may stand on a spring without stiffness",
            )
            for index, stage in enumerate(self.stages[:-1])
            if stage.stiffness == 0.0
        ]
        if self.force_stage is not None and self.force_stage > len(self.stages):
            problems.append(
                Problem(
                    ("force_stage",),
                    f"got {self.force_stage}; the pantograph has {len(self.stages)} stages, "
                    "1 being the head",
                )
            )
        refuse(problems)
        return self

    def uplift_force(self, air: Air) -> float:
        """Return static and aerodynamic force in a flow of air [N]."""
        is_own = not self.reversed or self.aerodynamic_reversed is None
        law = self.aerodynamic if is_own else self.aerodynamic_reversed
        if not isinstance(law, ForceLaw):
            law = ForceLaw(per_speed_squared=law or 0.0)
        return self.static_force + law.at(air)

    def stage_forces(self, air: Air) -> tuple[float, ...]:
        """Return the force on every stage besides the uplift force in a flow of air [N]."""
        return tuple(
            (
                stage.force
                if stage.force_reversed is None or not self.reversed
                else stage.force_reversed
            ).at(air)
            for stage in self.stages
        )

    def lifted_stage(self) -> int:
        """Return the 0-based index of the stage on which the uplift force acts."""
        return len(self.stages) - 1 if self.force_stage is None else self.force_stage - 1
