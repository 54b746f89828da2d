"""Finished passages read back: forces, standard deviations by cut-off, spectra."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.force.section import analysed_section
from tautwire.analyses.force.spectrum import force_spectrum
from tautwire.analyses.force.statistics import contact_statistics, uniform_force
from tautwire.results.run import ForceRecord, Run
from tautwire.results.storage import load_run
from tautwire.signals.filters import Butterworth, Lowpass, SharpLowpass
from tautwire.signals.spectra import Spectrum, background_limit

Array = NDArray[np.float64]

FILTERS: Mapping[str, Lowpass] = {"sharp": SharpLowpass(), "Butterworth": Butterworth()}

CHANCE = 0.01
"""Chance at which a line of the background alone counts as standing out."""

SHIFTS = (-1, 1)
"""Other readings of the central spans: the section one span earlier or later."""


@dataclass(eq=False)
class Passages:
    """The finished passages of the reproduction.

    Attributes
    ----------
    paths : mapping of str to Path
        Run files by name of the passage.
    """

    paths: Mapping[str, Path]
    _runs: dict[str, Run] = field(default_factory=dict, repr=False)
    _forces: dict[str, ForceRecord] = field(default_factory=dict, repr=False)
    _spectra: dict[str, Spectrum] = field(default_factory=dict, repr=False)

    def has(self, *names: str) -> bool:
        """Return whether all the passages are there."""
        return all(name in self.paths for name in names)

    def run(self, name: str) -> Run:
        """Return a passage."""
        if name not in self._runs:
            self._runs[name] = load_run(self.paths[name])
        return self._runs[name]

    def force(self, name: str) -> ForceRecord:
        """Return the unfiltered force, evenly spaced in time."""
        if name not in self._forces:
            run = self.run(name)
            self._forces[name] = uniform_force(run, run.pantographs[0].name)
        return self._forces[name]

    def inside(self, name: str, window: tuple[int, int] | None = None) -> NDArray[np.bool_]:
        """Mark the samples of the analysed section."""
        return analysed_section(self.run(name), window).contains(self.force(name).position)

    def low_passed(self, name: str, cutoff: float, kind: str = "sharp") -> Array:
        """Return the whole record low-passed [N]."""
        record = self.force(name)
        return FILTERS[kind].with_cutoff(cutoff).apply(record.force, record.time_step)

    def deviation(self, name: str, cutoff: float, kind: str = "sharp") -> float:
        """Return the standard deviation from 0 to a cut-off in the analysed section [N]."""
        return float(np.std(self.low_passed(name, cutoff, kind)[self.inside(name)]))

    def deviations(self, names: list[str], cutoff: float) -> Array:
        """Return the standard deviation of several passages [N]."""
        return np.array([self.deviation(name, cutoff) for name in names])

    def spectrum(self, name: str) -> Spectrum:
        """Return the amplitude spectrum over frequency in the analysed section."""
        if name not in self._spectra:
            run = self.run(name)
            self._spectra[name] = force_spectrum(run, run.pantographs[0].name)
        return self._spectra[name]

    @functools.cached_property
    def span(self) -> float:
        """Span length [m]."""
        first = next(iter(self.paths))
        return self.run(first).case.line.span_lengths()[0]

    def windows(self, name: str) -> dict[str, tuple[int, int]]:
        """Return other readings of the central spans of a passage by name."""
        case = self.run(name).case
        first, last = case.resolved_section()
        return {
            f"spans {first + shift} to {last + shift}": (first + shift, last + shift)
            for shift in SHIFTS
            if first + shift >= 1 and last + shift <= case.line.spans
        }

    def statistics(
        self, name: str, kind: str = "sharp", window: tuple[int, int] | None = None
    ) -> dict[str, float]:
        """Return the numbers of Table 2 [N]."""
        found = contact_statistics(self.run(name), section=window).pantograph()
        part = found.filtered["sharp" if kind == "sharp" else "butterworth"]
        bands = {f"std_{band}": value for band, value in part.standard_deviations.items()}
        return {"mean": part.mean, "maximum": part.maximum, "minimum": part.minimum, **bands}


@dataclass(frozen=True, eq=False)
class Comb:
    """Amplitudes of a spectrum at the multiples of the span-passing frequency.

    The ideal line repeats every span, so its spectra are combs; between the lines there is nothing
    of interest.

    Attributes
    ----------
    abscissa : (n_line,)
        Frequency [Hz] or wave number [1/m].
    value : (n_line,)
        Largest amplitude within half a spacing.
    """

    abscissa: Array
    value: Array

    @property
    def spacing(self) -> float:
        """Distance between two lines."""
        return float(self.abscissa[1] - self.abscissa[0])

    def nearest(self, place: float) -> int:
        """Return the number (0-based) of the line nearest to a place."""
        return int(np.argmin(np.abs(self.abscissa - place)))

    def level(self, place: float, reach: int = 1) -> float:
        """Return the largest line within `reach` lines of a place."""
        at = self.nearest(place)
        return float(self.value[max(0, at - reach) : at + reach + 1].max())

    def test(self, place: float, reach: int = 1, width: float = 0.15) -> LineTest:
        """Test whether a line stands out of its surroundings.

        Parameters
        ----------
        place
        reach
            Lines to either side that belong to the place.
        width
            Relative distance up to which lines are its surroundings; at least six lines.
        """
        at = self.nearest(place)
        distance = np.abs(np.arange(self.value.size) - at)
        around = (distance <= max(6, width * at)) & (distance > reach)
        places = int(np.sum(distance <= reach))
        background = float(np.sqrt(np.mean(self.value[around] ** 2)))
        return LineTest(self.level(place, reach), background, int(around.sum()), places)


@dataclass(frozen=True)
class LineTest:
    """A line of a spectrum beside its surroundings.

    Attributes
    ----------
    level : float
        Largest amplitude at the place.
    background : float
        Root mean square of the amplitudes around it.
    neighbours : int
        Number of lines around it.
    places : int
        Number of lines that belong to the place.
    """

    level: float
    background: float
    neighbours: int
    places: int

    @property
    def ratio(self) -> float:
        """Power of the line over the mean power around it."""
        return (self.level / self.background) ** 2

    @property
    def limit(self) -> float:
        """Ratio that background alone exceeds with the chance :data:`CHANCE`."""
        return background_limit(self.neighbours, CHANCE, self.places)

    @property
    def stands_out(self) -> bool:
        """True when the line exceeds what the background explains."""
        return self.ratio > self.limit


def comb(spectrum: Spectrum, spacing: float, highest: float) -> Comb:
    """Reduce a spectrum to the multiples of a spacing.

    Parameters
    ----------
    spectrum
    spacing
        Span-passing frequency [Hz], or 1/span [1/m].
    highest
        Last multiple that is wanted.
    """
    number = np.rint(spectrum.abscissa / spacing).astype(int)
    count = int(min(highest, float(spectrum.abscissa[-1])) / spacing)
    value = np.zeros(count + 1)
    kept = number <= count
    np.maximum.at(value, number[kept], spectrum.value[kept])
    return Comb(spacing * np.arange(1.0, count + 1.0), value[1:])
