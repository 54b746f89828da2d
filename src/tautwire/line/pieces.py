"""Every run of wire and whatever hangs on it, piece by piece.

Positions are given in the frame of the track: ``s`` along it, ``y`` to the left of rising ``s``,
``z`` above the rails, normal to their plane.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from tautwire.line.closures import Closure
from tautwire.line.labels import HangerLabel, MastLabel
from tautwire.numerics.network.parts import TENSION_ONLY
from tautwire.numerics.track import Track
from tautwire.specs.line.cantilever import Elastic
from tautwire.specs.line.catenary import Device
from tautwire.specs.line.dropper import DropperStiffness
from tautwire.specs.line.support import UpliftStop
from tautwire.specs.line.wire import Wire

Role = Literal["contact", "messenger", "auxiliary", "stitch"]
Termination = Literal["anchored", "weighted", "clamped"]


BESIDE = 0.05
"""A mark nearer to an attachment than this is at the attachment [m]: droppers are no closer."""


@dataclass(frozen=True)
class At:
    """A point of a run."""

    run: str
    s: float


@dataclass(frozen=True)
class End:
    """One end of a run.

    Attributes
    ----------
    s, y, z : float m
    kind : str
        ``"anchored"`` (held), ``"weighted"`` (constant tension, free along the track) or
        ``"clamped"`` (to the run ``host``).
    host : str
    device : Device or None
        What keeps the tension of a weighted end; None where it is constant.
    """

    s: float
    y: float
    z: float
    kind: Termination
    host: str = ""
    device: Device | None = None


@dataclass(frozen=True)
class Run:
    """One wire from end to end, as built.

    Attributes
    ----------
    name : str
        Of its own in the line.
    wire : Wire
        Tension, mass and stiffness.
    role : str
    start, end : End
        Left and right.
    wire_name : str
        Of the wire in the case.
    tension_length : str
        Name; empty where there is only one.
    """

    name: str
    wire: Wire
    role: Role
    start: End
    end: End
    wire_name: str
    tension_length: str


@dataclass(frozen=True)
class GivenHeight:
    """The height of the lower wire at a hanger is given; the hanger's length follows.

    Attributes
    ----------
    level : float m
        Straight line between the supports.
    drop : float m
        Depth below it.
    """

    level: float
    drop: float


@dataclass(frozen=True)
class GivenLength:
    """The length of a hanger is given [m]; the height follows."""

    length: float
    is_stretched: bool


@dataclass(frozen=True)
class Hanger:
    """A dropper.

    Attributes
    ----------
    label : HangerLabel
    upper, lower : At
    given : GivenHeight or GivenLength
    stiffness : DropperStiffness
    mass : float kg/m
        Per unstrained length.
    clamps : (float, float) kg
        Upper and lower.
    diameter, thermal_expansion : float m, 1/K or None
    raises : bool
        Holds a contact wire that an overlap raises, at its support: no pantograph comes there.
    """

    label: HangerLabel
    upper: At
    lower: At
    given: GivenHeight | GivenLength
    stiffness: DropperStiffness
    mass: float
    clamps: tuple[float, float]
    diameter: float | None
    thermal_expansion: float | None
    raises: bool


@dataclass(frozen=True)
class Joint:
    """Two runs clamped to each other at one place, turning freely.

    Attributes
    ----------
    host, other : At
    clamp : float kg
        Mass, on the host.
    """

    host: At
    other: At
    clamp: float


@dataclass(frozen=True)
class Registration:
    """A steady arm or spring that holds a contact wire.

    Attributes
    ----------
    label : MastLabel
    at : At
    y, z : float m
        Nominal position of the wire.
    kind : Closure
    clamp : float kg
    end : (float, float) or None
        Far end (y, z) of a given arm [m].
    is_fixed_along : bool
        Whether the wire is held along the track once the shape is found.
    stop : UpliftStop or None
        What it meets when it rises.
    heel : Elastic or None
        How the far end of its arm gives way.
    """

    label: MastLabel
    at: At
    y: float
    z: float
    kind: Closure
    clamp: float
    end: tuple[float, float] | None = None
    is_fixed_along: bool = False
    stop: UpliftStop | None = None
    heel: Elastic | None = None


@dataclass(frozen=True)
class Suspension:
    """The place where a cantilever carries a messenger wire.

    Attributes
    ----------
    label : MastLabel
    at : At
    y, z : float m
    stiffness, damping : float N/m, N s/m
        Vertical.
    is_fixed_along : bool
        Whether the wire is held along the track once the shape is found.
    elastic : Elastic or None
        How it gives way besides.
    """

    label: MastLabel
    at: At
    y: float
    z: float
    stiffness: float
    damping: float
    is_fixed_along: bool
    elastic: Elastic | None = None


@dataclass(frozen=True)
class Body:
    """A splice or an insulator in the line of a wire.

    Attributes
    ----------
    name : str
    run : str
    start, end : float m
        Equal for a mass alone.
    mass : float kg/m
        Per unstrained length, between its ends.
    end_mass : float kg
        At each end.
    axial, bending : float N, N m2
        EA and EI between its ends.
    """

    name: str
    run: str
    start: float
    end: float
    mass: float
    end_mass: float
    axial: float
    bending: float


@dataclass(frozen=True)
class WireStay:
    """A stay from a wire to a fixed point.

    Attributes
    ----------
    name : str
    at : At
    end : (float, float, float) m
        Far end ahead of ``at``, to the left and above the rails.
    law : int
        Of its axial force.
    stiffness : float N/m
    slack : float m
        Change of the distance until it acts.
    pull : float N
        In the design; negative for a push.
    """

    name: str
    at: At
    end: tuple[float, float, float]
    law: int
    stiffness: float
    slack: float
    pull: float

    def length(self, distance: float, pull: float) -> float:
        """Return the unstrained length where it pulls at a distance in the design [m]."""
        slack = self.slack if self.law == TENSION_ONLY else -self.slack
        return distance + slack - pull / self.stiffness


@dataclass(frozen=True)
class Line:
    """A line piece by piece; every group from left to right.

    Attributes
    ----------
    track : Track
    masts : tuple of float m
    runs, hangers, joints, registrations, suspensions, bodies, stays : tuples of pieces
    marks : tuple of At
        Other places at which a wire needs a node.
    """

    track: Track
    masts: tuple[float, ...]
    runs: tuple[Run, ...]
    hangers: tuple[Hanger, ...]
    registrations: tuple[Registration, ...]
    suspensions: tuple[Suspension, ...]
    joints: tuple[Joint, ...] = ()
    bodies: tuple[Body, ...] = ()
    stays: tuple[WireStay, ...] = ()
    marks: tuple[At, ...] = ()

    @cached_property
    def by_name(self) -> dict[str, Run]:
        """Runs by name."""
        return {run.name: run for run in self.runs}

    @cached_property
    def contact_supports(self) -> tuple[tuple[MastLabel, At], ...]:
        """Where contact wires are held, registrations and ends, from left to right."""
        order = {run.name: number for number, run in enumerate(self.runs)}
        places = [(piece.label, piece.at) for piece in self.registrations]
        for run in self.of_role("contact"):
            ends = (run.start.s, run.end.s)
            places += [(MastLabel.of_index(self.mast_at(s)), At(run.name, s)) for s in ends]
        return tuple(sorted(places, key=lambda item: (item[1].s, order[item[1].run])))

    @cached_property
    def registration_rows(self) -> tuple[int, ...]:
        """Which of the contact supports each registration is."""
        rows = {at: row for row, (_, at) in enumerate(self.contact_supports)}
        return tuple(rows[piece.at] for piece in self.registrations)

    def mast_at(self, s: float) -> int:
        """Return the index of the mast nearest to a place."""
        return min(range(len(self.masts)), key=lambda index: abs(self.masts[index] - s))

    def of_role(self, *roles: Role) -> tuple[Run, ...]:
        """Return the runs with one of some roles."""
        return tuple(run for run in self.runs if run.role in roles)

    @cached_property
    def _points(self) -> dict[str, list[float]]:
        points: dict[str, list[float]] = {run.name: [run.start.s, run.end.s] for run in self.runs}
        for at in _places(self):
            points[at.run].append(at.s)
        for at in self.marks:
            if min(abs(at.s - s) for s in points[at.run]) > BESIDE:
                points[at.run].append(at.s)
        return {name: sorted(set(values)) for name, values in points.items()}

    def holding_points(self, run: Run) -> list[float]:
        """Return where a contact wire is held: its ends, registrations and hangers above."""
        pieces = [piece.at for piece in self.registrations]
        pieces += [hanger.lower for hanger in self.hangers]
        return [run.start.s, run.end.s, *(at.s for at in pieces if at.run == run.name)]

    def points(self, run: str) -> list[float]:
        """Return where something is attached to a run, its ends included, from left to right."""
        return self._points[run]


def _places(line: Line) -> Iterable[At]:
    """Yield every point at which something is attached to a run."""
    for hanger in line.hangers:
        yield from (hanger.upper, hanger.lower)
    for joint in line.joints:
        yield from (joint.host, joint.other)
    for piece in (*line.registrations, *line.suspensions, *line.stays):
        yield piece.at
    for body in line.bodies:
        yield from (At(body.run, body.start), At(body.run, body.end))
