"""The arrays of a line as the compiled core takes them.

The core wants the nodes of all wires end to end, wire after wire and each from left to right. The
element between the last node of a wire and the first of the next has no stiffness and no mass.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.motion.dispersion import WaveStiffening
from tautwire.numerics.network.system import System

Array = NDArray[Any]
Index = NDArray[np.int64]


class NotAChainError(ValueError):
    """The wires of a line branch or close to rings, or a path does not follow one of them."""


@dataclass(frozen=True, eq=False)
class NodeOrder:
    """The nodes of a line in the order of the core.

    Attributes
    ----------
    nodes : (n_node,)
        Nodes of the line, wire after wire.
    cables : (n_node - 1,)
        Cable between a node and the next; -1 where a wire ends.
    """

    nodes: Index
    cables: Index

    @cached_property
    def place(self) -> Index:
        """Where each node of the line stands, ``(n_node,)``."""
        place = np.empty_like(self.nodes)
        place[self.nodes] = np.arange(len(self.nodes))
        return place

    @cached_property
    def dofs(self) -> Index:
        """Degrees of freedom of the line in the order of the core, ``(6 n_node,)``."""
        return (6 * self.nodes[:, None] + np.arange(6)).ravel()

    @classmethod
    def of(cls, cable_nodes: Index, node_count: int) -> NodeOrder:
        """Follow the cables ``(n_cable, 2)`` from left to right, wire after wire.

        Raises
        ------
        NotAChainError
            A node has two cables to one side, or cables form a ring.
        """
        cable_of = np.full(node_count, -1)
        has_left = np.zeros(node_count, dtype=bool)
        left, right = cable_nodes[:, 0], cable_nodes[:, 1]
        cable_of[left] = np.arange(len(left))
        has_left[right] = True
        if len(np.unique(left)) < len(left) or len(np.unique(right)) < len(right):
            raise NotAChainError("a node has two wire elements to one side")
        nodes: list[int] = []
        cables: list[int] = []
        for start in np.flatnonzero(~has_left):
            node = int(start)
            while True:
                cable = int(cable_of[node])
                nodes.append(node)
                cables.append(cable)
                if cable < 0:
                    break
                node = int(right[cable])
        if len(nodes) < node_count:
            raise NotAChainError("wire elements form a ring")
        return cls(np.array(nodes, dtype=np.int64), np.array(cables[:-1], dtype=np.int64))


def line_arrays(
    system: System,
    order: NodeOrder,
    stiffening: WaveStiffening | None,
    contact_stiffness: float,
) -> dict[str, Any]:
    """Return the arrays of a line by the names of the core.

    Parameters
    ----------
    system
        The line.
    order
        The order of its nodes.
    stiffening
        What is added per square of the time step.
    contact_stiffness
        Of a contact with any path [N/m].
    """
    numbers = _wires(system, order)
    attached, indices = _attachments(system, order)
    numbers |= attached
    indices["rank"] = order.nodes
    ends = [_path_ends(order, path.nodes) for path in system.paths]
    indices["path_nodes"] = np.array(ends).reshape(-1, 2)
    numbers["path_stiffness"] = np.full(len(ends), contact_stiffness)
    if stiffening is not None:
        numbers["stiffening_bending"] = _along(stiffening.bending, order, 0.0)
        numbers["stiffening_load"] = stiffening.load[order.dofs]
    result: dict[str, Any] = {k: np.ascontiguousarray(v, dtype=float) for k, v in numbers.items()}
    result |= {k: np.ascontiguousarray(v, dtype=np.int64) for k, v in indices.items()}
    result["fixed"] = np.ascontiguousarray(system.fixed[order.dofs], dtype=bool)
    result["damping_mass"] = float(system.damping.mass)
    result["damping_stiffness"] = float(system.damping.stiffness)
    return result


def _along(values: Array, order: NodeOrder, gap: float) -> Array:
    """Return values of cables in the order of the core, with one for the ends of wires."""
    padded = np.append(values, gap)
    return padded[order.cables]


def _path_ends(order: NodeOrder, nodes: Index) -> Index:
    """Return the places of the first and the last node of a path."""
    places = order.place[nodes]
    if not (np.diff(places) == 1).all() or (order.cables[places[:-1]] < 0).any():
        raise NotAChainError("the nodes of a path do not follow one wire from left to right")
    return places[[0, -1]]


def _wires(system: System, order: NodeOrder) -> dict[str, Array]:
    cables, stays = system.cables, system.stays
    node_mass = system.node_mass.copy()
    np.add.at(node_mass, stays.node, stays.mass / 3.0)
    return {
        "length": _along(cables.length, order, 1.0),
        "axial_stiffness": _along(cables.axial, order, 0.0),
        "bending_stiffness": _along(cables.bending, order, 0.0),
        "mass": _along(cables.mass, order, 0.0),
        "node_mass": node_mass[order.nodes],
        "load": system.load[order.dofs],
        "position": system.position[order.dofs],
    }


def _attachments(system: System, order: NodeOrder) -> tuple[dict[str, Array], dict[str, Index]]:
    """Return what joins wires and holds them: numbers and places."""
    ties, clamps, stays, grounds = system.ties, system.clamps, system.stays, system.grounds
    numbers = {
        "tie_length": ties.length,
        "tie_stiffness": ties.stiffness,
        "clamp_stiffness": clamps.stiffness,
        "clamp_offset": clamps.offset,
        "stay_end": stays.end,
        "stay_length": stays.length,
        "stay_stiffness": stays.stiffness,
        "ground_stiffness": grounds.stiffness,
        "ground_damping": grounds.damping,
        "ground_free": grounds.free,
    }
    places = {
        "tie_nodes": order.place[ties.nodes],
        "tie_law": ties.law,
        "clamp_nodes": order.place[clamps.nodes],
        "stay_node": order.place[stays.node],
        "stay_law": stays.law,
        "ground_node": order.place[grounds.node],
    }
    return numbers, places
