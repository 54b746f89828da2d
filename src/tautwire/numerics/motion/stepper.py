"""What a time integration is given and what it gives back; shared by all backends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.motion.dispersion import WaveStiffening
from tautwire.numerics.motion.pantograph import PantographChain
from tautwire.numerics.network.system import System
from tautwire.numerics.newmark import Integrator
from tautwire.numerics.track import Frames, Track
from tautwire.status import Status

Array = NDArray[Any]

SAME_TIME = 1e-12
"""Rounding of an instant of a passage [s]."""
Index = NDArray[np.int64]

_HISTORIES = (
    "time",
    "contact_force",
    "gap",
    "wire_height",
    "path_force",
    "stages",
    "dropper_force",
    "observed",
)


@dataclass(frozen=True, eq=False)
class RoofMotion:
    """Prescribed motion of the roof, linear between the given instants, constant outside.

    Attributes
    ----------
    time : (n,) s
    height : (n,) m
    """

    time: Array
    height: Array

    def at(self, time: Array) -> tuple[Array, Array]:
        """Return heights [m] and velocities [m/s] of the roof at some instants."""
        rates = np.concatenate([[0.0], np.diff(self.height) / np.diff(self.time), [0.0]])
        segment = np.searchsorted(self.time, time, side="right")
        return np.interp(time, self.time, self.height), rates[segment]


@dataclass(frozen=True, eq=False)
class SurfaceProfile:
    """Unevenness of the running surface of the contact wire, linear between even ordinates.

    Attributes
    ----------
    start : float m
        Longitudinal position of the first ordinate.
    spacing : float m
    height : (n,) m
        Height of the running surface above the wire, positive up; none beyond the ends.
    """

    start: float
    spacing: float
    height: Array

    @property
    def x(self) -> Array:
        """Longitudinal positions of the ordinates, ``(n,)`` [m]."""
        return self.start + self.spacing * np.arange(len(self.height))

    def at(self, x: Array) -> Array:
        """Return the heights at longitudinal positions, of the shape of ``x`` [m]."""
        place = (np.asarray(x, dtype=float) - self.start) / self.spacing
        last = len(self.height) - 1
        left = np.clip(place.astype(np.int64), 0, last - 1)
        share = place - left
        height = (1.0 - share) * self.height[left] + share * self.height[left + 1]
        return np.where((place >= 0.0) & (place <= last), height, 0.0)


@dataclass(frozen=True, eq=False)
class PantographInput:
    """One pantograph on its way along the line.

    Attributes
    ----------
    chain : PantographChain
    start_time : float s
        When it enters the line, at rest and just touching.
    start_x : float m
        Where it enters, along the track.
    start_height : float m
        Height of the head above the rails at the start.
    velocity : float m/s
        Along the track; negative in running direction -x.
    stage_forces : (n_stage,) N
        Uplift force and whatever else acts on the stages, reached after ``ramp`` seconds along
        half a cosine. The base spring counts from the start; where it carries nothing at another
        height, its force at the start is among these.
    ramp : float s
    roof : RoofMotion or None
    surface : SurfaceProfile or None
        Unevenness of the running surface that the head meets.
    reach : float m
        Half the length of the head; wires further from the middle of the track pass beside it.
    track : Track
        On which it runs; displacements of its stages are those from the moving frame.
    """

    chain: PantographChain
    start_time: float
    start_x: float
    start_height: float
    velocity: float
    stage_forces: Array
    ramp: float
    roof: RoofMotion | None = None
    surface: SurfaceProfile | None = None
    reach: float = np.inf
    track: Track = field(default_factory=Track.straight)

    def position(self, time: Any) -> Any:
        """Position along the track at one instant or at several [m]."""
        return self.start_x + self.velocity * (time - self.start_time)

    def plane(self, time: Any) -> Frames:
        """Frame of the track at one instant or at several: the head moves across it, along b."""
        return self.track.frames(self.position(time))

    def unevenness(self, time: Array) -> Array:
        """Return the height of the running surface above the wire where the head is [m]."""
        place = self.start_x + self.velocity * (np.asarray(time, dtype=float) - self.start_time)
        return np.zeros(np.shape(place)) if self.surface is None else self.surface.at(place)

    def external(self, time: Any) -> Array:
        """Return the forces on the stages at one instant or at several, ``(..., n_stage)`` [N].

        The motion of the roof is among them.

        The frame of the track accelerates along b by ``v^2 b . dt/ds`` on a vertical curve or a
        canted one, and the masses of the stages with it.
        """
        since = np.asarray(time, dtype=float) - self.start_time
        ramped = np.clip(since / self.ramp, 0.0, 1.0) if self.ramp > 0.0 else np.ones_like(since)
        share = np.where(ramped < 1.0, 0.5 - 0.5 * np.cos(np.pi * ramped), 1.0)
        load = share[..., None] * self.stage_forces
        if not self.track.is_plane:
            rise = share * self.track.rise_curvature(self.position(time))
            load -= self.velocity**2 * rise[..., None] * self.chain.mass
        if self.roof is not None:
            height, velocity = self.roof.at(since)
            load[..., -1] += self.chain.stiffness[-1] * height + self.chain.damping[-1] * velocity
        return load


@dataclass(frozen=True, eq=False)
class StepOptions:
    """How a time integration works.

    Attributes
    ----------
    integrator : Newmark, HHT or Extrapolated
    time_step : float s
    contact_stiffness : float N/m
    tolerance : float m
        Largest increment of a coordinate accepted as converged.
    iterations : int
        Most iterations per step.
    full_newton : bool
        Tangent and factor at every iteration (the check of the fast path).
    stiffening : WaveStiffening or None
        With a step dt, wires have the bending stiffness ``EI + dt^2 bending`` and the line carries
        ``load + dt^2 load``; damping stays that of ``EI``.
    """

    integrator: Integrator
    time_step: float
    contact_stiffness: float
    tolerance: float
    iterations: int = 30  # a step takes 2 or 3; one that takes ten times as many will not end
    full_newton: bool = False
    stiffening: WaveStiffening | None = None


def reachable_tolerance(system: System, options: StepOptions) -> float:
    """Return the tolerance of the options, or what rounding leaves when that is more [m].

    A coordinate x is rounded by ``eps x``, which strains an element of length L by ``eps x/L``; the
    force EA times that moves a node of mass m L by ``beta dt^2 EA/(m L^2)`` times the rounding in a
    step. No iteration gets below that; the factor 4 is for the sums on the way.

    Parameters
    ----------
    system
        The line in its static state.
    options
        Integrator, step, tolerance.
    """
    cables = system.cables
    gain = cables.axial / (cables.mass * cables.length**2)
    gain = 1.0 + options.integrator.beta * options.time_step**2 * float(gain.max(initial=0.0))
    place = float(np.abs(system.position).max(initial=0.0))
    return max(options.tolerance, 4.0 * float(np.finfo(float).eps) * place * gain)


@dataclass(frozen=True, eq=False)
class StepBlock:
    """Histories of a number of completed steps.

    Attributes
    ----------
    time : (n_step,) s
    contact_force : (n_step, n_pantograph) N
    gap : (n_step, n_pantograph) m
        Running surface of the wire above head; negative in contact; NaN before the pantograph
        has entered.
    wire_height : (n_step, n_pantograph) m
        Height of the wire next to the head.
    path_force : (n_step, n_pantograph, n_path) N
        Force of each path on each pantograph; NaN where the head does not reach it.
    stages : (n_step, n_stage_total) m
        Displacements of the stages from their start, pantograph by pantograph, head first.
    dropper_force : (n_step, n_dropper) N
    observed : (n_step, n_observed)
        Coordinates of the observed degrees of freedom.
    status : Status
        ``RUNNING`` while everything is well; otherwise the step after the last one failed.
    refused_gap : (n_pantograph,) m or None
        Gaps at the end of the step that was tried and not kept because a contact opened or
        closed in it; None when there was no such step.
    """

    time: Array
    contact_force: Array
    gap: Array
    wire_height: Array
    path_force: Array
    stages: Array
    dropper_force: Array
    observed: Array
    status: Status
    refused_gap: Array | None = None

    def rows(self, first: int, stop: int, every: int = 1) -> StepBlock:
        """Return some of the steps."""
        kept = {name: getattr(self, name)[first:stop:every] for name in _HISTORIES}
        return StepBlock(status=self.status, **kept)

    @classmethod
    def joined(cls, blocks: Sequence[StepBlock], status: Status) -> StepBlock:
        """Join at least one block to one, with a status of its own."""
        kept = {name: np.concatenate([getattr(b, name) for b in blocks]) for name in _HISTORIES}
        return cls(status=status, **kept)


COUNTED_NOTES = ("local_iterations", "local_rows", "solved_rows", "helped_parts")
"""Notes on a time integration that count work, as the core returns them (engine.hpp)."""
LARGEST_NOTES = ("overlooked",)
"""Notes that are the largest of what was met, behind the former."""


@dataclass
class StepCounters:
    """Work done so far."""

    steps: int = 0
    iterations: int = 0
    refactorisations: int = 0
    full_newton_steps: int = 0
    notes: dict[str, Any] = field(default_factory=dict)


class Stepper(Protocol):
    """A time integration under way.

    ``mark`` and ``rewind`` let a step control redo what it has just done with other steps. A mark
    is the complete state (wires, pantographs, time); it stays valid whatever is computed after it.
    """

    @property
    def counters(self) -> StepCounters:
        """Work done so far: one object throughout, to whose notes a step control adds its own."""
        ...

    @property
    def time(self) -> float:
        """Time reached [s]."""
        ...

    @property
    def coordinates(self) -> Array:
        """Nodal coordinates at the time reached, ``(n_dof,)``."""
        ...

    def advance(
        self, steps: int, time_step: float | None = None, *, until_crossing: bool = False
    ) -> StepBlock:
        """Take up to ``steps`` steps; fewer when one fails (see the block's status).

        Parameters
        ----------
        steps
            Number of steps.
        time_step
            Step [s]; that of the options by default. Any positive step is allowed. Steps of
            1, 1/2, 1/4 ... of the options' step find their matrix factored in advance after
            their first use; other steps use the factor of a slightly longer one.
        until_crossing
            Stop before a step in which the gap of a pantograph changes between negative
            (contact) and not negative. That step is not kept; its gaps are returned.
        """
        ...

    def start_from(self, q: Array, v: Array) -> None:
        """Replace the state at time zero (plucked wires, wave tests); forces need not balance.

        Parameters
        ----------
        q, v : (n_dof,)
            Coordinates and velocities.
        """
        ...

    def mark(self) -> object:
        """Return the present state, to come back to."""
        ...

    def rewind(self, mark: object) -> None:
        """Go back to a state returned by ``mark``; counters keep counting."""
        ...
