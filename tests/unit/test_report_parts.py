"""Parts of the report: thinning, packing, words, inputs, labels, spreadsheets."""

from __future__ import annotations

import base64
import csv
import dataclasses
import io
import zlib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tautwire.analyses.road.shape import find_shape
from tautwire.errors import InputError
from tautwire.inputs.load import load_case
from tautwire.model.build import build
from tautwire.report.figures import packing
from tautwire.report.figures.force_figures import force_figure, passings
from tautwire.report.figures.line_figures import line_figure
from tautwire.report.parts import words
from tautwire.report.parts.blocks import Table
from tautwire.report.parts.conditions import GROUPS, input_values, source_of
from tautwire.report.parts.sections import force_section
from tautwire.report.parts.tables import (
    dropper_table_csv,
    force_history_csv,
    write_dropper_table,
    write_force_history,
)
from tautwire.report.parts.views import finite_part, labels_of, prepare
from tautwire.results.equilibrium import Equilibrium
from tautwire.results.run import Run

from .synthetic import make_case, make_equilibrium, make_run


def test_thinning_keeps_every_extreme() -> None:
    """Of a long record the ends and the largest and smallest value of every piece are drawn."""
    values = np.random.default_rng(0).normal(size=100_000)
    values[54_321], values[12_345] = 40.0, -40.0
    kept = packing.thinned(values, 2_002)
    assert kept.size <= 2_002
    assert np.all(np.diff(kept) > 0)
    assert {0, 12_345, 54_321, 99_999} <= set(kept.tolist())
    pieces = np.array_split(values, 1_000)
    drawn = np.array_split(np.where(np.isin(np.arange(values.size), kept), values, np.nan), 1_000)
    assert all(np.nanmax(d) == p.max() for p, d in zip(pieces, drawn, strict=True))


def test_short_records_are_not_thinned() -> None:
    """A record within the limit is drawn sample by sample."""
    assert np.array_equal(packing.thinned(np.ones(50), 50), np.arange(50))


def test_thinning_survives_values_that_are_not_finite() -> None:
    """NaN in a long record neither fails nor hides an extreme."""
    values = np.zeros(10_000)
    values[5_000:5_100] = np.nan
    values[7_000] = 3.0
    assert 7_000 in packing.thinned(values, 200)


def test_packed_steps_are_exact_to_half_a_step() -> None:
    """Values packed as 255 steps read back within half a step; NaN becomes the smallest."""
    values = np.linspace(-0.02, 0.12, 999).reshape(3, 333)
    values[1, 1] = np.nan
    packed = packing.steps(values)
    assert packed["row"] == 333
    changes = np.frombuffer(zlib.decompress(base64.b64decode(packed["data"])), "u1")
    whole = np.cumsum(changes.reshape(3, 333), axis=0, dtype="u1")
    back = packed["low"] + packed["step"] * whole
    expected = np.where(np.isnan(values), -0.02, values)
    assert np.abs(back - expected).max() <= 0.5001 * packed["step"]


def test_packed_constants_stay() -> None:
    """A constant and an empty record can be packed."""
    assert packing.steps(np.full((2, 4), 5.3))["low"] == pytest.approx(5.3)
    empty = packing.steps(np.empty((0, 4)))
    assert zlib.decompress(base64.b64decode(empty["data"])) == b""


def test_even_places_are_written_once() -> None:
    """Where points are evenly apart, the first and the distance are enough; where not, all stay."""
    x = np.linspace(100.0, 1035.0, 10_000, dtype=np.float32)
    short = packing.even(x)
    assert short["x0"] == 100.0
    assert short["x0"] + 9_999 * short["dx"] == pytest.approx(1035.0, abs=1e-6)
    x[5_000] += 0.01
    assert packing.even(x) == {"x": x}
    assert packing.even(x[:1]).keys() == {"x"}


