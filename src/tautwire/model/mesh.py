"""Strands of wire elements between attachments; the only place that computes node numbers."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tautwire.line.measures import SAME_PLACE, longest_hung_interval
from tautwire.line.pieces import At, Line, Run

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
    """

    strands: tuple[Strand, ...]
    s: Array

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


def divide(line: Line, nodes_between: int) -> Mesh:
    """Divide every interval between neighbouring attachments of a run evenly.

    Intervals longer than any in a span with droppers (raised contact wires on their way to the
    anchor) get more elements, so that none is longer than the longest there.

    Parameters
    ----------
    line
        The pieces.
    nodes_between
        Nodes from one attachment to the next, both counted (NAD).
    """
    longest = longest_hung_interval(line)
    places = [
        _divided(np.array(line.points(run.name)), nodes_between - 1, longest) for run in line.runs
    ]
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
    return Mesh(tuple(strands), s[order])


def _divided(ends: Array, elements: int, longest: float) -> Array:
    """Divide the intervals between some points into elements, long ones into more [m]."""
    parts = []
    for left, gap in zip(ends[:-1], np.diff(ends), strict=True):
        count = elements * max(1, int(np.ceil(gap / longest - SAME_PLACE)))
        parts.append(left + gap * (np.arange(count) / count))
    return np.concatenate([*parts, ends[-1:]])
