"""Claims of the paper, the numbers that speak for or against each, and the rule of the verdict."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from tautwire.reproductions.song2021.passages import UNCALIBRATED, Reading

REPRODUCED = "reproduced"
CONDITIONAL = "reproduced under stated conditions"
NOT_REPRODUCED = "not reproduced"
NO_VALUE = "not evaluated"

VERDICTS = (REPRODUCED, CONDITIONAL, NOT_REPRODUCED, NO_VALUE)

RULE = (
    "Every claim is judged under the uncalibrated reading (the library case, in which no number "
    "was selected to meet a result) and, as conditions, under other readings of what the paper "
    "leaves open, by limits that are printed with the numbers. It is reproduced when all limits "
    "are kept under the uncalibrated reading, reproduced under stated conditions when they are "
    "kept under another one or a part of it, and otherwise not reproduced."
)


@dataclass(frozen=True)
class Condition:
    """Under which reading of what the paper leaves open a number was found.

    Attributes
    ----------
    text : str
        Empty where nothing is left open.
    departs : bool
        True when it is not the uncalibrated reading.
    """

    text: str = ""
    departs: bool = False


ALWAYS = Condition()
"""Where nothing is left open."""


def under(reading: Reading, *more: str) -> Condition:
    """Return the condition of a reading, with what else is special to the number."""
    return Condition(", ".join((str(reading), *more)), reading != UNCALIBRATED)


@dataclass(frozen=True)
class Evidence:
    """One number, and what it should be.

    Attributes
    ----------
    condition : Condition
    quantity : str
    found : float
    unit : str
    low, high : float
        Limits that it has to keep; infinite where there is none.
    published : float or None
        The paper's own number.
    """

    condition: Condition
    quantity: str
    found: float
    unit: str
    low: float = -math.inf
    high: float = math.inf
    published: float | None = None

    @property
    def holds(self) -> bool:
        """True when the number keeps its limits; a number that is missing does not."""
        return self.low <= self.found <= self.high

    @property
    def is_judged(self) -> bool:
        """True when there is a limit to keep."""
        return math.isfinite(self.low) or math.isfinite(self.high)

    @property
    def requirement(self) -> str:
        """The limits in words."""
        low, high = (
            f"{value:.5g}".replace("-", "\N{MINUS SIGN}") for value in (self.low, self.high)
        )
        if math.isfinite(self.low) and math.isfinite(self.high):
            return f"{low} to {high}"
        if math.isfinite(self.low):
            return f"≥ {low}"
        return f"≤ {high}" if math.isfinite(self.high) else "shown only"

    def as_dict(self) -> dict[str, Any]:
        """Return the number as plain data for JSON."""
        return {
            "condition": self.condition.text,
            "departs": self.condition.departs,
            "quantity": self.quantity,
            "found": _finite(self.found),
            "unit": self.unit,
            "published": _finite(self.published),
            "low": _finite(self.low),
            "high": _finite(self.high),
            "holds": self.holds,
        }


@dataclass(frozen=True)
class Claim:
    """A statement of the paper.

    Attributes
    ----------
    name : str
        Short and unique, as in ``"table-2"``.
    section : str
        Of the paper, as in ``"III.A"``.
    statement : str
        What the paper says.
    evidence : tuple of Evidence
    remark : str
        What the numbers mean.
    """

    name: str
    section: str
    statement: str
    evidence: tuple[Evidence, ...]
    remark: str = ""

    @property
    def by_condition(self) -> dict[Condition, bool]:
        """Whether all limits are kept, by condition."""
        found: dict[Condition, bool] = {}
        for item in self.evidence:
            found[item.condition] = found.get(item.condition, True) and item.holds
        return found

    @property
    def verdict(self) -> str:
        """The outcome by :data:`RULE`; ``"not evaluated"`` without evidence."""
        outcomes = self.by_condition
        first = [holds for condition, holds in outcomes.items() if not condition.departs]
        if not outcomes:
            return NO_VALUE
        if first and all(first):
            return REPRODUCED
        return CONDITIONAL if any(outcomes.values()) else NOT_REPRODUCED

    @property
    def verdict_under_all(self) -> str:
        """The outcome with every reading counting alike: under all, under some, under none."""
        outcomes = list(self.by_condition.values())
        if not outcomes:
            return NO_VALUE
        if all(outcomes):
            return REPRODUCED
        return CONDITIONAL if any(outcomes) else NOT_REPRODUCED

    @property
    def explanation(self) -> str:
        """Under which conditions the claim holds and under which it does not."""
        if self.verdict_under_all != CONDITIONAL:
            return ""
        kept = [own.text for own, holds in self.by_condition.items() if holds]
        broken = [own.text for own, holds in self.by_condition.items() if not holds]
        return f"holds for: {'; '.join(kept)}. Not for: {'; '.join(broken)}."

    def as_dict(self) -> dict[str, Any]:
        """Return the claim as plain data for JSON."""
        return {
            "name": self.name,
            "section": self.section,
            "statement": self.statement,
            "verdict": self.verdict,
            "verdict_under_all": self.verdict_under_all,
            "explanation": self.explanation,
            "remark": self.remark,
            "evidence": [item.as_dict() for item in self.evidence],
        }


def near(
    condition: Condition,
    quantity: str,
    found: float,
    published: float,
    within: float,
    unit: str = "N",
) -> Evidence:
    """Ask that a number be within a share of the published one.

    Parameters
    ----------
    condition, quantity
    found, published
        In `unit`.
    within
        Largest relative deviation.
    unit
    """
    margin = within * abs(published)
    low, high = published - margin, published + margin
    return Evidence(condition, quantity, found, unit, low, high, published)


def most(
    condition: Condition, quantity: str, found: float, limit: float, unit: str = "%"
) -> Evidence:
    """Ask that a number be at most a limit."""
    return Evidence(condition, quantity, found, unit, high=limit)


def least(
    condition: Condition, quantity: str, found: float, limit: float, unit: str = "%"
) -> Evidence:
    """Ask that a number be at least a limit."""
    return Evidence(condition, quantity, found, unit, low=limit)


def counts(claims: Sequence[Claim], *, alike: bool = False) -> dict[str, int]:
    """Return the number of claims per verdict.

    Parameters
    ----------
    claims
    alike
        Whether every reading counts alike (:attr:`Claim.verdict_under_all`).
    """
    verdicts = [claim.verdict_under_all if alike else claim.verdict for claim in claims]
    return {verdict: verdicts.count(verdict) for verdict in VERDICTS if verdict in verdicts}


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None
