"""What a line as built has that the design has not: the corrections that may be made."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.road.shape import find_design
from tautwire.analyses.survey.surveyed_line import SurveyedLine
from tautwire.errors import InputError
from tautwire.model.build import build
from tautwire.specs.case import Case

Array = NDArray[np.float64]

LEAST = 0.003
"""Least deviation that is looked at [m]: what a crew can set. From memory."""


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


def built_values(line: SurveyedLine, design: Case, built: Case) -> Array:
    """Return the unknowns of the line as built, ``(n_unknown,)`` [m].

    Parameters
    ----------
    line
        The line as designed.
    design, built
        The two cases.

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


def corrections_of(line: SurveyedLine, values: Array, least: float) -> list[Correction]:
    """Return everything that deviates by enough.

    Parameters
    ----------
    line
        The line as designed.
    values : (n_unknown,) m
        As built.
    least : float m
        Deviations below this are left alone.
    """
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
    return [
        Correction(row, kind, span, number, x, float(values[row]), float(design[row]))
        for kind, span, number, x, row in found
        if abs(values[row] - design[row]) >= least
    ]
