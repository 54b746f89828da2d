"""The line's own lengths, pre-sag spectra, named peaks, and the cut-off that follows."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tautwire.analyses.force.cutoff import advise_cutoff, missed_deviation
from tautwire.analyses.vibration.contact_wire import even_points, wavenumber_spectrum
from tautwire.analyses.vibration.wavelengths import (
    line_lengths,
    name_peaks,
    presag_spectrum,
)
from tautwire.assessment.wave_quantities import passing_lengths
from tautwire.errors import InputError
from tautwire.inputs.load import load_case
from tautwire.line.expand import expand
from tautwire.report.figures import style
from tautwire.report.figures.force_figures import passings
from tautwire.results.equilibrium import Equilibrium
from tautwire.signals.filters import Butterworth
from tautwire.signals.spectra import amplitude_spectrum
from tautwire.specs.case import Case

from ..lines import ac_simple, found
from .synthetic import make_case, make_run


@pytest.fixture(scope="module")
def shape() -> Equilibrium:
    """Static state of five spans of AC simple."""
    return found(ac_simple(line__spans=5, settings__nodes_between_droppers=5))[1]


def test_lengths_of_the_reference_line() -> None:
    """AC simple: DD 5.75 m, SD 4.5 m, and with NAD 9 elements of 0.72 and 0.56 m (paper III.A)."""
    lengths = line_lengths(load_case("ac-simple", {"settings.nodes_between_droppers": 9}))
    named = lengths.named()
    assert named["span"] == 55.0
    assert named["DD"] == pytest.approx(5.75)
    assert named["SD/4"] == pytest.approx(1.125)
    assert lengths.elements == pytest.approx((0.71875, 0.5625))
    assert lengths.shortest == pytest.approx(4.5)


@pytest.mark.parametrize(
    ("nad", "frequencies"),
    [(9, (123.67, 158.02)), (12, (170.05, 217.28)), (15, (216.43, 276.54)), (18, (262.80, 335.80))],
)
def test_element_passing_frequencies(nad: int, frequencies: tuple[float, float]) -> None:
    """All eight element-passing frequencies of section III.A follow from v/L_e at 320 km/h."""
    case = load_case("ac-simple", {"settings.nodes_between_droppers": nad})
    passed = [case.scenario.speed / length for length in line_lengths(case).elements]
    assert passed == pytest.approx(frequencies, rel=1e-4)


def test_line_without_droppers() -> None:
    """Without droppers the span is the only length."""
    case = load_case("ac-simple")
    bare = case.with_(**{"droppers.positions": (), "droppers.presag": ()})
    lengths = line_lengths(bare)
    assert lengths.dropper_interval is None
    assert lengths.shortest == 55.0
    assert set(lengths.named(elements=False)) == {"span"}


@pytest.mark.parametrize(
    ("speed", "cutoff"), [(200, 50.0), (225, 56.25), (250, 62.5), (275, 68.75), (320, 80.0)]
)
def test_advised_cutoff(speed: int, cutoff: float) -> None:
    """0.9 1/m times the speed: the five cut-offs of section IV.C."""
    case = load_case("ac-simple", {"scenario.speed": f"{speed} km/h"})
    advice = advise_cutoff(case)
    assert advice.wavenumber == pytest.approx(0.9)
    assert advice.frequency == pytest.approx(cutoff)


def test_missed_deviation() -> None:
    """What a cut-off misses is told against sigma(0-200), for either filter."""
    run = make_run(make_case(spans=8))
    sharp = missed_deviation(run)
    assert sharp.cutoff == pytest.approx(80.0)
    assert 0.0 < sharp.standard <= sharp.advised <= sharp.widest
    assert sharp.missed == pytest.approx(1.0 - sharp.advised / sharp.widest)
    assert sharp.missed_by_20_hz >= sharp.missed
    smooth = missed_deviation(run, "front", Butterworth())
    assert "Butterworth" in smooth.filter
    told = replace(smooth, widest=math.nan).as_dict()
    assert told["advised_cutoff_hz"] == pytest.approx(80.0)
    assert (told["std_0_20_n"], told["std_0_200_n"]) == (smooth.standard, None)
    assert (told["missed"], told["missed_by_20_hz"]) == (None, None)


def test_even_points_lie_on_the_wire(shape: Equilibrium) -> None:
    """Points are even along the track and interpolate positions exactly at the stations."""
    points = even_points(shape)
    assert np.diff(points.s) == pytest.approx(points.spacing)
    assert points.values(shape.position, 0) == pytest.approx(points.s, abs=1e-9)
    heights = np.interp(shape.contact.s, points.s, points.heights(shape.position))
    assert heights == pytest.approx(shape.contact_position[:, 2], abs=2e-3)


def test_wavenumber_spectrum_of_a_sine() -> None:
    """A sine of amplitude 3 and wavelength 2.5 m shows as a line of height 3 at 0.4 1/m."""
    x = np.arange(1000) * 0.05
    spectrum = wavenumber_spectrum(3.0 * np.sin(2.0 * math.pi * x / 2.5), 0.05)
    at = int(np.argmax(spectrum.value))
    assert spectrum.wavelength[at] == pytest.approx(2.5)
    assert spectrum.value[at] == pytest.approx(3.0)
    density = wavenumber_spectrum(3.0 * np.sin(2.0 * math.pi * x / 2.5), 0.05, density=True)
    assert density.value.sum() * density.resolution == pytest.approx(4.5, rel=0.01)


def test_presag_is_a_comb(shape: Equilibrium) -> None:
    """The ideal line is periodic: its pre-sag holds multiples of one per span and nothing else."""
    spectrum = presag_spectrum(shape, (2, 4), window="none")
    order = spectrum.abscissa * 55.0
    on_comb = np.abs(order - np.round(order)) < 1e-6
    assert spectrum.value[~on_comb].max() < 0.02 * spectrum.value.max()
    peaks = name_peaks(spectrum, {"span": 55.0, "DD/2": 2.875})
    assert "span" in {peak.name for peak in peaks}


def test_presag_peaks_at_the_dropper_interval(shape: Equilibrium) -> None:
    """On the comb of the span, DD/2 is the 19th multiple and stands out (paper, Fig. 11a)."""
    spectrum = presag_spectrum(shape, (2, 4), window="none")
    order = spectrum.abscissa * 55.0
    below, peak, above = (spectrum.value[np.abs(order - n).argmin()] for n in (18, 19, 20))
    assert peak > 2.0 * max(below, above)


def test_section_off_the_line_is_refused(shape: Equilibrium) -> None:
    """A section beyond the last span is refused."""
    with pytest.raises(InputError, match="section"):
        presag_spectrum(shape, (2, 9))


def test_peaks_are_named() -> None:
    """Peaks of a force spectrum are named by the length whose passing explains them."""
    time, speed = np.arange(8192) * 1e-3, 80.0
    force = 5.0 * np.sin(2.0 * math.pi * (speed / 5.75) * time)
    force += 2.0 * np.sin(2.0 * math.pi * 61.0 * time)
    spectrum = amplitude_spectrum(force, 1e-3)
    peaks = name_peaks(spectrum, {"DD": 5.75, "SD": 4.5}, speed=speed, count=2)
    assert [peak.name for peak in peaks] == ["DD", ""]
    assert peaks[1].abscissa == pytest.approx(61.0, abs=0.2)
    with pytest.raises(InputError, match="speed"):
        name_peaks(spectrum, {"DD": 5.75})


PAIRS = [5.0, 14.4, 14.9, 28.6, 29.1, 30.0 + 12.6, 43.1, 53.0]
"""Droppers in pairs half a metre apart [m], alone at both ends of a span of 58 m."""


def pairs_line() -> Case:
    """Return a line whose droppers hang in pairs."""
    return ac_simple(line__span_length=58.0, droppers__positions=PAIRS, droppers__presag=[0.0] * 8)


def test_pairs_of_droppers_are_passed_as_one() -> None:
    """DD is the distance of the pairs' middles, SD that of the first dropper."""
    lengths = line_lengths(pairs_line())
    assert lengths.dropper_interval == pytest.approx(14.2, abs=0.21)
    assert lengths.support_interval == 5.0
    assert lengths.shortest == 5.0
    assert line_lengths(ac_simple()).dropper_interval == 5.75


