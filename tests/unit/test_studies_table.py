"""The table of a study: labelled arrays, CSV, netCDF, failures, and the report page."""

from __future__ import annotations

import csv
import io
import os
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tautwire.errors import InputError
from tautwire.report.figures.study_figures import groups, readable_axis, usual_figures
from tautwire.report.pages.study_page import write_study_report
from tautwire.signals.bands import BANDS, band_name
from tautwire.studies.execution.task import lost_row
from tautwire.studies.files import save_csv, save_netcdf
from tautwire.studies.plan import Plan, plan_study
from tautwire.studies.store import Store
from tautwire.studies.study_file import make_study
from tautwire.studies.table import StudyTable, collect

FORMULAS = {"=1+1": {"line.spans": 17}, "@SUM(A1)": {"line.spans": 18}, "-2": {"line.spans": 19}}
AXES = {
    "scenario.speed": ["250 km/h", "300 km/h", "600 km/h"],
    "settings.contact_stiffness": ["50 kN/m", "200 kN/m"],
}


def sigma(speed: float, stiffness: float, band: int) -> float:
    """Return a made-up standard deviation that depends on all its arguments."""
    return speed / 10.0 + stiffness / 1e4 + 10.0 * band


def made_row(coordinates: dict[str, Any], pantographs: int = 1) -> dict[str, Any]:
    """Return a row as a computed case has it."""
    speed = float(coordinates.get("speed", 80.0))
    stiffness = float(coordinates.get("contact_stiffness", 2e5))
    part: dict[str, float | None] = {
        "mean": 169.0,
        "maximum": 300.0,
        "minimum": 60.0,
        "statistical_maximum": 320.0,
        "statistical_minimum": 20.0,
        "std_advised": sigma(speed, stiffness, 5),
        **{f"std_{band_name(b)}": sigma(speed, stiffness, n) for n, b in enumerate(BANDS)},
    }
    part["std_0_200"] = None if speed > 83.0 and stiffness > 1e5 else part["std_0_200"]
    entry = {
        "uplift_force": 174.0,
        "contact_height_range": 0.06,
        "loss_count": 2,
        "loss_percent": 0.1,
        "loss_longest": 0.004,
        "arc_percent": 0.0,
        "filters": {"sharp": part, "butterworth": {**part, "mean": 168.0}},
    }
    names = ["front", "rear"][:pantographs]
    return {
        "status": "done",
        "kind": "",
        "reason": "",
        "version": "0",
        "values": {
            "uplift_max": 0.06,
            "advised_cutoff": 0.9 * speed,
            "steps": 1000,
            "tuning_passes": 3,
            "pantographs": [{"name": name, **entry} for name in names],
        },
        "cost": {"cpu_s": 2.0, "wall_s": 2.5, "peak_memory_mb": 130.0},
    }


def fill(plan: Plan, folder: Path, pantographs: int = 1, leave_out: int = 0) -> StudyTable:
    """Store made-up rows for the valid cases of a plan and collect them."""
    store = Store(folder)
    for point in list(plan.by_key.values())[leave_out:]:
        store.save(point.key, made_row(plan.coordinates(point), pantographs))
    return collect(plan, store)


def make_plan(axes: dict[str, Any], **more: Any) -> Plan:
    """Write out a study of the reference line."""
    data = {"schema": 1, "name": "test", "base": "ac-simple", "axes": axes, **more}
    return plan_study(make_study(data))


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> StudyTable:
    """A grid of three speeds and two stiffnesses; the highest speed is refused."""
    return fill(make_plan(AXES), tmp_path_factory.mktemp("grid"))


def test_arrays_over_the_axes(table: StudyTable) -> None:
    """Values stand where their case stands; what is refused is NaN with its reason."""
    deviation = table["std"]
    assert deviation.dimensions == ("speed", "contact_stiffness", "pantograph", "filter", "band")
    assert deviation.values.shape == (3, 2, 1, 2, len(BANDS))
    at = table.labels["band"].index("5_20")
    speed = table.coordinates()["speed"].values
    assert deviation.values[1, 0, 0, 0, at] == pytest.approx(sigma(speed[1], 5e4, at))
    assert np.isnan(deviation.values[2]).all()
    assert np.isnan(deviation.values[1, 1, 0, 0, -1])
    assert table["mean"].values[0, 0, 0].tolist() == [169.0, 168.0]
    assert table.counts() == {"done": 4, "failed": 0, "refused": 2, "missing": 0}
    assert "wave speed" in table.reason[2, 0]


