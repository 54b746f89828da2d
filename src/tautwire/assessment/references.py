"""Comparison of a run with published ranges and values of reference lines."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Literal, Self

import numpy as np
from pydantic import Field, model_validator

from tautwire.assessment.data import Record, read_file, read_library
from tautwire.errors import InputError
from tautwire.plain import Plain
from tautwire.results.accuracy import Accuracy, error_of
from tautwire.results.equilibrium import Elasticity
from tautwire.results.statistics import PantographStatistics, RunStatistics
from tautwire.units import parse_unit, to_unit

LARGE_DEVIATION = 0.05
"""Deviation from a single published value that asks for an explanation; the paper's own model is
up to 5.2 % off the standard deviations of the benchmark."""

_SI_UNITS = {"N": "N", "mm": "m", "%": "%", "mm/N": "m/N"}


class ReferenceValue(Record):
    """A published range or value of one quantity, in the published unit.

    Attributes
    ----------
    low, high : float or None
        Range, both given or neither.
    target : float or None
        Single value, instead of a range.
    unit : str
    round_to : float or None
        Step to which the run's number is rounded before it is compared.
    confidence : str or None
        Where it differs from that of the reference.
    note : str
    """

    low: float | None = None
    high: float | None = None
    target: float | None = None
    unit: Literal["N", "mm", "%"]
    round_to: float | None = Field(default=None, gt=0.0)
    confidence: str | None = None
    note: str = ""

    @model_validator(mode="after")
    def _require_range_or_target(self) -> Self:
        if (self.low is None) != (self.high is None) or (self.low is None) == (self.target is None):
            raise ValueError("give either low and high, or target")
        return self


class Reference(Record):
    """Published results of one reference line at one speed.

    Attributes
    ----------
    id, title : str
    cases : tuple of str
        Library cases of this line.
    speed_kmh : float
    filter : str
        Filter of the published values, as far as it is known.
    source, confidence : str
    provisional : bool
        True when the values are remembered and their source was not read.
    values : mapping of str to ReferenceValue
        By quantity: ``mean``, ``std_0_20``, ``maximum``, ``uplift``, ``loss_percent`` and so on.
    """

    id: str
    title: str
    cases: tuple[str, ...]
    speed_kmh: float
    filter: str
    source: str
    confidence: str
    provisional: bool
    values: dict[str, ReferenceValue]


class ElasticityReference(Record):
    """Published elasticity at the support and the droppers of one span.

    Attributes
    ----------
    id, title, source, confidence, note : str
    cases : tuple of str
        Library cases of this line.
    unit : str
    support : float
    droppers : tuple of float
    """

    id: str
    title: str
    cases: tuple[str, ...]
    source: str
    confidence: str
    note: str = ""
    unit: Literal["mm/N"]
    support: float
    droppers: tuple[float, ...]


class Explanation(Record):
    """What is known of numbers of a library case that lie off the published ones.

    Attributes
    ----------
    case : str
    speed_kmh : float
    quantities : tuple of str
        Quantities it is about.
    text : str
    """

    case: str
    speed_kmh: float
    quantities: tuple[str, ...]
    text: str


class ReferenceLibrary(Record):
    """The content of a file of published results.

    Attributes
    ----------
    schema_version : int
    references : tuple of Reference
    elasticities : tuple of ElasticityReference
    explanations : tuple of Explanation
    """

    schema_version: Literal[1] = Field(alias="schema")
    references: tuple[Reference, ...]
    elasticities: tuple[ElasticityReference, ...] = ()
    explanations: tuple[Explanation, ...] = ()

    def get(self, name: str) -> Reference:
        """Return the reference with an id.

        Raises
        ------
        InputError
            When there is none.
        """
        for reference in self.references:
            if reference.id == name:
                return reference
        names = ", ".join(reference.id for reference in self.references)
        raise InputError(f"no reference named {name!r}; there are: {names}")

    def of_case(self, case: str, speed: float) -> tuple[Reference, ...]:
        """Return the references of a case at a speed [m/s], within 0.5 km/h."""
        return tuple(
            reference
            for reference in self.references
            if case in reference.cases and _is_same_speed(reference.speed_kmh, speed)
        )

    def explain(
        self, case: str, speed: float, rows: Iterable[ReferenceRow]
    ) -> tuple[Explanation, ...]:
        """Return what is known of the rows that lie off the published numbers.

        Parameters
        ----------
        case
            Name of the case.
        speed
            [m/s]
        rows
            Comparisons of a run of this case.
        """
        off = {row.quantity for row in rows if row.is_off}
        return tuple(
            found
            for found in self.explanations
            if found.case == case
            and _is_same_speed(found.speed_kmh, speed)
            and off.intersection(found.quantities)
        )

    def elasticities_of_case(self, case: str) -> tuple[ElasticityReference, ...]:
        """Return the published elasticities of a case."""
        return tuple(entry for entry in self.elasticities if case in entry.cases)


@dataclass(frozen=True)
class ReferenceRow(Plain):
    """One number of a run beside a published one, in SI units.

    Attributes
    ----------
    quantity : str
    value : float
        Number of the run, not rounded.
    low, high : float or None
        Published range.
    target : float or None
        Published single value.
    deviation : float or None
        ``(value - target) / target``, a fraction.
    inside : bool or None
        Whether the value, rounded where the source was, lies in the range; None without range.
    unit : str
    filter : str
        Filter of the run's number.
    reference, source, confidence, note : str
    is_carried : bool
        Whether mesh and time step carry the number of the run.
    error : float
        Half width of the numerical error bar of that number; NaN where none is known.
    """

    quantity: str
    value: float
    low: float | None
    high: float | None
    target: float | None
    deviation: float | None
    inside: bool | None
    unit: str
    filter: str
    reference: str
    source: str
    confidence: str
    note: str
    is_carried: bool = True
    error: float = math.nan

    @property
    def is_off(self) -> bool:
        """True outside a published range, or more than 5 % off a published value."""
        return self.inside is False or abs(self.deviation or 0.0) > LARGE_DEVIATION


def load_references(path: str | Path | None = None) -> ReferenceLibrary:
    """Load published results.

    Parameters
    ----------
    path : path, optional
        YAML file of the user; by default the file of the package.

    Returns
    -------
    ReferenceLibrary

    Raises
    ------
    InputError
        When the file cannot be read, with every fault.
    """
    return _library_references() if path is None else read_file(path, ReferenceLibrary)


def compare_with_reference(
    statistics: RunStatistics,
    reference: Reference,
    pantograph: str | None = None,
    filter: str | None = None,
    accuracy: Accuracy | None = None,
) -> tuple[ReferenceRow, ...]:
    """Compare the statistics of a run with a published set of ranges or values.

    Parameters
    ----------
    statistics : RunStatistics
    reference : Reference
    pantograph : str, optional
        Name; by default the leading one.
    filter : {"sharp", "butterworth"}, optional
        By default the headline filter.
    accuracy : Accuracy, optional
        Numerical errors of the statistics, which are told beside the numbers.

    Returns
    -------
    tuple of ReferenceRow

    Raises
    ------
    InputError
        When a published quantity or the filter is not known.
    """
    entry = statistics.pantograph(pantograph)
    kind = filter or entry.headline_kind
    if kind not in entry.filtered:
        names = ", ".join(entry.filtered)
        raise InputError(f"no statistics with a filter {kind!r}; there are: {names}")
    numbers = _numbers(statistics, entry.name, kind)
    unknown = [name for name in reference.values if name not in numbers]
    if unknown:
        raise InputError(
            f"reference {reference.id}: unknown quantity {unknown[0]!r}; "
            f"there are: {', '.join(numbers)}"
        )
    description = entry.filtered[kind].description
    return tuple(
        replace(
            _row(reference, name, numbers[name], published, description),
            is_carried=_is_carried(entry, kind, name),
            error=_error(accuracy, entry.name, kind, name),
        )
        for name, published in reference.values.items()
    )


def _is_carried(entry: PantographStatistics, kind: str, name: str) -> bool:
    """Return whether mesh and time step carry a number of a pantograph."""
    part = entry.filtered[kind]
    if name == "loss_percent":
        return entry.contact_loss.is_carried
    if name.startswith("std_"):
        return part.carries(name.removeprefix("std_"))
    return name in ("mean", "uplift") or part.carries(f"0_{part.cutoff:g}")


def _error(accuracy: Accuracy | None, who: str, kind: str, name: str) -> float:
    """Return the numerical error of a number by the name a reference uses."""
    if name == "uplift":
        return error_of(accuracy, name)
    if name == "loss_percent":
        return error_of(accuracy, who, "loss")
    return error_of(accuracy, who, kind, name.removeprefix("std_"))


def compare_elasticity(
    elasticity: Elasticity, reference: ElasticityReference, span: int
) -> tuple[ReferenceRow, ...]:
    """Compare the elasticity at the support and the droppers of a span with published values.

    Parameters
    ----------
    elasticity : Elasticity
    reference : ElasticityReference
    span : int
        1-based, a span in the middle of the line.

    Returns
    -------
    tuple of ReferenceRow
        Support first, then the droppers from left to right.

    Raises
    ------
    InputError
        When the span lacks one of the points.
    """
    names = ["support", *(f"dropper {i + 1}" for i in range(len(reference.droppers)))]
    targets = [reference.support, *reference.droppers]
    points = [("support", 0), *(("dropper", i + 1) for i in range(len(reference.droppers)))]
    factor = parse_unit(reference.unit).factor
    rows = []
    for name, (kind, index), target in zip(names, points, targets, strict=True):
        value = _elasticity_at(elasticity, span, kind, index)
        rows.append(
            ReferenceRow(
                quantity=f"elasticity at {name}",
                value=value,
                low=None,
                high=None,
                target=target * factor,
                deviation=value / (target * factor) - 1.0,
                inside=None,
                unit=_SI_UNITS[reference.unit],
                filter=f"static, {elasticity.force:g} N",
                reference=reference.id,
                source=reference.source,
                confidence=reference.confidence,
                note=reference.note,
            )
        )
    return tuple(rows)


def _numbers(statistics: RunStatistics, name: str, kind: str) -> dict[str, float]:
    """Return the numbers of one pantograph by the names a reference uses (SI units)."""
    entry = statistics.pantograph(name)
    part = entry.filtered[kind]
    return {
        "mean": part.mean,
        **{f"std_{band}": value for band, value in part.standard_deviations.items()},
        "statistical_maximum": part.statistical_maximum,
        "statistical_minimum": part.statistical_minimum,
        "maximum": part.maximum,
        "minimum": part.minimum,
        "uplift": statistics.uplift.maximum,
        "loss_percent": entry.contact_loss.percent,
    }


def _row(
    reference: Reference, name: str, value: float, published: ReferenceValue, description: str
) -> ReferenceRow:
    factor = 1.0 if published.unit == "%" else parse_unit(published.unit).factor
    inside: bool | None = None
    if published.low is not None and published.high is not None and math.isfinite(value):
        compared = value / factor
        if published.round_to is not None:
            compared = round(compared / published.round_to) * published.round_to
        inside = published.low <= compared <= published.high
    target = None if published.target is None else published.target * factor
    is_force = name not in ("uplift", "loss_percent")
    return ReferenceRow(
        quantity=name,
        value=value,
        low=None if published.low is None else published.low * factor,
        high=None if published.high is None else published.high * factor,
        target=target,
        deviation=value / target - 1.0 if target else None,
        inside=inside,
        unit=_SI_UNITS[published.unit],
        filter=description if is_force else "unfiltered",
        reference=reference.id,
        source=reference.source,
        confidence=published.confidence or reference.confidence,
        note=published.note,
    )


def _elasticity_at(elasticity: Elasticity, span: int, kind: str, index: int) -> float:
    chosen = (
        (elasticity.span == span)
        & (elasticity.index == index)
        & (np.asarray(elasticity.kind) == kind)
    )
    if not chosen.any():
        label = kind if kind == "support" else f"{kind} {index}"
        raise InputError(f"the elasticity holds no {label} of span {span}; compare another span")
    return float(elasticity.elasticity[chosen][0])


def _is_same_speed(speed_kmh: float, speed: float) -> bool:
    """Compare with a speed in m/s, within 0.5 km/h."""
    return abs(speed_kmh - to_unit(speed, "km/h")) <= 0.5


@lru_cache(maxsize=1)
def _library_references() -> ReferenceLibrary:
    return read_library("references.yaml", ReferenceLibrary)
