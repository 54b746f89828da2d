"""Data of the animation: shapes of the wires, motion and force of the pantographs, packed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.report.figures import packing
from tautwire.report.parts.views import ForceView, RunView
from tautwire.results.equilibrium import WireShape
from tautwire.results.run import Run, Snapshots

CELLS = 900_000
"""Largest number of stored displacements per wire, over all films of a page."""
FRAMES = 2_500
"""Largest number of frames of a film."""
SAMPLES = 24_000
"""Largest number of samples per history, over all pantographs of a page."""
MOST_FILMS = 6
"""Largest number of films on a page."""
POINTS_PER_SPAN = 90
"""Largest number of points of a wire per span."""


@dataclass(frozen=True)
class Budget:
    """What one film may hold: displacements per wire, and samples per history."""

    cells: int
    samples: int


def films(views: Sequence[RunView]) -> list[dict[str, Any]]:
    """Return the data of one film per run that :func:`filmed` chooses."""
    shown = filmed(views)
    moving = sum(not force.is_empty for view in shown for force in view.forces)
    budget = Budget(CELLS // max(len(shown), 2), min(3_000, SAMPLES // max(moving, 1)))
    return [film(view, budget) for view in shown]


def filmed(views: Sequence[RunView]) -> list[RunView]:
    """Return the runs with something to show, at most :data:`MOST_FILMS`."""
    return [view for view in views if has_film(view)][:MOST_FILMS]


def has_film(view: RunView) -> bool:
    """Tell whether there is something to show."""
    moving = any(not force.is_empty for force in view.forces)
    return moving and view.run.snapshots.time.size > 1 and view.run.snapshots.x.size > 1


def film(view: RunView, budget: Budget) -> dict[str, Any]:
    """Pack what one film needs."""
    run, shots = view.run, _coarse(view.run)
    shape = run.equilibrium
    moving = [force for force in view.forces if not force.is_empty]
    return {
        "title": view.label,
        "supports": shape.mast_x.tolist(),
        "marks": run.case.line.support_marks(),
        "droppers": packing.floats(shape.dropper_x),
        "dropperWires": shape.dropper_wires.ravel().tolist(),
        "slack": packing.counts(_slack(run, shots.time)),
        "section": list(view.section),
        "reference": float(np.mean(shape.support_heights)),
        "startTime": _start_time(view),
        "forceRange": _force_range(moving),
        "filterShort": f"0–{view.lowpass.cutoff:g} Hz",
        "frames": _frames(run, shots, budget.cells),
        "pantographs": [_pantograph(run, force, budget.samples) for force in moving],
    }


def exaggeration(view: RunView, length: float) -> int:
    """Choose a factor with which the wires fill a good part of the picture."""
    shape = view.run.equilibrium
    highest = np.max([np.mean(wire.position[:, 2]) for wire in shape.wires])
    height = float(highest - np.mean(shape.support_heights))
    wanted = 0.12 * length / max(height, 0.1)
    return int(np.clip(round(wanted), 2, 60))


def visible_length(view: RunView) -> float:
    """Return the length that shows about three spans [m]."""
    return float(3.0 * np.median(np.diff(view.run.equilibrium.mast_x)))


def _coarse(run: Run) -> Snapshots:
    """Leave out frames and points that a film does not need."""
    shots = run.snapshots
    rows = slice(None, None, max(1, -(-shots.time.size // FRAMES)))
    points = POINTS_PER_SPAN * run.case.line.spans
    columns = []
    for number in range(len(run.equilibrium.wire_names)):
        own = np.flatnonzero(shots.wire == number)
        columns.append(own[:: max(1, -(-own.size // points))])
    kept = np.concatenate(columns)
    return Snapshots(shots.time[rows], shots.x[kept], shots.wire[kept], shots.z[rows][:, kept])


def _frames(run: Run, shots: Snapshots, cells: int) -> dict[str, Any]:
    """Pack the displacements of the wires from their static shape, wire by wire."""
    middle = _middle(run, shots.time)
    wires = [
        _wire(shots, number, wire, middle, cells)
        for number, wire in enumerate(run.equilibrium.wires)
    ]
    return {"time": packing.floats(shots.time), "wires": wires}


def _wire(
    shots: Snapshots, number: int, wire: WireShape, middle: NDArray[np.float64], cells: int
) -> dict[str, Any]:
    """Pack the displacements of one wire.

    A wire too long to be stored whole is stored around the pantographs: as many points per frame
    as fit, from the point `first` on; elsewhere it is drawn at rest.
    """
    x, heights = shots.of(number)
    frames, points = heights.shape
    own = 2 * cells * points // max(1, shots.x.size)
    count = int(min(points, max(own // frames, 64)))
    first = np.clip(np.searchsorted(x, middle) - count // 2, 0, points - count)
    window = first[:, None] + np.arange(count)
    still = np.interp(x, wire.s, wire.position[:, 2])
    moved = np.take_along_axis(heights - still, window, axis=1)
    return {
        "name": wire.name,
        "role": wire.role,
        "x": packing.floats(x),
        "still": packing.floats(still),
        "moved": packing.steps(moved),
        "first": packing.floats(first),
        "count": count,
    }


def _middle(run: Run, times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the middle between the first and the last pantograph on the line [m]."""
    on = np.array([record.active for record in run.pantographs])
    position = np.array([record.position for record in run.pantographs])
    first = np.where(on, position, np.inf).min(axis=0)
    last = np.where(on, position, -np.inf).max(axis=0)
    rows = np.clip(np.searchsorted(run.time, times), 0, run.time.size - 1)
    middle = np.where(on.any(axis=0), 0.5 * (first + last), position[0])[rows]
    return np.asarray(middle, dtype=np.float64)


