"""netCDF-4 files written through HDF5, variable by variable.

A netCDF-4 file is an HDF5 file with conventions (netCDF user's guide, appendix C, "The netCDF-4
format"): every dimension is a dimension scale, numbered by ``_Netcdf4Dimid`` over the whole file;
that of a dimension without coordinates is named :data:`_NO_VARIABLE`; variables refer to the scales
of their dimensions. General writers look each of them up by its path again and again, which took
more time than the data of a run.
"""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from itertools import count
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tautwire.version import __version__

if TYPE_CHECKING:
    import h5py

_NO_VARIABLE = "This is a netCDF dimension but not a netCDF variable.{:10d}"
_PACKED = {"compression": "gzip", "compression_opts": 4, "shuffle": True}
"""Level 4: levels above take longer and save next to nothing on histories."""


class Group:
    """A group under way: its dimensions by name, and where variables go.

    Parameters
    ----------
    place
        Group of the HDF5 file.
    numbers
        The numbers of dimensions that are still free, from 0; one counter for the whole file.
    """

    def __init__(self, place: h5py.Group, numbers: Iterator[int]) -> None:
        self._place, self._numbers = place, numbers
        self._scales: dict[str, tuple[int, h5py.Dataset]] = {}

    def group(self, name: str) -> Group:
        """Return a new group within this one."""
        return Group(self._place.create_group(name, track_order=True), self._numbers)

    def describe(self, attributes: Mapping[str, str | int]) -> None:
        """Set attributes of the group."""
        for name, value in attributes.items():
            self._place.attrs[name] = value if isinstance(value, str) else [value]

    def size(self, dimension: str) -> int:
        """Return the length of a dimension of this group."""
        return int(self._scales[dimension][1].shape[0])

    def write(
        self,
        name: str,
        dimensions: tuple[str, ...],
        values: NDArray[Any],
        attributes: Mapping[str, str],
    ) -> None:
        """Write a variable, and the dimensions that it is the first of its group to use.

        Parameters
        ----------
        name
        dimensions
            Of `values`; that of the same name as the variable has it for its coordinates.
        values
            Numbers or texts.
        attributes
        """
        is_text = values.dtype.kind in "UO"
        for own, size in zip(dimensions, values.shape, strict=True):
            if own not in self._scales and own != name:
                self._add_scale(own, size)
        made = self._dataset(
            name,
            values.astype(object) if is_text else values,
            packed=not is_text and bool(dimensions),
        )
        if name in dimensions:
            self._scales[name] = (next(self._numbers), made)
            made.make_scale(name)
        else:
            for axis, own in enumerate(dimensions):
                made.dims[axis].attach_scale(self._scales[own][1])
        if dimensions:
            ids = np.array([self._scales[own][0] for own in dimensions], dtype=np.int32)
            made.attrs["_Netcdf4Coordinates"] = ids
            made.attrs["_Netcdf4Dimid"] = ids[0]
        for key, value in attributes.items():
            made.attrs[key] = value

    def _add_scale(self, name: str, size: int) -> None:
        """Add a dimension without coordinates; one of length 0 may grow, as netCDF has it."""
        number, grows = next(self._numbers), (None,) if size == 0 else None
        scale = self._place.create_dataset(
            name, (size,), dtype=">f4", maxshape=grows, track_order=True
        )
        scale.attrs["_Netcdf4Dimid"] = np.int32(number)
        scale.make_scale(_NO_VARIABLE.format(size))
        self._scales[name] = (number, scale)

    def _dataset(self, name: str, values: NDArray[Any], *, packed: bool) -> h5py.Dataset:
        import h5py

        settings: dict[str, Any] = dict(_PACKED) if packed and values.size else {}
        if not values.size:
            settings["maxshape"] = tuple(size or None for size in values.shape)
        kind = h5py.string_dtype() if values.dtype.kind == "O" else values.dtype
        return self._place.create_dataset(
            name, values.shape, dtype=kind, data=values, track_order=True, **settings
        )


@contextmanager
def created(image: io.BytesIO) -> Iterator[Group]:
    """Make a netCDF-4 file in memory.

    In memory, because HDF5 cannot be trusted with a disk that is full: closing a file whose data
    could not be flushed ends the process.

    Parameters
    ----------
    image
        Takes the bytes.

    Yields
    ------
    Group
        The root.
    """
    import h5py

    with h5py.File(image, "w", track_order=True) as file:
        yield Group(file, count())
        made_by = (
            f"version=2,tautwire={__version__},hdf5={h5py.version.hdf5_version},"
            f"h5py={h5py.__version__}"
        ).encode("ascii")
        file.attrs["_NCProperties"] = np.bytes_(made_by)
