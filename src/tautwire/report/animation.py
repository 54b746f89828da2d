"""Data of the animation: shapes of the wires, motion and force of the pantographs, packed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.report import packing
from tautwire.report.views import ForceView, RunView
from tautwire.results.run import Run, Snapshots

CELLS = 800_000
"""Largest number of stored wire heights per wire, over all films of a page."""
SAMPLES = 12_000
"""Largest number of samples per history."""
SCENE_SHARE = 0.22
"""Height of the messenger wire above the contact wire, as a share of the visible length."""


def films(views: Sequence[RunView]) -> list[dict[str, Any]]:
    """Return the data of one film per run that has shapes and a moving pantograph."""
    usable = [view for view in views if has_film(view)]
    return [film(view, min(CELLS // 2, CELLS // len(usable))) for view in usable]


def has_film(view: RunView) -> bool:
    """Tell whether there is something to show."""
    moving = any(not force.is_empty for force in view.forces)
    return moving and view.run.snapshots.time.size > 1 and view.run.snapshots.x.size > 1


def film(view: RunView, cells: int) -> dict[str, Any]:
    """Pack what one film needs."""
    run, shots = view.run, _coarse(view.run.snapshots, cells)
    shape = run.equilibrium
    moving = [force for force in view.forces if not force.is_empty]
    return {
        "title": view.label,
        "supports": shape.support_x.tolist(),
        "droppers": packing.floats(shape.dropper_x),
        "slack": packing.counts(_slack(run, shots.time)),
        "section": list(view.section),
        "reference": float(np.mean(shape.support_heights)),
        "startTime": _start_time(view),
        "forceRange": _force_range(moving),
        "filterShort": f"0–{view.lowpass.cutoff:g} Hz",
        "frames": {
            "time": packing.floats(shots.time),
            "x": packing.floats(shots.x),
            "contact": packing.steps(shots.contact_z),
            "messenger": packing.steps(shots.messenger_z),
        },
        "pantographs": [_pantograph(run, force) for force in moving],
    }


def exaggeration(view: RunView, length: float) -> int:
    """Choose a factor with which the wires fill a good part of the picture."""
    shape = view.run.equilibrium
    height = float(np.mean(shape.messenger_position[:, 2]) - np.mean(shape.support_heights))
    wanted = 0.12 * length / max(height, 0.1)
    return int(np.clip(round(wanted), 2, 60))


def visible_length(view: RunView) -> float:
    """Return the length that shows about three spans [m]."""
    return float(3.0 * np.median(np.diff(view.run.equilibrium.support_x)))


def _coarse(shots: Snapshots, cells: int) -> Snapshots:
    """Leave out frames until the shapes fit."""
    stride = max(1, int(np.ceil(shots.contact_z.size / max(cells, 1))))
    return Snapshots(
        shots.time[::stride], shots.x, shots.contact_z[::stride], shots.messenger_z[::stride]
    )


def _slack(run: Run, times: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which droppers are slack in which frame, (n_frame * n_dropper,)."""
    if not run.dropper_force.size:
        return np.zeros(0, dtype=np.bool_)
    rows = np.clip(np.searchsorted(run.time, times), 0, run.time.size - 1)
    return (run.dropper_force[rows] <= 0.0).ravel()


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


def _pantograph(run: Run, force: ForceView) -> dict[str, Any]:
    """Pack motion and force of one pantograph over the instants since it entered."""
    record, time = run.pantograph(force.name), force.time
    on = record.active
    stride = max(1, int(np.ceil(time.size / SAMPLES)))
    kept, raw = slice(None, None, stride), packing.thinned(force.raw, SAMPLES)

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