def test_mixed_kernels_are_named(tmp_path: Path) -> None:
    """A table whose rows come from different kernels says which; one of one kind says nothing."""
    plan = make_plan({"scenario.speed": ["250 km/h", "260 km/h", "270 km/h"]})
    store = Store(tmp_path)
    for point, backend in zip(plan.points, ("native (AVX2)", "native (AVX-512)"), strict=False):
        row = made_row(plan.coordinates(point), 1)
        row["values"]["backend"] = backend
        store.save(point.key, row)
        assert bool(collect(plan, store).mixture()) == (backend == "native (AVX-512)")
    told = collect(plan, store).mixture()
    assert "native (AVX-512): 1 cases, native (AVX2): 1 cases" in told
    assert collect(plan, store).backend.tolist() == ["native (AVX2)", "native (AVX-512)", ""]


def test_warnings_of_cases_are_named(tmp_path: Path) -> None:
    """What is outside the model stands in the case's row, in the CSV file and on the page."""
    plan = make_plan({"scenario.speed": ["250 km/h", "260 km/h", "270 km/h"]})
    store = Store(tmp_path)
    for point, gap in zip(plan.points, (0.61, 0.72, 0.0), strict=True):
        row = made_row(plan.coordinates(point), 1)
        row["values"]["warnings"] = f"outside the model: {gap} m below the wire" if gap else ""
        store.save(point.key, row)
    found = collect(plan, store)
    assert [warned.cases for warned in found.warned()] == [(1, 2)]
    assert found.warnings.tolist()[2] == ""
    assert "outside the model: 0.72 m below the wire" in found.to_csv()
    write_study_report(found, tmp_path / "study.html")
    assert "0.61 m below the wire" in (tmp_path / "study.html").read_text(encoding="utf-8")


def test_unknown_quantity_is_refused(table: StudyTable) -> None:
    """A quantity that the table does not hold is refused with those it holds."""
    with pytest.raises(InputError, match=r"holds no 'sigma'; it holds: .*std"):
        _ = table["sigma"]


def test_csv_names_its_units(table: StudyTable, tmp_path: Path) -> None:
    """The CSV has one row per case, units in its headers, and empty cells for missing numbers."""
    save_csv(table, tmp_path / "table.csv")
    text = (tmp_path / "table.csv").read_text()
    rows = list(csv.DictReader(io.StringIO(text)))
    assert len(rows) == 6
    assert rows[0]["speed [m/s]"] == str(250 / 3.6)
    assert rows[0]["contact_stiffness [N/m]"] == "50000.0"
    assert float(rows[0]["front.sharp.std_0_20 [N]"]) > 0.0
    assert rows[0]["front.loss_percent [%]"] == "0.1"
    assert rows[0]["uplift_max [m]"] == "0.06"
    assert rows[3]["front.sharp.std_0_200 [N]"] == ""
    assert rows[4]["status"] == "refused"
    assert rows[4]["front.sharp.mean [N]"] == ""
    assert not [name for name in rows[0] if "error" in name]


def test_errors_stand_beside_their_figures(tmp_path: Path) -> None:
    """Cases with error bars give columns of errors, and figures without digits that the errors make
    worthless, in CSV, JSON and on the page; cases without have neither."""
    plan = make_plan({"scenario.speed": ["250 km/h", "260 km/h"]})
    store = Store(tmp_path)
    for number, point in enumerate(plan.points):
        row = made_row(plan.coordinates(point))
        if number == 0:
            own = row["values"]
            own["uplift_max_error"] = 0.0004
            own["uplift_max"] = 0.06123
            entry = own["pantographs"][0]
            entry["loss_percent_error"] = 0.0
            part = entry["filters"]["sharp"]
            entry["filters"]["sharp"] = {
                **part, "mean": 168.73, "mean_error": 0.31, "std_0_20_error": 2.4
            }  # fmt: skip
        store.save(point.key, row)
    found = collect(plan, store)
    rows = list(csv.DictReader(io.StringIO(found.to_csv())))
    assert rows[0]["front.sharp.mean [N]"] == "168.7"
    assert rows[0]["front.sharp.mean_error [N]"] == "0.31"
    assert rows[0]["uplift_max [m]"] == "0.0612"
    assert rows[0]["front.sharp.std_0_20_error [N]"] == "2.4"
    assert rows[0]["front.loss_percent [%]"] == "0.1"
    assert rows[1]["front.sharp.mean [N]"] == "169"
    assert rows[1]["front.sharp.mean_error [N]"] == ""
    assert found.rows()[0]["front.sharp.mean [N]"] == 168.7
    assert found["mean"].values[0, 0, 0] == 168.73
    write_study_report(found, tmp_path / "study.html")
    page = (tmp_path / "study.html").read_text(encoding="utf-8")
    assert "168.7 ± 0.4" in page
    assert "61.2 ± 0.4" in page


