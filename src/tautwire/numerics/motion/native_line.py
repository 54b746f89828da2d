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

_BOTH_WAYS, _TENSION_ONLY = 0, 1


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
    indices: dict[str, Any] = {"rank": order.nodes}
    for kind in (_ties, _clamps, _stays, _grounds):
        more_numbers, more_indices = kind(system, order)
        numbers |= more_numbers
        indices |= more_indices
    path = _path_ends(order, system.contact_nodes)
    indices["path_nodes"] = path[None]
    numbers["path_stiffness"] = np.array([contact_stiffness])
    if stiffening is not None:
        numbers["stiffening_bending"] = _along(stiffening.bending, order, 0.0)
        numbers["stiffening_load"] = stiffening.load[order.dofs]
    result: dict[str, Any] = {k: np.ascontiguousarray(v, dtype=float) for k, v in numbers.items()}
    result |= {k: np.ascontiguousarray(v, dtype=np.int64) for k, v in indices.items()}
    result["fixed"] = np.ascontiguousarray(system.fixed[order.dofs], dtype=bool)
    result["damping_mass"] = float(system.damping_mass)
    result["damping_stiffness"] = float(system.damping_stiffness)
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
    node_mass = system.node_mass.copy()
    np.add.at(node_mass, system.arm_nodes, system.arm_mass / 3.0)
    return {
        "length": _along(system.cable_length, order, 1.0),
        "axial_stiffness": _along(system.cable_axial_stiffness, order, 0.0),
        "bending_stiffness": _along(system.cable_bending_stiffness, order, 0.0),
        "mass": _along(system.cable_mass, order, 0.0),
        "node_mass": node_mass[order.nodes],
        "load": system.load[order.dofs],
        "position": system.position[order.dofs],
    }


def _ties(system: System, order: NodeOrder) -> tuple[dict[str, Array], dict[str, Index]]:
    numbers = {"tie_length": system.dropper_length, "tie_stiffness": system.dropper_stiffness}
    law = np.full(len(system.dropper_length), _TENSION_ONLY)
    return numbers, {"tie_nodes": order.place[system.dropper_nodes], "tie_law": law}


def _clamps(system: System, order: NodeOrder) -> tuple[dict[str, Array], dict[str, Index]]:
    numbers = {"clamp_stiffness": np.empty(0), "clamp_offset": np.empty((0, 3))}
    return numbers, {"clamp_nodes": np.empty((0, 2))}


def _stays(system: System, order: NodeOrder) -> tuple[dict[str, Array], dict[str, Index]]:
    numbers = {
        "stay_end": system.arm_ends,
        "stay_length": system.arm_length,
        "stay_stiffness": system.arm_stiffness,
    }
    law = np.full(len(system.arm_nodes), _BOTH_WAYS)
    return numbers, {"stay_node": order.place[system.arm_nodes], "stay_law": law}


def _grounds(system: System, order: NodeOrder) -> tuple[dict[str, Array], dict[str, Index]]:
    count = len(system.spring_dofs)
    stiffness, damping, free = np.zeros((count, 3, 3)), np.zeros((count, 3, 3)), np.zeros((count, 3))
    n, i = np.arange(count), system.spring_dofs % 6
    stiffness[n, i, i] = system.spring_stiffness
    damping[n, i, i] = system.spring_damping
    free[n, i] = system.spring_free
    numbers = {"ground_stiffness": stiffness, "ground_damping": damping, "ground_free": free}
    return numbers, {"ground_node": order.place[system.spring_dofs // 6]}
