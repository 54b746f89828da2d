"""Irregularities: what is drawn, from which seed, and how it is stored."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tautwire.model.irregularity import SURFACE_SPACING, draw_irregularities, surface_profile
from tautwire.numerics.motion.stepper import SurfaceProfile
from tautwire.results.irregularity import DrawnIrregularities

from ..lines import ac_simple

Array = NDArray[np.float64]
UNIFORM = {"kind": "uniform", "spacing": 1.0, "amplitude": 2e-3}
GAUSSIAN = {"kind": "gaussian", "spacing": 0.5, "deviation": 1e-3}
POWER = {
    "kind": "power law",
    "level": 2e-8,
    "reference": 0.5,
    "exponent": 2.5,
    "shortest": 0.4,
    "longest": 8.0,
}
SPECTRUM = {
    "kind": "spectrum",
    "wavenumbers": (0.2, 1.0, 2.0),
    "densities": (4e-7, 1e-7, 0.0),
    "shortest": 0.25,
    "longest": 20.0,
}


def drawn(*unevenness: dict[str, Any], seed: int = 7, spans: int = 20, **more: Any) -> Any:
    """Draw the irregularities of a line."""
    case = ac_simple(
        line__spans=spans,
        settings__seed=seed,
        irregularities={"unevenness": unevenness, **more},
    )
    return draw_irregularities(case)


def density(surface: Array, wavenumber: Array) -> Array:
    """Return the one-sided spectral density of a record at its own harmonics [m3]."""
    length = len(surface) * SURFACE_SPACING
    lines = 2.0 * np.abs(np.fft.rfft(surface) / len(surface)) ** 2 * length
    return np.interp(wavenumber, np.fft.rfftfreq(len(surface), SURFACE_SPACING), lines)


def test_nothing_is_drawn_without_irregularities() -> None:
    """A case without irregularities has a perfect line."""
    perfect = draw_irregularities(ac_simple())
    assert not perfect.is_installed_wrong
    assert not perfect.is_uneven
    assert surface_profile(perfect) is None


def test_same_seed_same_bits() -> None:
    """The same seed gives the same numbers to the last bit, another one others."""
    installation = {"of": "height", "amplitude": 1e-3}
    one, two = (drawn(UNIFORM, POWER, installation=installation) for _ in range(2))
    other = drawn(UNIFORM, POWER, installation=installation, seed=8)
    assert one.surface_height.tobytes() == two.surface_height.tobytes()
    assert one.dropper_height.tobytes() == two.dropper_height.tobytes()
    assert one.seed == 7
    assert not np.array_equal(one.surface_height, other.surface_height)
    assert not np.array_equal(one.dropper_height, other.dropper_height)


def test_streams_do_not_depend_on_other_items() -> None:
    """Adding a part, or errors of installation, leaves what was drawn before as it was."""
    first, both = drawn(UNIFORM), drawn(UNIFORM, GAUSSIAN, installation={"of": "length",
        "distribution": "gaussian", "deviation": 1e-3})  # fmt: skip
    second = both.surface_height - first.surface_height
    assert first.surface_height.std() > 0.0
    assert second == pytest.approx(drawn(BUMP_OF_NOTHING, GAUSSIAN).surface_height, abs=1e-15)


BUMP_OF_NOTHING = {"kind": "bump", "position": 5.0, "length": 1.0, "rise": 0.0}


@pytest.mark.parametrize("part", [UNIFORM, GAUSSIAN], ids=["uniform", "gaussian"])
def test_ordinates_have_their_distribution(part: dict[str, Any]) -> None:
    """The ordinates at the given spacing have mean 0 and the variance of their distribution,
    amplitude^2/3 or deviation^2, within four standard errors; the spline passes through them."""
    found = drawn(part, spans=60)
    stride = round(part["spacing"] / SURFACE_SPACING)
    values = found.surface_height[::stride][:-1]
    expected = part.get("deviation") or part["amplitude"] / np.sqrt(3.0)
    assert abs(values.mean()) < 4.0 * expected / np.sqrt(len(values))
    assert values.std() == pytest.approx(expected, rel=4.0 / np.sqrt(2.0 * len(values)))
    if "amplitude" in part:
        assert np.abs(values).max() <= part["amplitude"]
        assert np.abs(values).max() > 0.99 * part["amplitude"]
    assert np.abs(np.diff(found.surface_height)).max() < 0.1 * expected


@pytest.mark.parametrize("part", [POWER, SPECTRUM], ids=["power law", "spectrum"])
def test_harmonics_have_the_given_density(part: dict[str, Any]) -> None:
    """The density of the drawn surface is the given one at every wavenumber inside the band and 0
    outside it (Shinozuka and Jan 1972: deterministic amplitudes, random phases)."""
    surface = drawn(part).surface_height
    step = 1.0 / (len(surface) * SURFACE_SPACING)
    line = step * np.arange(1, round(5.0 / step))
    inside = (line > 1.01 / part["longest"]) & (line < 0.99 / part["shortest"])
    if part["kind"] == "power law":
        given = part["level"] * (line / part["reference"]) ** -part["exponent"]
    else:
        given = np.interp(line, part["wavenumbers"], part["densities"], left=0.0, right=0.0)
    outside = (line < 0.99 / part["longest"]) | (line > 1.01 / part["shortest"])
    assert density(surface, line)[inside] == pytest.approx(given[inside], rel=1e-6, abs=1e-16)
    assert density(surface, line)[outside].max() < 1e-16


def test_variance_is_the_integral_of_the_density() -> None:
    """Variance of a power law: level reference^w (n1^(1-w) - n2^(1-w))/(w - 1) over its band,
    within the half harmonic at each of its ends."""
    surface = drawn(POWER, spans=60).surface_height
    w, low, high = POWER["exponent"], 1.0 / POWER["longest"], 1.0 / POWER["shortest"]
    assert isinstance(w, float)
    integral = POWER["level"] * POWER["reference"] ** w * (low ** (1 - w) - high ** (1 - w))
    assert surface.mean() == pytest.approx(0.0, abs=1e-12)
    assert np.mean(surface**2) == pytest.approx(integral / (w - 1.0), rel=0.01)


def test_two_sided_density_counts_twice() -> None:
    """A density of both signs of the wavenumber holds twice the variance of a one-sided one."""
    one, two = drawn(POWER), drawn({**POWER, "sides": "two"})
    assert two.surface_height == pytest.approx(np.sqrt(2.0) * one.surface_height, abs=1e-12)


def test_phases_make_it_gaussian() -> None:
    """A sum of many harmonics is nearly Gaussian: kurtosis near 3, skewness near 0."""
    surface = drawn(SPECTRUM, spans=60).surface_height
    unit = surface / surface.std()
    assert np.mean(unit**4) == pytest.approx(3.0, abs=0.3)
    assert np.mean(unit**3) == pytest.approx(0.0, abs=0.15)


def test_profile_and_bump_are_as_given() -> None:
    """A profile passes through its ordinates and is even beyond them; a bump is one period of a
    cosine; parts add up."""
    profile = {"kind": "profile", "x": (100.0, 101.0, 103.0), "height": (0.0, 2e-3, -1e-3)}
    bump = {"kind": "bump", "position": 102.0, "length": 0.8, "rise": -3e-3}
    found = drawn(profile, bump)
    x = np.array([99.0, 100.5, 101.0, 102.0, 101.8, 102.5, 103.0, 103.1])
    lowered = np.array([0.0, 0.0, 0.0, -3e-3, -1.5e-3, 0.0, 0.0, 0.0])
    straight = np.interp(x, profile["x"], profile["height"], left=0.0, right=0.0)
    surface = surface_profile(found)
    assert surface is not None
    assert surface.at(x) == pytest.approx(straight + lowered, abs=1e-12)
    assert np.array_equal(surface.x, found.surface_x)


def test_surface_ends_with_the_line() -> None:
    """The surface covers the whole line; a profile is straight between its ordinates and even
    beyond its ends."""
    assert drawn(UNIFORM).surface_x[-1] >= 20 * 55.0
    short = SurfaceProfile(10.0, 0.5, np.array([1.0, 3.0, 2.0]))
    found = short.at(np.array([9.99, 10.0, 10.25, 10.5, 11.0, 11.01]))
    assert found == pytest.approx([0.0, 1.0, 2.0, 3.0, 2.0, 0.0])


@pytest.mark.parametrize("of", ["height", "length"])
def test_errors_of_installation(of: str) -> None:
    """Errors of installation are one per dropper, of the kind and distribution asked for."""
    found = drawn(installation={"of": of, "amplitude": 3e-3})
    errors = {"height": found.dropper_height, "length": found.dropper_length}
    other = errors.pop("length" if of == "height" else "height")
    assert not other.any()
    assert errors[of].shape == (180,)
    assert 2.8e-3 < np.abs(errors[of]).max() <= 3e-3
    assert errors[of].std() == pytest.approx(3e-3 / np.sqrt(3.0), rel=0.15)
    assert found.is_installed_wrong
    assert not found.is_uneven


def test_errors_from_a_table() -> None:
    """Given errors hold in every span, or span by span."""
    row = tuple(1e-4 * i for i in range(9))
    rows = (row, tuple(-v for v in row))
    table = {"of": "height", "distribution": "table"}
    same = drawn(installation={**table, "values": row}, spans=2)
    each = drawn(installation={**table, "values": rows}, spans=2)
    assert same.dropper_height == pytest.approx(np.tile(row, 2))
    assert each.dropper_height == pytest.approx(np.concatenate(rows))


def test_drawn_irregularities_are_a_result() -> None:
    """They are frozen: what a run was computed with cannot be changed afterwards."""
    found = drawn(UNIFORM)
    assert isinstance(found, DrawnIrregularities)
    with pytest.raises(AttributeError):
        found.seed = 3  # pyright: ignore[reportAttributeAccessIssue]
