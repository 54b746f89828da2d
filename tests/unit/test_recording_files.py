"""Recordings as recorders write them: dialects, formats, units, directions, gaps, mappings."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
import pytest

import tautwire as tw
from tautwire.errors import InputError
from tautwire.inputs.reading.recording import open_recording
from tautwire.measured.evaluation import Treatment, evaluate
from tautwire.measured.recording import Recording

SPEED = 50.0
COUNT = 1200
TIME = 0.005 * np.arange(COUNT)
PLACE = 12_000.0 + SPEED * TIME
FORCE = (
    120.0
    + 25.0 * np.sin(2 * np.pi * PLACE / 50.0)
    + 9.0 * np.sin(2 * np.pi * PLACE / 6.25)
    + np.random.default_rng(1).normal(0.0, 0.3, COUNT)
)
HEIGHT = 5.3 - 0.02 * np.cos(2 * np.pi * PLACE / 50.0)
STAGGER = 0.2 * np.cos(np.pi * PLACE / 50.0)


def written(path: Path, text: str, encoding: str = "utf-8") -> Path:
    """Write a text file."""
    path.write_bytes(text.encode(encoding))
    return path


def table(heads: list[str], columns: list[Any], form: str = "%.4f", separator: str = ",") -> str:
    """Return a table as text."""
    rows = [separator.join(form % value for value in row) for row in zip(*columns, strict=True)]
    return "\n".join([separator.join(heads), *rows]) + "\n"


def load(path: Path, **options: Any) -> Recording:
    """Load a recording with the speed at which these were made."""
    return tw.load_recording(path, speed=SPEED, **options)


def check_force(recording: Recording, atol: float = 0.06) -> None:
    """See that force, time and way are those that were written."""
    np.testing.assert_allclose(recording.forces.sum(axis=0), FORCE, atol=atol)
    np.testing.assert_allclose(np.diff(recording.time), 0.005, atol=2e-4)
    assert recording.distance is not None
    np.testing.assert_allclose(recording.distance, PLACE - PLACE[0], atol=0.02)


DIALECTS: dict[str, Callable[[Path], Path]] = {
    "plain": lambda f: written(f, table(["time", "position", "force"], [TIME, PLACE, FORCE])),
    "semicolon, decimal comma, cp1252, preamble, row of units": lambda f: written(
        f,
        "Messzug 7, Fahrt von Süd nach Nord\n\n"
        + table(["Zeit", "Weg", "Kontaktkraft", "Fahrdrahthöhe"],
                [TIME, PLACE / 1e3, FORCE, 1e3 * HEIGHT], "%.6f", ";")
        .replace(".", ",").replace("höhe\n", "höhe\ns;km;N;mm\n"),
        "cp1252",
    ),
    "byte order mark, tabs, kN": lambda f: written(
        f, table(["t [ms]", "km [km]", "F [kN]"], [1e3 * TIME, PLACE / 1e3, FORCE / 1e3], "%.6f",
                 "\t"), "utf-8-sig"
    ),
    "UTF-16": lambda f: written(
        f, table(["time [s]", "PK [m]", "effort de contact [N]"], [TIME, PLACE, FORCE]), "utf-16"
    ),
    "blanks and comments": lambda f: written(
        f,
        "# recorder 4\n"
        + table(["time_s", "distance_m", "force_N"], [TIME, PLACE, FORCE], separator="  ")
        .replace("\n", "\n# a remark, with a comma\n", 1),
    ),
    "daN, units after a slash": lambda f: written(
        f, table(["v / km/h", "s / s", "Zeit / s", "Weg / m", "Kraft / daN"],
                 [np.full(COUNT, 180.0), TIME, TIME, PLACE, FORCE / 10.0], "%.5f", ";")
    ),
    "units in the cells": lambda f: written(
        f,
        "time;position;force\n"
        + "".join(f"{t:.3f};{x:.2f} m;{v:.2f} N\n"
                  for t, x, v in zip(TIME, PLACE, FORCE, strict=True)),
    ),
    "clock past midnight": lambda f: written(
        f,
        "Uhrzeit,location,contact force [N]\n"
        + "".join(
            f"{t // 3600 % 24:02.0f}:{t // 60 % 60:02.0f}:{t % 60:06.3f}"
            f",{x // 1000:.0f}+{x % 1000:06.2f},{v:.2f}\n"
            for t, x, v in zip((86397 + TIME).tolist(), PLACE.tolist(), FORCE.tolist(), strict=True)
        ),
    ),
}  # fmt: skip


@pytest.mark.parametrize("dialect", DIALECTS)
def test_dialects(dialect: str, tmp_path: Path) -> None:
    """Separators, decimal commas, encodings, preambles, rows of units, comments, units anywhere."""
    check_force(load(DIALECTS[dialect](tmp_path / "run.csv")))


def test_a_quoted_text_with_separators(tmp_path: Path) -> None:
    """A quoted cell may hold separators; a column of texts is no channel."""
    rows = table(["position [m]", "contact force [kgf]"], [PLACE, FORCE / 9.80665], "%.5f")
    lines = rows.splitlines()
    text = "\n".join(["Track," + lines[0], *(f'"001, up; 2",{line}' for line in lines[1:])])
    recording = load(written(tmp_path / "run.csv", text))
    np.testing.assert_allclose(recording.forces[0], FORCE, atol=0.01)


def _xlsx(path: Path) -> Path:
    import openpyxl

    book = openpyxl.Workbook()
    assert book.active is not None
    book.active.append(["about", "this run"])
    sheet = book.create_sheet("values")
    sheet.append(["Time [s]", "Kilometer [km]", "Contact force [N]"])
    for row in zip(TIME.tolist(), (PLACE / 1e3).tolist(), FORCE.tolist(), strict=True):
        sheet.append(row)
    path = path.with_suffix(".xlsx")
    book.save(path)
    return path


def _mat5(path: Path) -> Path:
    from scipy.io import savemat

    run = {"time": TIME, "position": PLACE, "force": {"data": FORCE / 1e3, "unit": "kN"}}
    savemat(path.with_suffix(".mat"), {"run": run, "title": "a run"})
    return path.with_suffix(".mat")


def _mat73(path: Path) -> Path:
    import h5py

    path = path.with_suffix(".mat")
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in (("time", TIME), ("position", PLACE), ("force", FORCE)):
            file.create_dataset(f"run/{name}", data=values[None])
    content = bytearray(path.read_bytes())
    content[:19] = b"MATLAB 7.3 MAT-file"
    path.write_bytes(content)
    return path


def _netcdf4(path: Path) -> Path:
    import h5netcdf

    path = path.with_suffix(".nc")
    with h5netcdf.File(path, "w") as file:
        file.dimensions = {"sample": COUNT}
        for name, values, unit in (
            ("time", TIME, "s"), ("position", PLACE / 1e3, "km"), ("force", FORCE, "N"),
        ):  # fmt: skip
            file.create_variable(name, ("sample",), data=values).attrs["units"] = unit
    return path


def _netcdf3(path: Path) -> Path:
    from scipy.io import netcdf_file

    path = path.with_suffix(".nc")
    with netcdf_file(path, "w") as file:
        file.createDimension("sample", COUNT)
        for name, values in (("time", TIME), ("position", PLACE), ("force", FORCE)):
            file.createVariable(name, "d", ("sample",))[:] = values
    return path


def _parquet(path: Path) -> Path:
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    columns = {"time [s]": TIME, "position [m]": PLACE, "force [N]": FORCE, "train": ["A"] * COUNT}
    parquet.write_table(pyarrow.table(columns), path.with_suffix(".parquet"))
    return path.with_suffix(".parquet")


def _tdms(path: Path) -> Path:
    nptdms = pytest.importorskip("nptdms")
    path = path.with_suffix(".tdms")
    wave = {"wf_increment": 0.005, "unit_string": "N"}
    with nptdms.TdmsWriter(path) as writer:
        writer.write_segment([
            nptdms.ChannelObject("Panto", "Kontaktkraft", FORCE, properties=wave),
            nptdms.ChannelObject("Panto", "Weg", PLACE, properties={"unit_string": "m"}),
            nptdms.ChannelObject("Slow", "temperature", np.arange(10.0)),
        ])  # fmt: skip
    return path


@pytest.mark.parametrize(
    "make", [_xlsx, _mat5, _mat73, _netcdf4, _netcdf3, _parquet, _tdms], ids=lambda f: f.__name__
)
def test_formats(make: Callable[[Path], Path], tmp_path: Path) -> None:
    """Workbooks, MAT of both kinds, netCDF of both kinds, Parquet and TDMS hold the same run."""
    check_force(load(make(tmp_path / "run")))


def _mat_of_rates(path: Path) -> Path:
    from scipy.io import savemat

    slow, slower = TIME[::5], np.arange(0.0, TIME[-1], 0.5)
    rates = {
        "fast": {"time": TIME, "force": FORCE},
        "slow": {"time": slow, "height": np.interp(slow, TIME, HEIGHT)},
        "train": {"time": slower, "position": np.interp(slower, TIME, PLACE)},
        "other": {"temperature": np.arange(7.0)},
    }
    savemat(path.with_suffix(".mat"), rates)
    return path.with_suffix(".mat")


def _tdms_of_rates(path: Path) -> Path:
    nptdms = pytest.importorskip("nptdms")
    path = path.with_suffix(".tdms")
    slow = np.arange(0.0, TIME[-1], 0.05)
    fast = {"wf_increment": 0.005, "unit_string": "N"}
    with nptdms.TdmsWriter(path) as writer:
        writer.write_segment([
            nptdms.ChannelObject("Train", "Weg", np.interp(slow, TIME, PLACE),
                                 properties={"wf_increment": 0.05, "unit_string": "m"}),
            nptdms.ChannelObject("Train", "Height", np.interp(slow, TIME, HEIGHT),
                                 properties={"wf_increment": 0.05, "unit_string": "m"}),
            nptdms.ChannelObject("Panto", "Kontaktkraft", FORCE, properties=fast),
            nptdms.ChannelObject("Slow", "temperature", np.arange(10.0)),
        ])  # fmt: skip
    return path


@pytest.mark.parametrize("make", [_mat_of_rates, _tdms_of_rates], ids=lambda f: f.__name__)
def test_several_sampling_rates(make: Callable[[Path], Path], tmp_path: Path) -> None:
    """Channels of other rates are interpolated to the fastest clock, which is said; nothing is
    continued beyond their last sample; the mapping that is written reads the file in the same
    way."""
    path = make(tmp_path / "run")
    opened = open_recording(path)
    recording = opened.recording
    count = len(recording.time)
    assert COUNT - 100 <= count < COUNT
    np.testing.assert_allclose(recording.forces[0], FORCE[:count])
    assert recording.height is not None
    known = ~np.isnan(recording.height)
    assert known[: COUNT - 110].all()
    np.testing.assert_allclose(recording.height[known], HEIGHT[:count][known], atol=2e-3)
    assert recording.chainage is not None
    np.testing.assert_allclose(recording.chainage, PLACE[:count], atol=1e-6)
    assert any("interpolated linearly to the 200" in note for note in recording.notes)
    assert any("temperature" in note for note in recording.notes if "not read" in note)
    opened.mapping_file.write_text(opened.mapping_text(), encoding="utf-8")
    again = open_recording(path)
    assert not again.is_proposed
    np.testing.assert_array_equal(again.recording.height, recording.height)


def test_measuring_train_with_sensors(tmp_path: Path) -> None:
    """Rows every 0.25 m with four sensors, two accelerometers, stagger and height, gaps written as
    words and a total of the recorder's own: found without a mapping, timed by the speed."""
    place = np.arange(0.0, 300.0, 0.25)
    force = 120.0 + 25.0 * np.sin(2 * np.pi * place / 50.0)
    head = (
        "Count,Location [km+m],Nopeus [km/h],P.AccZ_1_1 [m/s^2],P.AccZ_2_1 [m/s^2],P.F_1_1 [N],"
        "P.F_1_2 [N],P.F_2_1 [N],P.F_2_2 [N],P.Fext [N],P.Stagger [mm],P.Height_WS [mm]\n"
    )
    rows = [
        f"{n},45+{x:07.2f},216.0,{0.1 * np.sin(n):.3f},{0.1 * np.cos(n):.3f},{f / 4:.2f},"
        f"{f / 4 + 1:.2f},{f / 4:.2f},"
        f"{'epäluku' if n in (40, 41) else f'{f / 4 - 1:.2f}'},{f + 3:.2f},"
        f"{150 * np.cos(np.pi * x / 50):.1f},5300\n"
        for n, (x, f) in enumerate(zip(place.tolist(), force.tolist(), strict=True))
    ]
    recording = tw.load_recording(written(tmp_path / "run.csv", head + "".join(rows)))
    assert recording.force_strips.tolist() == [1, 1, 2, 2]
    assert recording.acceleration_strips.tolist() == [1, 2]
    assert np.isnan(recording.forces[3]).nonzero()[0].tolist() == [40, 41]
    assert recording.interval == pytest.approx(0.25 / 60.0)
    assert recording.chainage is not None
    assert recording.chainage[0] == 45_000.0
    assert recording.stagger is not None
    assert recording.stagger[0] == pytest.approx(0.15)
    assert any("'epäluku' 2 times" in note for note in recording.notes)
    found = evaluate(recording)
    assert found.force is not None
    assert found.force.mean == pytest.approx(123.0, abs=0.1)
    assert found.steps[0]["name"] == "contact force as recorded"
    assert found.steps[0]["mean_above_their_sum_n"] == pytest.approx(3.0, abs=0.01)
    corrected = evaluate(recording, Treatment(masses={1: 2.0, 2: 2.0})).steps
    assert [step["name"] for step in corrected][:2] == ["sum of sensors", "inertia correction"]


