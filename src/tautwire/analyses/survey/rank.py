"""Corrections of a line as built, in the order in which they gain most.

A deviation is felt from the span before it to two spans behind it. So one passage over the whole
line tells what many corrections gain: one in every fourth span is made, and the change of the force
in the four spans around each belongs to it. The number of passages is that of the deviations of the
worst spans, whatever the length of the line. Corrections together change the force by about the sum
of their changes, which gives standard deviation, maximum, minimum and loss for any set of them.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.force.section import analysed_section
from tautwire.analyses.force.statistics import support_uplift, uniform_force
from tautwire.analyses.road.dynamics import simulate
from tautwire.analyses.road.pipeline import run_line
from tautwire.analyses.road.shape import find_design
from tautwire.analyses.survey.as_built import with_values
from tautwire.analyses.survey.surveyed_line import SurveyedLine
from tautwire.errors import InputError
from tautwire.files import write_whole
from tautwire.model.build import build
from tautwire.results.run import Run
from tautwire.signals.filters import SharpLowpass
from tautwire.specs.case import Case

Array = NDArray[np.float64]

SPACING = 4
"""Spans between corrections that share a passage: one before, the own one and two behind it."""
BEFORE = 1
"""Spans before a correction in which its effect is counted: the wave runs ahead of the train."""
LEAST = 0.003
"""Least deviation that is looked at [m]: what a crew can set. From memory."""
TOGETHER = 10
"""Corrections that are chosen together and checked by a full passage."""


@dataclass(frozen=True)
class Correction:
    """Something to set right.

    Attributes
    ----------
    row : int
        Of the unknowns of the line.
    kind : str
        ``dropper``, ``messenger height`` or ``contact height``.
    span, number : int
        Span; number of the dropper in it, or of the support.
    x : float m
    built, design : float m
        Length of the dropper; height above the design.
    """

    row: int
    kind: str
    span: int
    number: int
    x: float
    built: float
    design: float

    @property
    def change(self) -> float:
        """What has to be added to what is there [m]."""
        return self.design - self.built


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
    alone : Figures
        Figures of the line with this correction alone.
    together : Figures
        With this and all corrections before it in the list.
    uplift : float m
        Change of the largest uplift at the supports around it.
    """

    correction: Correction
    alone: Figures
    together: Figures
    uplift: float


@dataclass(frozen=True, eq=False)
class Ranking:
    """Corrections in order of what they gain.

    Attributes
    ----------
    case : Case
        As built, with the uplift forces that were used.
    built : Figures
        As it stands.
    ranked : tuple of Ranked
    checked : Figures
        Of a full passage with the first ten corrections made.
    passages : int
    length : float m
    cpu : float s
        Of the passages that were computed now.
    """

    case: Case
    built: Figures
    ranked: tuple[Ranked, ...]
    checked: Figures
    passages: int
    length: float
    cpu: float


@dataclass(frozen=True, eq=False)
class _Passage:
    """What is kept of a passage: place, force filtered and not, uplifts, CPU time."""

    position: Array
    filtered: Array
    raw: Array
    uplift: Array
    cpu: float


