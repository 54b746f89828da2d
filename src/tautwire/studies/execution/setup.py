"""Set-up shared by the cases of a study: a line whose shape is known is not solved again.

A worker keeps the shapes it has found, under everything that the shape finding reads: the arrays
of the form problem, the drawn errors of installation, and the parts of the case that describe the
line. What differs between cases of one line (speed, pantographs, contact stiffness, steps, running
surface) is not among them. A kept shape is the one that would be found again, to the last bit.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections import OrderedDict
from collections.abc import Mapping
from typing import Any

import numpy as np

from tautwire.analyses.road.shape import find_shape
from tautwire.model.build import Model, build
from tautwire.results.equilibrium import Equilibrium
from tautwire.specs.case import Case

MOST_KEPT = 16
"""Shapes kept by a process, some hundred kilobytes each: a fast axis may change the line."""

_NOT_THE_LINE = (
    "schema", "name", "title", "description", "sources",
    "pantographs", "scenario", "settings", "irregularities",
)  # fmt: skip
"""Parts of a case that reach the shape only through the arrays, or not at all."""


class Lines:
    """Lines at rest, as many as were met last.

    Parameters
    ----------
    most
        Shapes kept.
    """

    def __init__(self, most: int = MOST_KEPT) -> None:
        self._most = most
        self._shapes: OrderedDict[str, Equilibrium] = OrderedDict()

    def at_rest(self, case: Case) -> tuple[Model, Equilibrium]:
        """Return the model of a case and its shape, found now or before.

        Raises
        ------
        ConvergenceError, ModelError
            As :func:`find_shape` does.
        """
        model = build(case)
        key = key_of_shape(model)
        shape = self._shapes.get(key)
        if shape is None:
            shape = self._shapes[key] = find_shape(model)
            if len(self._shapes) > self._most:
                self._shapes.popitem(last=False)
        self._shapes.move_to_end(key)
        return model, shape


def key_of_shape(model: Model) -> str:
    """Return what identifies the shape of a model: a hash of all that decides it."""
    parts = model.case.to_dict()
    line = {name: part for name, part in parts.items() if name not in _NOT_THE_LINE}
    found = hashlib.sha256(json.dumps(line, sort_keys=True).encode())
    errors = model.irregularities.dropper_length, model.irregularities.dropper_height
    _add(found, (model.form, model.mesh, model.line, errors))
    return found.hexdigest()


def _add(found: Any, value: Any) -> None:
    """Add a value with everything in it to a hash."""
    if isinstance(value, np.ndarray):
        found.update(f"{value.dtype}{value.shape}".encode())
        found.update(np.ascontiguousarray(value).tobytes())
    elif dataclasses.is_dataclass(value):
        for field in dataclasses.fields(value):
            found.update(field.name.encode())
            _add(found, getattr(value, field.name))
    elif isinstance(value, Mapping):
        _add(found, list(value.items()))
    elif isinstance(value, (tuple, list)):
        found.update(f"{len(value)} of".encode())
        for item in value:
            _add(found, item)
    else:
        found.update(repr(value).encode())