def test_geometry_alone(tmp_path: Path) -> None:
    """Height, stagger and residual thickness every 0.25 m load without speed, time or force."""
    place = np.arange(0.0, 200.0, 0.25)
    text = table(
        ["km", "Fahrdrahthöhe", "Seitenlage", "Restdicke"],
        [10.0 + place / 1e3, 5300 + place / 50, 200 * np.cos(place / 16), 11.0 - place / 400],
        "%.5f",
        ";",
    )
    recording = tw.load_recording(written(tmp_path / "wire.csv", text))
    assert recording.height is not None
    assert recording.thickness is not None
    assert recording.stagger is not None
    assert recording.height[0] == pytest.approx(5.3)
    assert recording.thickness[0] == pytest.approx(0.011)
    assert recording.stagger[0] == pytest.approx(0.2)
    assert len(recording.forces) == 0
    assert sum("alone makes it plausible" in note for note in recording.notes) == 4
    found = evaluate(recording)
    assert found.force is None
    assert {one.name for one in found.ranges} == {"height", "stagger", "thickness"}


def test_falling_chainage_turns_the_stagger(tmp_path: Path) -> None:
    """Towards falling chainage the way still rises; what is left of rising chainage is then right
    of the train, so that the stagger along the train changes its sign."""
    text = table(["position [m]", "force [N]", "stagger [m]"], [PLACE[::-1], FORCE, STAGGER])
    recording = load(written(tmp_path / "run.csv", text))
    assert not recording.is_rising
    assert "the train ran towards falling chainage" in recording.notes
    assert recording.distance is not None
    assert recording.distance[-1] == pytest.approx(PLACE[-1] - PLACE[0])
    assert recording.stagger is not None
    np.testing.assert_allclose(recording.stagger, -STAGGER, atol=1e-4)


