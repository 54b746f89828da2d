"""Section III.B, Figs 7-9: what the contact stiffness does to the contact force."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tautwire.reproductions.song2021 import published
from tautwire.reproductions.song2021.claims import Claim, Evidence, least, most
from tautwire.reproductions.song2021.passages import MESHES, STIFFNESSES, standard
from tautwire.reproductions.song2021.sections.forces import Passages
from tautwire.reproductions.song2021.sections.mesh import force_comb

Array = NDArray[np.float64]

CUTOFFS = (20, 50, 200)
CHANGE_WITHIN = 3.0
"""Limit for a change of the standard deviation: percentage points."""

MOST = 50.0
"""More than this share counts as most [%]."""

ALIKE = 0.8
"""Least correlation of two histories of the same waveform."""

BANDS = ((0.0, 50.0), (50.0, 200.0))


def computed(passages: Passages) -> list[int]:
    """Return the meshes on which all stiffnesses were computed."""
    return [m for m in MESHES if passages.has(*(standard(m, k) for k in STIFFNESSES))]


def condition(mesh: int) -> str:
    """Name a mesh."""
    return f"NAD {mesh}"


def deviations(passages: Passages, mesh: int, cutoff: float) -> Array:
    """Return the standard deviations over the contact stiffness [N]."""
    return passages.deviations([standard(mesh, k) for k in STIFFNESSES], cutoff)


def change(passages: Passages, mesh: int, cutoff: float) -> float:
    """Return the change of the standard deviation from the lowest to the highest stiffness [%]."""
    values = deviations(passages, mesh, cutoff)
    return 100.0 * float(values[-1] / values[0] - 1.0)


def share_that_falls(passages: Passages, mesh: int, low: float, high: float) -> float:
    """Return the share of spectral peaks in a band that fall from 50 to 500 kN/m [%].

    Peaks are multiples of the span-passing frequency that are higher than both neighbours at
    50 kN/m; those below a twentieth of the highest line of the band are not counted.

    Parameters
    ----------
    passages
    mesh
    low, high
        Band [Hz].
    """
    soft, stiff = (force_comb(passages, standard(mesh, k), 200.0) for k in STIFFNESSES[::5])
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
    meshes = computed(passages)
    return [
        *(_changes(passages, meshes, cutoff) for cutoff in CUTOFFS),
        _trends(passages, meshes),
        _waveform(passages, meshes),
        _falling(passages, meshes, BANDS[0], "stiffness-fig-8a"),
        _falling(passages, meshes, BANDS[1], "stiffness-fig-8b"),
        _conclusion(passages, meshes),
    ]


def _changes(passages: Passages, meshes: Sequence[int], cutoff: int) -> Claim:
    wanted = published.STIFFNESS_CHANGES[cutoff]
    found = tuple(
        Evidence(condition(m), f"change of σ(0–{cutoff})", change(passages, m, cutoff), "%",
                 wanted - CHANGE_WITHIN, wanted + CHANGE_WITHIN, wanted)
        for m in meshes
    )  # fmt: skip
    text = (
        f"From 50 to 500 kN/m σ(0-{cutoff} Hz) changes by {wanted:+.2f} % "
        f"(limit: {CHANGE_WITHIN:g} percentage points)."
    )
    return Claim(f"stiffness-{cutoff}", "III.B", text, found)


def _trends(passages: Passages, meshes: Sequence[int]) -> Claim:
    found: list[Evidence] = []
    for mesh in meshes:
        for cutoff in CUTOFFS:
            steps = np.diff(deviations(passages, mesh, cutoff))
            right = steps > 0.0 if cutoff == 200 else steps < 0.0
            word = "rises" if cutoff == 200 else "falls"
            text = f"steps of stiffness over which σ(0–{cutoff}) {word}"
            found.append(least(condition(mesh), text, int(right.sum()), len(steps), "of 5"))
    text = (
        "σ(0-20) and σ(0-50) decrease continuously with the contact stiffness; σ(0-200) shows the "
        "contrary trend."
    )
    return Claim("stiffness-trends", "III.B, VI.2", text, tuple(found))


def _waveform(passages: Passages, meshes: Sequence[int]) -> Claim:
    found: list[Evidence] = []
    for mesh in meshes:
        for soft in (50, 100, 200):
            histories = [
                passages.low_passed(standard(mesh, k), 200.0)[passages.inside(standard(mesh, k))]
                for k in (soft, STIFFNESSES[-1])
            ]
            size = min(history.size for history in histories)
            alike = float(np.corrcoef(histories[0][:size], histories[1][:size])[0, 1])
            where = f"{condition(mesh)}, {soft} beside {STIFFNESSES[-1]} kN/m"
            found.append(least(where, "correlation of the histories, 0–200 Hz", alike, ALIKE, "1"))
    text = "The contact stiffness does not change the waveform but the amplitude (Fig. 7)."
    return Claim("stiffness-waveform", "III.B", text, tuple(found))


def _falling(
    passages: Passages, meshes: Sequence[int], band: tuple[float, float], name: str
) -> Claim:
    low, high = band
    found = tuple(
        least(condition(m), f"share of peaks that fall, {low:g}–{high:g} Hz",
              share_that_falls(passages, m, low, high), MOST)
        for m in meshes
    )  # fmt: skip
    text = f"In {low:g}-{high:g} Hz most peaks decrease with the increase of contact stiffness."
    remark = (
        "For 50-200 Hz this sentence contradicts the paper's own conclusion 2; see the next claim."
        if low
        else ""
    )
    return Claim(name, "III.B", text, found, remark)


def _conclusion(passages: Passages, meshes: Sequence[int]) -> Claim:
    low, high = BANDS[1]
    found: list[Evidence] = []
    for mesh in meshes:
        falling = share_that_falls(passages, mesh, low, high)
        found.append(most(condition(mesh), f"share of peaks that fall, {low:g}–{high:g} Hz",
                          falling, MOST))  # fmt: skip
        wide, narrow = (deviations(passages, mesh, cutoff) for cutoff in (200, 50))
        bands = np.sqrt(wide**2 - narrow**2)
        found.append(least(condition(mesh), "σ(50–200) of 500 over that of 50 kN/m",
                           float(bands[-1] / bands[0]), 1.0, "1"))  # fmt: skip
    text = "Conclusion 2: contact stiffness increases the fluctuation in the high-frequency range."
    return Claim("stiffness-conclusion", "VI.2", text, tuple(found))
