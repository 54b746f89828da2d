"""Result files: netCDF-4, opened by xarray and by the netCDF C library.

A run file holds the histories in its root group and the groups ``equilibrium``, ``snapshots``
and (when known) ``elasticity``; the case, warnings, counters and provenance are JSON attributes
of the root. Spans, droppers and supports are numbered from 1. Behind the last byte of the netCDF
file stands its checksum, see :mod:`tautwire.results.storage.seal`.

Example
-------
>>> import xarray  # doctest: +SKIP
>>> xarray.open_dataset("run.nc").contact_force.sel(pantograph="front")  # doctest: +SKIP
"""

from tautwire.results.storage.reading import load_elasticity, load_equilibrium, load_run
from tautwire.results.storage.writing import run_image, save_equilibrium, save_run

__all__ = [
    "load_elasticity",
    "load_equilibrium",
    "load_run",
    "run_image",
    "save_equilibrium",
    "save_run",
]
