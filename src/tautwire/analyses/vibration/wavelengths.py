"""The line's own lengths, and where they show in spectra over wave number or frequency."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.vibration.contact_wire import even_points, wavenumber_spectrum
from tautwire.errors import InputError
from tautwire.line.expand import expand
from tautwire.line.measures import recurring
from tautwire.model.resolution import resolution
from tautwire.results.equilibrium import Equilibrium
from tautwire.signals.spectra import Spectrum, Window
from tautwire.specs.case import Case

Array = NDArray[np.float64]

FRACTIONS = (1, 2, 4)
"""Parts of the dropper and support intervals in which the paper finds the energy."""

NAMED_WITHIN = 0.02
"""Relative distance within which a wavelength is called by a length of the line: the dropper and
support intervals of real lines differ by more."""


@dataclass(frozen=True)
class LineLengths:
    """Distances along the track that repeat in the analysed section.

    Attributes
    ----------
    span : float m
        Commonest span length.
    dropper_interval : float m or None
        Commonest distance between neighbouring droppers (DD), or pairs of droppers; None without
        two in a span.
    support_interval : float m or None
        Commonest distance from a support to its nearest dropper (SD); None without droppers.
    shortest : float m
        Shortest of all DD and SD; the span where there are no droppers.
    elements : tuple of float m
        Element lengths of the mesh in these intervals, longest first.
    """

    span: float
    dropper_interval: float | None
    support_interval: float | None
    shortest: float
    elements: tuple[float, ...]

    def named(self, *, elements: bool = True) -> dict[str, float]:
        """Return lengths by name: span, DD, SD, their halves and quarters, elements [m].

        Parameters
        ----------
        elements
            Whether the element lengths of the mesh are among them.
        """
        found = {"span": self.span}
        for fraction in FRACTIONS:
            suffix = "" if fraction == 1 else f"/{fraction}"
            for name, value in (("DD", self.dropper_interval), ("SD", self.support_interval)):
                if value is not None:
                    found[name + suffix] = value / fraction
        if elements:
            for length in self.elements:
                found[f"element {length:.4g} m"] = length
        return found


def line_lengths(case: Case) -> LineLengths:
    """Read the lengths that repeat in the analysed section of a case.

    Parameters
    ----------
    case

    Returns
    -------
    LineLengths

    Examples
    --------
    >>> from tautwire.inputs.load import load_case
    >>> line_lengths(load_case("ac-simple")).named(elements=False)["SD/4"]
    1.125
    """
    found = recurring(expand(case), *case.resolved_section())
    lengths = {v for v in (found.between, found.beside) if v is not None} or {found.span}
    return LineLengths(
        span=found.span,
        dropper_interval=found.between,
        support_interval=found.beside,
        shortest=found.shortest,
        elements=_elements(case, sorted(lengths, reverse=True)),
    )


def _elements(case: Case, intervals: list[float]) -> tuple[float, ...]:
    """Return the lengths of elements that the head passes again and again [m]."""
    nodes = case.settings.nodes_between_droppers
    if nodes is None:
        return (resolution(case, expand(case)).longest,)
    return tuple(value / (nodes - 1) for value in intervals)


def presag_spectrum(
    shape: Equilibrium,
    section: tuple[int, int],
    window: Window = "hann",
    *,
    density: bool = False,
) -> Spectrum:
    """Compute the spectrum of the static height of the contact wire.

    Parameters
    ----------
    shape
        Static state.
    section : (first, last) span
        1-based, both included.
    window : {"hann", "none"}
    density : bool
        False: amplitudes [m]; True: power spectral density [m^3].

    Returns
    -------
    Spectrum
        Over wave number [1/m].

    Raises
    ------
    InputError
        When the section does not lie in the line.
    """
    first, last = section
    if not 1 <= first <= last < len(shape.mast_x):
        raise InputError(f"section [{first}, {last}]: the line has {len(shape.mast_x) - 1} spans")
    points = even_points(shape, start=float(shape.mast_x[first - 1]), end=float(shape.mast_x[last]))
    heights = points.heights(shape.position)
    return wavenumber_spectrum(heights, points.spacing, window, density=density)


@dataclass(frozen=True)
class Peak:
    """A local maximum of a spectrum.

    Attributes
    ----------
    abscissa : float
        Frequency [Hz] or wave number [1/m].
    value : float
    name : str
        Length of the line that it belongs to; empty for none.
    """

    abscissa: float
    value: float
    name: str


def name_peaks(
    spectrum: Spectrum,
    lengths: Mapping[str, float],
    *,
    speed: float | None = None,
    count: int = 12,
    above: float = 0.0,
    lines: float = 1.5,
) -> tuple[Peak, ...]:
    """Find the highest peaks of a spectrum and name those that a length of the line explains.

    Parameters
    ----------
    spectrum
        Over wave number, or over frequency with `speed`.
    lengths
        Name and length [m], as from :meth:`LineLengths.named`.
    speed
        Speed at which a spectrum over frequency was recorded [m/s].
    count
        Number of peaks.
    above
        Peaks at or below this abscissa are left out.
    lines
        A peak is named within so many lines of the spectrum, or within 2 %; 0.5 suits a comb.

    Returns
    -------
    tuple of Peak
        By increasing abscissa.
    """
    places = _places(spectrum, lengths, speed)
    value = spectrum.value
    is_peak = (value[1:-1] > value[:-2]) & (value[1:-1] >= value[2:])
    at = 1 + np.flatnonzero(is_peak)
    at = at[spectrum.abscissa[at] > above]
    at = at[np.argsort(value[at])[::-1][:count]]
    peaks = []
    for index in sorted(at.tolist()):
        x = float(spectrum.abscissa[index])
        near = {
            name: abs(place - x)
            for name, place in places.items()
            if abs(place - x) <= max(lines * spectrum.resolution, NAMED_WITHIN * place)
        }
        name = min(near, key=lambda item: near[item]) if near else ""
        peaks.append(Peak(x, float(value[index]), name))
    return tuple(peaks)


def _places(
    spectrum: Spectrum, lengths: Mapping[str, float], speed: float | None
) -> dict[str, float]:
    """Return where the lengths lie on the axis of a spectrum."""
    if spectrum.abscissa_unit == "Hz" and speed is None:
        raise InputError("a spectrum over frequency needs the speed to name lengths")
    factor = 1.0 if spectrum.abscissa_unit == "1/m" else float(speed or 0.0)
    return {name: factor / length for name, length in lengths.items()}
