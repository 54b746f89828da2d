"""AC simple against the world benchmark 2015, the paper and the remembered EN 50318:2018 ranges.

The values of the benchmark and of the paper are those of Tables 1 and 2 of Song, Ronnquist and
Navik (2021); the elasticities are checked in ``tests/verification/test_elasticity.py``. The line is
that of the library, of which no number was selected to meet a result; the calibrated plane reading
has its own tests at the end.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import pytest

import tautwire as tw
from tautwire.results.statistics import PantographStatistics, RunStatistics

Record = Callable[..., bool]

BENCHMARK = "world benchmark 2015, mean of ten codes (paper, Table 2)"
PAPER = "Song, Ronnquist, Navik 2021, own model (Table 2)"
TREND = "Song, Ronnquist, Navik 2021, section III.B"
REMEMBERED = "EN 50318:2018, remembered, not read"
BENCHMARK_SIGMA = {"0_2": 38.27, "0_5": 41.04, "5_20": 34.80, "0_20": 53.91}
PAPER_SIGMA = {"0_2": 38.25, "0_5": 41.00, "5_20": 32.99, "0_20": 52.59}
FINE = (15, "1 ms")
"""Mesh (nodes between droppers) and step of the comparisons."""


@cache
def statistics(
    speed: int = 320, mesh: tuple[int, str] = FINE, stiffness: str = "50 kN/m"
) -> RunStatistics:
    """Run AC simple once per condition; the guess saves a passage, nothing else."""
    guess = 1.1 * (70.0 + 0.00097 * speed**2)
    changes = {
        "settings.nodes_between_droppers": mesh[0],
        "settings.time_step": mesh[1],
        "settings.contact_stiffness": stiffness,
        "scenario.uplift_guess": round(guess, 1),
    }
    return _statistics("ac-simple", speed, changes)


@cache
def plane(speed: int = 320, stiffness: str = "200 kN/m") -> RunStatistics:
    """Run the plane reading once per condition, on the mesh that it was calibrated with."""
    guess = "157.1 N" if speed == 275 else "187.0 N"
    changes = {
        "settings.nodes_between_droppers": 9,
        "settings.time_step": "1 ms",
        "settings.contact_stiffness": stiffness,
        "scenario.uplift_guess": guess,
    }
    return _statistics("ac-simple-plane", speed, changes)


def _statistics(name: str, speed: int, changes: dict[str, Any]) -> RunStatistics:
    run = tw.run(name, speed=f"{speed} km/h", overrides=changes)
    assert run.status == "done"
    return tw.contact_statistics(run)


def reference_line() -> PantographStatistics:
    """Return the reference condition: 320 km/h, as in the library, 15 nodes between droppers."""
    return statistics().pantograph()


def test_mean_force_is_tuned() -> None:
    """The tuned mean force is the benchmark's 169 N within 0.5 N."""
    assert reference_line().sharp.mean == pytest.approx(169.0, abs=0.5)


def test_contact_is_never_lost(record_validation: Record) -> None:
    """No contact is lost on the ideal line, as in the benchmark and in the paper (V.B)."""
    assert record_validation(
        "AC simple, 320 km/h",
        "losses of contact",
        ours=reference_line().contact_loss.count,
        unit="1",
        target=0.0,
        absolute=0.0,
        source="Song, Ronnquist, Navik 2021, section V.B",
    )


@pytest.mark.parametrize(
    ("source", "published", "relative"),
    [(BENCHMARK, BENCHMARK_SIGMA, 0.06), (PAPER, PAPER_SIGMA, 0.03)],
    ids=["benchmark", "paper"],
)
def test_standard_deviations(
    source: str, published: dict[str, float], relative: float, record_validation: Record
) -> None:
    """All four standard deviations are within 6 % of the benchmark and 3 % of the paper (sharp)."""
    for band, target in published.items():
        assert record_validation(
            "AC simple, 320 km/h",
            f"σ({band.replace('_', '-')} Hz), sharp",
            ours=reference_line().sharp.standard_deviations[band],
            unit="N",
            target=target,
            relative=relative,
            source=source,
        )


def test_largest_force(record_validation: Record) -> None:
    """The largest force at 320 km/h is just within 6 % of the benchmark's mean: see the note."""
    ours = reference_line().sharp.maximum
    record_validation(
        "AC simple, 320 km/h",
        "Fmax, sharp",
        ours=ours,
        unit="N",
        target=313.22,
        relative=0.06,
        source=BENCHMARK,
        note="the steady arms decide: acting only vertically 25 N larger, with three times their "
        "mass 9 N; messenger wire held along the track 6 N larger; mesh and step below 1 N",
    )
    assert ours == pytest.approx(294.5, abs=1.0)


