"""Everything that came out of a study, as labelled arrays over its dimensions."""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.errors import InputError, not_installed
from tautwire.plain import Plain
from tautwire.results.accuracy import rounded
from tautwire.specs.study import Study
from tautwire.studies import columns
from tautwire.studies.axes import AxisValues, Dimension
from tautwire.studies.columns import BAND, FILTER, PANTOGRAPH, Quantity
from tautwire.studies.plan import Plan
from tautwire.studies.store import Row, Store
from tautwire.text import csv_text

REFUSED, MISSING = "refused", "missing"
_OWN_TEXTS = tuple(columns.TEXTS)[3:]
"""Texts that the computation of a case gives."""
_NUMBERS = re.compile(r"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")


@dataclass(frozen=True, eq=False)
class Variable:
    """A labelled array.

    Attributes
    ----------
    quantity : Quantity
    dimensions : tuple of str
    values : array
    """

    quantity: Quantity
    dimensions: tuple[str, ...]
    values: NDArray[Any]


@dataclass(frozen=True)
class Alike(Plain):
    """Cases of which the same is to be said (numbers in it aside).

    Attributes
    ----------
    status : str
        ``"done"``, ``"failed"`` or ``"refused"``.
    reason : str
        Why they failed, or what to know of their numbers, as the first of them says it.
    cases : tuple of int
        Their numbers, from 1.
    """

    status: str
    reason: str
    cases: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class StudyTable:
    """Results of a study.

    The first axes of every array are the dimensions of the study: one per axis of a grid,
    ``"sample"`` for a Latin hypercube, ``"case"`` for axes that move together. Then come
    ``"pantograph"``, ``"filter"`` and ``"band"`` where they apply.

    Attributes
    ----------
    study : Study
    dimensions : tuple of Dimension
    labels : mapping of str to tuple of str
        Names along pantograph, filter and band.
    variables : mapping of str to Variable
        Numbers; NaN where a case has none.
    status, reason, key, backend, marked, warnings : arrays of str over the dimensions
        ``"done"``, ``"failed"``, ``"refused"`` (by validation) or ``"missing"`` (not computed);
        why; what identifies the result; the kernels that computed it; the columns whose figures
        mesh and time step do not carry; what to know before its numbers are used.
    """

    study: Study
    dimensions: tuple[Dimension, ...]
    labels: Mapping[str, tuple[str, ...]]
    variables: Mapping[str, Variable]
    status: NDArray[np.object_]
    reason: NDArray[np.object_]
    key: NDArray[np.object_]
    backend: NDArray[np.object_]
    marked: NDArray[np.object_]
    warnings: NDArray[np.object_]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the dimensions of the study."""
        return tuple(dimension.name for dimension in self.dimensions)

    @property
    def axes(self) -> tuple[AxisValues, ...]:
        """All axes of the study."""
        return tuple(axis for dimension in self.dimensions for axis in dimension.axes)

    def counts(self) -> dict[str, int]:
        """Return the number of cases by status."""
        states, numbers = np.unique(self.status.astype(str), return_counts=True)
        found = dict(zip(states.tolist(), numbers.tolist(), strict=True))
        return {state: found.get(state, 0) for state in ("done", "failed", REFUSED, MISSING)}

    def mixture(self) -> str:
        """Say which kernels computed how many cases, when they were not all the same; else ''."""
        kernels, numbers = np.unique(
            self.backend[self.backend != ""].astype(str), return_counts=True
        )
        if len(kernels) < 2:
            return ""
        listed = ", ".join(f"{name}: {n} cases" for name, n in zip(kernels, numbers, strict=True))
        return f"cases were computed by different kernels, equal but for the last digits ({listed})"

    def carries(self, index: tuple[int, ...], column: str) -> bool:
        """Return whether mesh and time step of a case carry a figure.

        Parameters
        ----------
        index
            Place of the case along the dimensions of the study.
        column
            ``"std_0_200"``, or ``"losses"``.
        """
        return column not in str(self.marked[index]).split(", ")

    def error(self, name: str, index: tuple[int, ...]) -> float:
        """Return the numerical error of a quantity in one place; NaN where none was asked for."""
        found = self.variables.get(name + columns.ERROR)
        return float("nan") if found is None else float(found.values[index])

    def __getitem__(self, name: str) -> Variable:
        """Return a variable by name."""
        if name not in self.variables:
            raise InputError(f"the table holds no {name!r}; it holds: {', '.join(self.variables)}")
        return self.variables[name]

    def failures(self) -> tuple[Alike, ...]:
        """Return what failed, equal reasons together, the commonest first."""
        return self._alike(self.reason, ("failed", REFUSED))

    def warned(self) -> tuple[Alike, ...]:
        """Return the warnings of what was done, equal ones together, the commonest first."""
        return self._alike(self.warnings, ("done",))

    def _alike(self, told: NDArray[np.object_], states: tuple[str, ...]) -> tuple[Alike, ...]:
        groups: dict[tuple[str, str], list[int]] = {}
        texts: dict[tuple[str, str], str] = {}
        pairs = zip(self.status.ravel(), told.ravel(), strict=True)
        for number, (status, reason) in enumerate(pairs, 1):
            if reason and status in states:
                group = (str(status), _NUMBERS.sub("#", str(reason)))
                groups.setdefault(group, []).append(number)
                texts.setdefault(group, str(reason))
        order = sorted(groups, key=lambda group: (-len(groups[group]), groups[group]))
        return tuple(Alike(group[0], texts[group], tuple(groups[group])) for group in order)

    def coordinates(self) -> dict[str, Variable]:
        """Return the values of the axes over their dimension, by short name."""
        found = {}
        for dimension in self.dimensions:
            for axis in dimension.axes:
                dtype = float if axis.is_numeric else object
                quantity = Quantity(axis.name, axis.unit or "1", axis.path)
                values = np.array(axis.coordinates, dtype=dtype)
                found[axis.name] = Variable(quantity, (dimension.name,), values)
        return found

    def to_csv(self) -> str:
        """Return one row per case as CSV; units stand in the headers."""
        flat = list(self._flat())
        axes = [_headed(axis.name, axis.unit) for axis in self.axes]
        head = ["case", *axes, *columns.TEXTS, *(head for head, _ in flat)]
        rows = []
        for number, index in enumerate(np.ndindex(*self.status.shape)):
            values = [_cell(column[number]) for _, column in flat]
            texts = [values_of[index] for values_of in self._told().values()]
            rows.append([number + 1, *self._place(index), *texts, *values])
        return csv_text(head, rows)

    def rows(self) -> list[dict[str, Any]]:
        """Return one plain mapping per case for JSON: axes, texts, numbers."""
        flat = list(self._flat())
        found = []
        for number, index in enumerate(np.ndindex(*self.status.shape)):
            axes = zip(self.axes, self._place(index), strict=True)
            row = {"case": number + 1, **{axis.name: value for axis, value in axes}}
            row |= {name: values[index] for name, values in self._told().items()}
            found.append(row | {head: float(column[number]) for head, column in flat})
        return found

    def _place(self, index: tuple[int, ...]) -> list[Any]:
        return [
            axis.coordinates[at]
            for dimension, at in zip(self.dimensions, index, strict=True)
            for axis in dimension.axes
        ]

    def _flat(self) -> Iterator[tuple[str, NDArray[Any]]]:
        """Yield every column of the table: header with unit, one number per case."""
        count = self.status.size
        for variable in self.variables.values():
            quantity = variable.quantity
            further = [self.labels[name] for name in quantity.dimensions]
            columns_of = self._told_values(quantity.name).reshape(count, -1)
            for at, index in enumerate(np.ndindex(*map(len, further))):
                words = [labels[i] for labels, i in zip(further, index, strict=True)]
                band = f"_{words.pop()}" if BAND in quantity.dimensions else ""
                name = quantity.name.removesuffix(columns.ERROR)
                head = ".".join([*words, name + band + quantity.name[len(name) :]])
                yield _headed(head, quantity.unit), columns_of[:, at]

    def _told_values(self, name: str) -> NDArray[Any]:
        """Return the numbers of a variable without digits that their errors make worthless."""
        values, errors = self.variables[name].values, self.variables.get(name + columns.ERROR)
        if errors is None:
            return values
        return np.vectorize(rounded, otypes=[float])(values, errors.values)

    def to_xarray(self) -> Any:
        """Return the table as an ``xarray.Dataset``.

        Raises
        ------
        InputError
            When xarray is not installed.
        """
        try:
            import xarray
        except ImportError:
            raise not_installed("xarray", "data") from None
        variables = {
            name: (item.dimensions, item.values, _attributes(item.quantity))
            for name, item in [*self.variables.items(), *self._texts().items()]
        }
        coordinates: dict[str, Any] = {
            name: (item.dimensions, item.values, _attributes(item.quantity))
            for name, item in self.coordinates().items()
        }
        coordinates |= {name: list(labels) for name, labels in self.labels.items() if labels}
        return xarray.Dataset(variables, coordinates, {"study": self.study.name})

    def _texts(self) -> dict[str, Variable]:
        return {
            name: Variable(Quantity(name, "1", columns.TEXTS[name]), self.names, values)
            for name, values in self._told().items()
        }

    def _told(self) -> dict[str, NDArray[np.object_]]:
        return {name: getattr(self, name) for name in columns.TEXTS}

    def content(self) -> tuple[dict[str, Variable], dict[str, Variable], dict[str, Any]]:
        """Return coordinates, variables and attributes as a netCDF file holds them."""
        labels = {
            name: Variable(Quantity(name, "1", name), (name,), np.array(values, dtype=object))
            for name, values in self.labels.items()
            if values
        }
        attributes = {
            "title": self.study.title or self.study.name,
            "study": json.dumps(self.study.to_dict(), ensure_ascii=False),
        }
        coordinates = self.coordinates() | labels
        return coordinates, {**self.variables, **self._texts()}, attributes


def collect(plan: Plan, store: Store) -> StudyTable:
    """Read the rows of a study from disk and put them side by side.

    Parameters
    ----------
    plan
    store

    Returns
    -------
    StudyTable
    """
    rows = {key: row for key in plan.by_key if (row := store.load(key)) is not None}
    labels = _labels(rows.values())
    axes = {axis.name for dimension in plan.dimensions for axis in dimension.axes}
    quantities = _quantities(rows.values(), labels, axes)
    arrays = {
        q.name: np.full((len(plan.points), *(len(labels[d]) for d in q.dimensions)), np.nan)
        for q in quantities
    }
    texts = {name: np.full(len(plan.points), "", dtype=object) for name in columns.TEXTS}
    for at, point in enumerate(plan.points):
        row = rows.get(point.key)
        status = str(row["status"]) if row else REFUSED if point.problems else MISSING
        reason = str(row["reason"]) if row else "; ".join(point.problems)
        own = [str(row["values"].get(name, "")) if row else "" for name in _OWN_TEXTS]
        for name, text in zip(columns.TEXTS, (status, reason, point.key, *own), strict=True):
            texts[name][at] = text
        if row is not None:
            _fill(arrays, at, row, labels)
    names = tuple(dimension.name for dimension in plan.dimensions)
    return StudyTable(
        study=plan.study,
        dimensions=plan.dimensions,
        labels=labels,
        variables={
            q.name: Variable(
                q,
                (*names, *q.dimensions),
                arrays[q.name].reshape(*plan.shape, *arrays[q.name].shape[1:]),
            )
            for q in quantities
        },
        **{name: values.reshape(plan.shape) for name, values in texts.items()},
    )


def _labels(rows: Iterable[Row]) -> dict[str, tuple[str, ...]]:
    """Return the names of pantographs, filters and bands in all rows, in order."""
    found: dict[str, dict[str, None]] = {PANTOGRAPH: {}, FILTER: {}, BAND: {}}
    for row in rows:
        for entry in row["values"].get("pantographs", ()):
            found[PANTOGRAPH][entry["name"]] = None
            for kind, part in entry["filters"].items():
                found[FILTER][kind] = None
                found[BAND] |= dict.fromkeys(_bands(part))
    return {name: tuple(entries) for name, entries in found.items()}


def _bands(part: Mapping[str, Any]) -> list[str]:
    return [name[4:] for name in part if re.fullmatch(r"std_[\d.]+_[\d.]+", name)]


def _quantities(
    rows: Collection[Row], labels: Mapping[str, Sequence[str]], axes: Set[str]
) -> list[Quantity]:
    """Return what the table holds: the known quantities, then numbers of other tasks."""
    taken = axes | set(columns.NAMES)
    others = {
        name: None
        for row in rows
        for name, value in row["values"].items()
        if isinstance(value, (int, float)) and name not in taken
    }
    found = columns.KNOWN if labels[PANTOGRAPH] else ()
    if any("uplift_max" + columns.ERROR in row["values"] for row in rows):
        found = (*found, *columns.ERRORS)
    return [*found, *(Quantity(name, "1", name) for name in others), *columns.COST]


def _fill(
    arrays: Mapping[str, NDArray[Any]], at: int, row: Row, labels: Mapping[str, Sequence[str]]
) -> None:
    """Enter the numbers of a row."""
    values = row["values"]
    for name, value in [*values.items(), *row["cost"].items()]:
        if name in arrays and isinstance(value, (int, float)):
            arrays[name][at] = value
    for entry in values.get("pantographs", ()):
        who = labels[PANTOGRAPH].index(entry["name"])
        for name in _held(arrays, columns.PER_PANTOGRAPH):
            arrays[name][at, who] = _number(entry.get(name))
        for kind, part in entry["filters"].items():
            through = labels[FILTER].index(kind)
            for name in _held(arrays, columns.PER_FILTER):
                arrays[name][at, who, through] = _number(part.get(name))
            for name in _held(arrays, (columns.STD,)):
                for number, band in enumerate(labels[BAND]):
                    value = part.get(name.replace("std", f"std_{band}"))
                    arrays[name][at, who, through, number] = _number(value)


def _held(arrays: Mapping[str, NDArray[Any]], quantities: Iterable[Quantity]) -> list[str]:
    """Return the names of quantities, and of their errors, that the table holds."""
    names = [name for own in quantities for name in (own.name, own.name + columns.ERROR)]
    return [name for name in names if name in arrays]


def _number(value: float | None) -> float:
    return float("nan") if value is None else float(value)


def _attributes(quantity: Quantity) -> dict[str, str]:
    return {"long_name": quantity.text, "units": quantity.unit}


def _headed(name: str, unit: str) -> str:
    return f"{name} [{unit}]" if unit and unit != "1" else name


def _cell(value: float) -> str:
    return f"{value:.10g}" if np.isfinite(value) else ""
