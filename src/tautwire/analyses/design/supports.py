"""What the supports of a line carry in one of its states, and where wires stand beside them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tautwire.line.defects import placed
from tautwire.line.pieces import At, Registration, Suspension
from tautwire.model.build import Model
from tautwire.model.equations import equations
from tautwire.model.operation.cantilevers import cantilevers_of
from tautwire.model.registrations import registrations_at_rest
from tautwire.numerics.network.parts import Grounds, Stays
from tautwire.numerics.network.system import internal_force
from tautwire.plain import Plain, named
from tautwire.results.design.conditions import ConditionState
from tautwire.results.equilibrium import Equilibrium

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SupportForce(Plain):
    """The force of the line on what holds one of its wires at a support.

    Attributes
    ----------
    support : int
        From 1.
    x : float m
        Along the track from support 1.
    wire : str
    held_by : str
        ``"registration"``, ``"cantilever"``, or ``"end"`` for the anchor or tensioning device.
    lateral_position, height : float m
        Of the wire there, in the frame of the track.
    along, lateral, vertical : float N
        Along the rails, level to the left of rising chainage (radial in a curve), upwards; on a
        gradient the first rises with them.
    """

    support: int
    x: float = field(metadata=named("x_m"))
    wire: str
    held_by: str
    lateral_position: float = field(metadata=named("lateral_position_m"))
    height: float = field(metadata=named("height_m"))
    along: float = field(metadata=named("along_n"))
    lateral: float = field(metadata=named("lateral_n"))
    vertical: float = field(metadata=named("vertical_n"))


@dataclass(frozen=True)
class SupportTotal(Plain):
    """The forces of all wires on one support.

    Attributes
    ----------
    support : int
    x : float m
    along, lateral, vertical : float N
    """

    support: int
    x: float = field(metadata=named("x_m"))
    along: float = field(metadata=named("along_n"))
    lateral: float = field(metadata=named("lateral_n"))
    vertical: float = field(metadata=named("vertical_n"))


def support_forces(model: Model, shape: Equilibrium) -> tuple[SupportForce, ...]:
    """Return the forces of a line on its supports, from left to right.

    The force on a support is what loads and wires leave unbalanced at the node that it holds,
    ``load - Q``, with Q of the wires and droppers alone and without the constant forces that
    stand for supports (preloads, arms that act as springs). Weight of wires, droppers, clamps and
    steady arms, ice, and wind on wires and droppers are in it; weight of cantilevers and wind on
    them and on steady arms are not.

    Parameters
    ----------
    model
        With the condition chosen.
    shape
        In this condition.
    """
    held = list(_held(model))
    nodes = model.mesh.nodes(at for _, at, _, _ in held)
    force, place = _at_nodes(model, shape, nodes), _places(model, shape, nodes)
    found = [
        SupportForce(number, at.s, at.run, word, *position, *own)
        for (number, at, word, _), position, own in zip(
            held, place[:, 1:].tolist(), force.tolist(), strict=True
        )
    ]
    for row, (_, _, _, hanging) in enumerate(held):
        one = found[row]
        values = {"along": one.along, "lateral": one.lateral, "vertical": one.vertical - hanging}
        found[row] = _with(one, **values)
    rise = model.mesh.frames.axes[nodes, 0, 2]
    for row, pull in _pulls(model, shape, [at for _, at, _, _ in held]):
        found[row] = _with(found[row], along=pull - float(rise[row]) * found[row].vertical)
    return tuple(found)


def _with(one: SupportForce, **changes: float) -> SupportForce:
    return SupportForce(**{**one.__dict__, **changes})


def _held(model: Model) -> Iterator[tuple[int, At, str, float]]:
    """Yield number of the support, place, what holds the wire, and weight on its far side [N]."""
    line, gravity = model.line, model.case.line.gravity
    pieces: list[Registration | Suspension] = [*line.registrations, *line.suspensions]
    rows: list[tuple[int, At, str, float]] = []
    for piece in pieces:
        is_arm = isinstance(piece, Registration)
        hanging = 0.5 * piece.kind.carried_weight(gravity) if is_arm else 0.0
        word = "registration" if is_arm else "cantilever"
        rows.append((piece.label.number, piece.at, word, hanging))
    masts = np.array(line.masts)
    for run in line.runs:
        for end in (run.start, run.end):
            if end.kind != "clamped":
                number = int(np.abs(masts - end.s).argmin()) + 1
                rows.append((number, At(run.name, end.s), "end", 0.0))
    yield from sorted(rows, key=lambda row: (row[0], row[1].run))


def _at_nodes(model: Model, shape: Equilibrium, nodes: NDArray[np.int64]) -> Array:
    """Return the forces on what holds nodes: along, level to the left, upwards, ``(n, 3)`` [N].

    A force N normal to rails of rise g is ``N/sqrt(1 - g^2)`` upwards and -g times that along.
    """
    system = equations(model, shape)
    hangers = np.arange(len(system.ties)) < len(model.line.hangers)
    bare = system.with_(
        stays=Stays.none(), grounds=Grounds.none(), ties=system.ties.chosen(hangers)
    )
    left = (system.load - internal_force(bare, system.position).nodal).reshape(-1, 6)[:, :3]
    force = (left - _constant_forces(model, shape))[nodes]
    t = model.mesh.frames.axes[nodes, 0]
    level = np.hypot(t[:, 0], t[:, 1])
    along = np.sum(force * t * [1.0, 1.0, 0.0], axis=1) / level**2
    left = (force[:, 1] * t[:, 0] - force[:, 0] * t[:, 1]) / level
    return np.stack([along, left, force[:, 2] - along * t[:, 2]], axis=1)


def _constant_forces(model: Model, shape: Equilibrium) -> Array:
    """Return the constant forces of supports on the wires, ``(n_node, 3)`` [N].

    Those of registrations, and those along the track of cantilevers that have turned.
    The share of the arm's weight that rests on a wire is none of them.
    """
    operated, gravity = shape.operated, model.case.line.gravity
    design = shape if operated is None else operated.design
    broken = () if operated is None else placed(model.line, operated.condition).arms
    total = np.zeros((model.mesh.node_count, 3))
    for group, rest in registrations_at_rest(model.line, model.mesh, design, gravity, broken):
        total[group.nodes] += rest.load
        total[group.nodes, 2] += 0.5 * group.kind.carried_weight(gravity)
    if operated is not None:
        turning = cantilevers_of(model)
        turned = turning.turned(model, operated.system, design.position)
        along = model.mesh.frames.axes[turning.nodes, 0]
        np.add.at(total, turning.nodes, turned.along[:, None] * along)
    return total


def _places(model: Model, shape: Equilibrium, nodes: NDArray[np.int64]) -> Array:
    """Return where nodes are in the frames of the track, ``(n, 3)`` [m]."""
    return model.mesh.frames[nodes].to_local(shape.position.reshape(-1, 6)[nodes, :3])


def _pulls(model: Model, shape: Equilibrium, places: Sequence[At]) -> Iterator[tuple[int, float]]:
    """Yield the rows at ends of wires and the force along the track on what tensions them [N]."""
    for number, strand in enumerate(model.mesh.strands):
        for side, end in enumerate((strand.run.start, strand.run.end)):
            if end.kind != "clamped":
                row = places.index(At(strand.run.name, end.s))
                yield row, -float(shape.end_pulls[side, number])


def totals(forces: Sequence[SupportForce]) -> tuple[SupportTotal, ...]:
    """Return the forces of all wires on every support together.

    Parameters
    ----------
    forces
        Of :func:`support_forces`.
    """
    found: dict[int, SupportTotal] = {}
    for one in forces:
        before = found.get(one.support, SupportTotal(one.support, one.x, 0.0, 0.0, 0.0))
        found[one.support] = SupportTotal(
            one.support,
            one.x,
            before.along + one.along,
            before.lateral + one.lateral,
            before.vertical + one.vertical,
        )
    return tuple(found.values())


@dataclass(frozen=True)
class Installed(Plain):
    """How far a wire at a support, or a weight, stands from its place in the design.

    Attributes
    ----------
    what : str
        ``"cantilever"``: along the track, positive towards rising chainage; ``"weight"``: height,
        positive upwards.
    support : int
    x : float m
    wire : str
    offsets : tuple of float m
        One per condition; NaN where weights are not free to tell.
    """

    what: str
    support: int
    x: float = field(metadata=named("x_m"))
    wire: str
    offsets: tuple[float, ...] = field(metadata=named("offsets_m"))


def temperatures(states: Sequence[ConditionState]) -> tuple[ConditionState, ...]:
    """Return the states that have one temperature for all wires, the coldest first."""
    found: list[tuple[float, ConditionState]] = []
    for one in states:
        operated = None if one.shape is None else one.shape.operated
        if operated is not None and operated.condition.temperature is not None:
            found.append((operated.condition.temperature, one))
    return tuple(one for _, one in sorted(found, key=lambda pair: pair[0]))


def installation(model: Model, states: Sequence[ConditionState]) -> tuple[Installed, ...]:
    """Return where cantilevers and weights stand in some states, support by support.

    Hinged cantilevers turn by the offset of their wire over the distance of the wire from the
    hinge.

    Parameters
    ----------
    model
        The line.
    states
        Of :func:`temperatures`.
    """
    rows = [row for row in _held(model) if row[2] != "end"]
    nodes = model.mesh.nodes(at for _, at, _, _ in rows)
    offsets = np.array([_offsets(model, one, nodes) for one in states]).reshape(len(states), -1)
    found = [
        Installed("cantilever", number, at.s, at.run, tuple(own))
        for (number, at, _, _), own in zip(rows, offsets.T.tolist(), strict=True)
    ]
    return tuple(sorted([*found, *_weights(model, states)], key=lambda one: one.support))


def _offsets(model: Model, state: ConditionState, nodes: NDArray[np.int64]) -> Array:
    assert state.shape is not None
    assert state.shape.operated is not None
    design = state.shape.operated.design
    moved = (state.shape.position - design.position).reshape(-1, 6)[nodes, :3]
    return np.sum(moved * model.mesh.frames.axes[nodes, 0], axis=1)


def _weights(model: Model, states: Sequence[ConditionState]) -> Iterator[Installed]:
    """Yield the heights of weights, at the supports where their wires end."""
    masts = model.line.masts
    for run in model.line.runs:
        for side, end in (("left", run.start), ("right", run.end)):
            if end.device is None or end.device.weights is None:
                continue
            sunk = [
                own.sinking
                for one in states
                for own in one.ends
                if (own.wire, own.side) == (run.name, side)
            ]
            number = masts.index(end.s) + 1
            yield Installed("weight", number, end.s, run.name, tuple(-value for value in sunk))
