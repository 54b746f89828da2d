"""Conditions on the command line: side by side, one of them, and what cannot be."""

from __future__ import annotations

import csv
import json
from pathlib import Path

from .conftest import Invoke

CASE = """
include: ac-simple-plane
name: weather
line: {spans: 4, ends: {left: anchored, right: {weights: {ratio: 3}}}}
wires:
  contact: {diameter: 14.4 mm, thermal_expansion: 17e-6}
  messenger: {diameter: 14 mm, thermal_expansion: 17e-6 1/K}
droppers: {diameter: 4.5 mm, thermal_expansion: 17e-6}
settings: {section: [2, 2], nodes_between_droppers: 3, time_step: 4 ms}
scenario: {uplift_force: 150 N}
requirements: {gauge: {wind: {speed: 10 m/s}, permissible: 0.21 m}}
conditions:
  - {name: cold, temperature: -20 degC, reference: 15 degC}
  - {name: broken, defects: [{kind: missing dropper, span: 2, dropper: 5}]}
  - {name: storm, wind: {speed: 35 m/s, from: left}}
"""


def write(text: str = CASE) -> Path:
    """Write the case into the working folder."""
    path = Path("weather.yaml")
    path.write_text(text, encoding="utf-8")
    return path


def test_conditions_side_by_side(invoke: Invoke) -> None:
    """``static`` shows all conditions beside the design, in 80 columns and as JSON, CSV and a
    page; one that cannot be is told with its place, and the exit code says so."""
    Path("block.yaml").write_text("client: Valley Railway\n", encoding="utf-8")
    outcome = invoke("static", write(), "--out", "made", "--project", "block.yaml")
    assert outcome.code == 1
    assert "<dd>Valley Railway</dd>" in Path("made/conditions.html").read_text(encoding="utf-8")
    assert max(map(len, outcome.out.splitlines())) <= 80
    for text in ("cold", "(weights", "dropper 5 of span 2", "steady arm at support"):
        assert text in outcome.out
    states = json.loads(Path("made/static.json").read_text(encoding="utf-8"))["conditions"]
    assert [state["name"] for state in states] == ["design", "cold", "broken", "storm"]
    cold, broken, storm = states[1:]
    (right,) = [e for e in cold["ends"] if e["wire"] == "contact" and e["side"] == "right"]
    expected = -17e-6 * 220.0 * 35.0
    assert abs(right["travel_m"] - expected) < 2e-3 * abs(expected)
    assert abs(right["weights_sunk_m"] - 3.0 * right["travel_m"]) < 1e-12
    assert broken["slack_droppers"] == ["dropper 5 of span 2"]
    assert broken["told"] == ["missing dropper: dropper 5 of span 2"]
    assert "support 2" in storm["fault"]
    with Path("made/conditions.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["condition"] for row in rows] == ["design", "cold", "broken", "storm"]
    assert "support 2" in rows[3]["no such state"]
    with Path("made/supports.csv").open(encoding="utf-8") as file:
        forces = list(csv.DictReader(file))
    assert {row["condition"] for row in forces} == {"design", "cold", "broken"}
    weight = sum(float(row["vertical [N]"]) for row in forces if row["condition"] == "cold")
    document = json.loads(Path("made/static.json").read_text(encoding="utf-8"))
    assert abs(weight + document["shape"]["weight_n"]) < 1.0
    with Path("made/installation.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert float(rows[-1]["cold, -20 degC [mm]"]) > 0.0
    assert "Forces on supports" in outcome.out
    assert "worst place" in outcome.out
    with Path("made/lateral.csv").open(encoding="utf-8") as file:
        margins = [float(row["margin [m]"]) for row in csv.DictReader(file)]
    assert len(margins) == 8
    assert min(place["margin_m"] for place in document["lateral"]["places"]) < 0.02
    page = Path("made/conditions.html").read_text(encoding="utf-8")
    for text in (
        "Installation",
        "missing dropper: dropper 5 of span 2",
        "Lateral position",
        "farthest left",
    ):
        assert text in page


def test_one_condition(invoke: Invoke) -> None:
    """``--condition`` examines one; the document and the view say which, and no table follows."""
    outcome = invoke("static", write(), "--condition", "cold", "--json")
    assert outcome.code == 0
    told = ["cold", "-20 degC (design 15 degC)"]
    assert outcome.document["conventions"]["condition"] == told
    assert "conditions" not in outcome.document
    shown = invoke("static", write(), "--condition", "broken")
    assert "missing dropper: dropper 5 of span 2" in shown.out


def test_run_in_a_condition(invoke: Invoke) -> None:
    """``run --condition`` passes under the line with its defect; the report names it."""
    outcome = invoke("run", write(), "--condition", "broken", "--out", "made")
    assert outcome.code == 0
    assert "missing dropper: dropper 5 of span 2" in outcome.out
    page = Path("made/report.html").read_text(encoding="utf-8")
    assert "missing dropper: dropper 5 of span 2" in page


def test_impossible_condition_is_refused(invoke: Invoke) -> None:
    """A condition without a state is refused with the places; an unknown one with the names."""
    outcome = invoke("static", write(), "--condition", "storm")
    assert outcome.code == 2
    assert "condition 'storm': the steady arm at support 2" in outcome.err
    outcome = invoke("static", write(), "--condition", "frost")
    assert outcome.code == 2
    assert "the conditions are: cold, broken, storm" in outcome.err


def test_place_of_a_defect_is_checked(invoke: Invoke) -> None:
    """``check`` refuses a defect whose place is not there."""
    outcome = invoke("check", write(), "--set", "conditions[2].defects[1].dropper=12")
    assert outcome.code == 2
    assert "conditions[2].defects[1]: got dropper 12; span 2 has 1 to 9" in outcome.err
