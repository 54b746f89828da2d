"""Receptance of the wire, transmissibility from head to wire, and the advice that follows."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tautwire.analyses.vibration.transmissibility import (
    Receptance,
    advise_contact_stiffness,
    head_resonance,
    receptance,
)
from tautwire.errors import InputError
from tautwire.inputs.load import load_case
from tautwire.model.build import Model
from tautwire.numerics.network.system import System
from tautwire.numerics.vibration.harmonic import HarmonicLine
from tautwire.results.equilibrium import Equilibrium

from ..lines import ac_simple, found, oscillator

Line = tuple[Model, Equilibrium, System]


@pytest.fixture(scope="module")
def line() -> Line:
    """Three spans of AC simple on a coarse mesh."""
    return found(ac_simple())


def string(tension: float, mass: float, frequencies: np.ndarray) -> Receptance:
    """Return the receptance of an infinite string, 1/(2 i w sqrt(T m))."""
    impedance = 2.0 * math.sqrt(tension * mass)
    values = 1.0 / (2j * math.pi * frequencies * impedance)
    return Receptance(frequencies, np.array([0.0]), values[None, :])


def test_oscillator() -> None:
    """The receptance of a mass on a spring and damper is 1/(k - m w^2 + i c w)."""
    mass, stiffness, damping = 7.5, 5e4, 45.0
    line = HarmonicLine(oscillator(mass, stiffness, damping))
    load = np.zeros((18, 1))
    load[14] = 1.0
    for omega in (1.0, 81.0, 300.0):
        expected = 1.0 / (stiffness - mass * omega**2 + 1j * damping * omega)
        assert line.receptances(load, omega)[0] == pytest.approx(expected, rel=1e-12)


def test_low_frequency_is_static(line: Line) -> None:
    """Towards 0 Hz the receptance is the flexibility of the static tangent."""
    from scipy.sparse.linalg import spsolve

    from tautwire.numerics.vibration.eigen import Vibration

    model, shape, system = line
    x = float(shape.dropper_x[4])
    low = receptance(model, shape, positions=[x], frequencies=[1e-3]).values[0, 0]
    free = ~system.fixed
    load = np.zeros(len(free))
    load[12 * int(np.searchsorted(shape.contact.s, x - 1e-9)) + 2] = 1.0
    static = load[free] @ spsolve(Vibration(system).stiffness.tocsc(), load[free])
    assert low.real == pytest.approx(static, rel=1e-6)
    assert abs(low.imag) < 1e-3 * low.real


def test_reciprocity_of_damping(line: Line) -> None:
    """The wire takes up power at every frequency: the receptance has no positive imaginary part."""
    model, shape, _ = line
    result = receptance(model, shape, highest=60.0)
    assert result.values.shape == (12, len(result.frequencies))
    assert result.values.imag.max() < 0.0


def test_string_transmissibility() -> None:
    """On a long string T = k/(k + i w 2 sqrt(T m)) (point impedance of a string)."""
    frequencies = np.array([10.0, 20.0, 50.0])
    wire = string(22e3, 1.35, frequencies)
    impedance = 2.0 * math.sqrt(22e3 * 1.35)
    expected = 2e5 / (2e5 + 2j * math.pi * frequencies * impedance)
    assert wire.transmissibility(2e5)[0] == pytest.approx(expected)


def test_advice_on_a_string() -> None:
    """The smallest stiffness on a string is where |T| falls to 0.9 at the end of the band."""
    frequencies = np.geomspace(1.0, 200.0, 200)
    wire = string(22e3, 1.35, frequencies)
    pantograph = load_case("ac-simple").pantographs[0]
    advice = advise_contact_stiffness(wire, pantograph, band=20.0)
    assert advice.smallest is not None
    impedance = 2.0 * math.pi * 20.0 * 2.0 * math.sqrt(22e3 * 1.35)
    assert advice.smallest.stiffness == pytest.approx(impedance / math.sqrt(0.9**-2 - 1), rel=0.05)
    assert advice.smallest.reaches >= 20.0 * 0.97
    stiffer = advise_contact_stiffness(wire, pantograph, band=100.0).smallest
    assert stiffer is not None
    assert stiffer.stiffness > 4.0 * advice.smallest.stiffness


@pytest.mark.parametrize(("stiffness", "frequency"), [(5e4, 14.0), (2e5, 26.5), (5e5, 41.4)])
def test_head_resonance(stiffness: float, frequency: float) -> None:
    """The benchmark head resonates at 14.0, 26.5 and 41 Hz on 50, 200 and 500 kN/m."""
    pantograph = load_case("ac-simple").pantographs[0]
    assert head_resonance(pantograph, stiffness) == pytest.approx(frequency, rel=0.005)


def test_usual_stiffness_suits_20_hz(line: Line) -> None:
    """The advice for 0 to 20 Hz lies near the upper end of the usual 50 to 200 kN/m."""
    model, shape, _ = line
    result = receptance(model, shape, highest=40.0)
    advice = advise_contact_stiffness(result, model.case.pantographs[0], band=20.0, tolerance=0.15)
    assert advice.smallest is not None
    assert 5e4 < advice.smallest.stiffness < 4e5
    soft = next(item for item in advice.candidates if item.stiffness == 5e4)
    assert soft.deviation > 0.15
    assert advice.as_dict()["smallest"]["contact_stiffness_n_per_m"] == advice.smallest.stiffness


def test_places_off_the_line_are_refused(line: Line) -> None:
    """A place beyond the anchors and a frequency of 0 are refused."""
    model, shape, _ = line
    with pytest.raises(InputError, match="positions"):
        receptance(model, shape, positions=[1e4])
    with pytest.raises(InputError, match="frequencies"):
        receptance(model, shape, frequencies=[0.0])
    with pytest.raises(InputError, match="band"):
        receptance(model, shape, highest=0.5)
