"""Section V, Table 3: passages of an irregular wire, read back and compared loss by loss."""

from __future__ import annotations

import statistics
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.force.contact_loss import contact_loss
from tautwire.analyses.force.loss_comparison import compare_losses
from tautwire.analyses.force.section import analysed_section, time_in_section
from tautwire.reproductions.song2021 import published
from tautwire.reproductions.song2021.passages import Scope
from tautwire.reproductions.song2021.sections.forces import Passages
from tautwire.reproductions.song2021.sections.irregular import (
    ADAPTIVE,
    COARSE,
    FINE,
    FINEST,
    IRREGULARITIES,
    STEPS,
    VARIABLE,
    irregular,
)
from tautwire.results.equilibrium import Equilibrium
from tautwire.results.irregularity import DrawnIrregularities
from tautwire.results.loss_comparison import LossMatch
from tautwire.results.statistics import ContactLoss
from tautwire.results.storage import load_run

Array = NDArray[np.float64]

WAYS: Mapping[str, tuple[str, bool]] = {
    "1 ms, counted": (COARSE, True),
    "1 ms, interpolated": (COARSE, False),
    "variable step": (VARIABLE, False),
    "0.2 ms, counted": (FINE, True),
    "adaptive step": (ADAPTIVE, False),
    "0.05 ms": (FINEST, False),
}
"""Ways to find losses: the passage, and whether samples without contact are counted."""

COUNTED_1, INTERPOLATED, PAPER, COUNTED_5, REFINED, REFERENCE = WAYS
"""Labels of the ways; ``PAPER`` is the paper's variable step."""


@dataclass(frozen=True, eq=False)
class StepRun:
    """What is kept of a passage.

    Attributes
    ----------
    time : (n_time,) s
        Of the analysed section.
    force : (n_time,) N
        Unfiltered.
    gap : (n_time,) m
    separations : (n_event,) s
        Instants at which the step control ended a step because contact opened; empty without one.
    located, counted : ContactLoss
        Losses with interpolated or located instants, and by counting samples.
    cpu : float s
        Processor time of the passage.
    """

    time: Array
    force: Array
    gap: Array
    separations: Array
    located: ContactLoss
    counted: ContactLoss
    cpu: float


@dataclass(frozen=True, eq=False)
class Trial:
    """One irregular wire at one contact stiffness, passed in every way.

    Attributes
    ----------
    stiffness : int kN/m
    kind : str
        Key of :data:`IRREGULARITIES`.
    runs : mapping of str to StepRun
        By way to step.
    shape : Equilibrium
    drawn : DrawnIrregularities
    """

    stiffness: int
    kind: str
    runs: Mapping[str, StepRun]
    shape: Equilibrium
    drawn: DrawnIrregularities

    @property
    def name(self) -> str:
        """Contact stiffness and irregularity in words."""
        return f"{self.stiffness} kN/m, {IRREGULARITIES[self.kind][0]}"

    def losses(self) -> dict[str, ContactLoss]:
        """Return the losses by way to find them."""
        return {
            label: self.runs[step].counted if is_counted else self.runs[step].located
            for label, (step, is_counted) in WAYS.items()
        }

    def against(self, reference: str) -> dict[str, LossMatch]:
        """Compare all other ways with one of them, loss by loss."""
        found = compare_losses(self.losses(), reference)
        return {match.label: match for match in found.matches}

    def alike(self, first: str, second: str) -> float:
        """Return the correlation of the unfiltered forces of two ways to step."""
        one, two = self.runs[first], self.runs[second]
        other = np.interp(one.time, two.time, two.force)
        return float(np.corrcoef(one.force, other)[0, 1])


def gather(passages: Passages, scope: Scope) -> list[Trial]:
    """Read the passages of section V; wires of which one is missing are left out.

    Parameters
    ----------
    passages
    scope
    """
    return [
        _trial(passages, stiffness, kind)
        for stiffness in scope.irregular
        for kind in scope.kinds
        if passages.has(*(irregular(step, stiffness, kind) for step in STEPS))
    ]


def _trial(passages: Passages, stiffness: int, kind: str) -> Trial:
    runs = {step: _step_run(passages, irregular(step, stiffness, kind)) for step in STEPS}
    run = passages.run(irregular(COARSE, stiffness, kind))
    assert run.irregularities is not None
    return Trial(stiffness, kind, runs, run.equilibrium, run.irregularities)


def _step_run(passages: Passages, name: str) -> StepRun:
    """Read a passage; its histories of the whole line, which are large, are not kept."""
    run = load_run(passages.paths[name])
    record = run.pantographs[0]
    window = time_in_section(run, record, analysed_section(run)) or (0.0, 0.0)
    inside = record.active & (run.time >= window[0]) & (run.time <= window[1])
    events = run.events
    return StepRun(
        time=run.time[inside].copy(),
        force=record.contact_force[inside].copy(),
        gap=record.gap[inside].copy(),
        separations=np.empty(0) if events is None else events.time[events.opens],
        located=contact_loss(run)[0],
        counted=contact_loss(run, counted=True)[0],
        cpu=float(run.counters["cpu_s"]),
    )


def is_better(trial: Trial, way: str, other: str) -> float:
    """Return the chance of so clear an advantage of one way over another if there were none.

    Wilcoxon's signed-rank test, one-sided, on the errors of the losses that both ways share with
    the reference; NaN with fewer than five of them.

    Parameters
    ----------
    trial
    way, other
        Labels of :data:`WAYS`.
    """
    from scipy.stats import wilcoxon

    found = trial.against(REFERENCE)
    errors = {
        label: {id(p.reference): abs(p.difference) for p in found[label].judged}
        for label in (way, other)
    }
    both = [key for key in errors[way] if key in errors[other]]
    if len(both) < 5:
        return float("nan")
    first, second = ([errors[label][key] for key in both] for label in (way, other))
    return float(np.asarray(wilcoxon(first, second, alternative="less"))[1])


def published_errors(column: tuple[float | None, ...]) -> tuple[float, float, int]:
    """Return median and largest error [%], and losses not counted, of a column of Table 3.

    Errors are those with respect to the variable step, as in the paper.

    Parameters
    ----------
    column
        Durations [ms]; None where a loss was not counted.
    """
    pairs = list(zip(column, published.LOSS_VARIABLE, strict=True))
    errors = [100.0 * abs(a - b) / b for a, b in pairs if a is not None and b is not None]
    missed = sum(a is None and b is not None for a, b in pairs)
    return statistics.median(errors), max(errors), missed
