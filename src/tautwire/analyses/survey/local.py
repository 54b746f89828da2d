"""What single corrections do to the contact force, from passages over the spans around each.

A passage runs over some spans around a correction, on a line that is cut before and behind them,
once as the line stands and once with the correction made. What both have in common, the start of
the passage and the cut, is not in their difference.
"""

from __future__ import annotations

import hashlib
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.force.section import analysed_section
from tautwire.analyses.force.statistics import support_uplift, uniform_force
from tautwire.analyses.road.dynamics import Choices, Simulation, carried_out
from tautwire.analyses.road.shape import find_design
from tautwire.analyses.survey.as_built import with_values
from tautwire.analyses.survey.corrections import Correction
from tautwire.analyses.survey.part import part_of_line
from tautwire.analyses.survey.surveyed_line import SurveyedLine
from tautwire.model.build import build
from tautwire.results.run import Run
from tautwire.signals.filters import SharpLowpass
from tautwire.specs.case import Case

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Reach:
    """Spans around the one of a correction, seen along the way.

    Attributes
    ----------
    before, behind : int
        In which its change of the force is taken: the wave runs ahead of the train, and its
        reflections stay behind.
    lead, tail : int
        Between these and the places where the line is cut.
    """

    before: int
    behind: int
    lead: int
    tail: int


SHORT = Reach(before=1, behind=2, lead=2, tail=1)
"""Enough for the order. The change of the force by a dropper of 20 mm in the middle of nine spans
is 18 % of its root mean square away from that of full passages; with one span before 30 %, with two
behind 8 %, at a seventh more cost. Which droppers go slack depends on the whole passage."""
LONG = Reach(before=2, behind=4, lead=4, tail=3)
"""For what corrections gain. A messenger support of 30 mm changes the force by 6 to 8 N rms in its
two spans and by 2 N in the ten behind, as the line swings on: on three lines of eleven spans its
gain in standard deviation is missed by 0.23 to 0.35 N with the short reach, by 0.04 to 0.12 N with
two spans before, two behind and this lead and tail. On four of 17 spans this reach misses 0.09 to
0.17 N, nearly all of it what the spans farther behind would add."""
FRAME_INTERVAL = 1.0
"""Time between pictures of a passage of which none is looked at [s]."""


@dataclass(frozen=True, eq=False)
class Passage:
    """What is kept of a passage.

    Attributes
    ----------
    position : (n,) m
    raw, filtered : (n,) N
        Force of the first pantograph, and up to 20 Hz.
    uplift : (n_support,) m
        Largest at every support.
    cpu : float s
        Processor time.
    """

    position: Array
    raw: Array
    filtered: Array
    uplift: Array
    cpu: float


@dataclass(frozen=True, eq=False)
class Felt:
    """What one correction does around its place.

    Attributes
    ----------
    position : (n,) m
        Along the whole line, rising.
    raw, filtered : (n,) N
        Change of the force, and of the force up to 20 Hz.
    uplift : float m
        Change of the largest uplift at the supports around it.
    """

    position: Array
    raw: Array
    filtered: Array
    uplift: float

    @property
    def energy(self) -> float:
        """Square of the change of the force up to 20 Hz, summed over the way [N2 m]."""
        return float(np.trapezoid(self.filtered**2, self.position))


@dataclass(frozen=True, eq=False)
class Place:
    """The corrections of one span, and the line around it.

    Attributes
    ----------
    built : Case
        The spans around, as built.
    corrected : tuple of Case
        The same with one correction made.
    start : float m
        Where these spans begin on the line.
    felt : (first, last) m
        Where the corrections are felt.
    """

    built: Case
    corrected: tuple[Case, ...]
    start: float
    felt: tuple[float, float]

    def name(self) -> str:
        """Return a name that belongs to these passages alone."""
        cases = (self.built, *self.corrected)
        return hashlib.sha256("".join(case.hash() for case in cases).encode()).hexdigest()[:32]