def test_smallest_force(record_validation: Record) -> None:
    """The smallest force at 320 km/h is within 10 N of the benchmark's mean with both filters."""
    for kind in ("sharp", "butterworth"):
        assert record_validation(
            "AC simple, 320 km/h",
            f"Fmin, {'sharp' if kind == 'sharp' else 'Butterworth'}",
            ours=reference_line().filtered[kind].minimum,
            unit="N",
            target=60.40,
            absolute=10.0,
            source=BENCHMARK,
        )


@pytest.mark.slow
@pytest.mark.parametrize("speed", [250, 275, 320])
def test_mesh_and_step_are_fine_enough(speed: int, record_validation: Record) -> None:
    """With elements and step of half the size σ(0-20) and the uplift move by less than 1 %."""
    usual, halved = (statistics(speed, own) for own in ((9, "1 ms"), (17, "0.5 ms")))
    for name, pair in {
        "σ(0-20 Hz), sharp": [s.pantograph().sharp.standard_deviation for s in (usual, halved)],
        "Fmax, sharp": [s.pantograph().sharp.maximum for s in (usual, halved)],
        "largest uplift": [s.uplift.maximum for s in (usual, halved)],
    }.items():
        assert record_validation(
            f"AC simple, {speed} km/h, mesh and step halved",
            f"change of {name}",
            ours=100.0 * (pair[1] / pair[0] - 1.0),
            unit="%",
            target=0.0,
            absolute=1.0,
            source="the same line, 9 nodes between droppers and 1 ms",
        )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("band", "target", "note"),
    [
        (
            "0_20",
            -11.94,
            "hinged arms damp the resonance of the head that a stiffer contact removes",
        ),
        ("0_50", -6.08, ""),
        ("0_200", 16.67, ""),
    ],
)
def test_contact_stiffness(band: str, target: float, note: str, record_validation: Record) -> None:
    """From 50 to 500 kN/m σ falls below 20 and 50 Hz and rises to 200 Hz, by the paper's numbers
    within 3 percentage points but for 20 Hz, where it falls by 8.5 and not by 11.9 %."""
    soft, stiff = (
        statistics(stiffness=own).pantograph().sharp.standard_deviations[band]
        for own in ("50 kN/m", "500 kN/m")
    )
    change = 100.0 * (stiff / soft - 1.0)
    inside = record_validation(
        "AC simple, 320 km/h, contact stiffness from 50 to 500 kN/m",
        f"change of σ({band.replace('_', '-')} Hz), sharp",
        ours=change,
        unit="%",
        target=target,
        absolute=3.0,
        source=TREND,
        note=note,
    )
    assert inside == (band != "0_20")
    assert change == pytest.approx({"0_20": -8.5, "0_50": -3.5, "0_200": 17.7}[band], abs=0.3)


RANGES_275 = {
    "mean": ((141.5, 146.5), "N"),
    "0_20": ((31.9, 34.8), "N"),
    "0_5": ((26.4, 28.9), "N"),
    "5_20": ((16.2, 22.4), "N"),
    "Fmax": ((219.0, 244.0), "N"),
    "Fmin": ((71.0, 86.0), "N"),
    "uplift": ((42.0, 49.0), "mm"),
}
"""Remembered ranges of EN 50318:2018 at 275 km/h."""


def _at_275(found: RunStatistics, case: str, notes: dict[str, str], record: Record) -> list[str]:
    """Record the ranges at 275 km/h and return the names of those that are missed."""
    sharp = found.pantograph().sharp
    numbers = {
        **sharp.standard_deviations,
        "mean": sharp.mean,
        "Fmax": sharp.maximum,
        "Fmin": sharp.minimum,
        "uplift": 1e3 * float(found.uplift.uplift.max()),
    }
    titles = {"uplift": "largest uplift", "Fmax": "Fmax, sharp", "Fmin": "Fmin, sharp"}
    return [
        name
        for name, (allowed, unit) in RANGES_275.items()
        if not record(
            case,
            titles.get(name, name if name == "mean" else f"σ({name.replace('_', '-')} Hz), sharp"),
            ours=numbers[name],
            unit=unit,
            allowed=allowed,
            source=REMEMBERED,
            note=notes.get(name, ""),
        )
    ]


