"""A whole line as built: what is to be corrected on it, and its passages from end to end."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.road.mean_force import tune_mean_force
from tautwire.analyses.road.shape import find_design
from tautwire.analyses.survey.as_built import with_values
from tautwire.analyses.survey.corrections import Correction, built_values, corrections_of
from tautwire.analyses.survey.kept import keep_passage, kept_passage
from tautwire.analyses.survey.local import FRAME_INTERVAL, Passage, simulated
from tautwire.analyses.survey.surveyed_line import SurveyedLine
from tautwire.model.build import Model, build
from tautwire.model.passage import working_height
from tautwire.results.equilibrium import Equilibrium
from tautwire.specs.case import Case

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class WholeLine:
    """A line as built, beside its design.

    Attributes
    ----------
    line : SurveyedLine
        As designed.
    case : Case
        As built, under no condition.
    values : (n_unknown,) m
        As built.
    corrections : tuple of Correction
        Everything that deviates by enough.
    """

    line: SurveyedLine
    case: Case
    values: Array
    corrections: tuple[Correction, ...]

    @property
    def length(self) -> float:
        """Distance between the anchors [m]."""
        return self.line.model.line.masts[-1]

    @property
    def mean_span(self) -> float:
        """Mean length of a span [m]."""
        return self.length / self.case.line.spans

    @property
    def section(self) -> tuple[float, float]:
        """Where the analysed section begins and ends [m]."""
        first, last = self.case.resolved_section()
        return self.line.model.line.masts[first - 1], self.line.model.line.masts[last]

    def values_with(self, corrections: Sequence[Correction]) -> Array:
        """Return the unknowns with some corrections made."""
        values = self.values.copy()
        for one in corrections:
            values[one.row] = one.design
        return values

    def corrected(self, corrections: Sequence[Correction]) -> Case:
        """Return the case with some corrections made."""
        return with_values(self.case, self.line, self.values_with(corrections))


def whole_line(design: Case, built: Case, least: float) -> WholeLine:
    """Return a line as built with what deviates from the design.

    Parameters
    ----------
    design, built
    least : float m
        Deviations below this are left alone.

    Raises
    ------
    InputError
        When the two differ in more than lengths and heights.
    """
    line = SurveyedLine(build(design.with_condition(None)))
    values = built_values(line, design, built)
    corrections = tuple(corrections_of(line, values, least))
    return WholeLine(line, built.with_condition(None), values, corrections)


def settled(case: Case) -> tuple[Case, float]:
    """Return a line with the uplift forces and working heights that all its passages have.

    Parameters
    ----------
    case

    Returns
    -------
    case : Case
    cpu : float s
        Processor time of the passages that a mean force asks for.

    Raises
    ------
    KeyboardInterrupt
        When they were stopped.
    ConvergenceError
        When one fails.
    """
    model = build(case)
    shape = find_design(model)
    cpu = 0.0
    if case.scenario.target_mean_force() is not None:
        begin = time.process_time()
        case = _tuned(case, model, shape)
        cpu = time.process_time() - begin
    height = working_height(model, shape)
    raised = [
        one if one.working_height is not None else one.with_(working_height=height)
        for one in case.pantographs
    ]
    return case.with_(pantographs=raised), cpu


def _tuned(case: Case, model: Model, shape: Equilibrium) -> Case:
    """Return the case with the uplift forces that its mean force needs."""
    run = tune_mean_force(model, shape, frame_interval=FRAME_INTERVAL)
    if run.status != "done":
        raise KeyboardInterrupt(run.message)
    forces = [float(record.uplift_force) for record in run.pantographs]
    changes: dict[str, Any] = {"scenario.mean_force": None, "scenario.uplift_force": forces}
    return case.with_(**changes)


def whole_passage(case: Case, folder: Path | None) -> tuple[Passage, float]:
    """Return the passage over a whole line, and the processor time that it took now [s].

    Parameters
    ----------
    case
    folder : Path or None
        Where it is kept, and taken from.
    """
    path = None if folder is None else folder / f"{case.hash()[:32]}.npz"
    found = None if path is None else kept_passage(path)
    if found is not None:
        return found, 0.0
    found = simulated(case)
    if path is not None:
        keep_passage(path, found)
    return found, found.cpu
