"""Statistics of a run: section, bands, extremes, uplift, droppers, contact loss."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tautwire.analyses.force.contact_loss import contact_loss, nearest_place
from tautwire.analyses.force.section import analysed_section, time_in_section
from tautwire.analyses.force.spectrum import force_spectrum
from tautwire.analyses.force.statistics import contact_statistics, force_histogram
from tautwire.errors import InputError
from tautwire.results.droppers import DropperHistory
from tautwire.results.run import Run
from tautwire.signals.filters import Butterworth, SharpLowpass

from .synthetic import make_case, make_run

SECTION = (4, 13)


def with_record(run: Run, number: int = 0, **changes: Any) -> Run:
    """Return the run with some histories of one pantograph replaced."""
    records = list(run.pantographs)
    records[number] = replace(records[number], **changes)
    return replace(run, pantographs=tuple(records))


@pytest.fixture(scope="module")
def run() -> Run:
    """A passage at 320 km/h over 17 spans, one pantograph, no loss of contact."""
    return make_run(entering=True)


@pytest.fixture(scope="module")
def wave_run(run: Run) -> Run:
    """The passage with a force 169 + 50 sin(2 pi x / 55) + 30 sin(2 pi x / 5.75) N."""
    x = run.pantographs[0].position
    force = 169.0 + 50.0 * np.sin(2 * np.pi * x / 55.0) + 30.0 * np.sin(2 * np.pi * x / 5.75)
    return with_record(run, contact_force=force, gap=-force / 2e5)


def test_section_limits_are_supports(run: Run) -> None:
    """Spans 4 to 13 of 55 m reach from 165 m to 715 m, in 550 m / v seconds."""
    section = analysed_section(run)
    assert (section.first_span, section.last_span) == SECTION
    assert (section.start, section.end) == pytest.approx((165.0, 715.0))
    window = time_in_section(run, run.pantographs[0], section)
    assert window == pytest.approx((160.0 / (320.0 / 3.6), 710.0 / (320.0 / 3.6)))


@pytest.mark.parametrize("section", [(0, 3), (5, 4), (4, 18)])
def test_section_outside_the_line_is_refused(run: Run, section: tuple[int, int]) -> None:
    """A section that the line does not have is refused with the allowed spans."""
    with pytest.raises(InputError, match="from 1 to 17"):
        contact_statistics(run, section=section)


def test_standard_deviations_of_waves(wave_run: Run) -> None:
    """Amplitudes 50 N (1.62 Hz) and 30 N (15.46 Hz) give sigma = A / sqrt(2) in their bands.

    The Butterworth filter passes 0.957 of the second (gain of two passes at 15.46 Hz).
    """
    entry = contact_statistics(wave_run).pantograph("front")
    slow, fast = 50.0 / np.sqrt(2.0), 30.0 / np.sqrt(2.0)
    for kind, gain in (("sharp", 1.0), ("butterworth", 0.957)):
        part = entry.filtered[kind]
        assert part.mean == pytest.approx(169.0, abs=0.3)
        assert part.standard_deviations["0_5"] == pytest.approx(slow, rel=0.01)
        assert part.standard_deviations["5_20"] == pytest.approx(gain * fast, rel=0.01)
        assert part.standard_deviations["0_20"] == pytest.approx(
            np.hypot(slow, gain * fast), rel=0.01
        )
        assert part.standard_deviation == pytest.approx(part.standard_deviations["0_20"])
        assert part.statistical_maximum == pytest.approx(part.mean + 3 * part.standard_deviation)
        assert part.statistical_minimum == pytest.approx(part.mean - 3 * part.standard_deviation)
    assert entry.sharp.standard_deviations["0_2"] == pytest.approx(slow, rel=0.01)
    assert entry.sharp.maximum == pytest.approx(249.0, abs=1.5)
    assert entry.sharp.minimum == pytest.approx(89.0, abs=1.5)


def test_butterworth_loses_the_span_line_in_the_lowest_band(wave_run: Run) -> None:
    """At 2 Hz the Butterworth filter keeps 0.927 of the 1.616 Hz span line; the sharp keeps all."""
    part = contact_statistics(wave_run).pantograph().butterworth
    gain = 1.0 / (1.0 + (320.0 / 3.6 / 55.0 / 2.0) ** 12)
    assert gain == pytest.approx(0.927, abs=0.002)
    assert part.standard_deviations["0_2"] == pytest.approx(gain * 50.0 / np.sqrt(2), rel=0.01)


def test_the_record_outside_the_section_does_not_count(wave_run: Run) -> None:
    """A violent force in the last span leaves mean, sigma and extremes of the section alone."""
    record = wave_run.pantographs[0]
    wild = np.where(record.position > 880.0, 900.0, record.contact_force)
    calm = contact_statistics(wave_run).pantograph().butterworth
    other = contact_statistics(with_record(wave_run, contact_force=wild)).pantograph().butterworth
    assert other.mean == pytest.approx(calm.mean, abs=1e-3)
    assert other.standard_deviation == pytest.approx(calm.standard_deviation, abs=1e-3)
    assert other.maximum == pytest.approx(calm.maximum, abs=1e-3)


def test_mirrored_run_has_the_same_statistics(wave_run: Run) -> None:
    """A run in -x over the mirrored line has the mirrored spans' statistics, to rounding."""
    record = wave_run.pantographs[0]
    mirrored = with_record(wave_run, position=17 * 55.0 - record.position)
    there = contact_statistics(wave_run, section=(4, 13)).pantograph()
    back = contact_statistics(mirrored, section=(5, 14)).pantograph()
    assert back.sharp.mean == pytest.approx(there.sharp.mean, rel=1e-12)
    assert back.sharp.maximum == pytest.approx(there.sharp.maximum, rel=1e-12)
    assert [s.standard_deviation for s in back.sharp.per_span] == pytest.approx(
        [s.standard_deviation for s in reversed(there.sharp.per_span)], rel=1e-9
    )


