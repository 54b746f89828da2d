"""A run as the report needs it: filtered histories and statistics, computed once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.statistics import contact_statistics, uniform_force
from tautwire.errors import InputError
from tautwire.results.equilibrium import Elasticity
from tautwire.results.run import Run
from tautwire.results.statistics import RunStatistics
from tautwire.signals.filters import Butterworth, Lowpass, SharpLowpass

Array = NDArray[np.float64]

WIDE_CUTOFF = 200.0
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
    """

    name: str
    time: Array
    position: Array
    raw: Array
    low: Array
    wide: Array | None

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
        return self.run.equilibrium.support_x.tolist()


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
    lowpass = headline_filter(run)
    forces = tuple(_force_view(run, record.name, lowpass) for record in run.pantographs)
    return RunView(label, run, contact_statistics(run), lowpass, forces, elasticity)


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
    """Return a different label for every run: as given, or name, speed and number as needed."""
    if given is not None:
        if len(given) != len(runs):
            raise InputError(f"{len(given)} labels were given for {len(runs)} runs; give as many")
        return list(given)
    names = [run.case.name for run in runs]
    if len(set(names)) < len(names):
        names = [f"{run.case.name} {3.6 * run.case.scenario.speed:.0f} km/h" for run in runs]
    seen: dict[str, int] = {}
    labels = []
    for name in names:
        seen[name] = seen.get(name, 0) + 1
        labels.append(name if names.count(name) == 1 else f"{name} ({seen[name]})")
    return labels


def _force_view(run: Run, name: str, lowpass: Lowpass) -> ForceView:
    force = uniform_force(run, name)
    if force.time.size < 2:
        empty = np.empty(0)
        return ForceView(name, empty, empty, empty, empty, None)
    low = filtered_or_none(lowpass, force.force, force.time_step)
    wide = filtered_or_none(lowpass.with_cutoff(WIDE_CUTOFF), force.force, force.time_step)
    return ForceView(
        name, force.time, force.position, force.force, force.force if low is None else low, wide
    )


def filtered_or_none(lowpass: Lowpass, signal: Array, time_step: float) -> Array | None:
    """Filter a record; None when the cut-off is not below its Nyquist frequency."""
    if lowpass.cutoff >= 0.5 / time_step:
        return None
    return lowpass.apply(signal, time_step)
