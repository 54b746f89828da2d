"""Motion of the contact wire over space and time, from stored shapes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tautwire.errors import InputError
from tautwire.results.run import Run

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SpaceTime:
    """Vertical velocity of a wire over position and time.

    Attributes
    ----------
    time : (n_time,) s
    x : (n_point,) m
    velocity : (n_time, n_point) m/s
        Upwards positive.
    paths : mapping of str to (n_time,) m
        Position of each pantograph; NaN before it enters the line.
    """

    time: Array
    x: Array
    velocity: Array
    paths: dict[str, Array]


def wire_velocity(run: Run, wire: str | None = None) -> SpaceTime:
    """Differentiate the stored shapes of a wire in time.

    Central differences between the neighbours of each frame, so what is faster than about a third
    of the frame rate is smoothed.

    Parameters
    ----------
    run
        A run of a case with ``settings.store_shapes: true``.
    wire
        Its name; the first contact wire by default.

    Returns
    -------
    SpaceTime

    Raises
    ------
    InputError
        When the run holds too few shapes, or the wire is unknown.
    """
    names, wire = run.equilibrium.wire_names, wire or run.equilibrium.contact.name
    if wire not in names:
        raise InputError(f"wire: got {wire!r}; choose one of {', '.join(names)}")
    shots = run.snapshots
    if not run.case.settings.store_shapes or len(shots.time) < 3:
        raise InputError(
            "the shapes of the wires were not stored; run the case with settings.store_shapes: true"
        )
    x, heights = shots.of(names.index(wire))
    velocity = np.gradient(heights.astype(np.float64), shots.time, axis=0)
    paths = {
        record.name: np.where(
            np.interp(shots.time, run.time, record.active) > 0.5,
            np.interp(shots.time, run.time, record.position),
            np.nan,
        )
        for record in run.pantographs
    }
    return SpaceTime(shots.time, x, velocity, paths)
