"""The track under the line: straights, transitions and arcs, or a table; heights of the rails."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, model_validator

from tautwire.specs.base import Problem, Quantity, Spec, refuse
from tautwire.specs.line.catenary import Line
from tautwire.specs.pantograph import Pantograph

Length = Annotated[float, Quantity("m", gt=0.0, le=1e6, typical="20 to 1000 m")]
Place = Annotated[float, Quantity("m", ge=-1e7, le=1e7)]
Radius = Annotated[float, Quantity("m", ge=-1e9, le=1e9, typical="300 to 5000 m")]
Cant = Annotated[float, Quantity("m", ge=-0.3, le=0.3, typical="0 to 180 mm")]
Altitude = Annotated[float, Quantity("m", ge=-1e4, le=1e4)]

SMALLEST_RADIUS = 20.0
"""Tightest curve of any railway with an overhead line [m]; trams turn on about this radius."""


class TrackPiece(Spec):
    """A straight, a transition or an arc."""

    straight: Length | None = Field(default=None, description="Length of a straight.")
    transition: Length | None = Field(
        default=None,
        description="Length of a transition (clothoid): curvature and cant change evenly from the "
        "piece before to the piece after.",
    )
    arc: Length | None = Field(default=None, description="Length of an arc.")
    radius: Radius | None = Field(default=None, description="Radius of an arc.")
    side: Literal["left", "right"] | None = Field(
        default=None, description="Side to which an arc turns, seen along rising chainage."
    )
    cant: Cant = Field(default=0.0, description="Height of the outer rail above the inner one.")

    @model_validator(mode="after")
    def _check_kind(self) -> TrackPiece:
        names = [n for n in ("straight", "transition", "arc") if getattr(self, n) is not None]
        if len(names) != 1:
            what = f"is {' and '.join(names)}" if names else "has no kind"
            text = f"{what}; write one of straight, transition and arc with its length"
            refuse([Problem((), text)])
        refuse(list(_faults_of_arc(self) if self.arc is not None else _faults_of_other(self)))
        return self

    @property
    def length(self) -> float:
        """Length [m]."""
        return self.straight or self.transition or self.arc or 0.0

    @property
    def bend(self) -> tuple[float, float]:
        """Curvature [1/m] and cant [m] of a straight or an arc, positive to the left."""
        if self.radius is None:
            return 0.0, 0.0
        sign = 1.0 if self.side == "left" else -1.0
        return sign / self.radius, sign * self.cant


def _faults_of_arc(piece: TrackPiece) -> Iterator[Problem]:
    if piece.radius is None:
        yield Problem(("radius",), "is missing; an arc needs its radius, for example 1200 m")
    elif piece.radius < 0.0:
        text = f"got {piece.radius:g} m; a radius is positive, and side tells left from right"
        yield Problem(("radius",), text)
    elif piece.radius < SMALLEST_RADIUS:
        text = f"got {piece.radius:g} m; must be at least {SMALLEST_RADIUS:g} m"
        yield Problem(("radius",), text)
    if piece.side is None:
        yield Problem(("side",), "is missing; say to which side the arc turns: left or right")
    if piece.cant < 0.0:
        text = f"got {1e3 * piece.cant:g} mm; cant is the height of the outer rail: give its size"
        yield Problem(("cant",), text)


def _faults_of_other(piece: TrackPiece) -> Iterator[Problem]:
    for name in ("radius", "side"):
        if getattr(piece, name) is not None:
            text = "belongs to an arc; a transition takes what it needs from its neighbours"
            yield Problem((name,), text)
    if piece.cant != 0.0:
        yield Problem(("cant",), "belongs to an arc; transitions lead to it evenly")


class ProfilePoint(Spec):
    """A point at which the gradient of the rails changes."""

    at: Place = Field(description="Distance along the track from support 1.")
    height: Altitude = Field(description="Height of the rails where the gradients meet.")
    radius: Annotated[float, Quantity("m", ge=0.0, le=1e9, typical="2 to 30 km")] = Field(
        default=0.0, description="Radius of the vertical curve that rounds the change of gradient."
    )


def track_from_pieces(value: Any) -> Any:
    """Read a list as that of the pieces."""
    return {"pieces": value} if isinstance(value, (list, tuple)) else value


class Track(Spec):
    """The track, straight and level where nothing is said.

    Either pieces from support 1 on, or columns over the chainage, all of one length, between whose
    rows curvature and cant change evenly. Left is the side to the left of rising distance.
    """

    table_columns: ClassVar[tuple[str, ...]] = ("chainage", "radius", "cant", "height")
    optional_columns: ClassVar[tuple[str, ...]] = ("radius", "cant", "height")

    pieces: tuple[TrackPiece, ...] = Field(
        default=(), description="Straights, transitions and arcs, one after the other."
    )
    profile: tuple[ProfilePoint, ...] = Field(
        default=(), description="Points of the gradient; with pieces, or alone on straight track."
    )
    chainage: tuple[Place, ...] | None = Field(
        default=None,
        description="Chainage of each row, rising: counted as line.chainage does, from support 1 "
        "without one.",
    )
    radius: tuple[Radius, ...] | None = Field(
        default=None,
        description="Radius at each row, positive where the curve turns left along rising "
        "chainage, negative to the right, 0 on straight track.",
    )
    cant: tuple[Cant, ...] | None = Field(
        default=None,
        description="Cant at each row, with the sign of the radius where the outer rail is higher; "
        "none if left out.",
    )
    height: tuple[Altitude, ...] | None = Field(
        default=None, description="Height of the rails at each row; level if left out."
    )
    rail_distance: Annotated[float, Quantity("m", gt=0.5, le=2.5, typical="1.5 m")] = Field(
        default=1.5,
        description="Distance between the middles of the rail heads, over which cant is measured "
        "(1.5 m for a gauge of 1435 mm).",
    )

    @model_validator(mode="after")
    def _check_pieces_and_rows(self) -> Track:
        columns = [name for name in self.table_columns if getattr(self, name) is not None]
        if columns and (self.pieces or self.profile):
            given = "pieces" if self.pieces else "profile"
            text = f"is given as well as the columns {', '.join(columns)}; keep one description"
            refuse([Problem((given,), text)])
        problems = [*_faults_of_neighbours(self.pieces), *_faults_of_profile(self.profile)]
        if columns:
            problems += _faults_of_rows(self)
        refuse(problems)
        return self

    @property
    def is_straight_and_level(self) -> bool:
        """Whether nothing is said."""
        return not self.pieces and not self.profile and self.chainage is None


def _faults_of_neighbours(pieces: tuple[TrackPiece, ...]) -> Iterator[Problem]:
    """Yield transitions that lead nowhere, and places where the cant would jump."""
    for number, piece in enumerate(pieces):
        around = pieces[max(number - 1, 0) : number] + pieces[number + 1 : number + 2]
        if piece.transition is None:
            after = pieces[number + 1 : number + 2]
            if after and after[0].transition is None and after[0].bend[1] != piece.bend[1]:
                before, behind = (1e3 * abs(one.cant) for one in (piece, after[0]))
                yield Problem(
                    ("pieces", number + 1, "cant"),
                    f"jumps from {before:g} mm to {behind:g} mm; put a transition between the two "
                    "pieces",
                )
        elif len(around) < 2 or any(one.transition is not None for one in around):
            yield Problem(
                ("pieces", number, "transition"),
                "needs a straight or an arc on either side, whose curvatures it joins; add it",
            )


def _faults_of_profile(points: tuple[ProfilePoint, ...]) -> Iterator[Problem]:
    if len(points) == 1:
        yield Problem(("profile",), "has one point; a gradient needs two")
    for number, (left, right) in enumerate(pairwise(points)):
        if right.at <= left.at:
            text = f"got {right.at:g} m after {left.at:g} m; must increase"
            yield Problem(("profile", number + 1, "at"), text)
            return
        if abs(right.height - left.height) > STEEPEST * (right.at - left.at):
            yield Problem(
                ("profile", number + 1, "height"),
                f"rises by {right.height - left.height:g} m over {right.at - left.at:g} m; at most "
                f"{1e3 * STEEPEST:g} per mille are possible",
            )
            return
    yield from _faults_of_roundings(points)


STEEPEST = 0.15
"""Steepest gradient with an overhead line, with room: adhesion railways reach 110 per mille."""

SAME_GRADIENT = 1e-9
"""Change of gradient below which nothing needs rounding."""


def _faults_of_roundings(points: tuple[ProfilePoint, ...]) -> Iterator[Problem]:
    """Yield changes of gradient without a vertical curve, and curves that run into each other."""
    end = -float("inf")
    for number, point in enumerate(points):
        change = change_of_gradient(points, number)
        if abs(change) > SAME_GRADIENT and point.radius == 0.0:
            text = f"is missing; the gradient changes by {1e3 * change:.2f} per mille here"
            yield Problem(("profile", number, "radius"), text)
        half = 0.5 * point.radius * abs(change)
        limits = points[max(number - 1, 0)].at, points[min(number + 1, len(points) - 1)].at
        if half > 0.0 and (point.at - half < max(end, limits[0]) or point.at + half > limits[1]):
            yield Problem(
                ("profile", number, "radius"),
                f"gives a vertical curve of {2.0 * half:.1f} m, which runs into its neighbour; "
                "make the radius smaller or the points further apart",
            )
        end = point.at + half


def change_of_gradient(points: tuple[ProfilePoint, ...], number: int) -> float:
    """Return by how much the gradient changes at a point of a profile; 0 at the first and last."""
    if not 0 < number < len(points) - 1:
        return 0.0
    left, here, right = points[number - 1 : number + 2]
    before = (here.height - left.height) / (here.at - left.at)
    return (right.height - here.height) / (right.at - here.at) - before


def _faults_of_rows(track: Track) -> Iterator[Problem]:
    places = track.chainage
    if places is None:
        yield Problem(("chainage",), "is missing; the other columns are given over it")
        return
    if len(places) < 2:
        yield Problem(("chainage",), "has one row; give at least the first and the last place")
    for name in ("radius", "cant", "height"):
        values = getattr(track, name)
        if values is not None and len(values) != len(places):
            text = f"has {len(values)} values for {len(places)} rows; give one per row"
            yield Problem((name,), text)
            return
    for row, (left, right) in enumerate(pairwise(places), start=1):
        if right <= left:
            text = f"got {right:g} m after {left:g} m; must increase"
            yield Problem(("chainage", row), text)
            return
    yield from _faults_of_values(track, places)


def _faults_of_values(track: Track, places: tuple[float, ...]) -> Iterator[Problem]:
    radii = track.radius or (0.0,) * len(places)
    for row, radius in enumerate(radii):
        if 0.0 < abs(radius) < SMALLEST_RADIUS:
            text = f"got {radius:g} m; its size must be at least {SMALLEST_RADIUS:g} m, or 0"
            yield Problem(("radius", row), text)
        if track.cant is not None and radius * track.cant[row] < 0.0:
            yield Problem(
                ("cant", row),
                f"got {1e3 * track.cant[row]:g} mm in a curve of {radius:g} m, which raises the "
                "inner rail; give cant the sign of the radius",
            )
    for row, (left, right) in enumerate(pairwise(places), start=1):
        heights = track.height or (0.0,) * len(places)
        if abs(heights[row] - heights[row - 1]) > STEEPEST * (right - left):
            yield Problem(
                ("height", row),
                f"rises by {heights[row] - heights[row - 1]:g} m over {right - left:g} m; at most "
                f"{1e3 * STEEPEST:g} per mille are possible",
            )


@dataclass(frozen=True)
class _Stretch:
    """Part of a track: curvatures at both ends [1/m], positive to the left, and its path."""

    start: float
    end: float
    bends: tuple[float, float]
    path: tuple[str | int, ...]

    @property
    def radius(self) -> float:
        """Smallest radius [m]."""
        sharpest = max(abs(bend) for bend in self.bends)
        return 1.0 / sharpest if sharpest else math.inf

    @property
    def turn(self) -> float:
        """By how much the track turns to the left [rad]."""
        return 0.5 * sum(self.bends) * (self.end - self.start)


def _stretches(track: Track, line: Line) -> list[_Stretch]:
    if track.chainage is None:
        ends = list(accumulate((piece.length for piece in track.pieces), initial=0.0))
        bends = [piece.bend[0] for piece in track.pieces]
        found = []
        for number, (piece, (start, end)) in enumerate(
            zip(track.pieces, pairwise(ends), strict=True)
        ):
            own = bends[number], bends[number]
            if piece.transition is not None:
                own = bends[number - 1], bends[number + 1]
            found.append(_Stretch(start, end, own, ("pieces", number)))
        return found
    places = [line.distance(place) for place in track.chainage]
    rows = [1.0 / radius if radius else 0.0 for radius in track.radius or (0.0,) * len(places)]
    return [
        _Stretch(min(ends), max(ends), own, ("radius", row))
        for row, (ends, own) in enumerate(zip(pairwise(places), pairwise(rows), strict=True))
    ]


def check_track(line: Line, track: Track, pantographs: Sequence[Pantograph]) -> list[Problem]:
    """Check that the track reaches under the whole line, and its curves against the spans."""
    stretches, length = _stretches(track, line), line.length()
    if not stretches:
        return []
    start = min(stretch.start for stretch in stretches)
    end = max(stretch.end for stretch in stretches)
    if start > _SAME_PLACE or end < length - _SAME_PLACE:
        what = (
            f"reaches from {start:.6g} m to {end:.6g} m of the line, which is {length:.6g} m long"
        )
        text = f"{what}; describe the track from support 1 to support {line.spans + 1}"
        return [Problem(("track", "pieces" if track.pieces else "chainage"), text)]
    headings = list(accumulate((stretch.turn for stretch in stretches), initial=0.0))
    turn = math.degrees(max(headings) - min(headings))
    if turn > LARGEST_TURN:
        text = (
            f"turns by {turn:.0f} degrees; a plane across the track would meet a wire twice: "
            f"describe at most {LARGEST_TURN:g} degrees at once, as lines of their own"
        )
        return [Problem(("track",), text)]
    head = min(pantograph.head_length for pantograph in pantographs)
    return list(_faults_of_spans(line, stretches, head))


def _faults_of_spans(line: Line, stretches: list[_Stretch], head: float) -> Iterator[Problem]:
    """Yield the curves in which a wire along a chord cannot stay on the head: L^2/8R too large."""
    spans = list(pairwise(line.support_positions()))
    for stretch in stretches:
        own = [
            (right - left, number)
            for number, (left, right) in enumerate(spans, start=1)
            if left < stretch.end and stretch.start < right
        ]
        longest, number = max(own, default=(0.0, 0))
        inside = longest**2 / (8.0 * stretch.radius)
        if inside > head:
            most = math.floor(math.sqrt(8.0 * stretch.radius * head))
            yield Problem(
                ("track", *stretch.path),
                f"the radius of {stretch.radius:g} m is too small for span {number}: the wire runs "
                f"{inside:.2f} m inside the arc in the middle of its {longest:g} m, more than the "
                f"head is long ({head:g} m); make the spans at most {most} m long "
                "(line.span_length)",
            )


LARGEST_TURN = 150.0
"""Largest turn of a track under one line [degrees]: at 180 its ends run side by side."""

_SAME_PLACE = 1e-6
"""Distance below which two places of a track are one [m]."""

TrackInput = Annotated[
    Track,
    BeforeValidator(track_from_pieces, json_schema_input_type=tuple[TrackPiece, ...] | Track),
]
