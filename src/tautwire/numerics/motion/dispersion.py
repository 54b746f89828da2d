"""The stiffness that makes up for waves slowed down by the time step.

Time integration with the step dt lowers the frequency w of a free vibration to
``w (1 - kappa w^2 dt^2 / 2)``: it integrates ``M q'' + kappa dt^2 M q'''' + K q = F`` (primes are
time derivatives). On a wire under the tension T with the mass m per length, free waves obey
``m q'' = T q_xx``, so that the extra term is ``kappa dt^2 T^2/m q_xxxx``: the step takes bending
stiffness away. Adding

    EI_dt = kappa dt^2 T^2 / m,    kappa = beta - 1/12 - alpha^2

gives it back. What remains are the terms of higher order and the second-order error at the points
where forces act. The static state stays in balance: loads make up for its curvature.

Near the speed of the train this matters: waves that run ahead of the pantograph have a small
velocity relative to it, which a small loss of wave speed changes much.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.elements.hermite import derivative_tables
from tautwire.numerics.network.system import System, internal_force
from tautwire.numerics.newmark import Integrator

Array = NDArray[Any]


@dataclass(frozen=True, eq=False)
class WaveStiffening:
    """Bending stiffness and loads that are added, both per square of the time step.

    Attributes
    ----------
    bending : (n_cable,) N m2/s2
    load : (n_dof,) N/s2, N m/s2
        Keeps the static state in balance.
    """

    bending: Array
    load: Array

    def applied_to(self, system: System, time_step: float) -> System:
        """Return a line as it is to be integrated with a time step [s]."""
        square = time_step**2
        return system.with_(
            cables=system.cables.with_(bending=system.cables.bending + square * self.bending),
            load=system.load + square * self.load,
        )


def wave_stiffening(system: System, integrator: Integrator) -> WaveStiffening:
    """Return what makes up for the loss of wave speed of an integrator.

    Parameters
    ----------
    system
        The line in its static state.
    integrator
        Newmark or HHT.
    """
    kappa = integrator.beta - 1.0 / 12.0 - integrator.alpha**2
    bending = kappa * wire_tension(system) ** 2 / system.cables.mass
    cables = system.cables.with_(bending=system.cables.bending + bending)
    stiffer = system.with_(cables=cables)
    there = internal_force(stiffer, system.position).nodal
    here = internal_force(system, system.position).nodal
    return WaveStiffening(bending, np.where(system.fixed, 0.0, there - here))


def wire_tension(system: System) -> Array:
    """Return the tension in the middle of every wire element, ``(n_cable,)`` [N]."""
    e = system.cables.coordinates(system.position)
    first, _ = derivative_tables(np.array([0.5]))
    secant = (e[2] - e[0]) / system.cables.length
    slope = first[0, 0] * secant + first[0, 1] * e[1] + first[0, 2] * e[3]
    square = np.einsum("in,in->n", slope, slope)
    return system.cables.axial * 0.5 * (square - 1.0) * np.sqrt(square)
