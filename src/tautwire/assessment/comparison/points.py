"""Elasticity and uplift measured at places of the line, beside those of a run."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tautwire.assessment.comparison.droppers import NamedDroppers
from tautwire.assessment.comparison.measurement import MeasurementRow, incompleteness, row_of
from tautwire.assessment.limits import Limits, limits_of
from tautwire.errors import InputError
from tautwire.measured.survey import Quantity, Reading, Survey
from tautwire.plain import Plain, named
from tautwire.results.equilibrium import Elasticity
from tautwire.results.run import Run
from tautwire.text import shortened

Array = NDArray[np.float64]

COMPARED: tuple[Quantity, ...] = ("elasticity", "uplift")
"""Quantities of a survey that are compared with a run."""
_NEAR = 1.0
"""Distance [m] within which a place given by its position is that of a support, or the middle of a
span: chainages are written to the metre."""
_LISTED = 300
"""Letters in which places are listed in a note, some ten of them; the middle of a longer list is
left out."""


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
        What was left out or looks wrong, and why; that the run is not complete.
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
        When the survey holds neither, or at places that the line does not have or has several of;
        all of them.
    """
    readings = survey.of(*COMPARED)
    if not readings:
        raise InputError(
            f"{survey.label}: holds neither elasticity nor uplift; give columns such as "
            "'Elasticity [mm/N]' or 'Uplift [mm]' beside 'Support', 'Mast', or 'Span' with 'Point' "
            "(support or mid-span)"
        )
    tolerances = {entry.quantity: entry for entry in (limits or limits_of(run.case)).tolerances}
    rows: list[PointRow] = []
    left_out: dict[Quantity, list[str]] = {}
    for one, at in _placed(run, readings):
        simulated = _simulated(one, at, elasticity, uplift)
        if math.isnan(simulated):
            left_out.setdefault(one.quantity, []).append(at.words)
            continue
        numbers = row_of(one.quantity, simulated, one.value, tolerances.get(one.quantity))
        rows.append(PointRow(at.words, at.x, one.accuracy, numbers))
    notes = (*_lowered(readings), *_left_out(run, left_out), *incompleteness(run))
    return PointComparison(
        label=survey.label,
        rows=tuple(sorted(rows, key=lambda row: (row.numbers.quantity, row.x))),
        notes=(*survey.notes, *notes),
        elasticity=elasticity,
    )


def _lowered(readings: Sequence[Reading]) -> list[str]:
    """Tell of uplifts that say that the wire went down."""
    rows = [one.where for one in readings if one.quantity == "uplift" and one.value < 0.0]
    if not rows:
        return []
    return [
        f"{len(rows)} of the uplifts are negative, below the wire at rest ({_listed(rows)}); check "
        "their sign"
    ]


def _left_out(run: Run, places: Mapping[Quantity, Sequence[str]]) -> Iterator[str]:
    """Tell which places have no value of the run, and why."""
    if found := places.get("uplift"):
        yield (
            f"no pantograph reached the support of {len(found)} of the uplifts, which are left "
            f"out: {_listed(found)}"
        )
    if found := places.get("elasticity"):
        first, last = run.case.resolved_section()
        yield (
            f"{len(found)} readings of elasticity lie outside the analysed section (spans {first} "
            f"to {last}, settings.section), in which it is computed, and are left out: "
            f"{_listed(found)}"
        )


def _listed(places: Sequence[str]) -> str:
    return shortened("; ".join(places), _LISTED)


@dataclass(frozen=True)
class _Place:
    """Where a reading was taken: from support 1 [m], number of the support or None, in words."""

    x: float
    support: int | None
    words: str


def _placed(run: Run, readings: Sequence[Reading]) -> list[tuple[Reading, _Place]]:
    """Return the readings, quantity by quantity, with their places on the line.

    Raises
    ------
    InputError
        Naming every reading at a place that the line does not have, or has several of, and every
        uplift away from supports.
    """
    droppers = NamedDroppers.of(run)
    found: list[tuple[Reading, _Place]] = []
    problems: list[str] = []
    for one in sorted(readings, key=lambda one: COMPARED.index(one.quantity)):
        try:
            found.append((one, _place(run, one, droppers)))
        except InputError as error:
            problems += error.problems
    if problems:
        raise InputError(list(dict.fromkeys(problems)))
    return found


def _place(run: Run, one: Reading, droppers: NamedDroppers) -> _Place:
    """Return where a reading belongs.

    Raises
    ------
    InputError
        When the line has no such place, or several, or an uplift was measured away from supports.
    """
    masts, line = run.equilibrium.mast_x, run.case.line
    if one.support is not None:
        if not 1 <= one.support <= len(masts):
            raise InputError(f"{one.where}: names support {one.support}; the line has {len(masts)}")
        at = _Place(float(masts[one.support - 1]), one.support, line.support_in_words(one.support))
    elif one.s is None:
        row = droppers.find(one)
        at = _Place(float(run.equilibrium.dropper_x[row]), None, droppers.name(row))
    else:
        nearest = int(np.abs(masts - one.s).argmin()) + 1
        is_support = abs(masts[nearest - 1] - one.s) <= _NEAR
        words = line.support_in_words(nearest) if is_support else _between(masts, one.s)
        at = _Place(one.s, nearest if is_support else None, words)
    if one.quantity == "uplift" and at.support is None:
        raise InputError(
            f"{one.where}: gives an uplift at x = {at.x:.1f} m, which is no support; the uplift "
            "of a passage is compared at supports"
        )
    return at


def _between(masts: Array, x: float) -> str:
    """Name a place that is no support."""
    span = int(np.clip(np.searchsorted(masts, x), 1, len(masts) - 1))
    middle = 0.5 * (masts[span - 1] + masts[span])
    return f"middle of span {span}" if abs(x - middle) <= _NEAR else f"x = {x:.1f} m"


def _simulated(one: Reading, at: _Place, elasticity: Elasticity | None, uplift: Array) -> float:
    """Return the value of the run; NaN where it has none."""
    if one.quantity == "uplift":
        assert at.support is not None
        return float(uplift[at.support - 1])
    assert elasticity is not None
    order = np.argsort(elasticity.x)
    x, values = elasticity.x[order], elasticity.elasticity[order]
    return float(np.interp(at.x, x, values, left=math.nan, right=math.nan))


def judged(rows: Sequence[PointRow]) -> str:
    """Say how many places are within their tolerance."""
    told = [row.numbers.within for row in rows if row.numbers.within is not None]
    if not told:
        return "no tolerance is known"
    return f"{sum(told)} of {len(told)} within the tolerance"