@pytest.mark.parametrize(
    ("got", "text"),
    [
        (words.number(-0.04), "0.0"),
        (words.number(-12.34), "\N{MINUS SIGN}12.3"),
        (words.number(float("nan")), "–"),
        (words.number(None), "–"),
        (words.readable(0.0654, "m"), "65.4\N{NO-BREAK SPACE}mm"),
        (words.readable(2.06e-4, "m/N"), "0.2060\N{NO-BREAK SPACE}mm/N"),
        (words.readable(None, "N"), "–"),
        (words.speed(320 / 3.6), "320\N{NO-BREAK SPACE}km/h"),
        (words.band("5_20"), "5–20\N{NO-BREAK SPACE}Hz"),
        (words.listing(["a", "b", "c"]), "a, b and c"),
        (words.counted(1, "time"), "1 time"),
        (words.counted(2, "time"), "2 times"),
    ],
)
def test_numbers_read_well(got: str, text: str) -> None:
    """Numbers carry unit and minus sign, and a dash where there is none."""
    assert got == text


def test_every_input_is_listed_with_its_unit() -> None:
    """No value of a case is left out, and quantities carry their SI unit."""
    case = make_case(spans=3, pantographs=2)
    values = dict(input_values(case))
    assert values["wires.contact.tension"] == "22000 N"
    assert values["pantographs[2].behind"] == "100 m"
    assert values["pantographs[1].stages[3].damping"] == "70 N s/m"
    assert values["scenario.speed"] == "88.88889 m/s"
    assert values["line.ends.left"] == "anchored"
    assert values["settings.section"] == "not given"

    def leaves(part: Any) -> int:
        if isinstance(part, dict):
            return sum(leaves(item) for item in part.values())
        if isinstance(part, list) and part and isinstance(part[0], dict):
            return sum(leaves(item) for item in part)
        return 1

    parts = case.to_dict()
    assert values.pop("track") == "straight and level"
    told = [name for name in GROUPS if name != "track" and parts[name] != []]
    assert len(values) == sum(leaves(parts[name]) for name in told)


def test_track_is_listed_as_it_is_given() -> None:
    """Of a track that bends only what is given is shown."""
    arc = {"arc": 200.0, "radius": 900.0, "side": "left", "cant": 0.06}
    values = dict(input_values(make_case(spans=3, track=[arc])))
    shown = {path: text for path, text in values.items() if path.startswith("track")}
    first = "track.pieces[1]"
    assert shown == {
        f"{first}.arc": "200 m",
        f"{first}.radius": "900 m",
        f"{first}.side": "left",
        f"{first}.cant": "0.06 m",
        "track.rail_distance": "1.5 m",
    }


def test_long_lists_are_shortened() -> None:
    """Per-support values beyond twelve are counted, not listed."""
    heights = [5.3] * 18
    supports = make_case().supports.to_dict() | {"contact_height": heights}
    shown = dict(input_values(make_case(supports=supports)))["supports.contact_height"]
    assert shown.endswith("… 6 more values m")


@pytest.mark.parametrize(
    ("path", "index"),
    [
        ("wires.contact.tension", 1),
        ("wires.contact.mass", 0),
        ("wiresx", None),
        ("pantographs[2].stages[1].mass", 2),
        ("pantographs[1].stages[1].mass", 3),
        ("droppers.mass", None),
    ],
)
def test_smallest_group_gives_the_source(path: str, index: int | None) -> None:
    """A value takes the source of the smallest group that names it; an item beats its list."""
    sources = ["wires", "wires.contact.tension", "pantographs", "pantographs[1].stages"]
    assert source_of(path, sources) == index


