"""Elasticity and uplift measured at places of the line, beside those of a run."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tautwire.assessment.comparison.measurement import MeasurementRow, row_of
from tautwire.assessment.limits import Limits, limits_of
from tautwire.errors import InputError
from tautwire.measured.survey import Quantity, Reading, Survey
from tautwire.plain import Plain, named
from tautwire.results.equilibrium import Elasticity
from tautwire.results.run import Run

Array = NDArray[np.float64]

COMPARED: tuple[Quantity, ...] = ("elasticity", "uplift")
"""Quantities of a survey that are compared with a run."""
_NEAR = 1.0
"""Distance [m] within which a place given by its position is that of a support, or the middle of a
span: chainages are written to the metre."""


@dataclass(frozen=True)
class PointRow(Plain):
    """One measured place.

    Attributes
    ----------
    place : str
    x : float m
        From support 1.
    accuracy : float
        Standard deviation of the reading, in its unit; NaN where the survey does not say.
    numbers : MeasurementRow
        Simulated and measured value, and the tolerance.
    """

    place: str
    x: float = field(metadata=named("x_m"))
    accuracy: float
    numbers: MeasurementRow


@dataclass(frozen=True, eq=False)
class PointComparison(Plain):
    """Measured places beside a run.

    Attributes
    ----------
    label : str
        File of the survey.
    rows : tuple of PointRow
        In the order of quantity and place.
    notes : tuple of str
        What was left out, and why.
    elasticity : Elasticity or None
        Simulated; None where none was measured.
    """

    untold = ("elasticity",)

    label: str = field(metadata=named("survey"))
    rows: tuple[PointRow, ...]
    notes: tuple[str, ...]
    elasticity: Elasticity | None


def compare_points(
    run: Run,
    survey: Survey,
    *,
    elasticity: Elasticity | None,
    uplift: Array,
    limits: Limits | None = None,
) -> PointComparison:
    """Compare elasticity and uplift that were measured at places with those of a run.

    Parameters
    ----------
    run
    survey
        From :func:`tautwire.load_survey`.
    elasticity
        Of the line of the run; needed where elasticity was measured. Between its points, which are
        the supports, the droppers and the middles between them, it is interpolated.
    uplift : (n_support,) m
        Largest of the passage at every support; NaN where none passed.
    limits
        Tolerances; by default those that the case names, or of the package.

    Raises
    ------
    InputError
        When the survey holds neither, or at places that the line does not have; all of them.
    """
    readings = survey.of(*COMPARED)
    if not readings:
        raise InputError(
            f"{survey.label}: holds neither elasticity nor uplift; give columns such as "
            "'Elasticity [mm/N]' or 'Uplift [mm]' beside 'Support', 'Mast', or 'Span' with 'Point' "
            "(support or mid-span)"
        )
    problems: list[str] = []
    tolerances = {entry.quantity: entry for entry in (limits or limits_of(run.case)).tolerances}
    rows, outside = [], 0
    for one in sorted(readings, key=lambda one: COMPARED.index(one.quantity)):
        try:
            x, support = _place(run, one)
            simulated = _simulated(one, x, support, elasticity, uplift)
        except InputError as error:
            problems += error.problems
            continue
        if math.isnan(simulated):
            outside += 1
            continue
        numbers = row_of(one.quantity, simulated, one.value, tolerances.get(one.quantity))
        rows.append(PointRow(_words(run, one, x, support), x, one.accuracy, numbers))
    if problems:
        raise InputError(problems)
    left_out = [
        f"{outside} readings lie outside the analysed section or where no pantograph passed"
    ]
    return PointComparison(
        label=survey.label,
        rows=tuple(sorted(rows, key=lambda row: (row.numbers.quantity, row.x))),
        notes=(*survey.notes, *(left_out if outside else ())),
        elasticity=elasticity,
    )


def _place(run: Run, one: Reading) -> tuple[float, int | None]:
    """Return where a reading belongs [m], and the number of its support, None for none.

    Raises
    ------
    InputError
        When the line has no such place.
    """
    shape, masts = run.equilibrium, run.equilibrium.mast_x
    if one.support is not None:
        if not 1 <= one.support <= len(masts):
            raise InputError(f"{one.where}: names support {one.support}; the line has {len(masts)}")
        return float(masts[one.support - 1]), one.support
    if one.s is None:
        found = (shape.dropper_span == one.span) & (shape.dropper_number == one.dropper)
        if not found.any():
            raise InputError(
                f"{one.where}: names dropper {one.dropper} of span {one.span}, which the line does "
                "not have"
            )
        return float(shape.dropper_x[found][0]), None
    nearest = int(np.abs(masts - one.s).argmin())
    return one.s, nearest + 1 if abs(masts[nearest] - one.s) <= _NEAR else None


def _simulated(
    one: Reading, x: float, support: int | None, elasticity: Elasticity | None, uplift: Array
) -> float:
    """Return the value of the run; NaN where it has none.

    Raises
    ------
    InputError
        When an uplift was measured away from supports.
    """
    if one.quantity == "uplift":
        if support is None:
            raise InputError(
                f"{one.where}: gives an uplift at x = {x:.1f} m, which is no support; the uplift "
                "of a passage is compared at supports"
            )
        return float(uplift[support - 1])
    assert elasticity is not None
    order = np.argsort(elasticity.x)
    return float(
        np.interp(
            x, elasticity.x[order], elasticity.elasticity[order], left=math.nan, right=math.nan
        )
    )


def _words(run: Run, one: Reading, x: float, support: int | None) -> str:
    """Name the place of a reading."""
    if support is not None:
        return run.case.line.support_in_words(support)
    if one.s is None:
        return f"dropper {one.dropper} of span {one.span}"
    masts = run.equilibrium.mast_x
    span = int(np.clip(np.searchsorted(masts, x), 1, len(masts) - 1))
    middle = 0.5 * (masts[span - 1] + masts[span])
    return f"middle of span {span}" if abs(x - middle) <= _NEAR else f"x = {x:.1f} m"


def judged(rows: Sequence[PointRow]) -> str:
    """Say how many places are within their tolerance."""
    told = [row.numbers.within for row in rows if row.numbers.within is not None]
    if not told:
        return "no tolerance is known"
    return f"{sum(told)} of {len(told)} within the tolerance"
