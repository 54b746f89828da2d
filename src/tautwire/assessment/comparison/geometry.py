"""Static position of the contact wire beside a measured one: height and stagger."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tautwire.assessment.comparison.placement import model_position
from tautwire.errors import InputError
from tautwire.measured.recording import Recording
from tautwire.plain import Plain, named
from tautwire.results.run import Run

Array = NDArray[np.float64]

_MIRRORED = -0.7
"""Correlation of staggers from which the measured one counts as mirrored: a zigzag of the other
side has nearly -1, one of another track anything between. Chosen."""
_ZIGZAG = 0.03
"""Least standard deviation of a stagger that has sides to exchange [m]."""


@dataclass(frozen=True)
class GeometryRow(Plain):
    """Differences of one coordinate of the contact wire, simulated at rest minus measured.

    Attributes
    ----------
    quantity : str
        ``"height"`` or ``"stagger"``.
    mean, standard_deviation, largest : float m
        The last is the difference that is farthest from zero.
    place : float m
        Where that is, in the model.
    samples : int
    note : str
        That left and right are exchanged, where they seem to be.
    """

    quantity: str
    mean: float = field(metadata=named("mean_m"))
    standard_deviation: float = field(metadata=named("standard_deviation_m"))
    largest: float = field(metadata=named("largest_m"))
    place: float = field(metadata=named("place_m"))
    samples: int
    note: str = ""


def compare_geometry(
    run: Run, recording: Recording, *, offset: float = 0.0
) -> tuple[GeometryRow, ...]:
    """Compare the measured height and stagger with those of the static line.

    A height measured at the pantograph holds its uplift, which the static height does not.

    Parameters
    ----------
    run
    recording
    offset : float m
        As for :func:`~tautwire.assessment.comparison.measurement.compare_with_measurement`.

    Returns
    -------
    tuple of GeometryRow
        For what was measured of the two.

    Raises
    ------
    InputError
        When the recording has nothing in common with the line.
    """
    place = model_position(run, recording, offset)
    supports = run.equilibrium.support_x
    inside = (place >= supports[0]) & (place <= supports[-1])
    if not inside.any():
        raise InputError(
            f"{recording.label}: the measurement covers {place.min():.1f} m to {place.max():.1f} m "
            f"of the model, the line {supports[0]:.1f} m to {supports[-1]:.1f} m: nothing in "
            "common; give the offset of the measurement's zero"
        )
    shape = run.equilibrium
    sides = 1.0 if place[-1] >= place[0] else -1.0  # left of the train to left of the model
    measured: list[tuple[str, Array | None, Callable[[Array], Array]]] = [
        ("height", recording.height, shape.running_height),
        ("stagger", recording.stagger, lambda s: sides * shape.running_stagger(s)),
    ]
    rows = []
    for quantity, values, model in measured:
        if values is None:
            continue
        known = inside & ~np.isnan(values)
        if not known.any():
            continue
        difference = model(place[known]) - values[known]
        worst = int(np.abs(difference).argmax())
        rows.append(
            GeometryRow(
                quantity,
                float(difference.mean()),
                float(difference.std()),
                float(difference[worst]),
                float(place[known][worst]),
                int(known.sum()),
                _mirrored(quantity, model(place[known]), values[known]),
            )
        )
    return tuple(rows)


def _mirrored(quantity: str, model: Array, measured: Array) -> str:
    """Say so where a measured stagger is that of the line with left and right exchanged."""
    if quantity != "stagger" or min(model.std(), measured.std()) < _ZIGZAG:
        return ""
    correlation = float(np.corrcoef(model, measured)[0, 1])
    if correlation > _MIRRORED:
        return ""
    return (
        f"the measured stagger goes against that of the line (correlation {correlation:.2f}): left "
        "and right are exchanged, or the record is mirrored or of the neighbouring track; "
        "'stagger_positive: right' in the mapping file turns it"
    )
