"""How closely the wire follows the head through the contact spring, and how stiff it should be.

The head (height ``z_h``) and the touched point of the wire (``z_w``) are joined by the contact
stiffness k. With the receptance ``alpha`` of the wire at that point, ``z_w = alpha F`` and
``F = k (z_h - z_w)``, so the transmissibility is ``T = z_w/z_h = k alpha/(1 + k alpha)``: it
depends on the wire and on k, not on the pantograph. Song et al. (2021), section III.B, ask that it
be close to one over the band of interest. The line is linearised about its static state, all
droppers taut, and the head stays at one place.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tautwire.errors import InputError
from tautwire.model.build import Model
from tautwire.model.equations import equations
from tautwire.numerics.vibration.harmonic import HarmonicLine
from tautwire.plain import Plain, named
from tautwire.results.equilibrium import Equilibrium
from tautwire.signals.bands import WIDEST
from tautwire.specs.pantograph import Pantograph

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

TOLERANCE = 0.1
"""Deviation of ``|T|`` from one that counts as close; chosen, an option of ``advise``."""

LOWEST = 1.0
"""Lower end of the band looked at [Hz]; below it every contact spring is stiff."""

PER_OCTAVE = 24
"""Frequencies per octave: eight in each third octave that is averaged over."""
PLACES = 12
"""Places in the span that are averaged over; chosen, more than droppers (9), so that none is at the
same place of every interval."""
CANDIDATES = (5e4, 1e5, 2e5, 5e5, 1e6)
"""Contact stiffnesses shown for comparison [N/m]."""

_THIRD_OCTAVE = 2.0 ** (1.0 / 6.0)
"""Half a third octave to either side (IEC 61260)."""
_SEARCH = (1e3, 1e9)
"""Contact stiffnesses that are tried [N/m]: far beyond both ends of what is used (50 to 500
kN/m)."""
_PER_DECADE = 100
"""Stiffnesses tried per decade: steps of 2.3 %, finer than the three digits that are shown
matter."""


@dataclass(frozen=True, eq=False)
class Receptance:
    """Displacement of the contact wire per vertical force at the same point.

    Attributes
    ----------
    frequencies : (n_frequency,) Hz
    positions : (n_place,) m
    values : (n_place, n_frequency) m/N
        Complex amplitude per force amplitude.
    """

    frequencies: Array
    positions: Array
    values: Complex

    def transmissibility(self, stiffness: float) -> Complex:
        """Return wire displacement over head displacement, ``(n_place, n_frequency)``.

        Parameters
        ----------
        stiffness
            Contact stiffness [N/m].
        """
        return stiffness * self.values / (1.0 + stiffness * self.values)

    def mean_transmissibility(self, stiffness: float) -> Array:
        """Return ``|T|`` averaged over the places and over a third of an octave, (n_frequency,).

        A line of finite length has a resonance every fraction of a hertz, and a running pantograph
        stays at none of them; the average is what it meets.

        Parameters
        ----------
        stiffness
            Contact stiffness [N/m].
        """
        level = np.abs(self.transmissibility(stiffness)).mean(axis=0)
        return _over_third_octaves(self.frequencies, level)


@dataclass(frozen=True)
class HeadOnSpring(Plain):
    """A contact stiffness and what it does.

    Attributes
    ----------
    stiffness : float N/m
    deviation : float
        Largest deviation of the mean ``|T|`` from one in the band.
    reaches : float Hz
        Frequency up to which the deviation stays within the tolerance.
    resonance : float Hz
        Frequency of the head between the contact spring and its own, the wire held.
    """

    stiffness: float = field(metadata=named("contact_stiffness_n_per_m"))
    deviation: float
    reaches: float = field(metadata=named("reaches_hz"))
    resonance: float = field(metadata=named("head_resonance_hz"))


@dataclass(frozen=True)
class ContactAdvice(Plain):
    """Which contact stiffness keeps head and wire together.

    Attributes
    ----------
    band : float Hz
        Upper end of the band of interest.
    tolerance : float
    smallest : HeadOnSpring or None
        Smallest stiffness from which on the criterion is met; None when none is.
    candidates : tuple of HeadOnSpring
        Usual values, and that of the case.
    """

    band: float = field(metadata=named("band_hz"))
    tolerance: float
    smallest: HeadOnSpring | None
    candidates: tuple[HeadOnSpring, ...]


def receptance(
    model: Model,
    shape: Equilibrium,
    *,
    positions: Sequence[float] | None = None,
    frequencies: ArrayLike | None = None,
    highest: float = WIDEST,
) -> Receptance:
    """Compute the receptance of the contact wire by harmonic solves of the damped line.

    Parameters
    ----------
    model
        The line.
    shape
        Its static state.
    positions
        Places along the track [m]; by default evenly spread over the middle span of the section.
    frequencies
        [Hz]; by default 24 per octave from 1 Hz to `highest`.
    highest
        Upper end of the default frequencies [Hz].

    Returns
    -------
    Receptance

    Raises
    ------
    InputError
        When a place is off the line or a frequency is not positive.
    """
    places = np.asarray(_middle_span(model) if positions is None else positions, dtype=float)
    given = _octaves(highest) if frequencies is None else frequencies
    lines = np.asarray(given, dtype=float)
    x = shape.contact.s
    if not places.size or places.min() <= x[0] or places.max() >= x[-1]:
        raise InputError(f"positions must lie between {x[0]:g} and {x[-1]:g} m")
    if not lines.size or not (np.isfinite(lines).all() and lines.min() > 0.0):
        raise InputError("frequencies must be positive numbers in Hz")
    line = HarmonicLine(equations(model, shape))
    loads = np.stack([_unit_force(shape, place) for place in places], axis=1)
    values = [line.receptances(loads, 2.0 * math.pi * f) for f in lines]
    return Receptance(lines, places, np.array(values).T)


def advise_contact_stiffness(
    response: Receptance,
    pantograph: Pantograph,
    *,
    band: float = WIDEST,
    tolerance: float = TOLERANCE,
    candidates: Sequence[float] = CANDIDATES,
) -> ContactAdvice:
    """Find the smallest contact stiffness that keeps head and wire together over a band.

    Parameters
    ----------
    response
        Receptance of the wire.
    pantograph
        For the resonance of its head.
    band
        Upper end of the band of interest [Hz].
    tolerance
        Largest deviation of the mean ``|T|`` from one.
    candidates
        Stiffnesses to describe beside it [N/m].

    Returns
    -------
    ContactAdvice
    """
    found = None
    decades = math.log10(_SEARCH[1] / _SEARCH[0])
    for stiffness in np.geomspace(*_SEARCH, round(decades * _PER_DECADE) + 1)[::-1].tolist():
        item = _described(response, pantograph, stiffness, band, tolerance)
        if item.deviation > tolerance:
            break
        found = item
    return ContactAdvice(
        band=band,
        tolerance=tolerance,
        smallest=found,
        candidates=tuple(
            _described(response, pantograph, stiffness, band, tolerance)
            for stiffness in sorted(set(candidates))
        ),
    )


def head_resonance(pantograph: Pantograph, stiffness: float) -> float:
    """Return the frequency at which the head oscillates on the contact spring [Hz].

    The mode, among those of the pantograph standing against the contact spring with the wire
    held, in which the head carries most of the kinetic energy; about
    ``sqrt((k + k_1)/m_1)/(2 pi)``.

    Parameters
    ----------
    pantograph
    stiffness
        Contact stiffness k [N/m].
    """
    mass = np.array([stage.mass for stage in pantograph.stages])
    springs = np.array([stage.stiffness for stage in pantograph.stages])
    matrix = np.diag(springs)
    for i, k in enumerate(springs[:-1]):
        matrix[i + 1, i + 1] += k
        matrix[i, i + 1] = matrix[i + 1, i] = -k
    matrix[0, 0] += stiffness
    scale = 1.0 / np.sqrt(mass)
    values, vectors = np.linalg.eigh(scale[:, None] * matrix * scale)
    return float(np.sqrt(values[np.argmax(np.abs(vectors[0]))]) / (2.0 * math.pi))


def _described(
    response: Receptance, pantograph: Pantograph, stiffness: float, band: float, tolerance: float
) -> HeadOnSpring:
    inside = response.frequencies <= band * (1.0 + 1e-9)
    deviation = np.abs(response.mean_transmissibility(stiffness) - 1.0)
    is_far = deviation > tolerance
    first = int(np.argmax(is_far)) if is_far.any() else len(is_far)
    return HeadOnSpring(
        stiffness=stiffness,
        deviation=float(deviation[inside].max(initial=0.0)),
        reaches=float(response.frequencies[first - 1]) if first else 0.0,
        resonance=head_resonance(pantograph, stiffness),
    )


def _over_third_octaves(frequencies: Array, level: Array) -> Array:
    """Average over the frequencies from f/2^(1/6) to f 2^(1/6) that were computed."""
    total = np.concatenate([[0.0], np.cumsum(level)])
    start = np.searchsorted(frequencies, frequencies / _THIRD_OCTAVE * (1.0 - 1e-12))
    end = np.searchsorted(frequencies, frequencies * _THIRD_OCTAVE * (1.0 + 1e-12))
    return (total[end] - total[start]) / (end - start)


def _octaves(highest: float) -> Array:
    if not LOWEST < highest < math.inf:
        raise InputError(f"the band must end above {LOWEST:g} Hz, got {highest:g} Hz")
    count = math.ceil(PER_OCTAVE * math.log2(highest / LOWEST))
    return np.geomspace(LOWEST, highest, count + 1)


def _middle_span(model: Model) -> Array:
    """Return places evenly spread over the middle span of the section, supports avoided."""
    first, last = model.case.resolved_section()
    middle = (first + last) // 2
    left, right = model.line.masts[middle - 1 : middle + 1]
    return left + (right - left) * (np.arange(PLACES) + 0.5) / PLACES


def _unit_force(shape: Equilibrium, position: float) -> Array:
    """Return a unit force of a head on the contact wire as nodal loads, ``(n_dof,)``."""
    point, load = shape.points(shape.contact, np.array([position])), np.zeros(len(shape.position))
    load[point.dofs] = point.press
    return load
