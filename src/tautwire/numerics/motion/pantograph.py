"""Lumped-mass pantographs: matrices and exact elimination over a time step.

Stages are numbered from the head; spring and damper of stage i connect it to stage i+1, those of
the last stage to the roof. Displacements count from the starting position.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.newmark import Integrator

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PantographChain:
    """Mass, stiffness and damping of a chain of stages, head first.

    Attributes
    ----------
    mass, stiffness, damping : (n_stage,) kg, N/m, N s/m
    """

    mass: Array
    stiffness: Array
    damping: Array

    @property
    def stage_count(self) -> int:
        """Number of stages."""
        return len(self.mass)

    def chain_matrix(self, element: Array) -> Array:
        """Assemble springs (or dampers) between neighbouring stages, ``(n_stage, n_stage)``."""
        matrix = np.diag(element)
        upper = element[:-1]
        index = np.arange(len(upper))
        matrix[index + 1, index + 1] += upper
        matrix[index, index + 1] -= upper
        matrix[index + 1, index] -= upper
        return matrix


class PantographStep:
    """Advances one pantograph over a step whose contact force is still unknown.

    The equations of the stages are linear, so the head height at the end of the step is exactly
    ``z = z_free - compliance * F`` with the contact force F at the end of the step.

    Parameters
    ----------
    chain
        The pantograph.
    integrator
        Newmark or HHT.
    time_step
        [s]
    """

    def __init__(self, chain: PantographChain, integrator: Integrator, time_step: float) -> None:
        self.chain = chain
        self._integrator = integrator
        self._dt = time_step
        self._k = chain.chain_matrix(chain.stiffness)
        self._c = chain.chain_matrix(chain.damping)
        weight = 1.0 + integrator.alpha
        beta, gamma = integrator.beta, integrator.gamma
        effective = np.diag(chain.mass) + weight * (
            gamma * time_step * self._c + beta * time_step**2 * self._k
        )
        self._inverse = np.linalg.inv(effective)
        self.head_response = self._inverse[:, 0]
        self.compliance = float(weight * beta * time_step**2 * self.head_response[0])

    def internal(self, z: Array, v: Array, external: Array) -> Array:
        """Return ``C v + K z - external``, ``(n_stage,)`` [N], without the contact force."""
        return self._c @ v + self._k @ z - external

    def predict(
        self, z: Array, v: Array, a: Array, g: Array, force: float
    ) -> tuple[Array, Array, Array]:
        """Return displacement and velocity with zero end acceleration, and the known forces.

        Parameters
        ----------
        z, v, a : (n_stage,)
            State at the start of the step.
        g : (n_stage,) N
            ``internal`` at the start of the step.
        force : float N
            Contact force at the start of the step.
        """
        dt, beta, gamma = self._dt, self._integrator.beta, self._integrator.gamma
        z_p = z + dt * v + dt**2 * (0.5 - beta) * a
        v_p = v + dt * (1.0 - gamma) * a
        known = self._integrator.alpha * g
        known[0] += self._integrator.alpha * force
        return z_p, v_p, known

    def acceleration(self, z_p: Array, v_p: Array, known: Array, load: Array) -> Array:
        """Return the end acceleration for external forces ``load`` ``(n_stage,)`` [N]."""
        weight = 1.0 + self._integrator.alpha
        return self._inverse @ (known - weight * self.internal(z_p, v_p, load))
