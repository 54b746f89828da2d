"""The static state of a line: positions, forces and unstrained lengths."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.elements.hermite import local_coordinate, position_row
from tautwire.numerics.network.system import System
from tautwire.numerics.track import Frames, Track
from tautwire.specs.conditions.condition import Condition
from tautwire.text import Told

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class WireShape:
    """One wire in the static state.

    Attributes
    ----------
    name, role : str
    nodes : (n,)
        Numbers of its nodes in the arrays of the line, from left to right.
    s : (n,) m
        Their place along the track.
    position, slope : (n, 3) m, 1
        Coordinates in the frame of the track (along it from support 1, lateral, above the rails),
        and their derivatives along the unstrained wire.
    lengths : (n - 1,) m
        Unstrained lengths of its elements.
    """

    name: str
    role: str
    nodes: NDArray[np.int64]
    s: Array
    position: Array
    slope: Array
    lengths: Array

    def element(self, s: Array) -> NDArray[np.int64]:
        """Return which of its elements lie at some places, those beyond an end in the last [m]."""
        found = np.searchsorted(self.s, s, side="right") - 1
        return np.clip(found, 0, len(self.lengths) - 1)

    def dofs(self, element: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the degrees of freedom of r1, r1', r2, r2' of some elements, ``(n, 4, 3)``."""
        ends = np.stack([self.nodes[element], self.nodes[element + 1]], axis=-1)
        return (6 * ends[..., None] + np.arange(6)).reshape(*np.shape(element), 4, 3)


@dataclass(frozen=True, eq=False)
class WirePoints:
    """Points of wires where they pass through planes across the track.

    Attributes
    ----------
    s : (n_point,) m
        Places along the track.
    frames : Frames
        Of the track there.
    dofs : (n_point, 4, 3)
        Degrees of freedom of r1, r1', r2, r2' of the element that each point lies in.
    rows : (n_point, 4)
        Hermite row of each point: ``r = row @ (r1, r1', r2, r2')``.
    """

    s: Array
    frames: Frames
    dofs: NDArray[np.int64]
    rows: Array

    @classmethod
    def joined(cls, groups: Sequence[WirePoints]) -> WirePoints:
        """Return the points of some groups as one."""
        s, dofs, rows = (
            np.concatenate([getattr(g, name) for g in groups]) for name in ("s", "dofs", "rows")
        )
        origin, axes = (
            np.concatenate([getattr(g.frames, name) for g in groups]) for name in ("origin", "axes")
        )
        return cls(s, Frames(origin, axes), dofs, rows)

    @property
    def spacing(self) -> float:
        """Distance between neighbouring points that are evenly spaced [m]."""
        return float(self.s[1] - self.s[0])

    def values(self, vectors: Array, direction: int = 2) -> Array:
        """Return displacements, such as a mode shape, at the points in a direction of the track.

        Parameters
        ----------
        vectors : (..., n_dof)
        direction
            0 along the track, 1 lateral, 2 normal to the plane of the rails.

        Returns
        -------
        (..., n_point)
        """
        axes = self.frames.axes[:, direction]
        return np.einsum("...pki,pk,pi->...p", vectors[..., self.dofs], self.rows, axes)

    def heights(self, position: Array) -> Array:
        """Return the heights of the points above the rails, ``(n_point,)`` [m].

        Parameters
        ----------
        position : (n_dof,)
            Nodal coordinates.
        """
        rails = np.sum(self.frames.axes[:, 2] * self.frames.origin, axis=1)
        return self.values(position) - rails

    @property
    def press(self) -> Array:
        """What a unit force away from the rails puts on ``dofs``, ``(n_point, 4, 3)``."""
        return self.rows[..., None] * self.frames.axes[:, None, 2]


