"""Section IV.A, Figs 10 and 11: pre-sag and contact force over wavelength."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.vibration.wavelengths import line_lengths, presag_spectrum
from tautwire.reproductions.song2021 import published
from tautwire.reproductions.song2021.claims import (
    Claim,
    Condition,
    Evidence,
    least,
    most,
    under,
)
from tautwire.reproductions.song2021.passages import Reading, Scope, standard
from tautwire.reproductions.song2021.sections.forces import Comb, Passages, comb
from tautwire.signals.spectra import over_wavenumber

Array = NDArray[np.float64]

SPEEDS = (225, 275, 320)
"""Speeds of Fig. 11 [km/h]."""

HIGHEST = 1.2
"""Largest wave number of Fig. 11 [1/m]."""

SHORT = 0.1
"""Wave number from which components count as of high frequency [1/m]; 10 m."""

REGION = 0.06
"""Half width of a region relative to its wave number."""

MAJORITY = 50.0
"""At least this share is what 'highly consistent' and 'main source' mean [%]."""

BY_CHANCE = 5.0
"""Share of the shifts by which combs without a relation may agree as well [%]."""

NEGLIGIBLE = 10.0
"""Largest share of energy outside the regions that may be neglected [%]."""

HALVES = 0.27
"""Wave number between the regions of DD and SD and those of their halves [1/m]; 3.7 m."""

PRESAG = "pre-sag"
FRACTIONS = ("DD/2", "SD/2", "DD/4", "SD/4")


@dataclass(frozen=True, eq=False)
class Sources:
    """Combs over wave number.

    Attributes
    ----------
    combs : mapping of str to Comb
        ``"pre-sag"`` [m], then one per speed [N].
    lengths : mapping of str to float
        DD, SD and their fractions of this line [m].
    """

    combs: Mapping[str, Comb]
    lengths: Mapping[str, float]


def gather(passages: Passages, scope: Scope, reading: Reading) -> Sources | None:
    """Return the spectra of Fig. 11; None when a passage is missing.

    Parameters
    ----------
    passages
    scope
    reading
    """
    names = {f"{v} km/h": standard(scope.mesh, reading, v) for v in SPEEDS}
    if not passages.has(*names.values()):
        return None
    run = passages.run(names["320 km/h"])
    spacing = 1.0 / passages.span
    presag = presag_spectrum(run.equilibrium, run.case.resolved_section())
    combs = {PRESAG: comb(presag, spacing, HIGHEST)}
    for label, name in names.items():
        own = passages.run(name)
        spectrum = over_wavenumber(
            passages.spectrum(name), own.case.scenario.speed, is_density=False
        )
        combs[label] = comb(spectrum, spacing, HIGHEST)
    named = line_lengths(run.case).named(elements=False)
    return Sources(combs, {name: named[name] for name in published.REGIONS if name in named})


def is_local_maximum(found: Comb, place: float, reach: int = 1) -> bool:
    """Tell whether a line within `reach` of a place is higher than both its neighbours."""
    at, value = found.nearest(place), found.value
    return any(
        value[i] > value[i - 1] and value[i] > value[i + 1]
        for i in range(max(1, at - reach), min(value.size - 1, at + reach + 1))
    )


def share_near_maximum(found: Comb) -> float:
    """Return how many places, waves of 1 to 10 m, lie within one line of a local maximum [%]."""
    places = found.abscissa[(found.abscissa >= SHORT) & (found.abscissa <= 1.0)]
    return 100.0 * float(np.mean([is_local_maximum(found, float(place)) for place in places]))


def in_regions(found: Comb, lengths: Mapping[str, float]) -> NDArray[np.bool_]:
    """Mark the lines that belong to the regions of some lengths [m]."""
    inside = np.zeros(found.value.size, dtype=np.bool_)
    for length in lengths.values():
        inside |= np.abs(found.abscissa * length - 1.0) <= REGION
        inside[found.nearest(1.0 / length)] = True
    return inside


def outside_share(found: Comb, lengths: Mapping[str, float]) -> tuple[float, float]:
    """Return the share of energy, and of wave numbers, outside all regions [%].

    Only waves shorter than 10 m count.

    Parameters
    ----------
    found
    lengths
        [m]
    """
    short = found.abscissa >= SHORT
    inside = in_regions(found, lengths)
    energy = found.value**2
    outside = short & ~inside
    return (
        100.0 * float(energy[outside].sum() / energy[short].sum()),
        100.0 * float(outside.sum() / short.sum()),
    )


def peaks(found: Comb) -> NDArray[np.bool_]:
    """Mark the lines of waves of 1 to 10 m that are higher than both neighbours."""
    value = found.value
    marked = np.zeros(value.size, dtype=np.bool_)
    marked[1:-1] = (value[1:-1] > value[:-2]) & (value[1:-1] > value[2:])
    return marked & (found.abscissa >= SHORT) & (found.abscissa <= 1.0)


@dataclass(frozen=True)
class Agreement:
    """How the peaks of the force agree with those of the pre-sag, waves of 1 to 10 m.

    Attributes
    ----------
    share : float %
        Of the peaks of the pre-sag that are peaks of the force, on the same line of the comb.
    chance : float %
        Mean of the same when one comb is shifted along the other.
    as_good : float %
        Share of all shifts, none included, that agree at least as well.
    correlation : float
        Rank correlation of all lines.
    """

    share: float
    chance: float
    as_good: float
    correlation: float


def agreement(presag: Comb, force: Comb) -> Agreement:
    """Compare the peaks of the force with those of the pre-sag, waves of 1 to 10 m.

    Chance is what remains when one row of peaks is shifted along the other by any number of lines
    (round the end): peaks stay as many and as far apart as they are, and only their places lose
    their meaning.

    Parameters
    ----------
    presag, force
    """
    short = (presag.abscissa >= SHORT) & (presag.abscissa <= 1.0)
    wanted, present = peaks(presag)[short], peaks(force)[short]
    shares = np.array([100.0 * present[np.roll(wanted, n)].mean() for n in range(wanted.size)])
    first, second = (np.argsort(np.argsort(c.value[short])) for c in (presag, force))
    return Agreement(
        share=float(shares[0]),
        chance=float(shares[1:].mean()),
        as_good=100.0 * float(np.mean(shares >= shares[0] - 1e-9)),
        correlation=float(np.corrcoef(first, second)[0, 1]),
    )


def claims(by_reading: Mapping[Reading, Sources]) -> list[Claim]:
    """Judge section IV.A.

    Parameters
    ----------
    by_reading
        Spectra by reading.
    """
    return [
        _regions(by_reading),
        _agree(by_reading),
        *(_maximum(by_reading, name) for name in FRACTIONS),
        _negligible(by_reading),
        _main_source(by_reading),
    ]


def _regions(by_reading: Mapping[Reading, Sources]) -> Claim:
    found: list[Evidence] = []
    for sources in list(by_reading.values())[:1]:
        for name, wanted in published.REGIONS.items():
            length = sources.lengths[name]
            found.append(
                Evidence(Condition(name), f"{name} of the line", length, "m", wanted - 0.01,
                         wanted + 0.01, wanted)
            )  # fmt: skip
    return Claim(
        "wavelength-regions",
        "IV.A",
        "Six regions of the spectra belong to DD, SD, and their halves and quarters: 5.75, 4.25, "
        "2.88, 2.12, 1.44 and 1.13 m.",
        tuple(found),
        "SD of this line is 4.5 m. 4.25 m and 2.12 m are 55 m/13 = 4.23 m and 55 m/26 = 2.12 m: "
        "lines of the comb of a line that repeats every 55 m, next to SD (n = 12.2) and SD/2 "
        "(n = 24.4).",
    )


def _agree(by_reading: Mapping[Reading, Sources]) -> Claim:
    found: list[Evidence] = []
    for k, sources in by_reading.items():
        for label, own in sources.combs.items():
            if label == PRESAG:
                continue
            result = agreement(sources.combs[PRESAG], own)
            where = under(k, label)
            found += [
                least(where, "peaks of the pre-sag that are peaks of the force", result.share,
                      MAJORITY),
                most(where, "shifts of one comb along the other that agree as well",
                     result.as_good, BY_CHANCE),
                Evidence(where, "peaks in common by chance", result.chance, "%"),
                Evidence(where, "rank correlation of all lines", result.correlation, "1"),
            ]  # fmt: skip
    text = "The peaks in the spectrum of the force are highly consistent with those of the pre-sag."
    numbers = {int(peaks(own.combs[PRESAG]).sum()) for own in by_reading.values()}
    remark = (
        f"The pre-sag has {' or '.join(str(n) for n in sorted(numbers))} peaks between 1 and 10 m, "
        "so one of them more or less decides."
    )
    return Claim("presag-force", "IV.A", text, tuple(found), remark if numbers else "")


def _every_comb(
    by_reading: Mapping[Reading, Sources],
) -> Iterator[tuple[Condition, Mapping[str, float], Comb]]:
    """Yield every spectrum with its condition and the lengths of its line; the pre-sag once."""
    for number, (k, sources) in enumerate(by_reading.items()):
        for label, own in sources.combs.items():
            if label != PRESAG:
                yield under(k, label), sources.lengths, own
            elif number == 0:
                yield Condition(PRESAG), sources.lengths, own


def _maximum(by_reading: Mapping[Reading, Sources], name: str) -> Claim:
    found: list[Evidence] = []
    for where, lengths, own in _every_comb(by_reading):
        place = 1.0 / lengths[name]
        peak = float(is_local_maximum(own, place))
        test = own.test(place, width=0.0)
        found += [
            least(where, "local maximum within one line (1: yes)", peak, 1.0, "1"),
            least(where, "power over the mean of the lines around", test.ratio, test.limit, "1"),
            Evidence(where, "lines that are within one line of a local maximum",
                     share_near_maximum(own), "%"),
        ]  # fmt: skip
    text = f"{name} stands out in the spectra of pre-sag and contact force."
    return Claim(f"source-{name.replace('/', '-')}", "IV.A", text, tuple(found))


def _negligible(by_reading: Mapping[Reading, Sources]) -> Claim:
    found: list[Evidence] = []
    for where, lengths, own in _every_comb(by_reading):
        energy, width = outside_share(own, lengths)
        text = "energy outside the six regions, waves below 10 m"
        found.append(Evidence(where, text, energy, "%", high=NEGLIGIBLE))
        text = "share of the wave numbers outside them"
        found.append(Evidence(where, text, width, "%"))
    return Claim(
        "energy-elsewhere",
        "IV.A",
        "Out of the regions the spectrum energy is small and can be neglected (limit here: "
        f"{NEGLIGIBLE:g} %; a region reaches {100 * REGION:g} % to either side of it).",
        tuple(found),
        "The paper does not state the width of its regions.",
    )


def _main_source(by_reading: Mapping[Reading, Sources]) -> Claim:
    found: list[Evidence] = []
    for where, lengths, own in _every_comb(by_reading):
        if where == Condition(PRESAG):
            continue
        high = own.abscissa > HALVES
        inside = in_regions(own, {name: lengths[name] for name in FRACTIONS})[high]
        energy = own.value[high] ** 2
        share = 100.0 * float(energy[inside].sum() / energy.sum())
        text = "share of the four regions in the energy of waves below 3.7 m"
        found.append(least(where, text, share, MAJORITY))
        text = "the same if the energy were spread evenly"
        found.append(Evidence(where, text, 100.0 * float(inside.mean()), "%"))
    text = "Half and quarter of DD and SD are the main source of the high-frequency components."
    return Claim("main-source", "IV.A, VI.3", text, tuple(found))
