"""The passage: speed, direction, and the force that lifts the pantographs."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Discriminator, Field, Tag, model_validator

from tautwire.specs.base import LIST, MAPPING, SCALAR, Problem, Quantity, Spec, form_of, refuse
from tautwire.specs.pantograph import Air

Force = Annotated[float, Quantity("N", ge=0.0, le=1e4, typical="50 to 250 N")]
MeanForce = Annotated[float, Quantity("N", gt=0.0, le=1e4, typical="70 to 170 N")]
ForcePerPantograph = Annotated[
    Annotated[Force, Tag(SCALAR)] | Annotated[tuple[Force, ...], Tag(LIST)],
    Discriminator(form_of),
]


TUNING_TOLERANCE = 0.1
"""Difference from the wanted mean force at which its tuning ends [N]."""


class MeanForceLaw(Spec):
    """Mean contact force as a function of speed: constant + per_speed_squared * speed^2."""

    constant: MeanForce = Field(description="Mean force at standstill.")
    per_speed_squared: Annotated[
        float, Quantity("N/(m/s)^2", ge=-1.0, le=1.0, typical="0.00097 N/(km/h)^2")
    ] = Field(description="Increase with the speed squared.")

    def at(self, speed: float) -> float:
        """Return the mean force [N] at a speed in m/s."""
        return self.constant + self.per_speed_squared * speed**2


class Scenario(Spec):
    """One passage of the train at constant speed."""

    speed: Annotated[float, Quantity("m/s", ge=0.01, le=250.0, typical="320 km/h")] = Field(
        description="Speed of the train; below the wave speed of the contact wire."
    )
    direction: Literal["+x", "-x"] = Field(
        default="+x", description="Running direction: from support 1 to the last, or back."
    )
    headwind: Annotated[float, Quantity("m/s", ge=-60.0, le=60.0, typical="0; 10 m/s")] = Field(
        default=0.0,
        description="Wind along the track against the train, a tail wind negative: the air that "
        "lifts the pantographs is that much faster.",
    )
    tunnel_factor: Annotated[float, Quantity("", ge=0.1, le=5.0, typical="1.3 to 2")] = Field(
        default=1.0,
        description="Factor of the aerodynamic forces that depend on the speed; that of your "
        "tunnels, 1 in the open.",
    )
    mean_force: (
        Annotated[
            Annotated[MeanForce, Tag(SCALAR)] | Annotated[MeanForceLaw, Tag(MAPPING)],
            Discriminator(form_of),
        ]
        | None
    ) = Field(
        default=None,
        description="Mean contact force in the analysed section to which the uplift force of "
        "every pantograph is tuned: a force, or {constant: ..., per_speed_squared: ...}.",
    )
    uplift_force: ForcePerPantograph | None = Field(
        default=None,
        description="Uplift force, prescribed, for all pantographs or one value each; excludes "
        "mean_force. Without either, each pantograph's static and aerodynamic force acts. "
        "0 lowers a pantograph: it does not touch the wire.",
    )
    uplift_guess: ForcePerPantograph | None = Field(
        default=None,
        description="With mean_force: first guess of the uplift force, for all pantographs or "
        "one value each. A good guess saves a passage; it does not change the result.",
    )

    @model_validator(mode="after")
    def _check_one_force(self) -> Scenario:
        if self.mean_force is not None and self.uplift_force is not None:
            refuse(
                [
                    Problem(
                        ("uplift_force",),
                        "is given together with scenario.mean_force; keep mean_force (the uplift "
                        "force is tuned) or uplift_force (it is prescribed)",
                    )
                ]
            )
        return self

    def with_(self, **changes: Any) -> Self:
        """Return a validated copy; setting mean_force clears uplift_force and the reverse."""
        for name, other in (("mean_force", "uplift_force"), ("uplift_force", "mean_force")):
            if changes.get(name) is not None and other not in changes:
                changes = {**changes, other: None}
        return super().with_(**changes)

    @property
    def air(self) -> Air:
        """The air that the pantographs meet."""
        return Air(self.speed + self.headwind, self.tunnel_factor)

    def target_mean_force(self) -> float | None:
        """Return the mean force [N] to tune to at the given speed; None when nothing is tuned."""
        if isinstance(self.mean_force, MeanForceLaw):
            return self.mean_force.at(self.speed)
        return self.mean_force
