"""Closed forms of waves on the wires, with published numbers."""

from __future__ import annotations

import json
import math

import pytest

from tautwire.assessment.wave_quantities import (
    amplification_factor,
    doppler_factor,
    midspan_elasticity,
    passing_lengths,
    reflection_coefficient,
    wave_quantities,
)
from tautwire.line.expand import expand
from tautwire.specs.case import Case

from .synthetic import make_case

TENSION = 1500.0 * 9.81
"""1500 kgf with the g of the published table [N]."""

NAD_9 = {"contact_stiffness": 5e4, "nodes_between_droppers": 9}

WAVE_SPEED = math.sqrt(TENSION / 1.082)
"""Of the contact wire CTHA-120 [m/s]."""


def test_doppler_factor_of_the_published_table() -> None:
    """CTHA-120 (1.082 kg/m, 1500 kgf) at 160 km/h: 0.448109994 (theory, section 9)."""
    doppler = doppler_factor(160.0 / 3.6, WAVE_SPEED)
    assert doppler == pytest.approx(0.448109994, abs=1e-9)


@pytest.mark.parametrize(
    ("mass", "kilograms", "published"),
    [(0.647, 1500.0, 0.973141086), (0.647, 1000.0, 0.86367892), (0.883, 1500.0, 1.059152193)],
)
def test_amplification_factor_of_the_published_table(
    mass: float, kilograms: float, published: float
) -> None:
    """Three messenger wires over the same contact wire at 160 km/h."""
    reflection = reflection_coefficient(TENSION, 1.082, kilograms * 9.81, mass)
    doppler = doppler_factor(160.0 / 3.6, WAVE_SPEED)
    assert amplification_factor(reflection, doppler) == pytest.approx(published, abs=1e-8)


def test_amplification_at_the_wave_speed_is_infinite() -> None:
    """At the wave speed the Doppler factor is zero and waves grow without limit."""
    assert doppler_factor(100.0, 100.0) == 0.0
    assert math.isinf(amplification_factor(0.5, 0.0))


def test_wave_speed_of_the_benchmark() -> None:
    """Contact wire of 22 kN and 1.35 kg/m: 127.66 m/s."""
    assert make_case().wires.contact.wave_speed() == pytest.approx(127.66, abs=0.005)


def test_midspan_elasticity_of_the_benchmark() -> None:
    """The rule gives 0.362 mm/N for 55 m and 22 + 16 kN, 10 % under the benchmark's 0.400."""
    assert midspan_elasticity(55.0, 22e3, 16e3) == pytest.approx(0.362e-3, abs=5e-7)


def test_sheet_of_the_benchmark() -> None:
    """At 320 km/h v/c = 0.696, spans pass at 1.62 Hz, droppers at 15.46 Hz, elements at 124 Hz.

    Sources: the paper's section III.A for elements; theory, section 6 for the contact resonance.
    """
    rows = {row.name: row for row in wave_quantities(make_case(settings=NAD_9))}
    assert rows["speed over wave speed"].value == pytest.approx(0.6963, abs=1e-4)
    assert rows["0.7 of the wave speed"].value * 3.6 == pytest.approx(321.7, abs=0.05)
    assert rows["passing of the span"].value == pytest.approx(1.616, abs=1e-3)
    assert rows["passing of the dropper interval"].value == pytest.approx(15.46, abs=5e-3)
    assert rows["passing of the support-dropper interval"].value == pytest.approx(19.75, abs=5e-3)
    element = rows["passing of the longest element of the contact wire (numerical)"]
    assert element.value == pytest.approx(123.67, abs=0.01)
    assert rows["head of front on the contact spring"].unit == "Hz"
    assert all(row.formula for row in rows.values())
    json.dumps([row.as_dict() for row in rows.values()], allow_nan=False)


def test_head_resonance_of_the_benchmark_pantograph() -> None:
    """A head of 7.5 kg resonates at 14, 26.5 and 41 Hz on 50, 200 and 500 kN/m."""
    stages = [{"mass": 7.5, "stiffness": 7000.0}, {"mass": 6.0, "stiffness": 160.0}]
    values = []
    for stiffness in (5e4, 2e5, 5e5):
        case = make_case(settings={"contact_stiffness": stiffness}).with_(
            pantographs=[{"name": "front", "stages": stages}]
        )
        row = next(r for r in wave_quantities(case) if r.name.startswith("head of"))
        values.append(row.value)
    assert values == pytest.approx([14.0, 26.5, 41.0], rel=0.012)


def test_passing_lengths_of_a_line() -> None:
    """Span, the most frequent dropper interval and the interval beside the supports."""
    lengths = passing_lengths(make_case(), expand(make_case()))
    assert lengths == {
        "span": 55.0,
        "dropper interval": 5.75,
        "support-dropper interval": 4.5,
    }


def test_midspan_estimate_without_droppers() -> None:
    """A contact wire alone counts by its own tension: 40 m under 12.3 kN, L/(4 T) = 0.813 mm/N."""
    data = make_case().to_dict()
    data["wires"] = {"contact": {**data["wires"]["contact"], "tension": 12.3e3}}
    del data["droppers"]
    data["line"]["span_length"] = 40.0
    rows = {row.name: row for row in wave_quantities(Case.model_validate(data))}
    assert rows["mid-span elasticity, estimate"].value == pytest.approx(40.0 / (4.0 * 12.3e3))
