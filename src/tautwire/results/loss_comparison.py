"""Losses of contact of several runs, side by side."""

from __future__ import annotations

import statistics
from dataclasses import dataclass
from typing import Any

from tautwire.results.statistics import ContactLoss, LossEvent


@dataclass(frozen=True)
class LossPair:
    """One loss of the reference and the loss of another run that was matched with it.

    Attributes
    ----------
    reference, other : LossEvent
    """

    reference: LossEvent
    other: LossEvent

    @property
    def difference(self) -> float:
        """Duration minus that of the reference [s]."""
        return self.other.duration - self.reference.duration

    @property
    def error(self) -> float:
        """``|t - t_ref| / t_ref``."""
        return abs(self.difference) / self.reference.duration

    @property
    def shift(self) -> float:
        """Larger one of the differences of separation and re-contact [s]."""
        start = self.other.start - self.reference.start
        return max(abs(start), abs(start + self.difference))


@dataclass(frozen=True)
class LossMatch:
    """The losses of one run, matched in time with those of a reference.

    Attributes
    ----------
    label : str
    loss : ContactLoss
        All losses of the run.
    pairs : tuple of LossPair
        In the order of the reference.
    missed : tuple of LossEvent
        Losses of the reference, long enough, that have no partner.
    spurious : tuple of LossEvent
        Losses of the run, long enough, that have no partner.
    shortest : float s
        Shortest loss that counts in errors, as missed or as spurious.
    """

    label: str
    loss: ContactLoss
    pairs: tuple[LossPair, ...]
    missed: tuple[LossEvent, ...]
    spurious: tuple[LossEvent, ...]
    shortest: float

    @property
    def judged(self) -> tuple[LossPair, ...]:
        """Pairs whose reference is long enough and not cut by a limit of the section."""
        return tuple(
            pair
            for pair in self.pairs
            if pair.reference.duration >= self.shortest
            and not (pair.reference.is_cut or pair.other.is_cut)
        )

    @property
    def median_error(self) -> float:
        """Median of the relative errors of the durations; NaN without pairs."""
        errors = [pair.error for pair in self.judged]
        return statistics.median(errors) if errors else float("nan")

    @property
    def largest_error(self) -> float:
        """Largest relative error of a duration; NaN without pairs."""
        return max((pair.error for pair in self.judged), default=float("nan"))

    @property
    def largest_difference(self) -> float:
        """Largest absolute error of a duration [s]; NaN without pairs."""
        return max((abs(pair.difference) for pair in self.judged), default=float("nan"))

    def partner(self, event: LossEvent) -> LossPair | None:
        """Return the pair of a loss of the reference."""
        return next((pair for pair in self.pairs if pair.reference is event), None)


@dataclass(frozen=True)
class LossComparison:
    """Result of :func:`tautwire.compare_losses` for one pantograph.

    Attributes
    ----------
    label : str
        Name of the reference.
    reference : ContactLoss
    matches : tuple of LossMatch
        One per other run.
    """

    label: str
    reference: ContactLoss
    matches: tuple[LossMatch, ...]

    def as_dict(self) -> dict[str, Any]:
        """Return the comparison as plain data for JSON."""
        return {
            "reference": {"label": self.label, **self.reference.as_dict()},
            "runs": [
                {
                    "label": match.label,
                    "median_error": match.median_error,
                    "largest_error": match.largest_error,
                    "largest_difference_ms": 1e3 * match.largest_difference,
                    "missed": [event.as_dict() for event in match.missed],
                    "spurious": [event.as_dict() for event in match.spurious],
                    "durations_ms": [
                        None if pair is None else 1e3 * pair.other.duration
                        for pair in map(match.partner, self.reference.events)
                    ],
                }
                for match in self.matches
            ],
        }

    def __str__(self) -> str:
        """Return a table of durations, one line per run, and what was missed or invented."""
        numbers = [f"{1e3 * event.duration:7.2f}" for event in self.reference.events]
        width = max(len(self.label), *(len(m.label) for m in self.matches), 9)
        lines = [f"{self.label:{width}} [ms] " + "".join(numbers)]
        for match in self.matches:
            pairs = [match.partner(event) for event in self.reference.events]
            cells = ["      -" if p is None else f"{1e3 * p.other.duration:7.2f}" for p in pairs]
            lines.append(f"{match.label:{width}} [ms] " + "".join(cells))
            errors = ["      -" if p is None else f"{100.0 * p.error:7.2f}" for p in pairs]
            lines.append(f"{'error':>{width}}  [%] " + "".join(errors))
            lines += [f"  missed: {_named(event)}" for event in match.missed]
            lines += [f"  spurious: {_named(event)}" for event in match.spurious]
        return "\n".join(lines)


def _named(event: LossEvent) -> str:
    return f"{1e3 * event.duration:.2f} ms at t = {event.start:.4f} s, {event.place}"
