"""The command ``measured``: what it shows, writes and refuses."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from tautwire.analyses.road.elasticity import elasticity
from tautwire.model.build import build
from tautwire.results.storage import load_run, save_run

from ..unit.synthetic import make_run
from .conftest import Invoke, Outcome


def _recording(path: Path, heads: str = "position [km];F_1_1 [N];F_1_2 [N];speed [km/h]") -> Path:
    place = np.arange(0.0, 1200.0, 0.25)
    force = 60.0 + 12.0 * np.sin(2 * np.pi * place / 50.0)
    noise = np.random.default_rng(3).normal(0.0, 0.2, (2, len(place)))
    rows = [
        f"{7.2 + x / 1e3:.5f};{f + a:.2f};{f + b:.2f};200"
        for x, f, a, b in zip(place, force, *noise, strict=True)
    ]
    rows[900] = rows[900].replace(rows[900].split(";")[1], "900.0")
    path.write_text("\n".join([heads, *rows]).replace(".", ","), encoding="utf-8")
    return path


def test_shows_and_writes(invoke: Invoke, tmp_path: Path) -> None:
    """Columns, faults, steps, figures and stretches are shown; page, JSON and tables are written;
    the mapping is kept and said to be used the second time."""
    path = _recording(tmp_path / "run.csv")
    shown = invoke("measured", path, "--out", "out")
    assert shown.code == 0, shown.err
    for text in ("sensor force strip 1 sensor 2 [N]", "spike", "sum of sensors", "cut-off 20 Hz",
                 "7 to 8 km", "mapping written"):  # fmt: skip
        assert text in shown.out + shown.err, text
    page = (tmp_path / "out" / "measured.html").read_text(encoding="utf-8")
    assert "900" in page
    assert "Every step of the processing" in page
    force = np.genfromtxt(tmp_path / "out" / "force.csv", delimiter=",", skip_header=1)
    assert force[0, 0] == 7200.0
    assert np.isnan(force[900, 1])
    assert abs(np.nanstd(force[:, 1]) - 24.0 / np.sqrt(2.0)) < 0.2
    again = invoke("measured", path, "--json")
    assert "columns read as" in again.err
    assert abs(again.document["force"]["mean"] - 120.0) < 0.3
    assert again.document["faults"][0]["kind"] == "spike"
    assert again.document["mapping"]["F_1_2 [N]"]["sensor"] == 2


def test_hard_spots_are_events(invoke: Invoke, tmp_path: Path) -> None:
    """A blow on an accelerometer is an event on the terminal, in JSON and on the page, beside how
    it was looked for; with a limit above it there is none. No force is needed."""
    place = np.arange(0.0, 1000.0, 0.1)
    rng = np.random.default_rng(4)
    acceleration = rng.normal(0.0, 5.0, len(place))
    acceleration[4000:4008] += 200.0
    rows = [f"{x:.2f},{a:.3f},200" for x, a in zip(place, acceleration, strict=True)]
    path = tmp_path / "blow.csv"
    path.write_text("\n".join(["position [m],AccZ_1_1 [m/s^2],speed [km/h]", *rows]))
    shown = invoke("measured", path, "--out", "out")
    assert shown.code == 0, shown.err
    assert "hard spot" in shown.out
    assert "examined share 1" in " ".join(shown.out.split())
    page = (tmp_path / "out" / "measured.html").read_text(encoding="utf-8")
    assert "hard spots by the step of that name" in page
    (event,) = invoke("measured", path, "--json").document["events"]
    assert (event["kind"], event["unit"]) == ("hard spot", "m/s^2")
    assert abs(event["position"] - 400.4) < 0.5
    told = invoke("measured", path, "--hard", "490 m/s2", "--json").document
    assert told["events"] == []
    assert told["steps"][-1]["source"] == "given"


def test_aerodynamic_force_by_direction(invoke: Invoke, tmp_path: Path) -> None:
    """The force of a table is added at the speed of the run, by direction, with and without
    strips; the step says so. A table without the direction, or that falls, is refused."""
    path = _recording(tmp_path / "run.csv")
    table = tmp_path / "air.csv"
    table.write_text("speed [km/h],force [N],reversed [N]\n100,-2,-4\n300,-10,-12\n")
    plain = invoke("measured", path, "--json").document["force"]["mean"]
    for options, added, word in (((), -6.0, "forward"), (("--reversed",), -8.0, "reversed")):
        told = invoke("measured", path, "--air", table, *options, "--json")
        assert told.code == 0, told.err
        assert told.document["force"]["mean"] == pytest.approx(plain + added, abs=1e-6)
        step = told.document["steps"][1]
        assert (step["name"], step["direction"]) == ("aerodynamic correction", word)
    table.write_text("speed [km/h],force [N]\n300,-10\n100,-2\n")
    refused = invoke("measured", path, "--air", table, "--reversed")
    assert refused.code == 2
    assert "the speeds must increase" in refused.err
    assert "add a column 'reversed [N]'" in refused.err


def test_refusals_have_a_cure(invoke: Invoke, tmp_path: Path) -> None:
    """Without speed and time the option is named, and giving it helps."""
    path = tmp_path / "bare.csv"
    path.write_text("position,force\n" + "".join(f"{n / 4},{100 + n % 7}\n" for n in range(400)))
    refused = invoke("measured", path)
    assert refused.code == 2
    assert "--speed '200 km/h'" in refused.err
    assert invoke("measured", path, "--speed", "200 km/h").code == 0
    assert invoke("measured", path, "--speed", "7 km").code == 2
    heavy = invoke("measured", path, "--speed", "200 km/h", "--strip-mass", "3 kg")
    assert heavy.code == 2
    assert "strip 1 has no accelerometer" in heavy.err
    assert "0 kg" in heavy.err
    light = invoke("measured", path, "--speed", "200 km/h", "--strip-mass", "0 kg", "--json")
    assert light.document["steps"][1] == {"name": "inertia correction", "mass_kg": {"1": 0.0}}


def test_compare_several(short_run: tuple[Path, Outcome], invoke: Invoke, tmp_path: Path) -> None:
    """One run beside two recordings gives two comparisons, one page and what both cover; files that
    make no pairs and pantographs that are not there are refused."""
    run = short_run[0] / "run.nc"
    rows = (short_run[0] / "force.csv").read_text(encoding="utf-8").splitlines()
    for name, offset in (("a.csv", 0.0), ("b.csv", 12_000.0)):
        cells = [row.split(",") for row in rows[1:]]
        text = "".join(f"{t};{float(x) + offset:.4f};{f}\n" for t, x, f, *_ in cells)
        (tmp_path / name).write_text("Zeit [s];Weg [m];Kontaktkraft [N]\n" + text)
    told = invoke("compare", run, "a.csv", "a.csv", "--out", "both", "--json")
    assert told.code == 0, told.err
    assert len(told.document["comparisons"]) == 2
    assert told.document["covers"]["lines"] == ["ac-simple"]
    assert {path.name for path in (tmp_path / "both").iterdir()} == {
        "comparison.html", "comparison.json", "forces.csv", "forces-2.csv",
    }  # fmt: skip
    apart = invoke("compare", run, "b.csv")
    assert apart.code == 2
    assert "give the offset of the measurement's zero" in apart.err
    assert invoke("compare", run, "b.csv", "--offset", "-12 km").code == 0
    assert "give a recording too" in invoke("compare", run).err
    turned = invoke("compare", "a.csv", run)
    assert (turned.code, turned.out) == (2, "")
    assert f"a.csv is no run, but {run} is; give the run first" in turned.err
    assert "a.csv is no run; give the result file of one first" in invoke("compare", "a.csv").err
    assert "is no run" in invoke("compare", "a.csv", "b.csv").err
    (tmp_path / "cut.nc").write_bytes(run.read_bytes()[:300])
    assert "cut.nc: is cut off" in invoke("compare", "cut.nc", "a.csv").err
    assert "make no pairs" in invoke("compare", run, run, "a.csv", "a.csv", "b.csv").err
    assert "no pantograph" in invoke("compare", run, "a.csv", "--pantograph", "fifth").err
    assert "'tautwire report" in invoke("measured", run).err


PUBLIC_FORCES = {
    "Finnish": (
        "Location [km+m],Ajonopeus [Km/h],PI.AccZ_1_1 [m/s^2],PI.AccZ_1_2 [m/s^2],PI.F_1_1 [N],"
        "PI.F_1_2 [N],PI.F_2_1 [N],PI.F_2_2 [N],PI.Stagger [mm],PI.Height_WS [mm]",
        ",", 1.0,
    ),
    "German": (
        "Kilometer [km];Geschwindigkeit [km/h];Beschleunigung 1_1 [m/s²];Beschleunigung 1_2 [m/s²];"
        "Kraft 1_1 [kN];Kraft 1_2 [kN];Kraft 2_1 [kN];Kraft 2_2 [kN];Seitenlage [mm];"
        "Fahrdrahthöhe [mm]",
        ";", 1e-3,
    ),
    "French": (
        "PK [km]\tVitesse [km/h]\tAccélération 1_1 [m/s2]\tAccélération 1_2 [m/s2]"
        "\tEffort 1_1 [daN]\tEffort 1_2 [daN]\tEffort 2_1 [daN]\tEffort 2_2 [daN]"
        "\tDésaxement [cm]\tHauteur [cm]",
        "\t", 0.1,
    ),
}  # fmt: skip
"""Headings, separator and unit of the force [1/N] of rows every 0.25 m with sensors."""


@pytest.mark.parametrize("language", PUBLIC_FORCES)
def test_compare_with_rows_of_sensors(
    language: str, short_run: tuple[Path, Outcome], invoke: Invoke, tmp_path: Path
) -> None:
    """Accelerations of the head, forces of four sensors, stagger and height every 0.25 m, under the
    headings and in the units of a country, are compared without a mapping: the force is that of
    the run, height and stagger are those of the line."""
    heads, separator, unit = PUBLIC_FORCES[language]
    run = load_run(short_run[0] / "run.nc")
    force = run.contact_force(run.pantographs[0].name)
    place = np.arange(20.0, 200.0, 0.25)
    total = np.interp(place, force.position, force.force)
    height = run.equilibrium.running_height(place) + 0.004
    stagger, length = run.equilibrium.running_stagger(place), 1e2 if language == "French" else 1e3
    random = np.random.default_rng(2)
    first = (
        [f"12+{x:07.2f}" for x in place] if language == "Finnish"
        else [f"{12.0 + x / 1e3:.5f}" for x in place]
    )  # fmt: skip
    speed, noise = 3.6 * run.case.scenario.speed, random.normal(0.0, 0.2, (4, len(place)))
    right = 0.5 + stagger  # of two sensors of a strip that are a metre apart
    shares = np.array([0.55 * right, 0.55 * (1.0 - right), 0.45 * right, 0.45 * (1.0 - right)])
    columns = [
        np.full(len(place), speed), *random.normal(0.0, 0.5, (2, len(place))),
        *(unit * shares * total + unit * noise),
        length * stagger, length * height,
    ]  # fmt: skip
    rows = [separator.join([x, *(f"{value:.5f}" for value in row)])
            for x, row in zip(first, zip(*columns, strict=True), strict=True)]  # fmt: skip
    text = "\n".join(rows) if language == "Finnish" else "\n".join(rows).replace(".", ",")
    (tmp_path / "rows.csv").write_text(f"{heads}\n{text}\n", encoding="utf-8")
    told = invoke(
        "compare", short_run[0] / "run.nc", "rows.csv", "--offset", "-12 km", "--search", "0 m",
        "--json", "--out", "out",
    )  # fmt: skip
    assert told.code == 0, told.err
    (one,) = told.document["comparisons"]
    assert one["evaluation"]["faults"] == []
    assert one["evaluation"]["steps"][0] == {"name": "sum of sensors", "sensors": 4}
    deviation = next(row for row in one["rows"] if row["quantity"] == "standard_deviation")
    assert abs(deviation["relative_difference"]) < 0.02
    wire = {row["quantity"]: row for row in one["geometry"]}
    assert abs(wire["height"]["mean_m"] + 0.004) < 5e-4
    assert abs(wire["stagger"]["largest_m"]) < 5e-4
    assert (tmp_path / "out" / "comparison.html").exists()
    assert told.document["covers"]["line_types"] == ["simple"]


PUBLIC_WIRE = {
    "English": "Location [km],Height [mm],Stagger [mm],Residual thickness [mm]",
    "German": "Kilometer [km],Fahrdrahthöhe [mm],Seitenlage [mm],Restdicke [mm]",
    "French": "PK [km],Hauteur [mm],Désaxement [mm],Épaisseur résiduelle [mm]",
    "Spanish": "PK [km],Altura [mm],Descentramiento [mm],Espesor residual [mm]",
    "Chinese": "里程 [km],导高 [mm],拉出值 [mm],残存高度 [mm]",
}
"""Headings of rows every 0.25 m with the place of the wire and what wear left of it."""


@pytest.mark.parametrize("language", PUBLIC_WIRE)
def test_compare_with_a_survey_of_the_wire(
    language: str, short_run: tuple[Path, Outcome], invoke: Invoke, tmp_path: Path
) -> None:
    """Height, stagger and residual thickness every 0.25 m, without a mapping or a force: height
    and stagger are compared with the static line, 10 mm too high on either; the thickness is told;
    a stagger with left and right exchanged is named."""
    shape = load_run(short_run[0] / "run.nc").equilibrium
    place = np.arange(20.0, 200.0, 0.25)
    wire = shape.contact_position
    height = 1e3 * np.interp(place, wire[:, 0], wire[:, 2]) + 10.0
    side = 1e3 * np.interp(place, wire[:, 0], wire[:, 1]) + 10.0
    for name, sign in (("wire.csv", 1.0), ("mirrored.csv", -1.0)):
        rows = "".join(
            f"{x / 1e3:.5f},{z:.1f},{sign * y:.1f},11.{int(x) % 10}\n"
            for x, z, y in zip(place, height, side, strict=True)
        )
        (tmp_path / name).write_text(f"{PUBLIC_WIRE[language]}\n{rows}", encoding="utf-8")
    run = short_run[0] / "run.nc"
    told = invoke("compare", run, "wire.csv", "--json")
    assert told.code == 0, told.err
    (one,) = told.document["comparisons"]
    assert [row["quantity"] for row in one["geometry"]] == ["height", "stagger"]
    for row in one["geometry"]:
        assert abs(row["mean_m"] + 0.010) < 1e-4
        assert row["standard_deviation_m"] < 2e-4
        assert row["note"] == ""
    thickness = next(r for r in one["evaluation"]["ranges"] if r["name"] == "thickness")
    assert (thickness["least"], thickness["largest"]) == (0.011, 0.0119)
    assert "left and right are exchanged" in invoke("compare", run, "mirrored.csv").err
    assert "simulated minus measured" in invoke("compare", run, "wire.csv").out
    assert invoke("compare", run, "wire.csv", "--offset", "5 km").code == 2


def test_compare_with_elasticity_and_uplift(
    short_run: tuple[Path, Outcome], invoke: Invoke, tmp_path: Path
) -> None:
    """Elasticity at supports and mid-span and uplift at supports under German headings: each place
    beside the run, with deviation and tolerance, in terminal, JSON and page, without a recording;
    a tolerance of one's own judges the elasticity."""
    run = load_run(short_run[0] / "run.nc")
    first, last = run.case.resolved_section()
    found = elasticity(build(run.case), run.equilibrium)
    masts = run.equilibrium.mast_x
    rows, truth = ["Feld;Stelle;Elastizität [mm/N];Anhub [mm]"], {}
    for span in range(first, last + 1):
        support, middle = masts[span - 1], masts[span - 1 : span + 1].mean()
        lift = 1e3 * float(run.support_uplift[:, span - 1].max()) + 12.0
        for word, x, more in (("Stützpunkt", support, f"{lift:.3f}"), ("Feldmitte", middle, "")):
            value = 1e3 * float(np.interp(x, found.x, found.elasticity))
            truth[round(float(x), 3)] = value
            rows.append(f"{span};{word};{1.05 * value:.5f};{more}")
    (tmp_path / "places.csv").write_text("\n".join(rows).replace(".", ","), encoding="utf-8")
    shown = invoke("compare", short_run[0] / "run.nc", "--points", "places.csv", "--out", "out")
    assert shown.code == 0, shown.err
    for text in ("elasticity", "missed", "within the tolerance"):
        assert text in shown.out, text
    page = (tmp_path / "out" / "comparison.html").read_text(encoding="utf-8")
    assert "Elasticity and uplift at places" in page
    told = json.loads((tmp_path / "out" / "comparison.json").read_text(encoding="utf-8"))
    (points,) = told["points"]
    assert points["elasticity_force_n"] == found.force
    elastic = [r for r in points["rows"] if r["numbers"]["quantity"] == "elasticity"]
    assert [r["x_m"] for r in elastic] == pytest.approx(sorted(truth), abs=1e-3)
    for row in elastic:
        assert row["numbers"]["simulated"] == pytest.approx(1e-3 * truth[round(row["x_m"], 3)])
        assert row["numbers"]["relative_difference"] == pytest.approx(1 / 1.05 - 1, abs=1e-4)
        assert row["numbers"]["within"] is None
    lifts = [r["numbers"] for r in points["rows"] if r["numbers"]["quantity"] == "uplift"]
    assert [one["difference"] for one in lifts] == pytest.approx([-0.012] * len(lifts), abs=1e-5)
    assert {one["within"] for one in lifts} == {False}
    assert {one["verified"] for one in lifts} == {False}
    limits = invoke("limits", "--copy", "own.yaml")
    assert limits.code == 0, limits.err
    own = tmp_path / "own.yaml"
    own.write_text(own.read_text(encoding="utf-8") + OWN_TOLERANCE, encoding="utf-8")
    judged = invoke("compare", short_run[0] / "run.nc", "--points", "places.csv", "--limits", own,
                    "--json")  # fmt: skip
    assert judged.code == 0, judged.err
    numbers = [r["numbers"] for r in judged.document["points"][0]["rows"]]
    assert {one["passed"] for one in numbers if one["quantity"] == "elasticity"} == {True}


