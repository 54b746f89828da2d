"""Result files are read: the seal first, then every shape, then the numbers."""

from __future__ import annotations

import io
import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from pydantic import ValidationError

from tautwire.errors import InputError
from tautwire.line.alignment import alignment
from tautwire.results import layout
from tautwire.results.accuracy import Accuracy
from tautwire.results.droppers import DropperHistory
from tautwire.results.equilibrium import Elasticity, Equilibrium
from tautwire.results.irregularity import DrawnIrregularities
from tautwire.results.layout import FORMAT, FORMAT_VERSION, Entry
from tautwire.results.run import ContactEvents, PantographRecord, Run, Snapshots
from tautwire.results.storage import upgrade
from tautwire.results.storage.seal import Seal, seal_of
from tautwire.results.storage.trial import tried
from tautwire.specs.case import Case

if TYPE_CHECKING:
    import h5netcdf

PathLike = str | os.PathLike[str]
Result = TypeVar("Result")

CURE = "give a file written by tautwire, or compute it again"
STATUSES = ("done", "partial", "failed")


class UnreadableError(Exception):
    """What is wrong with a file, as the end of the sentence that its name begins."""


def load_run(path: PathLike) -> Run:
    """Read a run written by :func:`tautwire.save_run`.

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
        When the file cannot be read, is damaged, is not a run, or has another format version.
    """
    return _load(path, "run", _run)


