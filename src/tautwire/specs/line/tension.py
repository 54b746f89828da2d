"""Tension lengths: which masts a set of wires passes, how it ends, how neighbours overlap."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator

from tautwire.specs.base import Problem, Quantity, Spec, Typical, refuse
from tautwire.specs.line.catenary import Device, Ends, EndWord, Line, ends_from_word

MastNumber = Annotated[int, Field(ge=1, le=1001, strict=True)]

_SPANS = {"three-span": 3, "four-span": 4, "five-span": 5}


class TensionLength(Spec):
    """All wires from one anchor to the next.

    Exactly one place holds it along the track: an anchored end or a fixed point.
    """

    name: Annotated[
        str, Field(min_length=1, max_length=30, pattern=r"^[^/\\\x00-\x1f]+$"), Typical("T1")
    ] = Field(description="Short name, used in results.")
    masts: tuple[MastNumber, MastNumber] = Field(
        description="First and last support, [first, last], where the wires are anchored."
    )
    ends: Annotated[
        Ends, BeforeValidator(ends_from_word, json_schema_input_type=EndWord | Device | Ends)
    ] = Field(
        default=Ends(),
        description="How the wires end: 'anchored' (held) or 'weighted' (constant tension), "
        "for both ends or as {left: ..., right: ...}.",
    )
    fixed_point: MastNumber | None = Field(
        default=None,
        description="Support at which contact and messenger wires are held along the track "
        "(mid-point anchor); needed when both ends are weighted.",
    )

    @model_validator(mode="after")
    def _check_held_once(self) -> TensionLength:
        problems = []
        first, last = self.masts
        if last <= first + 1:
            text = f"got [{first}, {last}]; write [first, last], at least two spans apart"
            problems.append(Problem(("masts",), text))
        is_held = "anchored" in (self.ends.left, self.ends.right)
        if not is_held and self.fixed_point is None:
            text = (
                "is missing; with weights at both ends nothing else holds the wires along the track"
            )
            problems.append(Problem(("fixed_point",), text))
        if is_held and self.fixed_point is not None:
            text = "holds the wires along the track, and so does an anchored end; keep one of them"
            problems.append(Problem(("fixed_point",), text))
        elif self.fixed_point is not None and not first < self.fixed_point < last:
            text = f"got {self.fixed_point}; must lie between the supports {first} and {last}"
            problems.append(Problem(("fixed_point",), text))
        refuse(problems)
        return self


class Overlap(Spec):
    """How two tension lengths pass each other over the spans that they share.

    In the middle both contact wires run at their height. At the support before its anchor each of
    them is raised: it hangs there from its messenger wire, leaves the running height freely, under
    its own weight, and has no droppers from there to the anchor.
    """

    kind: Literal["three-span", "four-span", "five-span"] | None = Field(
        default=None,
        description="Number of spans that the two share, as a check; it follows from their masts.",
    )
    separation: Annotated[float, Quantity("m", ge=0.0, le=2.0, typical="0.2 to 0.5 m")] = Field(
        default=0.4, description="Lateral distance of the two systems where both are suspended."
    )
    rise: Annotated[float, Quantity("m", gt=0.0, le=2.0, typical="0.25 to 0.5 m")] = Field(
        default=0.5,
        description="Height of a contact wire above its running height at the support before its "
        "anchor.",
    )
    anchor_rise: Annotated[float, Quantity("m", gt=0.0, le=5.0, typical="0.8 to 1.5 m")] = Field(
        default=1.0, description="Height of a contact wire above its running height at its anchor."
    )

    def possible_spans(self) -> tuple[int, ...]:
        """Return how many spans the two tension lengths may share."""
        return (_SPANS[self.kind],) if self.kind else tuple(_SPANS.values())


def check_tension_lengths(
    line: Line, tension_lengths: tuple[TensionLength, ...], overlaps: tuple[Overlap, ...]
) -> list[Problem]:
    """Check that tension lengths follow each other, overlap and cover the line."""
    if not tension_lengths:
        text = "needs tension_lengths, which it joins"
        return [Problem(("overlaps",), text)] if overlaps else []
    supports, problems = line.spans + 1, []
    ends = (tension_lengths[0].masts[0], tension_lengths[-1].masts[1])
    if ends != (1, supports):
        text = f"reach from support {ends[0]} to {ends[1]}; the line has supports 1 to {supports}"
        problems.append(Problem(("tension_lengths",), text))
    names = [one.name for one in tension_lengths]
    problems += [
        Problem(("tension_lengths", number, "name"), f"got {name!r} again")
        for number, name in enumerate(names)
        if name in names[:number]
    ]
    joints = len(tension_lengths) - 1
    if len(overlaps) not in (0, 1, joints):
        text = f"has {len(overlaps)} entries for {joints} overlaps; give one for all, or one each"
        problems.append(Problem(("overlaps",), text))
    for number, (left, right) in enumerate(pairwise(tension_lengths), start=1):
        shared = left.masts[1] - right.masts[0]
        given = overlaps[min(number, len(overlaps)) - 1] if overlaps else Overlap()
        if shared not in given.possible_spans():
            text = (
                f"{right.name!r} shares {max(shared, 0)} spans with {left.name!r}; an overlap has "
                f"{' or '.join(str(n) for n in given.possible_spans())}"
            )
            problems.append(Problem(("tension_lengths", number, "masts"), text))
    return problems
