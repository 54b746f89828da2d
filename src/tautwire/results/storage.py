"""Result files: netCDF-4, opened by xarray and by the netCDF C library.

A run file holds the histories in its root group and the groups ``equilibrium``, ``snapshots``
and (when known) ``elasticity``; the case, warnings, counters and provenance are JSON attributes
of the root. Spans, droppers and supports are numbered from 1.

Example
-------
>>> import xarray  # doctest: +SKIP
>>> xarray.open_dataset("run.nc").contact_force.sel(pantograph="front")  # doctest: +SKIP
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tautwire.errors import InputError
from tautwire.results import layout, upgrade
from tautwire.results.equilibrium import Elasticity, Equilibrium
from tautwire.results.files import replacing
from tautwire.results.irregularity import DrawnIrregularities
from tautwire.results.layout import FORMAT, FORMAT_VERSION, Entry
from tautwire.results.provenance import provenance
from tautwire.results.run import ContactEvents, PantographRecord, Run, Snapshots
from tautwire.specs.case import Case

if TYPE_CHECKING:
    import h5netcdf

PathLike = str | os.PathLike[str]


def save_run(run: Run, path: PathLike, elasticity: Elasticity | None = None) -> None:
    """Write a run to a netCDF-4 file, completely or not at all.

    Parameters
    ----------
    run : Run
        Also a partial one.
    path : str or path
    elasticity : Elasticity, optional
        Kept beside the run, for the report.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    with _created(path, "run", run.case, run.provenance) as file:
        attributes = {
            "status": run.status,
            "message": run.message,
            "warnings": _to_json(run.warnings),
            "counters": _to_json(run.counters),
        }
        file.attrs.update(attributes)
        _write_axes(file, run)
        _write_entries(file, layout.RUN, run)
        _write_pantographs(file, run.pantographs)
        _write_entries(file.create_group("snapshots"), layout.SNAPSHOTS, run.snapshots)
        _write_static(file, run.equilibrium, elasticity)
        if run.events is not None:
            _write_events(file.create_group("events"), run.events)
        if run.irregularities is not None:
            group = file.create_group("irregularities")
            _write_entries(group, layout.IRREGULARITIES, run.irregularities)


def load_run(path: PathLike) -> Run:
    """Read a run written by :func:`save_run`.

    Parameters
    ----------
    path : str or path
        File to read.

    Returns
    -------
    Run

    Raises
    ------
    InputError
        When the file cannot be read, is not a run, or has another format version.
    """
    with _opened(path, "run") as file:
        case = Case.model_validate_json(_text(file, "case"))
        return Run(
            case=case,
            equilibrium=_read_equilibrium(file),
            status=_text(file, "status"),
            message=_text(file, "message"),
            time=_array(file, "time"),
            pantographs=_read_pantographs(file),
            snapshots=_read_snapshots(file),
            counters=json.loads(_text(file, "counters")),
            warnings=tuple(json.loads(_text(file, "warnings"))),
            provenance=json.loads(_text(file, "provenance")),
            events=_read_events(file),
            irregularities=_read_irregularities(file),
            **_read_entries(file, layout.RUN),
        )


