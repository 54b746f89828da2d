"""Modes against closed forms and dense eigenvalues; the inertia count against both."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from tautwire.analyses.road.shape import find_shape
from tautwire.analyses.vibration.modes import (
    free_wire_frequency,
    mode_spectrum,
    modes,
    modes_between,
    modes_sensitive_to,
)
from tautwire.analyses.vibration.wavelengths import line_lengths
from tautwire.errors import InputError
from tautwire.inputs.load import load_case
from tautwire.model.build import Model, build
from tautwire.numerics.network.system import System
from tautwire.numerics.vibration.eigen import Vibration
from tautwire.results.equilibrium import Equilibrium

from ..lines import CONTACT_WIRE, ac_simple, found, straight_wire, stretch_under

Array = NDArray[np.float64]
LENGTH, ELEMENTS, COUNT = 55.0, 60, 20


def pinned_beam(count: int) -> Array:
    """Return f_n = n/(2L) sqrt(T/m) sqrt(1 + n^2 pi^2 EI/(T L^2)) of the stretched wire [Hz]."""
    tension, bending = CONTACT_WIRE["tension"], CONTACT_WIRE["bending"]
    mass = CONTACT_WIRE["mass"] / stretch_under(tension, CONTACT_WIRE["axial"])
    n = np.arange(1, count + 1)
    stiffening = np.sqrt(1.0 + n**2 * math.pi**2 * bending / (tension * LENGTH**2))
    return n / (2.0 * LENGTH) * math.sqrt(tension / mass) * stiffening


def in_its_plane(wire: System) -> System:
    """Hold the lateral motion, which has the same frequencies as the vertical one."""
    fixed = wire.fixed.reshape(-1, 6).copy()
    fixed[:, [1, 4]] = True
    return wire.with_(fixed=fixed.ravel())


def hertz(values: Array) -> Array:
    return np.sqrt(values) / (2.0 * math.pi)


@pytest.fixture(scope="module")
def short_line() -> tuple[Model, Equilibrium, System]:
    """Three spans of AC simple on a coarse mesh."""
    return found(ac_simple())


@pytest.fixture(scope="module")
def longer_line() -> tuple[Model, Equilibrium, System]:
    """Five spans of AC simple on a mesh that shows half a dropper interval."""
    return found(ac_simple(line__spans=5, settings__nodes_between_droppers=5))


def test_tensioned_beam(record_validation: Callable[..., bool]) -> None:
    """The first 20 modes of a pinned wire meet the closed form within 1e-4 (theory)."""
    vibration = Vibration(in_its_plane(straight_wire(LENGTH, ELEMENTS)))
    pairs = vibration.nearest(0.0, COUNT)
    error = hertz(pairs.values) / pinned_beam(COUNT) - 1.0
    assert record_validation(
        "Bare contact wire, pinned, 55 m",
        "largest deviation of the first 20 frequencies",
        ours=float(np.abs(error).max()),
        unit="1",
        target=0.0,
        absolute=1e-4,
        source="tensioned Euler-Bernoulli beam, stretched length and mass",
    )
    assert pairs.residuals.max() < 1e-10
    assert vibration.orthogonality(pairs.vectors) < 1e-12


def test_beam_in_space_vibrates_twice() -> None:
    """In 3D every frequency of the straight wire occurs twice, and none is missed."""
    vibration = Vibration(straight_wire(LENGTH, ELEMENTS))
    pairs = vibration.nearest(0.0, 2 * COUNT)
    assert hertz(pairs.values) == pytest.approx(np.repeat(pinned_beam(COUNT), 2), rel=1e-4)
    assert vibration.count_below(pairs.values[-1] * (1.0 + 1e-6)) == 2 * COUNT


def test_inertia_counts_the_beam() -> None:
    """The inertia of K - omega^2 M steps by one at each frequency of the closed form."""
    vibration = Vibration(in_its_plane(straight_wire(LENGTH, ELEMENTS)))
    known = pinned_beam(COUNT)
    middles = 0.5 * (known[1:] + known[:-1])
    counted = [vibration.count_below((2.0 * math.pi * f) ** 2) for f in middles]
    assert counted == list(range(1, COUNT))


def test_inertia_equals_dense_eigenvalues(short_line: tuple[Model, Equilibrium, System]) -> None:
    """On a whole line the inertia count equals that of all eigenvalues of the dense problem."""
    from scipy.linalg import eigh

    vibration = Vibration(short_line[2])
    every = eigh(vibration.stiffness.toarray(), vibration.mass.toarray(), eigvals_only=True)
    random = np.random.default_rng(3)
    shifts = [*random.uniform(0.0, every[300], 60), *random.uniform(0.0, every[-1], 30)]
    shifts += [*(every[:20] * (1.0 + 1e-6)), *(every[:20] * (1.0 - 1e-6))]
    assert [vibration.count_below(s) for s in shifts] == [int((every < s).sum()) for s in shifts]


def test_nearest_modes_are_the_nearest(short_line: tuple[Model, Equilibrium, System]) -> None:
    """Shift-invert finds exactly those eigenvalues of the dense problem that are nearest."""
    from scipy.linalg import eigh

    vibration = Vibration(short_line[2])
    every = eigh(vibration.stiffness.toarray(), vibration.mass.toarray(), eigvals_only=True)
    shift = (2.0 * math.pi * 12.0) ** 2
    nearest = np.sort(every[np.argsort(np.abs(every - shift))[:15]])
    assert vibration.nearest(shift, 15).values == pytest.approx(nearest, rel=1e-9)


def test_shift_on_a_mode(short_line: tuple[Model, Equilibrium, System]) -> None:
    """A target that is itself a mode is no obstacle."""
    vibration = Vibration(short_line[2])
    lowest = vibration.nearest(0.0, 3).values
    again = vibration.nearest(float(lowest[1]), 3).values
    assert again == pytest.approx(lowest, rel=1e-9)


def test_modes_near_a_frequency(short_line: tuple[Model, Equilibrium, System]) -> None:
    """``modes`` gives complete, mass-orthogonal modes with small residuals and energy shares."""
    model, shape, _ = short_line
    result = modes(model, shape, near=10.0, count=12)
    assert len(result.frequencies) == 12
    assert result.is_complete
    assert result.orthogonality < 1e-10
    assert result.residuals.max() < 1e-8
    assert result.shares.sum(axis=1) == pytest.approx(1.0, abs=1e-12)
    assert result.shares.min() >= -1e-12
    ranked = result.participation[result.ranked()]
    assert np.all(np.diff(ranked) <= 0.0)
    contact = result.wires[0]
    assert contact.displacements.shape == (12, len(shape.contact.s), 3)


def test_band_is_complete(short_line: tuple[Model, Equilibrium, System]) -> None:
    """All modes of a band are found, however many shifts that takes."""
    from scipy.linalg import eigh

    model, shape, system = short_line
    vibration = Vibration(system)
    every = eigh(vibration.stiffness.toarray(), vibration.mass.toarray(), eigvals_only=True)
    frequencies = hertz(every)
    low, high = 5.0, 30.0
    inside = frequencies[(frequencies >= low) & (frequencies < high)]
    assert len(inside) > 120
    result = modes_between(model, shape, low, high)
    assert result.frequencies == pytest.approx(inside, rel=1e-9)
    assert result.counted == len(inside)


def test_empty_band(short_line: tuple[Model, Equilibrium, System]) -> None:
    """A band below the lowest mode holds none."""
    model, shape, _ = short_line
    result = modes_between(model, shape, 0.0, 0.5)
    assert len(result.frequencies) == 0
    assert result.counted == 0


def test_free_wire_frequencies() -> None:
    """DD/2, SD/2 and DD/4 of AC simple belong to about 45, 58 and 95 Hz (dispersion relation)."""
    case = load_case("ac-simple")
    model = build(case)
    shape, lengths = find_shape(model), line_lengths(case).named()
    expected = {"DD/2": 45.0, "SD/2": 58.0, "DD/4": 95.0}
    for name, frequency in expected.items():
        found_at = free_wire_frequency(model, shape, lengths[name])
        assert found_at == pytest.approx(frequency, rel=0.01)


def test_free_wire_carries_clamps_and_half_droppers() -> None:
    """The wire's mass in the dispersion relation is that of the line: clamps and half droppers."""
    case = {"droppers__mass": "3 kg/m", "settings__section": (1, 3)}
    model, shape, system = found(ac_simple(**case))
    wire, k = model.case.wires.contact, 2.0 * math.pi / 10.0
    hung = float(system.node_mass[system.ties.nodes[:, 1]].sum())
    mass = wire.mass + hung / model.case.line.length()
    expected = math.sqrt((wire.tension * k**2 + wire.bending_stiffness * k**4) / mass)
    given = 2.0 * math.pi * free_wire_frequency(model, shape, 10.0)
    assert given == pytest.approx(expected, rel=1e-9)


