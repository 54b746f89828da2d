"""Some spans of a line as a line of their own, for what is felt over a few spans only."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from tautwire.line.alignment import alignment
from tautwire.specs.case import Case
from tautwire.specs.line.track import Track

_TRACK_ROWS = 1.0
"""Distance between the rows that give the track of a part [m]: transitions are tens of metres
long."""


def part_of_line(case: Case, first: int, last: int) -> Case:
    """Return some spans of a line between anchors of their own.

    The wires end at the outer supports, where the whole line holds them too, under the same
    tension. The track is kept; names of masts, chainage, conditions, requirements and the uneven
    surface of the wire are left out.

    Parameters
    ----------
    case
        A line of one tension length with one set of droppers.
    first, last : int
        Spans, from 1.
    """
    lengths = case.line.span_lengths()
    data = case.to_dict()
    masts = slice(first - 1, last + 1)
    data["line"] |= {
        "spans": last - first + 1,
        "span_length": list(lengths[first - 1 : last]),
        "ends": _ends(data["line"]["ends"], {"left": first == 1, "right": last == len(lengths)}),
        "masts": None,
        "chainage": None,
    }
    data["supports"] |= _supports(case, masts)
    data["droppers"] |= _droppers(case, slice(first - 1, last))
    data["track"] = _track(case, sum(lengths[: first - 1]), sum(lengths[:last]))
    data["settings"]["section"] = [1, last - first + 1]
    for name in ("conditions", "condition", "requirements", "irregularities", "sources", "project"):
        data.pop(name, None)
    return Case.model_validate(data)


def _ends(ends: dict[str, Any], kept: dict[str, bool]) -> dict[str, Any]:
    """Return the ends; new ones are held, as the line that goes on beyond them holds the wires."""
    return {side: ends[side] if own else "anchored" for side, own in kept.items()}


def _supports(case: Case, masts: slice) -> dict[str, Any]:
    """Return what the supports have one by one."""
    spec, count = case.supports, case.line.spans + 1
    given: dict[str, Sequence[Any] | None] = {
        "contact_height": spec.contact_heights(count),
        "encumbrance": None if spec.encumbrance is None else spec.encumbrances(count),
        "contact_stagger": spec.contact_staggers(count),
        "messenger_stagger": spec.messenger_staggers(count),
        "hinge": spec.hinges(count),
        "type": spec.type,
        "arm_end_y": spec.arm_end_y,
        "arm_end_z": spec.arm_end_z,
    }
    return {name: None if row is None else list(row[masts]) for name, row in given.items()}


def _droppers(case: Case, spans: slice) -> dict[str, Any]:
    """Return what the droppers have span by span."""
    (spec,) = case.dropper_sets
    count = case.line.spans
    given = {
        "positions": spec.positions_by_span(count),
        "presag": None if spec.presag is None else spec.presag_by_span(count),
        "lengths": None if spec.lengths is None else spec.lengths_by_span(count),
    }
    return {
        name: None if rows is None else [list(row) for row in rows[spans]]
        for name, rows in given.items()
    }


def _track(case: Case, start: float, end: float) -> dict[str, Any]:
    """Return the track from one distance to another, in rows."""
    spec = case.track
    if spec.is_straight_and_level:
        return spec.to_dict()
    whole = alignment(spec, case.line)
    s = np.linspace(start, end, 1 + round((end - start) / _TRACK_ROWS))
    frames, curvature = whole.frames(s), whole.plan_curvature(s)
    tangent, lateral = frames.axes[..., 0, :], frames.axes[..., 1, :]
    sine = -lateral[:, 2] / np.hypot(tangent[:, 0], tangent[:, 1])
    bends = np.abs(curvature) > _STRAIGHT
    radius = np.divide(1.0, curvature, out=np.zeros_like(curvature), where=bends)
    rows = Track(
        chainage=tuple((s - start).tolist()),
        radius=tuple(radius.tolist()),
        cant=tuple(np.where(bends, spec.rail_distance * sine, 0.0).tolist()),
        height=tuple(frames.origin[:, 2].tolist()),
        rail_distance=spec.rail_distance,
    )
    return rows.to_dict()


_STRAIGHT = 1e-9
"""Curvature below which a track counts as straight [1/m]: the largest radius that is read."""