def save_equilibrium(
    equilibrium: Equilibrium,
    path: PathLike,
    case: Case,
    elasticity: Elasticity | None = None,
) -> None:
    """Write a static state to a netCDF-4 file, completely or not at all.

    Parameters
    ----------
    equilibrium : Equilibrium
    path : str or path
    case : Case
        The case it was found for.
    elasticity : Elasticity, optional

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    with _created(path, "equilibrium", case, provenance(case, "reference")) as file:
        _write_static(file, equilibrium, elasticity)


def load_equilibrium(path: PathLike) -> tuple[Case, Equilibrium]:
    """Read case and static state from a file of :func:`save_equilibrium` or :func:`save_run`.

    Parameters
    ----------
    path : str or path
        File to read.

    Returns
    -------
    case : Case
    equilibrium : Equilibrium

    Raises
    ------
    InputError
        When the file cannot be read or has another format version.
    """
    with _opened(path, "equilibrium") as file:
        return Case.model_validate_json(_text(file, "case")), _read_equilibrium(file)


def load_elasticity(path: PathLike) -> Elasticity | None:
    """Read the elasticity kept in a result file.

    Parameters
    ----------
    path : str or path
        File to read.

    Returns
    -------
    Elasticity or None
        None when the file holds none.

    Raises
    ------
    InputError
        When the file cannot be read or has another format version.
    """
    with _opened(path, "equilibrium") as file:
        if "elasticity" not in file.groups:
            return None
        values = _read_entries(file.groups["elasticity"], layout.ELASTICITY)
        values["kind"] = tuple(str(kind) for kind in values["kind"])
        return Elasticity(**values)


@contextmanager
def _created(
    path: PathLike, kind: str, case: Case, origin: Mapping[str, Any]
) -> Iterator[h5netcdf.File]:
    """Open a new file that replaces ``path`` once it is complete, with its root attributes."""
    import h5netcdf

    with replacing(path) as draft, h5netcdf.File(draft, "w") as file:
        attributes = {
            "title": case.title or case.name,
            "format": FORMAT,
            "format_version": FORMAT_VERSION,
            "kind": kind,
            "case": case.model_dump_json(by_alias=True),
            "provenance": _to_json(origin),
        }
        file.attrs.update(attributes)
        yield file


@contextmanager
def _opened(path: PathLike, kind: str) -> Iterator[h5netcdf.File]:
    """Open a result file for reading; whatever is wrong with it becomes an InputError."""
    import h5netcdf

    cure = "give a file written by tautwire, or compute it again"
    if not Path(path).is_file():
        what = "is a folder" if Path(path).is_dir() else "does not exist"
        raise InputError(f"{path}: {what}; give the name of a result file (.nc)")
    try:
        with h5netcdf.File(path, "r", decode_vlen_strings=True) as file:
            _check_kind(file, path, kind)
            yield file
    except InputError:
        raise
    except (OSError, RuntimeError) as error:
        reason = _reading_failure(Path(path), error)
        raise InputError(f"{path}: {reason}; {cure}") from error
    except (KeyError, ValueError, TypeError, AttributeError) as error:
        reason = f"damaged or not written by this program ({type(error).__name__}: {error})"
        raise InputError(f"{path}: {reason}; {cure}") from error


def _reading_failure(path: Path, error: Exception) -> str:
    """Say why the HDF5 library refused a file."""
    try:
        with path.open("rb") as file:
            start = file.read(8)
    except OSError as cause:
        return f"cannot be read ({cause.strerror})"
    if not start:
        return "the file is empty"
    if start.startswith(b"CDF"):
        return "is netCDF-3; result files are netCDF-4"
    if not start.startswith(b"\x89HDF\r\n\x1a\n"):
        return "is not a netCDF-4 file"
    if "truncated" in str(error):
        return "is cut off (an unfinished copy?)"
    return f"is damaged ({error})"


def _check_kind(file: h5netcdf.File, path: PathLike, kind: str) -> None:
    """Refuse a netCDF file of another program, version or kind."""
    if file.attrs.get("format") != FORMAT:
        raise InputError(
            f"{path}: is a netCDF file but not a tautwire result; give a file written by "
            "'tautwire run' or 'tautwire static'"
        )
    got = int(file.attrs.get("format_version", 0))
    if not 1 <= got <= FORMAT_VERSION:
        newer = "install a newer tautwire" if got > FORMAT_VERSION else "compute it again"
        raise InputError(
            f"{path}: has format version {got}, this tautwire reads versions 1 to "
            f"{FORMAT_VERSION}; {newer}"
        )
    if kind == "run" and file.attrs.get("kind") != "run":
        raise InputError(
            f"{path}: holds a static state, not a run; give a file written by 'tautwire run'"
        )


def _to_json(value: Any) -> str:
    """Return JSON with NumPy numbers written as numbers."""

    def plain(item: Any) -> Any:
        if isinstance(item, np.generic | np.ndarray):
            return item.tolist()
        if isinstance(item, Mapping):
            return dict(item)
        raise TypeError(f"cannot store {type(item).__name__} in a result file")

    return json.dumps(value if not isinstance(value, Mapping) else dict(value), default=plain)


def _write(group: h5netcdf.Group, entry: Entry, data: Any) -> None:
    """Write one variable, creating the dimensions it is the first to use."""
    import h5py

    values = np.asarray(data)
    for name, size in zip(entry.dimensions, values.shape, strict=True):
        if name not in group.dimensions:
            group.dimensions[name] = size
    packing: dict[str, Any] = {}
    if values.dtype.kind in "UO":
        values, dtype = values.astype(object), h5py.string_dtype()
    else:
        dtype = values.dtype
        if values.size:
            packing = {"compression": "gzip", "compression_opts": 4, "shuffle": True}
    if not entry.dimensions:
        packing = {}
    variable = group.create_variable(entry.name, entry.dimensions, dtype, data=values, **packing)
    variable.attrs["long_name"] = entry.text
    if values.dtype.kind != "O":
        variable.attrs["units"] = entry.units


def _write_entries(group: h5netcdf.Group, entries: tuple[Entry, ...], source: Any) -> None:
    """Write the attributes of ``source`` that ``entries`` list."""
    for entry in entries:
        _write(group, entry, getattr(source, entry.source))


def _write_axes(file: h5netcdf.File, run: Run) -> None:
    """Write the coordinate variables of the root group."""
    names = [record.name for record in run.pantographs]
    stages = max((record.stage_heights.shape[1] for record in run.pantographs), default=0)
    count = "number of the dropper along the line, from 1"
    axes = (
        ("time", "s", "time since the start", run.time),
        ("support", "1", "number of the support, from 1", _numbers(run.support_uplift.shape[1])),
        ("dropper", "1", count, _numbers(run.dropper_force.shape[1])),
        ("pantograph", "1", "name of the pantograph", np.array(names, dtype=object)),
        ("stage", "1", "number of the stage, 1 is the head", _numbers(stages)),
    )
    for name, units, text, values in axes:
        _write(file, Entry(name, name, (name,), units, text), values)


def _numbers(count: int) -> np.ndarray:
    return np.arange(1, count + 1, dtype=np.int32)


def _write_pantographs(file: h5netcdf.File, records: tuple[PantographRecord, ...]) -> None:
    """Write the histories of all pantographs stacked, missing stages as NaN."""
    n_time, n_stage = file.dimensions["time"].size, file.dimensions["stage"].size
    for entry in layout.PANTOGRAPH:
        wires = records[0].wire_forces.shape[1] if records else 0
        shape = {"time": n_time, "stage": n_stage, "contact_wire": wires}
        shape["pantograph"] = len(records)
        stacked = np.full([shape[name] for name in entry.dimensions], np.nan)
        for row, record in enumerate(records):
            values = getattr(record, entry.source)
            stacked[row][tuple(slice(0, size) for size in values.shape)] = values
        _write(file, entry, stacked.astype(np.int8) if entry.name == "active" else stacked)
    for entry in layout.PANTOGRAPH_SCALARS:
        values = [getattr(record, entry.source) for record in records]
        _write(file, entry, np.array([np.nan if v is None else v for v in values], dtype=float))
    counts = np.array([record.stage_heights.shape[1] for record in records], dtype=np.int32)
    text = "number of stages of the pantograph"
    _write(file, Entry("stage_count", "", ("pantograph",), "1", text), counts)


def _read_pantographs(file: h5netcdf.File) -> tuple[PantographRecord, ...]:
    """Read the records written by :func:`_write_pantographs`."""
    stored = [entry for entry in layout.PANTOGRAPH if entry.name in file.variables]
    values = _read_entries(file, tuple(stored))
    if "wire_forces" not in values:  # format 1: one contact wire
        values["wire_forces"] = values["contact_force"][:, :, None]
    uplift, target = _array(file, "uplift_force"), _array(file, "target_mean")
    counts = _array(file, "stage_count")
    records = []
    for row, name in enumerate(_array(file, "pantograph")):
        own = {key: np.ascontiguousarray(data[row]) for key, data in values.items()}
        own["stage_heights"] = np.ascontiguousarray(own["stage_heights"][:, : counts[row]])
        own["active"] = own["active"].astype(bool)
        mean = None if np.isnan(target[row]) else float(target[row])
        records.append(
            PantographRecord(
                name=str(name), uplift_force=float(uplift[row]), target_mean=mean, **own
            )
        )
    return tuple(records)


def _write_events(group: h5netcdf.Group, events: ContactEvents) -> None:
    """Write the instants at which contacts open and close; pantographs are numbered from 1."""
    values = (events.time, events.pantograph + 1, events.opens.astype(np.int8))
    for entry, data in zip(layout.EVENTS, values, strict=True):
        _write(group, entry, data)


def _read_events(file: h5netcdf.File) -> ContactEvents | None:
    if "events" not in file.groups:
        return None
    time, pantograph, opens = (_array(file.groups["events"], e.name) for e in layout.EVENTS)
    return ContactEvents(time, pantograph - 1, opens.astype(bool))


def _read_irregularities(file: h5netcdf.File) -> DrawnIrregularities | None:
    if "irregularities" not in file.groups:
        return None
    return DrawnIrregularities(
        **_read_entries(file.groups["irregularities"], layout.IRREGULARITIES)
    )


def _write_static(
    file: h5netcdf.File, equilibrium: Equilibrium, elasticity: Elasticity | None
) -> None:
    """Write the groups of the static results."""
    _write_entries(file.create_group("equilibrium"), layout.EQUILIBRIUM, equilibrium)
    if elasticity is not None:
        _write_entries(file.create_group("elasticity"), layout.ELASTICITY, elasticity)


def _text(file: h5netcdf.File, name: str) -> str:
    return str(file.attrs[name])


def _read_equilibrium(file: h5netcdf.File) -> Equilibrium:
    found = _upgraded(file, "equilibrium", layout.EQUILIBRIUM, upgrade.equilibrium_from_1)
    for name in ("wire_names", "wire_roles"):
        found[name] = tuple(str(value) for value in found[name])
    return Equilibrium(**found)


def _read_snapshots(file: h5netcdf.File) -> Snapshots:
    return Snapshots(**_upgraded(file, "snapshots", layout.SNAPSHOTS, upgrade.snapshots_from_1))


def _upgraded(
    file: h5netcdf.File, name: str, entries: tuple[Entry, ...], from_1: Callable[[Any], Any]
) -> dict[str, Any]:
    """Read the listed variables of a group, those of an older format through its upgrade."""
    group = file.groups[name]
    if str(file.attrs["format_version"]) == str(FORMAT_VERSION):
        return _read_entries(group, entries)
    values = from_1({key: _array(group, key) for key in group.variables})
    found = {entry.source: np.asarray(values[entry.name]) for entry in entries}
    return {source: data if data.ndim else data.item() for source, data in found.items()}


def _read_entries(group: h5netcdf.Group, entries: tuple[Entry, ...]) -> dict[str, Any]:
    """Read the listed variables by the attribute they belong to; scalars as plain numbers."""
    values = {entry.source: _array(group, entry.name) for entry in entries}
    return {name: data if data.ndim else data.item() for name, data in values.items()}


def _array(group: h5netcdf.Group, name: str) -> np.ndarray:
    return np.asarray(group.variables[name][...])