def test_percentiles_histogram_and_spans_agree_with_the_extremes(run: Run) -> None:
    """Classes of 10 N add up to 1, percentiles lie between the extremes, spans hold them."""
    part = contact_statistics(run).pantograph().sharp
    levels = list(part.percentiles.values())
    assert list(part.percentiles) == [0.1, 1.0, 5.0, 50.0, 95.0, 99.0, 99.9]
    assert part.minimum <= levels[0]
    assert levels[-1] <= part.maximum
    assert levels == sorted(levels)
    assert part.histogram.share.sum() == pytest.approx(1.0)
    assert np.all(part.histogram.edges % 10.0 == 0.0)
    assert part.histogram.edges[0] <= part.minimum <= part.maximum <= part.histogram.edges[-1]
    assert [span.span for span in part.per_span] == list(range(4, 14))
    assert max(span.maximum for span in part.per_span) == part.maximum
    assert min(span.minimum for span in part.per_span) == part.minimum


def test_histogram_of_known_forces() -> None:
    """Forces 95, 101, 109 and 110 N lie in the classes from 90, 100 and 110 N."""
    histogram = force_histogram(np.array([95.0, 101.0, 109.0, 110.0]))
    assert histogram.edges.tolist() == [90.0, 100.0, 110.0, 120.0]
    assert histogram.share.tolist() == [0.25, 0.5, 0.25]


def test_headline_filter(run: Run) -> None:
    """The case's filter is the headline; a filter given to the call replaces its kind."""
    assert contact_statistics(run).pantograph().headline_kind == "sharp"
    given = contact_statistics(run, Butterworth(order=4, cutoff=18.0)).pantograph()
    assert given.headline is given.butterworth
    assert given.headline.cutoff == 18.0
    assert "order 4" in given.headline.description
    assert given.sharp.cutoff == 20.0
    sharp = contact_statistics(run, SharpLowpass(50.0)).pantograph().headline
    assert sharp.standard_deviation == pytest.approx(sharp.standard_deviations["0_50"])


def test_order_comes_from_the_case() -> None:
    """The order and the headline filter of the case's settings are used."""
    case = make_case(
        settings={"contact_stiffness": 2e5, "filter": "butterworth", "filter_order": 3}
    )
    entry = contact_statistics(make_run(case)).pantograph()
    assert entry.headline_kind == "butterworth"
    assert "order 3" in entry.headline.description


def test_coarse_steps_leave_bands_without_value() -> None:
    """With steps of 4 ms the band to 200 Hz has no value and a note says why."""
    stats = contact_statistics(make_run(time_step=4e-3))
    assert np.isnan(stats.pantograph().sharp.standard_deviations["0_200"])
    assert np.isfinite(stats.pantograph().sharp.standard_deviations["0_100"])
    assert any("0-200 Hz reach the Nyquist frequency" in note for note in stats.notes)


def test_steps_too_coarse_for_the_filter_are_refused() -> None:
    """With steps of 30 ms a force cannot be filtered at 20 Hz, and the message says so."""
    with pytest.raises(InputError, match="sample faster"):
        contact_statistics(make_run(time_step=0.03))


