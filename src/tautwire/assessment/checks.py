"""Checks of a passage against limits of standards.

A limit that nobody compared with the standard's text never says "passed": `passed` is None then,
and the report writes "unverified". Whether the number lies within the limit as remembered is told
apart, by `within`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import ClassVar

from tautwire.assessment.limits import Limit, Limits, known_system, limits_of
from tautwire.assessment.references import load_references
from tautwire.plain import Plain
from tautwire.results.accuracy import Accuracy, error_of
from tautwire.results.statistics import PantographStatistics, RunStatistics
from tautwire.specs.case import Case
from tautwire.specs.scenario import TUNING_TOLERANCE

_ROUNDING = 1e-6
"""Force by which sums differ from the limit they were aimed at [N]."""
_PUBLISHED_AS = {"mean": "mean", "standard_deviation": "std_0_20", "maximum": "maximum"}
"""Names of limited quantities among those of published results, all in newtons."""


@dataclass(frozen=True)
class Check(Plain):
    """One number against one limit.

    Attributes
    ----------
    name : str
    pantograph : str or None
        None for a check of the line or of the whole run.
    value, limit : float
        In `unit`.
    unit : str
        SI unit, ``"%"`` or ``"1"``.
    sense : str
        ``"maximum"``: the value may not exceed the limit; ``"minimum"``: not fall below it.
    within : bool or None
        Whether the value lies within the limit as it stands in the file; None without a value.
    passed : bool or None
        The same, but None as long as the limit is not verified.
    standard, edition, clause : str
        Clause is None where it is not known.
    verified : bool
    confidence, note : str
    checked_by, checked_on : str or None
        Who compared the limit with the text of the standard, and when.
    explanation : str
        What is known of a value outside its limit; empty where nothing is.
    is_carried : bool
        Whether mesh and time step carry the value.
    error : float
        Half width of the numerical error bar of the value, in `unit`; NaN where none is known.
    """

    derived: ClassVar[tuple[str, ...]] = ("verdict", "words")

    name: str
    pantograph: str | None
    value: float
    limit: float
    unit: str
    sense: str
    within: bool | None
    passed: bool | None
    standard: str
    edition: str
    clause: str | None
    verified: bool
    confidence: str
    note: str
    checked_by: str | None = None
    checked_on: str | None = None
    explanation: str = ""
    is_carried: bool = True
    error: float = math.nan

    @property
    def verdict(self) -> str:
        """``"passed"``, ``"failed"``, ``"unverified"`` or ``"no value"``."""
        if self.within is None:
            return "no value"
        if self.passed is None:
            return "unverified"
        return "passed" if self.passed else "failed"

    @property
    def words(self) -> str:
        """Return the verdict as a client reads it."""
        if self.within is None:
            return "no value"
        if not self.verified:
            return "limit not checked against the standard"
        return "within" if self.within else "not within"


@dataclass(frozen=True)
class Criteria:
    """What a run is judged by beyond its case.

    Attributes
    ----------
    system : {"ac", "dc-1.5kv", "dc-3kv"}
        Supply system.
    free_uplift : float m or None
        Free space for uplift at the supports; None for that of the case.
    limits : Limits or None
        Limits of the user's own; None for those of the case, or of the package.
    """

    system: str = "ac"
    free_uplift: float | None = None
    limits: Limits | None = None

    def checks(
        self, statistics: RunStatistics, case: Case, accuracy: Accuracy | None = None
    ) -> tuple[Check, ...]:
        """Check the statistics of a run; see :func:`checks`."""
        return checks(
            statistics,
            case,
            system=self.system,
            free_uplift=self.free_uplift,
            limits=self.limits,
            accuracy=accuracy,
        )


def checks(
    statistics: RunStatistics,
    case: Case,
    *,
    system: str = "ac",
    free_uplift: float | None = None,
    uplift_stop: bool | None = None,
    limits: Limits | None = None,
    accuracy: Accuracy | None = None,
) -> tuple[Check, ...]:
    """Check the statistics of a run against the limits that apply to its speed and system.

    Forces are those of the headline filter. A mean force that was tuned to a value which keeps its
    limit keeps it as well when it misses by no more than the tolerance of the tuning; the check
    says so. Without any free space for uplift, the uplift is not checked.

    Parameters
    ----------
    statistics : RunStatistics
    case : Case
    system : {"ac", "dc-1.5kv", "dc-3kv"}
        Supply system, which decides between curves; a case does not say it.
    free_uplift : float m, optional
        Free space for uplift at the supports; by default that of the case,
        :meth:`Case.uplift_space`.
    uplift_stop : bool, optional
        Whether the steady arms have an uplift stop; by default as the case says.
    limits : Limits, optional
        By default those that the case names, or those of the package.
    accuracy : Accuracy, optional
        Numerical errors of the statistics, which are told beside the values.

    Returns
    -------
    tuple of Check

    Raises
    ------
    InputError
        When the supply system is unknown, or the limits of the case cannot be read.
    """
    supply = known_system(system)
    speed = case.scenario.speed
    stops = any(kind.stop is not None for kind in case.supports.kinds())
    has_stop = stops if uplift_stop is None else uplift_stop
    space = case.uplift_space() if free_uplift is None else free_uplift
    rows: list[Check] = []
    for limit in (limits or limits_of(case)).limits:
        if not limit.applies.includes(supply, speed, uplift_stop=has_stop):
            continue
        for pantograph, value, mean in _values(limit.quantity, statistics, case):
            bound = limit.value(speed, mean, space)
            if bound is not None:
                found = _with_tuning(_check(limit, pantograph, value, bound), limit, case)
                found = replace(
                    found,
                    is_carried=_is_carried(limit, pantograph, statistics),
                    error=_error(limit, pantograph, statistics, accuracy),
                )
                rows.append(_with_published(found, limit, case))
    return tuple(rows)


def _is_carried(limit: Limit, pantograph: str | None, statistics: RunStatistics) -> bool:
    """Return whether mesh and time step carry a limited quantity."""
    if pantograph is None or limit.quantity == "mean":
        return True
    entry = statistics.pantograph(pantograph)
    if limit.quantity == "loss_percent":
        return entry.contact_loss.is_carried
    return entry.headline.carries(f"0_{entry.headline.cutoff:g}")


def _error(
    limit: Limit, pantograph: str | None, statistics: RunStatistics, accuracy: Accuracy | None
) -> float:
    """Return the numerical error of a limited quantity.

    None is known of losses without the short ones.
    """
    if pantograph is None:
        return error_of(accuracy, limit.quantity)
    kind = statistics.pantograph(pantograph).headline.kind
    return error_of(accuracy, pantograph, kind, limit.quantity)


def _values(
    quantity: str, statistics: RunStatistics, case: Case
) -> Iterable[tuple[str | None, float, float]]:
    """Yield pantograph (None: the whole run), value and mean force for a limited quantity."""
    if quantity == "uplift":
        yield None, statistics.uplift.maximum, math.nan
    elif quantity == "wave_speed_ratio":
        yield None, case.scenario.speed / case.wires.contact.wave_speed(), math.nan
    else:
        for entry in statistics.pantographs:
            yield entry.name, _pantograph_value(quantity, entry), entry.headline.mean


def _pantograph_value(quantity: str, entry: PantographStatistics) -> float:
    if quantity == "loss_percent":
        return entry.contact_loss.percent_over()
    return float(getattr(entry.headline, quantity))


def _check(limit: Limit, pantograph: str | None, value: float, bound: float) -> Check:
    within: bool | None = None
    if math.isfinite(value) and math.isfinite(bound):
        within = value <= bound if limit.sense == "maximum" else value >= bound
    return Check(
        name=limit.name,
        pantograph=pantograph,
        value=value,
        limit=bound,
        unit=limit.unit,
        sense=limit.sense,
        within=within,
        passed=within if limit.verified else None,
        standard=limit.standard,
        edition=limit.edition,
        clause=limit.clause,
        verified=limit.verified,
        confidence=limit.confidence,
        note=limit.note,
        checked_by=limit.verified_by if limit.verified else None,
        checked_on=limit.verified_on if limit.verified else None,
    )


def _with_published(check: Check, limit: Limit, case: Case) -> Check:
    """Say so where published results of the same line and speed lie outside a limit as well."""
    if check.within is not False or limit.quantity not in _PUBLISHED_AS:
        return check
    texts = []
    for reference in load_references().of_case(case.name, case.scenario.speed):
        numbers = {name: own.target for name, own in reference.values.items()}
        value, mean = numbers.get(_PUBLISHED_AS[limit.quantity]), numbers.get("mean")
        bound = None if mean is None else limit.value(case.scenario.speed, mean, None)
        if value is None or bound is None:
            continue
        if (value > bound) == (limit.sense == "maximum"):
            texts.append(f"{reference.title}: {value:g} {limit.unit} against {bound:.1f}")
    if not texts:
        return check
    return replace(
        check,
        explanation=f"published results of this line lie outside as well ({'; '.join(texts)})",
    )


def _with_tuning(check: Check, limit: Limit, case: Case) -> Check:
    """Allow the tolerance of the tuning to a mean force that was aimed at an allowed value."""
    target = case.scenario.target_mean_force()
    if limit.quantity != "mean" or target is None or check.within is not False:
        return check
    sign = 1.0 if limit.sense == "maximum" else -1.0
    is_aimed_well = sign * (target - check.limit) <= _ROUNDING
    if not is_aimed_well or sign * (check.value - check.limit) > TUNING_TOLERANCE + _ROUNDING:
        return check
    text = (
        f"tuned to {target:.2f} N, which keeps the limit; {check.value:.2f} N misses it within the "
        f"tolerance of the tuning, {TUNING_TOLERANCE:g} N"
    )
    return replace(
        check,
        within=True,
        passed=True if limit.verified else None,
        note="; ".join(filter(None, (check.note, text))),
    )
