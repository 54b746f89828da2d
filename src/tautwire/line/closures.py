"""What is known about a contact wire where it is registered, and what holds it there.

A closure answers for all registrations of its kind at once: which directions are held while the
shape is sought, which force acts meanwhile, how the arm stands in the found shape, and what it is
at rest. Everything is told in the frame of the track at the registration: 0 along the track,
1 lateral, 2 normal to the plane of the rails. Gravity has a component in each of them where there
are gradient and cant.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from tautwire.numerics.network.parts import BOTH_WAYS, Grounds, Stays
from tautwire.specs.line.support import Arm, SupportSpring

Array = NDArray[Any]
Index = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Held:
    """How wires are held at registrations of one kind in the found shape.

    Attributes
    ----------
    force : (n,) N
        Axial force of the arms, tension positive; NaN without arms.
    angle : (n,) rad
        Inclination of the arms, positive when the far end is above the wire; NaN without arms.
    end : (n, 3) m
        Far ends of the arms in the frames of the track; NaN without arms.
    preload : (n,) N
        Upward force of springs; zero with arms.
    """

    force: Array
    angle: Array
    end: Array
    preload: Array


@dataclass(frozen=True, eq=False)
class AtRest:
    """What registrations of one kind are once the shape is found.

    Attributes
    ----------
    stays : Stays
    grounds : Grounds
    load : (n, 3) N
        Constant force on the wires.
    is_held_sideways : bool
    added_mass : float kg
        Mass that moves with each wire and is not among the lumped masses yet.
    """

    stays: Stays
    grounds: Grounds
    load: Array
    is_held_sideways: bool
    added_mass: float = 0.0


class Closure(ABC):
    """What is known about a contact wire at a registration."""

    @property
    @abstractmethod
    def held(self) -> tuple[int, ...]:
        """Directions in which the wire is held while the shape is sought."""

    @property
    def mass(self) -> float:
        """Mass that is lumped on the wire [kg]."""
        return 0.0

    def carried_weight(self, gravity: float) -> float:  # noqa: ARG002
        """Return the weight of what belongs to the registration and is no lumped mass [N]."""
        return 0.0

    def design_load(self, gravity: Array) -> Array:
        """Return the constant forces on the wires while the shape is sought, ``(n, 3)`` [N].

        Parameters
        ----------
        gravity : (n, 3) m/s2
            In the frames of the track.
        """
        return np.zeros_like(gravity)

    def design_stays(self, node: Index, end: Array) -> Stays:  # noqa: ARG002
        """Return the arms that take part while the shape is sought.

        Parameters
        ----------
        node : (n,)
        end : (n, 3) m
            Far ends, where they are given.
        """
        return Stays.none()

    @abstractmethod
    def hold(self, wire: Array, reaction: Array, end: Array, gravity: Array) -> Held:
        """Return how the wires are held in the found shape.

        Parameters
        ----------
        wire : (n, 3) m
            Positions of the wires.
        reaction : (n, 3) N
            Forces that hold them.
        end : (n, 3) m
            Far ends, where they are given.
        gravity : (n, 3) m/s2
        """

    @abstractmethod
    def at_rest(self, node: Index, wire: Array, held: Held, gravity: Array) -> AtRest:
        """Return what holds the wires once the shape is found.

        Parameters
        ----------
        node : (n,)
        wire : (n, 3) m
            Positions of the wires.
        held
            How they are held.
        gravity : (n, 3) m/s2
        """


@dataclass(frozen=True)
class _WithArm(Closure, ABC):
    arm: Arm

    @property
    def half_mass(self) -> float:
        """Half the mass of the arm [kg]; the other half hangs on its far end."""
        return 0.5 * self.arm.mass * self.arm.length

    @override
    def carried_weight(self, gravity: float) -> float:
        return 2.0 * self.half_mass * gravity

    @override
    def design_load(self, gravity: Array) -> Array:
        """Return what no reaction holds: the weight's share along the track."""
        return self.half_mass * gravity * np.array([1.0, 0.0, 0.0])

    def _pull(self, reaction: Array, gravity: Array) -> Array:
        """Return the axial force of each arm on its wire, ``(n, 3)`` [N]."""
        pull = reaction - self.half_mass * gravity
        pull[:, 0] = 0.0
        return pull

    @override
    def hold(self, wire: Array, reaction: Array, end: Array, gravity: Array) -> Held:
        pull = self._pull(reaction, gravity)
        force = np.linalg.norm(pull, axis=1)
        length = self.arm.length * (1.0 + force / self.arm.axial_stiffness)
        offset = pull * (length / np.where(force > 0.0, force, 1.0))[:, None]
        return _held_by_arms(wire, force, offset)

    def stays(self, node: Index, end: Array) -> Stays:
        """Return the arms as bars with given far ends ``(n, 3)`` [m]."""
        count, arm = len(node), self.arm
        return Stays(
            node=node,
            end=end,
            length=np.full(count, arm.length),
            stiffness=np.full(count, arm.axial_stiffness / arm.length),
            mass=np.full(count, arm.mass * arm.length),
            law=np.full(count, BOTH_WAYS),
        )

    @override
    def at_rest(self, node: Index, wire: Array, held: Held, gravity: Array) -> AtRest:
        half = self.half_mass * gravity
        if self.arm.motion == "swinging":
            return AtRest(self.stays(node, held.end), Grounds.none(), half, is_held_sideways=False)
        return self._vertical(node, wire, held, half)

    def _vertical(self, node: Index, wire: Array, held: Held, half: Array) -> AtRest:
        """Return the springs that the arms are for small rotations at constant lateral pull H.

        ``V = H tan(angle)`` gives ``dV/dz = H / (l cos^3 angle)``; along the track an arm is a
        pendulum of stiffness N/l. A third of its mass moves with the wire.
        """
        along = held.force / self.arm.length
        cosine = np.cos(held.angle)
        return AtRest(
            stays=Stays.none(),
            grounds=Grounds(
                node,
                along_axes(along, along / cosine**2),
                along_axes(0.0 * along, 0.0 * along),
                wire * np.array([1.0, 0.0, 1.0]),
            ),
            load=half + upward(held.force * np.sin(held.angle)),
            is_held_sideways=True,
            added_mass=self.arm.mass * self.arm.length / 3.0,
        )


