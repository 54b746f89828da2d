"""How a strip of a plan is divided: zones below each other, and what texts ask of the scale."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

from tautwire.report.layout_plan.content import Content, PlanDropper, Stretch, Support
from tautwire.report.layout_plan.items import NORMAL, text_width
from tautwire.report.layout_plan.scale import Scale

CLEAR = 1.2
"""Space between texts of a row, and between a text and a line beside it [mm]: two thirds of the
height of a capital, the space between two words."""
PITCH = 2.6
"""Distance of the feet of texts that stand beside each other [mm]: capitals of 1.8 mm and air."""
ROW = 5.0
"""Height of a row of values [mm]."""
HEAD = 38.0
"""Width of the column of headings [mm]: that of "height above rail [m]" and the axis beside it."""
BAR = 8.0
"""Height of the row of a tension length [mm]: a line with a text above and below."""
FAN = 4.0
"""Height in which leaders go from droppers to their texts [mm]."""
MARGIN = 3.0
"""Space around what is drawn to scale [mm]."""
CURVE, GRADE = 14.0, 9.0
"""Heights of the bands of curves and gradients [mm]: a line that bends, and a row of texts."""


MID_POINT = "mid-point anchor"
VALUES = {
    "stagger": "stagger [mm]",
    "height": "height above rail [m]",
    "encumbrance": "encumbrance [m]",
}
"""Rows of values at the supports, and their headings."""


@dataclass(frozen=True)
class Zone:
    """A part of a strip: its name, bottom and height [mm]."""

    name: str
    bottom: float
    height: float

    @property
    def top(self) -> float:
        """Upper edge [mm]."""
        return self.bottom + self.height


def end_labels(stretch: Stretch) -> Iterator[tuple[float, str]]:
    """Yield the places of the texts below the line of a tension length, from left to right [m]."""
    yield stretch.start, stretch.ends[0]
    if stretch.middle is not None:
        yield stretch.middle, MID_POINT
    yield stretch.end, stretch.ends[1]


@dataclass(frozen=True)
class Layout:
    """A plan at a scale, before it is cut into strips.

    Attributes
    ----------
    content : Content
    scale : Scale
    """

    content: Content
    scale: Scale

    @cached_property
    def dropper_rows(self) -> tuple[tuple[str, int], ...]:
        """Rows of droppers, in order."""
        return tuple(sorted({dropper.row for dropper in self.content.droppers}))

    @cached_property
    def value_rows(self) -> tuple[str, ...]:
        """Rows of values that have any."""
        supports = self.content.supports
        return tuple(name for name in VALUES if any(getattr(one, name) for one in supports))

    @cached_property
    def sides(self) -> tuple[float, float]:
        """Lateral positions between which wires, arms and the axis lie [m]."""
        wires = [points.points[:, 1] for points in self.content.wires]
        arms = [y for arm in self.content.arms for y in (arm.wire[0], arm.end[0])]
        return (
            min([0.0, *arms, *(float(y.min()) for y in wires)]),
            max([0.0, *arms, *(float(y.max()) for y in wires)]),
        )

    @cached_property
    def top(self) -> float:
        """Height of the highest wire above the rails [m]."""
        return max(float(wire.points[:, 2].max()) for wire in self.content.wires)

    @cached_property
    def bottom(self) -> float:
        """Height of the lowest wire, or of the rails where that is lower [m]."""
        return min(0.0, min(float(wire.points[:, 2].min()) for wire in self.content.wires))

    @cached_property
    def zones(self) -> dict[str, Zone]:
        """The zones by name; their bottom is 0."""
        heights = list(self._heights())
        bottom = sum(height for _, height in heights)
        found = {}
        for name, height in heights:
            bottom -= height
            found[name] = Zone(name, bottom, height)
        return found

    def _heights(self) -> Iterator[tuple[str, float]]:
        """Yield names and heights of the zones from top to bottom."""
        content, scale = self.content, self.scale
        if content.overlaps:
            yield "overlaps", ROW
        for row in range(1 + max(one.row for one in content.stretches)):
            yield f"stretches {row}", BAR
        yield "support", ROW
        yield "chainage", ROW
        right, left = self.sides
        yield "plan", scale.y(left - right) + 2.0 * MARGIN
        yield "elevation", scale.y(self.top - self.bottom) + 2.0 * MARGIN
        for row in self.dropper_rows:
            texts = [text_width(one.text) for one in content.droppers if one.row == row]
            yield zone_of_droppers(row), FAN + max(texts) + CLEAR
        yield "span", ROW
        for name in self.value_rows:
            yield name, ROW
        yield "curve", CURVE
        yield "gradient", GRADE

    @property
    def axis(self) -> float:
        """Height of the axis of the plan in a strip [mm]."""
        return self.zones["plan"].bottom + MARGIN - self.scale.y(self.sides[0])

    @property
    def rails(self) -> float:
        """Height of the rails of the elevation in a strip [mm]."""
        return self.zones["elevation"].bottom + MARGIN - self.scale.y(self.bottom)

    @property
    def height(self) -> float:
        """Of a strip [mm]."""
        return next(iter(self.zones.values())).top

    @property
    def tail(self) -> float:
        """Width beside the last support of a strip, for texts that begin there [mm]."""
        names = [text_width(wire.name) for wire in self.content.wires if wire.role != "stitch"]
        return max(*names, *map(support_width, self.content.supports)) + 2.0 * CLEAR


def zone_of_droppers(row: tuple[str, int]) -> str:
    """Return the name of the zone of a row of droppers."""
    return f"droppers {row[1]} of {row[0]}"


def support_width(support: Support) -> float:
    """Return the width of the widest text at a support [mm]."""
    values = [support.chainage, *(getattr(support, name) for name in VALUES)]
    return max(text_width(support.mark, NORMAL), *map(text_width, values))


def coarsest(content: Content) -> float:
    """Return the largest scale number along the track at which all texts stand clear."""
    return min(1e3 * way / needed for way, needed in _needs(content) if needed > 0.0)


def _needs(content: Content) -> Iterator[tuple[float, float]]:
    """Yield ways along the track [m] and the widths that texts need there [mm]."""
    for left, right in pairwise(content.supports):
        span = right.s - left.s
        yield span, support_width(left) + 2.0 * CLEAR
        yield span, text_width(span_in_words(span)) + 2.0 * CLEAR
        yield from ((span, need) for need in _dropper_needs(content, left.s, right.s))
    for stretch in content.stretches:
        for (at, text), (after, other) in pairwise(end_labels(stretch)):
            both = text_width(text) + (text_width(other) if after == stretch.end else 0.0)
            yield after - at, both + 6.0 * CLEAR


def _dropper_needs(content: Content, left: float, right: float) -> Iterable[float]:
    """Return the width that the droppers of a span need, row by row [mm]."""
    counts: dict[tuple[str, int], int] = {}
    for dropper in droppers_between(content, left, right):
        counts[dropper.row] = counts.get(dropper.row, 0) + 1
    return [(count + 1) * PITCH for count in counts.values()]


def droppers_between(content: Content, left: float, right: float) -> Sequence[PlanDropper]:
    """Return the droppers from one place to another, those at the second not included [m]."""
    places = content.dropper_places
    return content.droppers[bisect_left(places, left) : bisect_left(places, right)]


def span_in_words(span: float) -> str:
    """Return a length of a span [m], without zeros that say nothing."""
    return f"{span:.3f}".rstrip("0").rstrip(".")


def tick_step(per_metre: float) -> float:
    """Return the step of an axis whose marks stand at least 8 mm apart [m].

    Parameters
    ----------
    per_metre
        Length of a metre on the paper [mm].
    """
    least = 8.0 / per_metre  # three heights of their texts and air
    power = 10.0 ** math.floor(math.log10(least))
    return next(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= least - 1e-12)
