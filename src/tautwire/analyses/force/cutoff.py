"""Up to which frequency the geometry of the line acts (Song et al. 2021, section IV.C)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import ClassVar

from tautwire.analyses.force.section import analysed_section
from tautwire.analyses.force.statistics import uniform_force
from tautwire.analyses.vibration.wavelengths import line_lengths
from tautwire.plain import Plain, named
from tautwire.results.run import Run
from tautwire.signals.bands import WIDEST, band_name, band_standard_deviations
from tautwire.signals.filters import STANDARD_CUTOFF, Lowpass, SharpLowpass
from tautwire.specs.case import Case

_TENTHS = 10.0
"""The paper gives the wave number to cover as 0.9 1/m, in tenths."""


@dataclass(frozen=True)
class Cutoff:
    """The cut-off that covers a quarter of the shortest dropper or support interval.

    Attributes
    ----------
    shortest : float m
        Shortest distance between neighbouring droppers, or a support and its dropper.
    wavenumber : float 1/m
        That of a quarter of it, ``4/shortest``, rounded up to a tenth as in the paper
        (0.889 becomes 0.9).
    speed : float m/s
    """

    shortest: float
    wavenumber: float
    speed: float

    @property
    def frequency(self) -> float:
        """Advised cut-off [Hz]."""
        return self.wavenumber * self.speed


@dataclass(frozen=True)
class MissedDeviation(Plain):
    """Standard deviation of the contact force by cut-off.

    Attributes
    ----------
    filter : str
        The filter with every number but its cut-off.
    cutoff : float Hz
        Advised cut-off.
    standard, advised, widest : float N
        Standard deviation from 0 to 20 Hz, to the advised cut-off, and to 200 Hz; NaN where the
        record does not reach so far.
    """

    filter: str
    cutoff: float = field(metadata=named("advised_cutoff_hz"))
    standard: float = field(metadata=named("std_0_20_n"))
    advised: float = field(metadata=named("std_advised_n"))
    widest: float = field(metadata=named("std_0_200_n"))

    derived: ClassVar[tuple[str, ...]] = ("missed", "missed_by_20_hz")

    @property
    def missed(self) -> float:
        """Share of sigma(0-200) that the advised cut-off misses."""
        return 1.0 - self.advised / self.widest

    @property
    def missed_by_20_hz(self) -> float:
        """Share of sigma(0-200) that 20 Hz miss."""
        return 1.0 - self.standard / self.widest


def advise_cutoff(case: Case) -> Cutoff:
    """Return the cut-off that covers a quarter of all dropper and support intervals.

    Parameters
    ----------
    case

    Examples
    --------
    >>> from tautwire.inputs.load import load_case
    >>> round(advise_cutoff(load_case("ac-simple")).frequency, 6)
    80.0
    """
    shortest = line_lengths(case).shortest
    wavenumber = math.ceil(4.0 / shortest * _TENTHS - 1e-9) / _TENTHS
    return Cutoff(shortest, wavenumber, case.scenario.speed)


def missed_deviation(
    run: Run,
    name: str | None = None,
    lowpass: Lowpass | None = None,
    section: tuple[int, int] | None = None,
) -> MissedDeviation:
    """Compare the standard deviation up to the advised cut-off with that up to 20 and 200 Hz.

    Parameters
    ----------
    run
    name
        Name of the pantograph; the leading one by default.
    lowpass
        Family of the filter; sharp by default.
    section : (first, last) span, optional
        1-based, both included; by default that of the case.

    Returns
    -------
    MissedDeviation
    """
    record = uniform_force(run, name or run.pantographs[0].name)
    inside = analysed_section(run, section).contains(record.position)
    given: Lowpass = SharpLowpass() if lowpass is None else lowpass
    cutoff = advise_cutoff(run.case).frequency
    bands = [(0.0, STANDARD_CUTOFF), (0.0, cutoff), (0.0, WIDEST)]
    found = band_standard_deviations(given, record.force, record.time_step, inside, bands)
    values = [found[band_name(band)] for band in bands]
    return MissedDeviation(given.with_cutoff(cutoff).describe(), cutoff, *values)
