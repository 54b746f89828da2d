"""Section V, Table 3: passages of an irregular wire, read back and compared loss by loss."""

from __future__ import annotations

import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.force.contact_loss import contact_loss
from tautwire.analyses.force.loss_comparison import compare_losses
from tautwire.analyses.force.section import analysed_section, time_in_section
from tautwire.reproductions.song2021 import published
from tautwire.reproductions.song2021.claims import Condition, under
from tautwire.reproductions.song2021.passages import Reading, Scope
from tautwire.reproductions.song2021.sections.forces import Passages
from tautwire.reproductions.song2021.sections.irregular import (
    ADAPTIVE,
    COARSE,
    FINE,
    FINEST,
    IRREGULARITIES,
    STEPS,
    VARIABLE,
    WAVES,
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
class Wire:
    """One random wire, passed in every way.

    Attributes
    ----------
    runs : mapping of str to StepRun
        By way to step.
    shape : Equilibrium
    drawn : DrawnIrregularities
    """

    runs: Mapping[str, StepRun]
    shape: Equilibrium
    drawn: DrawnIrregularities

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


@dataclass(frozen=True, eq=False)
class Trial:
    """Several random wires of one kind under one reading; their losses are judged together.

    Attributes
    ----------
    reading : Reading
    kind : str
        Key of :data:`IRREGULARITIES`.
    is_corrected : bool
        Whether all steps make up for the loss of wave speed.
    wires : tuple of Wire
        One per seed.
    """

    reading: Reading
    kind: str
    is_corrected: bool
    wires: tuple[Wire, ...]

    @property
    def condition(self) -> Condition:
        """Under which condition numbers of these wires are found."""
        more = ["wave speed corrected"] if self.is_corrected else []
        return under(self.reading, IRREGULARITIES[self.kind][0], *more)

    @property
    def name(self) -> str:
        """Reading and irregularity in words."""
        return self.condition.text

    def losses(self) -> dict[str, ContactLoss]:
        """Return the losses of all wires by way to find them."""
        every = [wire.losses() for wire in self.wires]
        return {label: _joined([own[label] for own in every]) for label in WAYS}

    def against(self, reference: str) -> dict[str, LossMatch]:
        """Compare all other ways with one of them, loss by loss, over all wires."""
        every = [wire.against(reference) for wire in self.wires]
        return {
            label: LossMatch(
                label,
                _joined([own[label].loss for own in every]),
                tuple(pair for own in every for pair in own[label].pairs),
                tuple(event for own in every for event in own[label].missed),
                tuple(event for own in every for event in own[label].spurious),
                every[0][label].shortest,
            )
            for label in every[0]
        }

    def alike(self, first: str, second: str) -> float:
        """Return the least correlation of the unfiltered forces of two ways to step."""
        return min(wire.alike(first, second) for wire in self.wires)

    def cpu(self, step: str) -> float:
        """Return the processor time of the passages with a way to step [s]."""
        return sum(wire.runs[step].cpu for wire in self.wires)


def _joined(losses: Sequence[ContactLoss]) -> ContactLoss:
    """Return the losses of several wires as one record."""
    return replace(
        losses[0],
        observed=sum(own.observed for own in losses),
        events=tuple(event for own in losses for event in own.events),
    )


def gather(passages: Passages, scope: Scope) -> list[Trial]:
    """Read the passages of section V; wires of which one is missing are left out.

    Parameters
    ----------
    passages
    scope
    """
    found: list[Trial] = []
    for reading, kind in scope.irregular:
        names = {seed: {step: irregular(step, reading, kind, seed) for step in STEPS}
                 for seed in scope.seeds}  # fmt: skip
        every = [_wire(passages, own) for own in names.values() if passages.has(*own.values())]
        if every:
            found += [
                Trial(reading, kind, corrected, tuple(_stepped(wire, corrected) for wire in every))
                for corrected in (False, True)
            ]
    return found


def _wire(passages: Passages, names: Mapping[str, str]) -> Wire:
    runs = {step: _step_run(passages, name) for step, name in names.items()}
    run = load_run(passages.paths[names[COARSE]])
    assert run.irregularities is not None
    return Wire(runs, run.equilibrium, run.irregularities)


def _stepped(wire: Wire, corrected: bool) -> Wire:  # noqa: FBT001
    """Return the wire with its plain or its corrected steps under the plain names."""
    runs = {step: own for step, own in wire.runs.items() if not step.endswith(WAVES)}
    if corrected:
        runs |= {step: wire.runs[step + WAVES] for step in runs if step + WAVES in wire.runs}
    return replace(wire, runs=runs)


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