def load_equilibrium(path: PathLike) -> tuple[Case, Equilibrium]:
    """Read case and static state from a file of a static state or of a run.

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
        When the file cannot be read, is damaged, or has another format version.
    """
    return _load(path, "equilibrium", _static)


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
        When the file cannot be read, is damaged, or has another format version.
    """
    return _load(path, "equilibrium", _elasticity)


def _load(path: PathLike, kind: str, read: Callable[[h5netcdf.File], Result]) -> Result:
    """Read a file whose seal, or a trial in another process, says that HDF5 may see it."""
    try:
        return _parsed(_safe_content(Path(path), kind), kind, read)
    except UnreadableError as error:
        text = str(error)
        cure = "" if ";" in text else f"; {CURE}"
        raise InputError(f"{path}: {text}{cure}") from error


def _safe_content(path: Path, kind: str) -> bytes:
    """Return the bytes of a file that the HDF5 library can be given."""
    content = _content(path)
    seal = seal_of(content)
    if seal is Seal.BROKEN:
        raise UnreadableError("is damaged (it does not match its checksum)")
    if seal is Seal.NONE and (problem := tried(content, kind)) is not None:
        raise UnreadableError(problem)
    return content


def _content(path: Path) -> bytes:
    """Return the bytes of a file that looks like netCDF-4."""
    if not path.is_file():
        what = "is a folder" if path.is_dir() else "does not exist"
        raise UnreadableError(f"{what}; give the name of a result file (.nc)")
    try:
        content = path.read_bytes()
    except OSError as error:
        raise UnreadableError(f"cannot be read ({error.strerror or error})") from error
    if not content:
        raise UnreadableError("the file is empty")
    if content.startswith(b"CDF"):
        raise UnreadableError("is netCDF-3; result files are netCDF-4, so give one of these")
    if not content.startswith(b"\x89HDF\r\n\x1a\n"):
        raise UnreadableError("is not a netCDF-4 file")
    return content


def read_everything(content: bytes, kind: str) -> None:
    """Read all that any of the functions of this module may be asked for.

    Raises
    ------
    UnreadableError
        With the first thing that is wrong.
    """
    _parsed(content, kind, _run if kind == "run" else _static)
    _parsed(content, "equilibrium", _elasticity)


def _parsed(content: bytes, kind: str, read: Callable[[h5netcdf.File], Result]) -> Result:
    """Open the bytes of a file and read from it; whatever is wrong becomes UnreadableError."""
    import h5netcdf

    try:
        with h5netcdf.File(io.BytesIO(content), "r", decode_vlen_strings=True) as file:
            _check_kind(file, kind)
            return read(file)
    except (OSError, RuntimeError) as error:
        if "truncated" in str(error):
            raise UnreadableError("is cut off (an unfinished copy?)") from error
        raise UnreadableError(f"is damaged ({_one_line(error)})") from error
    except MemoryError as error:
        raise UnreadableError("is damaged, or too large for the memory") from error
    except _FAULTS as error:
        reason = f"is damaged or not written by this program ({_one_line(error)})"
        raise UnreadableError(reason) from error


_FAULTS = (
    KeyError,
    IndexError,
    ValueError,
    TypeError,
    AttributeError,
    ArithmeticError,
    RecursionError,
)
"""What reading raises where a file does not hold what it should."""


def _one_line(error: Exception) -> str:
    """Return an error in one line without the semicolon that parts reason and cure."""
    text = " ".join(f"{type(error).__name__}: {error}".split()).replace(";", ",")
    return text if len(text) <= 200 else text[:200] + " ..."


def _check_kind(file: h5netcdf.File, kind: str) -> None:
    """Refuse a netCDF file of another program, version or kind."""
    if file.attrs.get("format") != FORMAT:
        raise UnreadableError(
            "is a netCDF file but not a tautwire result; give a file written by 'tautwire run' or "
            "'tautwire static'"
        )
    got = _version(file)
    if not 1 <= got <= FORMAT_VERSION:
        newer = "install a newer tautwire" if got > FORMAT_VERSION else "compute it again"
        raise UnreadableError(
            f"has format version {got}, this tautwire reads versions 1 to {FORMAT_VERSION}; {newer}"
        )
    if kind == "run" and file.attrs.get("kind") != "run":
        raise UnreadableError(
            "holds a static state, not a run; give a file written by 'tautwire run'"
        )


def _version(file: h5netcdf.File) -> int:
    return int(file.attrs.get("format_version", 0))


def _case(file: h5netcdf.File) -> Case:
    try:
        return Case.model_validate_json(_text(file, "case"))
    except ValidationError as error:
        first = error.errors()[0]
        raise ValueError(f"its case is not valid: {first['msg']}") from error


def _run(file: h5netcdf.File) -> Run:
    """Read a run, every variable's shape compared with the case and with the other variables."""
    case = _case(file)
    shape = _equilibrium(file, case)
    sizes = {
        "support": shape.support_x.size,
        "dropper": shape.dropper_x.size,
        "pantograph": len(case.pantographs),
        "contact_wire": shape.wire_roles.count("contact"),
    }
    time = _array(file, layout.TIME, sizes)
    _require(np.all(np.isfinite(time)) and np.all(np.diff(time) > 0.0), "time must increase")
    status = _text(file, "status")
    _require(status in STATUSES, f"its status is {status!r}")
    return Run(
        case=case,
        equilibrium=shape,
        status=status,
        message=_text(file, "message"),
        time=time,
        pantographs=_pantographs(file, case, sizes),
        snapshots=_snapshots(file, len(shape.wire_names)),
        counters=_mapping(file, "counters"),
        warnings=_words(file, "warnings"),
        provenance=_mapping(file, "provenance"),
        events=_events(file, len(case.pantographs)),
        irregularities=_irregularities(file, sizes),
        accuracy=_accuracy(file),
        droppers=_droppers(file, sizes, len(time)),
        **_entries(file, layout.RUN, sizes),
    )


def _accuracy(file: h5netcdf.File) -> Accuracy | None:
    """Read the numerical errors, where the run has them."""
    if "accuracy" not in file.attrs:
        return None
    return Accuracy.from_dict(json.loads(_text(file, "accuracy")))


def _droppers(file: h5netcdf.File, sizes: dict[str, int], samples: int) -> DropperHistory:
    """Read the dropper forces; a file that says no first samples holds those of all samples."""
    entries = layout.DROPPERS
    if "dropper_first" not in file.variables:
        force = _array(file, entries[0], {**sizes, "dropper_sample": samples})
        return DropperHistory.of_every_sample(force)
    history = DropperHistory(**_entries(file, entries, sizes))
    _require(len(history.force) <= samples, "more dropper forces than samples")
    _require_numbers("first sample of a dropper", history.first, 0, max(samples - 1, 0))
    return history


def _static(file: h5netcdf.File) -> tuple[Case, Equilibrium]:
    case = _case(file)
    return case, _equilibrium(file, case)


