"""Registrations and suspensions as arrays: while the shape is sought, found, and at rest."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tautwire.line.closures import AtRest, Closure, Held, along_axes
from tautwire.line.pieces import Line
from tautwire.model.mesh import Mesh
from tautwire.numerics.network.parts import Grounds, Stays
from tautwire.results.equilibrium import Equilibrium

Array = NDArray[np.float64]
Index = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Group:
    """All registrations of one kind.

    Attributes
    ----------
    kind : Closure
    rows : (n,)
        Which of the line's registrations.
    nodes : (n,)
    end : (n, 3) m
        Given far ends of their arms; NaN where none is given.
    """

    kind: Closure
    rows: Index
    nodes: Index
    end: Array


def groups(line: Line, mesh: Mesh, without: Collection[int] = ()) -> Iterator[Group]:
    """Yield the registrations of a line kind by kind, some rows left out."""
    kinds: dict[Closure, list[int]] = {}
    for row, piece in enumerate(line.registrations):
        if row in without:
            continue
        kinds.setdefault(piece.kind, []).append(row)
    for kind, rows in kinds.items():
        pieces = [line.registrations[row] for row in rows]
        ends = [(p.at.s, *(p.end or (np.nan, np.nan))) for p in pieces]
        nodes = mesh.nodes(piece.at for piece in pieces)
        yield Group(kind, np.array(rows, dtype=np.int64), nodes, np.array(ends, dtype=float))


def design_stays(line: Line, mesh: Mesh) -> Stays:
    """Return the arms that take part while the shape is sought."""
    return Stays.none().joined(*(g.kind.design_stays(g.nodes, g.end) for g in groups(line, mesh)))


def held_registrations(
    line: Line, mesh: Mesh, position: Array, reactions: Array, gravity: float
) -> Held:
    """Return how the contact wires are held in a found shape, one row per registration.

    Parameters
    ----------
    line, mesh
    position, reactions : (n_dof,)
        Coordinates, and the forces that hold them.
    gravity
        [m/s2]
    """
    count = len(line.registrations)
    whole = Held(*(np.full(shape, np.nan) for shape in (count, count, (count, 3), count)))
    r, forces = (values.reshape(-1, 6)[:, :3] for values in (position, reactions))
    for group in groups(line, mesh):
        held = group.kind.hold(r[group.nodes], forces[group.nodes], group.end, gravity)
        for name in ("force", "angle", "end", "preload"):
            getattr(whole, name)[group.rows] = getattr(held, name)
    return whole


def registrations_at_rest(
    line: Line, mesh: Mesh, shape: Equilibrium, gravity: float, broken: Collection[int]
) -> Iterator[tuple[Group, AtRest]]:
    """Yield what holds the contact wires once the shape is found, kind by kind; broken rows not."""
    r = shape.position.reshape(-1, 6)[:, :3]
    held = _held_in(line, shape)
    for group in groups(line, mesh, broken):
        own = Held(*(getattr(held, n)[group.rows] for n in ("force", "angle", "end", "preload")))
        yield group, group.kind.at_rest(group.nodes, r[group.nodes], own, gravity)


def _held_in(line: Line, shape: Equilibrium) -> Held:
    """Read how the wires are held from an equilibrium, one row per registration."""
    rows = np.array(line.registration_rows, dtype=np.int64)
    count = len(shape.support_x)
    force, angle, end = (np.full(size, np.nan) for size in (count, count, (count, 3)))
    arms = shape.arm_supports - 1
    force[arms], angle[arms], end[arms] = shape.arm_forces, shape.arm_angles, shape.arm_ends
    return Held(force[rows], angle[rows], end[rows], shape.contact_preloads[rows])


def suspension_grounds(line: Line, mesh: Mesh, free_height: Array) -> Grounds:
    """Return the springs of the suspensions, slack at given heights ``(n_suspension,)`` [m]."""
    pieces = line.suspensions
    zeros = np.zeros(len(pieces))
    return Grounds(
        mesh.nodes(piece.at for piece in pieces),
        along_axes(zeros, np.array([piece.stiffness for piece in pieces])),
        along_axes(zeros, np.array([piece.damping for piece in pieces])),
        np.column_stack([zeros, zeros, free_height]),
    )
