"""Section III.A, Figs 4-6: what the element length does to the contact force."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.vibration.wavelengths import line_lengths
from tautwire.reproductions.song2021 import published
from tautwire.reproductions.song2021.claims import (
    ALWAYS,
    Claim,
    Evidence,
    least,
    most,
    under,
)
from tautwire.reproductions.song2021.passages import (
    MESHES,
    READINGS,
    TOP_SPEED,
    Reading,
    standard,
)
from tautwire.reproductions.song2021.sections.forces import Comb, Passages, comb
from tautwire.signals.spectra import amplitude_spectrum

Array = NDArray[np.float64]

CUTOFFS = (20, 50, 100, 150, 200)
"""Of Fig. 5 [Hz]."""
HIGHEST = 350.0
"""Upper end of the spectra [Hz]: that of Fig. 6 is 300 Hz, the elements of the finest mesh pass at
336."""
SPEED = TOP_SPEED / 3.6

SAME = 1.0
"""Differences of standard deviations up to this count as none [%]."""

SIMILAR = 5.0
"""Differences up to this count as not big [%]."""


def computed(passages: Passages) -> list[Reading]:
    """Return the readings under which all four meshes were computed."""
    return [k for k in READINGS if passages.has(*(standard(mesh, k) for mesh in MESHES))]


def deviations(passages: Passages, reading: Reading) -> dict[int, Array]:
    """Return the standard deviations of the four meshes by cut-off [Hz] [N]."""
    names = [standard(mesh, reading) for mesh in MESHES]
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
    passages: Passages, every: Sequence[Reading], by_cutoff: dict[Reading, dict[int, Array]]
) -> Claim:
    found: list[Evidence] = []
    for k in every:
        found.append(most(under(k), "spread of σ(0–20)", spread(by_cutoff[k][20]), SAME))
        coarse, fine = (
            passages.low_passed(name, 20.0)[passages.inside(name)]
            for name in (standard(MESHES[0], k), standard(MESHES[-1], k))
        )
        difference = 100.0 * float(np.std(_paired(coarse, fine)) / np.std(fine))
        text = "rms difference of the histories NAD 9 and 18 over σ"
        found.append(most(under(k), text, difference, SIMILAR))
    text = "Low-passed at 20 Hz the force shows no significant difference between the meshes."
    return Claim("mesh-20", "III.A", text, tuple(found))


def _paired(first: Array, second: Array) -> Array:
    size = min(first.size, second.size)
    return first[:size] - second[:size]


def _little_effect(every: Sequence[Reading], by_cutoff: dict[Reading, dict[int, Array]]) -> Claim:
    found = [most(under(k), "spread of σ(0–100)", spread(by_cutoff[k][100]), SIMILAR)
             for k in every]  # fmt: skip
    text = "With a cut-off of 100 Hz the standard deviations of the meshes differ little."
    return Claim("mesh-100", "III.A", text, tuple(found))


def _higher(every: Sequence[Reading], by_cutoff: dict[Reading, dict[int, Array]]) -> Claim:
    found = [
        least(
            under(k),
            "σ(0–200) of NAD 9 over that of NAD 18",
            100.0 * float(by_cutoff[k][200][0] / by_cutoff[k][200][-1] - 1.0),
            SAME,
        )
        for k in every
    ]
    text = "With higher cut-offs long elements give a higher standard deviation than short ones."
    return Claim("mesh-200", "III.A", text, tuple(found))


def _converged(every: Sequence[Reading], by_cutoff: dict[Reading, dict[int, Array]]) -> Claim:
    found = [
        most(
            under(k),
            f"difference of σ(0–{cutoff}) between NAD 15 and 18",
            100.0 * abs(float(by_cutoff[k][cutoff][2] / by_cutoff[k][cutoff][3] - 1.0)),
            SAME,
        )
        for k in every
        for cutoff in CUTOFFS
    ]
    text = "For all cut-offs the results of NAD 15 are similar to those of NAD 18."
    return Claim("mesh-converged", "III.A", text, tuple(found))


def _same_spectra(passages: Passages, every: Sequence[Reading]) -> Claim:
    found: list[Evidence] = []
    for k in every:
        coarse, fine = (force_comb(passages, standard(m, k), 100.0).value for m in (9, 18))
        difference = 100.0 * float(np.linalg.norm(coarse - fine) / np.linalg.norm(fine))
        found.append(most(under(k), "difference of the spectra of NAD 9 and 18 over the "
                          "spectrum, 0–100 Hz", difference, SIMILAR))  # fmt: skip
    text = "For 0-100 Hz the spectra of the meshes are almost the same."
    return Claim("mesh-spectra", "III.A", text, tuple(found))


def _frequencies(passages: Passages, every: Sequence[Reading]) -> Claim:
    found: list[Evidence] = []
    for mesh in MESHES if every else ():
        lengths = line_lengths(passages.run(standard(mesh, every[0])).case).elements
        for length, wanted in zip(lengths, published.ELEMENT_PASSING[mesh], strict=True):
            found.append(
                Evidence(ALWAYS, f"v/Le of NAD {mesh}", SPEED / length, "Hz", wanted - 0.06,
                         wanted + 0.06, wanted)
            )  # fmt: skip
    text = "Element passing v/Le of the four meshes (eight frequencies, limit ±0.06 Hz)."
    return Claim("element-frequencies", "III.A", text, tuple(found))


def difference_comb(passages: Passages, mesh: int, reading: Reading) -> Comb:
    """Return the comb of the difference between the histories of a mesh and of its finer one.

    What both meshes agree on cancels, so that lines of the elements stand alone.

    Parameters
    ----------
    passages
    mesh
        NAD.
    reading
    """
    names = [standard(m, reading) for m in (mesh, finer(mesh))]
    own, other = (passages.force(name).force[passages.inside(name)] for name in names)
    spectrum = amplitude_spectrum(_paired(own, other), passages.force(names[0]).time_step)
    return comb(spectrum, SPEED / passages.span, HIGHEST)


def finer(mesh: int) -> int:
    """Return the mesh that a line is looked for on as well: the finest, for NAD 18 NAD 15."""
    return MESHES[-1] if mesh != MESHES[-1] else MESHES[-2]


def false_alarms(passages: Passages, reading: Reading) -> tuple[float, int]:
    """Return the share of places that stand out on the finest mesh though no element is passed [%].

    All lines from 100 Hz to 5 % below its own first element passing are tested: the test is worth
    as much as this share is near the chance it is made for.

    Parameters
    ----------
    passages
    reading

    Returns
    -------
    share : float
    number : int
        Of places.
    """
    own = force_comb(passages, standard(MESHES[-1], reading))
    limit = 0.95 * published.ELEMENT_PASSING[MESHES[-1]][0]
    places = own.abscissa[(own.abscissa >= 100.0) & (own.abscissa <= limit)]
    found = [own.test(float(place), reach=0).stands_out for place in places]
    return 100.0 * float(np.mean(found)), len(found)


def _element_lines(passages: Passages, every: Sequence[Reading]) -> list[Claim]:
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
    passages: Passages, mesh: int, every: Sequence[Reading], frequency: float
) -> tuple[Evidence, ...]:
    found: list[Evidence] = []
    for k in every:
        own = force_comb(passages, standard(mesh, k)).test(frequency)
        other = force_comb(passages, standard(finer(mesh), k)).test(frequency)
        alone = difference_comb(passages, mesh, k).test(frequency)
        where = under(k)
        found += [
            least(where, "power over the mean around it", own.ratio, own.limit, "1"),
            most(where, f"the same on NAD {finer(mesh)}", other.ratio, other.limit, "1"),
            Evidence(where, "amplitude", own.level, "N"),
            Evidence(where, "amplitude of which 99 % of the background stay below",
                     own.background * own.limit**0.5, "N"),
            Evidence(where, f"in the difference from NAD {finer(mesh)}: power over the mean around "
                     f"it (background: {alone.limit:.2f})", alone.ratio, "1"),
        ]  # fmt: skip
    return tuple(found)


def _half_element(passages: Passages, every: Sequence[Reading]) -> Claim:
    exact = 2.0 * published.ELEMENT_PASSING[9][0]
    text = (
        "NAD 9 shows a significant peak at around 250 Hz, half the element length (n = 2; exactly "
        f"{exact:.2f} Hz)."
    )
    found = list(_line_evidence(passages, 9, every, exact))
    for k in every:
        share, number = false_alarms(passages, k)
        words = f"the test itself: share of {number} places of NAD 18 that stand out for no reason"
        found.append(Evidence(under(k), words, share, "%"))
    return Claim("element-line-half", "III.A", text, tuple(found))


def _suitable(passages: Passages, every: Sequence[Reading]) -> Claim:
    found: list[Evidence] = []
    for mesh in (15, 18) if every else ():
        lengths = line_lengths(passages.run(standard(mesh, every[0])).case).elements
        found.append(least(ALWAYS, f"lowest v/Le of NAD {mesh}", SPEED / max(lengths), 200.0, "Hz"))
    text = "NAD 15 and 18 keep element passing out of 0-200 Hz at 320 km/h."
    return Claim("mesh-choice", "III.A, VI.1", text, tuple(found))


def spread(values: Array) -> float:
    """Return largest minus smallest over the last value [%]."""
    return 100.0 * float((values.max() - values.min()) / values[-1])
