"""Corrections of a line as built, in the order of what they do to the contact force.

What a correction does is found by passages over the spans around it; see
:mod:`tautwire.analyses.survey.local`. The first ten are computed once more, each on the line on
which those before it are made: what two of them do together is not the sum of what each does alone.
The changes of the force, added up, predict standard deviation, maximum, minimum and loss. What the
first ten really gain is computed by a passage over the whole line.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.road.pipeline import run_line
from tautwire.analyses.road.shape import find_design
from tautwire.analyses.survey.as_built import with_values
from tautwire.analyses.survey.corrections import (
    LEAST,
    Correction,
    built_values,
    corrections_of,
)
from tautwire.analyses.survey.kept import computed, keep_passage, kept_passage, processes
from tautwire.analyses.survey.local import Felt, Passage, place_of, simulated
from tautwire.analyses.survey.surveyed_line import SurveyedLine
from tautwire.model.build import Model, build
from tautwire.model.passage import working_height
from tautwire.results.equilibrium import Equilibrium
from tautwire.specs.case import Case

Array = NDArray[np.float64]

TOGETHER = 10
"""Corrections that are listed for the crew and checked together by a full passage."""


@dataclass(frozen=True)
class Figures:
    """Figures of the force of the first pantograph over the analysed section, up to 20 Hz.

    Attributes
    ----------
    standard_deviation, maximum, minimum : float N
    loss : float
        Share of the samples, unfiltered, without contact.
    """

    standard_deviation: float
    maximum: float
    minimum: float
    loss: float


@dataclass(frozen=True)
class Ranked:
    """A correction with what it does.

    Attributes
    ----------
    correction : Correction
    effect : float N
        By how much it changes the force up to 20 Hz: root mean square of all of the change, as if
        it were spread over a span of mean length.
    alone : Figures
        Figures of the line with this correction alone, predicted.
    together : Figures
        With this and all corrections before it in the list, predicted: each of the first ten from
        what it does after those before it, the others from what they do alone.
    uplift : float m
        Change of the largest uplift at the supports around it.
    """

    correction: Correction
    effect: float
    alone: Figures
    together: Figures
    uplift: float


@dataclass(frozen=True, eq=False)
class Ranking:
    """Corrections in order of what they do.

    Attributes
    ----------
    case : Case
        As built, with the uplift forces that were used.
    built : Figures
        As it stands.
    ranked : tuple of Ranked
        The largest effect first.
    checked : Figures
        Of a full passage with the first ten corrections made: computed, not predicted.
    passages : int
        Over some spans; two over the whole line come on top.
    length : float m
    cpu : float s
        Processor time that was spent now on passages.
    """

    case: Case
    built: Figures
    ranked: tuple[Ranked, ...]
    checked: Figures
    passages: int
    length: float
    cpu: float


def rank(
    design: Case,
    built: Case,
    *,
    least: float = LEAST,
    workers: int = 1,
    keep: Path | None = None,
    watch: Callable[[int, int], None] | None = None,
) -> Ranking:
    """Rank the corrections of a line as built.

    Parameters
    ----------
    design, built
        The line as it should be and as it is, see :func:`as_built`; ``built`` gives speed,
        pantographs, mesh and section.
    least : float m
        Deviations below this are left alone.
    workers : int
        Processes that compute passages; a script that wants more than one runs under
        ``if __name__ == "__main__":``.
    keep
        Folder in which passages are kept: a ranking that was stopped goes on from there.
    watch
        Called with the number of spans whose corrections are known and how many there are, at the
        beginning and after every span.

    Returns
    -------
    Ranking

    Raises
    ------
    InputError
        When the two lines differ in more than lengths and heights, or nothing deviates.
    ConvergenceError
        When a passage fails.
    """
    line = SurveyedLine(build(design.with_condition(None)))
    whole = _Whole(line, built, keep)
    whole.values = built_values(line, design, built)
    corrections = corrections_of(line, whole.values, least)
    ordered = sorted(corrections, key=lambda one: (one.span, one.row))
    by_span = [list(own) for _, own in groupby(ordered, key=lambda one: one.span)]
    with processes(workers) as pool:
        felt, cpu = _felt(whole, [(whole.values, own) for own in by_span], pool, watch)
        found = sorted(felt, key=lambda one: (-felt[one].energy, one.row))
        first = found[:TOGETHER]
        after, more = _felt(whole, list(_one_after_another(whole.values, first)), pool, None)
    base, section = whole.passage(()), _section(line, whole.case)
    return Ranking(
        case=whole.case,
        built=_figures(base, section),
        ranked=_ranked(base, section, [(one, felt[one], after.get(one)) for one in found], line),
        checked=_figures(whole.passage(first), section),
        passages=len(corrections) + len(by_span) + 2 * len(first),
        length=line.model.line.masts[-1],
        cpu=cpu + more + whole.cpu,
    )


class _Whole:
    """The whole line as built; computes its passages or takes those that are kept."""

    def __init__(self, line: SurveyedLine, built: Case, keep: Path | None) -> None:
        self.line, self.keep, self.cpu = line, keep, 0.0
        self.values = line.design.values
        built = built.with_condition(None)
        model = build(built)
        shape = find_design(model)
        if built.scenario.target_mean_force() is not None:
            built = self._tuned(built, model, shape)
        height = working_height(model, shape)
        self.case = built.with_(pantographs=[
            one if one.working_height is not None else one.with_(working_height=height)
            for one in built.pantographs
        ])  # fmt: skip

    def _tuned(self, built: Case, model: Model, shape: Equilibrium) -> Case:
        """Return the case with the uplift forces that its mean force needs."""
        run = run_line(model, shape)
        self.cpu += float(run.counters["cpu_s"])
        forces = [float(record.uplift_force) for record in run.pantographs]
        changes: dict[str, Any] = {"scenario.mean_force": None, "scenario.uplift_force": forces}
        return built.with_(**changes)

    def passage(self, corrections: Sequence[Correction]) -> Passage:
        """Return the passage with some corrections made."""
        values = self.values.copy()
        for one in corrections:
            values[one.row] = one.design
        case = with_values(self.case, self.line, values)
        path = None if self.keep is None else self.keep / f"{case.hash()[:32]}.npz"
        found = None if path is None else kept_passage(path)
        if found is None:
            found = simulated(case)
            self.cpu += found.cpu
            if path is not None:
                keep_passage(path, found)
        return found


def _one_after_another(
    values: Array, corrections: Sequence[Correction]
) -> Iterator[tuple[Array, list[Correction]]]:
    """Yield corrections, each with the line on which those before it are made."""
    here = values
    for one in corrections:
        yield here, [one]
        here = here.copy()
        here[one.row] = one.design


def _felt(
    whole: _Whole,
    wanted: Sequence[tuple[Array, list[Correction]]],
    pool: Executor | None,
    watch: Callable[[int, int], None] | None,
) -> tuple[dict[Correction, Felt], float]:
    """Return what corrections of a span do on a line, and the processor time it took [s]."""
    places = [place_of(whole.line, whole.case, values, own[0].span, own) for values, own in wanted]
    if watch is not None:
        watch(0, len(places))
    found: dict[Correction, Felt] = {}
    spent = 0.0
    done = computed(places, pool, whole.keep)
    for count, (number, felt, cpu) in enumerate(done, 1):
        found.update(zip(wanted[number][1], felt, strict=True))
        spent += cpu
        if watch is not None:
            watch(count, len(places))
    return found, spent


def _section(line: SurveyedLine, case: Case) -> tuple[float, float]:
    first, last = case.resolved_section()
    return line.model.line.masts[first - 1], line.model.line.masts[last]


def _figures(passage: Passage, section: tuple[float, float]) -> Figures:
    inside = (passage.position >= section[0]) & (passage.position <= section[1])
    force = passage.filtered[inside]
    return Figures(
        float(force.std()),
        float(force.max()),
        float(force.min()),
        float(np.mean(passage.raw[inside] <= 0.0)),
    )


def _with(base: Passage, felt: Felt) -> Passage:
    """Return a passage with the changes of one more correction added."""
    low, high = felt.position[[0, -1]]
    rows = np.flatnonzero((base.position >= low) & (base.position <= high))
    at = base.position[rows]
    filtered, raw = base.filtered.copy(), base.raw.copy()
    filtered[rows] += np.interp(at, felt.position, felt.filtered)
    raw[rows] += np.interp(at, felt.position, felt.raw)
    return replace(base, filtered=filtered, raw=raw)


def _ranked(
    base: Passage,
    section: tuple[float, float],
    found: Sequence[tuple[Correction, Felt, Felt | None]],
    line: SurveyedLine,
) -> tuple[Ranked, ...]:
    """Return the corrections with their figures, in the order in which they are given.

    That is the order of the effect, not of the gain of a figure: two deviations may make up for
    each other, and the larger one is to be set right first all the same.
    """
    masts = line.model.line.masts
    mean_span = masts[-1] / (len(masts) - 1)
    ranked, here = [], base
    for one, alone, after in found:
        here = _with(here, after or alone)
        ranked.append(
            Ranked(
                correction=one,
                effect=float(np.sqrt(alone.energy / mean_span)),
                alone=_figures(_with(base, alone), section),
                together=_figures(here, section),
                uplift=alone.uplift,
            )
        )
    return tuple(ranked)