@pytest.mark.parametrize("name", ["ac-simple-overlap", "ac-simple-curve"])
def test_an_overlap_has_the_lengths_of_its_line(name: str) -> None:
    """What raises a wire at a support of an overlap is no dropper that a pantograph passes."""
    found = line_lengths(load_case(name)).named(elements=False)
    assert found == line_lengths(load_case("ac-simple")).named(elements=False)
    assert line_lengths(load_case(name)).shortest == 4.5


def test_check_advice_and_report_name_the_same_lengths() -> None:
    """On unequal spans wave quantities, advice and spectrum mark the same span, DD and SD."""
    spans = [50.0, 50.0, 60.0, 50.0, 60.0, 50.0, 45.0]
    rows = [[4.0, 13.0, 22.0, 31.0, 40.0]] * 7
    case = ac_simple(
        line__spans=7, line__span_length=spans, settings__section=[2, 6],
        droppers__positions=rows, droppers__presag=[[0.0] * 5] * 7,
    )  # fmt: skip
    lengths, passed = line_lengths(case), passing_lengths(case, expand(case))
    assert passed == {
        "span": lengths.span,
        "dropper interval": lengths.dropper_interval,
        "support-dropper interval": lengths.support_interval,
    }
    assert lengths.span == 50.0
    view: Any = SimpleNamespace(
        run=SimpleNamespace(case=case),
        statistics=SimpleNamespace(section=SimpleNamespace(first_span=2, last_span=6)),
    )
    assert {line.length for line in passings(view) if line.order == 1} == set(passed.values())


@pytest.mark.parametrize(("span", "labels"), [(72.0, (72.0, 20.0)), (30.0, (30.0, 10.0))])
def test_wavelength_axis_begins_with_the_span(span: float, labels: tuple[float, float]) -> None:
    """The first label is the line's own span; round numbers follow well below it."""
    assert style.wavelengths(span)[:2] == labels
