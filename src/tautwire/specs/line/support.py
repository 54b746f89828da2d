"""Supports: where the wires are held, and by what."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from tautwire.specs.base import LIST, SCALAR, Problem, Quantity, Spec, Typical, form_of, refuse
from tautwire.specs.line.cantilever import Cantilever
from tautwire.specs.line.catenary import Line
from tautwire.specs.line.wire import Wires

Height = Annotated[float, Quantity("m", ge=0.0, le=20.0, typical="5.08 to 5.5 m")]
Encumbrance = Annotated[float, Quantity("m", gt=0.0, le=10.0, typical="1.2 to 1.8 m")]
Stagger = Annotated[
    float,
    Quantity(
        "m",
        ge=-1.0,
        le=1.0,
        typical="0.2 to 0.3 m",
        beyond="it counts from the middle of the track; where that bends, 'track' says: "
        "track: [{arc: 500 m, radius: 800 m, side: left}]",
    ),
]
Coordinate = Annotated[float, Quantity("m", ge=-100.0, le=100.0)]
TypeName = Annotated[
    str, Field(min_length=1, max_length=30, pattern=r"^[^/\\\x00-\x1f]+$"), Typical("push-off")
]
Hinge = Annotated[float, Quantity("m", ge=-20.0, le=20.0, typical="-3.2 m, 3.2 m")]
Values = tuple[float, ...]
LIKE_CONTACT = "contact"

HeightPerSupport = Annotated[
    Annotated[Height, Tag(SCALAR)] | Annotated[tuple[Height, ...], Tag(LIST)],
    Discriminator(form_of),
]
EncumbrancePerSupport = Annotated[
    Annotated[Encumbrance, Tag(SCALAR)] | Annotated[tuple[Encumbrance, ...], Tag(LIST)],
    Discriminator(form_of),
]
StaggerPerSupport = Annotated[
    Annotated[Stagger, Tag(SCALAR)] | Annotated[tuple[Stagger, ...], Tag(LIST)],
    Discriminator(form_of),
]


def _form_of_messenger_stagger(value: object) -> str:
    return LIKE_CONTACT if value == LIKE_CONTACT else form_of(value)


class Arm(Spec):
    """A steady arm: a bar with mass, hinged at its far end, on the pulling side of the wire."""

    catalogue_kinds: ClassVar[tuple[str, ...]] = ("steady arm",)

    length: Annotated[float, Quantity("m", gt=0.0, le=10.0, typical="0.9 to 1.3 m")] = Field(
        default=1.22, description="Distance from the far hinge to the contact wire, unstrained."
    )
    mass: Annotated[float, Quantity("kg/m", ge=0.0, le=20.0, typical="0.7 to 0.8 kg/m")] = Field(
        default=0.73, description="Mass per length; half the weight rests on the contact wire."
    )
    axial_stiffness: Annotated[float, Quantity("N", gt=0.0, le=1e10, typical="17 MN")] = Field(
        default=17e6, description="Axial stiffness EA."
    )
    motion: Literal["swinging", "vertical"] = Field(
        default="swinging",
        description="'swinging': the arm turns about its far end and so moves the wire sideways "
        "as it rises. 'vertical': it acts as its equivalent vertical spring (lateral pull over "
        "length) with a third of its mass, the wire held laterally, as in plane models.",
    )
    angle: Annotated[float, Quantity("rad", gt=-1.5, lt=1.5, typical="10 deg")] | None = Field(
        default=None,
        description="Closure 'arm' only: inclination that places the far end as seen from the "
        "nominal wire point (contact height and stagger), positive when the far end is higher.",
    )


class SupportSpring(Spec):
    """A vertical spring under the contact wire in place of a steady arm (closure 'spring').

    It is preloaded so that the wire lies at the contact height.
    """

    stiffness: Annotated[float, Quantity("N/m", ge=0.0, le=1e9, typical="200 to 300 N/m")] = Field(
        description="Vertical stiffness."
    )
    mass: Annotated[float, Quantity("kg", ge=0.0, le=100.0, typical="0 to 1 kg")] = Field(
        default=0.0, description="Mass that moves with the wire."
    )
    damping: Annotated[float, Quantity("N s/m", ge=0.0, le=1e6, typical="0")] = Field(
        default=0.0, description="Vertical damping."
    )


class UpliftStop(Spec):
    """A stop on the cantilever that a steady arm meets when the wire has risen by a gap.

    A spring that only pushes, normal to the plane of the rails.
    """

    gap: Annotated[float, Quantity("m", gt=0.0, le=1.0, typical="80 to 150 mm")] = Field(
        description="Rise of the contact wire from its design until the stop is met."
    )
    stiffness: Annotated[float, Quantity("N/m", gt=0.0, le=1e9, typical="50 to 500 kN/m")] = Field(
        default=1e5,
        description="Stiffness of stop and cantilever together; chosen, a tube in bending, no "
        "measured value is known.",
    )


class SupportType(Spec):
    """A kind of support: what differs from the supports at large where it stands."""

    name: TypeName = Field(description="Short name, by which supports.type places it.")
    arm: Arm | None = Field(default=None, description="Its steady arm.")
    stop: UpliftStop | None = Field(default=None, description="Its uplift stop.")
    clamp: Annotated[float, Quantity("kg", ge=0.0, le=20.0)] | None = Field(
        default=None, description="Mass of its steady-arm clamp."
    )
    lift: Annotated[float, Quantity("N", ge=-1e4, le=1e4)] | None = Field(
        default=None, description="Closure 'lift': vertical force of its arm."
    )
    share: Annotated[float, Quantity("", ge=0.0, le=1.0)] | None = Field(
        default=None, description="Closure 'lift', in place of lift: share of the contact wire."
    )
    messenger_stiffness: Annotated[float, Quantity("N/m", gt=0.0, le=1e12)] | None = Field(
        default=None, description="Vertical stiffness of its messenger-wire support."
    )
    messenger_damping: Annotated[float, Quantity("N s/m", ge=0.0, le=1e9)] | None = Field(
        default=None, description="Vertical damping of its messenger-wire support."
    )
    messenger_longitudinal: Literal["free", "fixed"] | None = Field(
        default=None, description="Whether it holds the messenger wire along the track."
    )
    cantilever: Cantilever | None = Field(
        default=None, description="Where its cantilever gives way, in place of the others'."
    )


class Supports(Spec):
    """The supports, numbered from 1 (left anchor) to spans + 1 (right anchor).

    The first and the last hold the wire ends and carry neither steady arm nor messenger spring.
    Lists have one value per support, both anchors included.
    """

    catalogue_kinds: ClassVar[tuple[str, ...]] = ("cantilever",)

    contact_height: HeightPerSupport = Field(
        default=5.3, description="Height of the contact wire at the supports, above the rails."
    )
    encumbrance: EncumbrancePerSupport | None = Field(
        default=None,
        description="Height of the messenger wire above the contact wire at the supports; needed "
        "with a messenger wire.",
    )
    contact_stagger: StaggerPerSupport = Field(
        default=0.0,
        description="Lateral position of the contact wire. A single value s alternates: +s at "
        "support 1, -s at support 2, and so on.",
    )
    messenger_stagger: Annotated[
        Annotated[Literal["contact"], Tag(LIKE_CONTACT)]
        | Annotated[Stagger, Tag(SCALAR)]
        | Annotated[tuple[Stagger, ...], Tag(LIST)],
        Discriminator(_form_of_messenger_stagger),
    ] = Field(
        default=LIKE_CONTACT,
        description="Lateral position of the messenger wire, in the same forms, or 'contact': "
        "above the contact wire.",
    )
    closure: Literal["height", "lift", "arm", "spring"] = Field(
        description="What is known about the contact wire at the supports: 'height' (its height; "
        "the arm is placed accordingly), 'lift' (the vertical force of the arm), 'arm' (the far "
        "end of the arm), or 'spring' (a preloaded vertical spring in place of the arm)."
    )
    lift: Annotated[float, Quantity("N", ge=-1e4, le=1e4, typical="0 to 60 N")] = Field(
        default=0.0,
        description="Closure 'lift': vertical force of the arm on the wire, its own half weight "
        "deducted; 0 lets the wire hang free.",
    )
    share: Annotated[float, Quantity("", ge=0.0, le=1.0, typical="0 to 0.5")] | None = Field(
        default=None,
        description="Closure 'lift', in place of lift: share of the contact wire, from the "
        "dropper before to the dropper behind the support, that the arm carries. Practice runs "
        "from next to nothing (what published uplifts fit) to half.",
    )
    arm: Arm = Field(default=Arm(), description="Steady arm, where no type has its own.")
    stop: UpliftStop | None = Field(
        default=None, description="Uplift stop, where no type has its own; none if left out."
    )
    types: tuple[SupportType, ...] = Field(
        default=(), description="Kinds of supports that differ from the others, by name."
    )
    type: tuple[TypeName | None, ...] | None = Field(
        default=None,
        description="Type of each support, both anchors included; null where what stands above "
        "holds.",
    )
    arm_end_y: tuple[Coordinate | None, ...] | None = Field(
        default=None,
        description="Closure 'arm': lateral position of the far end of each arm, instead of "
        "arm.angle; null at the anchors.",
    )
    arm_end_z: tuple[Coordinate | None, ...] | None = Field(
        default=None,
        description="Closure 'arm': height above the rails of the far end of each arm; null at "
        "the anchors.",
    )
    spring: SupportSpring | None = Field(
        default=None, description="Closure 'spring': the spring at every support."
    )
    clamp: Annotated[float, Quantity("kg", ge=0.0, le=20.0, typical="0 to 0.5 kg")] = Field(
        default=0.0, description="Mass of the steady-arm clamp on the contact wire."
    )
    messenger_stiffness: Annotated[float, Quantity("N/m", gt=0.0, le=1e12, typical="500 kN/m")] = (
        Field(default=5e5, description="Vertical stiffness of the messenger-wire support.")
    )
    messenger_damping: Annotated[float, Quantity("N s/m", ge=0.0, le=1e9, typical="1000 N s/m")] = (
        Field(default=1e3, description="Vertical damping of the messenger-wire support.")
    )
    messenger_longitudinal: Literal["free", "fixed"] = Field(
        default="free",
        description="Whether the messenger-wire supports swing freely along the track (hinged "
        "cantilevers) or hold the wire there after the static shape is found.",
    )

    hinge: (
        Annotated[
            Annotated[Hinge, Tag(SCALAR)] | Annotated[tuple[Hinge, ...], Tag(LIST)],
            Discriminator(form_of),
        ]
        | None
    ) = Field(
        default=None,
        description="Lateral position of the vertical axes at the masts about which cantilevers "
        "turn along the track, one for all or one per support: in conditions they take their share "
        "of the tension. Left out, cantilevers follow the wires without resistance.",
    )

    cantilever: Cantilever | None = Field(
        default=None,
        description="Where cantilevers give way elastically, where no type has its own; rigid if "
        "left out, but for messenger_stiffness.",
    )

    @model_validator(mode="after")
    def _check_closure(self) -> Supports:
        problems = []
        if self.closure == "spring" and self.spring is None:
            problems.append(
                Problem(
                    ("spring",),
                    "is missing: closure 'spring' needs it, for example "
                    "'spring: {stiffness: 300 N/m}'",
                )
            )
        if self.share is not None and (self.closure != "lift" or self.lift != 0.0):
            other = "lift" if self.closure == "lift" else f"closure '{self.closure}'"
            text = f"is given with {other}; it belongs to closure 'lift', in place of lift"
            problems.append(Problem(("share",), text))
        if (self.arm_end_y is None) != (self.arm_end_z is None):
            given = "arm_end_y" if self.arm_end_z is None else "arm_end_z"
            problems.append(
                Problem((given,), "arm_end_y and arm_end_z belong together: give both or neither")
            )
        elif self.closure == "arm" and self.arm_end_y is None and self.arm.angle is None:
            problems.append(
                Problem(
                    ("arm", "angle"),
                    "is missing: closure 'arm' needs arm.angle (for example '10 deg'), or "
                    "arm_end_y and arm_end_z for every support",
                )
            )
        refuse([*problems, *self._faults_of_types(), *self._faults_of_cantilevers()])
        return self

    def _faults_of_cantilevers(self) -> Iterator[Problem]:
        """Name what contradicts the cantilevers of the supports at large and of the types."""
        yield from _cantilever_faults(self)
        for index, one in enumerate(self.types):
            if one.cantilever is not None or one.arm is not None:
                faults = _cantilever_faults(_as_type(self, one))
                yield from (problem.under("types", index) for problem in faults)

    def _faults_of_types(self) -> Iterator[Problem]:
        """Name types there twice, places of unknown types, shares without their closure."""
        names = [one.name for one in self.types]
        for index, one in enumerate(self.types):
            if one.name in names[:index]:
                yield Problem(("types", index, "name"), f"{one.name!r} is there twice; rename one")
            if self.closure != "lift" and (one.share is not None or one.lift is not None):
                key = "share" if one.share is not None else "lift"
                text = f"belongs to closure 'lift'; the closure is '{self.closure}'"
                yield Problem(("types", index, key), text)
        for index, name in enumerate(self.type or ()):
            if name is not None and name not in names:
                known = f"one of {', '.join(names)}" if names else "described in supports.types"
                yield Problem(("type", index), f"got {name!r}; a type is {known}, or null")

    def at(self, index: int) -> Supports:
        """Return what holds at one support, from 0: the supports as its type has them."""
        name = None if self.type is None else self.type[index]
        found = [one for one in self.types if one.name == name]
        return _as_type(self, found[0]) if found else self

    def kinds(self) -> tuple[Supports, ...]:
        """Return the supports as every type in use between the anchors has them."""
        names = (None,) if self.type is None else self.type[1:-1]
        first = {name: index for index, name in reversed(list(enumerate(names, 1)))}
        return tuple(self.at(index) for index in sorted(first.values()))

    def contact_heights(self, supports: int) -> Values:
        """Return the contact height [m] at each of the supports."""
        return _per_support(self.contact_height, supports)

    def encumbrances(self, supports: int) -> Values:
        """Return the encumbrance [m] at each of the supports; 0 when there is none."""
        return _per_support(0.0 if self.encumbrance is None else self.encumbrance, supports)

    def hinges(self, supports: int) -> Values | None:
        """Return the lateral position of the hinges [m] at each of the supports, if given."""
        return None if self.hinge is None else _per_support(self.hinge, supports)

    def contact_staggers(self, supports: int) -> Values:
        """Return the stagger of the contact wire [m] at each of the supports."""
        return _alternating(self.contact_stagger, supports)

    def messenger_staggers(self, supports: int) -> Values:
        """Return the stagger of the messenger wire [m] at each of the supports."""
        if isinstance(self.messenger_stagger, str):
            return self.contact_staggers(supports)
        return _alternating(self.messenger_stagger, supports)


def _as_type(supports: Supports, one: SupportType) -> Supports:
    own = {name: value for name in type(one).model_fields
           if name != "name" and (value := getattr(one, name)) is not None}  # fmt: skip
    if one.share is not None:
        own["lift"] = 0.0
    elif one.lift is not None:
        own["share"] = None
    return supports.model_copy(update=own)


def _cantilever_faults(supports: Supports) -> Iterator[Problem]:
    """Name what the cantilever at a support cannot have beside what else is told of it."""
    cantilever = supports.cantilever
    if cantilever is None:
        return
    arm, messenger = cantilever.arm, cantilever.messenger
    if arm is not None and supports.closure == "spring":
        text = "needs a steady arm, and closure 'spring' has none; leave it out"
        yield Problem(("cantilever", "arm"), text)
    elif arm is not None and supports.arm.motion == "vertical":
        text = "is 'vertical': such an arm holds the wire laterally; take 'swinging'"
        yield Problem(("arm", "motion"), f"{text}, or leave out cantilever.arm")
    elif arm is not None and arm.mass + supports.arm.mass * supports.arm.length == 0.0:
        text = "is missing: neither the arm nor its heel has any; give one of them (8 kg)"
        yield Problem(("cantilever", "arm", "mass"), text)
    for name, one in (("arm", arm), ("messenger", messenger)):
        if one is not None and one.along is not None and supports.hinge is not None:
            text = "and supports.hinge both say what cantilevers take along the track; keep one"
            yield Problem(("cantilever", name, "along"), text)
    is_fixed = supports.messenger_longitudinal == "fixed"
    if messenger is not None and messenger.along is not None and is_fixed:
        text = "gives way, and messenger_longitudinal is 'fixed'; keep one of them"
        yield Problem(("cantilever", "messenger", "along"), text)


def check_cantilevers(wires: Wires, supports: Supports) -> list[Problem]:
    """Check that no cantilever holds a messenger wire that is not there."""
    own = [(("types", n), one.cantilever) for n, one in enumerate(supports.types)]
    text = "holds the messenger wire, and there is none; leave it out"
    return [
        Problem(("supports", *path, "cantilever", "messenger"), text)
        for path, one in [((), supports.cantilever), *own]
        if wires.messenger is None and one is not None and one.messenger is not None
    ]


def _per_support(value: float | Values, supports: int) -> Values:
    return value if isinstance(value, tuple) else (value,) * supports


def _alternating(value: float | Values, supports: int) -> Values:
    if isinstance(value, tuple):
        return value
    return tuple(value if number % 2 == 0 else -value for number in range(supports))


SHORTEST_CANTILEVER = 0.5
"""Least distance of a wire from the axis about which its cantilever turns [m]: real ones have 2 to
4 m, and a wire at the axis could not turn it."""


def check_hinges(line: Line, supports: Supports) -> list[Problem]:
    """Check that no wire stands at the axis about which its cantilever turns."""
    count = line.spans + 1
    hinges = supports.hinges(count)
    if hinges is None or len(hinges) != count:
        return []
    for wires in (supports.contact_staggers(count), supports.messenger_staggers(count)):
        for number, (hinge, y) in enumerate(zip(hinges, wires, strict=False), start=1):
            if abs(hinge - y) < SHORTEST_CANTILEVER:
                text = (
                    f"got {hinge:g} m at support {number}, where a wire stands at {y:g} m; the "
                    f"axis is at the mast, at least {SHORTEST_CANTILEVER:g} m away"
                )
                return [Problem(("supports", "hinge"), text)]
    return []
