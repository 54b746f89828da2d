"""The line as a whole: spans, wire ends, damping."""

from __future__ import annotations

from bisect import bisect_right
from itertools import accumulate
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

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
from tautwire.text import LONGEST_NAME

Travel = Annotated[float, Quantity("m", ge=0.0, le=20.0, typical="0.5 m to 2 m")]
SpanLength = Annotated[float, Quantity("m", ge=1.0, le=500.0, typical="40 to 65 m")]
EndWord = Literal["anchored", "weighted"]
MOST_SPANS = 1000
"""Spans of a line; a tension length has about twenty."""


class Damping(Spec):
    """Proportional damping C = mass * M + stiffness * K0 of wires, droppers and arms."""

    mass: Annotated[float, Quantity("1/s", ge=0.0, le=1e3, typical="0.0125 1/s")] = Field(
        default=0.0125, description="Factor of the mass matrix."
    )
    stiffness: Annotated[float, Quantity("s", ge=0.0, le=1.0, typical="1e-4 s")] = Field(
        default=1e-4,
        description="Factor of the tangent stiffness in the static state; the share of a dropper "
        "acts only while it is taut.",
    )


class Weights(Spec):
    """Weights on a tensioning wheel."""

    ratio: Annotated[float, Quantity("", ge=1.0, le=10.0, typical="3 or 5")] = Field(
        default=1.0, description="Travel of the weights per travel of the wire: 3 for a wheel 1:3."
    )
    efficiency: Annotated[float, Quantity("", gt=0.5, le=1.0, typical="0.95 to 0.98")] = Field(
        default=1.0,
        description="Efficiency of one direction: the wire pulls tension/efficiency where it lifts "
        "the weights and tension*efficiency where it lowers them. It acts in conditions; in a "
        "passage the tension stays what it was.",
    )
    rise: Travel | None = Field(
        default=None,
        description="How far the weights can rise from their place in the design; unlimited if "
        "left out.",
    )
    sink: Travel | None = Field(
        default=None,
        description="How far the weights can sink from their place in the design; unlimited if "
        "left out.",
    )
    inertia: bool = Field(
        default=False,
        description="Whether the mass of the weights, tension/(ratio*gravity), moves with the wire "
        "in a passage.",
    )


class TensionSpring(Spec):
    """A spring that tensions a wire."""

    stiffness: Annotated[float, Quantity("N/m", gt=0.0, le=1e8, typical="5 to 20 kN/m")] = Field(
        description="Loss of tension per travel of the end of the wire."
    )
    travel: Travel | None = Field(
        default=None,
        description="How far the end of the wire can move from its place in the design, either "
        "way; unlimited if left out.",
    )


class Device(Spec):
    """A tensioning device: weights or a spring, one for every wire that ends here."""

    weights: Weights | None = Field(default=None, description="Weights on a wheel.")
    spring: TensionSpring | None = Field(default=None, description="A spring.")

    @model_validator(mode="after")
    def _check_one_given(self) -> Device:
        if (self.weights is None) == (self.spring is None):
            refuse([Problem((), "give exactly one of weights and spring")])
        return self

    def __str__(self) -> str:
        return "sprung" if self.spring is not None else "weighted"


End = Annotated[
    Annotated[EndWord, Tag(SCALAR)] | Annotated[Device, Tag(MAPPING)], Discriminator(form_of)
]


class Ends(Spec):
    """How all wires end after the static shape is found."""

    left: End = Field(
        default="anchored",
        description="Held ('anchored'), under constant tension ('weighted'), or {weights: ...} or "
        "{spring: ...}.",
    )
    right: End = Field(
        default="anchored",
        description="Held ('anchored'), under constant tension ('weighted'), or {weights: ...} or "
        "{spring: ...}.",
    )


def ends_from_word(value: Any) -> Any:
    """Read one word, or one device, as that of both ends."""
    is_device = isinstance(value, dict) and not {"left", "right"} & value.keys() and value
    return {"left": value, "right": value} if isinstance(value, str) or is_device else value


