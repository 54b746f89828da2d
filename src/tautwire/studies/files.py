"""Files of a study: table as CSV and as netCDF-4."""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import Any

import numpy as np

from tautwire.files import write_bytes, write_text
from tautwire.studies.table import StudyTable, Variable
from tautwire.version import __version__


def save_csv(table: StudyTable, path: str | os.PathLike[str]) -> Path:
    """Write the table as CSV, one row per case, completely or not at all."""
    return write_text(path, table.to_csv())


def save_netcdf(table: StudyTable, path: str | os.PathLike[str]) -> Path:
    """Write the table as netCDF-4 with its axes as coordinates; xarray opens it.

    Parameters
    ----------
    table
    path

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    import h5netcdf

    coordinates, variables, attributes = table.content()
    apart = [name for name, item in coordinates.items() if (name,) != item.dimensions]
    image = io.BytesIO()  # closing a file that a full disk has cut short ends the process
    with h5netcdf.File(image, "w") as file:
        file.attrs.update({"format": "tautwire study", "version": __version__, **attributes})
        for name, size in zip(table.names, table.status.shape, strict=True):
            file.dimensions[name] = size
        for name, labels in table.labels.items():
            if labels:
                file.dimensions[name] = len(labels)
        for name, item in coordinates.items():
            _write(file, name, item, [])
        for name, item in variables.items():
            _write(file, name, item, apart)
    return write_bytes(path, image.getvalue())


def _write(file: Any, name: str, item: Variable, coordinates: list[str]) -> None:
    import h5py

    is_text = item.values.dtype == np.dtype(object)
    dtype = h5py.string_dtype() if is_text else item.values.dtype
    variable = file.create_variable(name, item.dimensions, dtype, data=item.values)
    variable.attrs["long_name"] = item.quantity.text
    if not is_text:
        variable.attrs["units"] = item.quantity.unit
    if coordinates:
        variable.attrs["coordinates"] = " ".join(coordinates)
