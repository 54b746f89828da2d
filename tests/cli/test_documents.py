"""The JSON contract: keys, units and numbering that programs rely on."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from .conftest import Invoke, Outcome

BANDS = ("0_2", "0_5", "5_20", "0_20", "0_50", "0_100", "0_200")
CONVENTIONS = {
    "closure",
    "ends",
    "messenger_longitudinal",
    "nodes_between_droppers",
    "time_step_s",
    "integrator",
    "backend",
    "damping",
    "filter_order",
}
SHAPE = {
    "iterations",
    "residual_n",
    "dropper_lengths_unstrained_m",
    "dropper_lengths_m",
    "dropper_forces_n",
    "dropper_heights_m",
    "support_heights_m",
    "arm_forces_n",
    "arm_angles_deg",
}
STATISTICS = {
    "mean_n",
    *(f"std_{band}_n" for band in BANDS),
    "max_n",
    "min_n",
    "statistical_max_n",
    "statistical_min_n",
}
RUN = {
    "case",
    "version",
    "status",
    "conventions",
    "warnings",
    "speed_kmh",
    "contact_stiffness_n_per_m",
    "section",
    "pantographs",
    "uplift",
    "cost",
    "checks",
}
COST = {
    "dof",
    "steps",
    "iterations_mean",
    "simulated_s",
    "cpu_s",
    "wall_s",
    "real_time_factor",
    "tuning_passes",
}
CHECK = {"name", "value", "limit", "unit", "standard", "verified", "passed"}


@pytest.fixture
def static(invoke: Invoke) -> Any:
    """Return the document of a short static line."""
    outcome = invoke(
        "static", "ac-simple", "--json", "--set", "line.spans=4",
        "--set", "settings.nodes_between_droppers=3", "--set", "settings.section=[2, 2]",
    )  # fmt: skip
    assert outcome.code == 0
    return outcome.document


def test_static_document(static: Any) -> None:
    """``static --json`` has the agreed keys, one row per span, one value per support."""
    assert {"case", "version", "conventions", "warnings", "shape", "elasticity"} <= set(static)
    assert set(static["conventions"]) >= CONVENTIONS
    assert set(static["shape"]) >= SHAPE
    shape = static["shape"]
    for name in SHAPE - {"iterations", "residual_n"}:
        if name.startswith("dropper"):
            assert [len(row) for row in shape[name]] == [9] * 4, name
    assert len(shape["support_heights_m"]) == 5
    assert shape["arm_supports"] == [2, 3, 4]
    assert len(shape["arm_forces_n"]) == len(shape["arm_angles_deg"]) == 3
    assert shape["residual_n"] <= 1e-4
    assert shape["reaction_n"] == pytest.approx(shape["weight_n"], abs=0.01)


def test_elasticity_points(static: Any) -> None:
    """Points of the section: a support belongs to the span it begins, middles to the left one."""
    elasticity = static["elasticity"]
    assert elasticity["force_n"] == 100.0
    assert elasticity["nonuniformity_percent"] > 0.0
    points = elasticity["points"]
    assert set(points[0]) == {"span", "kind", "index", "x_m", "elasticity_mm_per_n"}
    found = [(point["span"], point["kind"], point["index"]) for point in points]
    assert found[0] == (2, "support", 0)
    assert found[1:4] == [(2, "middle", 0), (2, "dropper", 1), (2, "middle", 1)]
    assert found[-1] == (3, "support", 0)
    assert len([f for f in found if f[1] == "dropper"]) == 9
    assert all(0.1 < point["elasticity_mm_per_n"] < 1.0 for point in points)


def test_run_document(short_run: tuple[Path, Outcome]) -> None:
    """``run --json`` has the agreed keys."""
    _, outcome = short_run
    assert outcome.code == 0
    document = outcome.document
    assert set(document) >= RUN
    assert document["status"] == "done"
    assert set(document["conventions"]) >= CONVENTIONS
    assert document["speed_kmh"] == 320.0
    assert document["contact_stiffness_n_per_m"] == 50e3
    assert document["section"]["first_span"] == 2
    assert document["section"]["last_span"] == 3
    assert set(document["cost"]) >= COST
    assert document["checks"]
    assert all(set(check) >= CHECK for check in document["checks"])


def test_run_pantographs(short_run: tuple[Path, Outcome]) -> None:
    """Both filters, contact loss and forces of every pantograph, bands as null where unknown."""
    (front,) = short_run[1].document["pantographs"]
    assert front["name"] == "front"
    assert front["uplift_force_n"] == 150.0
    assert front["target_mean_n"] is None
    for kind in ("sharp", "butterworth"):
        assert set(front[kind]) >= STATISTICS
        assert front[kind]["std_0_20_n"] > 0.0
        assert front[kind]["std_0_200_n"] is None  # the record ends at 125 Hz
        assert front[kind]["min_n"] < front[kind]["mean_n"] < front[kind]["max_n"]
    assert set(front["contact_loss"]) >= {"count", "percent", "longest_ms", "events"}
    for event in front["contact_loss"]["events"]:
        assert set(event) >= {"start_s", "duration_ms", "position_m"}


def test_run_uplift(short_run: tuple[Path, Outcome]) -> None:
    """Uplift of every support of the section, numbered from 1, and the largest of them."""
    uplift = short_run[1].document["uplift"]
    assert [entry["support"] for entry in uplift["supports"]] == [2, 3, 4]
    assert uplift["max_mm"] == max(entry["mm"] for entry in uplift["supports"])


def test_unverified_limit_has_no_verdict(short_run: tuple[Path, Outcome]) -> None:
    """``passed`` is null where nobody compared the limit with the standard's text."""
    for check in short_run[1].document["checks"]:
        assert check["verified"] or check["passed"] is None


