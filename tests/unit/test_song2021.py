"""Reproduction of Song et al. (2021): the rule of the verdict, and the measures it rests on."""

from __future__ import annotations

import numpy as np
import pytest

from tautwire.reproductions.song2021 import mesh, published, sources, steps
from tautwire.reproductions.song2021.claims import (
    CONDITIONAL,
    NO_VALUE,
    NOT_REPRODUCED,
    REPRODUCED,
    Claim,
    Evidence,
    counts,
    least,
    most,
    near,
)
from tautwire.reproductions.song2021.forces import Comb, comb
from tautwire.reproductions.song2021.passages import (
    FULL,
    MESHES,
    QUICK,
    SPEEDS,
    STIFFNESSES,
    passage_study,
    passages,
    standard,
)
from tautwire.signals.spectra import amplitude_spectrum
from tautwire.studies.plan import plan_study


def claim(*evidence: Evidence) -> Claim:
    return Claim("name", "II", "statement", evidence)


def test_verdict_follows_the_rule() -> None:
    """All conditions keep all limits, some do, none does, or there is no number."""
    kept, broken = most("soft", "a", 1.0, 2.0), least("stiff", "a", 1.0, 2.0)
    also_soft = least("soft", "b", 1.0, 2.0)
    assert claim(kept).verdict == REPRODUCED
    assert claim(kept, broken).verdict == CONDITIONAL
    assert claim(kept, also_soft).verdict == NOT_REPRODUCED
    assert claim(kept, also_soft, broken).verdict == NOT_REPRODUCED
    assert claim().verdict == NO_VALUE
    assert claim(kept, broken).explanation == "holds for: soft. Not for: stiff."


def test_number_that_is_missing_keeps_no_limit() -> None:
    """NaN is never evidence for a claim."""
    assert not most("", "a", float("nan"), 1.0).holds
    assert claim(near("", "a", float("nan"), 1.0, 0.1)).verdict == NOT_REPRODUCED
    assert near("", "a", float("nan"), 1.0, 0.1).as_dict()["found"] is None


@pytest.mark.parametrize(("found", "holds"), [(98.1, True), (97.9, False), (102.1, False)])
def test_near_is_relative_to_the_published_number(found: float, holds: bool) -> None:
    """Two per cent of 100 are 98 to 102."""
    item = near("", "a", found, 100.0, 0.02)
    assert item.holds is holds
    assert item.requirement == "98 to 102"


def test_counts_are_in_the_order_of_the_verdicts() -> None:
    """Verdicts that do not occur are left out."""
    kept, broken = most("soft", "a", 1.0, 2.0), most("soft", "a", 3.0, 2.0)
    found = counts([claim(broken), claim(kept), claim(kept)])
    assert list(found.items()) == [(REPRODUCED, 2), (NOT_REPRODUCED, 1)]


def test_every_passage_of_both_scopes_is_a_valid_case() -> None:
    """Section III needs four meshes and six stiffnesses, IV.C five speeds; quick is smaller."""
    wanted = {standard(9, k) for k in STIFFNESSES} | {standard(m, 500) for m in MESHES}
    for scope in (FULL, QUICK):
        listed = passages(scope)
        assert wanted | {standard(scope.mesh, 500, v) for v in SPEEDS} <= set(listed)
        plan = plan_study(passage_study(listed))
        assert [point.problems for point in plan.points if point.problems] == []
        assert len(plan.by_key) == len(listed), "no two passages are the same case"
    assert len(passages(QUICK)) < len(passages(FULL)) / 2


def test_half_element_is_twice_the_first_frequency() -> None:
    """Section III.A: the peak around 250 Hz of NAD 9 is n = 2 of 123.67 Hz."""
    exact = 2.0 * published.ELEMENT_PASSING[9][0]
    assert exact == pytest.approx(published.HALF_ELEMENT, rel=0.02)


def test_comb_holds_the_amplitudes_of_a_periodic_signal() -> None:
    """A signal of two harmonics of 2 Hz gives those two lines."""
    time = np.arange(5000) * 1e-3
    signal = 3.0 * np.sin(2 * np.pi * 4.0 * time) + np.cos(2 * np.pi * 10.0 * time)
    found = comb(amplitude_spectrum(signal, 1e-3), 2.0, 20.0)
    assert found.abscissa.tolist() == [2, 4, 6, 8, 10, 12, 14, 16, 18, 20]
    assert found.value[[1, 4]] == pytest.approx([3.0, 1.0], rel=1e-6)
    assert found.spacing == 2.0


def test_ratio_compares_a_line_with_its_surroundings() -> None:
    """A line of 10 among lines of 2 has the ratio 5, and the lines beside it belong to it."""
    value = np.full(100, 2.0)
    value[50] = 10.0
    found = Comb(np.arange(1.0, 101.0), value)
    assert found.ratio(51.4) == pytest.approx(5.0)
    assert found.ratio(54.0) == pytest.approx(1.0)


def test_energy_outside_the_regions() -> None:
    """One line in a region and one of the same height outside share the energy."""
    value = np.zeros(60)
    value[19], value[29] = 1.0, 1.0
    found = Comb(np.arange(1.0, 61.0) / 55.0, value)
    energy, width = sources.outside_share(found, {"DD/2": 2.75})
    assert energy == pytest.approx(50.0)
    assert 80.0 < width < 100.0


def test_local_maximum_within_one_line() -> None:
    """A peak one line off counts, one two lines off does not."""
    value = np.ones(20)
    value[10] = 2.0
    found = Comb(np.arange(1.0, 21.0), value)
    assert sources.is_local_maximum(found, 12.0)
    assert not sources.is_local_maximum(found, 13.0)


def test_agreement_of_equal_and_of_shifted_combs() -> None:
    """Equal combs have all peaks in common, those shifted by one line none."""
    value = np.tile([1.0, 3.0, 2.0], 20)
    first = Comb(np.arange(1.0, 61.0) / 55.0, value)
    second = Comb(first.abscissa, np.roll(value, 1))
    assert sources.agreement(first, first)[0] == 100.0
    assert sources.agreement(first, second)[0] == 0.0


def test_losses_of_two_readings_are_put_into_rows() -> None:
    """Overlapping losses share a row; the error is relative to the reference."""
    exact = steps.Losses(np.array([1.0, 2.0]), np.array([1.004, 2.002]), np.array([4e-3, 2e-3]))
    rough = steps.Losses(np.array([1.001]), np.array([1.004]), np.array([3e-3]))
    found = steps.tabulate({"exact": exact, "rough": rough})
    assert found.time.tolist() == [1.0, 2.0]
    assert found.errors("rough", "exact") == pytest.approx([25.0])
    assert (found.missed("rough", "exact"), found.missed("exact", "rough")) == (1, 0)


def test_one_loss_beside_two_parts_of_it() -> None:
    """Two short losses under one long loss are one row, their durations added."""
    parts = steps.Losses(np.array([1.0, 1.003]), np.array([1.001, 1.004]), np.array([1e-3, 1e-3]))
    whole = steps.Losses(np.array([1.0]), np.array([1.004]), np.array([4e-3]))
    found = steps.tabulate({"parts": parts, "whole": whole})
    assert found.durations["parts"] == pytest.approx([2e-3])
    assert found.durations["whole"] == pytest.approx([4e-3])


def test_spread_is_relative_to_the_finest_mesh() -> None:
    """53, 51 and 50 N differ by 6 %."""
    assert mesh.spread(np.array([53.0, 51.0, 50.0])) == pytest.approx(6.0)
