"""Defects on the arrays of a line: what is gone, and what is elsewhere or heavier."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.line.defects import Placed
from tautwire.line.pieces import Hanger
from tautwire.model.build import Model
from tautwire.numerics.network.system import System

Array = NDArray[Any]
Index = NDArray[np.int64]


def without_broken(model: Model, system: System, defects: Placed) -> System:
    """Return a line whose broken droppers and stitch wires carry nothing.

    They keep their place in the arrays. The nodes of a broken stitch wire, which holds nothing any
    more, stand still.
    """
    runs, line = defects.stitches, model.line
    idle = [
        row in defects.missing | defects.slack
        or hanger.upper.run in runs
        or hanger.lower.run in runs
        for row, hanger in enumerate(line.hangers)
    ]
    ties, cables = system.ties, system.cables
    idle = np.array(idle + [False] * (len(ties) - len(idle)), dtype=bool)
    ties = ties.with_(
        stiffness=np.where(idle, 0.0, ties.stiffness), axial=np.where(idle, np.nan, ties.axial)
    )
    fixed, axial, bending = system.fixed.copy(), cables.axial.copy(), cables.bending.copy()
    for strand in model.mesh.strands:
        if strand.run.name in runs:
            fixed.reshape(-1, 6)[strand.nodes] = True
            axial[strand.cables] = bending[strand.cables] = 0.0
    kept = np.array([joint.other.run not in runs for joint in line.joints], dtype=bool)
    clamps = system.clamps
    return system.with_(
        ties=ties,
        cables=cables.with_(axial=axial, bending=bending),
        clamps=clamps.with_(
            nodes=clamps.nodes[kept], stiffness=clamps.stiffness[kept], offset=clamps.offset[kept]
        ),
        fixed=fixed,
    )


def with_defects(model: Model, system: System, defects: Placed) -> System:
    """Return a line with other lengths, masses and places of its supports.

    Weights follow the masses in :func:`tautwire.model.operation.weather.reweighed`.
    """
    ties = system.ties
    length = ties.length.copy()
    for one, other in defects.swaps:
        length[one], length[other] = length[other], length[one]
    for row, change in defects.changes:
        length[row] += change
    ties = ties.of_length(length)
    gone = np.array([row in defects.missing for row in range(len(ties))], dtype=bool)
    ties = ties.with_(mass=np.where(gone, 0.0, ties.mass))
    return _displaced(model, system.with_(ties=ties), defects)


def lumps(model: Model, defects: Placed) -> Array:
    """Return the masses that defects add to nodes, and take from them, ``(n_node,)`` [kg]."""
    mesh = model.mesh
    mass = np.zeros(mesh.node_count)
    for row in defects.missing:
        hanger: Hanger = model.line.hangers[row]
        mass[mesh.node(hanger.upper)] -= hanger.clamps[0]
        mass[mesh.node(hanger.lower)] -= hanger.clamps[1]
    for at, extra in defects.masses:
        mass[mesh.node(at)] += extra
    return mass


def _displaced(model: Model, system: System, defects: Placed) -> System:
    """Move what holds the wires at some supports: far ends of arms, springs, fixed places."""
    line, mesh = model.line, model.mesh
    shift = np.zeros((mesh.node_count, 3))
    for number, lateral, vertical in defects.shifts:
        pieces = (*line.registrations, *line.suspensions)
        nodes = mesh.nodes(piece.at for piece in pieces if piece.label.number == number)
        axes = mesh.frames.axes[nodes]
        shift[nodes] += lateral * axes[:, 1] + vertical * axes[:, 2]
    for heel, piece in zip(mesh.heels, line.registrations, strict=True):
        if piece.heel is not None:
            shift[heel] = shift[mesh.node(piece.at)]
    position = system.position.copy().reshape(-1, 6)
    position[:, :3] += shift
    stays, grounds = system.stays, system.grounds
    return system.with_(
        position=position.ravel(),
        stays=stays.with_(end=stays.end + shift[stays.node]),
        grounds=grounds.with_(free=grounds.free + shift[grounds.node]),
    )
