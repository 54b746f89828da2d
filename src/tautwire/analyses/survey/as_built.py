"""The line as built: a survey, the line as designed, and what follows of lengths and heights."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.road.shape import find_design
from tautwire.analyses.survey.allocation import Allocation, find_allocation_errors
from tautwire.analyses.survey.estimate import Estimate, Prior, estimate
from tautwire.analyses.survey.observations import Observations
from tautwire.analyses.survey.surveyed_line import SurveyedLine
from tautwire.analyses.threads import single_threaded
from tautwire.errors import ConvergenceError, InputError
from tautwire.measured.survey import Reading, Survey
from tautwire.model.build import build
from tautwire.specs.case import Case

Array = NDArray[np.float64]

SCATTER = 0.005
"""Deviation of dropper lengths from their design [m]. From memory: installation tolerances of
5 to 10 mm are usual."""
SUPPORT_SCATTER = 0.010
"""Deviation of heights at supports from their design [m]. From memory: the usual tolerance of the
contact height at a support is 10 to 30 mm."""
SURE = 2.0
"""Standard errors by which a dropper force lies above zero for the dropper to be called taut."""
_ODD = 4.0
"""Accuracies by which a reading misses the estimate to be named: 6 in 100,000 do so by chance."""
_DIGITS = 5
"""Decimals of a length in the case [m]: a hundredth of a millimetre, finer than any estimate."""
_SLACK = 5e-4
"""By how much a slack dropper of the case is longer than the distance it spans [m]: it stays slack
when lengths are rounded, and a passage takes it as what it is."""


@dataclass(frozen=True)
class BuiltDropper:
    """A dropper as built.

    Attributes
    ----------
    span, dropper : int
    x : float m
    design, length : float m
        Unstrained lengths.
    error : float m
        Standard error of the length.
    force, force_error : float N
    state : str
        ``taut``, ``slack`` (the length is the least that it can be) or ``undecided``.
    height : float m
        Of the contact wire.
    """

    span: int
    dropper: int
    x: float
    design: float
    length: float
    error: float
    force: float
    force_error: float
    state: str
    height: float


@dataclass(frozen=True)
class BuiltSupport:
    """A support as built; NaN where the height is not given by the support.

    Attributes
    ----------
    support : int
    x : float m
    contact_design, contact, contact_error : float m
    messenger_design, messenger, messenger_error : float m
    """

    support: int
    x: float
    contact_design: float
    contact: float
    contact_error: float
    messenger_design: float
    messenger: float
    messenger_error: float


@dataclass(frozen=True, eq=False)
class AsBuilt:
    """A line as built.

    Attributes
    ----------
    case : Case
        With the estimated lengths and heights.
    designed : Case
    survey : Survey
    droppers : tuple of BuiltDropper
    supports : tuple of BuiltSupport
    allocations : tuple of Allocation
        Droppers in wrong places.
    odd : tuple of (Reading, float)
        Readings that the estimate misses by more than four accuracies, and by how many.
    misfit : float
        Root mean square of what the estimate misses, over the accuracy; about one.
    prior : Prior
    """

    case: Case
    designed: Case
    survey: Survey
    droppers: tuple[BuiltDropper, ...]
    supports: tuple[BuiltSupport, ...]
    allocations: tuple[Allocation, ...]
    odd: tuple[tuple[Reading, float], ...]
    misfit: float
    prior: Prior

    def as_dict(self) -> dict[str, Any]:
        """Return everything as plain data."""
        return {
            "case": self.case.name,
            "survey": self.survey.label,
            "readings": len(self.survey.readings),
            "notes": list(self.survey.notes),
            "misfit": self.misfit,
            "droppers": [asdict(one) for one in self.droppers],
            "supports": [asdict(one) for one in self.supports],
            "allocations": [
                {
                    "text": one.hypothesis.text,
                    "gain": one.gain,
                    "threshold": one.threshold,
                    "or": [other.text for other in one.alternatives],
                }
                for one in self.allocations
            ],
            "odd_readings": [
                {"where": one.where, "quantity": one.quantity, "accuracies": by}
                for one, by in self.odd
            ],
        }


@single_threaded
def as_built(
    case: Case,
    survey: Survey,
    *,
    scatter: float = SCATTER,
    support_scatter: float = SUPPORT_SCATTER,
) -> AsBuilt:
    """Estimate the line as built from a survey.

    Dropper lengths and heights at supports are the most probable ones under the readings, their
    accuracy, and a scatter about the design; no dropper pushes. Errors of allocation are found by
    how much likelier they make the survey.

    Parameters
    ----------
    case
        The line as designed; staggers that were measured at supports replace those of it.
    survey
        From :func:`tautwire.load_survey`.
    scatter, support_scatter : float m
        Standard deviations of dropper lengths, and of the heights at supports, about the design.

    Returns
    -------
    AsBuilt

    Raises
    ------
    InputError
        When the line cannot be written with lengths of its own, or readings lie at places that it
        does not have.
    ConvergenceError
        When no line is found in equilibrium.

    Examples
    --------
    >>> built = as_built(load_case("my-line.yaml"), load_survey("survey.csv"))  # doctest: +SKIP
    """
    _refuse_unfit(case)
    designed = _with_staggers(case, survey.of("stagger"))
    line = SurveyedLine(build(designed.with_condition(None)))
    told = survey.of("contact height", "messenger height", "dropper length")
    if not told:
        raise InputError(
            f"{survey.label}: holds neither heights nor dropper lengths; give columns such as "
            "'Contact height [m]' or 'Dropper length [mm]'"
        )
    observed = Observations(line.model, told)
    deviation = np.full(line.count, support_scatter)
    deviation[: line.droppers] = scatter
    prior = Prior(line.design.values, deviation)
    plain = estimate(line, observed, prior)
    allocations, prior, found = find_allocation_errors(line, observed, prior, plain)
    if not found.is_reached:
        raise ConvergenceError(
            "survey: no equilibrium was found near the estimate, and no exchange of droppers "
            "explains it; check the readings for gross errors, or state a larger --accuracy"
        )
    droppers, values = _droppers(line, found)
    built = with_values(designed, line, values)
    find_design(build(built))
    return AsBuilt(
        case=built,
        designed=designed,
        survey=survey,
        droppers=droppers,
        supports=_supports(designed, line, found),
        allocations=allocations,
        odd=tuple(
            (one, float(miss))
            for one, miss in zip(told, found.residuals, strict=True)
            if abs(miss) > _ODD
        ),
        misfit=float(np.sqrt(np.mean(found.residuals**2))),
        prior=prior,
    )


def _refuse_unfit(case: Case) -> None:
    """Refuse lines whose droppers the case cannot give by their lengths, span by span."""
    problems = []
    sets = case.dropper_sets
    if len(sets) != 1 or sets[0].about != "span" or case.tension_lengths:
        problems.append(
            "as-built: needs a line of one tension length with one set of droppers counted from "
            "the spans; take the tension lengths of a longer line one by one"
        )
    if len(case.wires.of_role("contact")) != 1 or not case.wires.of_role("messenger"):
        problems.append("as-built: needs one contact wire under a messenger wire")
    if case.irregularities.installation is not None:
        problems.append(
            "as-built: the case draws errors of installation (irregularities.installation); leave "
            "them out, the survey tells what there is"
        )
    if problems:
        raise InputError(problems)


def _with_staggers(case: Case, readings: Sequence[Reading]) -> Case:
    """Return the case with the staggers that were measured at supports."""
    own = [one for one in readings if one.support is not None]
    if not own:
        return case
    count = case.line.spans + 1
    staggers = list(case.supports.contact_staggers(count))
    for one in own:
        assert one.support is not None
        if one.support > count:
            raise InputError(f"{one.where}: names support {one.support}; the line has {count}")
        staggers[one.support - 1] = one.value
    return case.with_(
        **{
            "supports.contact_stagger": staggers,
            "supports.messenger_stagger": list(case.supports.messenger_staggers(count)),
        }
    )


def _droppers(line: SurveyedLine, found: Estimate) -> tuple[tuple[BuiltDropper, ...], Array]:
    """Return the droppers, and the unknowns with what slack ones hang at."""
    shape, values = found.shape, found.shape.values.copy()
    heights = line.model.mesh.heights(shape.form.system.position)
    design = line.design.values
    rows = []
    for row, hanger in enumerate(line.model.line.hangers):
        force, spread = float(shape.forces[row]), float(found.force_errors[row])
        error = float(found.errors[row])
        if not shape.taut[row]:
            values[row] = shape.distances[row] + _SLACK
            error = float(found.bound_errors[row])
        state = "slack" if not shape.taut[row] else "taut"
        rows.append(
            BuiltDropper(
                span=hanger.label.span,
                dropper=hanger.label.number,
                x=hanger.lower.s,
                design=float(design[row]),
                length=float(values[row]),
                error=error,
                force=force,
                force_error=spread,
                state="undecided" if state == "taut" and force < SURE * spread else state,
                height=float(heights[line.model.mesh.node(hanger.lower)]),
            )
        )
    return tuple(rows), values


def _rises(line: SurveyedLine, values: Array) -> tuple[dict[int, float], dict[int, float]]:
    """Return values of the messenger and the contact wire by support."""
    own = values[line.droppers :].tolist()
    split = len(line.messenger)
    return (
        dict(zip(line.messenger, own[:split], strict=True)),
        dict(zip(line.contact, own[split:], strict=True)),
    )


def _supports(case: Case, line: SurveyedLine, found: Estimate) -> tuple[BuiltSupport, ...]:
    """Return heights at all supports between the anchors."""
    count = case.line.spans + 1
    heights = case.supports.contact_heights(count)
    apart = case.supports.encumbrances(count)
    messenger, contact = _rises(line, found.shape.values)
    messenger_error, contact_error = _rises(line, found.errors)
    rows, nan = [], float("nan")
    for number in line.messenger:
        low, high = heights[number - 1], heights[number - 1] + apart[number - 1]
        rows.append(
            BuiltSupport(
                support=number,
                x=line.model.line.masts[number - 1],
                contact_design=low,
                contact=low + contact.get(number, nan),
                contact_error=contact_error.get(number, nan),
                messenger_design=high,
                messenger=high + messenger[number],
                messenger_error=messenger_error[number],
            )
        )
    return tuple(rows)


def with_values(case: Case, line: SurveyedLine, values: Array) -> Case:
    """Return a case of the same line with given lengths and heights at supports.

    Parameters
    ----------
    case
        Everything else.
    line
        The design.
    values : (n_unknown,) m
    """
    designed = line.model.case
    count = designed.line.spans + 1
    heights = list(designed.supports.contact_heights(count))
    apart = list(designed.supports.encumbrances(count))
    messenger, contact = _rises(line, values)
    for number, rise in messenger.items():
        lift = contact.get(number, 0.0)
        heights[number - 1] = round(heights[number - 1] + lift, _DIGITS)
        apart[number - 1] = round(apart[number - 1] + rise - lift, _DIGITS)
    lengths: list[list[float]] = [[] for _ in range(designed.line.spans)]
    for row, hanger in enumerate(line.model.line.hangers):
        lengths[hanger.label.span - 1].append(round(float(values[row]), _DIGITS))
    given = {"mode": "length", "lengths": lengths, "length_kind": "unstrained"}
    return case.with_(
        **{
            "supports.contact_height": heights,
            "supports.encumbrance": apart,
            **{f"droppers.{key}": value for key, value in given.items()},
        }
    )