def test_prescribed_force_is_not_tuned(short_run: tuple[Path, Outcome]) -> None:
    """The cost is that of the reported pass; without a mean force there is no tuning pass."""
    cost = short_run[1].document["cost"]
    assert cost["tuning_passes"] == 0
    assert cost["steps"] == round(cost["simulated_s"] / 0.004)


def test_run_files(short_run: tuple[Path, Outcome]) -> None:
    """A run leaves histories, results, tables and a report, and says where."""
    folder, outcome = short_run
    names = {"run.nc", "results.json", "droppers.csv", "force.csv", "report.html"}
    assert {path.name for path in folder.iterdir()} == names
    assert set(outcome.document["files"]) == names
    stored = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    assert stored["pantographs"] == outcome.document["pantographs"]
    assert (folder / "report.html").read_text(encoding="utf-8").startswith("<!DOCTYPE html>")


def test_backend_is_named_everywhere(short_run: tuple[Path, Outcome], invoke: Invoke) -> None:
    """Version, standard error and JSON name the same backend."""
    outcome = short_run[1]
    name = outcome.document["conventions"]["backend"]
    assert name
    assert f"backend {name}" in outcome.err
    assert f"backend {name}" in invoke("--version").out


def test_check_document(invoke: Invoke) -> None:
    """``check --json`` says that the input is valid and gives the wave-quantity sheet."""
    counted = "settings.nodes_between_droppers=9"
    document = invoke("check", "ac-simple", "--json", "--set", counted).document
    assert document["valid"] is True
    assert document["size"] == {"droppers": 153, "dof": 16332, "steps": 10407}
    names = {quantity["name"] for quantity in document["wave_quantities"]}
    assert "wave speed of the contact wire" in names
    assert [advice["topic"] for advice in document["advice"]] == ["mesh"]


def test_cases_document(invoke: Invoke) -> None:
    """``cases --json`` lists what the library holds."""
    entries = invoke("cases", "--json").document["cases"]
    assert {"ac-simple", "en50318-2002"} <= {entry["name"] for entry in entries}


def test_schema_document(invoke: Invoke) -> None:
    """``schema`` prints a JSON Schema with or without ``--json``."""
    assert "line" in invoke("schema").document["properties"]
    assert invoke("schema", "--json").out == invoke("schema").out


def test_report_of_two_runs(short_run: tuple[Path, Outcome], invoke: Invoke) -> None:
    """Several runs are overlaid in one report."""
    path = short_run[0] / "run.nc"
    outcome = invoke("report", path, path, "--out", "both.html", "--json")
    assert outcome.code == 0
    assert [run["case"] for run in outcome.document["runs"]] == ["ac-simple"] * 2
    assert Path("both.html").stat().st_size > 1e5


def test_compare_with_itself(short_run: tuple[Path, Outcome], invoke: Invoke) -> None:
    """A run compared with its own force history differs by little more than what the suspicious
    samples of so coarse a run are worth, which are left out."""
    rows = (short_run[0] / "force.csv").read_text(encoding="utf-8").splitlines()
    kept = (",".join(row.split(",")[:3]) for row in rows)
    Path("measured.csv").write_text("\n".join(kept), encoding="utf-8")
    outcome = invoke("compare", short_run[0] / "run.nc", "measured.csv", "--out", "both", "--json")
    assert outcome.code == 0
    (deviation,) = (
        row
        for row in outcome.document["comparisons"][0]["rows"]
        if row["quantity"] == "standard_deviation"
    )
    assert deviation["measured"] == pytest.approx(deviation["simulated"], rel=0.01)
    assert deviation["passed"] is None
    assert outcome.document["covers"]["speed_kmh"] == [320.0, 320.0]
    both = np.genfromtxt("both/forces.csv", delimiter=",", skip_header=1)
    assert np.nanmedian(np.abs(both[:, 1] - both[:, 2])) < 1.5
    assert Path("both/comparison.html").stat().st_size > 1e5


def test_hht_is_named(invoke: Invoke) -> None:
    """The conventions name the integrator with its parameter, and ends that differ."""
    document = invoke(
        "static", "ac-simple", "--json", "--set", "line.spans=2",
        "--set", "settings.nodes_between_droppers=2",
        "--set", "settings.integrator={method: hht, alpha: -0.1}",
        "--set", "line.ends.right=weighted",
    ).document  # fmt: skip
    assert document["conventions"]["integrator"] == "HHT-alpha (alpha -0.1)"
    assert document["conventions"]["ends"] == {"left": "anchored", "right": "weighted"}
