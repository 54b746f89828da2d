"""Droppers: where they hang, what they hold, how stiff they are."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from tautwire.specs.base import LIST, TABLE, Problem, Quantity, Spec, form_of, refuse
from tautwire.specs.line.catenary import Line
from tautwire.specs.line.tension import TensionLength
from tautwire.specs.line.wire import Diameter, Expansion, Wires
from tautwire.units import UnitError, parse_quantity

MOST_DROPPERS = 200
"""Droppers of a span; built spans have up to twenty."""
Most = Field(max_length=MOST_DROPPERS)
Position = Annotated[float, Quantity("m", ge=-1000.0, le=1000.0, typical="4.5 m to 60 m")]
Presag = Annotated[float, Quantity("m", ge=-1.0, le=1.0, typical="0 to 60 mm")]
Length = Annotated[float, Quantity("m", gt=0.0, le=10.0, typical="0.3 to 2 m")]

Positions = Annotated[
    Annotated[tuple[Position, ...], Most, Tag(LIST)]
    | Annotated[tuple[Annotated[tuple[Position, ...], Most], ...], Tag(TABLE)],
    Discriminator(form_of),
]
Presags = Annotated[
    Annotated[tuple[Presag, ...], Most, Tag(LIST)]
    | Annotated[tuple[Annotated[tuple[Presag, ...], Most], ...], Tag(TABLE)],
    Discriminator(form_of),
]
Lengths = Annotated[
    Annotated[tuple[Length, ...], Most, Tag(LIST)]
    | Annotated[tuple[Annotated[tuple[Length, ...], Most], ...], Tag(TABLE)],
    Discriminator(form_of),
]
BySpan = tuple[tuple[float, ...], ...]


class DropperStiffness(Spec):
    """Stiffness of a taut dropper: of the whole dropper or per unit strain, exactly one."""

    spring: Annotated[float, Quantity("N/m", gt=0.0, le=1e12, typical="100 to 200 kN/m")] | None = (
        Field(default=None, description="Stiffness of every dropper, whatever its length.")
    )
    axial: Annotated[float, Quantity("N", gt=0.0, le=1e12, typical="200 kN")] | None = Field(
        default=None, description="Axial stiffness EA; a dropper of length L has EA/L."
    )

    @model_validator(mode="after")
    def _check_one_given(self) -> DropperStiffness:
        if (self.spring is None) == (self.axial is None):
            refuse([Problem((), "give exactly one of spring ('200 kN/m') and axial ('200 kN')")])
        return self

    def of_length(self, length: float) -> float:
        """Return the stiffness [N/m] of a dropper of the given unstrained length [m]."""
        return self.spring if self.spring is not None else (self.axial or 0.0) / length


def _stiffness_from_text(value: Any) -> Any:
    """Read ``"200 kN/m"`` (or a number) as a spring and ``"200 kN"`` as EA."""
    if not isinstance(value, (str, int, float)):
        return value
    try:
        return {"spring": parse_quantity(value, "N/m")}
    except UnitError as error:
        spring_error = error
    try:
        return {"axial": parse_quantity(value, "N")}
    except UnitError:
        raise UnitError(f"{spring_error}, or an axial stiffness EA, for example '200 kN'") from None


def _mode_from_word(value: Any) -> Any:
    """Accept the plurals ``heights`` and ``lengths``."""
    return (
        {"heights": "height", "lengths": "length"}.get(value, value)
        if (isinstance(value, str))
        else value
    )


class Droppers(Spec):
    """The droppers of the line, or one of several sets of them.

    Lists hold one value per dropper, left to right, valid in every span; or one such list per
    span. A set that counts from the supports (`about: mast`) has one list for all of them, or one
    list per support between the anchors.
    """

    catalogue_kinds: ClassVar[tuple[str, ...]] = ("dropper", "dropper clamps")

    from_: str | None = Field(
        default=None,
        alias="from",
        description="Name of the wire above; 'messenger' if left out.",
    )
    to: str | None = Field(
        default=None, description="Name of the wire below; 'contact' if left out."
    )
    tension_length: str | None = Field(
        default=None,
        description="Name of the only tension length in which they hang; in all if left out.",
    )
    about: Literal["span", "mast"] = Field(
        default="span",
        description="What positions count from: the support on the left of every 'span', or every "
        "support between the anchors ('mast'; negative on its left).",
    )

    mode: Annotated[
        Literal["height", "length"],
        BeforeValidator(
            _mode_from_word,
            json_schema_input_type=Literal["height", "length", "heights", "lengths"],
        ),
    ] = Field(
        default="height",
        description="What is prescribed: 'height' (presag; lengths are found) or 'length' "
        "(lengths; heights are found). The list of the other mode is not used.",
    )
    positions: Positions = Field(
        description="Distance of the droppers from the support on the left of their span, or from "
        "the support that 'about: mast' names."
    )
    presag: Presags | None = Field(
        default=None,
        description="Mode 'height': depth of the contact wire at the droppers below the straight "
        "line between the contact heights of the two supports, positive downwards. With a wire "
        "'to' other than 'contact' it may be left out: no pre-sag.",
    )
    lengths: Lengths | None = Field(
        default=None, description="Mode 'length': dropper lengths, clamp to clamp."
    )
    length_kind: Literal["unstrained", "stretched"] = Field(
        default="unstrained",
        description="Whether lengths are those of the unloaded or of the loaded dropper.",
    )
    stiffness: Annotated[
        DropperStiffness,
        BeforeValidator(
            _stiffness_from_text, json_schema_input_type=float | str | DropperStiffness
        ),
    ] = Field(
        description="Stiffness of a taut dropper: a spring ('200 kN/m', or a number in N/m) or "
        "an axial stiffness EA ('200 kN'). A slack dropper has none."
    )
    mass: Annotated[float, Quantity("kg/m", ge=0.0, le=10.0, typical="0.09 to 0.12 kg/m")] = Field(
        default=0.0, description="Mass per length; half of a dropper counts at each of its ends."
    )
    diameter: Diameter | None = Field(
        default=None,
        description="Outer diameter, which wind and ice meet; needed by conditions with either.",
    )
    thermal_expansion: Expansion | None = Field(
        default=None,
        description="Thermal expansion of the unstrained length; needed by conditions at another "
        "temperature.",
    )
    clamp_contact: Annotated[float, Quantity("kg", ge=0.0, le=10.0, typical="0.165 kg")] = Field(
        default=0.0, description="Mass of the clamp on the contact wire."
    )
    clamp_messenger: Annotated[float, Quantity("kg", ge=0.0, le=10.0, typical="0.195 kg")] = Field(
        default=0.0, description="Mass of the clamp on the messenger wire."
    )

    @model_validator(mode="after")
    def _check_prescribed_list(self) -> Droppers:
        name = "presag" if self.mode == "height" else "lengths"
        is_level = name == "presag" and self.to not in (None, "contact")
        if getattr(self, name) is None and not is_level:
            refuse(
                [
                    Problem(
                        (name,),
                        f"is missing: mode '{self.mode}' needs one value per dropper, in a list "
                        "for every span or in one list per span",
                    )
                ]
            )
        return self

    @property
    def upper(self) -> str:
        """Name of the wire above."""
        return self.from_ or "messenger"

    @property
    def lower(self) -> str:
        """Name of the wire below."""
        return self.to or "contact"

    def positions_by_span(self, spans: int) -> BySpan:
        """Return the positions [m] from the left support, one tuple per span."""
        return _by_span(self.positions, spans)

    def presag_by_span(self, spans: int) -> BySpan:
        """Return the pre-sags [m], one tuple per span; empty in mode 'length' without presag."""
        if self.presag is not None:
            return _by_span(self.presag, spans)
        positions = self.positions_by_span(spans) if self.mode == "height" else ()
        return tuple((0.0,) * len(row) for row in positions)

    def lengths_by_span(self, spans: int) -> BySpan:
        """Return the given lengths [m], one tuple per span; empty when none are given."""
        return () if self.lengths is None else _by_span(self.lengths, spans)


def _by_span(values: tuple[float, ...] | BySpan, spans: int) -> BySpan:
    rows = tuple(item for item in values if isinstance(item, tuple))
    if rows:
        return rows
    flat = tuple(item for item in values if not isinstance(item, tuple))
    return (flat,) * spans


def check_sets(
    line: Line,
    wires: Wires,
    droppers: Droppers | tuple[Droppers, ...],
    tension_lengths: tuple[TensionLength, ...],
) -> list[Problem]:
    """Check that sets name tension lengths of the line and hang where there is a wire above."""
    names, problems = [one.name for one in tension_lengths], []
    sets = enumerate(droppers) if isinstance(droppers, tuple) else [(None, droppers)]
    for index, one in sets:
        path = ("droppers",) if index is None else ("droppers", index)
        if one.tension_length is not None and one.tension_length not in names:
            there = f"there are {', '.join(names)}" if names else "the case has none by name"
            text = f"got {one.tension_length!r}; {there}"
            problems.append(Problem((*path, "tension_length"), text))
        problems += [
            Problem((*path, "positions"), text) for text in _beside_stitches(line, wires, one)
        ]
    return problems


def _beside_stitches(line: Line, wires: Wires, one: Droppers) -> list[str]:
    """Name the first dropper of a set in spans that hangs where no stitch wire is above."""
    above = dict(wires.named()).get(one.upper)
    if one.about != "span" or above is None or above.role != "stitch":
        return []
    low, high = above.from_ or 0.0, above.to or 0.0
    for span, row in enumerate(one.positions_by_span(line.spans)[: line.spans]):
        length = line.span_lengths()[span]
        for number, x in enumerate(row, 1):
            on_left, on_right = span > 0 and x <= high, span < line.spans - 1 and x >= length + low
            if not on_left and not on_right:
                return [
                    f"dropper {number} of span {span + 1} at {x:g} m hangs beside the stitch wires "
                    f"{one.upper!r}, which reach from {low:g} to {high:g} m about the supports "
                    "between the anchors"
                ]
    return []
