"""Where on the line a measured force belongs: tracked cross-correlation with a computed one.

Both forces hold the same spans and droppers. The whole record is first laid over the line, in
either direction; then windows of it are shifted against the computed force, each near the shift of
its neighbour, and a monotone cubic through the shifts maps recorded to true positions. (Windowed
correlation is what the mutual alignment of track geometry records uses; time warping makes
staircases.)
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from tautwire.measured.recording import Array

Verdict = Literal["aligned", "undecidable", "wrong direction", "does not match"]

WINDOW = 200.0
"""Length of a window [m]: three to four spans, so that droppers and spans both speak."""

STRIDE = 50.0
"""Distance of the windows [m]."""

REACH = 6.0
"""Largest change of the shift from window to window [m], 3 % of a stride."""

LEAST_CORRELATION = 0.4
"""Correlation below which a window does not count, and a record does not belong to the line."""

RIVAL = 0.93
"""A second place with so much of the best correlation makes the position undecidable."""


@dataclass(frozen=True, eq=False)
class Alignment:
    """How recorded positions map to those of the line.

    Attributes
    ----------
    verdict : str
    text : str
        What was found, in words.
    recorded, true : (n,) m
        Points of the map, both increasing; empty unless aligned.
    correlation : (n,)
        Of each window.
    refused : int
        Windows that did not match.
    uncertainty : float m
        Standard deviation of the windows about the smooth map; NaN unless aligned.
    """

    verdict: Verdict
    text: str
    recorded: Array
    true: Array
    correlation: Array
    refused: int
    uncertainty: float

    def position(self, recorded: Array) -> Array:
        """Map recorded positions to those of the line, ``(n,)`` m to ``(n,)`` m."""
        from scipy.interpolate import PchipInterpolator

        if len(self.recorded) == 1:
            return recorded + (self.true[0] - self.recorded[0])
        shift = self.true - self.recorded
        held = np.clip(recorded, self.recorded[0], self.recorded[-1])
        drift = float(np.polyfit(self.recorded, shift, 1)[0])  # a wheel's error goes on at the ends
        return recorded + PchipInterpolator(self.recorded, shift)(held) + drift * (recorded - held)


def align(
    recorded: Array, measured: Array, line: Array, computed: Array, *, search: float
) -> Alignment:
    """Align a measured force with a computed one.

    Parameters
    ----------
    recorded : (n,) m
        Evenly spaced recorded positions, increasing.
    measured : (n,) N
        Filtered force; NaN where not measured.
    line : (m,) m
        Positions of the computed force, increasing, with the same spacing.
    computed : (m,) N
        Filtered force.
    search : float m
        Largest error of the recorded positions at the start.
    """
    spacing = float(recorded[1] - recorded[0])
    grid = np.arange(line[0], line[-1], spacing)
    pattern = np.interp(grid, line, computed)
    forward = _coarse(recorded, measured, grid, pattern, search)
    backward = _coarse(recorded, measured[::-1], grid, pattern, search)
    if max(forward.best, backward.best) < LEAST_CORRELATION:
        return _refused(
            "does not match",
            f"the best correlation with the computed force is {forward.best:.2f}: another track, "
            "another line, or positions that are off by more than the search",
        )
    if backward.best - forward.best > _CLEARLY:
        return _refused(
            "wrong direction",
            f"the record matches the line when it is turned around (correlation "
            f"{backward.best:.2f}, as it stands {forward.best:.2f})",
        )
    if forward.rival > RIVAL * forward.best:
        return _refused(
            "undecidable",
            f"shifts of {forward.shift:+.1f} m and {forward.rival_shift:+.1f} m fit alike "
            f"(correlation {forward.best:.2f} and {forward.rival:.2f}); equal spans repeat: give "
            "marks of known chainage",
        )
    return _refined(recorded, measured, grid, pattern, forward.shift)


def _refined(
    recorded: Array, measured: Array, grid: Array, pattern: Array, shift: float
) -> Alignment:
    """Track once, then again on the record laid out by the first map.

    A wheel's error stretches a window against the line, which draws its shift towards where the
    force varies most; laid out by a first map, the windows are no longer stretched.
    """
    first = _tracked(recorded, measured, grid, pattern, shift)
    if first.verdict != "aligned":
        return first
    place = first.position(recorded)
    even = np.arange(place[0], place[-1], recorded[1] - recorded[0])
    known = np.interp(even, place, np.isnan(measured).astype(float)) == 0.0
    bridged = np.interp(even, place, np.nan_to_num(measured, nan=float(np.nanmean(measured))))
    second = _tracked(even, np.where(known, bridged, np.nan), grid, pattern, 0.0)
    if second.verdict != "aligned":
        return second
    return replace(second, recorded=np.interp(second.recorded, place, recorded))


def _refused(verdict: Verdict, text: str) -> Alignment:
    none = np.empty(0)
    return Alignment(verdict, text, none, none, none, 0, float("nan"))


@dataclass(frozen=True)
class _Coarse:
    """The best constant shift, and the best one elsewhere."""

    shift: float
    best: float
    rival_shift: float
    rival: float


_PART = 0.7
"""Share of a short record that is laid over the line first; the rest leaves room for its shift."""

_CLEARLY = 0.1
"""Difference of correlations from which the turned record is the better one. Chosen: with 0.03
and 0.3 the records of the tests are judged alike."""

_APART = 8.0
"""Shifts that are further apart than this are different places, not flanks of one peak [m]."""


def _coarse(
    recorded: Array, measured: Array, grid: Array, pattern: Array, search: float
) -> _Coarse:
    """Correlate the middle of the record with the line over all shifts within the search."""
    length = recorded[-1] - recorded[0]
    middle = recorded[0] + 0.5 * length
    part = np.abs(recorded - middle) <= 0.5 * min(4.0 * WINDOW, _PART * length)
    shifts, values = _correlations(recorded[part], measured[part], grid, pattern, 0.0, search)
    best = int(np.argmax(values))
    elsewhere = np.abs(shifts - shifts[best]) > _APART
    rival = int(np.argmax(np.where(elsewhere, values, -1.0)))
    has_rival = bool(elsewhere.any())
    return _Coarse(
        float(shifts[best]),
        float(values[best]),
        float(shifts[rival]) if has_rival else float("nan"),
        float(values[rival]) if has_rival else -1.0,
    )


def _correlations(
    place: Array, force: Array, grid: Array, pattern: Array, about: float, reach: float
) -> tuple[Array, Array]:
    """Return shifts about a guess and the correlation of a window at each."""
    spacing = float(grid[1] - grid[0])
    steps = np.arange(-round(reach / spacing), round(reach / spacing) + 1)
    start = round((place[0] + about - grid[0]) / spacing)
    exact = grid[0] + start * spacing - place[0]
    known = ~np.isnan(force)
    window = np.where(known, force - np.nanmean(force) if known.any() else 0.0, 0.0)
    count = len(window)
    values = np.full(len(steps), -1.0)
    inside = (start + steps >= 0) & (start + steps + count <= len(pattern))
    if not inside.any() or known.mean() < 0.5:
        return exact + spacing * steps, values
    first = start + int(steps[inside][0])
    views = np.lib.stride_tricks.sliding_window_view(
        pattern[first : first + int(inside.sum()) - 1 + count], count
    )
    weighted = views * known
    means = weighted.sum(axis=1) / known.sum()
    centred = (views - means[:, None]) * known
    scale = np.linalg.norm(centred, axis=1) * np.linalg.norm(window)
    values[inside] = (centred @ window) / np.where(scale > 0.0, scale, np.inf)
    return exact + spacing * steps, values


def _tracked(
    recorded: Array, measured: Array, grid: Array, pattern: Array, shift: float
) -> Alignment:
    """Follow the shift from window to window and smooth it."""
    spacing = float(recorded[1] - recorded[0])
    count = round(min(WINDOW, recorded[-1] - recorded[0]) / spacing)
    centres, shifts, correlations, refused = [], [], [], 0
    for start in range(0, len(recorded) - count + 1, round(STRIDE / spacing)):
        window = slice(start, start + count)
        found, values = _correlations(
            recorded[window], measured[window], grid, pattern, shift, REACH
        )
        best = int(np.argmax(values))
        if values[best] < LEAST_CORRELATION or best in (0, len(values) - 1):
            refused += 1
            continue
        shift = float(found[best] + spacing * _vertex(values[best - 1 : best + 2]))
        centres.append(float(recorded[window].mean()))
        shifts.append(shift)
        correlations.append(float(values[best]))
    if not centres:
        return _refused("does not match", "no window of the record matches the computed force")
    return _map_of(np.array(centres), np.array(shifts), np.array(correlations), refused)


def _vertex(values: Array) -> float:
    """Return where the parabola through three neighbours has its top, in steps from the middle."""
    curvature = values[0] - 2.0 * values[1] + values[2]
    return 0.5 * float((values[0] - values[2]) / curvature) if curvature < 0.0 else 0.0


def _map_of(centres: Array, shifts: Array, correlations: Array, refused: int) -> Alignment:
    smooth = shifts.copy()
    if len(shifts) >= 3:  # a window that disagrees with both neighbours follows them
        middle = np.median(np.stack([shifts[:-2], shifts[1:-1], shifts[2:]]), axis=0)
        smooth[1:-1] = middle
    true = centres + smooth
    keep = np.concatenate([[True], np.diff(np.maximum.accumulate(true)) > 0.0])
    spread = float(np.std(shifts - smooth)) if len(shifts) >= 3 else float("nan")
    text = (
        f"aligned over {len(centres)} windows of {WINDOW:g} m, {refused} refused, correlation "
        f"{correlations.min():.2f} to {correlations.max():.2f}, windows scatter by {spread:.2f} m"
    )
    return Alignment("aligned", text, centres[keep], true[keep], correlations, refused, spread)
