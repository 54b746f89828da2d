"""Lines of many kinds, made of straight wires under tension, for the tests of the time integration.

They hang without weight: every tie begins with the tension that it is given, and the rest moves.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.motion.backend import make_stepper
from tautwire.numerics.motion.stepper import PantographInput, StepOptions
from tautwire.numerics.network.parts import (
    BOTH_WAYS,
    COMPRESSION_ONLY,
    TENSION_ONLY,
    Cables,
    Clamps,
    Grounds,
    Path,
    Rayleigh,
    Stays,
    Ties,
)
from tautwire.numerics.network.system import System
from tautwire.numerics.newmark import Newmark
from tautwire.status import Status

from .lines import one_stage, stretch_under

Array = NDArray[Any]


@dataclass(frozen=True)
class Wire:
    """A straight wire: where its nodes are [m], its height [m], tension [N] and mass [kg/m]."""

    x: Array
    height: float
    tension: float
    mass: float
    y: float = 0.0


def even(start: float, end: float, spacing: float) -> Array:
    """Return nodes at about a spacing [m], both ends included."""
    return np.linspace(start, end, round((end - start) / spacing) + 1)


class Network:
    """Wires, numbered along the track, to which ties, clamps and stays are added.

    Parameters
    ----------
    *wires
        The first one is the path of the pantograph.
    """

    def __init__(self, *wires: Wire) -> None:
        self.wires = wires
        x = np.concatenate([w.x for w in wires])
        self._place = np.empty(len(x), dtype=np.int64)
        self._place[np.argsort(x, kind="stable")] = np.arange(len(x))
        self._first = np.cumsum([0, *(len(w.x) for w in wires)])
        self.ties: list[tuple[int, int, float, int]] = []
        self.clamps: list[tuple[int, int]] = []
        self.stays: list[tuple[int, Array, float, float, int]] = []
        self.grounds: list[tuple[int, Array, Array]] = []

    def node(self, wire: int, x: float) -> int:
        """Return the node of a wire nearest to a place."""
        nearest = int(np.abs(self.wires[wire].x - x).argmin())
        return int(self._place[self._first[wire] + nearest])

    def nodes(self, wire: int) -> Array:
        """Return the nodes of a wire from left to right."""
        return self._place[self._first[wire] : self._first[wire + 1]]

    def tie(self, upper: int, lower: int, places: Array, stiffness: float, law: int) -> None:
        """Tie two wires at some places."""
        for x in places:
            self.ties.append((self.node(upper, x), self.node(lower, x), stiffness, law))

    def position(self) -> Array:
        """Return the nodal coordinates, ``(n_node, 6)``."""
        out = np.zeros((len(self._place), 6))
        for k, wire in enumerate(self.wires):
            at = self.nodes(k)
            out[at, 0], out[at, 1], out[at, 2] = wire.x, wire.y, wire.height
            out[at, 3] = stretch_under(wire.tension, 15e6)
        return out

    def _cables(self) -> Cables:
        nodes, length, mass = [], [], []
        for k, wire in enumerate(self.wires):
            at = self.nodes(k)
            nodes.append(np.stack([at[:-1], at[1:]], axis=1))
            length.append(np.diff(wire.x) / stretch_under(wire.tension, 15e6))
            mass.append(np.full(len(wire.x) - 1, wire.mass))
        lengths = np.concatenate(length)
        count = len(lengths)
        return Cables(
            np.concatenate(nodes),
            lengths,
            np.full(count, 15e6),
            np.full(count, 150.0),
            np.concatenate(mass),
        )

    def system(self, pull: float = 60.0) -> System:
        """Return the line; every tie that can pull does so with ``pull`` [N] at the start."""
        position = self.position()
        r = position[:, :3]
        ends = [self.nodes(k)[[0, -1]] for k in range(len(self.wires))]
        clamped = {n for pair in self.clamps for n in pair}
        fixed = np.zeros(position.shape, dtype=bool)
        for pair in ends:
            fixed[[n for n in pair if n not in clamped], :3] = True
        count = len(self.wires[0].x)
        return System(
            cables=self._cables(),
            node_mass=np.where(np.arange(len(r)) % 5 == 0, 0.2, 0.0),
            load=np.zeros(position.size),
            fixed=fixed.ravel(),
            position=position.ravel(),
            ties=self._ties(r, pull),
            clamps=self._clamps(r),
            stays=self._stays(),
            grounds=self._grounds(r),
            paths=(Path("contact", self.nodes(0), np.arange(count - 1)),),
            damping=Rayleigh(0.0125, 1e-4),
        )

    def _ties(self, r: Array, pull: float) -> Ties:
        if not self.ties:
            return Ties.none()
        upper, lower, stiffness, law = (np.array(column) for column in zip(*self.ties, strict=True))
        distance = np.linalg.norm(r[upper] - r[lower], axis=1)
        return Ties(
            np.stack([upper, lower], axis=1),
            distance - pull / stiffness * (law == TENSION_ONLY),
            stiffness,
            np.full(len(upper), np.nan),
            np.zeros(len(upper)),
            law,
        )

    def _clamps(self, r: Array) -> Clamps:
        if not self.clamps:
            return Clamps.none()
        nodes = np.array(self.clamps)
        return Clamps(nodes, np.full(len(nodes), 1e7), r[nodes[:, 1]] - r[nodes[:, 0]])

    def _stays(self) -> Stays:
        if not self.stays:
            return Stays.none()
        node, end, length, stiffness, law = zip(*self.stays, strict=True)
        return Stays(
            np.array(node),
            np.array(end),
            np.array(length),
            np.array(stiffness),
            np.full(len(node), 0.6),
            np.array(law),
        )

    def _grounds(self, r: Array) -> Grounds:
        if not self.grounds:
            return Grounds.none()
        node, stiffness, damping = (np.array(column) for column in zip(*self.grounds, strict=True))
        return Grounds(node, stiffness, damping, r[node])


SPAN = 40.0
LENGTH = 2.0 * SPAN
MIDDLE = even(6.0, LENGTH - 6.0, 8.5)


def hold(network: Network, wire: int) -> None:
    """Hold a wire at its middle support with a skew elastic cantilever."""
    skew = np.array([[2e4, 3e3, -4e3], [3e3, 3e5, 2e4], [-4e3, 2e4, 5e5]])
    network.grounds.append((network.node(wire, SPAN), skew, 2e-3 * skew))


def single() -> Network:
    """Return one wire with a steady arm, a stop above it and a rope to the side."""
    line = Network(Wire(even(0.0, LENGTH, 0.8), 0.0, 22e3, 1.35))
    at = line.node(0, SPAN)
    line.stays.append((at, np.array([SPAN, 1.2, 0.2]), 1.2165, 1e6, BOTH_WAYS))
    line.stays.append((at, np.array([SPAN, 0.0, 0.6]), 0.598, 4e5, COMPRESSION_ONLY))
    line.stays.append((line.node(0, 20.0), np.array([20.0, -3.0, 0.0]), 2.9995, 2e5, TENSION_ONLY))
    return line


def simple() -> Network:
    """Return a contact and a messenger wire on meshes of their own."""
    line = Network(
        Wire(even(0.0, LENGTH, 0.72), 0.0, 22e3, 1.35),
        Wire(even(-3.0, LENGTH + 2.0, 0.9), 1.2, 16e3, 1.08, y=0.1),
    )
    line.tie(1, 0, MIDDLE, 2e5, TENSION_ONLY)
    hold(line, 1)
    return line


def stitched() -> Network:
    """Return a line with a stitch wire on either side of the support, clamped to the messenger."""
    contact = Wire(even(0.0, LENGTH, 0.75), 0.0, 22e3, 1.35)
    messenger = Wire(even(0.0, LENGTH, 0.75), 1.5, 16e3, 1.08)
    from_x, to_x = SPAN - 9.0, SPAN + 9.0
    stitch = Wire(even(from_x, to_x, 0.75), 1.1, 3.5e3, 0.31)
    line = Network(contact, messenger, stitch)
    line.tie(1, 0, np.array([7.0, 14.0, 21.0, 28.0, 52.0, 59.0, 66.0, 73.0]), 3e5, TENSION_ONLY)
    line.tie(2, 0, np.array([35.0, 45.0]), 3e5, TENSION_ONLY)
    line.clamps += [(line.node(1, x), line.node(2, x)) for x in (from_x, to_x)]
    hold(line, 1)
    return line


def twin() -> Network:
    """Return two contact wires side by side with rigid cross-links and alternating droppers."""
    x = even(0.0, LENGTH, 0.75)
    line = Network(
        Wire(x, 0.0, 10e3, 0.9, y=-0.02),
        Wire(x, 1.4, 20e3, 1.3),
        Wire(x, 0.0, 10e3, 0.9, y=0.02),
    )
    line.tie(1, 0, np.arange(5.0, LENGTH - 4.0, 10.0), 2e5, TENSION_ONLY)
    line.tie(1, 2, np.arange(10.0, LENGTH - 4.0, 10.0), 2e5, TENSION_ONLY)
    line.clamps += [(line.node(0, p), line.node(2, p)) for p in np.arange(4.5, LENGTH, 5.25)]
    hold(line, 1)
    return line


def compound() -> Network:
    """Return a messenger wire, an auxiliary wire and a contact wire, each on its own mesh."""
    line = Network(
        Wire(even(0.0, LENGTH, 0.7), 0.0, 12e3, 1.0),
        Wire(even(0.0, LENGTH, 0.8), 0.6, 12e3, 0.9, y=0.05),
        Wire(even(0.0, LENGTH, 0.95), 1.6, 20e3, 1.3),
    )
    line.tie(1, 0, even(2.5, LENGTH - 2.5, 2.5), 3e5, TENSION_ONLY)
    line.tie(2, 1, even(5.0, LENGTH - 5.0, 10.0), 3e5, TENSION_ONLY)
    hold(line, 2)
    return line


def graded() -> Network:
    """Return a simple line whose meshes are finer where droppers and supports bend the wires."""
    near = np.array([-0.5, -0.15, 0.0, 0.15, 0.5])
    marks = np.concatenate([MIDDLE, [SPAN]])
    x = np.unique(np.round(np.concatenate([even(0.0, LENGTH, 1.6), *(m + near for m in marks)]), 9))
    x = x[np.concatenate([[True], np.diff(x) > 0.1])]
    line = Network(Wire(x, 0.0, 22e3, 1.35), Wire(x, 1.2, 16e3, 1.08))
    line.tie(1, 0, MIDDLE, 2e5, TENSION_ONLY)
    hold(line, 1)
    return line


def overlap() -> Network:
    """Return two tension lengths that hang side by side; the second is never touched."""
    line = Network(
        Wire(even(0.0, 60.0, 0.8), 0.0, 22e3, 1.35),
        Wire(even(0.0, 60.0, 0.8), 1.2, 16e3, 1.08),
        Wire(even(35.0, 90.0, 0.8), 0.3, 22e3, 1.35, y=0.4),
        Wire(even(35.0, 90.0, 0.8), 1.5, 16e3, 1.08, y=0.4),
    )
    line.tie(1, 0, np.array([8.0, 16.0, 24.0, 32.0]), 2e5, TENSION_ONLY)
    line.tie(3, 2, np.array([62.0, 70.0, 78.0]), 2e5, TENSION_ONLY)
    line.ties.append((line.node(3, 45.0), line.node(1, 45.0), 1e4, BOTH_WAYS))
    return line


TOPOLOGIES: dict[str, Callable[[], Network]] = {
    made.__name__: made for made in (single, simple, stitched, twin, compound, graded, overlap)
}


def hanging(system: System) -> System:
    """Return a line at rest under its weight, found by letting it swing with much damping."""
    cables = system.cables
    load = np.zeros((system.node_count, 6))
    half = 0.5 * 9.81 * cables.length * cables.mass
    np.subtract.at(load[:, 2], cables.nodes, half[:, None])
    load[:, 2] -= 9.81 * system.node_mass
    swinging = system.with_(load=load.ravel(), damping=Rayleigh(6.0, 1e-3))
    options = StepOptions(Newmark(), 5e-3, 5e4, tolerance=1e-9, iterations=60)
    stepper = make_stepper(swinging, (), options, np.array([2]))
    block = stepper.advance(1500)
    assert block.status is Status.RUNNING
    return swinging.with_(position=stepper.coordinates, damping=system.damping)


def under_way(
    start_x: float = 22.0, start_height: float = 0.0, velocity: float = 70.0
) -> PantographInput:
    """Return a pantograph that presses on a wire from below, 160 N in the mean."""
    return PantographInput(
        chain=one_stage(10.0, 100.0, 120.0),
        start_time=0.0,
        start_x=start_x,
        start_height=start_height,
        velocity=velocity,
        stage_forces=np.array([160.0]),
        ramp=0.05,
    )