@pytest.mark.slow
def test_ranges_at_275_kmh(record_validation: Record) -> None:
    """At 275 km/h the standard deviations lie off remembered edges by up to 1.1 N, the rest
    inside."""
    resonance = (
        "droppers are passed at 13.3 Hz, the head on a contact spring of 50 kN/m resonates at "
        "13.9 Hz; with 200 kN/m it lies inside"
    )
    notes = {
        "5_20": resonance,
        "0_20": resonance,
        "0_5": "0.3 N below a remembered edge; an independent plane model gives 25.6 N",
    }
    found = statistics(275)
    assert _at_275(found, "AC simple, 275 km/h", notes, record_validation) == [
        "0_20",
        "0_5",
        "5_20",
    ]
    sharp = found.pantograph().sharp.standard_deviations
    assert sharp["5_20"] == pytest.approx(23.5, abs=0.2)
    assert sharp["0_5"] == pytest.approx(26.1, abs=0.2)
    stiffer = statistics(275, stiffness="200 kN/m").pantograph().sharp.standard_deviations
    assert 16.2 <= stiffer["5_20"] <= 22.4


# The plane reading: steady arms that act vertically only, contact stiffness calibrated.


@pytest.mark.slow
@pytest.mark.parametrize(
    ("band", "relative"), [("0_2", 0.03), ("0_5", 0.03), ("0_20", 0.03), ("5_20", 0.05)]
)
def test_plane_reading(band: str, relative: float, record_validation: Record) -> None:
    """The plane reading meets the benchmark below 20 Hz, for which it was calibrated."""
    assert record_validation(
        "AC simple, plane, 320 km/h, contact stiffness 200 kN/m (calibrated)",
        f"σ({band.replace('_', '-')} Hz), sharp",
        ours=plane().pantograph().sharp.standard_deviations[band],
        unit="N",
        target=BENCHMARK_SIGMA[band],
        relative=relative,
        source=BENCHMARK,
    )


@pytest.mark.slow
def test_plane_reading_loses_contact(record_validation: Record) -> None:
    """The plane reading loses contact on the ideal line, which the benchmark and the paper do not:
    vertical arms and a stiff contact cancel below 20 Hz and not above."""
    count = plane().pantograph().contact_loss.count
    inside = record_validation(
        "AC simple, plane, 320 km/h, contact stiffness 200 kN/m (calibrated)",
        "losses of contact",
        ours=count,
        unit="1",
        target=0.0,
        absolute=0.0,
        source="Song, Ronnquist, Navik 2021, section V.B",
        note="two departures cancel below 20 Hz and not above",
    )
    assert not inside
    assert count == 6


@pytest.mark.slow
def test_plane_table_2_of_the_paper(record_validation: Record) -> None:
    """With 500 kN/m the plane reading has the paper's standard deviations within 1 %, but for
    σ(5-20): the paper's own scheme, without wave correction, has it within 0.2 %."""
    ours = plane(stiffness="500 kN/m").pantograph().sharp.standard_deviations
    notes = {
        "5_20": "33.0 N in the paper's plain Newmark scheme: the step of 1 ms took 0.5 N away, "
        "which the wave correction gives back"
    }
    for band, target in PAPER_SIGMA.items():
        inside = record_validation(
            "AC simple, plane, 320 km/h, contact stiffness 500 kN/m",
            f"σ({band.replace('_', '-')} Hz), sharp",
            ours=ours[band],
            unit="N",
            target=target,
            relative=0.01,
            source=PAPER,
            note=notes.get(band, ""),
        )
        assert inside == (band not in notes)
    assert ours["5_20"] == pytest.approx(33.59, abs=0.1)


@pytest.mark.slow
def test_plane_nominal_contact_stiffness(record_validation: Record) -> None:
    """With 50 kN/m and vertical arms σ(5-20) is 26 % too large: the head resonates at 14 Hz, and
    nothing takes the energy away."""
    ours = plane(stiffness="50 kN/m").pantograph().sharp.standard_deviations
    inside = record_validation(
        "AC simple, plane, 320 km/h, contact stiffness 50 kN/m",
        "σ(5-20 Hz), sharp",
        ours=ours["5_20"],
        unit="N",
        target=34.80,
        relative=0.05,
        source=BENCHMARK,
        note="the head on the contact spring resonates at 14 Hz, inside the band",
    )
    assert not inside
    assert ours["5_20"] == pytest.approx(43.9, abs=0.5)
    assert ours["0_5"] == pytest.approx(41.04, rel=0.03)


@pytest.mark.slow
def test_plane_ranges_at_275_kmh(record_validation: Record) -> None:
    """At 275 km/h all but σ(0-5) of the plane reading lie in the remembered ranges."""
    notes = {"0_5": "0.4 N below a remembered edge; an independent plane model gives 25.6 N"}
    found = plane(275)
    case = "AC simple, plane, 275 km/h, contact stiffness 200 kN/m (calibrated)"
    assert _at_275(found, case, notes, record_validation) == ["0_5"]
    assert found.pantograph().sharp.standard_deviations["0_5"] == pytest.approx(26.0, abs=0.2)