def test_mode_sensitive_to_half_a_dropper_interval(
    longer_line: tuple[Model, Equilibrium, System],
) -> None:
    """Near 45 Hz modes peak at DD/2 (Song et al. 2021, Fig. 13), vertical in the contact wire."""
    model, shape, _ = longer_line
    wavelength = line_lengths(model.case).named()["DD/2"]
    result = modes_sensitive_to(model, shape, wavelength, width=0.03, count=3)
    assert len(result.frequencies)
    assert result.frequencies == pytest.approx(45.0, rel=0.05)
    assert result.participation.max() > 0.4
    spectrum = mode_spectrum(result, int(result.ranked()[0]))
    peak = float(spectrum.wavelength[np.argmax(spectrum.value)])
    assert peak == pytest.approx(wavelength, rel=0.02)
    assert result.wavelengths == pytest.approx(wavelength, rel=0.02)


def test_wavelength_below_the_mesh_is_refused(
    short_line: tuple[Model, Equilibrium, System],
) -> None:
    """A wavelength that two elements cannot show is refused, with the cure."""
    model, shape, _ = short_line
    with pytest.raises(InputError, match="longest_element"):
        modes_sensitive_to(model, shape, 1.0)


@pytest.mark.parametrize(("near", "count"), [(-1.0, 5), (math.nan, 5), (10.0, 0)])
def test_impossible_requests_are_refused(
    short_line: tuple[Model, Equilibrium, System], near: float, count: int
) -> None:
    """A negative target and a count of none are refused."""
    with pytest.raises(InputError):
        modes(*short_line[:2], near=near, count=count)


def test_tables_of_modes(short_line: tuple[Model, Equilibrium, System]) -> None:
    """CSV and JSON hold one row per mode; the shapes one column per wire and mode."""
    model, shape, _ = short_line
    result = modes(model, shape, near=10.0, count=4)
    table = result.to_csv().splitlines()
    assert table[0].startswith("frequency [Hz],sensitive wavelength [m]")
    assert len(table) == 5
    shapes = result.shapes_csv().splitlines()
    assert len(shapes) == 1 + len(shape.contact.s)
    assert len(shapes[0].split(",")) >= 9
    assert result.as_dict()["counted_by_inertia"] == 4


def test_a_contact_wire_alone_has_all_the_energy() -> None:
    """Without a messenger wire its shares are there and nothing, and the rows are complete."""
    case = load_case("tram", {"line.spans": 4, "settings.section": [2, 3]})
    model = build(case)
    rows = modes(model, find_shape(model), count=3).rows()
    shares = [[value for key, value in row.items() if key.startswith("share_")] for row in rows]
    assert [len(one) for one in shares] == [6, 6, 6]
    assert np.array(shares)[:, 3:].max() == 0.0
    assert np.array(shares).sum(axis=1) == pytest.approx(np.ones(3))