class Line(Spec):
    """Spans, wire ends and damping of the line.

    A list of span lengths alone also sets the number of spans.
    """

    spans: Annotated[int, Field(ge=1, le=MOST_SPANS, strict=True), Typical("10 to 20")] = Field(
        description="Number of spans, from anchor to anchor."
    )
    span_length: Annotated[
        Annotated[SpanLength, Tag(SCALAR)] | Annotated[tuple[SpanLength, ...], Tag(LIST)],
        Discriminator(form_of),
    ] = Field(description="Length of every span, or a list with one length per span.")
    masts: tuple[Annotated[str, Field(max_length=LONGEST_NAME)], ...] | None = Field(
        default=None, description="Names of the supports from left to right, as people know them."
    )
    chainage: tuple[Annotated[float, Quantity("m", ge=-1e7, le=1e7)], ...] | None = Field(
        default=None, description="Chainage of the supports from left to right; rising or falling."
    )
    ends: Annotated[
        Ends, BeforeValidator(ends_from_word, json_schema_input_type=EndWord | Device | Ends)
    ] = Field(
        default=Ends(),
        description="How both wires end: 'anchored' (held) or 'weighted' (constant tension, "
        "free to move along the track), for both ends or as {left: ..., right: ...}.",
    )
    damping: Damping = Field(default=Damping(), description="Proportional damping.")
    gravity: Annotated[float, Quantity("m/s^2", gt=0.0, le=100.0, typical="9.81 m/s^2")] = Field(
        default=9.81, description="Acceleration of gravity."
    )

    @model_validator(mode="before")
    @classmethod
    def _count_spans(cls, data: Any) -> Any:
        if isinstance(data, dict) and "spans" not in data:
            lengths = data.get("span_length")
            if isinstance(lengths, (list, tuple)):
                return {**data, "spans": len(lengths)}
        return data

    @model_validator(mode="after")
    def _check_span_lengths(self) -> Line:
        problems = []
        if isinstance(self.span_length, tuple) and len(self.span_length) != self.spans:
            problems.append(
                Problem(
                    ("span_length",),
                    f"has {len(self.span_length)} values for {self.spans} spans; give one "
                    "length per span, or a single length for all, or leave out line.spans",
                )
            )
        for name in ("masts", "chainage"):
            given = getattr(self, name)
            if given is not None and len(given) != self.spans + 1:
                problems.append(
                    Problem(
                        (name,),
                        f"has {len(given)} values; give one for each of the {self.spans + 1} "
                        "supports",
                    )
                )
        refuse(problems)
        return self

    def span_lengths(self) -> tuple[float, ...]:
        """Return the length of each span [m]."""
        if isinstance(self.span_length, tuple):
            return self.span_length
        return (self.span_length,) * self.spans

    def support_positions(self) -> tuple[float, ...]:
        """Return the position of each support [m]; the left anchor is at 0."""
        return tuple(accumulate(self.span_lengths(), initial=0.0))

    def distance(self, chainage: float) -> float:
        """Return how far from support 1 a chainage lies [m].

        Between supports whose chainages are given the way is shared out evenly, so that a jump of
        the chainage stays in its span; beyond the ends it is counted on.
        """
        if self.chainage is None:
            return chainage
        s, sign = self.support_positions(), 1.0 if self.chainage[-1] > self.chainage[0] else -1.0
        given = [sign * value for value in self.chainage]
        span = min(max(bisect_right(given, sign * chainage) - 1, 0), self.spans - 1)
        way = sign * chainage - given[span]
        gap = given[span + 1] - given[span]
        if way < 0.0 or gap <= 0.0:
            return s[span] + way
        return (
            s[span + 1] + way - gap if way > gap else s[span] + way / gap * (s[span + 1] - s[span])
        )

    def chainage_at(self, s: float) -> float:
        """Return the chainage of a place, the reverse of :meth:`distance` [m]."""
        if self.chainage is None:
            return s
        masts = self.support_positions()
        span = min(max(bisect_right(masts, s) - 1, 0), self.spans - 1)
        share = (s - masts[span]) / (masts[span + 1] - masts[span])
        if not 0.0 <= share <= 1.0:
            sign = 1.0 if self.chainage[-1] > self.chainage[0] else -1.0
            end = span if share < 0.0 else span + 1
            return self.chainage[end] + sign * (s - masts[end])
        return self.chainage[span] + share * (self.chainage[span + 1] - self.chainage[span])

    def support_marks(self) -> tuple[str, ...]:
        """Return what stands at each support in a drawing: its mast, or else its number from 1."""
        return self.masts or tuple(str(number) for number in range(1, self.spans + 2))

    def place_of_support(self, index: int) -> str:
        """Name a support by its mast and chainage, as in "mast 4/12, km 12.624"; or nothing."""
        parts = []
        if self.masts is not None:
            parts.append(f"mast {self.masts[index]}")
        if self.chainage is not None:
            parts.append(f"km {self.chainage[index] / 1e3:.3f}")
        return ", ".join(parts)

    def support_in_words(self, number: int) -> str:
        """Name a support by its number, from 1, and by mast and chainage where it has them."""
        return ", ".join(filter(None, (f"support {number}", self.place_of_support(number - 1))))

    def span_in_words(self, number: int) -> str:
        """Name a span by its number, from 1, and by its support on the left if that has a name."""
        place = self.place_of_support(number - 1)
        return f"span {number} (from {place})" if place else f"span {number}"

    def length(self) -> float:
        """Return the distance between the two anchors [m]."""
        return self.support_positions()[-1]