def test_rows_for_json(table: StudyTable) -> None:
    """The rows for programs hold axes, status and every number."""
    row = table.rows()[2]
    assert row["case"] == 3
    assert row["speed"] == pytest.approx(300 / 3.6)
    assert row["status"] == "done"
    assert row["front.butterworth.mean [N]"] == 168.0


@pytest.mark.skipif(os.name != "posix", reason="limits of POSIX")
def test_table_on_a_full_disk_is_one_message(table: StudyTable, tmp_path: Path) -> None:
    """Where the file has no room writing ends with a message and nothing half-written; the process
    and the HDF5 library go on."""
    import resource
    import signal

    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (3000, limits[1]))
    try:
        with pytest.raises(InputError, match="cannot be written"):
            save_netcdf(table, tmp_path / "table.nc")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        signal.signal(signal.SIGXFSZ, ignored)
    assert not list(tmp_path.iterdir())
    assert save_netcdf(table, tmp_path / "table.nc").stat().st_size > 3000


def test_netcdf_opens_in_xarray(table: StudyTable, tmp_path: Path) -> None:
    """The netCDF file is a labelled array: values are selected by coordinates."""
    xarray = pytest.importorskip("xarray")
    save_netcdf(table, tmp_path / "table.nc")
    with xarray.open_dataset(tmp_path / "table.nc", engine="h5netcdf") as data:
        chosen = data["std"].sel(contact_stiffness=2e5, filter="sharp", pantograph="front")
        assert chosen.dims == ("speed", "band")
        assert chosen.sel(band="0_20").values[0] == pytest.approx(sigma(250 / 3.6, 2e5, 3))
        assert data["std"].attrs["units"] == "N"
        assert data["speed"].attrs["units"] == "m/s"
        assert data["speed"].attrs["long_name"] == "scenario.speed"
        assert data["status"].values[2, 0] == "refused"
        assert '"base": "ac-simple"' in data.attrs["study"]
    same = table.to_xarray()
    assert same["std"].sel(contact_stiffness=2e5).shape == (3, 1, 2, len(BANDS))


def test_axes_that_move_together(tmp_path: Path) -> None:
    """Zipped and sampled axes are coordinates along one dimension, in the file too."""
    xarray = pytest.importorskip("xarray")
    axes = {"scenario.speed": ["250 km/h", "300 km/h"], "settings.seed": [4, 7]}
    zipped = fill(make_plan(axes, design="zip"), tmp_path / "zip")
    assert zipped["mean"].dimensions[0] == "case"
    save_netcdf(zipped, tmp_path / "zip.nc")
    with xarray.open_dataset(tmp_path / "zip.nc", engine="h5netcdf") as data:
        assert data["mean"].coords["seed"].dims == ("case",)
        assert data["seed"].values.tolist() == [4, 7]
    sampled = fill(
        make_plan({"wires.contact.mass": {"low": 1.2, "high": 1.4}}, samples=5), tmp_path / "lhs"
    )
    assert sampled["mean"].dimensions[0] == "sample"


def test_several_pantographs(tmp_path: Path) -> None:
    """Every pantograph has its own columns."""
    found = fill(make_plan({"settings.seed": {"seeds": 2}}), tmp_path, pantographs=2)
    assert found.labels["pantograph"] == ("front", "rear")
    head = found.to_csv().splitlines()[0]
    assert "front.sharp.std_0_20 [N]" in head
    assert "rear.uplift_force [N]" in head


def test_largest_force_and_uplift_are_drawn(tmp_path: Path) -> None:
    """The largest force is drawn for every pantograph, the uplift once for all of them, in mm."""
    axes = {"scenario.speed": ["250 km/h", "300 km/h"]}
    found = fill(make_plan(axes), tmp_path, pantographs=2)
    drawn = {name: figure for name, figure, _ in usual_figures(found)}
    forces, uplift = drawn["extremes-speed"].data, drawn["uplift-speed"].data
    assert [trace["name"].split(",")[0] for trace in forces] == ["front", "front", "rear", "rear"]
    largest = found["maximum"].values[:, 0, found.labels["filter"].index("sharp")]
    assert list(forces[0]["y"]) == pytest.approx(list(largest))
    assert len(uplift) == 1
    assert list(uplift[0]["y"]) == pytest.approx(list(1e3 * found["uplift_max"].values))


