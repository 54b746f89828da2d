"""Result files: complete, exact, readable by others, refused when damaged."""

from __future__ import annotations

import dataclasses
import json
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import h5netcdf
import numpy as np
import pytest

from tautwire.analyses.road.shape import find_shape
from tautwire.errors import InputError
from tautwire.files import replacing, write_text
from tautwire.model.build import build
from tautwire.model.equations import equations
from tautwire.model.irregularity import draw_irregularities
from tautwire.numerics.network.system import internal_force
from tautwire.results import layout
from tautwire.results.droppers import DropperHistory
from tautwire.results.equilibrium import Elasticity, Equilibrium
from tautwire.results.run import ContactEvents, PantographRecord, Run, Snapshots
from tautwire.results.storage import (
    load_elasticity,
    load_equilibrium,
    load_run,
    save_equilibrium,
    save_run,
)

from .synthetic import make_case, make_elasticity, make_equilibrium, make_run


@pytest.fixture(scope="module")
def run() -> Run:
    """A run with two pantographs of different stage counts."""
    case = make_case(spans=5, pantographs=2)
    data = case.to_dict()
    data["pantographs"][1]["stages"] = data["pantographs"][1]["stages"][1:]
    made = make_run(type(case).model_validate(data), losses=True)
    short = made.pantographs[1]
    short = dataclasses.replace(short, stage_heights=short.stage_heights[:, 1:], target_mean=None)
    return dataclasses.replace(made, pantographs=(made.pantographs[0], short))


