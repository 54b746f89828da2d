"""The alignment of a track as a pure curve: from the way along it to the frame there.

The curve runs at rail level in the middle of the track and is parametrised by its own length s.
With the heading psi, the rise per length g = dz/ds and the cant angle phi::

    t  = (c cos psi, c sin psi, g),      c = sqrt(1 - g^2)      tangent
    n0 = (-sin psi, cos psi, 0),         b0 = t x n0
    n  =  n0 cos phi - b0 sin phi                               lateral, to the left
    b  =  b0 cos phi + n0 sin phi                               normal to the plane of the rails
    dt/ds = (dpsi/ds) c n0 + (dg/ds)/c b0

The curvature dpsi/ds and the sine of the cant angle are linear in s on every piece, so that a
transition is a clothoid; the height is a cubic. Positions are integrated by Gauss's rule.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]

_PANEL = 25.0
"""Longest stretch over which positions are integrated at once [m]: the heading turns by a quarter
at most even on a radius of 100 m, for which the rule is exact to rounding."""
_POINTS = 8
"""Points of the rule per stretch: its error there is below 1e-15 of the length."""
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(_POINTS)


@dataclass(frozen=True, eq=False)
class Frames:
    """Frames of a track.

    Attributes
    ----------
    origin : (..., 3) m
        Middle of the track at rail level.
    axes : (..., 3, 3)
        Unit vectors along the track, lateral (left positive) and normal, as rows.
    """

    origin: Array
    axes: Array

    def to_world(self, local: Array) -> Array:
        """Return points given by their coordinates in the frames, ``(..., 3)`` [m]."""
        return self.origin + self.turned(local)

    def to_local(self, points: Array) -> Array:
        """Return the coordinates of points in the frames, ``(..., 3)`` [m]."""
        return self.components(points - self.origin)

    def turned(self, local: Array) -> Array:
        """Return vectors given by their components in the frames, ``(..., 3)``."""
        return np.einsum("...ij,...i->...j", self.axes, local)

    def components(self, vectors: Array) -> Array:
        """Return the components of vectors in the frames, ``(..., 3)``."""
        return np.einsum("...ij,...j->...i", self.axes, vectors)

    def matrices(self, local: Array) -> Array:
        """Return matrices given in the frames, ``(..., 3, 3)``."""
        return np.einsum("...ki,...kl,...lj->...ij", self.axes, local, self.axes)

    def __getitem__(self, chosen: Index | int) -> Frames:
        return Frames(self.origin[chosen], self.axes[chosen])


@dataclass(frozen=True, eq=False)
class Track:
    """The alignment of a track piece by piece.

    Attributes
    ----------
    s : (n + 1,) m
        Ends of the pieces; the first and the last piece go on beyond them.
    curvature : (n, 2) 1/m
        dpsi/ds at both ends of every piece, positive in a curve to the left.
    cant : (n, 2)
        Sine of the cant angle at both ends, positive when the right rail is higher.
    height : (4, n)
        Coefficients of the height [m] over the way from the beginning of a piece, the highest
        power first.
    start : (3,) m
        Where the curve is at s = 0.
    heading : float rad
        Its direction there.
    """

    s: Array
    curvature: Array
    cant: Array
    height: Array
    start: Array
    heading: float = 0.0

    @classmethod
    def straight(cls) -> Self:
        """Return a straight and level track along x."""
        level = np.zeros((1, 2))
        return cls(np.array([0.0, _PANEL]), level, level, np.zeros((4, 1)), np.zeros(3))

    @cached_property
    def is_plane(self) -> bool:
        """Whether the plane of the rails never bends: no vertical curve, no cant in a curve."""
        return not (self.height[:2].any() or self.cant.any())

    def frames(self, s: ArrayLike) -> Frames:
        """Return the frames at some places.

        Parameters
        ----------
        s : (...) m
        """
        s = np.asarray(s, dtype=float)
        t, n0, b0 = self._directions(s)
        sine = self._cant(s)[..., None]
        cosine = np.sqrt(1.0 - sine**2)
        axes = np.stack([t, cosine * n0 - sine * b0, cosine * b0 + sine * n0], axis=-2)
        return Frames(self._position(s), axes)

    def bending(self, s: ArrayLike) -> Array:
        """Return dt/ds, the rate at which the tangent turns, ``(..., 3)`` [1/m]."""
        s = np.asarray(s, dtype=float)
        _, n0, b0 = self._directions(s)
        piece, u = self._piece(s, self.s)
        slope, rate = self._slope(piece, u), self._slope_rate(piece, u)
        cosine = np.sqrt(1.0 - slope**2)
        turning = _between(self.curvature[piece], u / self._lengths[piece])
        return (turning * cosine)[..., None] * n0 + (rate / cosine)[..., None] * b0

    def plan_curvature(self, s: ArrayLike) -> Array:
        """Return dpsi/ds, positive in a curve to the left, ``(...)`` [1/m]."""
        piece, u = self._piece(np.asarray(s, dtype=float), self.s)
        return _between(self.curvature[piece], u / self._lengths[piece])

    def rise_curvature(self, s: ArrayLike) -> Array:
        """Return ``b . dt/ds``: how the track bends away from the plane of the rails [1/m]."""
        return np.sum(self.frames(s).axes[..., 2, :] * self.bending(s), axis=-1)

    def _directions(self, s: Array) -> tuple[Array, Array, Array]:
        """Return tangent, level lateral and upright direction, ``(..., 3)`` each."""
        piece, u = self._piece(s, self.s)
        psi, slope = self._heading_at(piece, u), self._slope(piece, u)
        cosine, level = np.sqrt(1.0 - slope**2), np.zeros_like(psi)
        sin, cos = np.sin(psi), np.cos(psi)
        t = np.stack([cosine * cos, cosine * sin, slope], axis=-1)
        n0 = np.stack([-sin, cos, level], axis=-1)
        b0 = np.stack([-slope * cos, -slope * sin, cosine], axis=-1)
        return t, n0, b0

    def _position(self, s: Array) -> Array:
        panel, u = self._piece(s, self._panels)
        piece, _ = self._piece(s, self.s)
        rise = _cubic(self.height[:, piece], s - self.s[piece]) - self._height_at_start
        plan = self._at_panels[panel] + self._run(panel, u)
        along = np.stack([s, np.zeros_like(s)], axis=-1)
        return self.start + np.concatenate([along + plan, rise[..., None]], axis=-1)

    def _run(self, panel: Index, u: Array) -> Array:
        """Integrate ``(dx/ds - 1, dy/ds)`` from the beginning of panels, ``(..., 2)`` [m].

        Without the 1 nothing is left of a straight track, not even rounding.
        """
        at = 0.5 * u[..., None] * (1.0 + _NODES)
        s = self._panels[panel][..., None] + at
        piece = self._piece_of_panel[panel][..., None]
        way = s - self.s[piece]
        psi, slope = self._heading_at(piece, way), self._slope(piece, way)
        cosine = np.sqrt(1.0 - slope**2)
        lost = -(slope**2) / (1.0 + cosine) * np.cos(psi) - 2.0 * np.sin(0.5 * psi) ** 2
        rates = np.stack([lost, cosine * np.sin(psi)], axis=-1)
        return 0.5 * u[..., None] * np.einsum("...pi,p->...i", rates, _WEIGHTS)

    def _heading_at(self, piece: Index, u: Array) -> Array:
        first, last = self.curvature[piece, 0], self.curvature[piece, 1]
        share = 0.5 * u / self._lengths[piece]
        return self._headings[piece] + u * (first + share * (last - first))

    def _slope(self, piece: Index, u: Array) -> Array:
        a, b, c, _ = self.height[:, piece]
        return (3.0 * a * u + 2.0 * b) * u + c

    def _slope_rate(self, piece: Index, u: Array) -> Array:
        a, b, _, _ = self.height[:, piece]
        return 6.0 * a * u + 2.0 * b

    def _cant(self, s: Array) -> Array:
        piece, u = self._piece(s, self.s)
        return _between(self.cant[piece], u / self._lengths[piece])

    @staticmethod
    def _piece(s: Array, ends: Array) -> tuple[Index, Array]:
        """Return which stretch places lie in, and the way from its beginning [m]."""
        piece = np.clip(np.searchsorted(ends, s, side="right") - 1, 0, len(ends) - 2)
        return piece, s - ends[piece]

    @cached_property
    def _lengths(self) -> Array:
        """Lengths of the pieces, ``(n,)`` [m]."""
        return np.diff(self.s)

    @cached_property
    def _headings(self) -> Array:
        """Heading at the beginning of every piece, ``(n,)`` [rad]."""
        turned = np.cumsum(self.curvature.mean(axis=1) * self._lengths)
        begin = np.concatenate([[0.0], turned[:-1]])
        piece, u = self._piece(np.array(0.0), self.s)
        first, last = self.curvature[piece]
        there = begin[piece] + u * (first + 0.5 * u / self._lengths[piece] * (last - first))
        return begin - there + self.heading

    @cached_property
    def _panels(self) -> Array:
        """Beginnings of the stretches of integration, and the end of the last [m]."""
        counts = np.maximum(1, np.ceil(np.diff(self.s) / _PANEL)).astype(np.int64)
        parts = [
            left + gap * np.arange(count) / count
            for left, gap, count in zip(self.s[:-1], np.diff(self.s), counts, strict=True)
        ]
        return np.concatenate([*parts, self.s[-1:]])

    @cached_property
    def _piece_of_panel(self) -> Index:
        return self._piece(self._panels[:-1], self.s)[0]

    @cached_property
    def _at_panels(self) -> Array:
        """What ``(x - s, y)`` is at the beginnings of the panels when both are 0 at s = 0."""
        panels = np.arange(len(self._panels) - 1)
        steps = self._run(panels, np.diff(self._panels))
        begin = np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)[:-1]])
        panel, u = self._piece(np.array(0.0), self._panels)
        return begin - (begin[panel] + self._run(panel, u))

    @cached_property
    def _height_at_start(self) -> float:
        piece, u = self._piece(np.array(0.0), self.s)
        return float(_cubic(self.height[:, piece], u))


def _between(ends: Array, share: Array) -> Array:
    return ends[..., 0] + share * (ends[..., 1] - ends[..., 0])


def _cubic(coefficients: Array, u: Array) -> Array:
    a, b, c, d = coefficients
    return ((a * u + b) * u + c) * u + d