def test_gaps_stay_gaps(tmp_path: Path) -> None:
    """Empty cells, words and missing rows are gaps, told once each; nothing bridges them."""
    lines = table(["time [s]", "position [m]", "force [N]"], [TIME, PLACE, FORCE]).splitlines()
    lines[301:311] = [line.rpartition(",")[0] + "," for line in lines[301:311]]
    lines[501:503] = [line.rpartition(",")[0] + ",overflow" for line in lines[501:503]]
    del lines[801:901]
    recording = load(written(tmp_path / "run.csv", "\n".join(lines)))
    assert len(recording.time) == COUNT
    assert np.isnan(recording.forces[0]).sum() == 112
    np.testing.assert_allclose(recording.time, TIME, atol=1e-6)
    notes = " ".join(recording.notes)
    assert "12 of 1100 cells hold no number (empty 10 times, 'overflow' 2 times)" in notes
    assert "rows are missing in 1 places, 0.505 s in all" in notes
    found = evaluate(recording)
    assert found.force is not None
    assert found.force.missing_share > 0.09


@pytest.mark.parametrize("sign", [1.0, -1.0], ids=["rising", "falling"])
def test_a_chainage_that_jumps_back_is_counted_on(sign: float, tmp_path: Path) -> None:
    """An equation of chainage, 250 m back within one row, is told and the way runs on; a train that
    turns back is refused."""
    place = np.where(np.arange(COUNT) < 700, PLACE, PLACE - 250.0) * sign
    columns = [TIME, place, FORCE]
    heads = ["time [s]", "position [m]", "force [N]"]
    recording = load(written(tmp_path / "run.csv", table(heads, columns)))
    check_force(recording)
    assert recording.chainage is not None
    np.testing.assert_allclose(recording.chainage, sign * PLACE, atol=1e-3)
    assert any("jumps back in 1 places, the first by 249.8 m" in n for n in recording.notes)
    turned = np.where(np.arange(COUNT) < 700, PLACE, 2.0 * PLACE[700] - PLACE) * sign
    with pytest.raises(InputError, match="turns back"):
        load(written(tmp_path / "turned.csv", table(heads, [TIME, turned, FORCE])))


