"""Modes of the line about its static state, and the wavelengths they are sensitive to.

The procedure follows Song et al. (2021), section IV.B and Fig. 12: the spectrum of the vertical
mode shape of the contact wire over the length of the line gives the wavelength by which the mode
can be excited.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.vibration.contact_wire import even_points, wavenumber_spectrum
from tautwire.errors import ConvergenceError, InputError
from tautwire.line.measures import contact_mass
from tautwire.model.build import Model
from tautwire.model.equations import equations
from tautwire.numerics.vibration.eigen import Pairs, Vibration
from tautwire.results.equilibrium import Equilibrium, WirePoints
from tautwire.results.modes import SHARES, Modes, ModeWire
from tautwire.signals.spectra import Spectrum

Array = NDArray[np.float64]

PER_SHIFT = 60
"""Most modes that are sought around one shift: the time of Lanczos' method grows with the square of
their number, that of a factor is paid per shift. Chosen."""

MOST = 20_000
"""Most modes in one band; more are refused: their shapes fill gigabytes."""

SEARCH_WIDTH = 0.05
"""Half width of a search, relative to the frequency that a bare wire would have; the line's own
modes of that wavelength lie within 5 % of it (ten spans of AC simple, 2.1 to 5.75 m)."""

SENSITIVE_WITHIN = 0.01
"""Largest relative distance of a mode's wavelength from the wanted one: the lengths of a line that
are told apart differ by more. A longer line of the spectrum counts in its place."""

_EDGE = 1e-7
"""Relative distance from the outermost modes at which modes are counted: above the error of a
computed frequency (some 1e-12), below the distance of two modes (2e-5 and more on ten
spans at 45 Hz)."""
NEAR, COUNT = 0.0, 20
"""Where modes are sought [Hz], and how many: the first ones of the line, whatever line it is; the
number is chosen: a screen."""
_CONCENTRATED = 0.05
"""Relative distance from a wavelength within which a mode's energy counts for it. Chosen: eight
lines of the spectrum of 17 spans to either side at the dropper interval."""


def modes(model: Model, shape: Equilibrium, *, near: float = NEAR, count: int = COUNT) -> Modes:
    """Find the modes nearest to a frequency.

    A line has many modes per Hz, half of them lateral; ``result.ranked()`` puts first those in
    which the contact wire moves vertically.

    Parameters
    ----------
    model
        The line.
    shape
        Its static state.
    near
        Target frequency [Hz]; 0 finds the lowest modes.
    count
        Number of modes.

    Returns
    -------
    Modes

    Raises
    ------
    InputError
        When the target is negative or there are fewer modes.
    ConvergenceError
        When the iteration fails.

    Examples
    --------
    >>> found = modes(model, shape, near=45.0)  # doctest: +SKIP
    >>> found.frequencies[found.ranked()[0]]  # doctest: +SKIP
    """
    vibration = Vibration(equations(model, shape))
    most = int(vibration.free.sum()) - 1
    if not (math.isfinite(near) and near >= 0.0):
        raise InputError(f"near: got {near:g} Hz; a target frequency is 0 or more")
    if not 1 <= count <= min(most, MOST):
        raise InputError(f"count: got {count}; the line has 1 to {min(most, MOST)} modes to find")
    pairs = _nearest(vibration, (2.0 * math.pi * near) ** 2, count)
    return _result(model, shape, vibration, pairs)


def modes_between(model: Model, shape: Equilibrium, low: float, high: float) -> Modes:
    """Find all modes in a band of frequencies; their number is checked by an inertia count.

    Parameters
    ----------
    model
        The line.
    shape
        Its static state.
    low, high
        Band [Hz].

    Returns
    -------
    Modes

    Raises
    ------
    InputError
        When the band is empty or holds too many modes.
    ConvergenceError
        When a mode of the band was not found.
    """
    if not 0.0 <= low < high < math.inf:
        raise InputError(f"band: got {low:g} to {high:g} Hz; give two increasing frequencies")
    vibration = Vibration(equations(model, shape))
    return _result(model, shape, vibration, _between(vibration, low, high))


def modes_sensitive_to(
    model: Model,
    shape: Equilibrium,
    wavelength: float,
    *,
    near: float | None = None,
    width: float = SEARCH_WIDTH,
    count: int = 5,
) -> Modes:
    """Find modes whose contact wire is sensitive to a wavelength, such as half a dropper interval.

    All modes around a frequency are computed; those whose spectrum over the contact wire peaks at
    the wavelength (within 1 %, or one line of that spectrum) are ranked by their vertical
    contact-wire participation times the share of their spectrum near the wavelength.

    Parameters
    ----------
    model
        The line.
    shape
        Its static state.
    wavelength
        [m]
    near
        Where to search [Hz]; by default where a bare contact wire has this wavelength.
    width
        Half width of the search relative to `near`.
    count
        Most modes to return.

    Returns
    -------
    Modes
        The best ones by increasing frequency; empty when no mode in the band is sensitive to the
        wavelength. ``counted`` is the number of modes searched.

    Raises
    ------
    InputError
        When the mesh cannot show the wavelength.
    """
    finest = 2.0 * float(np.diff(shape.contact.s).max())
    if not finest <= wavelength < math.inf:
        raise InputError(
            f"wavelength: got {wavelength:g} m; elements of up to {0.5 * finest:.3g} m show "
            f"wavelengths from {finest:.3g} m on: shorten settings.longest_element"
        )
    target = near if near is not None else free_wire_frequency(model, shape, wavelength)
    found = modes_between(model, shape, target * (1.0 - width), target * (1.0 + width))
    length = float(found.x[-1] - found.x[0])
    tolerance = max(SENSITIVE_WITHIN, wavelength / length)
    is_sensitive = np.abs(found.wavelengths / wavelength - 1.0) <= tolerance
    score = np.where(is_sensitive, found.participation * concentration(found, wavelength), 0.0)
    best = np.argsort(-score, kind="stable")[:count]
    return found.chosen(best[score[best] > 0.0])


def mode_spectrum(modes: Modes, number: int) -> Spectrum:
    """Compute the spectrum of a mode's vertical contact-wire shape (Song et al. 2021, Fig. 12).

    Parameters
    ----------
    modes
    number
        0-based.

    Returns
    -------
    Spectrum
        Over wave number [1/m], Hann window over the whole line; the largest value is 1.
    """
    spectrum = wavenumber_spectrum(modes.contact_z[number], float(modes.x[1] - modes.x[0]))
    peak = float(spectrum.value.max()) or 1.0
    return Spectrum(spectrum.abscissa, spectrum.value / peak, "1/m", spectrum.window, 1)


def concentration(modes: Modes, wavelength: float) -> Array:
    """Return the share of each mode's spectral energy within 5 % of a wavelength, (n_mode,)."""
    shares = np.empty(len(modes.frequencies))
    for number in range(len(shares)):
        spectrum = mode_spectrum(modes, number)
        near = np.abs(spectrum.abscissa * wavelength - 1.0) <= _CONCENTRATED
        energy = spectrum.value**2
        shares[number] = energy[near].sum() / max(float(energy.sum()), 1e-300)
    return shares


