"""The track under a plan in words: straights, transitions, arcs and gradients."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from tautwire.numerics.track import Track

_SAME = 1e-9
"""Difference of curvatures [1/m], cants [m] or gradients below which they are one: rounding."""

_LEVEL = 0.005
"""Gradient that rounds to none in the hundredths of a per mille that are written."""


@dataclass(frozen=True)
class Bend:
    """A straight, a transition or an arc.

    Attributes
    ----------
    start, end : float m
    curvature : (float, float) 1/m
        At both ends, positive to the left.
    cant : (float, float) m
        At both ends, positive where the right rail is higher.
    """

    start: float
    end: float
    curvature: tuple[float, float]
    cant: tuple[float, float]

    @property
    def texts(self) -> tuple[str, ...]:
        """Descriptions, the longest first."""
        length = f"{self.end - self.start:.1f} m"
        first, last = self.curvature
        if abs(last - first) > _SAME:
            return f"transition {length}", length
        cant = f", cant {1e3 * abs(self.cant[0]):.0f} mm" if abs(self.cant[0]) > _SAME else ""
        if abs(first) < _SAME:
            return f"straight{cant} {length}", "straight"
        radius = f"R {1.0 / abs(first):.0f} m {'left' if first > 0.0 else 'right'}"
        return f"{radius}{cant}, {length}", f"{radius}{cant}", radius


@dataclass(frozen=True)
class Rise:
    """A stretch of rails: gradients at both ends, and radius of the vertical curve or None [m]."""

    start: float
    end: float
    gradient: tuple[float, float]
    radius: float | None

    @property
    def texts(self) -> tuple[str, ...]:
        """Descriptions, the longest first."""
        first, last = (1e3 * value for value in self.gradient)
        if self.radius is not None:
            kind = "crest" if last < first else "sag"
            return f"{kind}, Rv {self.radius:.0f} m", f"Rv {self.radius:.0f}"
        if max(abs(first), abs(last)) < _LEVEL:
            return ("level",)
        return f"{0.5 * (first + last):+.2f} ‰", f"{0.5 * (first + last):+.1f}"


def bends(track: Track, rail_distance: float, length: float) -> tuple[Bend, ...]:
    """Return straights, transitions and arcs under a line.

    Parameters
    ----------
    track
    rail_distance
        Over which cant is measured [m].
    length
        Of the line [m].
    """
    found: list[Bend] = []
    lengths = np.diff(track.s)
    for piece, start, end in _pieces(track, length):
        shares = (np.array([start, end]) - track.s[piece]) / lengths[piece]
        curvature, cant = (
            tuple((ends[0] + shares * (ends[1] - ends[0])).tolist())
            for ends in (track.curvature[piece], rail_distance * track.cant[piece])
        )
        one = Bend(start, end, curvature, cant)
        if found and _goes_on(found[-1], one):
            before = found[-1]
            joined = (before.curvature[0], curvature[1]), (before.cant[0], cant[1])
            found[-1] = replace(before, end=end, curvature=joined[0], cant=joined[1])
        else:
            found.append(one)
    return tuple(found)


def rises(track: Track, length: float) -> tuple[Rise, ...]:
    """Return the gradients of the rails under a line of a length [m]."""
    found: list[Rise] = []
    for piece, start, end in _pieces(track, length):
        a, b, c, _ = track.height[:, piece].tolist()
        first, last = (
            (3.0 * a * way + 2.0 * b) * way + c
            for way in (start - track.s[piece], end - track.s[piece])
        )
        radius = 1.0 / (2.0 * abs(b)) if abs(b) > _SAME and abs(a) <= _SAME else None
        one = Rise(start, end, (float(first), float(last)), radius)
        if found and _rises_on(found[-1], one):
            before = found[-1]
            found[-1] = replace(before, end=end, gradient=(before.gradient[0], one.gradient[1]))
        else:
            found.append(one)
    return tuple(found)


def _rises_on(before: Rise, one: Rise) -> bool:
    """Tell whether a gradient or a vertical curve goes on from one piece to the next."""
    (first, last), (begin, end) = before.gradient, one.gradient
    if abs(begin - last) > _SAME:
        return False
    if before.radius is None or one.radius is None:
        return max(first, end) - min(first, end) < _SAME
    is_same = abs(1.0 / before.radius - 1.0 / one.radius) < _SAME
    return is_same and (last > first) == (end > begin)


def _goes_on(before: Bend, one: Bend) -> bool:
    """Tell whether curvature and cant go on evenly from one piece to the next."""
    for own, other in ((before.curvature, one.curvature), (before.cant, one.cant)):
        if abs(own[1] - other[0]) > _SAME:
            return False
        rates = [
            (last - first) / (piece.end - piece.start)
            for (first, last), piece in ((own, before), (other, one))
        ]
        if abs(rates[0] - rates[1]) > _SAME:
            return False
    return True


def _pieces(track: Track, length: float) -> Iterator[tuple[int, float, float]]:
    """Yield the pieces of a track under a line, with where each begins and ends there [m].

    The outer ones reach on.
    """
    ends = track.s.copy()
    ends[0], ends[-1] = min(ends[0], 0.0), max(ends[-1], length)
    ends = np.clip(ends, 0.0, length)
    for piece, (start, end) in enumerate(pairwise(ends.tolist())):
        if end > start:
            yield piece, start, end
