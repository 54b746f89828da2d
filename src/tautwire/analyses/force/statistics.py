"""Statistics of a run: contact force per pantograph and span, uplift, dropper forces."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.force.contact_loss import carried_band, pantograph_loss
from tautwire.analyses.force.section import analysed_section, passage_mask, reached_supports
from tautwire.errors import InputError
from tautwire.results.run import ForceRecord, PantographRecord, Run
from tautwire.results.statistics import (
    DropperStatistics,
    FilteredStatistics,
    Histogram,
    PantographStatistics,
    RunStatistics,
    Section,
    SpanStatistics,
    UpliftStatistics,
)
from tautwire.signals.bands import BANDS, WIDEST, band_name, band_standard_deviations
from tautwire.signals.filters import Butterworth, Lowpass, SharpLowpass, evenly_spaced
from tautwire.text import MARK

Array = NDArray[np.float64]

PERCENTILES = (0.1, 1.0, 5.0, 50.0, 95.0, 99.0, 99.9)
"""Percentiles of the filtered force [%]."""

FORCE_CLASS = 10.0
"""Width of the classes of the force histogram [N]."""


def contact_statistics(
    run: Run,
    filter: Lowpass | None = None,
    section: tuple[int, int] | None = None,
) -> RunStatistics:
    """Compute the statistics of a run over the analysed section.

    The contact force is filtered over the whole record, from the instant the pantograph entered
    the line; then the samples between the limits of the section are taken. Every pantograph is
    seen through the sharp and through the Butterworth filter, side by side. Uplift and dropper
    forces are largest and smallest values while a pantograph is in the section or within half a
    span of it.

    Parameters
    ----------
    run : Run
    filter : Lowpass, optional
        Headline filter; it replaces the standard one of its kind. By default the case's setting.
    section : (first, last) span, optional
        1-based, both included; by default that of the case.

    Returns
    -------
    RunStatistics

    Examples
    --------
    >>> stats = contact_statistics(run, SharpLowpass())  # doctest: +SKIP
    >>> stats.pantograph("front").sharp.standard_deviations["0_20"]  # doctest: +SKIP
    """
    part = analysed_section(run, section)
    filters, headline = _filters(run, filter)
    carried = carried_band(run)
    pantographs = tuple(
        _pantograph_statistics(run, record, part, filters, headline, carried)
        for record in run.pantographs
    )
    return RunStatistics(
        case_name=run.case.name,
        speed=run.case.scenario.speed,
        section=part,
        pantographs=pantographs,
        uplift=passed_uplift(run, part),
        droppers=dropper_statistics(run, part),
        notes=(*_notes(run, part, pantographs), *_marks(carried)),
    )


def uniform_force(run: Run, name: str) -> ForceRecord:
    """Return a pantograph's unfiltered force since it entered, evenly spaced in time.

    A record with uneven steps is resampled at the case's time step by linear interpolation.

    Parameters
    ----------
    run : Run
    name : str
        Name of the pantograph.

    Returns
    -------
    ForceRecord
    """
    record = run.contact_force(name)
    columns = np.column_stack([record.position, record.force])
    time, values = evenly_spaced(record.time, columns, run.case.settings.step())
    return ForceRecord(time, values[:, 0], values[:, 1])


def uniform_shares(run: Run, name: str) -> dict[str, Array]:
    """Return what a pantograph presses on each contact wire, by the name of the wire.

    Parameters
    ----------
    run : Run
    name : str
        Name of the pantograph.

    Returns
    -------
    dict of str to (n_time,) N
        Evenly spaced in time as :func:`uniform_force`; 0 where the head does not reach the wire.
        Wires that it never presses on are left out, and all where the line has but one.
    """
    wires = run.equilibrium.of_role("contact")
    record = run.pantograph(name)
    shares = np.nan_to_num(record.wire_forces[record.active])
    if len(wires) < 2 or not len(shares):
        return {}
    _, values = evenly_spaced(run.time[record.active], shares, run.case.settings.step())
    return {wire.name: share for wire, share in zip(wires, values.T, strict=True) if share.any()}


def force_statistics(
    force: ForceRecord, lowpass: Lowpass, section: Section, supports: Array
) -> FilteredStatistics:
    """Compute the statistics of one force record through one filter.

    Parameters
    ----------
    force : ForceRecord
        Unfiltered and evenly spaced in time.
    lowpass : Lowpass
        Its cut-off gives mean, extremes, percentiles, histogram and per-span values; the bands
        have their own cut-offs.
    section : Section
    supports : (n_support,) m
        Positions of all supports of the line.

    Returns
    -------
    FilteredStatistics
        NaN everywhere when no sample lies in the section.

    Raises
    ------
    InputError
        When the cut-off is not below the Nyquist frequency of the record.
    """
    inside = section.contains(force.position)
    if not inside.any() or force.time.size < 2:
        return _no_statistics(lowpass, section, supports)
    try:
        filtered = lowpass.apply(force.force, force.time_step)
    except ValueError as error:
        raise InputError(f"the contact force cannot be filtered: {error}") from None
    values = filtered[inside]
    deviations = band_standard_deviations(lowpass, force.force, force.time_step, inside)
    levels = np.percentile(values, PERCENTILES)
    return FilteredStatistics(
        kind=lowpass.kind,
        description=lowpass.describe(),
        cutoff=lowpass.cutoff,
        mean=float(values.mean()),
        maximum=float(values.max()),
        minimum=float(values.min()),
        standard_deviations=deviations,
        standard_deviation=float(values.std()),
        percentiles=dict(zip(PERCENTILES, levels.tolist(), strict=True)),
        histogram=force_histogram(values),
        per_span=_per_span(force.position, filtered, section, supports),
    )


def force_histogram(values: Array, width: float = FORCE_CLASS) -> Histogram:
    """Sort forces into classes whose limits are multiples of `width`.

    Parameters
    ----------
    values : (n_sample,) N
    width : float N

    Returns
    -------
    Histogram
    """
    if values.size == 0:
        return Histogram(np.empty(0), np.empty(0))
    first = math.floor(float(values.min()) / width)
    last = math.floor(float(values.max()) / width) + 1
    edges = width * np.arange(first, last + 1, dtype=np.float64)
    counts, _ = np.histogram(values, edges)
    return Histogram(edges, counts / values.size)


def support_uplift(run: Run, section: Section) -> UpliftStatistics:
    """Find the largest uplift at every support of the section, its limits included.

    Counted while a pantograph is in the section or within half a span of it, at supports that none
    reached too: there it is what waves ahead of a pantograph do.

    Parameters
    ----------
    run : Run
    section : Section

    Returns
    -------
    UpliftStatistics
    """
    shape, inside = run.equilibrium, slice(section.first_span - 1, section.last_span + 1)
    history = shape.by_mast(run.support_uplift[passage_mask(run, section)].astype(np.float64))
    history, positions = history[:, inside], shape.mast_x[inside]
    numbers = np.arange(section.first_span, section.last_span + 2)
    uplift = history.max(axis=0) if history.shape[0] else np.full(numbers.size, np.nan)
    return UpliftStatistics(numbers, positions, uplift)


def passed_uplift(run: Run, section: Section) -> UpliftStatistics:
    """Find the largest uplift at every support of the section that a pantograph passed.

    Parameters
    ----------
    run : Run
    section : Section

    Returns
    -------
    UpliftStatistics
        As of :func:`support_uplift`; NaN at supports that no pantograph reached.
    """
    found = support_uplift(run, section)
    reached = reached_supports(run)[found.supports - 1]
    return replace(found, uplift=np.where(reached, found.uplift, np.nan))


def dropper_statistics(run: Run, section: Section) -> DropperStatistics:
    """Find force range and slack time of every dropper of the section.

    A dropper is slack while its force is zero or less; counted while a pantograph is in the
    section or within half a span of it.

    Parameters
    ----------
    run : Run
    section : Section

    Returns
    -------
    DropperStatistics
    """
    shape = run.equilibrium
    chosen = (shape.dropper_span >= section.first_span) & (shape.dropper_span <= section.last_span)
    mask = passage_mask(run, section)
    durations = _sample_durations(run.time)
    found = run.droppers.extremes(mask, durations, np.flatnonzero(chosen))
    return DropperStatistics(
        span=shape.dropper_span[chosen],
        number=shape.dropper_number[chosen],
        position=shape.dropper_x[chosen],
        static_force=shape.dropper_forces[chosen],
        maximum=found.largest,
        minimum=found.least,
        slack_time=found.slack_time,
        observed=float(durations[mask].sum()),
    )


def _filters(run: Run, given: Lowpass | None) -> tuple[dict[str, Lowpass], str]:
    """Return the filters by kind and the kind of the headline."""
    settings = run.case.settings
    filters: dict[str, Lowpass] = {
        SharpLowpass.kind: SharpLowpass(),
        Butterworth.kind: Butterworth(order=settings.filter_order),
    }
    if given is None:
        return filters, settings.filter
    return {**filters, given.kind: given}, given.kind


def _pantograph_statistics(
    run: Run,
    record: PantographRecord,
    section: Section,
    filters: dict[str, Lowpass],
    headline: str,
    carried: float,
) -> PantographStatistics:
    force = uniform_force(run, record.name)
    supports = run.equilibrium.mast_x
    heights = record.wire_height[section.contains(record.position) & record.active]
    return PantographStatistics(
        name=record.name,
        uplift_force=record.uplift_force,
        target_mean=record.target_mean,
        filtered={
            kind: replace(force_statistics(force, lowpass, section, supports), carried=carried)
            for kind, lowpass in filters.items()
        },
        headline_kind=headline,
        contact_loss=pantograph_loss(run, record, section, carried),
        contact_height_range=float(np.ptp(heights)) if heights.size else float("nan"),
    )


def _per_span(
    position: Array, filtered: Array, section: Section, supports: Array
) -> tuple[SpanStatistics, ...]:
    rows = []
    for span in range(section.first_span, section.last_span + 1):
        start, end = float(supports[span - 1]), float(supports[span])
        values = filtered[(position >= start) & (position <= end)]
        numbers = [float("nan")] * 4
        if values.size:
            numbers = [float(f(values)) for f in (np.mean, np.std, np.max, np.min)]
        rows.append(SpanStatistics(span, start, end, *numbers))
    return tuple(rows)


def _no_statistics(lowpass: Lowpass, section: Section, supports: Array) -> FilteredStatistics:
    nan = float("nan")
    return FilteredStatistics(
        kind=lowpass.kind,
        description=lowpass.describe(),
        cutoff=lowpass.cutoff,
        mean=nan,
        maximum=nan,
        minimum=nan,
        standard_deviations={band_name(band): nan for band in BANDS},
        standard_deviation=nan,
        percentiles=dict.fromkeys(PERCENTILES, nan),
        histogram=force_histogram(np.empty(0)),
        per_span=_per_span(np.empty(0), np.empty(0), section, supports),
    )


def _sample_durations(time: Array) -> Array:
    """Return the time each sample stands for (half of both neighbouring steps) [s]."""
    if time.size < 2:
        return np.zeros(time.size)
    steps = np.diff(time)
    return 0.5 * (np.concatenate([[0.0], steps]) + np.concatenate([steps, [0.0]]))


def _marks(carried: float) -> tuple[str, ...]:
    """Say what the mark means, where losses or bands have one."""
    if carried * (1.0 + 1e-6) >= WIDEST:
        return ()
    return (
        f"{MARK}: mesh and time step carry {carried:.0f} Hz; losses of contact and figures of "
        "wider bands are not to be relied on",
    )


def _notes(
    run: Run, section: Section, pantographs: tuple[PantographStatistics, ...]
) -> tuple[str, ...]:
    """Say which numbers are missing or rest on part of the section."""
    notes = []
    for record, result in zip(run.pantographs, pantographs, strict=True):
        position = record.position[record.active]
        inside = position[section.contains(position)]
        who = f"pantograph {record.name!r}"
        if inside.size == 0:
            notes.append(f"{who} never was in the analysed section; its statistics are empty")
            continue
        # A record has a sample within one step of each end; half a step is room for rounding.
        slack = 1.5 * float(np.max(np.abs(np.diff(position)), initial=0.0))
        if inside.min() > section.start + slack or inside.max() < section.end - slack:
            notes.append(
                f"{who} covered only {inside.min():.1f} m to {inside.max():.1f} m of the section "
                f"from {section.start:.1f} m to {section.end:.1f} m"
            )
        missing = [
            k.replace("_", "-") for k, v in result.headline.standard_deviations.items() if v != v
        ]
        if missing:
            notes.append(
                f"{who}: bands {', '.join(missing)} Hz reach the Nyquist frequency of the record "
                "and have no value; use a shorter time step"
            )
    return tuple(notes)