@dataclass(frozen=True)
class Height(_WithArm):
    """The height is given; the steady arm is placed accordingly."""

    @property
    @override
    def held(self) -> tuple[int, ...]:
        return (1, 2)


@dataclass(frozen=True)
class Lift(_WithArm):
    """The upward force of the steady arm is given, its own half weight deducted [N]."""

    force: float

    @property
    @override
    def held(self) -> tuple[int, ...]:
        return (1,)

    @override
    def design_load(self, gravity: Array) -> Array:
        return super().design_load(gravity) + np.array([0.0, 0.0, self.force])

    @override
    def _pull(self, reaction: Array, gravity: Array) -> Array:
        given = reaction.copy()
        given[:, 2] = self.force
        return super()._pull(given, gravity)


@dataclass(frozen=True)
class GivenArm(_WithArm):
    """The far end of the steady arm is given."""

    @property
    @override
    def held(self) -> tuple[int, ...]:
        return ()

    @override
    def design_load(self, gravity: Array) -> Array:
        return self.half_mass * gravity

    @override
    def design_stays(self, node: Index, end: Array) -> Stays:
        return self.stays(node, end)

    @override
    def hold(self, wire: Array, reaction: Array, end: Array, gravity: Array) -> Held:
        offset = end - wire
        arms = self.stays(np.zeros(len(wire), dtype=np.int64), end)
        return _held_by_arms(wire, arms.axial_force(np.linalg.norm(offset, axis=1)), offset)


@dataclass(frozen=True)
class Spring(Closure):
    """A preloaded vertical spring stands in place of the arm."""

    spring: SupportSpring

    @property
    @override
    def held(self) -> tuple[int, ...]:
        return (1, 2)

    @property
    @override
    def mass(self) -> float:
        return self.spring.mass

    @override
    def hold(self, wire: Array, reaction: Array, end: Array, gravity: Array) -> Held:
        none = np.full(len(wire), np.nan)
        return Held(none, none, np.full((len(wire), 3), np.nan), reaction[:, 2])

    @override
    def at_rest(self, node: Index, wire: Array, held: Held, gravity: Array) -> AtRest:
        ones = np.ones(len(node))
        grounds = Grounds(
            node,
            along_axes(0.0 * ones, self.spring.stiffness * ones),
            along_axes(0.0 * ones, self.spring.damping * ones),
            wire * np.array([1.0, 0.0, 1.0]),
        )
        return AtRest(Stays.none(), grounds, upward(held.preload), is_held_sideways=True)


def _held_by_arms(wire: Array, force: Array, offset: Array) -> Held:
    angle = np.arctan2(offset[:, 2], np.abs(offset[:, 1]))
    return Held(force, angle, wire + offset, np.zeros(len(wire)))


def upward(force: Array) -> Array:
    """Return forces normal to the plane of the rails, ``(n, 3)`` [N]."""
    zeros = np.zeros_like(force)
    return np.stack([zeros, zeros, force], axis=1)


def along_axes(along: Array, vertical: Array) -> Array:
    """Return diagonal matrices ``(n, 3, 3)`` that act along the track and vertically."""
    matrix = np.zeros((len(along), 3, 3))
    matrix[:, 0, 0], matrix[:, 2, 2] = along, vertical
    return matrix
