"""Strands of wire elements between attachments; the only place that computes node numbers."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tautwire.line.measures import SAME_PLACE, longest_hung_interval
from tautwire.line.pieces import At, Line, Run
from tautwire.model.band import longest_element
from tautwire.numerics.track import Frames, Track
from tautwire.specs.settings import Settings

Array = NDArray[np.float64]
Index = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Strand:
    """One run as nodes and elements.

    Attributes
    ----------
    run : Run
    s : (n,) m
        Place of its nodes along the track, from left to right.
    nodes : (n,)
    cables : (n - 1,)
        Elements between them.
    leads : (float, float)
        Share of its tension that acts along the track at its left and its right end: in a curve it
        comes from the neighbouring support along a chord.
    held : int
        Which of its nodes is held along the track while the shape is sought. Its tension is given
        at the ends that are not.
    """

    run: Run
    s: Array
    nodes: Index
    cables: Index
    leads: tuple[float, float]
    held: int

    @property
    def pulled_ends(self) -> tuple[tuple[int, int], ...]:
        """Node of every end whose tension is given, and 0 at the left, 1 at the right end."""
        ends = (0, self.nodes[0]), (len(self.s) - 1, self.nodes[-1])
        return tuple((int(n), side) for side, (row, n) in enumerate(ends) if row != self.held)

    def position(self, s: float) -> int:
        """Return which of its nodes lies at a place where something is attached [m]."""
        right = min(max(int(self.s.searchsorted(s)), 1), len(self.s) - 1)
        is_left_nearer = s - self.s[right - 1] <= self.s[right] - s
        return right - 1 if is_left_nearer else right


@dataclass(frozen=True, eq=False)
class Mesh:
    """All strands of a line; nodes are numbered along the track, at one place by strand.

    Attributes
    ----------
    strands : tuple of Strand
    s : (n_node,) m
        Place of every node along the track.
    track : Track
    heels : (n_registration,)
        Node at the elastic far end of the arm of each registration; -1 where it has none.
    """

    strands: tuple[Strand, ...]
    s: Array
    track: Track
    heels: Index

    @property
    def node_count(self) -> int:
        """Number of nodes."""
        return len(self.s)

    @cached_property
    def frames(self) -> Frames:
        """Frames of the track at every node."""
        return self.track.frames(self.s)

    @cached_property
    def _by_name(self) -> dict[str, Strand]:
        return {strand.run.name: strand for strand in self.strands}

    def strand(self, run: str) -> Strand:
        """Return the strand of a run."""
        return self._by_name[run]

    def node(self, at: At) -> int:
        """Return the node at an attachment."""
        strand = self._by_name[at.run]
        return int(strand.nodes[strand.position(at.s)])

    def heights(self, position: Array) -> Array:
        """Return how high the nodes are above the rails, ``(n_node,)`` [m].

        Parameters
        ----------
        position : (n_dof,)
        """
        return self.frames.to_local(position.reshape(-1, 6)[:, :3])[:, 2]

    def nodes(self, places: Iterable[At]) -> Index:
        """Return the nodes at some attachments."""
        return np.array([self.node(at) for at in places], dtype=np.int64)


@dataclass(frozen=True)
class Division:
    """How intervals between neighbouring attachments are divided.

    Attributes
    ----------
    elements : int
        At least.
    longest : float m
        Longest element.
    is_graded : bool
        Whether elements are short beside the attachments.
    """

    elements: int
    longest: float
    is_graded: bool

    def fractions(self, gap: float) -> Array:
        """Return the left ends of the elements of an interval, in parts of its length."""
        near = GRADED_NODES
        if not self.is_graded or gap <= _WIDE * near[-1]:
            count = self._count(gap, self.elements)
            return np.arange(count) / count
        corners = (0.0, *near, *(gap - distance for distance in reversed(near)), gap)
        least = [1] * (len(corners) - 1)
        least[len(near)] = self.elements - 2 * len(near)
        parts = [
            _even(left, right, self._count(right - left, count))
            for (left, right), count in zip(pairwise(corners), least, strict=True)
        ]
        return np.concatenate(parts) / gap

    def _count(self, length: float, least: int) -> int:
        return max(least, math.ceil(length / self.longest - SAME_PLACE))


def _even(left: float, right: float, count: int) -> Array:
    """Return the left ends of equal parts."""
    return left + (right - left) * np.arange(count) / count


GRADED_NODES = (0.15, 0.5)
"""Distances of the nodes of a graded mesh from an attachment [m]. Point loads bend a wire over
sqrt(EI/T), some 0.1 m; with nodes here dropper lengths of a stitched line are 0.03 mm off, with as
many even elements 4 mm."""

_WIDE = 4.0
"""Intervals shorter than this, in units of the outer graded node's distance, are divided evenly."""