def test_uneven_steps_are_resampled(wave_run: Run) -> None:
    """A record with every second sample missing in one half gives the same sigma(0-5)."""
    keep = np.ones(wave_run.time.size, dtype=bool)
    keep[1:5000:2] = False
    record = wave_run.pantographs[0]
    names = ("position", "contact_force", "gap", "wire_height", "stage_heights", "active")
    thinned = replace(
        with_record(wave_run, **{name: getattr(record, name)[keep] for name in names}),
        time=wave_run.time[keep],
        support_uplift=wave_run.support_uplift[keep],
        droppers=DropperHistory.of_every_sample(wave_run.dropper_force[keep]),
    )
    full, thin = (contact_statistics(r).pantograph().sharp for r in (wave_run, thinned))
    assert thin.standard_deviations["0_5"] == pytest.approx(full.standard_deviations["0_5"], 1e-3)


def test_partial_run_says_what_it_covers() -> None:
    """A run cut at 5 s covers part of the section; one cut at 1 s has empty statistics."""
    cut = contact_statistics(make_run(status="partial", duration=5.0))
    assert np.isfinite(cut.pantograph().sharp.mean)
    assert any("covered only 165.0 m to 449." in note for note in cut.notes)
    assert np.isnan(cut.pantograph().sharp.per_span[-1].mean)
    short = contact_statistics(make_run(status="partial", duration=1.0))
    assert np.isnan(short.pantograph().sharp.mean)
    assert np.isnan(short.pantograph().contact_loss.percent)
    assert np.isnan(short.uplift.maximum)
    assert short.droppers.observed == 0.0
    assert any("never was in the analysed section" in note for note in short.notes)
    assert short.as_dict()["pantographs"][0]["sharp"]["mean_n"] is None


def test_pantograph_that_never_entered() -> None:
    """A pantograph that never entered gives empty statistics, not an error."""
    stats = contact_statistics(make_run(entering=False))
    assert np.isnan(stats.pantograph().sharp.maximum)
    assert stats.pantograph().contact_loss.count == 0
    json.dumps(stats.as_dict(), allow_nan=False)


def test_two_pantographs_have_their_own_statistics() -> None:
    """Every pantograph has its own record; an unknown name is refused with the names."""
    stats = contact_statistics(make_run(make_case(pantographs=2)))
    assert [entry.name for entry in stats.pantographs] == ["front", "rear"]
    assert stats.pantograph().name == "front"
    assert stats.pantograph("rear").sharp.mean != stats.pantograph("front").sharp.mean
    with pytest.raises(InputError, match="there are: front, rear"):
        stats.pantograph("back")


def test_uplift_is_the_largest_at_each_support_of_the_section(run: Run) -> None:
    """Supports 4 to 14 bound spans 4 to 13; a lift far outside the passage does not count."""
    history = np.zeros_like(run.support_uplift)
    history[:, 3] = 0.01
    history[4000, 7] = 0.06
    history[0, 8] = 0.5
    history[-1, 9] = 0.5
    history[4000, 1] = 0.5
    uplift = contact_statistics(replace(run, support_uplift=history)).uplift
    assert uplift.supports.tolist() == list(range(4, 15))
    assert uplift.uplift == pytest.approx([0.01, 0, 0, 0, 0.06, 0, 0, 0, 0, 0, 0], abs=1e-7)
    assert uplift.maximum == pytest.approx(0.06)


def test_uplift_of_the_limiting_supports_is_complete(run: Run) -> None:
    """The uplift of the support at a limit counts even when it peaks just after the passage."""
    history = np.zeros_like(run.support_uplift)
    after = int(np.searchsorted(run.pantographs[0].position, 715.0 + 10.0))
    history[after, 13] = 0.055
    uplift = contact_statistics(replace(run, support_uplift=history)).uplift
    assert uplift.uplift[-1] == pytest.approx(0.055)


def test_dropper_range_and_slack_time(run: Run) -> None:
    """A dropper without force for 30 samples of 1 ms is slack for 30 ms; others never."""
    forces = np.full_like(run.dropper_force, 80.0)
    column = 9 * 6 + 2
    forces[4000:4030, column] = 0.0
    forces[4100, column] = 150.0
    droppers = contact_statistics(
        replace(run, droppers=DropperHistory.of_every_sample(forces))
    ).droppers
    assert droppers.span.size == 90
    row = 9 * 3 + 2
    assert (droppers.span[row], droppers.number[row]) == (7, 3)
    assert droppers.slack_time[row] == pytest.approx(0.030)
    assert (droppers.minimum[row], droppers.maximum[row]) == pytest.approx((0.0, 150.0))
    assert np.count_nonzero(droppers.slack_time) == 1
    assert droppers.static_force[row] == run.equilibrium.dropper_forces[column]
    assert droppers.observed == pytest.approx(605.0 / (320.0 / 3.6), abs=2e-3)


