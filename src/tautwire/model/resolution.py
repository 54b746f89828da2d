"""What mesh and time step of a case resolve, and how large they make the computation."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

from tautwire.line.expand import expand
from tautwire.line.pieces import Line
from tautwire.model.band import carried_by, longest_element
from tautwire.model.mesh import divide, longest_elements
from tautwire.numerics.motion.extrapolated_stepper import PARTS
from tautwire.plain import Plain
from tautwire.specs.case import Case
from tautwire.specs.settings import STEPS_PER_PERIOD

_ROUNDING = 1e-6
"""Share by which a frequency may be missed that is carried: places are kept to a nanometre."""

_COMPILED = 2e-8
"""CPU time per degree of freedom and step with the compiled core [s]: 8 to 40 ns were measured on a
machine in use, more on larger lines, and 20 ns on the reference line."""
_NUMPY = 9e-7
"""The same with NumPy [s]: 0.86 us were measured on the reference line, 0.6 to 1 us before on nine
nodes between droppers."""


@dataclass(frozen=True)
class Resolution:
    """Highest frequencies that a case carries.

    Attributes
    ----------
    mesh, step : float Hz
        Of the wire mesh and of the time step.
    run : str
        Wire whose mesh carries least.
    element : float m
        Its longest element.
    longest : float m
        Longest element of the contact wires.
    """

    mesh: float
    step: float
    run: str
    element: float
    longest: float

    @property
    def carried(self) -> float:
        """Highest frequency that both carry [Hz]."""
        return min(self.mesh, self.step)

    def carries(self, frequency: float) -> bool:
        """Return whether mesh and step carry a frequency [Hz]."""
        return frequency <= self.carried * (1.0 + _ROUNDING)


def resolution(case: Case, line: Line) -> Resolution:
    """Return the highest frequencies that mesh and time step of a case carry.

    Parameters
    ----------
    case
    line
        Its pieces.
    """
    speed = case.scenario.speed
    longest = longest_elements(line, case.settings, speed)
    mesh, run = min((carried_by(run, longest[run.name], speed), run.name) for run in line.runs)
    touched = max(longest[run.name] for run in line.of_role("contact"))
    step = 1.0 / (STEPS_PER_PERIOD * case.settings.step())
    return Resolution(mesh, step, run, longest[run], touched)


def fewest_nodes(line: Line, band: float, speed: float) -> int:
    """Return the fewest nodes between droppers, evenly, whose elements carry a band.

    Parameters
    ----------
    line
    band
        Highest frequency [Hz].
    speed
        Of the train [m/s].
    """
    return max(
        math.ceil(gap / longest_element(run, band, speed) - _ROUNDING) + 1
        for run in line.runs
        for gap in [_longest_gap(line.points(run.name))]
    )


def _longest_gap(points: list[float]) -> float:
    return max(right - left for left, right in pairwise(points))


@dataclass(frozen=True)
class Size(Plain):
    """How large a computation is.

    Attributes
    ----------
    droppers, dof, steps : int
        Droppers, degrees of freedom, time steps of one passage.
    """

    droppers: int
    dof: int
    steps: int

    def cpu_s(self, *, is_compiled: bool = True) -> float:
        """Return about how long one passage takes, with the compiled core or with NumPy [s]."""
        return self.dof * self.steps * (_COMPILED if is_compiled else _NUMPY)


def size(case: Case) -> Size:
    """Return how large the computation of a case will be."""
    line = expand(case)
    nodes = divide(line, case.settings, case.scenario.speed).node_count
    way = case.line.length() - 2.0 * case.settings.start
    steps = math.ceil(way / case.scenario.speed / case.settings.step())
    parts = sum(PARTS) if case.settings.integrator.method == "extrapolated" else 1
    return Size(len(line.hangers), 6 * nodes, parts * max(steps, 0))
