"""Draw the irregularities of a line from their description.

Every random item has its own stream of random numbers, which depends on the seed and on the item's
place only: adding one item leaves the others as they are.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from tautwire.line.expand import expand
from tautwire.numerics.motion.stepper import SurfaceProfile
from tautwire.results.irregularity import DrawnIrregularities
from tautwire.specs.case import Case
from tautwire.specs.line.irregularity import Installation, Unevenness, installation_values

Array = NDArray[np.float64]

SURFACE_SPACING = 0.005
"""Distance of the ordinates between which the running surface is straight [m]."""

_INSTALLATION, _UNEVENNESS = 0, 1


def draw_irregularities(case: Case) -> DrawnIrregularities:
    """Draw all irregularities of a case.

    Parameters
    ----------
    case
        Its ``irregularities`` and ``settings.seed`` decide everything.
    """
    spec, seed = case.irregularities, case.settings.seed
    errors = np.zeros(len(expand(case).hangers))
    if spec.installation is not None:
        random = _stream(seed, _INSTALLATION)
        errors = _installation_errors(spec.installation, len(errors), case.line.spans, random)
    is_height = spec.installation is not None and spec.installation.of == "height"
    none = np.zeros_like(errors)
    surface = np.empty(0)
    if spec.unevenness:
        x = SURFACE_SPACING * np.arange(case.line.length() // SURFACE_SPACING + 2, dtype=np.float64)
        surface = np.zeros_like(x)
        for number, part in enumerate(spec.unevenness):
            surface += _DRAW[part.kind](part, x, _stream(seed, _UNEVENNESS, number))
    return DrawnIrregularities(
        seed=seed,
        dropper_height=errors if is_height else none,
        dropper_length=none if is_height else errors,
        surface_start=0.0,
        surface_spacing=SURFACE_SPACING,
        surface_height=surface,
    )


def surface_profile(drawn: DrawnIrregularities) -> SurfaceProfile | None:
    """Return the running surface for the time integration; None when it is even."""
    if not drawn.is_uneven:
        return None
    return SurfaceProfile(drawn.surface_start, drawn.surface_spacing, drawn.surface_height)


def _stream(seed: int, *place: int) -> np.random.Generator:
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=place))


def _installation_errors(
    spec: Installation, count: int, spans: int, random: np.random.Generator
) -> Array:
    """Return one error per dropper, span by span [m]."""
    if spec.values is not None:
        rows = installation_values(spec.values, spans)
        return np.concatenate([np.array(row) for row in rows])
    if spec.amplitude is not None:
        return random.uniform(-spec.amplitude, spec.amplitude, count)
    return random.normal(0.0, _given(spec.deviation), count)


def _ordinates(part: Unevenness, x: Array, random: np.random.Generator) -> Array:
    """Return independent random ordinates joined by a natural cubic spline."""
    from scipy.interpolate import CubicSpline

    spacing = _given(part.spacing)
    at = spacing * np.arange(max(2, int(np.ceil(x[-1] / spacing)) + 1))
    if part.amplitude is not None:
        values = random.uniform(-part.amplitude, part.amplitude, len(at))
    else:
        values = random.normal(0.0, _given(part.deviation), len(at))
    return CubicSpline(at, values, bc_type="natural")(x)


def _harmonics(part: Unevenness, x: Array, random: np.random.Generator) -> Array:
    """Return a sum of harmonics whose spectral density is the given one.

    The line at the wavenumber n, one of a series with the distance dn, has the amplitude
    ``sqrt(2 S(n) dn)`` of the one-sided density S and a random phase (M. Shinozuka and C.-M. Jan,
    J. Sound Vib. 25 (1972) 111-128, doi:10.1016/0022-460X(72)90600-1).
    """
    count = len(x)
    wavenumber = np.fft.rfftfreq(count, x[1] - x[0])
    density = _density(part, wavenumber)
    amplitude = np.sqrt(2.0 * density * wavenumber[1])
    phase = random.uniform(0.0, 2.0 * np.pi, len(wavenumber))
    return np.fft.irfft(0.5 * count * amplitude * np.exp(1j * phase), count)


def _density(part: Unevenness, wavenumber: Array) -> Array:
    """Return the one-sided spectral density at some wavenumbers [m3], zero outside the band."""
    inside = (wavenumber * _given(part.longest) >= 1.0) & (
        wavenumber * _given(part.shortest) <= 1.0
    )
    density = np.zeros_like(wavenumber)
    if part.wavenumbers is not None:
        density[inside] = np.interp(
            wavenumber[inside], part.wavenumbers, part.densities or (), left=0.0, right=0.0
        )
    else:
        ratio = wavenumber[inside] / _given(part.reference)
        density[inside] = _given(part.level) * ratio ** -_given(part.exponent)
    return density if part.sides == "one" else 2.0 * density


def _profile(part: Unevenness, x: Array, random: np.random.Generator) -> Array:  # noqa: ARG001
    """Return the given ordinates, joined by straight lines, zero beyond their ends."""
    return np.interp(x, part.x or (), part.height or (), left=0.0, right=0.0)


def _bump(part: Unevenness, x: Array, random: np.random.Generator) -> Array:  # noqa: ARG001
    """Return one period of a cosine, raised to start and end at zero."""
    phase = (x - _given(part.position)) / _given(part.length)
    shape = 0.5 + 0.5 * np.cos(2.0 * np.pi * phase)
    return np.where(np.abs(phase) <= 0.5, _given(part.rise) * shape, 0.0)


_DRAW: dict[str, Callable[[Unevenness, Array, np.random.Generator], Array]] = {
    "uniform": _ordinates,
    "gaussian": _ordinates,
    "power law": _harmonics,
    "spectrum": _harmonics,
    "profile": _profile,
    "bump": _bump,
}


def _given(value: float | None) -> float:
    """Return a value that the spec's checks guarantee."""
    if value is None:
        raise ValueError("the description of an irregularity is incomplete")
    return value
