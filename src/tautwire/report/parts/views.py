"""A run as the report needs it: filtered histories and statistics, computed once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.force.statistics import contact_statistics, uniform_force, uniform_shares
from tautwire.errors import InputError
from tautwire.results.equilibrium import Elasticity
from tautwire.results.run import Run
from tautwire.results.statistics import RunStatistics
from tautwire.signals.bands import WIDEST
from tautwire.signals.filters import Butterworth, Lowpass, SharpLowpass
from tautwire.text import DESIGN

Array = NDArray[np.float64]

WIDE_CUTOFF = WIDEST
"""Cut-off of the second force curve [Hz]."""


@dataclass(frozen=True, eq=False)
class ForceView:
    """Contact force of one pantograph, unfiltered and low-passed, evenly spaced in time.

    Attributes
    ----------
    name : str
    time : (n_time,) s
    position : (n_time,) m
    raw, low : (n_time,) N
        Unfiltered, and low-passed at the headline cut-off.
    wide : (n_time,) N or None
        Low-passed at 200 Hz; None when the record is sampled too slowly for that.
    shares : dict of str to (n_time,) N
        Of each contact wire, low-passed as ``low``; empty where the line has but one.
    """

    name: str
    time: Array
    position: Array
    raw: Array
    low: Array
    wide: Array | None
    shares: dict[str, Array]

    @property
    def is_empty(self) -> bool:
        """True when the pantograph never entered the line."""
        return self.time.size < 2


@dataclass(frozen=True, eq=False)
class RunView:
    """One run, its label in legends, its statistics and its filtered forces.

    Attributes
    ----------
    label : str
    run : Run
    statistics : RunStatistics
    lowpass : Lowpass
        Headline filter of the case.
    forces : tuple of ForceView
        One per pantograph.
    elasticity : Elasticity or None
    """

    label: str
    run: Run
    statistics: RunStatistics
    lowpass: Lowpass
    forces: tuple[ForceView, ...]
    elasticity: Elasticity | None

    @property
    def section(self) -> tuple[float, float]:
        """Limits of the analysed section [m]."""
        return self.statistics.section.start, self.statistics.section.end

    @property
    def supports(self) -> list[float]:
        """Positions of the supports [m]."""
        return self.run.equilibrium.mast_x.tolist()


@dataclass(frozen=True, eq=False)
class Series:
    """One pantograph of one run, as a series of a figure.

    Attributes
    ----------
    label : str
        Empty when the page shows a single series.
    view : RunView
    force : ForceView
    number : int
        From 0 over all series of the page; decides the look.
    """

    label: str
    view: RunView
    force: ForceView
    number: int

    def named(self, text: str) -> str:
        """Return a legend entry."""
        return f"{self.label}, {text}" if self.label else text


def headline_filter(run: Run) -> Lowpass:
    """Return the filter the case asks for, at 20 Hz."""
    settings = run.case.settings
    if settings.filter == Butterworth.kind:
        return Butterworth(order=settings.filter_order)
    return SharpLowpass()


def prepare(run: Run, label: str, elasticity: Elasticity | None = None) -> RunView:
    """Filter the histories of a run and compute its statistics."""
    run, lowpass = finite_part(run), headline_filter(run)
    forces = tuple(_force_view(run, record.name, lowpass) for record in run.pantographs)
    return RunView(label, run, contact_statistics(run), lowpass, forces, elasticity)


def finite_part(run: Run) -> Run:
    """Return a run cut before the first force or height that is not a finite number.

    A run that failed may end with such samples; a filter would spread them over the record.
    """
    bad = np.zeros(run.time.size, dtype=np.bool_)
    for record in run.pantographs:
        histories = np.column_stack([record.contact_force, record.gap, record.wire_height])
        bad |= record.active & ~np.isfinite(histories).all(axis=1)
    if not bad.any():
        return run
    end = int(np.argmax(bad))
    names = _HISTORIES
    records = tuple(
        replace(record, **{name: getattr(record, name)[:end] for name in names})
        for record in run.pantographs
    )
    return replace(
        run,
        message=f"{run.message} Values are not finite from t = {run.time[end]:.3f} s on; the "
        "report stops there.".strip(),
        time=run.time[:end],
        pantographs=records,
        support_uplift=run.support_uplift[:end],
        droppers=run.droppers.until(end),
    )


_HISTORIES = (
    "position",
    "contact_force",
    "gap",
    "wire_height",
    "wire_forces",
    "stage_heights",
    "active",
)


def series(views: Sequence[RunView]) -> list[Series]:
    """List all pantographs of all runs in the order of their looks."""
    pairs = [(view, force) for view in views for force in view.forces]
    many_pantographs = any(len(view.forces) > 1 for view in views)
    found = []
    for number, (view, force) in enumerate(pairs):
        parts = [view.label] if len(views) > 1 else []
        parts += [force.name] if many_pantographs else []
        found.append(Series(", ".join(parts), view, force, number))
    return found


def labels_of(runs: Sequence[Run], given: Sequence[str] | None = None) -> list[str]:
    """Return a different label for every run: as given, or what tells them apart."""
    if given is not None:
        if len(given) != len(runs):
            raise InputError(f"{len(given)} labels were given for {len(runs)} runs; give as many")
        return list(given)
    columns = [_distinctions(run) for run in runs]
    labels = [run.case.name if len({r.case.name for r in runs}) > 1 else "" for run in runs]
    for name in columns[0]:
        values = [column[name] for column in columns]
        if len(set(labels)) < len(runs) and len(set(values)) > 1:
            labels = [", ".join(filter(None, pair)) for pair in zip(labels, values, strict=True)]
    if not any(labels):
        labels = [run.case.name for run in runs]
    return [
        f"{label} ({labels[: n + 1].count(label)})" if labels.count(label) > 1 else label
        for n, label in enumerate(labels)
    ]


def _distinctions(run: Run) -> dict[str, str]:
    """Return what can tell runs of the same line apart, the most telling first."""
    case, line = run.case, run.case.line
    ends = (str(line.ends.left), str(line.ends.right))
    target, count = case.scenario.target_mean_force(), len(case.pantographs)
    prescribed = [f"{record.uplift_force:g} N uplift" for record in run.pantographs]
    return {
        "speed": f"{round(3.6 * case.scenario.speed, 2):g} km/h",
        "condition": case.condition or DESIGN,
        "stiffness": f"{1e-3 * case.settings.contact_stiffness:g} kN/m",
        "pantographs": f"{count} pantograph{'s' if count > 1 else ''}",
        "mesh": f"mesh {case.settings.mesh()}",
        "step": _step(run),
        "integrator": case.settings.integrator.method,
        "closure": f"closure {case.supports.closure}",
        "ends": ends[0] if ends[0] == ends[1] else "/".join(ends),
        "messenger": f"messenger {case.supports.messenger_longitudinal}",
        "direction": case.scenario.direction,
        "force": prescribed[0] if target is None else f"mean {target:g} N",
        "spans": f"{line.spans} spans",
        "backend": str(run.counters.get("backend", "")),
    }


def _step(run: Run) -> str:
    """Return step and step control as a label: ``"1 ms"``, ``"adaptive 1 ms"``."""
    settings = run.case.settings
    size = 1e3 * float(run.counters.get("time_step", settings.step()))
    method = str(run.counters.get("step_control", settings.step_control.method)).split()[0]
    return f"{size:g} ms" if method == "constant" else f"{method} {size:g} ms"


def _force_view(run: Run, name: str, lowpass: Lowpass) -> ForceView:
    force = uniform_force(run, name)
    if force.time.size < 2:
        empty = np.empty(0)
        return ForceView(name, empty, empty, empty, empty, None, {})
    low = filtered_or_none(lowpass, force.force, force.time_step)
    wide = filtered_or_none(lowpass.with_cutoff(WIDE_CUTOFF), force.force, force.time_step)
    shares = uniform_shares(run, name)
    if low is not None:
        shares = {wire: lowpass.apply(share, force.time_step) for wire, share in shares.items()}
    low = force.force if low is None else low
    return ForceView(name, force.time, force.position, force.force, low, wide, shares)


def filtered_or_none(lowpass: Lowpass, signal: Array, time_step: float) -> Array | None:
    """Filter a record; None when the cut-off is not below its Nyquist frequency."""
    if lowpass.cutoff >= 0.5 / time_step:
        return None
    return lowpass.apply(signal, time_step)