def _slack(run: Run, times: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return which droppers are slack in which frame, one bit each, frame by frame."""
    if not run.droppers.force.size:
        return np.zeros(0, dtype=np.uint8)
    rows = np.clip(np.searchsorted(run.time, times), 0, run.time.size - 1)
    return np.packbits(run.droppers.at(rows) <= 0.0)


def _start_time(view: RunView) -> float:
    """Return the time at which the leading pantograph is well inside the section."""
    first = next(force for force in view.forces if not force.is_empty)
    start, end = view.section
    nearest = np.argmin(np.abs(first.position - (start + 0.3 * (end - start))))
    return float(first.time[nearest])


def _force_range(forces: Sequence[ForceView]) -> list[float]:
    """Return the axis of the force, robust against a single extreme sample."""
    every = np.concatenate([force.raw[np.isfinite(force.raw)] for force in forces])
    if not every.size:
        return [0.0, 100.0]
    lowest, highest = np.percentile(every, (0.1, 99.8)).tolist()
    return [min(0.0, 10.0 * np.floor(lowest / 10.0)), max(50.0, 10.0 * np.ceil(highest / 10.0))]


def _pantograph(run: Run, force: ForceView, samples: int) -> dict[str, Any]:
    """Pack motion and force of one pantograph over the instants since it entered."""
    record, time = run.pantograph(force.name), force.time
    on = record.active
    stride = max(1, -(-time.size // samples))
    kept, raw = slice(None, None, stride), packing.thinned(force.raw, 2 * samples)

    def at_samples(values: NDArray[np.float64]) -> dict[str, Any]:
        return packing.floats(np.interp(time[kept], run.time[on], values[on]))

    return {
        "name": record.name,
        "time": packing.floats(time[kept]),
        "position": packing.floats(force.position[kept]),
        "filtered": packing.floats(force.low[kept]),
        "rawTime": packing.floats(time[raw]),
        "rawPosition": packing.floats(force.position[raw]),
        "raw": packing.floats(force.raw[raw]),
        "wire": at_samples(record.wire_height),
        "head": at_samples(record.wire_height - record.gap),
        "stages": [at_samples(column) for column in record.stage_heights.T],
    }
