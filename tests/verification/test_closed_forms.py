"""The closed forms of the trade against their own definitions and against integration."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tautwire.formulas.curve import chord_offset, radial_pull, stagger_pull
from tautwire.formulas.lateral import SIDES, Blown, Side, lateral_position, longest_span
from tautwire.formulas.temperature import (
    fixed_wire_tension,
    friction_loop,
    tension_at_fixed_point,
    thermal_travel,
    weight_travel,
)
from tautwire.formulas.wind import dynamic_pressure, wind_load


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("stagger", [(0.2, -0.2), (0.3, 0.3), (-0.1, 0.25), (0.4, -0.4)])
@pytest.mark.parametrize("radius", [400.0, 3000.0, math.inf])
def test_lateral_position(side: Side, stagger: tuple[float, float], radius: float) -> None:
    """The largest lateral position is that of the bow drawn point by point over the span."""
    wire, span = Blown(15e3, 12.0, radius, stagger), 52.0
    sign = 1.0 if side == "inside" else -1.0
    x = np.linspace(0.0, span, 200_001)
    chord = stagger[0] + (stagger[1] - stagger[0]) * x / span
    y = wire.lateral_load(side) * x * (span - x) / (2.0 * wire.tension) - sign * chord
    assert lateral_position(wire, span, side) == pytest.approx(y.max(), abs=1e-9)


@pytest.mark.parametrize("stagger", [(0.2, -0.2), (0.3, 0.15), (0.3, 0.3)])
@pytest.mark.parametrize("radius", [300.0, 1500.0, math.inf])
def test_longest_span_is_the_inverse(stagger: tuple[float, float], radius: float) -> None:
    """At the longest span the wire just reaches the permissible position, on the worse side."""
    wire, permissible = Blown(20e3, 15.6, radius, stagger), 0.42
    found = longest_span(wire, permissible)
    reached = max(lateral_position(wire, found.length, side) for side in SIDES)
    assert reached == pytest.approx(permissible, abs=1e-9)


def test_what_governs() -> None:
    """A stagger beyond the permissible position leaves no span; pull and limit cut it."""
    wire = Blown(10e3, 10.0, 500.0, (0.45, 0.45))
    assert longest_span(wire, 0.4).length == 0.0
    assert longest_span(wire, 0.5, limit=40.0).governs == "limit"
    pulled = longest_span(wire, 0.5, largest_pull=700.0, pulling=2.0 * wire.tension)
    assert pulled.governs == "radial pull"
    assert radial_pull(2.0 * wire.tension, pulled.length, 500.0) == pytest.approx(700.0)


def test_curve_without_wind_to_the_outside() -> None:
    """Where the pull of the curve exceeds the wind, the wire cannot be blown to the outside."""
    wire = Blown(20e3, 10.0, 1000.0, (0.2, 0.2))
    assert lateral_position(wire, 60.0, "outside") == pytest.approx(-0.2 + 0.4, abs=1e-12)
    assert longest_span(wire, 0.3).governs == "wind to the inside"


def test_radial_pull_of_a_polygon() -> None:
    """The pull is the resultant of two chords and nears T L / R; chords run L^2/8R inside."""
    tension, span, radius = 22e3, 55.0, 1000.0
    angle = span / radius
    chords = tension * np.array([[-1.0, 0.0], [math.cos(angle), math.sin(angle)]])
    assert radial_pull(tension, span, radius) == pytest.approx(np.linalg.norm(chords.sum(axis=0)))
    assert radial_pull(tension, span, radius) == pytest.approx(tension * span / radius, rel=2e-4)
    exact = radius * (1.0 - math.cos(0.5 * angle))
    assert chord_offset(span, radius) == pytest.approx(exact, rel=3e-4)


def test_stagger_pull_of_a_zigzag() -> None:
    """Equal spans and alternating stagger b pull 4 T b / L at every support."""
    pull = stagger_pull(10e3, (-0.2, 0.2, -0.2), (50.0, 50.0))
    assert pull == pytest.approx(4.0 * 10e3 * 0.2 / 50.0)


def _catenary_length(tension: float, span: float, load: float, stiffness: float) -> float:
    """Return the unstrained length of an elastic catenary with supports at equal height."""
    a = tension / load
    half = 0.5 * span
    length = 2.0 * a * math.sinh(half / a)
    # elongation: integral of T/EA along the wire, T = H cosh(x / a)
    stretch = tension / stiffness * (half + 0.5 * a * math.sinh(2.0 * half / a))
    return length - stretch


@pytest.mark.parametrize("warming", [-55.0, -20.0, 0.0, 30.0, 85.0])
@pytest.mark.parametrize("ice", [0.0, 7.0])
def test_state_equation(warming: float, ice: float) -> None:
    """Tension over temperature and ice within 0.1 % of the elastic catenary (flat wire)."""
    span, load, stiffness, alpha, before = 60.0, 10.5, 12e6, 17e-6, 12e3
    found = fixed_wire_tension(before, span, stiffness, (load, load + ice), alpha * warming)
    unstrained = _catenary_length(before, span, load, stiffness) * (1.0 + alpha * warming)
    low, high = 0.2 * found, 3.0 * found
    for _ in range(200):
        middle = 0.5 * (low + high)
        if _catenary_length(middle, span, load + ice, stiffness) > unstrained:
            low = middle
        else:
            high = middle
    assert found == pytest.approx(middle, rel=1e-3)


def test_state_equation_without_change() -> None:
    """Neither warming nor load: the tension stays, to rounding."""
    assert fixed_wire_tension(1e4, 50.0, 1e7, (9.0, 9.0), 0.0) == pytest.approx(1e4, rel=1e-12)


def test_published_travel() -> None:
    """600 m warmed by 10 K travel 102 mm; weights 1:5 at 410 m rise 34.85 cm when 10 K colder.

    Source: Spanish course on NAE 107 (secondary); it prints -34.85 as a descent, while a shorter
    wire lifts the weights: here a negative travel is a rise.
    """
    assert 1e3 * thermal_travel(600.0, 1.7e-5, 10.0) == pytest.approx(102.0)
    assert 1e2 * weight_travel(410.0, 1.7e-5, -10.0, 5.0) == pytest.approx(-34.85)


def test_tension_along_hinged_cantilevers() -> None:
    """Summing the turned cantilevers one by one nears the closed form with its feedback."""
    tension, span, radius, arm, strain, supports = 15e3, 1.0, 800.0, 3.0, 17e-6 * 40.0, 600
    summed = tension
    for number in range(supports, 0, -1):
        travelled = strain * number * span
        summed -= summed * span / radius * travelled / arm
    closed = tension_at_fixed_point(tension, supports * span, strain, radius, arm)
    assert summed == pytest.approx(closed, rel=2e-4)
    pushed = tension_at_fixed_point(tension, supports * span, strain, -radius, arm)
    assert pushed > tension > closed


def test_friction_loop() -> None:
    """The loop between lifting (T/eta) and lowering (T eta) is closed by both tensions."""
    assert friction_loop(10e3, 0.95) == pytest.approx(10e3 / 0.95 - 10e3 * 0.95)
    assert friction_loop(10e3, 1.0) == 0.0


def test_wind_load() -> None:
    """30 m/s at 1.25 kg/m3 press with 562.5 N/m2; a wire of 12 mm and drag 1.1 takes 7.4 N/m."""
    pressure = dynamic_pressure(30.0)
    assert pressure == pytest.approx(562.5)
    assert wind_load(pressure, 0.012, 1.1) == pytest.approx(7.425)
