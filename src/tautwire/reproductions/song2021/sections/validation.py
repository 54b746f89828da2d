"""Section II.C, Table 2: statistics of the contact force up to 20 Hz, by reading."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from tautwire.reproductions.song2021 import published
from tautwire.reproductions.song2021.claims import Claim, Condition, Evidence, near
from tautwire.reproductions.song2021.passages import (
    CONVENTIONS,
    LINES,
    MESHES,
    UNCALIBRATED,
    series,
    standard,
)
from tautwire.reproductions.song2021.sections.forces import Passages

WITHIN = {"mean": 0.005, "maximum": 0.03, "minimum": 0.05}
DEVIATION_WITHIN = 0.02
"""Relative deviations that count as reproduced; the paper is up to 5 % off the benchmark itself."""


@dataclass(frozen=True)
class Variant:
    """Table 2 under one reading of what the paper leaves open.

    Attributes
    ----------
    label : str
    group : str
        What is varied.
    numbers : mapping of str to float
        By quantity [N].
    """

    label: str
    group: str
    numbers: Mapping[str, float]

    @property
    def largest_deviation(self) -> float:
        """Largest relative deviation of a standard deviation from the paper's."""
        names = [name for name in published.QUANTITIES if name.startswith("std")]
        return max(abs(self.numbers[n] / published.PAPER[n] - 1.0) for n in names)


def readings(passages: Passages) -> list[Variant]:
    """Return Table 2 under every reading that was computed.

    Parameters
    ----------
    passages
    """
    base = standard(9, UNCALIBRATED)
    own = [reading for line in LINES for reading in series(line)]
    found = [
        Variant(str(reading), "reading", passages.statistics(standard(9, reading)))
        for reading in own
        if passages.has(standard(9, reading))
    ]
    found += [
        Variant(f"NAD {mesh}", "mesh", passages.statistics(standard(mesh, UNCALIBRATED)))
        for mesh in MESHES[1:]
        if passages.has(standard(mesh, UNCALIBRATED))
    ]
    if passages.has(base):
        found.append(Variant("Butterworth", "filter", passages.statistics(base, "Butterworth")))
        found += [
            Variant(name, "window", passages.statistics(base, window=window))
            for name, window in passages.windows(base).items()
        ]
    found += [
        Variant(words, "model", passages.statistics(name))
        for name, (words, _) in CONVENTIONS.items()
        if passages.has(name)
    ]
    return found


def claims(found: list[Variant]) -> list[Claim]:
    """Judge Table 2.

    Parameters
    ----------
    found
        Those that vary anything but the reading differ from the uncalibrated one.
    """
    own = tuple(
        near(_condition(item), published.NAMES[name], item.numbers[name], value,
             WITHIN.get(name, DEVIATION_WITHIN))
        for item in found
        for name, value in published.PAPER.items()
    )  # fmt: skip
    close = tuple(
        _as_close(_condition(item), name, item.numbers[name])
        for item in found
        for name in published.QUANTITIES
    )
    return [
        Claim(
            "table-2",
            "II.C",
            "Statistics of the contact force at 320 km/h, the paper's column of Table 2 (limits "
            "here: σ within 2 %, Fm 0.5 %, Fmax 3 %, Fmin 5 %).",
            own,
            "The paper states neither contact stiffness nor filter, damping, closure or window.",
        ),
        Claim(
            "table-2-benchmark",
            "II.C",
            "The statistics agree with the benchmark as well as the paper's do (limit here: 10 % "
            "on every number, which the paper keeps).",
            close,
        ),
    ]


def _condition(item: Variant) -> Condition:
    if item.group == "reading":
        return Condition(item.label, item.label != str(UNCALIBRATED))
    return Condition(f"{item.group}: {item.label}", departs=True)


def _as_close(condition: Condition, name: str, found: float) -> Evidence:
    return near(condition, published.NAMES[name], found, published.BENCHMARK[name], 0.1)
