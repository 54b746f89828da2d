"""Section III.B, Figs 7-9: what the contact stiffness does to the contact force."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tautwire.reproductions.song2021 import published
from tautwire.reproductions.song2021.claims import (
    Claim,
    Condition,
    Evidence,
    least,
    most,
)
from tautwire.reproductions.song2021.passages import (
    LINES,
    MESHES,
    STIFFNESSES,
    UNCALIBRATED,
    series,
    standard,
)
from tautwire.reproductions.song2021.sections.forces import Passages
from tautwire.reproductions.song2021.sections.mesh import force_comb

Array = NDArray[np.float64]

CUTOFFS = (20, 50, 200)
"""Of the changes that section III.B gives [Hz]."""
CHANGE_WITHIN = 3.0
"""Limit for a change of the standard deviation: percentage points."""

MOST = 50.0
"""More than this share counts as most [%]."""

ALIKE = 0.8
"""Least correlation of two histories of the same waveform."""

BANDS = ((0.0, 50.0), (50.0, 200.0))
"""Of Fig. 8 [Hz]."""


@dataclass(frozen=True)
class Series:
    """One line on one mesh, passed with every contact stiffness.

    Attributes
    ----------
    line : str
        Key of :data:`LINES`.
    mesh : int
        NAD.
    """

    line: str
    mesh: int

    def __str__(self) -> str:
        """Return line and mesh in words."""
        return f"{LINES[self.line][0]}, NAD {self.mesh}"

    @property
    def names(self) -> list[str]:
        """Names of the passages, softest contact first."""
        return [standard(self.mesh, reading) for reading in series(self.line)]

    def under(self, *more: str) -> Condition:
        """Return the condition of a number, with what else is special to it."""
        return Condition(", ".join((str(self), *more)), self.line != UNCALIBRATED.line)


def computed(passages: Passages) -> list[Series]:
    """Return the lines and meshes with all contact stiffnesses."""
    every = (Series(line, mesh) for line in LINES for mesh in MESHES)
    return [own for own in every if passages.has(*own.names)]


def deviations(passages: Passages, own: Series, cutoff: float) -> Array:
    """Return the standard deviations over the contact stiffness [N]."""
    return passages.deviations(own.names, cutoff)


def change(passages: Passages, own: Series, cutoff: float) -> float:
    """Return the change of the standard deviation from the lowest to the highest stiffness [%]."""
    values = deviations(passages, own, cutoff)
    return 100.0 * float(values[-1] / values[0] - 1.0)


def share_that_falls(passages: Passages, own: Series, low: float, high: float) -> float:
    """Return the share of spectral peaks in a band that fall from 50 to 500 kN/m [%].

    Peaks are multiples of the span-passing frequency that are higher than both neighbours at
    50 kN/m; those below a twentieth of the highest line of the band are not counted.

    Parameters
    ----------
    passages
    own
    low, high
        Band [Hz].
    """
    soft, stiff = (force_comb(passages, name, 200.0) for name in own.names[:: len(own.names) - 1])
    band = (soft.abscissa > low) & (soft.abscissa <= high)
    first, last = soft.value[band], stiff.value[band]
    is_peak = np.zeros(first.size, dtype=bool)
    is_peak[1:-1] = (first[1:-1] > first[:-2]) & (first[1:-1] > first[2:])
    largest = np.maximum(first, last)
    counted = is_peak & (largest >= 0.05 * largest.max())
    return 100.0 * float(np.mean(last[counted] < first[counted]))


def claims(passages: Passages) -> list[Claim]:
    """Judge section III.B.

    Parameters
    ----------
    passages
    """
    every = computed(passages)
    return [
        *(_changes(passages, every, cutoff) for cutoff in CUTOFFS),
        _trends(passages, every),
        _waveform(passages, every),
        _falling(passages, every, BANDS[0], "stiffness-fig-8a"),
        _falling(passages, every, BANDS[1], "stiffness-fig-8b"),
        _conclusion(passages, every),
    ]


def _changes(passages: Passages, every: Sequence[Series], cutoff: int) -> Claim:
    wanted = published.STIFFNESS_CHANGES[cutoff]
    found = tuple(
        Evidence(own.under(), f"change of σ(0–{cutoff})", change(passages, own, cutoff), "%",
                 wanted - CHANGE_WITHIN, wanted + CHANGE_WITHIN, wanted)
        for own in every
    )  # fmt: skip
    text = (
        f"From 50 to 500 kN/m σ(0-{cutoff} Hz) changes by {wanted:+.2f} % "
        f"(limit: {CHANGE_WITHIN:g} percentage points)."
    )
    return Claim(f"stiffness-{cutoff}", "III.B", text, found)


def _trends(passages: Passages, every: Sequence[Series]) -> Claim:
    found: list[Evidence] = []
    for own in every:
        for cutoff in CUTOFFS:
            steps = np.diff(deviations(passages, own, cutoff))
            right = steps > 0.0 if cutoff == 200 else steps < 0.0
            word = "rises" if cutoff == 200 else "falls"
            text = f"steps of stiffness over which σ(0–{cutoff}) {word}"
            found.append(least(own.under(), text, int(right.sum()), len(steps), "of 5"))
    text = (
        "σ(0-20) and σ(0-50) decrease continuously with the contact stiffness; σ(0-200) shows the "
        "contrary trend."
    )
    return Claim("stiffness-trends", "III.B, VI.2", text, tuple(found))


def _waveform(passages: Passages, every: Sequence[Series]) -> Claim:
    found: list[Evidence] = []
    for own in every:
        for soft, name in zip(STIFFNESSES[:3], own.names, strict=False):
            histories = [passages.low_passed(one, 200.0)[passages.inside(one)]
                         for one in (name, own.names[-1])]  # fmt: skip
            size = min(history.size for history in histories)
            alike = float(np.corrcoef(histories[0][:size], histories[1][:size])[0, 1])
            where = own.under(f"{soft} beside {STIFFNESSES[-1]} kN/m")
            found.append(least(where, "correlation of the histories, 0–200 Hz", alike, ALIKE, "1"))
    text = "The contact stiffness does not change the waveform but the amplitude (Fig. 7)."
    return Claim("stiffness-waveform", "III.B", text, tuple(found))


def _falling(
    passages: Passages, every: Sequence[Series], band: tuple[float, float], name: str
) -> Claim:
    low, high = band
    found = tuple(
        least(own.under(), f"share of peaks that fall, {low:g}–{high:g} Hz",
              share_that_falls(passages, own, low, high), MOST)
        for own in every
    )  # fmt: skip
    text = f"In {low:g}-{high:g} Hz most peaks decrease with the increase of contact stiffness."
    remark = (
        "For 50-200 Hz this sentence contradicts the paper's own conclusion 2; see the next claim."
        if low
        else ""
    )
    return Claim(name, "III.B", text, found, remark)


def _conclusion(passages: Passages, every: Sequence[Series]) -> Claim:
    low, high = BANDS[1]
    found: list[Evidence] = []
    for own in every:
        falling = share_that_falls(passages, own, low, high)
        found.append(most(own.under(), f"share of peaks that fall, {low:g}–{high:g} Hz",
                          falling, MOST))  # fmt: skip
        wide, narrow = (deviations(passages, own, cutoff) for cutoff in (200, 50))
        bands = np.sqrt(wide**2 - narrow**2)
        found.append(least(own.under(), "σ(50–200) of 500 over that of 50 kN/m",
                           float(bands[-1] / bands[0]), 1.0, "1"))  # fmt: skip
    text = "Conclusion 2: contact stiffness increases the fluctuation in the high-frequency range."
    return Claim("stiffness-conclusion", "VI.2", text, tuple(found))