def test_names_that_look_like_formulas(tmp_path: Path) -> None:
    """Variants whose names a spreadsheet would compute are written as texts, numbers as numbers."""
    base = {"schema": 1, "name": "s", "base": "ac-simple"}
    plan = plan_study(make_study({**base, "axes": {"length": {"variants": FORMULAS}}}))
    rows = list(csv.reader(io.StringIO(fill(plan, tmp_path).to_csv())))
    assert [row[1] for row in rows] == ["length", "'=1+1", "'@SUM(A1)", "-2"]


def test_unfinished_study(tmp_path: Path) -> None:
    """Cases that were not computed yet are missing, not failed."""
    found = fill(make_plan(AXES), tmp_path, leave_out=3)
    assert found.counts() == {"done": 1, "failed": 0, "refused": 2, "missing": 3}
    assert not any(failure.status == "missing" for failure in found.failures())


def test_equal_failures_are_grouped(tmp_path: Path) -> None:
    """Failures that differ only in numbers are one group, the commonest first."""
    plan = make_plan({"settings.seed": {"seeds": 5}})
    store = Store(tmp_path)
    reasons = ["stopped at 1.5 s", "no memory", "stopped at 2.25 s", "stopped at 3 s"]
    for point, reason in zip(plan.points, reasons, strict=False):
        store.save(point.key, lost_row(reason))
    common, single = collect(plan, store).failures()
    assert (common.reason, common.cases) == ("stopped at 1.5 s", (1, 3, 4))
    assert single.as_dict() == {"status": "failed", "reason": "no memory", "cases": [2]}


def test_groups_follow_the_axes(table: StudyTable) -> None:
    """A curve over speed exists per stiffness, with the stiffness in its name."""
    found = groups(table, "speed")
    assert [group.label for group in found] == [
        "contact stiffness 50 kN/m",
        "contact stiffness 200 kN/m",
    ]
    assert found[1].values["0_20"][0] == pytest.approx(sigma(250 / 3.6, 2e5, 3))
    assert readable_axis(table.axes[0]) == ("speed [km/h]", [250.0, 300.0, 600.0])


@pytest.mark.parametrize(
    ("axes", "more", "figures"),
    [
        (
            AXES,
            {},
            [
                f"{what}-{axis}"
                for axis in ("speed", "contact_stiffness")
                for what in ("over", "extremes", "uplift")
            ],
        ),
        (
            {"settings.nodes_between_droppers": [9, 12], "settings.seed": {"seeds": 4}},
            {},
            ["bands-nodes_between_droppers", "over-nodes_between_droppers", "spread-seed"],
        ),
        (
            {"wires.contact.mass": {"low": 1.2, "high": 1.4}},
            {"samples": 4},
            ["spread-sample", "samples-mass"],
        ),
        (
            {"line.ends": ["anchored", "weighted"]},
            {},
            ["bands-ends", "extremes-ends", "uplift-ends"],
        ),
        (
            {"settings.seed": {"seeds": 10}, "scenario.speed": ["250 km/h", "300 km/h"]},
            {},
            ["spread-seed", "over-speed", "extremes-speed", "uplift-speed"],
        ),
    ],
)
def test_usual_figures(
    axes: dict[str, Any], more: dict[str, Any], figures: list[str], tmp_path: Path
) -> None:
    """The axes decide the figures: curves, bars by mesh and band, boxes over seeds, clouds."""
    found = fill(make_plan(axes, **more), tmp_path)
    drawn = {name: figure for name, figure, _ in usual_figures(found)}
    assert list(drawn) == figures
    assert all(figure.data for figure in drawn.values())


def test_report_page(table: StudyTable, tmp_path: Path) -> None:
    """The page is one file without references to other machines, with figures and all cases."""
    path = write_study_report(table, tmp_path / "study.html", {"Computed by": "2 processes"})
    text = path.read_text(encoding="utf-8")
    assert not re.search(r"""(?:src|href)=["']?https?:""", text)
    for part in ("Study test", "2 processes", "chart-over-speed", "wave speed", "300"):
        assert part in text
    assert text.count('class="verdict passed"') == 4


def test_report_of_an_empty_study(tmp_path: Path) -> None:
    """A study of which nothing was computed still gives a page, which says so."""
    found = collect(make_plan(AXES), Store(tmp_path / "none"))
    path = write_study_report(found, tmp_path / "study.html")
    assert "--resume" in path.read_text(encoding="utf-8")