@pytest.fixture(scope="module")
def loss_run(run: Run) -> Run:
    """The passage with a gap cos(w t) - a around a few instants of the section."""
    gap = np.full(run.time.size, -1e-3)
    for centre, half in ((3.0, 0.0101), (4.0, 0.0015)):
        near = np.abs(run.time - centre) < 0.05
        gap[near] = 1e-2 * (half - np.abs(run.time[near] - centre))
    return with_record(run, gap=gap)


def test_contact_loss_is_timed_between_samples(loss_run: Run) -> None:
    """Losses of 20.2 and 3.0 ms are found with their duration, place and share of time."""
    [loss] = contact_loss(loss_run)
    assert loss.count == 2
    assert [event.duration for event in loss.events] == pytest.approx([0.0202, 0.003])
    assert loss.events[0].start == pytest.approx(3.0 - 0.0101)
    assert loss.events[0].position == pytest.approx(5.0 + (3.0 - 0.0101) * 320.0 / 3.6)
    assert loss.events[0].place == "dropper 9 of span 5"
    assert loss.observed == pytest.approx(550.0 / (320.0 / 3.6))
    assert loss.percent == pytest.approx(100.0 * 0.0232 / loss.observed)
    assert loss.longest == pytest.approx(0.0202)
    assert loss.count_over() == 1
    assert loss.percent_over() == pytest.approx(100.0 * 0.0202 / loss.observed)
    assert not any(event.is_cut for event in loss.events)


def test_contact_loss_is_cut_at_the_section(run: Run) -> None:
    """A loss from 10 m before to 2 m behind the first support counts with its 2 m."""
    position = run.pantographs[0].position
    gap = np.where(np.abs(position - 161.0) < 6.0, 1e-3, -1e-3)
    [loss] = contact_loss(with_record(run, gap=gap))
    [event] = loss.events
    assert event.is_cut
    assert event.position == pytest.approx(165.0)
    assert event.place == "support 4"
    assert event.duration == pytest.approx(2.0 / (320.0 / 3.6), abs=1e-3)


def test_contact_loss_of_a_mirrored_run(loss_run: Run) -> None:
    """A run in -x has the same durations at the mirrored places."""
    record = loss_run.pantographs[0]
    mirrored = with_record(loss_run, position=17 * 55.0 - record.position)
    [there], [back] = contact_loss(loss_run), contact_loss(mirrored, (5, 14))
    assert [e.duration for e in back.events] == pytest.approx([e.duration for e in there.events])
    assert [17 * 55.0 - e.position for e in back.events] == pytest.approx(
        [e.position for e in there.events]
    )


def test_nearest_place(run: Run) -> None:
    """Supports and droppers are numbered from 1."""
    assert nearest_place(run.equilibrium, 55.0 * 7 + 1.0) == "support 8"
    assert nearest_place(run.equilibrium, 55.0 * 7 + 10.0) == "dropper 2 of span 8"


def test_json_has_the_keys_of_the_contract(run: Run) -> None:
    """The plain data of statistics has the keys of the command line's JSON, without NaN."""
    stats = contact_statistics(run)
    data = json.loads(json.dumps(stats.as_dict(), allow_nan=False))
    entry = data["pantographs"][0]
    names = ["std_0_2", "std_0_5", "std_5_20", "std_0_20", "std_0_50", "std_0_100", "std_0_200"]
    names += ["mean", "max", "min", "statistical_max", "statistical_min"]
    for kind in ("sharp", "butterworth"):
        assert {f"{name}_n" for name in names} <= set(entry[kind])
    assert {"name", "uplift_force_n", "target_mean_n", "contact_loss"} <= set(entry)
    assert {"count", "percent", "longest_ms", "events"} <= set(entry["contact_loss"])
    assert {"first_span": 4, "last_span": 13}.items() <= data["section"].items()
    assert data["uplift"]["supports"][0].keys() == {"support", "mm"}
    assert data["uplift"]["max_mm"] == pytest.approx(1e3 * stats.uplift.maximum)
    assert "sigma" in str(stats)


def test_spectrum_shows_the_waves(wave_run: Run) -> None:
    """The section's spectrum has lines of 50 N near 1.62 Hz and of 30 N near 15.46 Hz."""
    spectrum = force_spectrum(wave_run, "front")
    for frequency, amplitude in ((1.616, 50.0), (15.46, 30.0)):
        near = np.abs(spectrum.abscissa - frequency) < 0.5
        assert spectrum.value[near].max() == pytest.approx(amplitude, rel=0.15)
    density = force_spectrum(wave_run, "front", density=True, segments=3)
    assert np.sum(density.value) * density.resolution == pytest.approx(1700.0, rel=0.1)


def test_spectrum_needs_samples() -> None:
    """A run that ended before the section has no spectrum, and the message says so."""
    with pytest.raises(InputError, match="no spectrum of pantograph 'front'"):
        force_spectrum(make_run(status="partial", duration=1.0), "front")
