"""Contact loss of a run: how often, how long, where."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.force.section import analysed_section, time_in_section
from tautwire.line.expand import expand
from tautwire.model.resolution import resolution
from tautwire.results.equilibrium import Equilibrium
from tautwire.results.run import PantographRecord, Run
from tautwire.results.statistics import ContactLoss, LossEvent, Section
from tautwire.signals.losses import (
    clip_intervals,
    counted_intervals,
    intervals_between,
    loss_intervals,
)

Array = NDArray[np.float64]


def contact_loss(
    run: Run, section: tuple[int, int] | None = None, *, counted: bool = False
) -> tuple[ContactLoss, ...]:
    """Find the contact losses of every pantograph inside the analysed section.

    A run whose step control located the changes of contact is read by these instants. In another
    run, separation and re-contact are located between the samples of the unfiltered gap by a
    straight line (see :func:`tautwire.signals.losses.loss_intervals`). A loss that crosses a limit
    of the section counts with its part inside.

    Parameters
    ----------
    run : Run
    section : (first, last) span, optional
        1-based, both included; by default that of the case.
    counted : bool
        Count lost samples instead, each as one time step: what a program does that knows no
        instants between its samples.

    Returns
    -------
    tuple of ContactLoss
        One per pantograph, in their order.
    """
    part, carried = analysed_section(run, section), carried_band(run)
    return tuple(
        pantograph_loss(run, record, part, carried, counted=counted) for record in run.pantographs
    )


def carried_band(run: Run) -> float:
    """Return the highest frequency that mesh and time step of a run carry [Hz]."""
    return resolution(run.case, expand(run.case)).carried


def pantograph_loss(
    run: Run, record: PantographRecord, section: Section, carried: float, *, counted: bool = False
) -> ContactLoss:
    """Find the contact losses of one pantograph inside a section.

    Parameters
    ----------
    run : Run
    record : PantographRecord
    section : Section
    carried : float Hz
        Highest frequency that mesh and time step carry.
    counted : bool
        Count lost samples, each as one time step.

    Returns
    -------
    ContactLoss
    """
    window = time_in_section(run, record, section)
    if window is None:
        return ContactLoss(record.name, 0.0, (), carried)
    time, position = run.time[record.active], record.position[record.active]
    intervals = _intervals(run, record, counted=counted)
    start, end, is_cut = clip_intervals(*intervals, *window)
    is_cut |= (start <= time[0]) | (end >= time[-1])
    places = np.interp(start, time, position)
    events = tuple(
        LossEvent(float(t), float(u - t), float(x), nearest_place(run.equilibrium, x), bool(cut))
        for t, u, x, cut in zip(start, end, places, is_cut, strict=True)
    )
    return ContactLoss(record.name, window[1] - window[0], events, carried)


def _intervals(run: Run, record: PantographRecord, *, counted: bool) -> tuple[Array, Array]:
    """Return begin and end of every loss of one pantograph [s]."""
    time, gap = run.time[record.active], record.gap[record.active]
    if counted:
        return counted_intervals(time, gap)
    if run.events is None:
        return loss_intervals(time, gap)
    number = next(i for i, other in enumerate(run.pantographs) if other is record)
    own = run.events.pantograph == number
    if not time.size:
        return np.empty(0), np.empty(0)
    begins_lost = bool(gap[np.argmax(~np.isnan(gap))] >= 0.0)
    limits = (float(time[0]), float(time[-1]))
    return intervals_between(
        run.events.time[own], run.events.opens[own], limits, begins_lost=begins_lost
    )


def nearest_place(shape: Equilibrium, position: float) -> str:
    """Name the support or dropper nearest to a position [m], for example ``"support 8"``."""
    support = int(np.argmin(np.abs(shape.support_x - position)))
    name = f"support {shape.support_number[support]}"
    if shape.dropper_x.size == 0:
        return name
    dropper = int(np.argmin(np.abs(shape.dropper_x - position)))
    if abs(shape.support_x[support] - position) <= abs(shape.dropper_x[dropper] - position):
        return name
    return f"dropper {shape.dropper_number[dropper]} of span {shape.dropper_span[dropper]}"
