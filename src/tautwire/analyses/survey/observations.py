"""What a survey would read of a line in some shape."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.survey.surveyed_line import Shape, Tangent
from tautwire.errors import InputError
from tautwire.line.pieces import At, Line
from tautwire.measured.survey import Reading
from tautwire.model.build import Model
from tautwire.numerics.elements.hermite import position_row

if TYPE_CHECKING:
    from scipy.sparse import csr_array

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Row = tuple[Index, Array, float]


class Observations:
    """Readings of heights and dropper lengths as functions of the shape of a line.

    Parameters
    ----------
    model
    readings
        Of contact heights, messenger heights and dropper lengths.

    Attributes
    ----------
    values, accuracies : (n,) m
    places : (n,) m
        Where they were taken, from support 1.

    Raises
    ------
    InputError
        Naming every reading at a place that the line does not have.
    """

    def __init__(self, model: Model, readings: Sequence[Reading]) -> None:
        from scipy.sparse import coo_array

        self.values = np.array([one.value for one in readings])
        self.accuracies = np.array([one.accuracy for one in readings])
        places, problems = _Places(model), []
        rows: list[tuple[Index, Array]] = []
        self._rails, ties = np.zeros(len(readings)), []
        for number, one in enumerate(readings):
            try:
                if one.quantity == "dropper length":
                    ties.append((number, places.dropper(one)))
                    rows.append((np.empty(0, dtype=np.int64), np.empty(0)))
                else:
                    dofs, weights, self._rails[number] = places.height(one)
                    rows.append((dofs, weights))
            except KeyError as error:
                problems.append(f"{one.where}: {error.args[0]}")
        if problems:
            raise InputError(problems)
        self._lengths = np.array(ties, dtype=np.int64).reshape(-1, 2)
        self.places = np.array([places.at(one) for one in readings])
        row = np.repeat(np.arange(len(rows)), [len(dofs) for dofs, _ in rows])
        dofs, weights = (np.concatenate(part) for part in zip(*rows, strict=True))
        size = (len(rows), 6 * model.mesh.node_count)
        self._heights: csr_array = coo_array((weights, (row, dofs)), shape=size).tocsr()

    def measured_lengths(self, count: int) -> tuple[Array, Array]:
        """Return precision of the measured dropper lengths, and with it their sum.

        Parameters
        ----------
        count
            Number of droppers.

        Returns
        -------
        (n_dropper,) 1/m2 and (n_dropper,) 1/m
        """
        rows, ties = self._lengths.T
        precision = self.accuracies[rows] ** -2
        found, total = np.zeros(count), np.zeros(count)
        np.add.at(found, ties, precision)
        np.add.at(total, ties, precision * self.values[rows])
        return found, total

    def predicted(self, shape: Shape) -> Array:
        """Return what would be read, ``(n,)`` [m]."""
        found = self._heights @ shape.form.system.position - self._rails
        rows, ties = self._lengths.T
        found[rows] = np.maximum(shape.distances, shape.form.system.ties.length)[ties]
        return found

    def slopes(self, tangent: Tangent) -> Array:
        """Return how the readings follow the unknowns, ``(n, n_unknown)``."""
        found = self._heights @ tangent.moved
        rows, ties = self._lengths.T
        found[rows] = tangent.lengths[ties]
        return found


class _Places:
    """Where readings lie on the mesh."""

    def __init__(self, model: Model) -> None:
        self.model, line = model, model.line
        self.by_dropper = {(h.label.span, h.label.number): i for i, h in enumerate(line.hangers)}
        self.contact = {label.number: at for label, at in line.contact_supports}
        self.messenger = {p.label.number: p.at for p in line.suspensions}

    def dropper(self, one: Reading) -> int:
        key = (one.span or 0, one.dropper or 0)
        if key not in self.by_dropper:
            most = max((n for span, n in self.by_dropper if span == one.span), default=0)
            known = f"droppers 1 to {most}" if most else "no droppers"
            raise KeyError(f"names dropper {one.dropper} of span {one.span}, which has {known}")
        return self.by_dropper[key]

    def at(self, one: Reading) -> float:
        """Return where a reading was taken [m]."""
        if one.support is not None:
            return self.model.line.masts[one.support - 1]
        if one.dropper is not None:
            return self.model.line.hangers[self.dropper(one)].lower.s
        return float(one.s or 0.0)

    def height(self, one: Reading) -> Row:
        """Return coordinates, weights and the height of the rails of a reading."""
        is_messenger = one.quantity == "messenger height"
        if one.support is not None:
            known = self.messenger if is_messenger else self.contact
            if one.support not in known:
                wire = "messenger" if is_messenger else "contact"
                raise KeyError(f"there is no {wire} wire on support {one.support} to measure")
            return self._at_node(known[one.support])
        if one.dropper is not None:
            hanger = self.model.line.hangers[self.dropper(one)]
            return self._at_node(hanger.upper if is_messenger else hanger.lower)
        return self._between("messenger" if is_messenger else "contact", float(one.s or 0.0))

    def _at_node(self, at: At) -> Row:
        node = self.model.mesh.node(at)
        normal, origin = (getattr(self.model.mesh.frames, n)[node] for n in ("axes", "origin"))
        return 6 * node + np.arange(3), normal[2], float(normal[2] @ origin)

    def _between(self, role: str, s: float) -> Row:
        mesh = self.model.mesh
        runs = [run for run in _of_role(self.model.line, role) if run.start.s <= s <= run.end.s]
        if not runs:
            raise KeyError(f"there is no {role} wire at {s:.2f} m from support 1")
        run = min(runs, key=lambda run: self._nearest(run.name, s))
        strand = mesh.strand(run.name)
        element = int(np.clip(np.searchsorted(strand.s, s) - 1, 0, len(strand.s) - 2))
        left, right = strand.s[element], strand.s[element + 1]
        length = self.model.form.system.cables.length[strand.cables[element]]
        row = position_row((s - left) / (right - left), length)
        nodes = strand.nodes[[element, element + 1]]
        dofs = (6 * nodes[:, None, None] + np.arange(6).reshape(2, 3)).reshape(4, 3)
        frame = self.model.line.track.frames(np.array([s]))
        normal, origin = frame.axes[0, 2], frame.origin[0]
        weights = (row[:, None] * normal).ravel()
        return dofs.ravel(), weights, float(normal @ origin)

    def _nearest(self, name: str, s: float) -> float:
        """Return the guessed height of a wire at a place, to take the lowest."""
        strand, mesh = self.model.mesh.strand(name), self.model.mesh
        return float(
            np.interp(s, strand.s, mesh.heights(self.model.form.system.position)[strand.nodes])
        )


def _of_role(line: Line, role: str) -> tuple:
    return tuple(run for run in line.runs if run.role == role)