def _elasticity(file: h5netcdf.File) -> Elasticity | None:
    if "elasticity" not in file.groups:
        return None
    values = _entries(file.groups["elasticity"], layout.ELASTICITY, {})
    values["kind"] = tuple(str(kind) for kind in values["kind"])
    _require(set(values["kind"]) <= layout.POINTS, "unknown kind of point of the elasticity")
    _require_numbers("span", values["span"], 1, _case(file).line.spans)
    return Elasticity(**values)


def _pantographs(
    file: h5netcdf.File, case: Case, sizes: dict[str, int]
) -> tuple[PantographRecord, ...]:
    """Read the histories of all pantographs, which are stacked, missing stages as NaN."""
    has_shares = _version(file) > 1
    stored = tuple(e for e in layout.PANTOGRAPH if has_shares or e.name != "wire_force")
    values = _entries(file, stored, sizes)
    values.setdefault("wire_forces", values["contact_force"][:, :, None])
    names = [str(name) for name in _array(file, layout.NAMES, sizes)]
    counts = _array(file, layout.STAGE_COUNT, sizes).tolist()
    given = [(spec.name, len(spec.stages)) for spec in case.pantographs]
    _require(
        list(zip(names, counts, strict=True)) == given, "pantographs are not those of its case"
    )
    _require(max(counts) == sizes["stage"], "number of stages")
    uplift, target = (_array(file, entry, sizes) for entry in layout.PANTOGRAPH_SCALARS)
    records = []
    for row, name in enumerate(names):
        own = {key: np.ascontiguousarray(data[row]) for key, data in values.items()}
        own["stage_heights"] = np.ascontiguousarray(own["stage_heights"][:, : counts[row]])
        own["active"] = own["active"].astype(bool)
        mean = None if np.isnan(target[row]) else float(target[row])
        records.append(
            PantographRecord(name=name, uplift_force=float(uplift[row]), target_mean=mean, **own)
        )
    return tuple(records)


def _events(file: h5netcdf.File, pantographs: int) -> ContactEvents | None:
    if "events" not in file.groups:
        return None
    sizes: dict[str, int] = {}
    time, who, opens = (_array(file.groups["events"], e, sizes) for e in layout.EVENTS)
    _require(bool(np.all(np.diff(time) >= 0.0)), "events must be in order")
    _require_numbers("pantograph of an event", who, 1, pantographs)
    return ContactEvents(time, who - 1, opens.astype(bool))


def _irregularities(file: h5netcdf.File, sizes: dict[str, int]) -> DrawnIrregularities | None:
    if "irregularities" not in file.groups:
        return None
    own = {"dropper": sizes["dropper"]}
    return DrawnIrregularities(
        **_entries(file.groups["irregularities"], layout.IRREGULARITIES, own)
    )


def _snapshots(file: h5netcdf.File, wires: int) -> Snapshots:
    found = _upgraded(file, "snapshots", layout.SNAPSHOTS, upgrade.snapshots_from_1)
    shots = Snapshots(**found)
    _require(np.all(np.isfinite(shots.time)), "times of snapshots must be finite")
    _require_numbers("wire of a snapshot", shots.wire, 0, wires - 1)
    return shots


def _equilibrium(file: h5netcdf.File, case: Case) -> Equilibrium:
    """Read a static state whose numbers of nodes, wires, spans and supports exist."""
    found = _upgraded(file, "equilibrium", layout.EQUILIBRIUM, upgrade.equilibrium_from_1)
    for name in ("wire_names", "wire_roles"):
        found[name] = tuple(str(value) for value in found[name])
    shape = Equilibrium(track=alignment(case.track, case.line), **found)
    wires, spans = len(shape.wire_names), case.line.spans
    _require("contact" in shape.wire_roles, "no contact wire")
    _require_numbers("wire of a node", shape.node_wire, -1, wires - 1)
    nodes = np.bincount(shape.node_wire[shape.node_wire >= 0], minlength=wires)
    _require(np.all(nodes >= 2), "a wire needs two nodes")
    _require(shape.position.size == 6 * shape.node_s.size, "number of nodal coordinates")
    _require(shape.cable_lengths.size == np.sum(nodes - 1), "number of wire elements")
    _require_numbers("wire of a dropper", shape.dropper_wires, 0, wires - 1)
    _require_numbers("wire of a support", shape.support_wire, 0, wires - 1)
    _require_numbers("span of a dropper", shape.dropper_span, 1, spans)
    _require_numbers("number of a support", shape.support_number, 1, spans + 1)
    _require_numbers("support of an arm", shape.arm_supports, 1, shape.support_x.size)
    return shape