def place_of(
    line: SurveyedLine,
    case: Case,
    values: Array,
    span: int,
    corrections: Sequence[Correction],
    reach: Reach,
    *,
    least_step: float = 0.0,
) -> Place:
    """Cut out what is needed for the corrections of a span.

    Parameters
    ----------
    line
        The line as designed.
    case
        As built; every pantograph has its working height and its uplift force.
    values : (n_unknown,) m
        As built.
    span : int
        From 1.
    corrections
        Those of this span.
    reach
    least_step : float s
        Time step of the passages where that of the case is shorter.
    """
    count = case.line.spans
    before, behind = reach.before, reach.behind
    lead, tail = before + reach.lead, behind + reach.tail
    if case.scenario.direction == "-x":
        before, behind, lead, tail = behind, before, tail, lead
    ends = max(span - lead, 1), min(span + tail, count)
    near = max(span - before, 1), min(span + behind, count)
    masts = line.model.line.masts
    cases = []
    for one in (None, *corrections):
        own = values.copy()
        if one is not None:
            own[one.row] = one.design
        cases.append(_part(with_values(case, line, own), *ends, least_step))
    return Place(
        built=cases[0],
        corrected=tuple(cases[1:]),
        start=masts[ends[0] - 1],
        felt=(masts[near[0] - 1], masts[near[1]]),
    )


def _part(case: Case, first: int, last: int, least_step: float) -> Case:
    """Return the spans around a place, under the first pantograph alone."""
    part = part_of_line(case, first, last)
    return part.with_(
        **{
            "pantographs": part.pantographs[:1],
            "scenario.uplift_force": case.uplift_forces()[0],
            "settings.time_step": max(case.settings.step(), least_step),
        }
    )


def _passage(run: Run) -> Passage:
    """Return what is needed of a run."""
    force = uniform_force(run, run.pantographs[0].name)
    step = float(force.time[1] - force.time[0])
    section = analysed_section(run, (1, run.case.line.spans))
    return Passage(
        position=force.position,
        raw=force.force,
        filtered=SharpLowpass().apply(force.force, step),
        uplift=support_uplift(run, section).uplift,
        cpu=float(run.counters["cpu_s"]),
    )


def simulated(case: Case) -> Passage:
    """Simulate a passage.

    Raises
    ------
    KeyboardInterrupt
        When it was stopped: a part of a passage is of no use here.
    ConvergenceError
        When it fails.
    """
    model = build(case)
    choices = Choices(frame_interval=FRAME_INTERVAL)
    run = carried_out(Simulation(model, find_design(model), choices))
    if run.status != "done":
        raise KeyboardInterrupt(run.message)
    return _passage(run)


def felt_at(place: Place) -> tuple[tuple[Felt, ...], float]:
    """Return what the corrections of a place do, and the processor time it took [s].

    Parameters
    ----------
    place

    Raises
    ------
    ConvergenceError
        When a passage fails.
    """
    begin = time.process_time()
    base = simulated(place.built)
    felt = tuple(_difference(place, base, simulated(case)) for case in place.corrected)
    return felt, time.process_time() - begin


def _difference(place: Place, base: Passage, other: Passage) -> Felt:
    """Return the change between two passages where it is felt."""
    count = min(len(base.raw), len(other.raw))
    position = base.position[:count] + place.start
    inside = np.flatnonzero((position >= place.felt[0]) & (position <= place.felt[1]))
    rows = inside[np.argsort(position[inside])]
    supports = np.cumsum((place.start, *place.built.line.span_lengths()))
    near = (supports >= place.felt[0] - 1e-6) & (supports <= place.felt[1] + 1e-6)
    return Felt(
        position=position[rows],
        raw=other.raw[rows] - base.raw[rows],
        filtered=other.filtered[rows] - base.filtered[rows],
        uplift=float(np.max(other.uplift[near]) - np.max(base.uplift[near])),
    )
