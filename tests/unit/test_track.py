"""The alignment of a track: positions, frames and their derivatives, tables against pieces."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.special import fresnel

from tautwire.line.alignment import alignment
from tautwire.numerics.track import Track
from tautwire.specs.line.catenary import Line
from tautwire.specs.line.track import Track as TrackSpec

LINE = Line(spans=15, span_length=60.0)
CURVE: list[dict[str, Any]] = [
    {"straight": 100.0},
    {"transition": 80.0},
    {"arc": 300.0, "radius": 600.0, "side": "left", "cant": 0.12},
    {"transition": 90.0},
    {"arc": 200.0, "radius": 900.0, "side": "right", "cant": 0.06},
    {"transition": 60.0},
    {"straight": 170.0},
]
PROFILE = [
    {"at": 0.0, "height": 0.0},
    {"at": 300.0, "height": 3.0, "radius": 8000.0},
    {"at": 700.0, "height": -5.0, "radius": 4000.0},
    {"at": 900.0, "height": -3.0},
]


def curve(**keys: Any) -> Track:
    """Return the alignment of a description of the track."""
    return alignment(TrackSpec.model_validate(keys), LINE)


WHOLE = curve(pieces=CURVE, profile=PROFILE)
PLACES = np.linspace(0.3, 899.7, 401)


def test_straight_track_is_x_without_rounding() -> None:
    """The frame of a straight track is the axes of the coordinates, its origin exactly s."""
    frames = Track.straight().frames(PLACES)
    assert np.array_equal(frames.origin, np.stack([PLACES, 0 * PLACES, 0 * PLACES], axis=1))
    assert np.array_equal(frames.axes, np.broadcast_to(np.eye(3), (len(PLACES), 3, 3)))


def test_tangent_is_the_derivative_of_the_position() -> None:
    """p' = t, by central differences over 0.1 m; t is of length 1, so s is the length."""
    h = 0.05
    rate = (WHOLE.frames(PLACES + h).origin - WHOLE.frames(PLACES - h).origin) / (2.0 * h)
    assert_allclose(rate, WHOLE.frames(PLACES).axes[:, 0], atol=1e-8)


def test_bending_is_the_derivative_of_the_tangent() -> None:
    """t' = the curvature vector, by central differences away from the joints of the pieces."""
    h = 1e-3
    away = PLACES[np.min(np.abs(PLACES[:, None] - WHOLE.s), axis=1) > 2.0 * h]
    ends = (WHOLE.frames(away + side * h).axes[:, 0] for side in (1.0, -1.0))
    assert_allclose(np.subtract(*ends) / (2.0 * h), WHOLE.bending(away), atol=1e-9)


def test_frames_are_orthonormal_and_continuous() -> None:
    """t, n, b form a right-handed frame, which turns by no jump at the joints of the pieces."""
    axes = WHOLE.frames(PLACES).axes
    assert_allclose(
        axes @ np.swapaxes(axes, 1, 2), np.broadcast_to(np.eye(3), axes.shape), atol=1e-14
    )
    assert_allclose(np.cross(axes[:, 0], axes[:, 1]), axes[:, 2], atol=1e-14)
    before, after = (WHOLE.frames(WHOLE.s[1:-1] + side * 1e-7) for side in (-1.0, 1.0))
    assert_allclose(before.axes, after.axes, atol=1e-8)
    assert_allclose(before.origin, after.origin, atol=1e-6)


def test_transition_is_the_clothoid() -> None:
    """x + iy of a clothoid of parameter A^2 = R L is A sqrt(pi) (C + iS)(s / (A sqrt(pi)))."""
    length, radius = 120.0, 400.0
    pieces = [
        {"straight": 50.0},
        {"transition": length},
        {"arc": 730.0, "radius": radius, "side": "left"},
    ]
    way = np.linspace(0.0, length, 61)
    scale = np.sqrt(np.pi * radius * length)
    sine, cosine = fresnel(way / scale)
    origin = curve(pieces=pieces).frames(50.0 + way).origin
    assert_allclose(origin[:, 0] - 50.0, scale * cosine, atol=1e-11)
    assert_allclose(origin[:, 1], scale * sine, atol=1e-11)


