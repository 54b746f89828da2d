"""The matrix of a time step and its factor, kept for the steps that come back.

A step ``dt`` solves with ``A = M + c C + k K``, ``c`` proportional to dt and ``k`` to dt squared.
Factors are kept for the steps ``g = dt_0 2^(-j/4)``; another step uses the factor of the next
longer one, which overrates the stiff directions by up to ``s = (dt/g)^2 > 0.7``. Scaled by
``2/(1 + s)`` its error shrinks by ``(1 - s)/(1 + s) < 0.18`` per iteration.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, replace
from math import floor, log2
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.motion.corotation import NodeRotation, unit_tangents
from tautwire.numerics.motion.stepper import StepOptions
from tautwire.numerics.network.banded import BandedCholesky, Pattern
from tautwire.numerics.network.system import (
    PartMatrices,
    System,
    ground_dampers,
    lumped_mass,
    mass_parts,
    tangent_parts,
)
from tautwire.numerics.newmark import Integrator

Array = NDArray[Any]

MOST_FACTORS = 12
"""Factors that are kept; the one not used for longest goes first. An adaptive passage uses
about seven."""

_STEPS_PER_OCTAVE = 4
"""Factored steps per octave: a factor is used for steps shorter by up to 2^(-1/4), so that an
iteration contracts by (1 - s)/(1 + s) = 0.17 at worst, s = 2^(-1/2)."""
_SAME = 1e-9
"""Rounding of a step that was halved and added up, relative."""


@dataclass(frozen=True)
class StepCoefficients:
    """What multiplies the end acceleration in a step.

    Attributes
    ----------
    time_step : float s
    weight : float
        ``1 + alpha``.
    to_velocity : float s
        ``gamma dt``.
    to_position : float s2
        ``beta dt^2``.
    """

    time_step: float
    weight: float
    to_velocity: float
    to_position: float

    @classmethod
    def of(cls, integrator: Integrator, time_step: float) -> StepCoefficients:
        """Return the coefficients of an integrator for a time step [s]."""
        return cls(
            time_step,
            1.0 + integrator.alpha,
            integrator.gamma * time_step,
            integrator.beta * time_step**2,
        )


class LineMatrices:
    """Mass, damping and static stiffness of a line, and the entries from which A is summed."""

    def __init__(self, system: System) -> None:
        self.pattern = Pattern(system)
        self._system = system
        self._mass_values = self.pattern.values(mass_parts(system))
        self._lumped = lumped_mass(system)
        parts = tangent_parts(system, system.position)
        rayleigh = parts.scaled(cables=1.0, stays=1.0)
        a_r, b_r = system.damping.mass, system.damping.stiffness
        self._damping_values = (
            a_r * self._mass_values
            + b_r * self.pattern.values(rayleigh)
            + self.pattern.values(ground_dampers(system, parts))
        )
        self.mass = self.pattern.csr(self._mass_values, self._lumped)
        self.damping = self.pattern.csr(self._damping_values, a_r * self._lumped)
        self._lumped_damping = a_r * self._lumped

    def effective_band(self, parts: PartMatrices, c: float, k: float) -> Array:
        """Return ``M + c C + k K`` for a tangent K, ties damped like ``b_R K``."""
        tie = k + c * self._system.damping.stiffness
        scaled = parts.scaled(cables=k, ties=tie, clamps=k, stays=k, grounds=k)
        values = self._mass_values + c * self._damping_values + self.pattern.values(scaled)
        return self.pattern.upper_band(values, self._lumped + c * self._lumped_damping)


@dataclass(frozen=True)
class FactorPlace:
    """Which kept factor serves a time step.

    Attributes
    ----------
    number : int
        j of the factored step ``dt_0 2^(-j/4)``.
    factored_step : float s
        At least the step itself.
    scale : float
        Makes up for the longer step: ``2/(1 + (dt/g)^2)``.
    """

    number: int
    factored_step: float
    scale: float


def factor_place(time_step: float, base_step: float) -> FactorPlace:
    """Return which factor serves a step [s], given the step ``dt_0`` [s]."""
    number = floor(_STEPS_PER_OCTAVE * log2(base_step / time_step) + _SAME)
    factored = base_step * 2.0 ** (-number / _STEPS_PER_OCTAVE)
    share = (time_step / factored) ** 2
    return FactorPlace(number, factored, 1.0 if share > 1.0 - _SAME else 2.0 / (1.0 + share))


@dataclass(frozen=True, eq=False)
class StepFactor:
    """A factored matrix, the state it belongs to, and what it is multiplied with.

    Attributes
    ----------
    cholesky : BandedCholesky
    tangents : (3, n_node)
        Unit tangents of the nodes in that state.
    scale : float
        Makes up for the factor of a longer step.
    """

    cholesky: BandedCholesky
    tangents: Array
    scale: float = 1.0

    def solve(self, r: Array, rotation: NodeRotation) -> Array:
        """Return the approximate solution for a residual ``(n_dof,)``, turned with the wires."""
        x = rotation.forward(self.cholesky.solve(rotation.backward(r)))
        return x if self.scale == 1.0 else self.scale * x


class StepFactors:
    """Factors of the matrix of a line, by time step; the ones used last are kept.

    Parameters
    ----------
    system
        The line.
    matrices
        Its mass, damping and stiffness.
    options
        Integrator, the step ``dt_0``, stiffening.
    """

    def __init__(self, system: System, matrices: LineMatrices, options: StepOptions) -> None:
        self._system, self._matrices = system, matrices
        self._options, self._base = options, options.time_step
        self._kept: OrderedDict[int, StepFactor] = OrderedDict()

    def get(self, time_step: float) -> StepFactor | None:
        """Return a factor for a step, made at the static state when there is none.

        None when the matrix is not positive definite.
        """
        place = factor_place(time_step, self._base)
        if place.number not in self._kept:
            made = self.make(self._system.position, place.factored_step)
            if made is None:
                return None
            self._keep(place.number, made)
        self._kept.move_to_end(place.number)
        return replace(self._kept[place.number], scale=place.scale)

    def renew(self, q: Array, time_step: float) -> StepFactor | None:
        """Return the factor that serves a step, made anew at state ``q`` and kept."""
        place = factor_place(time_step, self._base)
        made = self.make(q, place.factored_step)
        if made is None:
            return None
        self._keep(place.number, made)
        return replace(made, scale=place.scale)

    def make(
        self, q: Array, time_step: float, taut: NDArray[np.bool_] | None = None
    ) -> StepFactor | None:
        """Factor the matrix of a step at state ``q``, with all droppers or the taut ones only."""
        c = StepCoefficients.of(self._options.integrator, time_step)
        system, stiffening = self._system, self._options.stiffening
        if stiffening is not None:
            system = stiffening.applied_to(system, time_step)
        parts = tangent_parts(system, q, taut=taut)
        band = self._matrices.effective_band(
            parts, c.weight * c.to_velocity, c.weight * c.to_position
        )
        factor = BandedCholesky.of(band)
        return None if factor is None else StepFactor(factor, unit_tangents(q))

    def _keep(self, number: int, factor: StepFactor) -> None:
        self._kept[number] = factor
        self._kept.move_to_end(number)
        if len(self._kept) > MOST_FACTORS:
            self._kept.popitem(last=False)
