"""Error bars: what mesh and time step may have done to the statistics of a passage.

The passage is repeated with longer elements and a longer step, under the same uplift force. The
error of the step is of second order, so that with a step longer by sqrt(2) its change is the error
itself: e(sqrt(2) h) - e(h) = 2 e(h) - e(h). Elements are twice as long, which changes a force by
three times the error of a mesh of second order: the bar is on the safe side of meshes, and the
companion is cheap. A step longer than that would not be cheaper: couplings of stitch wires and of
two contact wires contract badly then. Errors of mesh and step may cancel in the change, and
extremes are not smooth: hence a factor and a least width, both from passages over random lines of
all topologies whose mesh and step were halved twice (benchmarks/error_bars.py).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from tautwire.analyses.force.cutoff import missed_deviation
from tautwire.analyses.force.section import analysed_section
from tautwire.analyses.force.statistics import contact_statistics
from tautwire.analyses.road.dynamics import (
    FEW_FRAMES,
    Choices,
    Progress,
    Simulation,
    carried_out,
)
from tautwire.analyses.road.shape import find_shape
from tautwire.errors import ConvergenceError, InputError, ModelError
from tautwire.model.build import build
from tautwire.numerics.motion.backend import Choice
from tautwire.results.accuracy import Accuracy
from tautwire.results.run import Run
from tautwire.results.statistics import FilteredStatistics, RunStatistics
from tautwire.signals.filters import Butterworth, Lowpass, SharpLowpass
from tautwire.specs.case import Case
from tautwire.specs.settings import FEWEST_GRADED, Settings

LONGER_STEP = math.sqrt(2.0)
LONGER_ELEMENTS = 2.0
"""Step and elements of the companion over those of the run, see above."""

FACTOR = 2.0
"""Width of an error bar over the change: calibrated, see above and docs/speed.md."""

LEAST = 0.01
"""Least width of an error bar, as a share of the standard deviation of the force (of the uplift
itself): changes that small are as often chance. Calibrated likewise. Extremes lie about three
standard deviations from the mean, so theirs is three times as much."""

ADVISED = "advised"
"""Name of the standard deviation up to the advised cut-off."""

_EXTREMES = ("maximum", "minimum")
_FAR = (*_EXTREMES, "statistical_maximum", "statistical_minimum")

WORDS = {
    "estimate": "one companion passage with elements 2 and a step 1.41 times as long",
    "bound": "two companion passages, one with elements 2 and one with a step 1.41 times as long, "
    "their changes added up",
}


def with_accuracy(
    run: Run,
    *,
    backend: Choice | None = None,
    watch: Callable[[str, Progress], bool] | None = None,
) -> Run:
    """Give a run the numerical errors of its statistics, as ``settings.error`` asks for.

    Parameters
    ----------
    run
        A passage that reached its end; another one is returned as it is.
    backend
        Kernels of the companions; ``settings.backend`` by default.
    watch
        Called with the name of the companion and its progress; True stops it, and the run has no
        error bars then.

    Returns
    -------
    Run
        Without error bars, but with a warning, where a companion fails.
    """
    kind = run.case.settings.error
    if kind == "none" or run.status != "done":
        return run
    forces = tuple(record.uplift_force for record in run.pantographs)
    choices = Choices(uplift_forces=forces, backend=backend, frame_interval=FEW_FRAMES)
    cases = {
        "estimate": [coarser(run.case)],
        "bound": [coarser(run.case, step=False), coarser(run.case, mesh=False)],
    }[kind]
    companions: list[Run] = []
    try:
        for number, case in enumerate(cases, 1):
            model = build(case)
            name = f"companion {number} for the numerical error"
            told = None if watch is None else lambda p, name=name: watch(name, p)
            companions.append(carried_out(Simulation(model, find_shape(model), choices), told))
            if companions[-1].status != "done":
                return run
    except (ConvergenceError, InputError, ModelError) as error:
        text = f"the numerical error could not be estimated: {error}"
        return replace(run, warnings=(*run.warnings, text))
    return replace(run, accuracy=accuracy_of(run, companions, kind))


def coarser(case: Case, *, mesh: bool = True, step: bool = True) -> Case:
    """Return a case with longer elements, a longer step, or both.

    A mesh that is as coarse as it can be is kept; the step is kept or made longer by itself.
    """
    settings, changes = case.settings, dict[str, Any]()
    changes["settings.time_step"] = settings.step() * (LONGER_STEP if step else 1.0)
    if mesh:
        nodes = settings.nodes_between_droppers
        if nodes is None:
            changes["settings.band"] = max(20.0, settings.band / LONGER_ELEMENTS)
        else:
            changes["settings.nodes_between_droppers"] = coarser_nodes(settings, nodes)
        if settings.longest_element is not None:
            changes["settings.longest_element"] = settings.longest_element * LONGER_ELEMENTS
    return case.with_(**changes)


def coarser_nodes(settings: Settings, nodes: int) -> int:
    """Return how many nodes between droppers make elements at least twice as long."""
    fewest = FEWEST_GRADED if settings.is_graded() else 2
    return max(fewest, int((nodes - 1) / LONGER_ELEMENTS) + 1)


def accuracy_of(run: Run, companions: list[Run], kind: str) -> Accuracy:
    """Compare a run with its companions.

    Parameters
    ----------
    run
    companions
        Their changes are added up.
    kind
        ``"estimate"`` or ``"bound"``.
    """
    statistics = contact_statistics(run)
    own, least = dict(figures(run)), dict(least_widths(statistics))
    others = [dict(figures(other)) for other in companions]
    changes = {n: sum(abs(other[n] - value) for other in others) for n, value in own.items()}
    widths = {n: least[n] + FACTOR * _shared(n, changes) for n in own}
    if kind == "bound":
        widths |= dict(history_errors(run, companions[-1]))
    return Accuracy(
        kind=kind,
        told=WORDS[kind],
        first_span=statistics.section.first_span,
        last_span=statistics.section.last_span,
        cpu_s=sum(float(other.counters["cpu_s"]) for other in companions),
        widths={name: width for name, width in widths.items() if math.isfinite(width)},
    )


def history_errors(run: Run, longer_step: Run) -> Iterator[tuple[str, float]]:
    """Yield the error that the time step leaves in the unfiltered force over time [N rms].

    Richardson's estimate: the error is of second order, so that of a step longer by sqrt(2) is
    twice as large, and the difference of both passages is the error itself. Of a scheme of higher
    order it is too large.

    Parameters
    ----------
    run
    longer_step
        The passage on the same mesh with a step longer by :data:`LONGER_STEP`.

    Yields
    ------
    (``pantograph/history``, float)
        Over the analysed section.
    """
    from scipy.interpolate import CubicSpline

    section = analysed_section(run)
    for record, other in zip(run.pantographs, longer_step.pantographs, strict=True):
        compared = other.active & section.contains(other.position)
        compared &= (longer_step.time >= run.time[0]) & (longer_step.time <= run.time[-1])
        own = CubicSpline(run.time, record.contact_force)(longer_step.time[compared])
        change = own - other.contact_force[compared]
        rms = float(np.sqrt(np.mean(change**2))) if change.size else math.nan
        yield f"{record.name}/history", rms / (LONGER_STEP**2 - 1.0)


def _shared(name: str, changes: Mapping[str, float]) -> float:
    """Return the change that decides a figure's width: of both extremes the larger one.

    One of them alone may hardly change by chance.
    """
    stem, _, last = name.rpartition("/")
    if last not in _EXTREMES:
        return changes[name]
    return max(changes[f"{stem}/{extreme}"] for extreme in _EXTREMES)


def figures(run: Run) -> Iterator[tuple[str, float]]:
    """Yield the figures that have an error bar, by name."""
    statistics, order = contact_statistics(run), run.case.settings.filter_order
    filters: dict[str, Lowpass] = {"sharp": SharpLowpass(), "butterworth": Butterworth(order)}
    for entry in statistics.pantographs:
        for kind, part in entry.filtered.items():
            for name, value in _of_force(part).items():
                yield f"{entry.name}/{kind}/{name}", value
            advised = missed_deviation(run, entry.name, filters[kind]).advised
            yield f"{entry.name}/{kind}/{ADVISED}", advised
        yield f"{entry.name}/loss", entry.contact_loss.percent
    yield "uplift", statistics.uplift.maximum


def _of_force(part: FilteredStatistics) -> Mapping[str, float]:
    return {
        "mean": part.mean,
        "maximum": part.maximum,
        "minimum": part.minimum,
        "standard_deviation": part.standard_deviation,
        "statistical_maximum": part.statistical_maximum,
        "statistical_minimum": part.statistical_minimum,
        **part.standard_deviations,
    }


def least_widths(statistics: RunStatistics) -> Iterator[tuple[str, float]]:
    """Yield the least width of the error bar of every figure."""
    for entry in statistics.pantographs:
        for kind, part in entry.filtered.items():
            share = LEAST * part.standard_deviation
            for name in (*_of_force(part), ADVISED):
                yield f"{entry.name}/{kind}/{name}", (3.0 if name in _FAR else 1.0) * share
        yield f"{entry.name}/loss", 0.0
    yield "uplift", LEAST * statistics.uplift.maximum