@pytest.fixture(scope="module")
def stored(run: Run, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The file of that run."""
    path = tmp_path_factory.mktemp("stored") / "run.nc"
    save_run(run, path, make_elasticity(run.case))
    return path


def _same(left: Any, right: Any) -> bool:
    """Tell whether two results are equal to the last bit, types included."""
    if isinstance(left, np.ndarray):
        return left.dtype == right.dtype and np.array_equal(left, right, equal_nan=True)
    if dataclasses.is_dataclass(left):
        names = [field.name for field in dataclasses.fields(left)]
        return all(_same(getattr(left, name), getattr(right, name)) for name in names)
    if isinstance(left, tuple):
        return len(left) == len(right) and all(map(_same, left, right))
    return type(left) is type(right) and left == right


def test_run_survives_unchanged(run: Run, stored: Path) -> None:
    """A run read back equals the run written, bit by bit and in every type."""
    loaded = load_run(stored)
    for field in dataclasses.fields(Run):
        assert _same(getattr(run, field.name), getattr(loaded, field.name)), field.name


def test_elasticity_survives_unchanged(run: Run, stored: Path) -> None:
    """The elasticity kept beside a run reads back bit by bit."""
    assert _same(make_elasticity(run.case), load_elasticity(stored))


def test_equilibrium_survives_unchanged(tmp_path: Path) -> None:
    """A static state reads back bit by bit, from its own file."""
    case = make_case(spans=2)
    shape = make_equilibrium(case)
    save_equilibrium(shape, tmp_path / "shape.nc", case)
    loaded_case, loaded = load_equilibrium(tmp_path / "shape.nc")
    assert loaded_case == case
    assert _same(shape, loaded)
    assert load_elasticity(tmp_path / "shape.nc") is None


def test_equilibrium_is_read_from_a_run(run: Run, stored: Path) -> None:
    """A run file also serves where a static state is asked for."""
    assert _same(load_equilibrium(stored)[1], run.equilibrium)


@pytest.mark.parametrize(
    ("kind", "entries", "elsewhere"),
    [
        (Equilibrium, layout.EQUILIBRIUM, {"track", "operated"}),
        (Elasticity, layout.ELASTICITY, set()),
        (Snapshots, layout.SNAPSHOTS, set()),
        (DropperHistory, layout.DROPPERS, set()),
        (PantographRecord, (*layout.PANTOGRAPH, *layout.PANTOGRAPH_SCALARS), {"name"}),
        (
            Run,
            layout.RUN,
            {
                *("case", "equilibrium", "status", "message", "time", "pantographs"),
                *("droppers", "snapshots", "counters", "warnings", "provenance"),
                *("events", "irregularities", "accuracy"),
            },
        ),
    ],
)
def test_layout_covers_every_field(kind: Any, entries: Any, elsewhere: set[str]) -> None:
    """No field of a result is forgotten in the file, and none is stored that does not exist."""
    fields = {field.name for field in dataclasses.fields(kind)}
    assert {entry.source for entry in entries} == fields - elsewhere


def test_xarray_opens_the_file(stored: Path, run: Run) -> None:
    """``xarray.open_dataset`` gives named dimensions, coordinates, units and long names."""
    xarray = pytest.importorskip("xarray")
    with xarray.open_dataset(stored, engine="h5netcdf") as data:
        force = data.contact_force.sel(pantograph="front")
        assert force.dims == ("time",)
        assert force.attrs["units"] == "N"
        assert np.array_equal(force.values, run.pantographs[0].contact_force)
        assert np.array_equal(data.time.values, run.time)
        assert all("long_name" in variable.attrs for variable in data.variables.values())
        assert json.loads(data.attrs["case"])["name"] == "synthetic"
    with xarray.open_dataset(stored, engine="h5netcdf", group="equilibrium") as shape:
        assert shape.dropper_force.attrs["units"] == "N"


def test_netcdf_library_opens_the_file(stored: Path, run: Run) -> None:
    """The netCDF C library reads dimensions, strings and every variable."""
    netcdf = pytest.importorskip("netCDF4")
    with netcdf.Dataset(stored) as data:
        assert data.data_model == "NETCDF4"
        assert data.dimensions["time"].size == run.time.size
        assert list(data["pantograph"][:]) == ["front", "rear"]
        assert data.format_version == layout.FORMAT_VERSION
        assert data["support_uplift"].filters()["zlib"]
        for group in (data, *data.groups.values()):
            for variable in group.variables.values():
                assert variable[...].shape == variable.shape
        assert np.array_equal(data["equilibrium"]["position"][:], run.equilibrium.position)


def test_events_and_irregularities_survive(tmp_path: Path) -> None:
    """Instants of contact and drawn irregularities read back as they were, to the last bit; in the
    file pantographs are numbered from 1."""
    irregularities = {
        "installation": {"of": "length", "amplitude": 1e-3},
        "unevenness": [{"kind": "gaussian", "spacing": 1.0, "deviation": 1e-3}],
    }
    case = make_case(spans=3, pantographs=2, irregularities=irregularities)
    events = ContactEvents(np.array([0.1, 0.25]), np.array([0, 1]), np.array([True, False]))
    plain = make_run(case, duration=0.3)
    run = dataclasses.replace(plain, events=events, irregularities=draw_irregularities(case))
    save_run(run, tmp_path / "run.nc")
    loaded = load_run(tmp_path / "run.nc")
    assert _same(loaded.events, events)
    assert _same(loaded.irregularities, run.irregularities)
    save_run(plain, tmp_path / "plain.nc")
    assert load_run(tmp_path / "plain.nc").events is None
    assert load_run(tmp_path / "plain.nc").irregularities is None
    with h5netcdf.File(tmp_path / "run.nc", "r") as file:
        assert list(file["events"]["pantograph"][:]) == [1, 2]
        assert file["irregularities"]["surface_height"].attrs["units"] == "m"


def test_partial_run_survives(tmp_path: Path) -> None:
    """A partial run keeps status and message."""
    run = make_run(make_case(spans=3), status="partial", duration=0.4)
    save_run(run, tmp_path / "run.nc")
    loaded = load_run(tmp_path / "run.nc")
    assert (loaded.status, loaded.message) == (run.status, run.message)
    assert loaded.time.size == 400


def test_run_without_a_step_survives(tmp_path: Path) -> None:
    """A run interrupted before its first step can be stored; empty arrays keep their shape."""
    run = make_run(make_case(spans=3), status="partial", duration=0.0)
    save_run(run, tmp_path / "run.nc")
    loaded = load_run(tmp_path / "run.nc")
    assert loaded.support_uplift.shape == run.support_uplift.shape == (0, 4)
    assert loaded.pantographs[0].stage_heights.shape == (0, 3)


def test_line_without_arms_and_droppers_survives(tmp_path: Path) -> None:
    """Empty groups of items (no steady arms) are stored with their empty shape."""
    case = make_case(spans=2)
    shape = dataclasses.replace(
        make_equilibrium(case),
        arm_supports=np.empty(0, dtype=np.int64),
        arm_forces=np.empty(0),
        arm_angles=np.empty(0),
        arm_ends=np.empty((0, 3)),
    )
    save_equilibrium(shape, tmp_path / "shape.nc", case)
    assert _same(load_equilibrium(tmp_path / "shape.nc")[1], shape)


def test_numbers_of_numpy_in_counters_are_stored(tmp_path: Path) -> None:
    """Counters may hold NumPy scalars; they read back as plain numbers."""
    run = make_run(make_case(spans=2), duration=0.05)
    counters = {"steps": np.int64(50), "iterations_mean": np.float64(2.5)}
    save_run(dataclasses.replace(run, counters=counters), tmp_path / "run.nc")
    assert load_run(tmp_path / "run.nc").counters == {"steps": 50, "iterations_mean": 2.5}


def test_long_case_is_stored(tmp_path: Path) -> None:
    """A case of more than 64 kB (the limit of plain HDF5 attributes) survives."""
    case = make_case(spans=2, description="x" * 200_000)
    save_equilibrium(make_equilibrium(case), tmp_path / "shape.nc", case)
    assert load_equilibrium(tmp_path / "shape.nc")[0].description == case.description


def test_path_is_taken_as_text(tmp_path: Path) -> None:
    """``save_run`` takes a name and the file carries exactly that name."""
    save_run(make_run(make_case(spans=2), duration=0.05), str(tmp_path / "a.nc"))
    assert [path.name for path in tmp_path.iterdir()] == ["a.nc"]


@pytest.fixture
def damaged(stored: Path, tmp_path: Path) -> Path:
    """A copy of the file to be damaged."""
    return Path(shutil.copy(stored, tmp_path / "damaged.nc"))


def _refused(path: Path) -> str:
    """Return the message with which the file is refused as a run."""
    with pytest.raises(InputError) as caught:
        load_run(path)
    text = str(caught.value)
    assert str(path) in text
    assert ";" in text
    return text


def test_missing_file_is_refused(tmp_path: Path) -> None:
    """A name that does not exist is refused."""
    assert "does not exist" in _refused(tmp_path / "none.nc")


def test_folder_is_refused(tmp_path: Path) -> None:
    """A folder is refused."""
    assert "is a folder" in _refused(tmp_path)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "empty"),
        (b"time,force\n0,1\n", "not a netCDF-4 file"),
        (b"CDF\x01" + bytes(100), "netCDF-3"),
        (b"\x89HDF\r\n\x1a\n" + bytes(400), "damaged"),
    ],
)
def test_other_files_are_refused(tmp_path: Path, content: bytes, words: str) -> None:
    """Empty, text, netCDF-3 and garbled files are refused and named for what they are."""
    path = tmp_path / "other.nc"
    path.write_bytes(content)
    assert words in _refused(path)


def test_truncated_file_is_refused(damaged: Path) -> None:
    """A file that lost its end is refused as cut off."""
    damaged.write_bytes(damaged.read_bytes()[:40_000])
    assert "cut off" in _refused(damaged)


def test_overwritten_file_is_refused(damaged: Path) -> None:
    """A file whose data were overwritten is refused without a traceback of the library."""
    content = bytearray(damaged.read_bytes())
    content[20_000:90_000] = bytes(70_000)
    damaged.write_bytes(content)
    assert "damaged" in _refused(damaged)


def test_netcdf_file_of_another_program_is_refused(tmp_path: Path) -> None:
    """A netCDF file without this format's mark is refused."""
    h5netcdf = pytest.importorskip("h5netcdf")
    with h5netcdf.File(tmp_path / "other.nc", "w") as file:
        file.dimensions["x"] = 2
        file.create_variable("x", ("x",), data=np.arange(2.0))
    assert "not a tautwire result" in _refused(tmp_path / "other.nc")


@pytest.mark.parametrize(("version", "cure"), [(99, "newer tautwire"), (0, "compute it again")])
def test_other_format_version_is_refused(damaged: Path, version: int, cure: str) -> None:
    """A file of another format version is refused with the cure that fits."""
    h5netcdf = pytest.importorskip("h5netcdf")
    with h5netcdf.File(damaged, "a") as file:
        file.attrs["format_version"] = version
    text = _refused(damaged)
    assert f"format version {version}" in text
    assert cure in text


def test_missing_variable_is_refused(damaged: Path) -> None:
    """A file that lacks a variable is refused and the variable named."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(damaged, "a") as file:
        del file["contact_force"]
    assert "contact_force" in _refused(damaged)


def test_broken_case_is_refused(damaged: Path) -> None:
    """A file whose case is not valid is refused."""
    h5netcdf = pytest.importorskip("h5netcdf")
    with h5netcdf.File(damaged, "a") as file:
        file.attrs["case"] = '{"schema": 1}'
    assert "damaged" in _refused(damaged)


def test_static_state_is_not_a_run(tmp_path: Path) -> None:
    """A file with a static state is refused where a run is asked for."""
    case = make_case(spans=2)
    save_equilibrium(make_equilibrium(case), tmp_path / "shape.nc", case)
    assert "not a run" in _refused(tmp_path / "shape.nc")


def test_failed_writing_leaves_nothing(tmp_path: Path) -> None:
    """When a run cannot be stored, neither a new nor a half-written file stays."""
    run = dataclasses.replace(make_run(make_case(spans=2), duration=0.05), counters={"a": object()})
    with pytest.raises(TypeError):
        save_run(run, tmp_path / "run.nc")
    assert not list(tmp_path.iterdir())


def test_failed_writing_keeps_the_old_file(tmp_path: Path) -> None:
    """An interruption while writing leaves the file that stood there before."""
    path = tmp_path / "report.html"
    write_text(path, "before")

    def interrupted() -> None:
        with replacing(path) as draft:
            draft.write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert path.read_text() == "before"
    assert list(tmp_path.iterdir()) == [path]


def test_missing_folder_is_refused(tmp_path: Path) -> None:
    """Writing into a folder that does not exist is refused with the folder's name."""
    run = make_run(make_case(spans=2), duration=0.05)
    with pytest.raises(InputError, match=r"nowhere does not exist; create it"):
        save_run(run, tmp_path / "nowhere" / "run.nc")
    with pytest.raises(InputError, match="is a folder"):
        save_run(run, tmp_path)


def test_module_is_light() -> None:
    """Importing the storage loads neither h5py nor pandas; reading and writing do."""
    code = "import sys, tautwire.results.storage; print({'h5py', 'pandas'} & set(sys.modules))"
    answer = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert answer.stdout.strip() == "set()"


FORMAT_1 = Path(__file__).parents[1] / "data" / "format-1.nc"
"""A run of three spans of AC simple, stopped after 0.12 s, written by version 0.1 in format 1."""


def test_format_1_is_read() -> None:
    """A run of format 1 reads as the wires of format 2: the same line found anew has the same
    coordinates, droppers and arms, and the equations built from the file are in balance."""
    run = load_run(FORMAT_1)
    model = build(run.case)
    anew = find_shape(model)
    old = run.equilibrium
    assert old.wire_names == anew.wire_names
    assert old.position == pytest.approx(anew.position, abs=1e-9)
    for name in ("node_s", "node_wire", "dropper_wires", "support_number", "arm_supports"):
        assert np.array_equal(getattr(old, name), getattr(anew, name))
    for name in ("arm_ends", "suspension_free_heights", "contact_preloads", "end_pulls"):
        assert getattr(old, name) == pytest.approx(getattr(anew, name), abs=1e-5)
    system = equations(model, old)
    residual = internal_force(system, old.position).nodal - system.load
    assert np.abs(residual[~system.fixed]).max() <= 1e-4
    x, heights = run.snapshots.of(0)
    still = np.interp(x, old.contact.s, old.contact.position[:, 2])
    assert heights[0] == pytest.approx(still, abs=1e-6)
    assert run.time[-1] == pytest.approx(0.12)


def test_format_1_is_written_as_format_2(tmp_path: Path) -> None:
    """A run of format 1 that is saved again reads back equal."""
    run = load_run(FORMAT_1)
    save_run(run, tmp_path / "again.nc")
    assert _same(load_run(tmp_path / "again.nc").equilibrium, run.equilibrium)
