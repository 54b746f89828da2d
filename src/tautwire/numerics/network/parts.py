"""What a line is made of, as arrays: one class for each kind of part.

Nodes carry six coordinates each, ``x y z`` and the slopes ``x' y' z'``; only cables use the slopes.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.elements import ancf
from tautwire.numerics.elements.bar import BarState, bar_state, bar_tangent

Array = NDArray[Any]
Index = NDArray[np.int64]

BOTH_WAYS, TENSION_ONLY, COMPRESSION_ONLY = 0, 1, 2
"""Laws of an axial force: a bar, a rope (dropper), a stop."""


def law_allows(law: Index, axial: Array) -> NDArray[np.bool_]:
    """Tell where a law lets an axial force (tension positive) act."""
    force = np.real(axial)
    return (
        (law == BOTH_WAYS)
        | ((law == TENSION_ONLY) & (force > 0.0))
        | ((law == COMPRESSION_ONLY) & (force < 0.0))
    )


@dataclass(frozen=True, eq=False)
class _Part:
    def with_(self, **changes: Any) -> Self:
        """Return a copy with some arrays replaced."""
        return replace(self, **changes)

    def chosen(self, keep: NDArray[np.bool_]) -> Self:
        """Return some of the parts."""
        return replace(self, **{item.name: getattr(self, item.name)[keep] for item in fields(self)})

    def joined(self, *others: Self) -> Self:
        """Return these parts and some others as one group."""
        names = [item.name for item in fields(self)]
        groups = (self, *others)
        return replace(self, **{n: np.concatenate([getattr(g, n) for g in groups]) for n in names})


@dataclass(frozen=True, eq=False)
class Cables(_Part):
    """Wire elements.

    Attributes
    ----------
    nodes : (n_cable, 2)
        Left and right node; a node is at most once left and once right.
    length : (n_cable,) m
        Unstrained lengths.
    axial, bending, mass : (n_cable,) N, N m2, kg/m
        EA, EI and mass per unstrained length.
    """

    nodes: Index
    length: Array
    axial: Array
    bending: Array
    mass: Array

    def __len__(self) -> int:
        return len(self.length)

    @classmethod
    def none(cls) -> Cables:
        """Return no cable at all."""
        return cls(np.empty((0, 2), dtype=np.int64), *(np.empty(0) for _ in range(4)))

    @cached_property
    def section(self) -> ancf.CableSection:
        """Length and stiffness of the elements."""
        return ancf.CableSection(self.length, self.axial, self.bending)

    @cached_property
    def dofs(self) -> Index:
        """Degrees of freedom of each element, ``(12, n_cable)``."""
        return (6 * self.nodes[:, :, None] + np.arange(6)).reshape(-1, 12).T

    def coordinates(self, q: Array) -> Array:
        """Gather element coordinates (r1, r1', r2, r2') from ``q``, ``(4, 3, n_cable)``."""
        nodes = q.reshape(-1, 6)
        e = np.empty((12, len(self)), dtype=q.dtype)
        e[:6] = nodes[self.nodes[:, 0]].T
        e[6:] = nodes[self.nodes[:, 1]].T
        return e.reshape(4, 3, -1)

    def add_forces(self, total: Array, forces: Array) -> None:
        """Add element forces ``(4, 3, n_cable)`` to the nodal forces ``(n_dof,)`` in place."""
        nodes, flat = total.reshape(-1, 6), forces.reshape(12, -1)
        nodes[self.nodes[:, 0]] += flat[:6].T
        nodes[self.nodes[:, 1]] += flat[6:].T


@dataclass(frozen=True, eq=False)
class Ties(_Part):
    """Straight bars between two nodes: droppers, ropes.

    Attributes
    ----------
    nodes : (n_tie, 2)
        Upper node first.
    length, stiffness : (n_tie,) m, N/m
        Unstrained length and stiffness k of a taut tie.
    axial : (n_tie,) N
        EA where the stiffness is ``EA / length``; NaN where it is a spring of its own.
    mass : (n_tie,) kg/m
        Per unstrained length; one half hangs on either end.
    law : (n_tie,)
        ``BOTH_WAYS``, ``TENSION_ONLY`` or ``COMPRESSION_ONLY``.
    """

    nodes: Index
    length: Array
    stiffness: Array
    axial: Array
    mass: Array
    law: Index

    def __len__(self) -> int:
        return len(self.length)

    @classmethod
    def none(cls) -> Ties:
        """Return no tie at all."""
        none = np.empty(0)
        return cls(
            np.empty((0, 2), dtype=np.int64), none, none, none, none, np.empty(0, dtype=np.int64)
        )

    @cached_property
    def dofs(self) -> Index:
        """Degrees of freedom of each tie, ``(6, n_tie)``."""
        return (6 * self.nodes[:, :, None] + np.arange(3)).reshape(-1, 6).T

    def state(self, q: Array) -> BarState:
        """Return direction (lower to upper node) and length at coordinates ``q``."""
        r = q.reshape(-1, 6)[:, :3]
        return bar_state(r[self.nodes[:, 0]].T, r[self.nodes[:, 1]].T)

    def of_length(self, length: Array) -> Ties:
        """Return the ties with other unstrained lengths, and the stiffness that follows."""
        stiffness = np.where(np.isnan(self.axial), self.stiffness, self.axial / length)
        return self.with_(length=length, stiffness=stiffness)

    def acting(self, axial: Array) -> NDArray[np.bool_]:
        """Tell which ties have their stiffness under some axial forces ``(n_tie,)`` [N]."""
        return law_allows(self.law, axial)

    def hanging_mass(self, node_count: int) -> Array:
        """Return the mass that the ties put on their nodes, ``(n_node,)`` [kg]."""
        total = np.zeros(node_count)
        np.add.at(total, self.nodes, (0.5 * self.mass * self.length)[:, None])
        return total


@dataclass(frozen=True, eq=False)
class Clamps(_Part):
    """Joints of two nodes that keep their distance and turn freely against each other.

    An isotropic spring without damping. A bar of length zero would have no direction, and shared
    coordinates could not carry the tangents of two wires.

    Attributes
    ----------
    nodes : (n_clamp, 2)
        Host first.
    stiffness : (n_clamp,) N/m
        The same in every direction.
    offset : (n_clamp, 3) m
        From the host's node to the other when the clamp carries nothing.
    """

    nodes: Index
    stiffness: Array
    offset: Array

    def __len__(self) -> int:
        return len(self.stiffness)

    @classmethod
    def none(cls) -> Clamps:
        """Return no clamp at all."""
        return cls(np.empty((0, 2), dtype=np.int64), np.empty(0), np.empty((0, 3)))

    @cached_property
    def dofs(self) -> Index:
        """Degrees of freedom of each clamp, ``(6, n_clamp)``."""
        return (6 * self.nodes[:, :, None] + np.arange(3)).reshape(-1, 6).T

    def pull(self, q: Array) -> Array:
        """Return the force with which each clamp pulls its host, ``(n_clamp, 3)`` [N]."""
        r = q.reshape(-1, 6)[:, :3]
        apart = r[self.nodes[:, 1]] - r[self.nodes[:, 0]] - self.offset
        return self.stiffness[:, None] * apart


@dataclass(frozen=True, eq=False)
class Stays(_Part):
    """Straight bars from a node to a fixed point: steady arms, wind stays, stops.

    Attributes
    ----------
    node : (n_stay,)
    end : (n_stay, 3) m
        Fixed far ends.
    length, stiffness, mass : (n_stay,) m, N/m, kg
        A third of the mass moves with the node.
    law : (n_stay,)
    """

    node: Index
    end: Array
    length: Array
    stiffness: Array
    mass: Array
    law: Index

    def __len__(self) -> int:
        return len(self.length)

    @classmethod
    def none(cls) -> Stays:
        """Return no stay at all."""
        none, index = np.empty(0), np.empty(0, dtype=np.int64)
        return cls(index, np.empty((0, 3)), none, none, none, index)

    @cached_property
    def dofs(self) -> Index:
        """Degrees of freedom of each stay, ``(3, n_stay)``."""
        return (6 * self.node[:, None] + np.arange(3)).T

    def state(self, q: Array) -> BarState:
        """Return direction (far end to node) and length at coordinates ``q``."""
        return bar_state(q.reshape(-1, 6)[self.node, :3].T, self.end.T)

    def axial_force(self, length: Array) -> Array:
        """Return the axial force at some lengths, tension positive, ``(n_stay,)`` [N]."""
        force = self.stiffness * (length - self.length)
        return np.where(law_allows(self.law, force), force, 0.0)

    def tangent(self, q: Array) -> Array:
        """Return the tangent of each stay at coordinates ``q``, ``(3, 3, n_stay)`` [N/m]."""
        state = self.state(q)
        force = self.axial_force(state.length)
        acts = (self.law == BOTH_WAYS) | (force != 0.0)
        return bar_tangent(state, acts * self.stiffness, force)


@dataclass(frozen=True, eq=False)
class Grounds(_Part):
    """Linear spring-dampers from a node to the ground.

    Attributes
    ----------
    node : (n_ground,)
    stiffness, damping : (n_ground, 3, 3) N/m, N s/m
    free : (n_ground, 3) m
        Coordinates at which the spring carries nothing.
    """

    node: Index
    stiffness: Array
    damping: Array
    free: Array

    def __len__(self) -> int:
        return len(self.node)

    @classmethod
    def none(cls) -> Grounds:
        """Return no ground at all."""
        return cls(
            np.empty(0, dtype=np.int64), np.empty((0, 3, 3)), np.empty((0, 3, 3)), np.empty((0, 3))
        )

    @cached_property
    def dofs(self) -> Index:
        """Degrees of freedom of each ground, ``(3, n_ground)``."""
        return (6 * self.node[:, None] + np.arange(3)).T

    def pull(self, q: Array) -> Array:
        """Return the restoring force of each ground, ``(n_ground, 3)`` [N]."""
        apart = q.reshape(-1, 6)[self.node, :3] - self.free
        return np.einsum("nij,nj->ni", self.stiffness, apart)


@dataclass(frozen=True, eq=False)
class Path:
    """A wire that pantographs may run under.

    Attributes
    ----------
    name : str
        Name of the wire.
    nodes : (n,)
        From left to right.
    cables : (n - 1,)
        Elements between them.
    """

    name: str
    nodes: Index
    cables: Index


@dataclass(frozen=True)
class Rayleigh:
    """Coefficients of proportional damping, ``C = mass M + stiffness K0`` [1/s, s]."""

    mass: float = 0.0
    stiffness: float = 0.0
