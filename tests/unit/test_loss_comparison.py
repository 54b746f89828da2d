"""Losses counted, sorted into classes, and compared run by run."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest

from tautwire.analyses.force.contact_loss import contact_loss
from tautwire.analyses.force.loss_comparison import compare_losses
from tautwire.errors import InputError
from tautwire.results.run import ContactEvents, Run
from tautwire.results.statistics import ARC_NOTE, ContactLoss, LossEvent
from tautwire.signals.losses import counted_intervals

from .synthetic import make_case, make_run


def loss(*events: tuple[float, float], cut: bool = False) -> ContactLoss:
    """Return losses from starts and durations in milliseconds."""
    return ContactLoss(
        "front",
        10.0,
        tuple(
            LossEvent(1e-3 * start, 1e-3 * duration, 80.0, "dropper 3 of span 2", cut)
            for start, duration in events
        ),
    )


def test_counted_losses_are_whole_steps() -> None:
    """Counting takes each lost sample as one step: a loss of 0.6 ms that no sample hits is not
    there, one sample is a whole step, and a loss at the end of the record ends one step later."""
    time = 1e-3 * np.arange(8)
    start, end = counted_intervals(time, [-1.0, -1.0, 2.0, -1.0, -1.0, 0.0, 1.0, 1.0])
    assert start == pytest.approx([2e-3, 5e-3])
    assert end - start == pytest.approx([1e-3, 3e-3])
    assert counted_intervals(time[:1], [1.0])[0].size == 0
    assert counted_intervals(time, np.full(8, -1.0))[0].size == 0


def test_classes_of_durations() -> None:
    """Every loss is in one class: below 1, 5, 10, 20 ms, and longer; 5 ms itself counts as an
    arc (EN 50367 as quoted by the paper)."""
    found = loss((0, 0.5), (10, 1.0), (20, 4.999), (30, 5.0), (40, 12.0), (60, 30.0))
    assert [part.count for part in found.classes()] == [1, 2, 1, 1, 1]
    assert found.count_over() == 3
    assert found.percent_over() == pytest.approx(100.0 * 47e-3 / 10.0)
    assert found.longest == pytest.approx(30e-3)
    document = json.loads(json.dumps(found.as_dict()))
    assert document["classes"][-1] == {"from_ms": 20.0, "to_ms": None, "count": 1}
    assert document["count_over_5_ms"] == 3
    assert "surrogate" in ARC_NOTE


def test_losses_are_matched_missed_and_invented() -> None:
    """Losses that overlap belong together, then those less than 5 ms apart; what is left of 1 ms
    or more was missed or is spurious, what is shorter does not count."""
    reference = loss((100, 4.0), (200, 2.0), (300, 0.8), (400, 1.2), (500, 1.5))
    other = loss((99, 4.5), (203, 1.0), (510, 3.0), (600, 0.5))
    match = compare_losses({"1 ms": other, "fine": reference}).matches[0]
    assert [(p.reference.start, p.other.start) for p in match.pairs] == [(0.1, 0.099), (0.2, 0.203)]
    assert [event.start for event in match.missed] == [0.4, 0.5]
    assert [event.start for event in match.spurious] == [0.51]
    assert [pair.error for pair in match.pairs] == pytest.approx([0.125, 0.5])
    assert match.median_error == pytest.approx(0.3125)
    assert match.largest_error == pytest.approx(0.5)
    assert match.largest_difference == pytest.approx(1e-3)
    assert match.pairs[0].shift == pytest.approx(1e-3)
    assert match.partner(reference.events[3]) is None


def test_a_loss_has_one_partner() -> None:
    """One long loss against two short ones: the one that overlaps more is the partner, the other
    was missed."""
    reference = loss((99, 3.0), (103, 6.0))
    match = compare_losses({"a": loss((100, 10.0)), "b": reference}).matches[0]
    assert [pair.reference for pair in match.pairs] == [reference.events[1]]
    assert match.missed == reference.events[:1]
    assert not match.spurious


def test_losses_cut_by_the_section_are_not_judged() -> None:
    """A loss that a limit of the section cuts is matched but has no error."""
    match = compare_losses({"a": loss((0, 4.0), cut=True), "b": loss((0, 5.0))}).matches[0]
    assert len(match.pairs) == 1
    assert not match.judged
    assert np.isnan(match.median_error)
    assert np.isnan(match.largest_error)


def test_comparison_as_table_and_document() -> None:
    """The table shows durations, errors and what is missing, the document the same as data."""
    comparison = compare_losses(
        {"fine": loss((100, 4.0), (200, 2.0)), "1 ms": loss((100, 5.0), (300, 1.0))}, "fine"
    )
    text = str(comparison)
    assert "25.00" in text
    assert "missed: 2.00 ms at t = 0.2000 s, dropper 3 of span 2" in text
    assert "spurious: 1.00 ms at t = 0.3000 s" in text
    (run,) = json.loads(json.dumps(comparison.as_dict()))["runs"]
    assert run["durations_ms"] == [pytest.approx(5.0), None]
    assert len(run["missed"]) == len(run["spurious"]) == 1


@pytest.mark.parametrize(
    ("labels", "reference", "words"),
    [
        (("a",), None, "at least two runs"),
        (("a", "b"), "c", "no run is labelled 'c'; there are: a, b"),
    ],
    ids=["alone", "reference"],
)
def test_bad_comparisons(labels: tuple[str, ...], reference: str | None, words: str) -> None:
    """A comparison needs two runs and a reference among them."""
    with pytest.raises(InputError, match=words):
        compare_losses({label: loss((0, 1.0)) for label in labels}, reference)


@pytest.fixture(scope="module")
def run() -> Run:
    """A run with two losses of contact of the leading pantograph, and a second pantograph."""
    return make_run(make_case(pantographs=2), losses=True)


def test_located_events_are_what_counts(run: Run) -> None:
    """A run that stores instants of separation and re-contact is read by them, not by its samples;
    those of the other pantograph are not mixed in."""
    sampled = contact_loss(run)[0]
    assert sampled.count > 0
    first = sampled.events[0]
    events = ContactEvents(
        time=np.array([first.start + 2e-4, first.start + 3e-4, first.start + 47e-4]),
        pantograph=np.array([0, 1, 0]),
        opens=np.array([True, True, False]),
    )
    (read, _) = contact_loss(dataclasses.replace(run, events=events))
    assert read.count == 1
    assert read.events[0].start == pytest.approx(first.start + 2e-4)
    assert read.events[0].duration == pytest.approx(45e-4)


def test_counting_ignores_located_events(run: Run) -> None:
    """Counted losses are whole steps, whatever else is known."""
    (counted, _) = contact_loss(run, counted=True)
    steps = np.array([event.duration for event in counted.events]) / 1e-3
    assert steps == pytest.approx(np.round(steps))


def test_runs_are_compared_by_pantograph(run: Run) -> None:
    """The pantograph is chosen by name; two equal runs agree in every loss."""
    comparison = compare_losses({"a": run, "b": run}, pantograph="rear")
    assert comparison.reference.pantograph == "rear"
    match = comparison.matches[0]
    assert match.loss.count == comparison.reference.count
    assert not match.missed
    assert not match.spurious
    with pytest.raises(InputError, match="no pantograph named 'third'"):
        compare_losses({"a": run, "b": run}, pantograph="third")
