"""Where a recording lies on the line of a run: its chainage, its marks, then the force itself."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from tautwire.measured.alignment import Alignment, align
from tautwire.measured.evaluation import SPACING
from tautwire.measured.processing import Processed
from tautwire.measured.recording import Recording
from tautwire.plain import Plain, named
from tautwire.results.run import Run

Array = NDArray[np.float64]

_LESS_THAN_HALF = 0.45
"""Share of the shortest span that is searched: from half a span on equal spans are mistaken."""
_MOST_MISSING = 0.3
"""Share of the common part that may be missing: windows with more than half missing do not count,
and gaps come in heaps."""
_SHORTEST = 30.0
"""Shortest common part that can be aligned [m]: half a span with its droppers."""


@dataclass(frozen=True, eq=False)
class Placement(Plain):
    """Positions of a recording in the model.

    Attributes
    ----------
    verdict : str
        ``"aligned"``, ``"as recorded"``, or why it was not aligned.
    text : str
    uncertainty : float m
        Scatter of the aligned windows; NaN without alignment.
    position : (n,) m
        Of the processed force, monotone.
    rows : (n_row,) m
        Of the rows of the recording.
    """

    untold: ClassVar[tuple[str, ...]] = ("position", "rows")

    verdict: str
    text: str
    uncertainty: float = field(metadata=named("uncertainty_m"))
    position: Array
    rows: Array


def place_on_line(
    run: Run,
    recording: Recording,
    signal: Processed,
    computed: tuple[Array, Array],
    *,
    offset: float,
    search: float | None,
) -> Placement:
    """Lay a recording over the line of a run.

    Recorded chainage becomes positions of the model by the chainage of the line, where the case has
    it, and else by the offset; marks of known chainage correct it. Then the force is aligned with
    the computed one. A recording that does not match, or the other way round, stays where it was
    recorded, and the text says so.

    Parameters
    ----------
    run
    recording
    signal
        Its processed force.
    computed : (n,) m, (n,) N
        Position and filtered force of the run.
    offset : float m
    search : float m, optional
        By default nearly half of the shortest span; 0 for none.
    """
    rows = model_position(run, recording, offset)
    place = np.interp(signal.time, recording.time, rows)
    spans = np.diff(run.equilibrium.mast_x)
    reach = _LESS_THAN_HALF * float(spans.min()) if search is None else search
    if reach <= 0.0:
        return Placement("as recorded", "positions are taken as recorded", np.nan, place, rows)
    found = _aligned(place, signal.force, computed, reach)
    if found is None:
        text = (
            "the common part is too short, or too much of it is missing, to be aligned; positions "
            "are taken as recorded"
        )
        return Placement("as recorded", text, np.nan, place, rows)
    if found.verdict != "aligned":
        text = f"not aligned, {found.verdict}: {found.text}; positions are taken as recorded"
        return Placement(found.verdict, text, np.nan, place, rows)
    return Placement(
        "aligned", found.text, found.uncertainty, found.position(place), found.position(rows)
    )


def model_position(run: Run, recording: Recording, offset: float) -> Array:
    """Return the positions of the rows of a recording in the model, ``(n_row,)`` [m].

    Parameters
    ----------
    run
    recording
    offset : float m
    """
    if recording.chainage is None:
        assert recording.distance is not None
        forwards = run.case.scenario.direction == "+x"
        return offset + (recording.distance if forwards else -recording.distance)
    chainage = _marked(recording) + offset
    given = run.case.line.chainage
    if given is None:
        return chainage
    supports, known = run.equilibrium.mast_x, np.array(given)
    if known[0] > known[-1]:
        supports, known = supports[::-1], known[::-1]
    inner = np.interp(chainage, known, supports)
    slope = 1.0 if supports[-1] > supports[0] else -1.0
    beyond = np.minimum(chainage - known[0], 0.0) + np.maximum(chainage - known[-1], 0.0)
    return inner + slope * beyond


def _marked(recording: Recording) -> Array:
    """Return the recorded chainage, shifted so that marks of known chainage lie where they are."""
    assert recording.chainage is not None
    if not len(recording.mark_times):
        return recording.chainage
    recorded = np.interp(recording.mark_times, recording.time, recording.chainage)
    shift = np.interp(recording.time, recording.mark_times, recording.mark_chainages - recorded)
    return recording.chainage + shift


def _aligned(
    place: Array, force: Array, computed: tuple[Array, Array], reach: float
) -> Alignment | None:
    """Align the part of a recording that lies on the line; None where that is too short."""
    line, pattern = computed
    order = slice(None, None, -1 if place[0] > place[-1] else 1)
    place, force = place[order], force[order]
    start, end = max(place[0], line[0] - reach), min(place[-1], line[-1] + reach)
    if end - start < _SHORTEST + 2.0 * reach:
        return None
    grid = np.arange(float(start), float(end), SPACING)
    known = ~np.isnan(force)
    if known.sum() < 2:
        return None
    measured = np.interp(grid, place[known], force[known])
    measured[np.interp(grid, place, (~known).astype(float)) > 0.0] = np.nan
    if np.isnan(measured).mean() > _MOST_MISSING:
        return None
    even = np.arange(float(line[0]), float(line[-1]), SPACING)
    return align(grid, measured, even, np.interp(even, line, pattern), search=reach)