def test_compare_says_that_a_run_is_not_complete(invoke: Invoke, tmp_path: Path) -> None:
    """A run that stopped is told once on the terminal, its state stands in the JSON, and supports
    that it did not reach are left out."""
    save_run(make_run(status="partial", duration=4.0), tmp_path / "part.nc")
    (tmp_path / "places.csv").write_text("Support,Uplift [mm]\n5,30\n12,30\n")
    shown = invoke("compare", "part.nc", "--points", "places.csv")
    assert shown.code == 0, shown.err
    assert shown.err.count("not complete") == 1
    assert "part.nc: the run is not complete (partial" in shown.err
    assert "no pantograph reached" in shown.err
    (points,) = invoke("compare", "part.nc", "--points", "places.csv", "--json").document["points"]
    assert points["status"] == "partial"
    assert [row["place"] for row in points["rows"]] == ["support 5"]


OWN_TOLERANCE = """
  - id: elasticity-measured
    name: elasticity
    quantity: elasticity
    relative: true
    low: -0.1
    high: 0.1
    unit: "1"
    standard: works specification
    edition: "7"
    clause: "3.2"
    verified: true
    verified_by: A. Reader
    verified_on: 2026-01-31
    confidence: seen
    note: "simulated minus measured"
"""


def test_places_that_are_not_there_are_refused(
    short_run: tuple[Path, Outcome], invoke: Invoke, tmp_path: Path
) -> None:
    """Every wrong row is named with its cure: a mast and a support that the line does not have, an
    uplift away from supports, a unit that is missing; a survey of other things, too."""
    run = short_run[0] / "run.nc"
    (tmp_path / "a.csv").write_text("Support,Uplift [mm]\n77,30\n2,40\n")
    (tmp_path / "b.csv").write_text("Position [m],Uplift [mm]\n30,30\n")
    (tmp_path / "c.csv").write_text("Span,Point,Elasticity\n2,mid-span,0.4\n2,somewhere,0.0004\n")
    (tmp_path / "d.csv").write_text("Support,Contact height [m]\n2,5.1\n")
    for name, words in (
        ("a.csv", ("row 2: names support 77; the line has 5",)),
        ("b.csv", ("x = 30.0 m, which is no support",)),
        ("c.csv", ("say the unit in the heading, as in 'Elasticity [mm/N]'", "'somewhere'")),
        ("d.csv", ("holds neither elasticity nor uplift",)),
    ):
        refused = invoke("compare", run, "--points", name)
        assert refused.code == 2, refused.out
        for text in words:
            assert text in refused.err


def test_air_table_without_unit_or_too_short(invoke: Invoke, tmp_path: Path) -> None:
    """Speeds of no train are refused at their cell, as km/h without a unit are; the step tells
    which share of the samples lies beyond the table, and at which speeds."""
    path = _recording(tmp_path / "run.csv")
    table = tmp_path / "air.csv"
    table.write_text("speed,force\n100,-2\n300,-10\n")
    refused = invoke("measured", path, "--air", table)
    assert refused.code == 2
    assert "line 3, column 'speed': got 300 m/s" in refused.err
    assert "say the unit, as in 'speed [km/h]'" in refused.err
    table.write_text("speed [km/h],force [N]\n250,-2\n300,-10\n")
    beyond = invoke("measured", path, "--air", table, "--json").document["steps"][1]
    assert beyond["share_beyond_table"] == 1.0
    assert beyond["speeds_beyond_m_s"] == pytest.approx([200 / 3.6, 200 / 3.6])
    assert "share beyond table 1" in invoke("measured", path, "--air", table).out
    table.write_text("speed [km/h],force [N]\n200,-2\n300,-10\n")
    within = invoke("measured", path, "--air", table, "--json").document["steps"][1]
    assert "share_beyond_table" not in within
