"""AC simple against the world benchmark 2015, the paper and the remembered EN 50318:2018 ranges.

The values of the benchmark and of the paper are those of Tables 1 and 2 of Song, Ronnquist and
Navik (2021); the elasticities are checked in ``tests/verification/test_elasticity.py``.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import pytest

import tautwire as tw
from tautwire.results.statistics import PantographStatistics, RunStatistics

Record = Callable[..., bool]

BENCHMARK = "world benchmark 2015, mean of ten codes (paper, Table 2)"
PAPER = "Song, Ronnquist, Navik 2021, own model (Table 2)"
REMEMBERED = "EN 50318:2018, remembered, not read"
BANDS = ("0_2", "0_5", "5_20", "0_20")


@cache
def statistics(speed: str, stiffness: str, guess: str) -> RunStatistics:
    """Run AC simple once per condition; the guess saves a passage, nothing else."""
    changes = {"settings.contact_stiffness": stiffness, "scenario.uplift_guess": guess}
    run = tw.run("ac-simple", speed=speed, overrides=changes)
    assert run.status == "done"
    return tw.contact_statistics(run)


def benchmark() -> PantographStatistics:
    """Return the reference condition: 320 km/h, contact stiffness 200 kN/m."""
    return statistics("320 km/h", "200 kN/m", "182.4 N").pantograph()


def test_mean_force_is_tuned() -> None:
    """The tuned mean force is the benchmark's 169 N within 0.5 N."""
    assert benchmark().sharp.mean == pytest.approx(169.0, abs=0.5)


@pytest.mark.parametrize(
    ("band", "target", "relative"),
    [("0_2", 38.27, 0.03), ("0_5", 41.04, 0.03), ("0_20", 53.91, 0.03), ("5_20", 34.80, 0.05)],
)
def test_standard_deviation(
    band: str, target: float, relative: float, record_validation: Record
) -> None:
    """Standard deviations at 320 km/h and 200 kN/m are those of the benchmark (sharp filter)."""
    assert record_validation(
        "AC simple, 320 km/h, contact stiffness 200 kN/m",
        f"σ({band.replace('_', '-')} Hz), sharp",
        ours=benchmark().sharp.standard_deviations[band],
        unit="N",
        target=target,
        relative=relative,
        source=BENCHMARK,
    )


def test_largest_force(record_validation: Record) -> None:
    """The largest force at 320 km/h is within 6 % of the benchmark's mean (sharp filter)."""
    assert record_validation(
        "AC simple, 320 km/h, contact stiffness 200 kN/m",
        "Fmax, sharp",
        ours=benchmark().sharp.maximum,
        unit="N",
        target=313.22,
        relative=0.06,
        source=BENCHMARK,
    )


def test_smallest_force(record_validation: Record) -> None:
    """The smallest force at 320 km/h is within 10 N of the benchmark's mean (Butterworth)."""
    assert record_validation(
        "AC simple, 320 km/h, contact stiffness 200 kN/m",
        "Fmin, Butterworth",
        ours=benchmark().butterworth.minimum,
        unit="N",
        target=60.40,
        absolute=10.0,
        source=BENCHMARK,
    )


@pytest.mark.slow
def test_table_2_of_the_paper(record_validation: Record) -> None:
    """With 500 kN/m the standard deviations are those of the paper's own model within 1 %."""
    ours = statistics("320 km/h", "500 kN/m", "182.4 N").pantograph().sharp.standard_deviations
    for band, target in zip(BANDS, (38.25, 41.00, 32.99, 52.59), strict=True):
        assert record_validation(
            "AC simple, 320 km/h, contact stiffness 500 kN/m",
            f"σ({band.replace('_', '-')} Hz), sharp",
            ours=ours[band],
            unit="N",
            target=target,
            relative=0.01,
            source=PAPER,
        )


@pytest.mark.slow
def test_nominal_contact_stiffness(record_validation: Record) -> None:
    """With 50 kN/m the head resonates on the contact spring at 14 Hz: σ(5-20) is 26 % too large."""
    ours = statistics("320 km/h", "50 kN/m", "183.0 N").pantograph().sharp.standard_deviations
    inside = record_validation(
        "AC simple, 320 km/h, contact stiffness 50 kN/m",
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
def test_ranges_at_275_kmh(record_validation: Record) -> None:
    """At 275 km/h all but σ(0-5) lie in the remembered ranges; σ(0-5) lies 0.4 N below."""
    found = statistics("275 km/h", "200 kN/m", "152.6 N")
    sharp = found.pantograph().sharp
    rows = {
        "mean": (sharp.mean, (141.5, 146.5), "N"),
        "σ(0-20 Hz), sharp": (sharp.standard_deviations["0_20"], (31.9, 34.8), "N"),
        "σ(0-5 Hz), sharp": (sharp.standard_deviations["0_5"], (26.4, 28.9), "N"),
        "σ(5-20 Hz), sharp": (sharp.standard_deviations["5_20"], (16.2, 22.4), "N"),
        "Fmax, sharp": (sharp.maximum, (219.0, 244.0), "N"),
        "Fmin, sharp": (sharp.minimum, (71.0, 86.0), "N"),
        "largest uplift": (1e3 * float(found.uplift.uplift.max()), (42.0, 49.0), "mm"),
    }
    notes = {
        "σ(0-5 Hz), sharp": "0.4 N below a remembered edge; an independent plane model gives 25.6 N"
    }
    missed = [
        name
        for name, (ours, allowed, unit) in rows.items()
        if not record_validation(
            "AC simple, 275 km/h, contact stiffness 200 kN/m",
            name,
            ours=ours,
            unit=unit,
            allowed=allowed,
            source=REMEMBERED,
            note=notes.get(name, ""),
        )
    ]
    assert missed == ["σ(0-5 Hz), sharp"]
    assert sharp.standard_deviations["0_5"] == pytest.approx(26.0, abs=0.2)
