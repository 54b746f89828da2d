"""A strip of a plan: from one support to another, all zones below each other."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tautwire.report.figures.packing import simplified
from tautwire.report.layout_plan.alignment import Bend, Rise
from tautwire.report.layout_plan.content import PlanDropper, PlanWire, Stretch
from tautwire.report.layout_plan.items import (
    NORMAL,
    SMALL,
    Anchor,
    Drawing,
    cut_to,
    spread,
    text_width,
)
from tautwire.report.layout_plan.zones import (
    CLEAR,
    FAN,
    HEAD,
    PITCH,
    VALUES,
    Layout,
    Zone,
    droppers_between,
    end_labels,
    span_in_words,
    tick_step,
    zone_of_droppers,
)

Array = NDArray[np.float64]

TOLERANCE = 0.03
"""By how much a drawn wire may miss the wire [mm]: a sixth of the thinnest line."""
SIGN = 1.2
"""Half the size of a sign for an end or a mid-point anchor [mm]."""

_SIDE, _HEIGHT = 1, 2  # columns of the points of a wire


@dataclass(frozen=True)
class Piece:
    """A part of the line: its first and last support, from 0."""

    first: int
    last: int


class Strip:
    """Draws a part of a plan; x = 0 at its first support, y = 0 at its bottom.

    Parameters
    ----------
    layout
    piece
    """

    def __init__(self, layout: Layout, piece: Piece) -> None:
        self.layout, self.content, self.scale = layout, layout.content, layout.scale
        self.supports = self.content.supports[piece.first : piece.last + 1]
        self.start, self.end = self.supports[0].s, self.supports[-1].s
        self.width = self.x(self.end)
        self.zones = layout.zones
        self.drawing = Drawing()
        self.left_out = 0

    def x(self, s: float) -> float:
        """Return where a place along the track is [mm]."""
        return self.scale.x(s - self.start)

    def drawn(self) -> Drawing:
        """Return the drawing."""
        self._grid()
        self._stretches()
        self._views()
        self._droppers()
        self._supports()
        self._alignment()
        return self.drawing

    def _grid(self) -> None:
        """Draw edges and headings of the zones, and the supports through all of them."""
        top, right = self.layout.height, self.width + self.layout.tail
        for zone in self.zones.values():
            self.drawing.stroke("FRAME", [(-HEAD, zone.top), (right, zone.top)])
            lines = self._heading(zone.name)
            foot = 0.5 * (zone.bottom + zone.top) + 0.5 * PITCH * (len(lines) - 1) - 0.5 * SMALL
            for number, text in enumerate(lines):
                self._text(text, -HEAD + CLEAR, foot - PITCH * number)
        self.drawing.box("FRAME", (-HEAD, 0.0, HEAD + right, top))
        low, high = self.zones["curve"].top, self.zones["support"].top
        for support in self.supports:
            x = self.x(support.s)
            self.drawing.stroke("SUPPORTS", [(x, low), (x, high)])

    def _heading(self, name: str) -> Sequence[str]:
        """Return the lines of the heading of a zone."""
        across = f"1:{self.scale.across}"
        texts = {
            "overlaps": ("overlaps",),
            "stretches 0": ("tension lengths",),
            "stretches 1": (),
            "support": ("support",),
            "chainage": (self.content.chainage_heading,),
            "plan": ("plan [m]", across),
            "elevation": ("elevation", "above rail [m]", across),
            "span": ("span [m]",),
            "curve": ("curves",),
            "gradient": ("gradients",),
            **{key: (text,) for key, text in VALUES.items()},
        }
        if name in texts:
            return texts[name]
        wire, own = next(row for row in self.layout.dropper_rows if zone_of_droppers(row) == name)
        names = [
            one.name
            for one in self.content.stretches
            if one.row == own and one.name and one.end > self.start and one.start < self.end
        ]
        lines = (f"droppers of {wire}", ", ".join(names), "from support /", "length [m]")
        return [cut_to(line, HEAD - 2.0 * CLEAR) for line in lines if line]

    def _text(
        self, text: str, x: float, y: float, *, height: float = SMALL, anchor: Anchor = "start",
        is_upright: bool = False,
    ) -> None:  # fmt: skip
        self.drawing.text("TEXT", text, x, y, height=height, anchor=anchor, is_upright=is_upright)

    def _supports(self) -> None:
        for support in self.supports:
            x = self.x(support.s) + 0.5 * CLEAR
            zone = self.zones["support"]
            self._text(support.mark, x, zone.bottom + CLEAR, height=NORMAL)
            rows = {"chainage": support.chainage}
            rows |= {name: getattr(support, name) for name in self.layout.value_rows}
            for name, text in rows.items():
                self._text(text, x, _foot(self.zones[name]))
        for left, right in pairwise(self.supports):
            middle = 0.5 * (self.x(left.s) + self.x(right.s))
            text = span_in_words(right.s - left.s)
            self._text(text, middle, _foot(self.zones["span"]), anchor="middle")

    # ---- plan and elevation ----------------------------------------------------------------------

    def _views(self) -> None:
        scale, axis, rails = self.scale, self.layout.axis, self.layout.rails
        plan, elevation = self.zones["plan"], self.zones["elevation"]
        self.drawing.stroke("AXIS", [(0.0, axis), (self.width, axis)])
        self.drawing.stroke("TRACK", [(0.0, rails), (self.width, rails)])
        self._axis(plan, axis, self.layout.sides, _side_of_axis)
        self._axis(elevation, rails, (self.layout.bottom, self.layout.top), "{:g}".format)
        for zone, origin, column in ((plan, axis, _SIDE), (elevation, rails, _HEIGHT)):
            self._wires(zone, origin, column)
        for arm in self.content.arms:
            if self.start <= arm.s <= self.end:
                ends = [(self.x(arm.s), axis + scale.y(y)) for y in (arm.wire[0], arm.end[0])]
                self.drawing.stroke("ARMS", ends)
                self.drawing.ring("ARMS", ends[1], 0.5 * SIGN)
        for dropper in droppers_between(self.content, self.start, self.end):
            x = self.x(dropper.s)
            ends = [(x, rails + scale.y(z)) for z in (dropper.low, dropper.high)]
            self.drawing.stroke("DROPPERS", ends)

    def _axis(
        self, zone: Zone, origin: float, limits: tuple[float, float], named: Callable[[float], str]
    ) -> None:
        """Mark metres at the left of a view."""
        step = tick_step(self.scale.y(1.0))
        low, high = (round(value / step) for value in limits)
        for number in range(low, high + 1):
            y = origin + self.scale.y(number * step)
            if zone.bottom + 0.5 * SMALL <= y <= zone.top - 0.5 * SMALL:
                self.drawing.stroke("FRAME", [(-CLEAR, y), (0.0, y)])
                text = named(round(number * step, 6))
                self._text(text, -1.5 * CLEAR, y - 0.5 * SMALL, anchor="end")

    def _wires(self, zone: Zone, origin: float, column: int) -> None:
        """Draw the wires of a view, and name each where it leaves the strip or ends in it."""
        going_on: list[tuple[float, str, str]] = []
        ending: dict[float, list[tuple[float, str, str]]] = {}
        for wire in self.content.wires:
            s = wire.points[:, 0]
            if s[-1] <= self.start or s[0] >= self.end:
                continue
            points = self._on_paper(wire, origin, column)
            layer = wire.role.upper()
            self.drawing.stroke(layer, points)
            if wire.role == "stitch":
                continue
            x, y = points[-1]
            if s[-1] >= self.end:
                going_on.append((float(y) - 0.5 * SMALL, wire.name, layer))
            elif column == _HEIGHT:
                ending.setdefault(float(x), []).append((float(y), wire.name, layer))
        for x, names in ending.items():
            lowest = origin + self.scale.y(self.lowest(self.start + x / self.scale.x(1.0)))
            for number, (_, name, layer) in enumerate(sorted(names, reverse=True), start=1):
                foot = lowest - PITCH * number - CLEAR
                self.drawing.text(layer, f"{name} ends", x + CLEAR, foot)
        going_on.sort()
        feet = spread([y for y, _, _ in going_on], PITCH, zone.bottom + 0.5, zone.top - SMALL)
        for foot, (_, name, layer) in zip(feet.tolist(), going_on, strict=True):
            self.drawing.text(layer, name, self.width + CLEAR, foot)

    def lowest(self, s: float) -> float:
        """Return the height of the lowest wire at a place [m]."""
        return min(
            float(np.interp(s, wire.points[:, 0], wire.points[:, _HEIGHT]))
            for wire in self.content.wires
            if wire.points[0, 0] <= s <= wire.points[-1, 0]
        )

    def _on_paper(self, wire: PlanWire, origin: float, column: int) -> Array:
        points = wire.between(self.start, self.end)
        x = self.scale.x(1.0) * (points[:, 0] - self.start)
        return simplified(
            np.stack([x, origin + self.scale.y(1.0) * points[:, column]], 1), TOLERANCE
        )

    # ---- droppers --------------------------------------------------------------------------------

    def _droppers(self) -> None:
        """Write place and length of every dropper, below its place or beside it."""
        for row in self.layout.dropper_rows:
            for left, right in pairwise(self.supports):
                own = [d for d in droppers_between(self.content, left.s, right.s) if d.row == row]
                if own:
                    self._dropper_texts(own, (left.s, right.s), self.zones[zone_of_droppers(row)])

    def _dropper_texts(
        self, droppers: Sequence[PlanDropper], span: tuple[float, float], zone: Zone
    ) -> None:
        """Write the texts of a row and a span, and lead to those not below their dropper.

        One line along the zone's edge leads to all of them, because a line of its own for each
        would be a quarter of a DXF file.
        """
        low, high = self.x(span[0]) + PITCH, self.x(span[1]) - 0.5 * PITCH
        top, leader = zone.top, []
        places = spread([self.x(d.s) + 0.5 * SMALL for d in droppers], PITCH, low, high)
        for dropper, place in zip(droppers, places.tolist(), strict=True):
            self._text(dropper.text, place, zone.bottom + 0.5 * CLEAR, is_upright=True)
            x, end = self.x(dropper.s), (place - 0.5 * SMALL, top - FAN + 0.5 * CLEAR)
            if abs(end[0] - x) > TOLERANCE:
                leader += [(x, top), (x, top - 1.0), end, (x, top - 1.0), (x, top)]
        if leader:
            self.drawing.stroke("DROPPERS", leader)

    # ---- tension lengths -------------------------------------------------------------------------

    def _stretches(self) -> None:
        for stretch in self.content.stretches:
            if stretch.end > self.start and stretch.start < self.end:
                self._stretch(stretch, self.zones[f"stretches {stretch.row}"])
        for start, end, spans in self.content.overlaps:
            if end > self.start and start < self.end:
                zone = self.zones["overlaps"]
                left, right = self.x(max(start, self.start)), self.x(min(end, self.end))
                y = zone.bottom + 0.5
                ends = [(left, y), (left, y + 1.5), (right, y + 1.5), (right, y)]
                self.drawing.stroke("TENSION_LENGTHS", ends)
                self._fitting((f"overlap, {spans} spans", "overlap"), left, right, y + 2.2)

    def _stretch(self, stretch: Stretch, zone: Zone) -> None:
        left = self.x(max(stretch.start, self.start))
        right = self.x(min(stretch.end, self.end))
        y = 0.5 * (zone.bottom + zone.top)
        self.drawing.stroke("TENSION_LENGTHS", [(left, y), (right, y)])
        self._fitting(stretch.texts, left, right, y + 1.5)
        held = {stretch.start: stretch.is_held[0], stretch.end: stretch.is_held[1]}
        for s, text in end_labels(stretch):
            if not self.start <= s <= self.end:
                continue
            x, is_last = self.x(s), s == stretch.end
            kind = "mid-point" if s not in held else "anchored" if held[s] else "weighted"
            end_sign(self.drawing, (x, y), kind, -1 if is_last else 1)
            shift = -2.5 * SIGN if is_last else 2.5 * SIGN
            self._text(text, x + shift, y - 0.9 - SMALL, anchor="end" if is_last else "start")

    def _fitting(self, texts: Sequence[str], left: float, right: float, y: float) -> bool:
        """Write the longest of some texts that has room between two places, or none."""
        room = right - left - 2.0 * CLEAR
        text = next((text for text in texts if text_width(text) <= room), "")
        if text:
            self._text(text, 0.5 * (left + right), y, anchor="middle")
        return bool(text)

    # ---- the track -------------------------------------------------------------------------------

    def _alignment(self) -> None:
        curve, grade = self.zones["curve"], self.zones["gradient"]
        sharpest = max(max(map(abs, bend.curvature)) for bend in self.content.bends) or 1.0
        middle, size = curve.bottom + 8.5, 4.0
        self.drawing.stroke("SUPPORTS", [(0.0, middle), (self.width, middle)])
        along: list[tuple[float, float]] = []
        for bend in self.content.bends:
            places = self._part(bend.start, bend.end)
            if places is None:
                continue
            shares = np.interp(places, (bend.start, bend.end), bend.curvature) / sharpest
            ends = [
                (self.x(s), middle + size * share) for s, share in zip(places, shares, strict=True)
            ]
            along += ends
            self._described(bend, ends, curve)
        self.drawing.stroke("ALIGNMENT", along)
        for rise in self.content.rises:
            places = self._part(rise.start, rise.end)
            if places is None:
                continue
            slope = float(np.sign(round(1e3 * sum(rise.gradient), 2)))
            y = grade.bottom + 6.0
            ends = [(self.x(places[0]), y - slope), (self.x(places[1]), y + slope)]
            self.drawing.stroke("ALIGNMENT", ends)
            self._described(rise, ends, grade)

    def _part(self, start: float, end: float) -> tuple[float, float] | None:
        """Return the part of a stretch that the strip shows [m]."""
        low, high = max(start, self.start), min(end, self.end)
        return (low, high) if high > low else None

    def _described(
        self, piece: Bend | Rise, ends: Sequence[tuple[float, float]], zone: Zone
    ) -> None:
        """Mark the ends of a piece of the track, and say what it is."""
        (left, _), (right, _) = ends
        for s in (piece.start, piece.end):
            if self.start <= s <= self.end:
                x = self.x(s)
                self.drawing.stroke("ALIGNMENT", [(x, zone.bottom), (x, zone.bottom + 3.0)])
        if not self._fitting(piece.texts, left, right, zone.bottom + CLEAR):
            self.left_out += 1


def _foot(zone: Zone) -> float:
    return zone.bottom + 0.5 * (zone.height - SMALL)


def _side_of_axis(y: float) -> str:
    return f"{'L ' if y > 0.0 else 'R ' if y < 0.0 else ''}{abs(y):g}"


def end_sign(drawing: Drawing, at: tuple[float, float], kind: str, inwards: int) -> None:
    """Draw what ends or holds wires: a wall, hanging weights or a spring, or two crossed lines."""
    x, y = at
    if kind == "anchored":
        drawing.stroke("TENSION_LENGTHS", [(x, y - 1.5 * SIGN), (x, y + 1.5 * SIGN)])
        for step in (-1.0, 0.0, 1.0):
            foot = y + SIGN * step
            drawing.stroke("TENSION_LENGTHS", [(x, foot), (x - 0.8 * inwards, foot - 0.8)])
    elif kind == "mid-point":
        for sign in (-1.0, 1.0):
            ends = [(x - SIGN, y - sign * SIGN), (x + SIGN, y + sign * SIGN)]
            drawing.stroke("TENSION_LENGTHS", ends)
    else:
        drawing.ring("TENSION_LENGTHS", (x, y), 0.6 * SIGN)
        drawing.stroke("TENSION_LENGTHS", [(x, y - 0.6 * SIGN), (x, y - 1.4 * SIGN)])
        drawing.box("TENSION_LENGTHS", (x - 0.6 * SIGN, y - 2.6 * SIGN, 1.2 * SIGN, 1.2 * SIGN))
