"""Measured runs: contact force over position, from a CSV file."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tautwire.inputs.reading.tables import Column, Table, read_table

Array = NDArray[np.float64]

COLUMNS = (
    Column("time", "s"),
    Column("position", "m", required=True),
    Column("force", "N", required=True),
    Column("speed", "m/s"),
    Column("uplift", "m"),
)


@dataclass(frozen=True, eq=False)
class MeasuredRun:
    """A measured contact force along the line.

    Attributes
    ----------
    label : str
        Name of the file.
    position : (n_sample,) m
        Along the track, in the running direction or against it.
    force : (n_sample,) N
    time : (n_sample,) s or None
    speed : (n_sample,) m/s or None
    uplift : (n_sample,) m or None
        Height of the wire above its static position, at the pantograph.
    """

    label: str
    position: Array
    force: Array
    time: Array | None = None
    speed: Array | None = None
    uplift: Array | None = None


def read_measured(path: str | os.PathLike[str]) -> MeasuredRun:
    """Read a measured run.

    The file is a table as described in :mod:`tautwire.inputs.reading.tables` with the columns
    ``position`` and ``force``, and where they were measured ``time``, ``speed`` and ``uplift``.
    Other columns are ignored.

    Parameters
    ----------
    path
        CSV file.

    Raises
    ------
    InputError
        Naming line and column of everything that is wrong.
    """
    table = read_table(Path(path), COLUMNS, others_allowed=True)
    if len(table.lines) < 2:
        table.problems.append(f"{table.label}: has one row; a record has at least two samples")
    values = {name: np.array(table.full_column(name)) for name in table.columns}
    if "time" in values:
        _check_increasing(table, "time", values["time"])
    _check_monotonic(table, values["position"])
    table.raise_problems()
    return MeasuredRun(label=table.label, **values)


def _check_increasing(table: Table, name: str, values: Array) -> None:
    backwards = np.flatnonzero(np.diff(values) <= 0.0)
    if len(backwards):
        table.complain(int(backwards[0]) + 1, name, "does not increase; sort the rows by time")


def _check_monotonic(table: Table, position: Array) -> None:
    steps = np.diff(position)
    forwards = position[-1] >= position[0]
    turns = np.flatnonzero(steps < 0.0 if forwards else steps > 0.0)
    if len(turns):
        table.complain(
            int(turns[0]) + 1, "position", "turns back; give one passage in one direction"
        )
