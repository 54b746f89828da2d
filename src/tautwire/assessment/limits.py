"""Limits and tolerances of standards, read from a data file; none of them stands in code."""

from __future__ import annotations

from functools import lru_cache
from importlib.resources import files
from pathlib import Path
from typing import Literal

from pydantic import Field, model_validator

from tautwire.assessment.data import Record, read_file, read_library, read_text
from tautwire.errors import InputError
from tautwire.specs.case import Case
from tautwire.units import to_unit

System = Literal["ac", "dc-1.5kv", "dc-3kv"]
Sense = Literal["maximum", "minimum"]

SYSTEMS: tuple[System, ...] = ("ac", "dc-1.5kv", "dc-3kv")


class Provenance(Record):
    """Where a number comes from and whether somebody compared it with the standard.

    Attributes
    ----------
    standard, edition, clause : str
        Clause is None where it is not known.
    verified : bool
        True only after comparison with the text of the standard.
    verified_by, verified_on : str or None
    confidence : str
    note : str
    """

    standard: str
    edition: str
    clause: str | None
    verified: bool
    verified_by: str | None = None
    verified_on: str | None = None
    confidence: str
    note: str = ""

    @model_validator(mode="after")
    def _check_who_verified(self) -> Provenance:
        if self.verified and not (self.verified_by and self.verified_on):
            raise ValueError("verified: true needs verified_by (a name) and verified_on (a date)")
        return self


class Constant(Record):
    """A limit that is a number."""

    kind: Literal["constant"]
    value: float


class ShareOfMean(Record):
    """A limit proportional to the mean contact force."""

    kind: Literal["share_of_mean"]
    factor: float


class SpeedCurve(Record):
    """A limit ``constant + per_speed_squared * v**2`` [N] with v in km/h."""

    kind: Literal["speed_curve"]
    constant: float
    per_speed_squared: float


class ShareOfSpace(Record):
    """A limit that is the free space for uplift over a divisor."""

    kind: Literal["share_of_space"]
    divisor: float = Field(gt=0.0)


class Applies(Record):
    """When a limit applies; speeds in km/h. What is absent does not restrict."""

    system: System | tuple[System, ...] | None = None
    uplift_stop: bool | None = None
    above: float | None = None
    from_: float | None = Field(default=None, alias="from")
    up_to: float | None = None
    below: float | None = None

    def includes(self, system: str, speed: float, *, uplift_stop: bool) -> bool:
        """Say whether the limit applies to a system, a speed [m/s] and a kind of steady arm."""
        speed_kmh = round(to_unit(speed, "km/h"), 6)
        systems = (self.system,) if isinstance(self.system, str) else self.system
        return (
            (systems is None or system in systems)
            and (self.uplift_stop is None or self.uplift_stop == uplift_stop)
            and (self.above is None or speed_kmh > self.above)
            and (self.from_ is None or speed_kmh >= self.from_)
            and (self.up_to is None or speed_kmh <= self.up_to)
            and (self.below is None or speed_kmh < self.below)
        )


class Limit(Provenance):
    """One limit of a standard.

    Attributes
    ----------
    id, name : str
    quantity : str
        What is limited: ``mean``, ``standard_deviation``, ``maximum``, ``statistical_maximum``,
        ``statistical_minimum``, ``uplift``, ``loss_percent`` or ``wave_speed_ratio``.
    sense : str
        ``"maximum"`` or ``"minimum"``.
    limit : Constant, ShareOfMean, SpeedCurve or ShareOfSpace
    unit : str
    applies : Applies
    """

    id: str
    name: str
    quantity: Literal[
        "mean",
        "standard_deviation",
        "maximum",
        "statistical_maximum",
        "statistical_minimum",
        "uplift",
        "loss_percent",
        "wave_speed_ratio",
    ]
    sense: Sense
    limit: Constant | ShareOfMean | SpeedCurve | ShareOfSpace = Field(discriminator="kind")
    unit: Literal["N", "m", "%", "1"]
    applies: Applies = Applies()

    def value(self, speed: float, mean: float, free_uplift: float | None) -> float | None:
        """Evaluate the limit.

        Parameters
        ----------
        speed : float m/s
        mean : float N
            Mean contact force of the pantograph that is checked.
        free_uplift : float m or None
            Free space for uplift at the supports.

        Returns
        -------
        float or None
            In `unit`; None when the limit needs the free space and none is given.
        """
        rule = self.limit
        if isinstance(rule, Constant):
            return rule.value
        if isinstance(rule, ShareOfMean):
            return rule.factor * mean
        if isinstance(rule, SpeedCurve):
            return rule.constant + rule.per_speed_squared * to_unit(speed, "km/h") ** 2
        return None if free_uplift is None else free_uplift / rule.divisor


class Tolerance(Provenance):
    """Accuracy asked of a simulation against a measurement.

    Attributes
    ----------
    id, name, quantity : str
    relative : bool
        True: (simulated - measured) / measured; False: simulated - measured.
    low, high : float
    unit : str
    """

    id: str
    name: str
    quantity: Literal["standard_deviation", "uplift", "contact_height_range", "elasticity"]
    relative: bool
    low: float
    high: float
    unit: Literal["N", "m", "m/N", "1"]


class Limits(Record):
    """The content of a file of limits.

    Attributes
    ----------
    schema_version : int
    limits : tuple of Limit
    tolerances : tuple of Tolerance
    """

    schema_version: Literal[1] = Field(alias="schema")
    limits: tuple[Limit, ...]
    tolerances: tuple[Tolerance, ...] = ()


def load_limits(path: str | Path | None = None) -> Limits:
    """Load limits and tolerances.

    Parameters
    ----------
    path : path, optional
        YAML file of the user, for example with entries verified against a bought standard; by
        default the file of the package.

    Returns
    -------
    Limits

    Raises
    ------
    InputError
        When the file cannot be read, with every fault.
    """
    return _library_limits() if path is None else read_file(path, Limits)


def limits_of(case: Case) -> Limits:
    """Return the limits that a case names; those of the package where it names none.

    Raises
    ------
    InputError
        When they do not hold what limits should, with every fault.
    """
    return (
        read_text(case.limits, f"limits of {case.name}", Limits) if case.limits else load_limits()
    )


def limits_text() -> str:
    """Return the package's file of limits as text, to begin an own one from."""
    return files("tautwire").joinpath("catalogue", "limits.yaml").read_text(encoding="utf-8")


def known_system(name: str) -> System:
    """Return a supply system by name.

    Raises
    ------
    InputError
        When there is no such system.
    """
    for system in SYSTEMS:
        if name.lower() == system:
            return system
    raise InputError(f"no supply system named {name!r}; there are: {', '.join(SYSTEMS)}")


@lru_cache(maxsize=1)
def _library_limits() -> Limits:
    return read_library("limits.yaml", Limits)