def test_arc_is_a_circle() -> None:
    """An arc to the right stays at its radius from the centre on that side."""
    track = curve(pieces=[{"arc": 900.0, "radius": 250.0, "side": "right"}])
    distance = track.frames(PLACES).origin - np.array([0.0, -250.0, 0.0])
    assert_allclose(np.linalg.norm(distance, axis=1), 250.0, rtol=1e-14)


def test_cant_raises_the_outer_rail() -> None:
    """In a curve to the left the normal leans to the left by cant over the rail distance."""
    axes = WHOLE.frames(300.0).axes
    heading = np.array([axes[0, 0], axes[0, 1], 0.0]) / np.hypot(axes[0, 0], axes[0, 1])
    level_left = np.cross([0.0, 0.0, 1.0], heading)
    assert axes[2] @ level_left == pytest.approx(0.12 / 1.5, rel=1e-12)
    assert axes[1, 2] == pytest.approx(-0.12 / 1.5, rel=1e-3)


def test_profile_meets_gradients_and_vertical_radii() -> None:
    """Between vertical curves dz/ds is the gradient; inside one it changes by 1/R per length."""
    slopes = WHOLE.frames([100.0, 500.0, 850.0]).axes[:, 0, 2]
    assert_allclose(slopes, [0.01, -0.02, 0.01], rtol=1e-12)
    h = 1.0
    rate = np.diff(WHOLE.frames([300.0 - h, 300.0 + h]).axes[:, 0, 2]) / (2.0 * h)
    assert_allclose(rate, -1.0 / 8000.0, rtol=1e-9)
    assert WHOLE.frames(150.0).origin[2] == pytest.approx(1.5, rel=1e-12)


def test_rows_describe_what_pieces_do() -> None:
    """A table with a row at every change gives the curve of the pieces, from either end."""
    s = np.concatenate([[0.0], np.cumsum([next(iter(piece.values())) for piece in CURVE])])
    radius = [0.0, 0.0, 600.0, 600.0, -900.0, -900.0, 0.0, 0.0]
    cant = [0.0, 0.0, 0.12, 0.12, -0.06, -0.06, 0.0, 0.0]
    height = 0.002 * s
    profile = [{"at": 0.0, "height": 0.0}, {"at": 1000.0, "height": 2.0}]
    wanted = curve(pieces=CURVE, profile=profile).frames(PLACES)
    rising = TrackSpec(
        chainage=tuple(s), radius=tuple(radius), cant=tuple(cant), height=tuple(height)
    )
    found = alignment(rising, LINE).frames(PLACES)
    assert_allclose(found.origin, wanted.origin, atol=1e-9)
    assert_allclose(found.axes, wanted.axes, atol=1e-12)
    chainage = tuple(5000.0 - 60.0 * number for number in range(16))
    falling = TrackSpec(
        chainage=tuple(5000.0 - s[::-1]),
        radius=tuple(-value for value in radius[::-1]),
        cant=tuple(-value for value in cant[::-1]),
        height=tuple(height[::-1]),
    )
    found = alignment(falling, LINE.with_(chainage=chainage)).frames(PLACES)
    assert_allclose(found.origin, wanted.origin, atol=1e-9)
    assert_allclose(found.axes, wanted.axes, atol=1e-12)


def test_local_coordinates_are_undone() -> None:
    """World coordinates of a point in a frame lead back to its local ones."""
    frames = WHOLE.frames(PLACES)
    local = np.random.default_rng(5).normal(size=(len(PLACES), 3))
    assert_allclose(frames.to_local(frames.to_world(local)), local, atol=1e-12)


def test_jump_of_chainage_stays_in_its_span() -> None:
    """With a span whose chainage grows by 20 m too much the rows behind it keep their distance."""
    chainage = tuple(60.0 * n + (20.0 if n > 3 else 0.0) for n in range(16))
    line = LINE.with_(chainage=chainage)
    assert line.distance(120.0) == pytest.approx(120.0)
    assert line.distance(380.0) == pytest.approx(360.0)
    assert line.distance(220.0) == pytest.approx(180.0 + 60.0 * 40.0 / 80.0)
    assert line.distance(-7.0) == pytest.approx(-7.0)
    assert line.distance(930.0) == pytest.approx(910.0)