@dataclass(frozen=True, eq=False, repr=False)
class Equilibrium(Told):
    """Static state found by :func:`tautwire.find_shape`.

    Everything is ordered from left to right. Numbers that a person reads count from 1, numbers of
    nodes and wires from 0.

    Attributes
    ----------
    track : Track
        The alignment, in whose frames heights and lateral positions are told.
    position : (n_dof,) m
        Nodal coordinates, node by node ``x y z x' y' z'``: those of the track where it is straight
        and level; in space otherwise, the track starting along x.
    node_s : (n_node,) m
        Place of each node along the track.
    node_wire : (n_node,)
        Wire that each node belongs to; the nodes of a wire are numbered from left to right.
    wire_names, wire_roles : (n_wire,) tuples of str
    cable_lengths : (n_element,) m
        Unstrained length of every wire element, wire by wire.
    dropper_span, dropper_number : (n_dropper,)
        Span of each dropper and its number within the span.
    dropper_wires : (n_dropper, 2)
        Wires above and below.
    dropper_x : (n_dropper,) m
    dropper_lengths_unstrained, dropper_lengths : (n_dropper,) m
        Unstrained and stretched dropper lengths, clamp to clamp.
    dropper_forces : (n_dropper,) N
        Mean axial force, tension positive.
    dropper_heights : (n_dropper,) m
        Height of the lower wire at the droppers.
    support_number, support_wire : (n_support,)
        Number of the support, and the contact wire that it holds.
    support_x, support_heights : (n_support,) m
        Where contact wires are held, their ends included, and their height there.
    contact_preloads : (n_support,) N
        Upward force of the springs that stand in place of steady arms; 0 where there is none.
    arm_supports : (n_arm,)
        Rows of the supports that carry a steady arm, from 1.
    arm_forces : (n_arm,) N
        Axial force of the steady arms, tension positive.
    arm_angles : (n_arm,) rad
        Inclination of the arms, positive when the far end is above the wire.
    arm_ends : (n_arm, 3) m
        Far (hinged) ends of the arms: along the track, lateral, above the rails.
    suspension_free_heights : (n_suspension,) m
        Height at which the springs that carry messenger wires are slack.
    joint_pulls : (n_joint, 3) N
        Force in space of each joint of two wires on the one that holds the other.
    end_pulls : (2, n_wire) N
        Longitudinal force on the left and the right end of every wire.
    weight, reaction : float N
        Weight of the line, and sum of the vertical reactions of all supports and anchors.
    iterations, residual : int, N
        Newton iterations of the shape finding and the largest out-of-balance nodal force.
    operated : Operated or None
        What the condition made of the line; None for the design, and for what was read from a file.
    """

    track: Track
    position: Array
    node_s: Array
    node_wire: NDArray[np.int64]
    wire_names: tuple[str, ...]
    wire_roles: tuple[str, ...]
    cable_lengths: Array
    dropper_span: NDArray[np.int64]
    dropper_number: NDArray[np.int64]
    dropper_wires: NDArray[np.int64]
    dropper_x: Array
    dropper_lengths_unstrained: Array
    dropper_lengths: Array
    dropper_forces: Array
    dropper_heights: Array
    support_number: NDArray[np.int64]
    support_wire: NDArray[np.int64]
    support_x: Array
    support_heights: Array
    contact_preloads: Array
    arm_supports: NDArray[np.int64]
    arm_forces: Array
    arm_angles: Array
    arm_ends: Array
    suspension_free_heights: Array
    joint_pulls: Array
    end_pulls: Array
    weight: float
    reaction: float
    iterations: int
    residual: float
    operated: Operated | None = None

    def facts(self) -> dict[str, str]:
        """Return wires, droppers, arms and how the shape was found, in words."""
        told = {"wires": ", ".join(f"{w.name} ({w.role})" for w in self.wires)}
        told["length"] = f"{self.node_s.max() - self.node_s.min():.1f} m"
        if self.dropper_x.size:
            told["droppers"] = (
                f"{self.dropper_x.size}, {self.dropper_lengths.min():.3f} to "
                f"{self.dropper_lengths.max():.3f} m, {self.dropper_forces.min():.1f} to "
                f"{self.dropper_forces.max():.1f} N"
            )
        if self.arm_forces.size:
            degrees = np.degrees(self.arm_angles)
            told["steady arms"] = (
                f"{self.arm_forces.size}, {self.arm_forces.min():.0f} to "
                f"{self.arm_forces.max():.0f} N, {degrees.min():.1f} to {degrees.max():.1f} deg"
            )
        told["weight"] = f"{self.weight:.0f} N, reactions {self.reaction:.0f} N"
        told["found"] = f"in {self.iterations} iterations, residual {self.residual:.1e} N"
        return told

    @cached_property
    def wires(self) -> tuple[WireShape, ...]:
        """All wires, in the order of ``wire_names``."""
        r = self.in_track_frame(self.position)
        counts = np.bincount(self.node_wire[self.node_wire >= 0], minlength=len(self.wire_names))
        elements = np.split(self.cable_lengths, np.cumsum(counts - 1)[:-1])
        found = []
        for number, (name, role) in enumerate(zip(self.wire_names, self.wire_roles, strict=True)):
            own = np.flatnonzero(self.node_wire == number)
            place, slope = r[own, 0], r[own, 1]
            found.append(
                WireShape(name, role, own, self.node_s[own], place, slope, elements[number])
            )
        return tuple(found)

    def in_track_frame(self, position: Array) -> Array:
        """Return nodal coordinates and slopes in the frame of the track, ``(n_node, 2, 3)``."""
        r, frames = position.reshape(-1, 2, 3), self.track.frames(self.node_s)
        local = np.stack([frames.to_local(r[:, 0]), frames.components(r[:, 1])], axis=1)
        local[:, 0, 0] += self.node_s
        return local

    def wire(self, name: str) -> WireShape:
        """Return the wire of a name.

        Raises
        ------
        KeyError
            When the line has no such wire.
        """
        return self.wires[self.wire_names.index(name)] if name in self.wire_names else _no(name)

    def points(self, wire: WireShape, s: Array) -> WirePoints:
        """Return the points of a wire at some places, ``(n_point,)`` [m]."""
        element, frames = wire.element(s), self.track.frames(s)
        dofs, lengths = wire.dofs(element), wire.lengths[element]
        e = self.position[dofs]
        e[:, ::2] -= frames.origin[:, None]
        along = np.einsum("pki,pi->pk", e, frames.axes[:, 0])
        rows = position_row(local_coordinate(along, lengths, 0.0), lengths)
        return WirePoints(s, frames, dofs, rows)

    def of_role(self, role: str) -> tuple[WireShape, ...]:
        """Return the wires with a role."""
        return tuple(wire for wire in self.wires if wire.role == role)

    def running_height(self, s: Array) -> Array:
        """Return the height of the lowest contact wire at some places, shaped as ``s`` [m]."""
        heights = [
            np.interp(s, wire.position[:, 0], wire.position[:, 2], left=np.inf, right=np.inf)
            for wire in self.of_role("contact")
        ]
        return np.min(heights, axis=0)

    def running_stagger(self, s: Array) -> Array:
        """Return the lateral position of the lowest contact wire at some places, as ``s`` [m]."""
        wires = [wire.position for wire in self.of_role("contact")]
        heights = [np.interp(s, r[:, 0], r[:, 2], left=np.inf, right=np.inf) for r in wires]
        sides = np.array([np.interp(s, r[:, 0], r[:, 1]) for r in wires])
        lowest = np.argmin(heights, axis=0)
        return np.asarray(np.take_along_axis(sides, lowest[None], axis=0)[0])

    @cached_property
    def mast_x(self) -> Array:
        """Places of the supports by number, each once however many wires it holds [m].

        ``(n_span + 1,)``, the ends included.
        """
        return self.support_x[self._first_of_support]

    def by_mast(self, values: NDArray[Any]) -> NDArray[Any]:
        """Return the largest value of the wires that each support holds.

        Parameters
        ----------
        values : (..., n_support)
            In the order of ``support_x``.

        Returns
        -------
        (..., n_span + 1)
            In the order of ``mast_x``.
        """
        return np.maximum.reduceat(values, self._first_of_support, axis=-1)

    def support_line(self, wire: int, s: Array) -> Array:
        """Return the height of the straight line between the supports of a wire [m].

        Parameters
        ----------
        wire
            Number of a contact wire.
        s : (n,) m
            Places along the track.
        """
        own = self.support_wire == wire
        return np.interp(s, self.support_x[own], self.support_heights[own])

    @cached_property
    def _first_of_support(self) -> NDArray[np.intp]:
        return np.unique(self.support_number, return_index=True)[1]

    @property
    def contact(self) -> WireShape:
        """The first contact wire."""
        return self.of_role("contact")[0]

    @property
    def contact_position(self) -> Array:
        """Coordinates of the first contact wire in the frame of the track, ``(n, 3)`` [m]."""
        return self.contact.position

    @property
    def messenger_position(self) -> Array:
        """The same of the first messenger wire, ``(n, 3)``; empty without one [m]."""
        found = self.of_role("messenger")
        return found[0].position if found else np.empty((0, 3))