def test_labels_tell_runs_apart() -> None:
    """Runs are named by what differs; equal ones by number; given labels are taken."""
    first = make_run(make_case(spans=2), duration=0.01)
    case = first.case.with_(**{"scenario.speed": 250 / 3.6})
    slow = dataclasses.replace(first, case=case)
    other = dataclasses.replace(first, case=first.case.with_(name="other"))
    assert labels_of([first]) == ["synthetic"]
    assert labels_of([first, slow]) == ["320 km/h", "250 km/h"]
    assert labels_of([first, other]) == ["synthetic", "other"]
    assert labels_of([first, first]) == ["synthetic (1)", "synthetic (2)"]
    assert labels_of([first, slow], ["a", "b"]) == ["a", "b"]


def test_passing_frequencies_are_those_of_the_line() -> None:
    """Spans of 55 m are passed at 1.616 Hz, droppers of 5.75 m at 15.46 Hz at 320 km/h."""
    lines = {(p.name, p.order): p.frequency for p in passings(prepare(make_run(), "x"))}
    assert lines["span", 1] == pytest.approx(1.616, abs=1e-3)
    assert lines["droppers", 1] == pytest.approx(15.46, abs=1e-2)
    assert lines["droppers", 2] == pytest.approx(30.92, abs=1e-2)
    assert lines["support to dropper", 1] == pytest.approx(19.75, abs=1e-2)


def _rows(text: str) -> list[list[str]]:
    return list(csv.reader(io.StringIO(text)))


def test_dropper_table_has_units_and_all_droppers() -> None:
    """The dropper table has one row per dropper and units in its head."""
    case = make_case(spans=3)
    shape = make_equilibrium(case)
    head, *rows = _rows(dropper_table_csv(shape, case))
    assert head[:5] == ["span", "dropper", "position [m]", "x [m]", "unstrained length [m]"]
    assert "force [N]" in head
    assert len(rows) == 27
    assert rows[9][:2] == ["2", "1"]
    assert [float(rows[9][2]), float(rows[9][3])] == [4.5, 59.5]
    assert float(rows[9][4]) == pytest.approx(shape.dropper_lengths_unstrained[9], abs=1e-6)


def test_force_history_names_its_filters() -> None:
    """The force history has the unfiltered force and both low-passes, named with cut-off."""
    run = make_run(make_case(spans=3))
    head, *rows = _rows(force_history_csv(run))
    assert head == [
        "time [s]",
        "position [m]",
        "force [N]",
        "force, sharp low-pass 20 Hz [N]",
        "force, sharp low-pass 200 Hz [N]",
    ]
    assert len(rows) == run.time.size
    assert float(rows[500][2]) == pytest.approx(run.pantographs[0].contact_force[500], abs=1e-4)


def two_wires(run: Run) -> Run:
    """Return a run in which the force goes from one contact wire to another half-way."""
    shape = run.equilibrium
    more = make_two_contact_wires(shape)
    record = run.pantographs[0]
    shares = np.full((run.time.size, 2), np.nan)
    half = run.time.size // 2
    shares[:half, 0] = record.contact_force[:half]
    shares[half:, 1] = record.contact_force[half:]
    return replace(run, equilibrium=more, pantographs=(replace(record, wire_forces=shares),))


def make_two_contact_wires(shape: Equilibrium) -> Equilibrium:
    """Return a static state that calls its messenger wire a second contact wire."""
    return replace(shape, wire_names=("T1 contact", "T2 contact"), wire_roles=("contact",) * 2)


