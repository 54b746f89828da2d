"""Result files are written: netCDF-4, made in memory, sealed, and put in their place as a whole."""

from __future__ import annotations

import io
import json
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np

from tautwire.files import write_bytes
from tautwire.results import layout
from tautwire.results.equilibrium import Elasticity, Equilibrium
from tautwire.results.layout import FORMAT, FORMAT_VERSION, Entry
from tautwire.results.provenance import provenance
from tautwire.results.run import ContactEvents, PantographRecord, Run
from tautwire.results.storage.netcdf import Group, created
from tautwire.results.storage.seal import sealed
from tautwire.specs.case import Case

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
    write_bytes(path, run_image(run, elasticity))


def run_image(run: Run, elasticity: Elasticity | None = None) -> bytes:
    """Return a run as the bytes of its file, see :func:`save_run`."""
    image = io.BytesIO()
    with _created(image, "run", run.case, run.provenance) as file:
        attributes = {
            "status": run.status,
            "message": run.message,
            "warnings": _to_json(run.warnings),
            "counters": _to_json(run.counters),
        }
        if run.accuracy is not None:
            attributes["accuracy"] = _to_json(run.accuracy.as_dict())
        file.describe(attributes)
        _write_axes(file, run)
        _write_entries(file, layout.RUN, run)
        _write_entries(file, layout.DROPPERS, run.droppers)
        _write_pantographs(file, run.pantographs)
        _write_entries(file.group("snapshots"), layout.SNAPSHOTS, run.snapshots)
        _write_static(file, run.equilibrium, elasticity)
        if run.events is not None:
            _write_events(file.group("events"), run.events)
        if run.irregularities is not None:
            group = file.group("irregularities")
            _write_entries(group, layout.IRREGULARITIES, run.irregularities)
    return sealed(image.getvalue())


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
    image = io.BytesIO()
    with _created(image, "equilibrium", case, provenance(case, "reference")) as file:
        _write_static(file, equilibrium, elasticity)
    write_bytes(path, sealed(image.getvalue()))


@contextmanager
def _created(
    image: io.BytesIO, kind: str, case: Case, origin: Mapping[str, Any]
) -> Iterator[Group]:
    """Open a file in memory, with its root attributes."""
    with created(image) as file:
        attributes = {
            "title": case.title or case.name,
            "format": FORMAT,
            "format_version": FORMAT_VERSION,
            "kind": kind,
            "case": case.model_dump_json(by_alias=True),
            "provenance": _to_json(origin),
        }
        file.describe(attributes)
        yield file


def _to_json(value: Any) -> str:
    """Return JSON with NumPy numbers written as numbers."""

    def plain(item: Any) -> Any:
        if isinstance(item, np.generic | np.ndarray):
            return item.tolist()
        if isinstance(item, Mapping):
            return dict(item)
        raise TypeError(f"cannot store {type(item).__name__} in a result file")

    return json.dumps(value if not isinstance(value, Mapping) else dict(value), default=plain)


def _write(group: Group, entry: Entry, data: Any) -> None:
    """Write one variable."""
    values = np.asarray(data)
    units = {} if values.dtype.kind in "UO" else {"units": entry.units}
    group.write(entry.name, entry.dimensions, values, {"long_name": entry.text, **units})


def _write_entries(group: Group, entries: tuple[Entry, ...], source: Any) -> None:
    """Write the attributes of ``source`` that ``entries`` list."""
    for entry in entries:
        _write(group, entry, getattr(source, entry.source))


def _write_axes(file: Group, run: Run) -> None:
    """Write the coordinate variables of the root group."""
    names = np.array([record.name for record in run.pantographs], dtype=object)
    stages = max((record.stage_heights.shape[1] for record in run.pantographs), default=0)
    count = "number of the dropper along the line, from 1"
    _write(file, layout.TIME, run.time)
    _write(file, layout.NAMES, names)
    axes = (
        ("support", "1", "number of the support, from 1", run.equilibrium.support_number),
        ("dropper", "1", count, _numbers(run.droppers.first.size)),
        ("stage", "1", "number of the stage, 1 is the head", _numbers(stages)),
    )
    for name, units, text, values in axes:
        _write(file, Entry(name, name, (name,), units, text), values)


def _numbers(count: int) -> np.ndarray:
    return np.arange(1, count + 1, dtype=np.int32)


def _write_pantographs(file: Group, records: tuple[PantographRecord, ...]) -> None:
    """Write the histories of all pantographs stacked, missing stages as NaN."""
    n_time, n_stage = file.size("time"), file.size("stage")
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
    _write(file, layout.STAGE_COUNT, counts)


def _write_events(group: Group, events: ContactEvents) -> None:
    """Write the instants at which contacts open and close; pantographs are numbered from 1."""
    values = (events.time, events.pantograph + 1, events.opens.astype(np.int8))
    for entry, data in zip(layout.EVENTS, values, strict=True):
        _write(group, entry, data)


def _write_static(file: Group, equilibrium: Equilibrium, elasticity: Elasticity | None) -> None:
    """Write the groups of the static results."""
    _write_entries(file.group("equilibrium"), layout.EQUILIBRIUM, equilibrium)
    if elasticity is not None:
        _write_entries(file.group("elasticity"), layout.ELASTICITY, elasticity)
