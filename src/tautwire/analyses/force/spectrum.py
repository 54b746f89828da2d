"""Filtered force histories and spectra of a run."""

from __future__ import annotations

from tautwire.analyses.force.section import analysed_section
from tautwire.analyses.force.statistics import uniform_force
from tautwire.errors import InputError
from tautwire.results.run import Run
from tautwire.signals.spectra import Spectrum, amplitude_spectrum, power_spectral_density


def force_spectrum(
    run: Run,
    name: str,
    *,
    section: tuple[int, int] | None = None,
    segments: int = 1,
    density: bool = False,
) -> Spectrum:
    """Compute the spectrum of the unfiltered contact force over the analysed section.

    Parameters
    ----------
    run : Run
    name : str
        Name of the pantograph.
    section : (first, last) span, optional
        1-based, both included; by default that of the case.
    segments : int
        With `density`: number of half-overlapping pieces that are averaged.
    density : bool
        False: amplitudes [N]; True: power spectral density [N^2/Hz]. Both with a Hann window.

    Returns
    -------
    Spectrum
        Over frequency; see :func:`tautwire.signals.spectra.over_wavenumber`.

    Raises
    ------
    InputError
        When too few samples lie in the section.
    """
    record = uniform_force(run, name)
    force = record.force[analysed_section(run, section).contains(record.position)]
    try:
        if density:
            return power_spectral_density(force, record.time_step, segments)
        return amplitude_spectrum(force, record.time_step)
    except (ValueError, IndexError) as error:
        raise InputError(
            f"no spectrum of pantograph {name!r} over the analysed section: {error}"
        ) from None