def divide(line: Line, settings: Settings, speed: float) -> Mesh:
    """Divide every interval between neighbouring attachments of a run.

    Parameters
    ----------
    line
        The pieces.
    settings
        Band, or nodes from one attachment to the next (NAD); grading, longest element.
    speed
        Of the train [m/s]: waves ahead of it are shorter.
    """
    places = [
        _divided(np.array(line.points(run.name)), _division(line, run, settings, speed))
        for run in line.runs
    ]
    elastic = [row for row, piece in enumerate(line.registrations) if piece.heel is not None]
    places.append(np.array([line.registrations[row].at.s for row in elastic], dtype=float))
    s = np.concatenate(places)
    strand_of = np.repeat(np.arange(len(places)), [len(p) for p in places])
    order = np.lexsort((strand_of, s))
    number = np.empty(len(s), dtype=np.int64)
    number[order] = np.arange(len(s))
    strands, first_node, first_cable = [], 0, 0
    for run, own in zip(line.runs, places[:-1], strict=True):
        nodes = number[first_node : first_node + len(own)]
        cables = np.arange(first_cable, first_cable + len(own) - 1)
        held = int(np.argmin(np.abs(own - _held_at(line, run))))
        strands.append(Strand(run, own, nodes, cables, _leads(line, run), held))
        first_node, first_cable = first_node + len(own), first_cable + len(own) - 1
    heels = np.full(len(line.registrations), -1)
    heels[elastic] = number[first_node:]
    return Mesh(tuple(strands), s[order], line.track, heels)


def _division(line: Line, run: Run, settings: Settings, speed: float) -> Division:
    """Return how a run is divided.

    With nodes that are counted, intervals longer than any in a span with droppers (raised contact
    wires on their way to the anchor) get more, so that no element is longer than the longest there.
    """
    given, graded = settings.longest_element, settings.is_graded()
    if settings.nodes_between_droppers is not None:
        elements = settings.nodes_between_droppers - 1
        return Division(elements, given or longest_hung_interval(line) / elements, graded)
    longest = longest_element(run, settings.band, speed)
    return Division(1, longest if given is None else min(given, longest), graded)


def _held_at(line: Line, run: Run) -> float:
    """Return the place at which a run is held along the track: an anchor or its fixed point.

    Between two anchors its tension is given at the right one. With weights at both ends it is held
    in the middle of the supports that hold it; without any, at its left end, whose weight is then
    what the other end leaves.
    """
    if run.start.kind != "weighted":
        return run.start.s
    if run.end.kind == "anchored":
        return run.end.s
    pieces = (*line.registrations, *line.suspensions)
    fixed = sorted(p.at.s for p in pieces if p.at.run == run.name and p.is_fixed_along)
    return fixed[len(fixed) // 2] if fixed else run.start.s


def _leads(line: Line, run: Run) -> tuple[float, float]:
    """Return how much less of a run's tension acts along the track at its ends for the curve.

    The ratio of the cosines between the track and the way to the next support, to that on straight
    track: there the tension is that along the track.
    """
    held = [(end.s, end.y, end.z) for end in (run.start, run.end)]
    pieces = (*line.registrations, *line.suspensions)
    held += [(piece.at.s, piece.y, piece.z) for piece in pieces if piece.at.run == run.name]
    places = np.array(sorted(set(held)))
    left, right = _cosines(line.track, places) / _cosines(Track.straight(), places)
    return float(left), float(right)


def _cosines(track: Track, places: Array) -> Array:
    """Return cosines between a track and chords at the first and last of some points ``(n, 3)``."""
    frames = track.frames(places[:, 0])
    points = frames.to_world(places * np.array([0.0, 1.0, 1.0]))
    chords = np.diff(points, axis=0)[[0, -1]]
    along = np.sum(chords * frames.axes[[0, -1], 0], axis=1)
    return along / np.linalg.norm(chords, axis=1)


def _divided(ends: Array, division: Division) -> Array:
    """Divide the intervals between some points into elements."""
    gaps = np.diff(ends).tolist()
    fractions = {gap: division.fractions(gap) for gap in set(gaps)}
    parts = [left + gap * fractions[gap] for left, gap in zip(ends[:-1], gaps, strict=True)]
    return np.concatenate([*parts, ends[-1:]])


def longest_elements(line: Line, settings: Settings, speed: float) -> dict[str, float]:
    """Return the length of the longest element of every run [m]."""
    return {
        strand.run.name: round(float(np.diff(strand.s).max()), 9)
        for strand in divide(line, settings, speed).strands
    }
