"""Cantilevers that give way: heels of steady arms as nodes, and springs to the ground.

A spring is free where it leaves the found shape in balance: there the wires are where they are
told to be. From there ``K (u - u0)`` holds the node, with K diagonal along the axes of the track.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.line.closures import AtRest
from tautwire.line.pieces import At, Line
from tautwire.model.mesh import Mesh
from tautwire.model.registrations import Group
from tautwire.numerics.network.parts import Grounds, Ties
from tautwire.numerics.network.system import System, internal_force
from tautwire.specs.line.cantilever import Elastic

Array = NDArray[Any]
Index = NDArray[np.int64]

HOLDING = 1e8
"""Stiffness of a spring that holds a node in a direction across the axes of the coordinates [N/m]:
under 1 kN it gives way by 10 micrometres, and it is no stiffer than a wire element of 0.15 m."""


def arms_on_heels(mesh: Mesh, group: Group, rest: AtRest) -> tuple[AtRest, Ties]:
    """Return arms with a fixed far end as they are, and those with an elastic one as ties."""
    heels = mesh.heels[group.rows]
    if not len(rest.stays) or (heels < 0).all():
        return rest, Ties.none()
    stays, elastic = rest.stays, heels >= 0
    arms = stays.chosen(elastic)
    ties = Ties(
        nodes=np.stack([heels[elastic], arms.node], axis=1),
        length=arms.length,
        stiffness=arms.stiffness,
        axial=np.full(len(arms), np.nan),
        mass=np.zeros(len(arms)),
        law=arms.law,
    )
    return replace(rest, stays=stays.chosen(~elastic)), ties


def moving_masses(line: Line, mesh: Mesh, broken: Collection[int]) -> Array:
    """Return what moves with elastic cantilevers and is not among the weights, ``(n_node,)`` [kg].

    An arm has a third of its mass on the wire and the rest on its heel: right when the wire moves
    alone, and when both move together.
    """
    mass = np.zeros(mesh.node_count)
    for row, piece in enumerate(line.registrations):
        if piece.heel is not None:
            arm = 0.0 if row in broken else piece.kind.carried_weight(1.0)
            mass[mesh.node(piece.at)] += arm / 3.0
            mass[mesh.heels[row]] += piece.heel.mass + 2.0 * arm / 3.0
    for piece in line.suspensions:
        if piece.elastic is not None:
            mass[mesh.node(piece.at)] += piece.elastic.mass
    return mass


def held_heels(line: Line, mesh: Mesh, held: NDArray[np.bool_], broken: Collection[int]) -> None:
    """Hold heels in the directions in which they are rigid, those of broken arms in all."""
    for row, piece in enumerate(line.registrations):
        if piece.heel is not None:
            rigid = (False, piece.heel.lateral is None, piece.heel.vertical is None)
            held[mesh.heels[row]] = True if row in broken else rigid


def elastic_grounds(line: Line, mesh: Mesh, system: System, broken: Collection[int]) -> Grounds:
    """Return the springs of elastic cantilevers, which leave the state of the system in balance.

    Parameters
    ----------
    line, mesh
    system
        At rest but for these springs.
    broken
        Rows of registrations that hold nothing.
    """
    rows = list(_springs(line, mesh, system.damping.stiffness, broken))
    if not rows:
        return Grounds.none()
    node = np.array([node for node, _, _ in rows], dtype=np.int64)
    stiffness, damping = (np.array(values) for values in list(zip(*rows, strict=True))[1:])
    frames = mesh.frames[node]
    left = internal_force(system, system.position).nodal - system.load
    local = frames.components(left.reshape(-1, 6)[node, :3])
    offset = np.divide(local, stiffness, out=np.zeros_like(local), where=stiffness > 0.0)
    return Grounds(
        node,
        frames.matrices(_diagonal(stiffness)),
        frames.matrices(_diagonal(damping)),
        system.position.reshape(-1, 6)[node, :3] + frames.turned(offset),
    )


def _springs(
    line: Line, mesh: Mesh, damping: float, broken: Collection[int]
) -> Iterator[tuple[int, list[float], list[float]]]:
    """Yield nodes with stiffness and damping along the track, lateral and vertical.

    A heel that follows the wires along the track is held there in a passage as the far end of a
    rigid arm is. At a fixed point the messenger wire is held along the track by more than this.
    """
    for row, piece in enumerate(line.registrations):
        if piece.heel is not None and row not in broken:
            given = _along_axes(piece.heel)
            dampers = [piece.heel.damping if value else 0.0 for value in given]
            if piece.heel.along is None:
                given[0], dampers[0] = HOLDING, damping * HOLDING
            yield int(mesh.heels[row]), given, dampers
    for piece in line.suspensions:
        if piece.elastic is not None:
            given = _along_axes(piece.elastic)
            given[0] = 0.0 if piece.is_fixed_along else given[0]
            yield mesh.node(piece.at), given, [piece.elastic.damping if v else 0.0 for v in given]


def _along_axes(elastic: Elastic) -> list[float]:
    return [elastic.along or 0.0, elastic.lateral or 0.0, elastic.vertical or 0.0]


def _diagonal(values: Array) -> Array:
    matrix = np.zeros((len(values), 3, 3))
    matrix[:, [0, 1, 2], [0, 1, 2]] = values
    return matrix


def resisting(line: Line, mesh: Mesh) -> Index:
    """Return the nodes at which cantilevers resist the travel of the wires elastically."""
    places: list[At] = [
        p.at for p in line.suspensions if p.elastic is not None and p.elastic.along is not None
    ]
    heels = [
        int(mesh.heels[row])
        for row, piece in enumerate(line.registrations)
        if piece.heel is not None and piece.heel.along is not None
    ]
    return np.concatenate([mesh.nodes(places), np.array(heels, dtype=np.int64)])
