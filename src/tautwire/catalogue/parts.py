"""What the catalogue holds, kind by kind: wires, ropes, droppers, clamps, arms, pantographs.

Every kind says which numbers an entry may state and which follow from them. A stated number always
stands; what it leaves out is derived where a rule of :mod:`tautwire.catalogue.rules` applies.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, ClassVar

from pydantic import BaseModel, ConfigDict, Field, model_validator

from tautwire.catalogue.numbers import Known, Number
from tautwire.catalogue.rules import CONTACT_WIRE, DROPPER, ROPE, Rule, complete
from tautwire.text import LONGEST_NAME

Name = Annotated[
    str, Field(min_length=1, max_length=LONGEST_NAME, pattern=r"^[^\x00-\x1f\x7f\[\]{}]+$")
]
Mass = Annotated[Number, Known("kg")]
Length = Annotated[Number, Known("m")]
MassPerLength = Annotated[Number, Known("kg/m")]
Section = Annotated[Number, Known("m^2")]
Modulus = Annotated[Number, Known("Pa")]
Force = Annotated[Number, Known("N")]
Stiffness = Annotated[Number, Known("N/m", zero_allowed=True)]
DampingRate = Annotated[Number, Known("N s/m", zero_allowed=True)]
Bending = Annotated[Number, Known("N m^2", zero_allowed=True)]
Expansion = Annotated[Number, Known("1/K")]

Filling = dict[str, Any]
"""Numbers by the key of a case that takes them; mappings and lists of them where it nests."""


class Part(BaseModel):
    """An entry of the catalogue: a thing with a name and numbers of known origin."""

    model_config = ConfigDict(frozen=True, extra="forbid", arbitrary_types_allowed=True)

    kind: ClassVar[str]
    rules: ClassVar[tuple[Rule, ...]] = ()
    name: Name
    aliases: tuple[Name, ...] = ()
    summary: str = Field(min_length=1, max_length=200)

    @model_validator(mode="before")
    @classmethod
    def _derive(cls, data: Any) -> Any:
        return complete(data, cls.rules)

    def numbers(self) -> dict[str, Number]:
        """Return every number of the entry by its name, numbers inside lists included."""
        return dict(_numbers(self))

    def filling(self) -> Filling:
        """Return what the entry gives to a case, by the keys of the case."""
        return {key: value for key, value in self if isinstance(value, Number)}


class _Strand(Part):
    """What every tensioned wire has."""

    section: Section
    diameter: Length | None = None
    mass: MassPerLength
    elasticity: Modulus
    axial_stiffness: Force
    strength: Force | None = None
    thermal_expansion: Expansion


class ContactWire(_Strand):
    """A grooved contact wire; a designation of EN 50149 names groove, section and material."""

    kind: ClassVar[str] = "contact wire"
    rules: ClassVar[tuple[Rule, ...]] = CONTACT_WIRE
    tensile_strength: Modulus | None = None
    bending_stiffness: Bending


class Rope(_Strand):
    """A stranded rope of equal wires laid in full layers: 7, 19, 37 ..."""

    kind: ClassVar[str] = "rope"
    rules: ClassVar[tuple[Rule, ...]] = ROPE
    wires: Annotated[int, Field(ge=1, le=1000)]
    wire_diameter: Length
    wire_strength: Modulus | None = None
    bending_stiffness: Bending
    bending_stiffness_slip: Bending

    def filling(self) -> Filling:
        """Return what the rope gives; its bending stiffness is that of wires that stick."""
        return {k: v for k, v in super().filling().items() if k != "bending_stiffness_slip"}


class Dropper(Part):
    """A dropper rope or rod, and the stiffness that a dropper made of it is given."""

    kind: ClassVar[str] = "dropper"
    rules: ClassVar[tuple[Rule, ...]] = DROPPER
    section: Section
    diameter: Length | None = None
    mass: MassPerLength
    elasticity: Modulus | None = None
    axial_stiffness: Force | None = None
    bending_stiffness: Bending | None = None
    strength: Force | None = None
    thermal_expansion: Expansion | None = None
    stiffness: Stiffness


class DropperClamps(Part):
    """The two clamps of a dropper."""

    kind: ClassVar[str] = "dropper clamps"
    clamp_contact: Mass
    clamp_messenger: Mass


class Clamp(Part):
    """A single clamp."""

    kind: ClassVar[str] = "clamp"
    mass: Mass


class SteadyArm(Part):
    """A steady arm."""

    kind: ClassVar[str] = "steady arm"
    length: Length
    mass: MassPerLength
    axial_stiffness: Force | None = None


class Cantilever(Part):
    """A cantilever: the steady arm, its clamp, and how the messenger wire is held."""

    kind: ClassVar[str] = "cantilever"
    arm_length: Length
    arm_mass: MassPerLength
    clamp: Mass | None = None
    messenger_stiffness: Stiffness
    messenger_damping: DampingRate

    def filling(self) -> Filling:
        """Return what the cantilever gives to the supports; its arm as the arm of them."""
        own = super().filling()
        arm = {"length": own.pop("arm_length"), "mass": own.pop("arm_mass")}
        return {"arm": arm, **own}


class Stage(BaseModel):
    """One lumped mass of a pantograph with the spring and the damper below it."""

    model_config = ConfigDict(frozen=True, extra="forbid", arbitrary_types_allowed=True)

    mass: Mass
    stiffness: Stiffness
    damping: DampingRate


class LumpedPantograph(Part):
    """A pantograph of lumped masses, from the head down."""

    kind: ClassVar[str] = "pantograph"
    stages: tuple[Stage, ...] = Field(min_length=1, max_length=10)
    static_force: Force | None = None

    def filling(self) -> Filling:
        """Return the stages and, where it is known, the static force."""
        stages = [dict(stage) for stage in self.stages]
        return {"stages": stages, **super().filling()}


KINDS: tuple[type[Part], ...] = (
    ContactWire,
    Rope,
    Dropper,
    DropperClamps,
    Clamp,
    SteadyArm,
    Cantilever,
    LumpedPantograph,
)
KIND_NAMES: tuple[str, ...] = tuple(kind.kind for kind in KINDS)


def _numbers(model: BaseModel, prefix: str = "") -> Iterator[tuple[str, Number]]:
    for key, value in model:
        if isinstance(value, Number):
            yield f"{prefix}{key}", value
        elif isinstance(value, tuple):
            for index, item in enumerate(value, 1):
                if isinstance(item, BaseModel):
                    yield from _numbers(item, f"{prefix}{key}[{index}].")
