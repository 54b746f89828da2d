"""Section II.C, Table 2: statistics of the contact force up to 20 Hz, by reading."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from tautwire.reproductions.song2021 import published
from tautwire.reproductions.song2021.claims import Claim, Evidence, near
from tautwire.reproductions.song2021.passages import (
    CONVENTIONS,
    FITTING,
    MESHES,
    STIFFNESSES,
    convention,
    standard,
)
from tautwire.reproductions.song2021.sections.forces import Passages

WITHIN = {"mean": 0.005, "maximum": 0.03, "minimum": 0.05}
DEVIATION_WITHIN = 0.02


@dataclass(frozen=True)
class Reading:
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


def readings(passages: Passages) -> list[Reading]:
    """Return Table 2 under every reading that was computed.

    Parameters
    ----------
    passages
    """
    base = standard(9, FITTING)
    found = [
        Reading(f"{k} kN/m", "contact stiffness", passages.statistics(standard(9, k)))
        for k in STIFFNESSES
        if passages.has(standard(9, k))
    ]
    found += [
        Reading(f"NAD {mesh}", "mesh", passages.statistics(standard(mesh, FITTING)))
        for mesh in MESHES[1:]
        if passages.has(standard(mesh, FITTING))
    ]
    if passages.has(base):
        found.append(Reading("Butterworth", "filter", passages.statistics(base, "Butterworth")))
        found += [
            Reading(name, "window", passages.statistics(base, window=window))
            for name, window in passages.windows(base).items()
        ]
    for name, (words, _) in CONVENTIONS.items():
        for k in (FITTING, 50):
            if passages.has(convention(name, k)):
                label = words if k == FITTING else f"{words}, {k} kN/m"
                numbers = passages.statistics(convention(name, k))
                found.append(Reading(label, "model", numbers))
    return found


def claims(found: list[Reading]) -> list[Claim]:
    """Judge Table 2.

    Parameters
    ----------
    found
        Readings; those that vary anything but the contact stiffness use 500 kN/m unless they say
        otherwise.
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


def _condition(item: Reading) -> str:
    return item.label if item.group == "contact stiffness" else f"{item.group}: {item.label}"


def _as_close(condition: str, name: str, found: float) -> Evidence:
    return near(condition, published.NAMES[name], found, published.BENCHMARK[name], 0.1)
