"""A line whose dropper lengths and support heights are unknown: its shape, and how it follows.

The unknowns are the unstrained length of every dropper, and the heights of the messenger wire and,
where the supports prescribe it, of the contact wire at every support between the anchors. They are
what a case gives in mode ``length``; the shape is that of the case with these values.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.road.shape import solve_design, with_lengths, with_slack
from tautwire.line.pieces import At
from tautwire.model.build import Model
from tautwire.numerics.statics.form_finding import Form, FormProblem
from tautwire.numerics.statics.form_response import FormResponse

Array = NDArray[np.float64]
Index = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Shape:
    """The line at some values of its unknowns.

    Attributes
    ----------
    values : (n_unknown,) m
    problem : FormProblem
    form : Form
    """

    values: Array
    problem: FormProblem
    form: Form

    @property
    def taut(self) -> NDArray[np.bool_]:
        """Droppers that carry."""
        return self.problem.taut

    @property
    def distances(self) -> Array:
        """Distances between the clamps of the droppers [m]."""
        system = self.form.system
        return system.ties.state(system.position).length

    @property
    def forces(self) -> Array:
        """Forces of the droppers, zero where slack, ``(n_dropper,)`` [N]."""
        ties = self.form.system.ties
        return np.where(self.taut, ties.stiffness * (self.distances - ties.length), 0.0)


@dataclass(frozen=True, eq=False)
class Tangent:
    """How the line follows its unknowns.

    Attributes
    ----------
    moved : (n_dof, n_unknown)
        Coordinates of the nodes.
    forces : (n_dropper, n_unknown) N/m
    distances, lengths : (n_dropper, n_unknown)
        Between the clamps; and of the droppers as they hang, which slack ones have of their own.
    """

    moved: Array
    forces: Array
    distances: Array
    lengths: Array


class SurveyedLine:
    """A line with unknown dropper lengths and support heights.

    Parameters
    ----------
    model
        The line as designed.

    Attributes
    ----------
    model : Model
    design : Shape
    messenger, contact : tuple of int
        Supports, from 1, whose heights of the messenger and the contact wire are unknown.
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        line, mesh = model.line, model.mesh
        form, _ = solve_design(model)
        suspensions = [(p.label.number, p.at) for p in line.suspensions]
        held = [(p.label.number, p.at) for p in line.registrations if 2 in p.kind.held]
        self.messenger, self._hung = _by_support(suspensions, mesh.nodes)
        self.contact, self._held = _by_support(held, mesh.nodes)
        self._base = form
        lengths = form.system.ties.length
        values = np.concatenate([lengths, np.zeros(len(self.messenger) + len(self.contact))])
        taut = form.system.ties.state(form.system.position).length > lengths
        self.design = self.at(values, taut)

    @property
    def droppers(self) -> int:
        """Number of droppers; the first unknowns are their lengths."""
        return len(self.model.line.hangers)

    @property
    def count(self) -> int:
        """Number of unknowns."""
        return self.droppers + len(self.messenger) + len(self.contact)

    def at(self, values: Array, taut: NDArray[np.bool_]) -> Shape:
        """Return the line at some values.

        Parameters
        ----------
        values : (n_unknown,) m
            Lengths of the droppers; heights above the design of the messenger wire and of the
            contact wire at the supports.
        taut : (n_dropper,) bool
            First guess of the droppers that carry.

        Raises
        ------
        ConvergenceError
            When there is no equilibrium with these values.
        """
        problem = with_lengths(self.model, self._base, values[: self.droppers])
        position = problem.system.position.reshape(-1, 6).copy()
        normal = self.model.mesh.frames.axes[:, 2]
        groups = [*self._hung, *self._held]
        for nodes, rise in zip(groups, values[self.droppers :], strict=True):
            position[nodes, :3] += rise * normal[nodes]
        system = problem.system.with_(position=position.ravel())
        problem, form, _ = with_slack(replace(problem, system=system, taut=taut))
        return Shape(values, problem, form)

    def tangent(self, shape: Shape) -> Tangent:
        """Return how the line follows small changes; slack droppers change nothing."""
        response = FormResponse(shape.problem, shape.form)
        system, taut = shape.form.system, np.flatnonzero(shape.taut)
        moved = np.zeros((system.dof_count, self.count))
        forces = np.zeros((self.droppers, self.count))
        moved[:, taut], forces[:, taut] = response.of_lengths(taut)
        for column, nodes in enumerate([*self._hung, *self._held], self.droppers):
            parts = response.of_held(6 * nodes + 2)
            moved[:, column], forces[:, column] = (part.sum(axis=1) for part in parts)
        ties = system.ties
        ends = moved.reshape(-1, 6, self.count)[ties.nodes, :3]
        direction = ties.state(system.position).direction
        distances = np.einsum("in,nik->nk", direction, ends[:, 0] - ends[:, 1])
        own = np.eye(self.droppers, self.count)
        lengths = np.where(shape.taut[:, None], distances, own)
        return Tangent(moved, forces, distances, lengths)


def _by_support(
    pieces: Sequence[tuple[int, At]], nodes: Any
) -> tuple[tuple[int, ...], list[Index]]:
    """Return the numbers of the supports that have pieces, and the nodes of these."""
    numbers = sorted({number for number, _ in pieces})
    return tuple(numbers), [nodes(at for n, at in pieces if n == number) for number in numbers]