def test_time_and_speed_alone(tmp_path: Path) -> None:
    """Without position the speed is integrated, and the notes say so."""
    speed = 3.6 * SPEED * np.ones(COUNT)
    text = table(["time", "speed", "force"], [TIME, speed, FORCE])
    recording = tw.load_recording(written(tmp_path / "run.csv", text))
    check_force(recording)
    notes = " ".join(recording.notes)
    assert "'speed' has no unit; it is read in km/h" in notes
    assert "it is the speed integrated" in notes


def test_repeated_positions(tmp_path: Path) -> None:
    """A coarse odometer is spread evenly; rows that a standing train repeats are left out."""
    coarse = np.floor(PLACE)  # four rows to a metre
    text = table(["position [m]", "force [N]"], [coarse, FORCE])
    recording = load(written(tmp_path / "coarse.csv", text))
    assert recording.distance is not None
    np.testing.assert_allclose(np.diff(recording.distance)[:-8], 0.25, atol=1e-6)
    assert any("75 % of the rows repeat the position" in note for note in recording.notes)
    stood = np.concatenate([PLACE[:600], np.full(700, PLACE[600]), PLACE[600:]])
    force = np.concatenate([FORCE[:600], np.full(700, 120.0), FORCE[600:]])
    standing = load(written(tmp_path / "stood.csv", table(["position", "force"], [stood, force])))
    assert len(standing.time) == COUNT
    assert any("700 rows repeat the position" in note for note in standing.notes)


