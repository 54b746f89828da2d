"""Corrections of lines as built, in the order of what they do to the contact force.

What a correction does is found by passages over the spans around it; see
:mod:`tautwire.analyses.survey.local`. The first ten are computed once more, over more spans, each
on the line on which those before it are made: what two of them do together is not the sum of what
each does alone.
The changes of the force, added up, predict standard deviation, maximum, minimum and loss. What the
first ten really gain is computed by a passage over the whole line. Several tension lengths are
ranked in one list.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.survey.corrections import LEAST, Correction
from tautwire.analyses.survey.kept import computed, in_order, processes
from tautwire.analyses.survey.local import LONG, SHORT, Felt, Passage, Place, Reach, place_of
from tautwire.analyses.survey.whole import WholeLine, settled, whole_line, whole_passage
from tautwire.errors import InputError
from tautwire.specs.case import Case

Array = NDArray[np.float64]

TOGETHER = 10
"""Corrections that are listed for the crew and checked together by full passages."""

ORDER_STEP = 2e-3
"""Least time step of the passages that give the order [s]. Up to 20 Hz it changes the size of what
a correction does by 1 % in the median and 5 % at most, and the change itself by 6 to 12 % of its
root mean square; that only some spans are passed makes 18 %. With 3 ms both are 1.6 times as
large."""


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
    place : int
        In the list over all lines, from 1.
    effect : float N
        By how much it changes the force up to 20 Hz: root mean square of all of the change, as if
        it were spread over a span of mean length.
    alone : Figures
        Figures of the line with this correction alone, predicted.
    together : Figures
        With this and all corrections of the line before it in the list, predicted: each of the
        first ten from what it does after those before it, the others from what they do alone.
    uplift : float m
        Change of the largest uplift at the supports around it.
    """

    correction: Correction
    place: int
    effect: float
    alone: Figures
    together: Figures
    uplift: float


@dataclass(frozen=True, eq=False)
class Ranking:
    """Corrections of one line in order of what they do.

    Attributes
    ----------
    case : Case
        As built, with the uplift forces that were used.
    built : Figures
        As it stands.
    ranked : tuple of Ranked
        The largest effect first.
    made : int
        How many of them are among the first of the list over all lines.
    checked : Figures
        Of a full passage with these made: computed, not predicted.
    passages : int
        Over some spans; those over the whole line come on top.
    length : float m
    cpu : float s
        Processor time that was spent now on passages.
    """

    case: Case
    built: Figures
    ranked: tuple[Ranked, ...]
    made: int
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
    pairs = [(design, built)]
    return rank_lines(pairs, least=least, workers=workers, keep=keep, watch=watch)[0]


def rank_lines(
    lines: Sequence[tuple[Case, Case]],
    *,
    least: float = LEAST,
    first: int = TOGETHER,
    workers: int = 1,
    keep: Path | None = None,
    watch: Callable[[int, int], None] | None = None,
) -> tuple[Ranking, ...]:
    """Rank the corrections of several tension lengths in one list.

    Parameters
    ----------
    lines : sequence of (Case, Case)
        Design and line as built of each.
    least, workers, keep, watch
        See :func:`rank`.
    first : int
        Corrections of the list that are made together, each in its line, to compute what they
        gain.

    Returns
    -------
    tuple of Ranking
        One per line.

    Raises
    ------
    InputError
        When two lines of a pair differ in more than lengths and heights, or nothing deviates.
    ConvergenceError
        When a passage fails.
    """
    wholes = _whole_lines(lines, least)
    with processes(workers) as pool:
        work = _Work(wholes, pool, keep)
        felt = work.felt(work.by_span(), SHORT, ORDER_STEP, watch)
        order = sorted(felt, key=lambda one: (-work.effect(one, felt[one]), one[0], one[1].row))
        after = work.felt(work.one_after_another(order[:first]), LONG, 0.0, None)
        passages = work.full(order[:first])
    found: list[list[_Found]] = [[] for _ in wholes]
    for place, one in enumerate(order, 1):
        effect = work.effect(one, felt[one])
        found[one[0]].append(_Found(one[1], place, effect, felt[one], after.get(one)))
    parts = zip(work.wholes, found, passages, work.cpu, strict=True)
    return tuple(_ranking(*part) for part in parts)


def _whole_lines(lines: Sequence[tuple[Case, Case]], least: float) -> list[WholeLine]:
    """Return the lines; all that is wrong with them is told at once."""
    wholes, problems = [], []
    for design, built in lines:
        try:
            wholes.append(whole_line(design, built, least))
        except InputError as error:
            problems += [f"{built.name}: {text}" for text in error.problems]
    if problems:
        raise InputError(problems)
    if not any(whole.corrections for whole in wholes):
        raise InputError(
            f"rank: nothing deviates from the design by {1e3 * least:g} mm or more; choose a "
            "smaller --least"
        )
    return wholes


_Mark = tuple[int, Correction]
"""Number of the line, from 0, and a correction of it."""


