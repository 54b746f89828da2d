"""Registrations and suspensions as arrays: while the shape is sought, found, and at rest."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tautwire.errors import ModelError
from tautwire.line.closures import AtRest, Closure, Held, along_axes
from tautwire.line.pieces import Line
from tautwire.model.mesh import Mesh
from tautwire.numerics.network.parts import BOTH_WAYS, COMPRESSION_ONLY, Grounds, Stays
from tautwire.numerics.track import Frames
from tautwire.results.equilibrium import Equilibrium

Array = NDArray[np.float64]
Index = NDArray[np.int64]
EVEN = 0.01
"""Change of the force of a stay while the shape is sought, over that of its length: a guess that is
5 cm off changes the force of a stay of 3 m by 0.02 %."""
SHORTEST_STAY = 0.2
"""Least length of a stay [m]: a shorter one turns by more than the wire moves."""
STOP_LENGTH = 10.0
"""Length of the bar that stands for an uplift stop [m]: a wire 0.1 m aside of it meets it 0.5 mm
later, and is pushed sideways by 1 % of the force."""


@dataclass(frozen=True, eq=False)
class Group:
    """All registrations of one kind.

    Attributes
    ----------
    kind : Closure
    rows : (n,)
        Which of the line's registrations.
    nodes : (n,)
    frames : Frames
        Of the track there.
    end : (n, 3) m
        Given far ends of their arms in these frames; NaN where none is given.
    """

    kind: Closure
    rows: Index
    nodes: Index
    frames: Frames
    end: Array

    def gravity(self, gravity: float) -> Array:
        """Return the acceleration of gravity in the frames, ``(n, 3)`` [m/s2]."""
        return self.frames.components(np.array([0.0, 0.0, -gravity]))

    def local(self, vectors: Array) -> Array:
        """Return the coordinates of the nodes among all ``(n_node, 3)``, in the frames [m]."""
        return self.frames.to_local(vectors[self.nodes])


def groups(line: Line, mesh: Mesh, without: Collection[int] = ()) -> Iterator[Group]:
    """Yield the registrations of a line kind by kind, some rows left out."""
    kinds: dict[Closure, list[int]] = {}
    for row, piece in enumerate(line.registrations):
        if row in without:
            continue
        kinds.setdefault(piece.kind, []).append(row)
    for kind, rows in kinds.items():
        pieces = [line.registrations[row] for row in rows]
        ends = [(0.0, *(p.end or (np.nan, np.nan))) for p in pieces]
        nodes = mesh.nodes(piece.at for piece in pieces)
        numbers = np.array(rows, dtype=np.int64)
        yield Group(kind, numbers, nodes, mesh.frames[nodes], np.array(ends, dtype=float))


def design_stays(line: Line, mesh: Mesh) -> Stays:
    """Return the arms that take part while the shape is sought."""
    return Stays.none().joined(
        *(
            _placed_stays(group.kind.design_stays(group.nodes, group.end), group.frames)
            for group in groups(line, mesh)
        )
    )


def _placed_stays(stays: Stays, frames: Frames) -> Stays:
    """Return stays whose far ends were given in frames of the track, where they are."""
    return stays.with_(end=frames.to_world(stays.end)) if len(stays) else stays


def placed_grounds(grounds: Grounds, frames: Frames) -> Grounds:
    """Return springs that were given in frames of the track, where they are."""
    if not len(grounds):
        return grounds
    return grounds.with_(
        stiffness=frames.matrices(grounds.stiffness),
        damping=frames.matrices(grounds.damping),
        free=frames.to_world(grounds.free),
    )


def held_registrations(
    line: Line, mesh: Mesh, position: Array, reactions: Array, gravity: float
) -> Held:
    """Return how the contact wires are held in a found shape, one row per registration.

    Parameters
    ----------
    line, mesh
    position : (n_dof,)
    reactions : (n_dof,)
        Forces that hold the nodes, along the axes of the track.
    gravity
        [m/s2]
    """
    count = len(line.registrations)
    whole = Held(*(np.full(shape, np.nan) for shape in (count, count, (count, 3), count)))
    r, forces = (values.reshape(-1, 6)[:, :3] for values in (position, reactions))
    for group in groups(line, mesh):
        weight, force = group.gravity(gravity), forces[group.nodes]
        held = group.kind.hold(group.local(r), force, group.end, weight)
        for name in ("force", "angle", "end", "preload"):
            getattr(whole, name)[group.rows] = getattr(held, name)
    return whole


def registrations_at_rest(
    line: Line, mesh: Mesh, shape: Equilibrium, gravity: float, broken: Collection[int]
) -> Iterator[tuple[Group, AtRest]]:
    """Yield what holds the contact wires once the shape is found, kind by kind, in place.

    Broken rows are left out.
    """
    r = shape.position.reshape(-1, 6)[:, :3]
    held = _held_in(line, shape)
    for group in groups(line, mesh, broken):
        own = Held(*(getattr(held, n)[group.rows] for n in ("force", "angle", "end", "preload")))
        rest = group.kind.at_rest(group.nodes, group.local(r), own, group.gravity(gravity))
        yield (
            group,
            replace(
                rest,
                stays=_placed_stays(rest.stays, group.frames),
                grounds=placed_grounds(rest.grounds, group.frames),
                load=group.frames.turned(rest.load),
            ),
        )


def _held_in(line: Line, shape: Equilibrium) -> Held:
    """Read how the wires are held from an equilibrium, one row per registration."""
    rows = np.array(line.registration_rows, dtype=np.int64)
    count = len(shape.support_x)
    force, angle, end = (np.full(size, np.nan) for size in (count, count, (count, 3)))
    arms = shape.arm_supports - 1
    force[arms], angle[arms], end[arms] = shape.arm_forces, shape.arm_angles, shape.arm_ends
    end[:, 0] -= shape.support_x
    return Held(force[rows], angle[rows], end[rows], shape.contact_preloads[rows])


def uplift_stops(line: Line, mesh: Mesh, shape: Equilibrium, broken: Collection[int] = ()) -> Stays:
    """Return what the wires meet when they rise from their design; broken arms have none.

    A stop is a bar that only pushes, from a point high above the wire: the longer it is, the less
    it pushes sideways.
    """
    rows = [r for r, piece in enumerate(line.registrations) if piece.stop and r not in broken]
    stops = [stop for row in rows if (stop := line.registrations[row].stop) is not None]
    nodes = mesh.nodes(line.registrations[row].at for row in rows)
    rest = shape.position.reshape(-1, 6)[nodes, :3]
    return Stays(
        node=nodes,
        end=rest + STOP_LENGTH * mesh.frames[nodes].axes[:, 2],
        length=np.array([STOP_LENGTH - stop.gap for stop in stops]),
        stiffness=np.array([stop.stiffness for stop in stops]),
        mass=np.zeros(len(stops)),
        law=np.full(len(stops), COMPRESSION_ONLY),
    )


def pulling_stays(line: Line, mesh: Mesh, guess: Array) -> Stays:
    """Return the stays of wires while the shape is sought: they pull evenly, as they should.

    A bar so soft that its force hardly changes with its length. Its unstrained length counts
    backwards from the far end.

    Parameters
    ----------
    line, mesh
    guess : (n_dof,) m
        Coordinates of the nodes, near those that are sought.
    """
    stays = _stays_at(line, mesh)
    pulls = np.array([piece.pull for piece in line.stays])
    length = np.maximum(stays.state(guess).length, SHORTEST_STAY)
    return stays.with_(
        length=length * (1.0 - 1.0 / EVEN),
        stiffness=EVEN * pulls / length,
        law=np.full(len(pulls), BOTH_WAYS),
    )


def _stays_at(line: Line, mesh: Mesh) -> Stays:
    """Return the stays of wires in their places, lengths unknown."""
    pieces = line.stays
    nodes = mesh.nodes(piece.at for piece in pieces)
    end = np.array([piece.end for piece in pieces]).reshape(-1, 3)
    return Stays(
        node=nodes,
        end=mesh.frames[nodes].to_world(end),
        length=np.ones(len(pieces)),
        stiffness=np.array([piece.stiffness for piece in pieces]),
        mass=np.zeros(len(pieces)),
        law=np.array([piece.law for piece in pieces], dtype=np.int64),
    )


def wire_stays(line: Line, mesh: Mesh, shape: Equilibrium, sought: Stays) -> Stays:
    """Return the stays of wires at rest, with the force that they have in a design.

    Parameters
    ----------
    line, mesh
    shape
        The design.
    sought
        Stays while it was sought; those of :func:`pulling_stays` are the last of them.

    Raises
    ------
    ModelError
        When the far end of one is at its wire.
    """
    pieces, stays = line.stays, _stays_at(line, mesh)
    apart = stays.state(shape.position).length  # as it is counted later: no force by rounding
    if faults := [
        f"the stay {piece.name!r} at x = {piece.at.s:.2f} m: its far end is {d:.2f} m from the "
        f"wire; give it {SHORTEST_STAY:g} m more than its slack (stays, end_y, end_z, end_along)"
        for piece, d in zip(pieces, apart, strict=True)
        if d < piece.slack + SHORTEST_STAY
    ]:
        raise ModelError("\n".join(faults))
    pulls = sought.axial_force(sought.state(shape.position).length)[len(sought) - len(pieces) :]
    length = [
        piece.length(*own)
        for piece, *own in zip(pieces, apart.tolist(), pulls.tolist(), strict=True)
    ]
    return stays.with_(length=np.array(length))


def suspension_grounds(line: Line, mesh: Mesh, free_height: Array) -> Grounds:
    """Return the springs of the suspensions, slack at given heights ``(n_suspension,)`` [m]."""
    pieces = line.suspensions
    zeros = np.zeros(len(pieces))
    nodes = mesh.nodes(piece.at for piece in pieces)
    grounds = Grounds(
        nodes,
        along_axes(zeros, np.array([piece.stiffness for piece in pieces])),
        along_axes(zeros, np.array([piece.damping for piece in pieces])),
        np.column_stack([zeros, zeros, free_height]),
    )
    return placed_grounds(grounds, mesh.frames[nodes])
