"""The command ``measured``: what it shows, writes and refuses."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tautwire.results.storage import load_run

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
    page = (tmp_path / "out" / "measured.html").read_text(encoding="utf-8")
    assert "hard spots by the step of that name" in page
    (event,) = invoke("measured", path, "--json").document["events"]
    assert (event["kind"], event["unit"]) == ("hard spot", "m/s^2")
    assert abs(event["position"] - 400.4) < 0.5
    told = invoke("measured", path, "--hard", "490 m/s2", "--json").document
    assert told["events"] == []
    assert told["steps"][-1]["source"] == "given"


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
    assert "make no pairs" in invoke("compare", run, run, "a.csv", "a.csv", "b.csv").err
    assert "no pantograph" in invoke("compare", run, "a.csv", "--pantograph", "fifth").err
    assert "'tautwire report" in invoke("measured", run).err


def test_compare_with_a_survey_of_the_wire(
    short_run: tuple[Path, Outcome], invoke: Invoke, tmp_path: Path
) -> None:
    """Height, stagger and residual thickness every 0.25 m, without a mapping or a force: height
    and stagger are compared with the static line, 10 mm too high on either."""
    shape = load_run(short_run[0] / "run.nc").equilibrium
    place = np.arange(20.0, 200.0, 0.25)
    wire = shape.contact_position
    height = 1e3 * np.interp(place, wire[:, 0], wire[:, 2]) + 10.0
    side = 1e3 * np.interp(place, wire[:, 0], wire[:, 1]) + 10.0
    rows = "".join(
        f"{x / 1e3:.5f},{z:.1f},{y:.1f},11.{int(x) % 10}\n"
        for x, z, y in zip(place, height, side, strict=True)
    )
    head = "Location [km],Height [mm],Stagger [mm],Residual thickness [mm]\n"
    (tmp_path / "wire.csv").write_text(head + rows)
    run = short_run[0] / "run.nc"
    told = invoke("compare", run, "wire.csv", "--json")
    assert told.code == 0, told.err
    (one,) = told.document["comparisons"]
    assert [row["quantity"] for row in one["geometry"]] == ["height", "stagger"]
    for row in one["geometry"]:
        assert abs(row["mean_m"] + 0.010) < 1e-4
        assert row["standard_deviation_m"] < 2e-4
    assert "simulated minus measured" in invoke("compare", run, "wire.csv").out
    assert invoke("compare", run, "wire.csv", "--offset", "5 km").code == 2