def free_wire_frequency(model: Model, shape: Equilibrium, wavelength: float) -> float:
    """Return the frequency at which waves on the contact wire alone have a wavelength [Hz].

    ``omega^2 = (T k^2 + EI k^4)/m`` with ``k = 2 pi/wavelength``; the mass includes clamps and
    halves of the droppers spread over the analysed section, so that it is near that of the line.

    Parameters
    ----------
    model
        The line.
    shape
        Its static state.
    wavelength
        [m]
    """
    wire = model.line.of_role("contact")[0].wire
    lengths = shape.dropper_lengths_unstrained
    mass = contact_mass(model.line, lengths, *model.case.resolved_section())
    k = 2.0 * math.pi / wavelength
    omega = math.sqrt((wire.tension * k**2 + wire.bending_stiffness * k**4) / mass)
    return omega / (2.0 * math.pi)


def _nearest(vibration: Vibration, shift: float, count: int) -> Pairs:
    from scipy.sparse.linalg import ArpackNoConvergence

    try:
        return vibration.nearest(shift, count)
    except ArpackNoConvergence as error:
        raise ConvergenceError(
            f"modes: only {len(error.eigenvalues)} of {count} modes near "
            f"{math.sqrt(max(shift, 0.0)) / (2.0 * math.pi):g} Hz were found. Try fewer modes "
            "(count) or a slightly different frequency (near)."
        ) from None