@pytest.mark.parametrize(("metres", "held"), [(1, 12.5), (10, 1.25)])
def test_means_over_metres_are_not_judged(metres: int, held: float, tmp_path: Path) -> None:
    """Means over L keep sin(x)/x of the force, 0.9 at f = v / 4 L: 12.5 Hz of 1 m at 50 m/s; bands
    beyond that have no standard deviation."""
    place = np.arange(0.0, 3000.0, metres)
    force = 120.0 + 25.0 * np.sin(2 * np.pi * place / 50.0)
    text = table(["position [m]", "mean force [N]"], [place, force])
    found = evaluate(load(written(tmp_path / "run.csv", text)))
    assert found.highest_frequency == pytest.approx(held)
    assert any(f"up to {held:.3g} Hz only" in note for note in found.notes)
    assert found.force is not None
    assert np.isnan(found.force.bands["5_20"])
    assert np.isnan(found.force.bands["0_5"]) == (metres == 10)


def test_mapping_is_kept_and_used_for_the_next_file(tmp_path: Path) -> None:
    """The mapping that was shown reads the next file with these columns; an edited one is obeyed,
    and one for other columns is left alone."""
    heads = ["time", "position", "force", "force 2"]
    text = table(heads, [TIME, PLACE, FORCE, 0.1 * FORCE])
    first = open_recording(written(tmp_path / "first.csv", text))
    assert first.is_proposed
    said = first.mapping_text().replace(
        '"force 2": {field: sensor_force, unit: "N", sensor: 2}', '"force 2": aside'
    )
    said = said.replace('"force 2": {field: sensor_force, sensor: 2}', '"force 2": aside')
    assert '"force 2": aside' in said
    first.mapping_file.write_text(said, encoding="utf-8")
    second = open_recording(written(tmp_path / "second.csv", text))
    assert not second.is_proposed
    assert second.mapping_file == first.mapping_file
    check_force(second.recording)
    other = table(["time", "position", "force"], [TIME, PLACE, FORCE])
    assert open_recording(written(tmp_path / "third.csv", other)).is_proposed
    more = table([*heads, "height"], [TIME, PLACE, FORCE, 0.1 * FORCE, 5.3 + 0 * TIME])
    fourth = open_recording(written(tmp_path / "fourth.csv", more))
    assert fourth.is_proposed  # no column of it is swallowed by the mapping of another file
    assert fourth.recording.height is not None