def _no(name: str) -> WireShape:
    raise KeyError(f"the line has no wire named {name!r}")


@dataclass(frozen=True, eq=False)
class Operated:
    """A line under a condition: what it was and what it is.

    Attributes
    ----------
    condition : Condition
    design : Equilibrium
        Whose unstrained lengths, before temperature and defects, the line keeps.
    system : System
        The line at rest under the condition; its loads stay on.
    end_travel : (2, n_wire) m
        How far the left and the right end of every wire have moved away from the wire's middle;
        NaN where a wire is clamped to another.
    end_words : (2, n_wire) tuples of str
        What each end is doing: held, free, at a stop.
    """

    condition: Condition
    design: Equilibrium
    system: System
    end_travel: Array
    end_words: tuple[tuple[str, ...], tuple[str, ...]]


@dataclass(frozen=True, eq=False, repr=False)
class Elasticity(Told):
    """Static uplift per vertical force on the contact wire.

    Attributes
    ----------
    force : float N
        Force at which the elasticity was evaluated (the line is nonlinear).
    span : (n_point,)
        1-based span of the point; a support belongs to the span it begins.
    kind : tuple of str
        ``"support"``, ``"dropper"`` or ``"middle"``.
    index : (n_point,)
        0 for a support, the dropper's number, or for a middle the number of the dropper on
        its left (0: between the support and dropper 1).
    x : (n_point,) m
    elasticity : (n_point,) m/N
    """

    force: float
    span: NDArray[np.int64]
    kind: tuple[str, ...]
    index: NDArray[np.int64]
    x: Array
    elasticity: Array

    @property
    def nonuniformity(self) -> float:
        """Non-uniformity u = (e_max - e_min)/(e_max + e_min), a fraction.

        Definition of EN 50119 as remembered (edition and clause not verified).
        """
        high, low = float(self.elasticity.max()), float(self.elasticity.min())
        return (high - low) / (high + low)

    def facts(self) -> dict[str, str]:
        """Return force, range and non-uniformity in words."""
        least, most = 1e3 * self.elasticity.min(), 1e3 * self.elasticity.max()
        return {
            "elasticity": f"{least:.3f} to {most:.3f} mm/N under {self.force:g} N",
            "spans": f"{self.span.min()} to {self.span.max()}",
            "non-uniformity": f"{100 * self.nonuniformity:.1f} %",
        }

    def __str__(self) -> str:
        rows = [f"elasticity under {self.force:g} N [mm/N]"]
        for span, kind, index, x, e in zip(
            self.span, self.kind, self.index, self.x, self.elasticity, strict=True
        ):
            label = kind if kind == "support" else f"{kind} {index}"
            rows.append(f"span {span:3d}  {label:<12} x = {x:8.3f} m  {1e3 * e:.4f}")
        rows.append(f"non-uniformity {100 * self.nonuniformity:.1f} %")
        return "\n".join(rows)