def test_shares_of_contact_wires_are_written_and_drawn() -> None:
    """The force on each contact wire is a column of the CSV, a curve of the figure and a row of the
    report; together they are the contact force. With one contact wire there is nothing of it."""
    run = two_wires(make_run(make_case(spans=3)))
    head, *rows = _rows(force_history_csv(run))
    assert head[-2:] == ["force on T1 contact [N]", "force on T2 contact [N]"]
    total = run.pantographs[0].contact_force
    for at in (200, -200):
        assert float(rows[at][-2]) + float(rows[at][-1]) == pytest.approx(total[at], abs=2e-4)
    view = prepare(run, "")
    force = view.forces[0]
    assert sum(force.shares.values()) == pytest.approx(force.low, abs=1e-6)
    names = {curve.get("name") for curve in force_figure([view]).to_dict()["data"]}
    assert {"0–20 Hz on T1 contact", "0–20 Hz on T2 contact"} <= names
    table = next(block for block in force_section([view]).blocks if isinstance(block, Table))
    record = run.pantographs[0]
    half = run.time.size // 2
    first, second = table.rows
    assert (first[0], second[0]) == ("T1 contact", "T2 contact")
    assert float(str(first[2])) == pytest.approx(record.position[half - 1], abs=0.06)
    assert float(str(second[1])) == pytest.approx(record.position[half], abs=0.06)
    assert float(str(first[3])) + float(str(second[3])) == pytest.approx(100.0, abs=0.11)
    alone = prepare(make_run(make_case(spans=3)), "")
    assert alone.forces[0].shares == {}
    assert not any(isinstance(block, Table) for block in force_section([alone]).blocks)


def test_a_record_is_cut_with_its_shares() -> None:
    """Where a force is not finite, every history of the pantograph ends before it."""
    run = two_wires(make_run(make_case(spans=3)))
    run.pantographs[0].contact_force[300:] = np.nan
    cut = finite_part(run).pantographs[0]
    assert len(cut.wire_forces) == len(cut.contact_force) == 300


def test_force_history_of_a_pantograph_that_never_entered() -> None:
    """A pantograph without a record gives the head alone; an unknown one is refused."""
    run = make_run(make_case(spans=3), entering=False)
    assert force_history_csv(run) == "time [s],position [m],force [N]\n"
    with pytest.raises(InputError, match="no pantograph named"):
        force_history_csv(run, "middle")


def test_tables_are_written_whole(tmp_path: Path) -> None:
    """Tables are written under their names and nothing else is left."""
    run = make_run(make_case(spans=2), duration=0.1)
    write_dropper_table(run.equilibrium, run.case, tmp_path / "droppers.csv")
    write_force_history(run, tmp_path / "force.csv", "front")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["droppers.csv", "force.csv"]
    with pytest.raises(InputError, match="does not exist"):
        write_dropper_table(run.equilibrium, run.case, tmp_path / "nowhere" / "droppers.csv")


def test_importing_the_page_is_light() -> None:
    """Importing the report loads neither plotly nor jinja2 nor scipy."""
    import subprocess
    import sys

    code = (
        "import sys, tautwire.report.pages.run_page;"
        "print({'plotly', 'jinja2', 'scipy'} & set(sys.modules))"
    )
    answer = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert answer.stdout.strip() == "set()"


def test_stitch_wires_share_an_entry_of_the_legend() -> None:
    """However many stitch wires a line has, its figure names them once."""
    case = load_case("ac-stitched", {"line.spans": 4})
    figure = line_figure(case, find_shape(build(case)), 1)
    curves = [one for one in figure.to_dict()["data"] if one.get("name") == "stitch wires"]
    assert len(curves) >= 3
    assert sum(curve["showlegend"] for curve in curves) == 1


def test_wires_are_drawn_where_they_are() -> None:
    """Between the points that are drawn, a wire lies within half a millimetre of where it is, its
    sag within a tenth; fewer points than nodes are drawn."""
    case = load_case("ac-simple", {"line.spans": 3, "settings.section": [1, 3]})
    shape = find_shape(build(case))
    x, _, z = shape.contact.position.T
    sag = 1e3 * (shape.support_line(shape.wire_names.index("contact"), x) - z)
    lines = [trace for trace in line_figure(case, shape, 1).data if trace.get("name") == "contact"]
    for trace, own, off in zip(lines, (z, sag), (5.1e-4, 0.102), strict=False):
        drawn = np.interp(x, trace["x"], trace["y"])
        assert np.abs(drawn - own).max() < off
        assert len(trace["x"]) < 0.7 * len(x)