@dataclass(frozen=True, eq=False)
class _Wanted:
    """Corrections of one span, each to be made alone on a line as it stands then."""

    line: int
    values: Array
    corrections: tuple[Correction, ...]


class _Work:
    """Passages of some lines, computed or taken from where they are kept, and what they cost."""

    def __init__(
        self, wholes: Sequence[WholeLine], pool: Executor | None, keep: Path | None
    ) -> None:
        self.pool, self.keep = pool, keep
        settling = list(in_order(pool, settled, [(one.case,) for one in wholes]))
        self.wholes = [replace(a, case=b) for a, (b, _) in zip(wholes, settling, strict=True)]
        self.cpu = [cpu for _, cpu in settling]

    def effect(self, mark: _Mark, felt: Felt) -> float:
        """Return what the order is made by [N], see :class:`Ranked`."""
        return float(np.sqrt(felt.energy / self.wholes[mark[0]].mean_span))

    def by_span(self) -> list[_Wanted]:
        """Return all corrections, span by span, on the lines as built."""
        wanted = []
        for number, whole in enumerate(self.wholes):
            ordered = sorted(whole.corrections, key=lambda one: (one.span, one.row))
            for _, own in groupby(ordered, key=lambda one: one.span):
                wanted.append(_Wanted(number, whole.values, tuple(own)))
        return wanted

    def one_after_another(self, order: Sequence[_Mark]) -> list[_Wanted]:
        """Return corrections, each with the line on which those before it are made."""
        wanted = []
        for count, (number, one) in enumerate(order):
            before = [other for line, other in order[:count] if line == number]
            wanted.append(_Wanted(number, self.wholes[number].values_with(before), (one,)))
        return wanted

    def felt(
        self,
        wanted: Sequence[_Wanted],
        reach: Reach,
        least_step: float,
        watch: Callable[[int, int], None] | None,
    ) -> dict[_Mark, Felt]:
        """Return what corrections do, from passages with at least a time step [s]."""
        found: dict[_Mark, Felt] = {}
        if watch is not None:
            watch(0, len(wanted))
        places = (self._place(one, reach, least_step) for one in wanted)
        for count, (at, felt, cpu) in enumerate(computed(places, self.pool, self.keep), 1):
            line = wanted[at].line
            marks = [(line, one) for one in wanted[at].corrections]
            found.update(zip(marks, felt, strict=True))
            self.cpu[line] += cpu
            if watch is not None:
                watch(count, len(wanted))
        return found

    def _place(self, wanted: _Wanted, reach: Reach, least_step: float) -> Place:
        whole, own = self.wholes[wanted.line], wanted.corrections
        values, span = wanted.values, own[0].span
        return place_of(whole.line, whole.case, values, span, own, reach, least_step=least_step)

    def full(self, made: Sequence[_Mark]) -> list[tuple[Passage, Passage]]:
        """Return the passages over each line as built, and with its part of some corrections."""
        wanted = []
        for number, whole in enumerate(self.wholes):
            own = [one for line, one in made if line == number]
            cases = [whole.case, whole.corrected(own)] if own else [whole.case]
            wanted += [(number, case) for case in cases]
        found: list[list[Passage]] = [[] for _ in self.wholes]
        done = in_order(self.pool, whole_passage, [(case, self.keep) for _, case in wanted])
        for (number, _), (passage, cpu) in zip(wanted, done, strict=True):
            found[number].append(passage)
            self.cpu[number] += cpu
        return [(own[0], own[-1]) for own in found]


@dataclass(frozen=True, eq=False)
class _Found:
    """A correction with its place in the list, and what it does alone and after those before it."""

    correction: Correction
    place: int
    effect: float
    alone: Felt
    after: Felt | None


def _ranking(
    whole: WholeLine, found: Sequence[_Found], passages: tuple[Passage, Passage], cpu: float
) -> Ranking:
    """Return what is told about one line."""
    base, section = passages[0], whole.section
    made = sum(one.after is not None for one in found)
    return Ranking(
        case=whole.case,
        built=_figures(base, section),
        ranked=_ranked(base, section, found),
        made=made,
        checked=_figures(passages[1], section),
        passages=len(found) + len({one.correction.span for one in found}) + 2 * made,
        length=whole.length,
        cpu=cpu,
    )


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
    base: Passage, section: tuple[float, float], found: Sequence[_Found]
) -> tuple[Ranked, ...]:
    """Return the corrections with their figures, in the order in which they are given.

    That is the order of the effect, not of the gain of a figure: two deviations may make up for
    each other, and the larger one is to be set right first all the same.
    """
    ranked, here = [], base
    for one in found:
        here = _with(here, one.after or one.alone)
        ranked.append(
            Ranked(
                correction=one.correction,
                place=one.place,
                effect=one.effect,
                alone=_figures(_with(base, one.alone), section),
                together=_figures(here, section),
                uplift=one.alone.uplift,
            )
        )
    return tuple(ranked)
