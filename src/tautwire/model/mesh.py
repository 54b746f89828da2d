"""Strands of wire elements between attachments; the only place that computes node numbers."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tautwire.line.measures import SAME_PLACE, longest_hung_interval
from tautwire.line.pieces import At, Line, Run
from tautwire.numerics.track import Frames
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
    """

    run: Run
    s: Array
    nodes: Index
    cables: Index

    def position(self, s: float) -> int:
        """Return which of its nodes lies at a place where something is attached [m]."""
        return int(np.abs(self.s - s).argmin())


@dataclass(frozen=True, eq=False)
class Mesh:
    """All strands of a line; nodes are numbered along the track, at one place by strand.

    Attributes
    ----------
    strands : tuple of Strand
    s : (n_node,) m
        Place of every node along the track.
    frames : Frames
        Of the track at every node.
    """

    strands: tuple[Strand, ...]
    s: Array
    frames: Frames

    @property
    def node_count(self) -> int:
        """Number of nodes."""
        return len(self.s)

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
        near = np.array(GRADED_NODES)
        is_graded = self.is_graded and gap > _WIDE * near[-1]
        inner, elements = (
            (gap - 2.0 * near[-1], self.elements - 2 * len(near))
            if is_graded
            else (
                gap,
                self.elements,
            )
        )
        count = max(elements, int(np.ceil(inner / self.longest - SAME_PLACE)))
        if not is_graded:
            return np.arange(count) / count
        middle = near[-1] + inner * np.arange(count + 1) / count
        return np.concatenate([[0.0], near[:-1], middle, gap - near[-2::-1]]) / gap


GRADED_NODES = (0.15, 0.5)
"""Distances of the nodes of a graded mesh from an attachment [m]. Point loads bend a wire over
sqrt(EI/T), some 0.1 m; with nodes here dropper lengths of a stitched line are 0.03 mm off, with as
many even elements 4 mm."""

_WIDE = 4.0
"""Intervals shorter than this, in units of the outer graded node's distance, are divided evenly."""


def divide(line: Line, settings: Settings) -> Mesh:
    """Divide every interval between neighbouring attachments of a run.

    Intervals longer than any in a span with droppers (raised contact wires on their way to the
    anchor) get more elements, so that none is longer than the longest there.

    Parameters
    ----------
    line
        The pieces.
    settings
        Nodes from one attachment to the next (NAD), grading, longest element.
    """
    elements = settings.nodes_between_droppers - 1
    longest = settings.longest_element or longest_hung_interval(line) / elements
    division = Division(elements, longest, settings.graded_mesh)
    places = [_divided(np.array(line.points(run.name)), division) for run in line.runs]
    s = np.concatenate(places)
    strand_of = np.repeat(np.arange(len(places)), [len(p) for p in places])
    order = np.lexsort((strand_of, s))
    number = np.empty(len(s), dtype=np.int64)
    number[order] = np.arange(len(s))
    strands, first_node, first_cable = [], 0, 0
    for run, own in zip(line.runs, places, strict=True):
        nodes = number[first_node : first_node + len(own)]
        cables = np.arange(first_cable, first_cable + len(own) - 1)
        strands.append(Strand(run, own, nodes, cables))
        first_node, first_cable = first_node + len(own), first_cable + len(own) - 1
    return Mesh(tuple(strands), s[order], line.track.frames(s[order]))


def _divided(ends: Array, division: Division) -> Array:
    """Divide the intervals between some points into elements."""
    gaps = np.diff(ends)
    parts = [
        left + gap * division.fractions(gap) for left, gap in zip(ends[:-1], gaps, strict=True)
    ]
    return np.concatenate([*parts, ends[-1:]])


def element_lengths(line: Line, settings: Settings) -> tuple[float, float]:
    """Return the lengths of the shortest and of the longest wire element [m]."""
    steps = np.concatenate([np.diff(strand.s) for strand in divide(line, settings).strands])
    return round(float(steps.min()), 9), round(float(steps.max()), 9)
