"""Equilibrium of a line whose unstrained lengths are all given: plain Newton, with continuation.

What holds the wires sideways swings freely along the track, as hinged cantilevers do: a stay or a
ground acts on a node ``r`` in the plane across the track tangent ``t`` only, so that its force is
that of ``P r`` with ``P = I - t t^T``. Once the equilibrium is found its far end stands beside the
node again, and it resists motion along the track as it did in the design.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.network.banded import BandedCholesky, Pattern
from tautwire.numerics.network.system import System, internal_force, tangent_parts, tie_axial_force
from tautwire.numerics.statics.newton import NewtonResult, NewtonSettings, damped_newton
from tautwire.status import Status

Array = NDArray[Any]

RESIDUAL = 1e-4
"""Largest unbalanced force accepted [N]; rounding leaves some 1e-5 N on a line of 17 spans."""

_LARGEST_STEP = np.repeat([0.5, 0.1], 3)
"""Of a coordinate [m] and of a slope; undamped Newton passes through absurd states."""

_INCREMENT = 1e-9
"""Increment accepted as converged, in units of the largest step: a condition that changes nothing
gives the design back to 1e-9 m."""

_SMALLEST_SHARE = 1.0 / 64.0
"""Smallest step of the continuation, as a share of the whole change."""


@dataclass(frozen=True, eq=False)
class Settled:
    """An equilibrium, or how far a continuation came.

    Attributes
    ----------
    status : Status
    system : System
        At the equilibrium; stays and grounds stand beside their nodes.
    share : float
        Share of the change from the start that was reached; 1 when done.
    iterations : int
    residual : float N
    """

    status: Status
    system: System
    share: float
    iterations: int
    residual: float


@dataclass(frozen=True, eq=False)
class Swing:
    """Directions in which what holds the wires follows them without resistance.

    Attributes
    ----------
    stays : (n_stay, 3)
        Unit vectors; zeros for a stay that stands still.
    grounds : (n_ground, 3)
        The same for grounds.
    """

    stays: Array
    grounds: Array


def settle(start: System, end: System, swing: Swing) -> Settled:
    """Find the equilibrium of a system, starting from that of another with the same parts.

    Parameters
    ----------
    start
        At rest; lengths, loads, far ends and fixed coordinates are those to start from.
    end
        What they become. Its ``position`` is a guess; the fixed coordinates in it are prescribed.
    swing
        How stays and grounds follow.
    """
    reached, share, step, iterations, residual = start, 0.0, 1.0, 0, 0.0
    guess = end.position
    while share < 1.0:
        target = _between(start, end, share + step)
        newton = _Newton(target, swing).solve(guess)
        iterations, residual = iterations + newton.iterations, newton.residual
        if newton.status is Status.DONE:
            reached, share = target.with_(position=newton.x), share + step
            step = min(2.0 * step, 1.0 - share)
        elif step > _SMALLEST_SHARE:
            step *= 0.5
        else:
            return Settled(newton.status, reached, share, iterations, residual)
        guess = reached.position
    return Settled(Status.DONE, beside(reached, swing), 1.0, iterations, residual)


def _between(start: System, end: System, share: float) -> System:
    """Return a system some way from one to another."""
    if share >= 1.0:
        return end

    def mixed(a: Array, b: Array) -> Array:
        return a + share * (b - a)

    return end.with_(
        cables=end.cables.with_(
            length=mixed(start.cables.length, end.cables.length),
            axial=mixed(start.cables.axial, end.cables.axial),
            bending=mixed(start.cables.bending, end.cables.bending),
        ),
        ties=end.ties.with_(length=mixed(start.ties.length, end.ties.length)),
        load=mixed(start.load, end.load),
        position=np.where(end.fixed, mixed(start.position, end.position), start.position),
    )


def beside(system: System, swing: Swing) -> System:
    """Return a system whose stays and grounds end beside their nodes, not ahead or behind."""
    r = system.position.reshape(-1, 6)[:, :3]
    stays, grounds = system.stays, system.grounds
    return system.with_(
        stays=stays.with_(end=stays.end + _along(r[stays.node] - stays.end, swing.stays)),
        grounds=grounds.with_(
            free=grounds.free + _along(r[grounds.node] - grounds.free, swing.grounds)
        ),
    )


def _along(vectors: Array, tangent: Array) -> Array:
    return np.sum(vectors * tangent, axis=1)[:, None] * tangent


def _across(directions: Array) -> Array:
    """Return the projections across some unit vectors, ``(n, 3, 3)``."""
    return np.eye(3) - directions[:, :, None] * directions[:, None, :]


class _Newton:
    """Newton's iteration on the coordinates of one system."""

    def __init__(self, system: System, swing: Swing) -> None:
        grounds, own = system.grounds, _across(swing.grounds)
        self.across, self.swing = _across(swing.stays), swing
        self.system = system.with_(grounds=grounds.with_(stiffness=own @ grounds.stiffness @ own))
        self.pattern = Pattern(system)

    def placed(self, q: Array) -> System:
        return beside(self.system.with_(position=q), self.swing)

    def residual(self, q: Array) -> Array:
        system = self.placed(q)
        return np.where(system.fixed, 0.0, internal_force(system, q).nodal - system.load)

    def direction(self, q: Array, r: Array) -> Array | None:
        system = self.placed(q)
        taut = system.ties.acting(tie_axial_force(system, q))
        parts = tangent_parts(system, q, taut=taut)
        stays = np.einsum("nij,jkn,nkl->iln", self.across, parts.stays, self.across)
        parts = parts.with_(stays=stays)
        factor = BandedCholesky.of(self.pattern.upper_band(self.pattern.values(parts)))
        return None if factor is None else factor.solve(-r)

    def solve(self, q: Array) -> NewtonResult:
        system = self.system
        begin = np.where(system.fixed, system.position, q)
        limits = np.tile(_LARGEST_STEP, system.node_count)
        settings = NewtonSettings(increment=_INCREMENT, residual=RESIDUAL)
        return damped_newton(begin, self.residual, self.direction, limits, settings)
