"""Cantilevers that turn about their masts, and the share of the tension that they take.

A cantilever and its steady arm are one rigid piece in plan. When the wire has moved along the track
by u from where the cantilever stands square to it, the force between them acts along the line from
the wire to the hinge, at the lateral distance d: with the lateral force F on the wire it has the
component along the track ::

    F_along = -F u / d,    d = y_hinge - y_wire

which holds the wire back where the cantilever pulls (F and d of one sign, pull-off) and drives it
on where it pushes. Its end describes a circle about the hinge and so takes the wire towards the
mast, by ``d - sqrt(d^2 - u^2)``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.model.build import Model
from tautwire.numerics.network.parts import Grounds, Stays
from tautwire.numerics.network.system import System, internal_force

Array = NDArray[Any]
Index = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Cantilevers:
    """What turns with the wires of a line.

    Attributes
    ----------
    nodes : (n,)
        That they hold.
    hinge : (n,) m
        Lateral position of their axes in the frames of the track.
    """

    nodes: Index
    hinge: Array

    @property
    def square(self) -> Turned:
        """How they stand in the design."""
        return Turned(np.zeros(len(self.nodes)), np.zeros(len(self.nodes)))

    def turned(self, model: Model, system: System, design: Array) -> Turned:
        """Return how cantilevers stand and what they take in a state of the line.

        Parameters
        ----------
        model
        system
            At rest.
        design : (n_dof,) m
            Where the nodes were when the cantilevers stood square.
        """
        frames = model.mesh.frames[self.nodes]
        bare = system.with_(stays=Stays.none(), grounds=Grounds.none())
        missing = internal_force(bare, system.position).nodal - system.load
        on_wire = frames.components(missing.reshape(-1, 6)[self.nodes, :3])[:, 1]
        before, now = (
            frames.to_local(q.reshape(-1, 6)[self.nodes, :3]) for q in (design, system.position)
        )
        travel, distance = now[:, 0] - before[:, 0], self.hinge - before[:, 1]
        reach = np.sqrt(np.maximum(distance**2 - travel**2, 0.0))
        lateral = distance - np.sign(distance) * reach
        return Turned(-on_wire * travel / (np.sign(distance) * np.maximum(reach, 1e-9)), lateral)


@dataclass(frozen=True, eq=False)
class Turned:
    """How the cantilevers of a line stand.

    Attributes
    ----------
    along : (n,) N
        Their force along the track on the nodes.
    lateral : (n,) m
        How far they have taken the nodes to the left.
    """

    along: Array
    lateral: Array

    def on(self, model: Model, cantilevers: Cantilevers, system: System) -> System:
        """Return a line with its cantilevers turned and their forces among its loads."""
        axes, nodes = model.mesh.frames.axes, cantilevers.nodes
        load, shift = np.zeros((len(axes), 6)), np.zeros((len(axes), 3))
        load[nodes, :3] = self.along[:, None] * axes[nodes, 0]
        shift[nodes] = self.lateral[:, None] * axes[nodes, 1]
        position = system.position.copy().reshape(-1, 6)
        position[:, :3] += shift
        stays, grounds = system.stays, system.grounds
        return system.with_(
            load=system.load + load.ravel(),
            position=position.ravel(),
            stays=stays.with_(end=stays.end + shift[stays.node]),
            grounds=grounds.with_(free=grounds.free + shift[grounds.node]),
        )


def cantilevers_of(model: Model) -> Cantilevers:
    """Return the cantilevers of a line that turn; none where no hinges are given.

    What is fixed along the track does not turn.
    """
    line = model.line
    hinges = model.case.supports.hinges(len(line.masts))
    if hinges is None:
        return Cantilevers(np.empty(0, dtype=np.int64), np.empty(0))
    held = [p for p in (*line.registrations, *line.suspensions) if not p.is_fixed_along]
    return Cantilevers(
        model.mesh.nodes(piece.at for piece in held),
        np.array([hinges[piece.label.number - 1] for piece in held]),
    )