REFUSED = {
    "no speed": (table(["position", "force"], [PLACE, FORCE]), "give the speed, as in --speed"),
    "no headings": (table(["1", "2"], [PLACE, FORCE]), "it needs a row of headings"),
    "turns back": (
        table(["position", "speed", "force"],
              [np.concatenate([PLACE[:700], PLACE[200:700]]), 50 + 0 * PLACE,
               np.concatenate([FORCE[:700], FORCE[200:700]])]),
        "turns back by",
    ),
    "time goes back": (
        table(["time", "position", "force"],
              [np.concatenate([TIME[600:], TIME[:600]]), PLACE, FORCE]),
        "the time goes back by",
    ),
    "wrong unit of time": (
        table(["time [s]", "position", "force"], [1e9 * TIME, PLACE, FORCE], "%.9g"),
        "the time goes on by 5e\\+06 s",
    ),
    "stands": (
        table(["time", "position", "force"], [TIME, 0 * PLACE, FORCE]), "does not move",
    ),
    "no rows": ("time;position;force\ns;m;N\n", "headings and no rows below them"),
    "one row": ("time,position,force\n0,0,100\n", "fewer than two rows"),
}  # fmt: skip


@pytest.mark.parametrize("kind", REFUSED)
def test_refused_with_the_right_words(kind: str, tmp_path: Path) -> None:
    """What cannot be used is refused by what is wrong with it and what to do."""
    text, words = REFUSED[kind]
    with pytest.raises(InputError, match=words):
        tw.load_recording(written(tmp_path / "run.csv", text))


@pytest.mark.parametrize(
    ("name", "content"),
    [("run.mat", b"MATLAB 5.0 MAT-file" + b"\0" * 200),
     ("run.nc", b"\x89HDF\r\n\x1a\n" + b"x" * 99),
     ("run.csv", b"PAR1" + b"\0" * 50), ("run.xlsx", b"PK\x03\x04" + b"\0" * 50),
     ("run.tdms", b"TDSm" + b"\xff" * 60), ("run.bin", bytes(range(256)) * 4), ("run.txt", b"")],
)  # fmt: skip
def test_damaged_files_are_refused(name: str, content: bytes, tmp_path: Path) -> None:
    """A file that is not what it says is refused, never an internal error."""
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match=name):
        tw.load_recording(tmp_path / name)


def test_two_columns_for_one_channel(tmp_path: Path) -> None:
    """Of two columns that mean the same the first is read, which is said."""
    heads = ["time", "position", "force", "contact force"]
    text = table(heads, [TIME, PLACE, FORCE, 0 * FORCE])
    recording = tw.load_recording(written(tmp_path / "run.csv", text))
    check_force(recording)
    assert any("could both be the force; the first is read" in n for n in recording.notes)


@pytest.mark.slow
def test_long_recordings_load_fast(tmp_path: Path) -> None:
    """A tenth of ten minutes at 5 kHz, 300 000 rows of 8 columns with decimal commas, takes less
    than a tenth of 10 s of processor time."""
    rng = np.random.default_rng(0)
    time = 2e-4 * np.arange(300_000)
    columns = [time, 12.0 + 0.08 * time, rng.normal(320.0, 0.1, len(time))]
    columns += [rng.normal(40.0, 2.0, len(time)) for _ in range(5)]
    heads = ["time [s]", "position [km]", "speed [km/h]", "F_1_1", "F_1_2", "F_2_1", "F_2_2", "acc"]
    np.savetxt(tmp_path / "raw.csv", np.column_stack(columns), "%.6f", ";")
    rows = (tmp_path / "raw.csv").read_text(encoding="utf-8").replace(".", ",")
    path = written(tmp_path / "run.csv", ";".join(heads) + "\n" + rows)
    start = process_time()
    recording = tw.load_recording(path)
    assert process_time() - start < 1.0
    assert recording.forces.shape == (4, 300_000)


def test_number_of_thousands_of_digits_is_no_sensor(tmp_path: Path) -> None:
    """A cell of 5000 digits, looked at as a heading, ends in a message."""
    path = tmp_path / "record.csv"
    path.write_text(f"position [m],force [N]\n0,100\n1,{'9' * 5000}\n2,3\n", encoding="utf-8")
    with pytest.raises(InputError):
        open_recording(path)
