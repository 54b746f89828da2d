"""Section III.A, Figs 4-6: what the element length does to the contact force."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.wavelengths import line_lengths
from tautwire.reproductions.song2021 import published
from tautwire.reproductions.song2021.claims import Claim, Evidence, least, most
from tautwire.reproductions.song2021.forces import Comb, Passages, comb
from tautwire.reproductions.song2021.passages import MESHES, READINGS, TOP_SPEED, standard

Array = NDArray[np.float64]

CUTOFFS = (20, 50, 100, 150, 200)
HIGHEST = 350.0
SPEED = TOP_SPEED / 3.6

VISIBLE = 2.0
"""Least ratio of a spectral line to the median of the lines around it."""

ABOVE = 1.5
"""Least ratio of a spectral line to the same place on the other mesh."""

SAME = 1.0
"""Differences of standard deviations up to this count as none [%]."""

SIMILAR = 5.0
"""Differences up to this count as not big [%]."""


def computed(passages: Passages) -> list[int]:
    """Return the contact stiffnesses at which all four meshes were computed [kN/m]."""
    return [k for k in READINGS if passages.has(*(standard(mesh, k) for mesh in MESHES))]


def condition(stiffness: int) -> str:
    """Name a contact stiffness."""
    return f"{stiffness} kN/m"


def deviations(passages: Passages, stiffness: int) -> dict[int, Array]:
    """Return the standard deviations of the four meshes by cut-off [Hz] [N]."""
    names = [standard(mesh, stiffness) for mesh in MESHES]
    return {cutoff: passages.deviations(names, cutoff) for cutoff in CUTOFFS}


def force_comb(passages: Passages, name: str, highest: float = HIGHEST) -> Comb:
    """Return the amplitudes at the multiples of the span-passing frequency."""
    speed = passages.run(name).case.scenario.speed
    return comb(passages.spectrum(name), speed / passages.span, highest)


def claims(passages: Passages) -> list[Claim]:
    """Judge section III.A.

    Parameters
    ----------
    passages
    """
    every = computed(passages)
    by_cutoff = {k: deviations(passages, k) for k in every}
    return [
        _no_effect(passages, every, by_cutoff),
        _little_effect(every, by_cutoff),
        _higher(every, by_cutoff),
        _converged(every, by_cutoff),
        _same_spectra(passages, every),
        _frequencies(passages, every),
        *_element_lines(passages, every),
        _half_element(passages, every),
        _suitable(passages, every),
    ]


def _no_effect(
    passages: Passages, every: Sequence[int], by_cutoff: dict[int, dict[int, Array]]
) -> Claim:
    found: list[Evidence] = []
    for k in every:
        found.append(most(condition(k), "spread of σ(0–20)", spread(by_cutoff[k][20]), SAME))
        coarse, fine = (
            passages.low_passed(name, 20.0)[passages.inside(name)]
            for name in (standard(MESHES[0], k), standard(MESHES[-1], k))
        )
        difference = 100.0 * float(np.std(_paired(coarse, fine)) / np.std(fine))
        text = "rms difference of the histories NAD 9 and 18 over σ"
        found.append(most(condition(k), text, difference, SIMILAR))
    text = "Low-passed at 20 Hz the force shows no significant difference between the meshes."
    return Claim("mesh-20", "III.A", text, tuple(found))


def _paired(first: Array, second: Array) -> Array:
    size = min(first.size, second.size)
    return first[:size] - second[:size]


def _little_effect(every: Sequence[int], by_cutoff: dict[int, dict[int, Array]]) -> Claim:
    found = [most(condition(k), "spread of σ(0–100)", spread(by_cutoff[k][100]), SIMILAR)
             for k in every]  # fmt: skip
    text = "With a cut-off of 100 Hz the standard deviations of the meshes differ little."
    return Claim("mesh-100", "III.A", text, tuple(found))


def _higher(every: Sequence[int], by_cutoff: dict[int, dict[int, Array]]) -> Claim:
    found = [
        least(
            condition(k),
            "σ(0–200) of NAD 9 over that of NAD 18",
            100.0 * float(by_cutoff[k][200][0] / by_cutoff[k][200][-1] - 1.0),
            SAME,
        )
        for k in every
    ]
    text = "With higher cut-offs long elements give a higher standard deviation than short ones."
    return Claim("mesh-200", "III.A", text, tuple(found))


def _converged(every: Sequence[int], by_cutoff: dict[int, dict[int, Array]]) -> Claim:
    found = [
        most(
            condition(k),
            f"difference of σ(0–{cutoff}) between NAD 15 and 18",
            100.0 * abs(float(by_cutoff[k][cutoff][2] / by_cutoff[k][cutoff][3] - 1.0)),
            SAME,
        )
        for k in every
        for cutoff in CUTOFFS
    ]
    text = "For all cut-offs the results of NAD 15 are similar to those of NAD 18."
    return Claim("mesh-converged", "III.A", text, tuple(found))


def _same_spectra(passages: Passages, every: Sequence[int]) -> Claim:
    found: list[Evidence] = []
    for k in every:
        coarse, fine = (force_comb(passages, standard(m, k), 100.0).value for m in (9, 18))
        difference = 100.0 * float(np.linalg.norm(coarse - fine) / np.linalg.norm(fine))
        found.append(most(condition(k), "difference of the spectra of NAD 9 and 18 over the "
                          "spectrum, 0–100 Hz", difference, SIMILAR))  # fmt: skip
    text = "For 0-100 Hz the spectra of the meshes are almost the same."
    return Claim("mesh-spectra", "III.A", text, tuple(found))


def _frequencies(passages: Passages, every: Sequence[int]) -> Claim:
    found: list[Evidence] = []
    for mesh in MESHES if every else ():
        lengths = line_lengths(passages.run(standard(mesh, every[0])).case).elements
        for length, wanted in zip(lengths, published.ELEMENT_PASSING[mesh], strict=True):
            found.append(
                Evidence("", f"v/Le of NAD {mesh}", SPEED / length, "Hz", wanted - 0.06,
                         wanted + 0.06, wanted)
            )  # fmt: skip
    text = "Element passing v/Le of the four meshes (eight frequencies, limit ±0.06 Hz)."
    return Claim("element-frequencies", "III.A", text, tuple(found))


def line_strength(
    passages: Passages, mesh: int, stiffness: int, frequency: float
) -> tuple[float, float]:
    """Return the ratio of a line to its surroundings, and to the same place on another mesh.

    The other mesh is the finest, NAD 18; for NAD 18 itself it is NAD 15.

    Parameters
    ----------
    passages
    mesh
        NAD on which the line is expected.
    stiffness
        Contact stiffness [kN/m].
    frequency
        [Hz]
    """
    own = force_comb(passages, standard(mesh, stiffness))
    finer = force_comb(passages, standard(18 if mesh != 18 else 15, stiffness))
    return own.ratio(frequency), own.level(frequency) / finer.level(frequency)


def _element_lines(passages: Passages, every: Sequence[int]) -> list[Claim]:
    return [
        Claim(
            f"element-line-{frequency:g}",
            "III.A",
            f"Element passing of NAD {mesh} at {frequency} Hz shows as a peak of the spectrum and "
            f"not on {'the finer mesh' if mesh != 18 else 'another mesh'}.",
            _line_evidence(passages, mesh, every, frequency),
            ""
            if frequency < 300.0
            else "The paper calculates this one and does not claim to see "
            "it: its Fig. 6 ends at 300 Hz.",
        )
        for mesh, pair in published.ELEMENT_PASSING.items()
        for frequency in pair
    ]


def _line_evidence(
    passages: Passages, mesh: int, every: Sequence[int], frequency: float
) -> tuple[Evidence, ...]:
    found: list[Evidence] = []
    for k in every:
        around, finer = line_strength(passages, mesh, k, frequency)
        found.append(least(condition(k), "amplitude over its surroundings", around, VISIBLE, "1"))
        found.append(least(condition(k), "amplitude over that of the other mesh", finer, ABOVE,
                           "1"))  # fmt: skip
    return tuple(found)


def _half_element(passages: Passages, every: Sequence[int]) -> Claim:
    exact = 2.0 * published.ELEMENT_PASSING[9][0]
    text = (
        "NAD 9 shows a significant peak at around 250 Hz, half the element length (n = 2; exactly "
        f"{exact:.2f} Hz)."
    )
    return Claim("element-line-half", "III.A", text, _line_evidence(passages, 9, every, exact))


def _suitable(passages: Passages, every: Sequence[int]) -> Claim:
    found: list[Evidence] = []
    for mesh in (15, 18) if every else ():
        lengths = line_lengths(passages.run(standard(mesh, every[0])).case).elements
        found.append(least("", f"lowest v/Le of NAD {mesh}", SPEED / max(lengths), 200.0, "Hz"))
    text = "NAD 15 and 18 keep element passing out of 0-200 Hz at 320 km/h."
    return Claim("mesh-choice", "III.A, VI.1", text, tuple(found))


def spread(values: Array) -> float:
    """Return largest minus smallest over the last value [%]."""
    return 100.0 * float((values.max() - values.min()) / values[-1])
