"""Validation records: verdicts that name their filter, and inputs that rest on memory."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tautwire.assessment.references import compare_with_reference, load_references
from tautwire.inputs.load import load_case
from tautwire.reproductions import en50318_2002
from tautwire.reproductions.record import Claim, Record, claims_of, record_html, writers

COARSE = {
    "line.spans": 4,
    "settings.section": [2, 3],
    "settings.nodes_between_droppers": 2,
    "settings.time_step": "8 ms",
}


@pytest.fixture(scope="module")
def record() -> Record:
    """The study on a line much too short and coarse, for its form only."""
    return en50318_2002.reproduce(changes=COARSE)


def _claim(found: dict[str, float], inside: dict[str, bool | None]) -> Claim:
    return Claim("250 km/h", "minimum", "N", 50.0, 75.0, found, inside, "one source")


@pytest.mark.parametrize(
    ("inside", "verdict"),
    [
        ({"sharp": True, "butterworth": True}, "inside"),
        ({"sharp": False, "butterworth": False}, "outside"),
        ({"sharp": False, "butterworth": True}, "depends on the filter"),
        ({"sharp": None, "butterworth": True}, "no value"),
    ],
)
def test_verdict(inside: dict[str, bool | None], verdict: str) -> None:
    """A number inside with one filter only is not called inside."""
    assert _claim(dict.fromkeys(inside, 60.0), inside).verdict == verdict


def test_explanation() -> None:
    """The filter that meets the range is named."""
    claim = _claim({"sharp": 40.0, "butterworth": 55.0}, {"sharp": False, "butterworth": True})
    assert claim.explanation.startswith("inside with the Butterworth filter")
    assert replace(claim, remark="over spans 4 to 10: 51.0 N").explanation.endswith("51.0 N")


def test_every_published_range_is_judged(record: Record) -> None:
    """Both speeds, every quantity of the references, with both filters where one is involved."""
    assert record.status == "done"
    assert len(record.claims) == 16
    for claim in record.claims:
        expected = {"unfiltered"} if claim.quantity in ("uplift", "loss_percent") else {
            "sharp", "butterworth"}  # fmt: skip
        assert set(claim.found) == expected
        assert claim.verdict in {"inside", "outside", "depends on the filter"}
    assert sum(record.counts.values()) == 16


def test_claims_agree_with_the_comparison(record: Record) -> None:
    """Numbers are in the published unit and carry the verdict of the comparison."""
    from tautwire.analyses.force.statistics import contact_statistics

    run = record.runs["250 km/h"]
    rows = compare_with_reference(
        contact_statistics(run), load_references().get("en50318-2002-250"), filter="sharp"
    )
    (claim,) = (c for c in claims_of("250 km/h", {"sharp": rows}) if c.quantity == "uplift")
    (row,) = (row for row in rows if row.quantity == "uplift")
    assert (claim.low, claim.high, claim.unit) == (48.0, 55.0, "mm")
    assert claim.found["unfiltered"] == pytest.approx(1e3 * row.value)
    assert claim.inside["unfiltered"] == row.inside


def test_record_names_what_it_rests_on(record: Record) -> None:
    """Remembered inputs, changed inputs and filters stand in the record."""
    remembered = {source.path for source in record.doubtful_inputs}
    assert {"droppers.presag", "scenario.uplift_force"} <= remembered
    assert record.changed_inputs == tuple(COARSE)
    assert set(record.filters) == {"sharp", "butterworth"}
    assert "not stated" in record.published_filter
    for path in COARSE:
        assert path in record.statement


def test_record_files(record: Record, tmp_path: Path) -> None:
    """Page, data and table hold the same claims; the page asks no other machine."""
    wanted = writers(record)
    assert set(wanted) == {
        "record.html", "record.json", "record.csv", "run-250.nc", "run-300.nc", "report.html",
    }  # fmt: skip
    for name in ("record.html", "record.json", "record.csv"):
        wanted[name](tmp_path / name)
    stored: Any = json.loads((tmp_path / "record.json").read_text(encoding="utf-8"))
    assert len(stored["claims"]) == 16
    with (tmp_path / "record.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 12 * 2 + 4
    page = (tmp_path / "record.html").read_text(encoding="utf-8")
    assert "http" not in page.replace("http-equiv", "")
    assert page.count('class="verdict') == 16
    assert "scenario.uplift_force" in page


def test_interrupted_study_is_partial(record: Record) -> None:
    """A study that is stopped keeps no verdict on the run that was cut, and says so."""
    stopped = en50318_2002.reproduce(lambda _name, _progress: True, COARSE)
    assert stopped.status == "partial"
    assert stopped.runs == {}
    assert "not complete" in stopped.statement
    assert "not complete" in record_html(replace(record, status="partial"))


def test_library_case_is_not_adjusted() -> None:
    """The study runs the library case as it is: force, ranges and section are not tuned."""
    case = load_case("en50318-2002")
    assert case.scenario.uplift_force == 120.0
    assert case.scenario.mean_force is None
