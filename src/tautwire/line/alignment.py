"""From the words about a track to the curve that it is; distances count from support 1."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.track import Track
from tautwire.specs.line.catenary import Line
from tautwire.specs.line.track import ProfilePoint, TrackPiece, change_of_gradient
from tautwire.specs.line.track import Track as TrackSpec

Array = NDArray[np.float64]


def alignment(spec: TrackSpec, line: Line) -> Track:
    """Return the curve of a track; at support 1 it is at the origin and runs along x.

    Parameters
    ----------
    spec
        The track.
    line
        Tells how chainage is counted.
    """
    if spec.chainage is not None:
        return _from_rows(spec, line)
    if spec.is_straight_and_level:
        return Track.straight()
    s, bends = _from_pieces(spec.pieces) if spec.pieces else _no_bend(line)
    profile = _profile(spec.profile) if spec.profile else _level(s)
    return _joined(s, bends, profile, spec.rail_distance)


def _no_bend(line: Line) -> tuple[Array, Array]:
    return np.array([0.0, line.length()]), np.zeros((1, 2, 2))


def _from_pieces(pieces: tuple[TrackPiece, ...]) -> tuple[Array, Array]:
    """Return ends (n + 1,) and curvature and cant at both ends of every piece, ``(n, 2, 2)``."""
    s = np.concatenate([[0.0], np.cumsum([piece.length for piece in pieces])])
    own = np.array([piece.bend for piece in pieces])
    bends = np.stack([own, own], axis=1)
    for number, piece in enumerate(pieces):
        if piece.transition is not None:
            bends[number] = own[number - 1], own[number + 1]
    return s, bends


def _profile(points: tuple[ProfilePoint, ...]) -> tuple[Array, Array]:
    """Return ends and cubic coefficients of a profile of gradients and vertical curves."""
    ends = [points[0].at]
    pieces = []
    gradients = [
        (right.height - left.height) / (right.at - left.at) for left, right in pairwise(points)
    ]
    for number, gradient in enumerate(gradients):
        left, right = points[number], points[number + 1]
        change = change_of_gradient(points, number + 1)
        half = 0.5 * right.radius * abs(change)
        pieces.append((0.0, 0.0, gradient, left.height + gradient * (ends[-1] - left.at)))
        ends.append(right.at - half)
        if half > 0.0:
            pieces.append((0.0, 0.25 * change / half, gradient, right.height - gradient * half))
            ends.append(right.at + half)
    return np.array(ends), np.array(pieces).T


def _level(s: Array) -> tuple[Array, Array]:
    return s[[0, -1]], np.zeros((4, 1))


def _from_rows(spec: TrackSpec, line: Line) -> Track:
    """Return the curve of a table; seen from the other end where chainage falls along the line."""
    from scipy.interpolate import PchipInterpolator

    assert spec.chainage is not None
    count = len(spec.chainage)
    radius = np.array(spec.radius or np.zeros(count))
    curvature = np.where(radius == 0.0, 0.0, 1.0 / np.where(radius == 0.0, 1.0, radius))
    cant = np.array(spec.cant or np.zeros(count))
    height = np.array(spec.height or np.zeros(count))
    s = np.array([line.distance(place) for place in spec.chainage])
    if s[-1] < s[0]:
        s, curvature, cant, height = s[::-1], -curvature[::-1], -cant[::-1], height[::-1]
    rows = np.stack([curvature, cant], axis=1)
    found: Any = PchipInterpolator(s, height)
    return _joined(s, np.stack([rows[:-1], rows[1:]], axis=1), (s, found.c), spec.rail_distance)


def _joined(s: Array, bends: Array, profile: tuple[Array, Array], rail_distance: float) -> Track:
    """Lay plan and profile on common ends of pieces."""
    heights, cubics = profile
    ends = np.unique(np.concatenate([s, heights]))
    middle = 0.5 * (ends[:-1] + ends[1:])
    own = np.clip(np.searchsorted(s, middle) - 1, 0, len(s) - 2)
    shares = (np.stack([ends[:-1], ends[1:]], axis=1) - s[own][:, None]) / np.diff(s)[own][:, None]
    shares = np.where(
        (middle < s[0])[:, None], 0.0, np.where((middle > s[-1])[:, None], 1.0, shares)
    )
    first, last = bends[own, 0], bends[own, 1]
    both = first[:, None] + shares[..., None] * (last - first)[:, None]
    cubic = np.clip(np.searchsorted(heights, middle) - 1, 0, len(heights) - 2)
    return Track(
        s=ends,
        curvature=both[..., 0],
        cant=both[..., 1] / rail_distance,
        height=_moved(cubics[:, cubic], ends[:-1] - heights[cubic]),
        start=np.zeros(3),
    )


def _moved(cubics: Array, by: Array) -> Array:
    """Return cubics over a way that begins further on."""
    a, b, c, d = cubics
    return np.stack(
        [
            a,
            b + 3.0 * a * by,
            c + (2.0 * b + 3.0 * a * by) * by,
            d + (c + (b + a * by) * by) * by,
        ]
    )