def _between(vibration: Vibration, low: float, high: float) -> Pairs:
    """Find the modes of a band, slice by slice."""
    edges = [(2.0 * math.pi * f) ** 2 for f in (low, high)]
    below = [vibration.count_below(edge) for edge in edges]
    expected = below[1] - below[0]
    if expected > MOST:
        raise InputError(
            f"band: {expected} modes lie between {low:g} and {high:g} Hz; at most {MOST} are "
            "computed at once"
        )
    parts = [
        _slice(vibration, *piece) for piece in _slices(vibration, edges, below) if piece[2] > 0
    ]
    if not parts:
        return Pairs(np.empty(0), np.empty((0, vibration.size)), np.empty(0))
    return Pairs(*(np.concatenate([getattr(p, name) for p in parts]) for name in
                   ("values", "vectors", "residuals")))  # fmt: skip


def _slices(
    vibration: Vibration, edges: list[float], below: list[int]
) -> list[tuple[float, float, int]]:
    """Halve a band until no slice holds more modes than one shift can serve."""
    number = below[1] - below[0]
    if number <= PER_SHIFT:
        return [(edges[0], edges[1], number)]
    middle = 0.5 * (edges[0] + edges[1])
    half = vibration.count_below(middle)
    left = _slices(vibration, [edges[0], middle], [below[0], half])
    return left + _slices(vibration, [middle, edges[1]], [half, below[1]])


def _slice(vibration: Vibration, low: float, high: float, number: int) -> Pairs:
    """Find the modes of a slice; those nearest to its middle are exactly its own."""
    most = int(vibration.free.sum()) - 1
    for more in (2, 20):  # the nearest outside come along; where they are crowded, more do
        pairs = _nearest(vibration, 0.5 * (low + high), min(number + more, most))
        own = (pairs.values >= low) & (pairs.values < high)
        if int(own.sum()) == number:
            return Pairs(pairs.values[own], pairs.vectors[own], pairs.residuals[own])
    band = [math.sqrt(edge) / (2.0 * math.pi) for edge in (low, high)]
    raise ConvergenceError(
        f"modes: {int(own.sum())} of {number} modes between {band[0]:g} and {band[1]:g} Hz were "
        "found. Try a slightly different band."
    )


def _result(model: Model, shape: Equilibrium, vibration: Vibration, pairs: Pairs) -> Modes:
    """Describe found modes: shapes, energy shares, wavelengths, checks."""
    points = even_points(shape)
    axes = shape.track.frames(shape.node_s).axes
    nodes = pairs.vectors.reshape(len(pairs.values), vibration.size // 6, 2, 3)
    nodes = np.einsum("nij,mnaj->mnai", axes, nodes)
    contact = [number for number, role in enumerate(shape.wire_roles) if role == "contact"]
    group = np.tile(np.arange(3), vibration.size // 3)
    group += 3 * np.repeat(~np.isin(shape.node_wire, contact), 6)
    contact_z = points.values(pairs.vectors)
    omega = np.sqrt(np.maximum(pairs.values, 0.0))
    return Modes(
        case_name=model.case.name,
        case_hash=model.case.hash(),
        frequencies=omega / (2.0 * math.pi),
        wires=tuple(ModeWire(wire.name, wire.s, nodes[:, wire.nodes, 0]) for wire in shape.wires),
        x=points.s,
        contact_z=contact_z,
        shares=vibration.energy_shares(pairs.vectors, group, len(SHARES), axes),
        wavelengths=_dominant_wavelengths(contact_z, points),
        residuals=pairs.residuals,
        orthogonality=vibration.orthogonality(pairs.vectors),
        counted=_counted(vibration, pairs.values),
    )


def _dominant_wavelengths(contact_z: Array, points: WirePoints) -> Array:
    found = np.full(len(contact_z), np.nan)
    for number, values in enumerate(contact_z):
        spectrum = wavenumber_spectrum(values, points.spacing)
        at = 1 + int(np.argmax(spectrum.value[1:]))
        found[number] = 1.0 / spectrum.abscissa[at]
    return found


def _counted(vibration: Vibration, values: Array) -> int:
    """Count the modes from the lowest to the highest of the found ones by inertia."""
    if not len(values):
        return 0
    low, high = values[0] - _EDGE * abs(values[0]), values[-1] + _EDGE * abs(values[-1])
    return vibration.count_below(high) - vibration.count_below(low)
