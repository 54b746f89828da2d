"""The analysed section of a run and when the pantographs were in it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tautwire.errors import InputError
from tautwire.results.run import PantographRecord, Run
from tautwire.results.statistics import Section

Array = NDArray[np.float64]


def analysed_section(run: Run, section: tuple[int, int] | None = None) -> Section:
    """Return the analysed section of a run with its limits in metres.

    Parameters
    ----------
    run : Run
    section : (first, last) span, optional
        1-based, both included; by default that of the case.

    Returns
    -------
    Section

    Raises
    ------
    InputError
        When the spans do not lie in the line.
    """
    first, last = section if section is not None else run.case.resolved_section()
    supports = run.equilibrium.mast_x
    spans = supports.size - 1
    if not 1 <= first <= last <= spans:
        raise InputError(
            f"section [{first}, {last}] must be two spans of the line, first not after last, "
            f"from 1 to {spans}"
        )
    return Section(first, last, float(supports[first - 1]), float(supports[last]))


def time_in_section(
    run: Run, record: PantographRecord, section: Section
) -> tuple[float, float] | None:
    """Return when a pantograph was in the section, None when it never was.

    The instants at which it passes the limits are interpolated between samples; a record that
    ends inside the section ends the interval.

    Parameters
    ----------
    run : Run
    record : PantographRecord
    section : Section

    Returns
    -------
    (first, last) s, or None
    """
    time, position = run.time[record.active], record.position[record.active]
    if time.size < 2:
        return None
    low, high = min(position[0], position[-1]), max(position[0], position[-1])
    if high <= section.start or low >= section.end:
        return None
    order = slice(None) if position[-1] >= position[0] else slice(None, None, -1)
    limits = np.clip([section.start, section.end], low, high)
    first, last = sorted(np.interp(limits, position[order], time[order]).tolist())
    return (first, last) if last > first else None


def reached_supports(run: Run) -> NDArray[np.bool_]:
    """Mark the supports that some pantograph passed while it was on the line.

    Parameters
    ----------
    run : Run

    Returns
    -------
    (n_span + 1,) bool
        In the order of ``Equilibrium.mast_x``.
    """
    supports = run.equilibrium.mast_x
    reached = np.zeros(supports.size, dtype=np.bool_)
    for record in run.pantographs:
        way = record.position[record.active]
        if way.size:
            reached |= (supports >= way.min()) & (supports <= way.max())
    return reached


def passage_mask(run: Run, section: Section) -> NDArray[np.bool_]:
    """Mark the samples at which some pantograph runs under or close to the section.

    Half a span is added at both ends (half of the section's outer spans): the uplift of the
    support at a limit peaks when the pantograph is there, and the peak must not be cut in two.

    Parameters
    ----------
    run : Run
    section : Section

    Returns
    -------
    (n_time,) bool
    """
    supports = run.equilibrium.mast_x
    before = 0.5 * float(supports[section.first_span] - supports[section.first_span - 1])
    after = 0.5 * float(supports[section.last_span] - supports[section.last_span - 1])
    mask = np.zeros(run.time.size, dtype=np.bool_)
    for record in run.pantographs:
        near = (record.position >= section.start - before) & (
            record.position <= section.end + after
        )
        mask |= near & record.active
    return mask
