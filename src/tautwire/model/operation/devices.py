"""Tensioning devices: what keeps the tension of a wire, and where its end comes to stand.

The travel of an end counts away from the middle of its wire: positive when the wire grows, when
weights sink. Weights with the efficiency eta hold a wire still while it pulls between ``T eta``
and ``T / eta``; they rise under the larger force and sink under the smaller one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.model.build import Model
from tautwire.numerics.network.parts import Grounds
from tautwire.specs.conditions.condition import Condition
from tautwire.specs.line.catenary import TensionSpring, Weights

Array = NDArray[Any]

_SAME_TENSION = 1e-6
"""Share of a tension that counts as no difference when friction decides whether an end moves."""

_SAME_PLACE = 1e-6
"""Travel that counts as none [m]."""


@dataclass(frozen=True, eq=False)
class Tensioning:
    """Springs that tension wires, and masses of weights that move with them.

    Attributes
    ----------
    springs : Grounds
        Slack where the tension is that of the design.
    mass : (n_node,) kg
        Along the track; nothing else moves at the end of a wire.
    """

    springs: Grounds
    mass: Array


def tensioning_devices(model: Model, position: Array) -> Tensioning:
    """Return the devices of a line whose wires have their tension at some coordinates."""
    mass = np.zeros(model.mesh.node_count)
    node, stiffness = [], []
    for end in ends_of_wires(model):
        if isinstance(end.device, TensionSpring):
            node.append(end.node)
            t = end.outward
            stiffness.append(end.device.stiffness * t[:, None] * t[None, :])
        elif end.device is not None and end.device.inertia:
            mass[end.node] += end.device.ratio * end.tension / model.case.line.gravity
    matrices = np.array(stiffness).reshape(-1, 3, 3)
    nodes = np.array(node, dtype=np.int64)
    free = position.reshape(-1, 6)[nodes, :3]
    return Tensioning(Grounds(nodes, matrices, np.zeros_like(matrices), free), mass)


@dataclass(frozen=True, eq=False)
class WireEnd:
    """One end of a wire that is not clamped to another.

    Attributes
    ----------
    strand : int
        Number of the wire.
    side : int
        0 left, 1 right.
    node : int
    outward : (3,)
        Unit vector along the track, away from the wire.
    tension : float N
        That the device keeps, without friction.
    is_anchored : bool
    is_let_go : bool
        Whether an anchored end is moved until the wire has its tension, and anchored again.
    device : Weights, TensionSpring or None
    """

    strand: int
    side: int
    node: int
    outward: Array
    tension: float
    is_anchored: bool
    is_let_go: bool
    device: Weights | TensionSpring | None

    @property
    def limits(self) -> tuple[float, float]:
        """Smallest and largest travel [m]."""
        if isinstance(self.device, TensionSpring):
            reach = np.inf if self.device.travel is None else self.device.travel
            return -reach, reach
        if self.device is None:
            return -np.inf, np.inf
        rise, sink = (np.inf if x is None else x for x in (self.device.rise, self.device.sink))
        return -rise / self.device.ratio, sink / self.device.ratio

    @property
    def pulls(self) -> tuple[float, float]:
        """Pull at which the end moves outwards, and inwards [N]."""
        efficiency = self.device.efficiency if isinstance(self.device, Weights) else 1.0
        return self.tension * efficiency, self.tension / efficiency


def ends_of_wires(model: Model, condition: Condition | None = None) -> list[WireEnd]:
    """Return the ends of all wires that are not clamped to others, strand by strand.

    Parameters
    ----------
    model
        The line.
    condition
        May give wires other tensions; with both ends anchored, the right one is let go for it.
    """
    found = []
    for number, strand in enumerate(model.mesh.strands):
        run = strand.run
        if run.start.kind == "clamped":
            continue
        given = None if condition is None else condition.of_wire(run.wire_name).tension
        let_go = given is not None and run.start.kind == run.end.kind == "anchored"
        for side, end in enumerate((run.start, run.end)):
            node = int(strand.nodes[-1 if side else 0])
            device = end.device.weights or end.device.spring if end.device else None
            found.append(
                WireEnd(
                    strand=number,
                    side=side,
                    node=node,
                    outward=(1.0 if side else -1.0) * model.mesh.frames.axes[node, 0],
                    tension=strand.leads[side] * (run.wire.tension if given is None else given),
                    is_anchored=end.kind == "anchored",
                    is_let_go=let_go and side == 1,
                    device=device,
                )
            )
    return found


@dataclass(frozen=True)
class EndState:
    """What an end of a wire is doing.

    Attributes
    ----------
    travel : float m
        Where it is held; None while it moves freely.
    pull : float N
        Of the device while it moves freely.
    word : str
        For people.
    is_final : bool
        Whether nothing can change it any more.
    """

    travel: float | None
    pull: float = 0.0
    word: str = "anchored"
    is_final: bool = False


def first_state(end: WireEnd, previous: float, *, is_seized: bool) -> EndState:
    """Return what an end does before anything is known about its wire.

    Parameters
    ----------
    end
    previous
        Its travel in the state that the line comes from [m].
    is_seized
        Whether its device does not move.
    """
    if is_seized:
        return EndState(previous, word="seized", is_final=True)
    if end.is_anchored and not end.is_let_go:
        return EndState(0.0, is_final=True)
    return EndState(None, end.tension, word="free")


def next_state(
    end: WireEnd, state: EndState, previous: float, travel: float, pull: float
) -> EndState:
    """Return what an end does, knowing where it came and how the wire pulls it.

    Parameters
    ----------
    end, state
    previous
        Its travel in the state that the line comes from [m].
    travel : float m
        Found with ``state``.
    pull : float N
        Of the wire on the end, found with ``state``.
    """
    if state.is_final:
        return state
    low, high = end.limits
    outwards, inwards = end.pulls
    margin = _SAME_TENSION * end.tension
    if state.travel is None:
        if not low <= travel <= high:
            stop = "at the inner stop" if travel < low else "at the outer stop"
            return EndState(min(max(travel, low), high), word=stop)
        way = travel - previous
        if outwards < state.pull < inwards:  # known now: where it goes without friction
            is_growing = way > 0.0
            return EndState(
                None,
                outwards if is_growing else inwards,
                word="has moved out" if is_growing else "has moved in",
            )
        against = way < -_SAME_PLACE if state.pull == outwards else way > _SAME_PLACE
        if outwards < inwards and against:
            return EndState(previous, word="held by friction")
        if end.is_let_go:
            return EndState(travel, word="anchored", is_final=True)
        return state
    spring = end.device.stiffness * state.travel if isinstance(end.device, TensionSpring) else 0.0
    if pull > inwards - spring + margin and state.travel > low + _SAME_PLACE:
        return EndState(None, inwards, word="free" if inwards == outwards else "has moved in")
    if pull < outwards - spring - margin and state.travel < high - _SAME_PLACE:
        return EndState(None, outwards, word="free" if inwards == outwards else "has moved out")
    return state