def _upgraded(
    file: h5netcdf.File, name: str, entries: tuple[Entry, ...], from_1: Callable[[Any], Any]
) -> dict[str, Any]:
    """Read the listed variables of a group, those of an older format through its upgrade."""
    group, sizes = file.groups[name], dict(_FIXED_SIZES)
    if _version(file) == FORMAT_VERSION:
        return _entries(group, entries, sizes)
    values = from_1({key: np.asarray(variable[...]) for key, variable in group.variables.items()})
    found = {entry: np.asarray(values[entry.name]) for entry in entries}
    for entry, data in found.items():
        _check(entry, data.dtype, data.shape, sizes)
    return {entry.source: data if data.ndim else data.item() for entry, data in found.items()}


_FIXED_SIZES = {"component": 3, "end": 2, "side": 2}


def _require(condition: object, what: str) -> None:
    if not condition:
        raise ValueError(what)


def _require_numbers(what: str, values: np.ndarray, least: int, most: int) -> None:
    """Refuse numbers outside a range."""
    is_inside = (values >= least) & (values <= most)
    _require(np.all(is_inside), f"{what} outside {least} to {most}")


def _text(file: h5netcdf.File, name: str) -> str:
    value = file.attrs[name]
    if not isinstance(value, str):
        raise TypeError(f"attribute {name!r} is no text")
    return value


def _mapping(file: h5netcdf.File, name: str) -> dict[str, Any]:
    """Read a flat JSON object; values that are counted with must be numbers."""
    value = json.loads(_text(file, name))
    _require(isinstance(value, dict), f"attribute {name!r} is no mapping")
    wrong = [
        key
        for key, item in value.items()
        if isinstance(item, list | dict) or (key in layout.NUMBERS and not _is_number(item))
    ]
    _require(not wrong, f"attribute {name!r} holds no number for {', '.join(wrong)}")
    return value


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _words(file: h5netcdf.File, name: str) -> tuple[str, ...]:
    value = json.loads(_text(file, name))
    is_list = isinstance(value, list) and all(isinstance(item, str) for item in value)
    _require(is_list, f"attribute {name!r} is no list of texts")
    return tuple(value)


def _entries(
    group: h5netcdf.Group, entries: tuple[Entry, ...], sizes: dict[str, int]
) -> dict[str, Any]:
    """Read the listed variables by the attribute they belong to; scalars as plain numbers."""
    values = {entry.source: _array(group, entry, sizes) for entry in entries}
    return {name: data if data.ndim else data.item() for name, data in values.items()}


def _array(group: h5netcdf.Group, entry: Entry, sizes: dict[str, int]) -> np.ndarray:
    """Read a variable whose type and shape are what its entry and ``sizes`` say.

    A dimension that is met for the first time enters ``sizes``.
    """
    if entry.name not in group.variables:
        raise ValueError(f"variable {entry.name!r} is missing")
    variable = group.variables[entry.name]
    _check(entry, variable.dtype, variable.shape, sizes)
    return np.asarray(variable[...])


def _check(entry: Entry, dtype: Any, shape: tuple[int, ...], sizes: dict[str, int]) -> None:
    """Compare type and shape of a variable with its entry and with known sizes."""
    _require(np.dtype(dtype).kind in layout.KINDS[entry.kind], f"type of {entry.name!r}")
    _require(len(shape) == len(entry.dimensions), f"dimensions of {entry.name!r}")
    for name, size in zip(entry.dimensions, shape, strict=True):
        wanted = sizes.setdefault(name, int(size))
        text = f"{entry.name!r} has {size} values along {name!r} instead of {wanted}"
        _require(wanted == size, text)
