"""Stations of both wires: supports, droppers and the even division between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tautwire.specs.case import Case

Array = NDArray[np.float64]
Index = NDArray[np.int64]

CONTACT, MESSENGER = 0, 1


@dataclass(frozen=True, eq=False)
class Mesh:
    """Stations along the track; each carries a contact-wire and a messenger-wire node.

    Attributes
    ----------
    x : (n_station,) m
    support_station : (n_support,)
        Stations of the supports, both anchors included.
    dropper_station : (n_dropper,)
    dropper_span, dropper_number : (n_dropper,)
        1-based span and number within the span.
    """

    x: Array
    support_station: Index
    dropper_station: Index
    dropper_span: Index
    dropper_number: Index

    @property
    def station_count(self) -> int:
        """Number of stations."""
        return len(self.x)

    @property
    def support_x(self) -> Array:
        """Longitudinal position of the supports [m]."""
        return self.x[self.support_station]

    @property
    def dropper_x(self) -> Array:
        """Longitudinal position of the droppers [m]."""
        return self.x[self.dropper_station]

    def nodes(self, wire: int) -> Index:
        """Node numbers of one wire from left to right."""
        return 2 * np.arange(self.station_count) + wire


def divide(case: Case) -> Mesh:
    """Divide every interval between neighbouring attachment points into NAD - 1 elements.

    Parameters
    ----------
    case
        The line; NAD is ``settings.nodes_between_droppers``.
    """
    spans = case.line.span_lengths()
    positions = case.droppers.positions_by_span(len(spans))
    support_x = np.concatenate([[0.0], np.cumsum(spans)])
    elements = case.settings.nodes_between_droppers - 1
    points: list[float] = [0.0]
    support_index, dropper_index = [0], []
    span_of, number_of = [], []
    for i, in_span in enumerate(positions):
        for number, position in enumerate(in_span, start=1):
            dropper_index.append(len(points))
            span_of.append(i + 1)
            number_of.append(number)
            points.append(support_x[i] + position)
        support_index.append(len(points))
        points.append(support_x[i + 1])
    fractions = np.arange(elements) / elements
    ends = np.array(points)
    inner = ends[:-1, None] + np.diff(ends)[:, None] * fractions
    return Mesh(
        x=np.concatenate([inner.ravel(), ends[-1:]]),
        support_station=elements * np.array(support_index),
        dropper_station=elements * np.array(dropper_index, dtype=np.int64),
        dropper_span=np.array(span_of, dtype=np.int64),
        dropper_number=np.array(number_of, dtype=np.int64),
    )