def rank(
    design: Case,
    built: Case,
    *,
    least: float = LEAST,
    keep: Path | None = None,
    watch: Callable[[int, int], None] | None = None,
) -> Ranking:
    """Rank the corrections of a line as built.

    Parameters
    ----------
    design, built
        The line as it should be and as it is, see :func:`as_built`; ``built`` gives speed,
        pantographs and section.
    least : float m
        Deviations below this are left alone.
    keep
        Folder in which passages are kept: a ranking that was stopped goes on from there.
    watch
        Called before every passage with its number and how many there are.

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
    case, start = _prepared(built)
    values = _values(line, design, built)
    corrections = _corrections(line, values, least)
    groups = _groups(corrections)
    if watch is not None:
        watch(0, len(groups) + 2)
    runner = _Runner(line, case, values, keep)
    base = runner.passage(()) if start is None else runner.kept(start, ())
    felt: dict[Correction, _Felt] = {}
    for number, group in enumerate(groups, 1):
        if watch is not None:
            watch(number, len(groups) + 2)
        passage = runner.passage(group)
        felt.update({one: _felt(line, one, base, passage) for one in group})
    section = _section(line, case)
    ranked = _ranked(base, section, felt)
    first = tuple(one.correction for one in ranked[:TOGETHER])
    checked = _figures(runner.passage(first), section)
    return Ranking(
        case=case,
        built=_figures(base, section),
        ranked=ranked,
        checked=checked,
        passages=len(groups) + 2,
        length=line.model.line.masts[-1],
        cpu=runner.cpu,
    )


def _prepared(built: Case) -> tuple[Case, Run | None]:
    """Return the case with fixed uplift forces, and the passage that found them if one did."""
    if built.scenario.target_mean_force() is None:
        return built.with_condition(None), None
    model = build(built.with_condition(None))
    run = run_line(model, find_design(model))
    forces = [float(record.uplift_force) for record in run.pantographs]
    changes: dict[str, Any] = {"scenario.mean_force": None, "scenario.uplift_force": forces}
    return built.with_condition(None).with_(**changes), run


def _values(line: SurveyedLine, design: Case, built: Case) -> Array:
    """Return the unknowns of the line as built.

    Raises
    ------
    InputError
        When it is another line.
    """
    model = build(built.with_condition(None))
    pairs = zip(model.line.hangers, line.model.line.hangers, strict=False)
    is_same = len(model.line.hangers) == line.droppers and all(
        abs(a.lower.s - b.lower.s) < 0.01  # the centimetre to which places are written
        for a, b in pairs
    )
    if not is_same or built.line.spans != design.line.spans:
        raise InputError(
            "rank: the line as built has other spans or dropper places than the design; give the "
            "case from which 'tautwire as-built' began, and what it wrote"
        )
    count = design.line.spans + 1
    low = [np.array(case.supports.contact_heights(count)) for case in (design, built)]
    apart = [np.array(case.supports.encumbrances(count)) for case in (design, built)]
    contact, messenger = low[1] - low[0], low[1] + apart[1] - low[0] - apart[0]
    return np.concatenate(
        [
            find_design(model).dropper_lengths_unstrained,
            messenger[np.array(line.messenger, dtype=int) - 1],
            contact[np.array(line.contact, dtype=int) - 1],
        ]
    )


def _corrections(line: SurveyedLine, values: Array, least: float) -> list[Correction]:
    """Return everything that deviates by enough."""
    design, found = line.design.values, []
    for row, hanger in enumerate(line.model.line.hangers):
        label = hanger.label
        found.append(("dropper", label.span, label.number, hanger.lower.s, row))
    row, masts = line.droppers, line.model.line.masts
    kinds = (("messenger height", line.messenger), ("contact height", line.contact))
    for kind, supports in kinds:
        for number in supports:
            found.append((kind, number, number, masts[number - 1], row))
            row += 1
    wanted = [
        Correction(row, kind, span, number, x, float(values[row]), float(design[row]))
        for kind, span, number, x, row in found
        if abs(values[row] - design[row]) >= least
    ]
    if not wanted:
        raise InputError(
            f"rank: nothing deviates from the design by {1e3 * least:g} mm or more; choose a "
            "smaller --least"
        )
    return wanted


def _groups(corrections: Sequence[Correction]) -> list[tuple[Correction, ...]]:
    """Return corrections that share a passage: one in every fourth span."""
    by_span: dict[int, list[Correction]] = {}
    for one in corrections:
        by_span.setdefault(one.span, []).append(one)
    groups = []
    for phase in range(SPACING):
        own = [by_span[span] for span in sorted(by_span) if span % SPACING == phase]
        most = max(map(len, own), default=0)
        groups += [tuple(of[n] for of in own if n < len(of)) for n in range(most)]
    return groups


class _Runner:
    """Computes passages of the line with some corrections made, or takes those that are kept."""

    def __init__(self, line: SurveyedLine, case: Case, values: Array, keep: Path | None) -> None:
        self.line, self.case, self.values, self.keep = line, case, values, keep
        self.cpu = 0.0

    def passage(self, corrections: Sequence[Correction]) -> _Passage:
        """Return the passage with some corrections made."""
        case = self.corrected(corrections)
        found = None if self.keep is None else _loaded(self._file(case))
        if found is not None:
            return found
        model = build(case)
        return self.kept(simulate(model, find_design(model)), corrections)

    def corrected(self, corrections: Sequence[Correction]) -> Case:
        """Return the case with some corrections made."""
        values = self.values.copy()
        for one in corrections:
            values[one.row] = one.design
        return with_values(self.case, self.line, values)

    def kept(self, run: Run, corrections: Sequence[Correction]) -> _Passage:
        """Return what is needed of a run, kept where it is wanted."""
        force = uniform_force(run, run.pantographs[0].name)
        step = float(force.time[1] - force.time[0])
        section = analysed_section(run, (1, run.case.line.spans))
        found = _Passage(
            position=force.position,
            filtered=SharpLowpass().apply(force.force, step),
            raw=force.force,
            uplift=support_uplift(run, section).uplift,
            cpu=float(run.counters["cpu_s"]),
        )
        self.cpu += found.cpu
        if self.keep is not None:
            _save(self._file(self.corrected(corrections)), found)
        return found

    def _file(self, case: Case) -> Path:
        assert self.keep is not None
        return self.keep / f"{case.hash()[:32]}.npz"


def _save(path: Path, passage: _Passage) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    content = io.BytesIO()
    np.savez_compressed(content, **vars(passage))
    write_whole(path, content.getvalue())


def _loaded(path: Path) -> _Passage | None:
    """Return a kept passage; None where there is none that can be read."""
    try:
        with np.load(path, allow_pickle=False) as data:
            arrays = {name: data[name] for name in ("position", "filtered", "raw", "uplift")}
            return _Passage(**arrays, cpu=float(data["cpu"]))
    except (OSError, ValueError, KeyError, EOFError):
        return None


@dataclass(frozen=True, eq=False)
class _Felt:
    """Changes that one correction makes: samples from the first, of both forces; uplift."""

    first: int
    filtered: Array
    raw: Array
    uplift: float


def _felt(line: SurveyedLine, one: Correction, base: _Passage, passage: _Passage) -> _Felt:
    """Cut what belongs to a correction out of a passage."""
    masts = line.model.line.masts
    low = masts[max(one.span - 1 - BEFORE, 0)]
    high = masts[min(one.span - 1 - BEFORE + SPACING, len(masts) - 1)]
    count = min(len(base.raw), len(passage.raw))
    inside = (base.position[:count] >= low) & (base.position[:count] < high)
    rows = np.flatnonzero(inside)
    near = slice(max(one.span - 1 - BEFORE, 0), one.span + SPACING - 1 - BEFORE)
    return _Felt(
        first=int(rows[0]) if len(rows) else 0,
        filtered=passage.filtered[rows] - base.filtered[rows],
        raw=passage.raw[rows] - base.raw[rows],
        uplift=float(np.max(passage.uplift[near]) - np.max(base.uplift[near])),
    )


def _section(line: SurveyedLine, case: Case) -> tuple[float, float]:
    first, last = case.resolved_section()
    return line.model.line.masts[first - 1], line.model.line.masts[last]


def _figures(passage: _Passage, section: tuple[float, float]) -> Figures:
    inside = (passage.position >= section[0]) & (passage.position <= section[1])
    force = passage.filtered[inside]
    return Figures(
        float(force.std()),
        float(force.max()),
        float(force.min()),
        float(np.mean(passage.raw[inside] <= 0.0)),
    )


def _with(base: _Passage, felt: _Felt) -> _Passage:
    """Return a passage with the changes of one more correction added."""
    rows = slice(felt.first, felt.first + len(felt.raw))
    filtered, raw = base.filtered.copy(), base.raw.copy()
    filtered[rows] += felt.filtered
    raw[rows] += felt.raw
    return replace(base, filtered=filtered, raw=raw)


def _ranked(
    base: _Passage, section: tuple[float, float], felt: dict[Correction, _Felt]
) -> tuple[Ranked, ...]:
    """Return the corrections, the first ten so that each gains most after those before it."""
    alone = {one: _figures(_with(base, changes), section) for one, changes in felt.items()}
    left = sorted(felt, key=lambda one: alone[one].standard_deviation)
    found, here = [], base
    while left:
        near = left if len(found) < TOGETHER else left[:1]
        tried = [_figures(_with(here, felt[one]), section) for one in near]
        best = min(range(len(near)), key=lambda n: tried[n].standard_deviation)
        one = left.pop(best)
        here = _with(here, felt[one])
        found.append(Ranked(one, alone[one], tried[best], felt[one].uplift))
    return tuple(found)
