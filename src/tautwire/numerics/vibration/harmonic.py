"""Harmonic response of a line about its static state: ``(K + i w C - w^2 M) u = f``."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tautwire.numerics.elements.bar import bar_tangent
from tautwire.numerics.network.banded import Pattern
from tautwire.numerics.network.system import (
    System,
    ground_dampers,
    lumped_mass,
    mass_parts,
    tangent_parts,
)
from tautwire.numerics.vibration.eigen import BandedLU

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


class HarmonicLine:
    """A line that vibrates a little about its static state, all droppers taut.

    ``C = a_R M + b_R K0`` plus the support dampers; of the droppers only the part along their
    axis is damped, as in the time integration.

    Parameters
    ----------
    system
        The line; ``system.position`` is its static state.
    """

    def __init__(self, system: System) -> None:
        self._pattern = Pattern(system)
        parts = tangent_parts(system, system.position)
        state = system.ties.state(system.position)
        axial = bar_tangent(state, system.ties.stiffness, np.zeros(len(state.length)))
        proportional = replace(parts.scaled(cables=1.0, stays=1.0), ties=axial)
        supports = ground_dampers(system, parts)
        a_r, b_r = system.damping.mass, system.damping.stiffness
        values = self._pattern.values
        self._stiffness, self._mass = values(parts), values(mass_parts(system))
        self._damping = a_r * self._mass + b_r * values(proportional) + values(supports)
        self._lumped = lumped_mass(system)
        self._lumped_damping = a_r * self._lumped
        self._free = ~np.asarray(system.fixed)

    def dynamic_stiffness(self, omega: float) -> Complex:
        """Return ``K + i w C - w^2 M`` in upper banded storage (held rows: the identity)."""
        band = self._pattern.upper_band
        real = band(self._stiffness - omega**2 * self._mass, -(omega**2) * self._lumped)
        imaginary = band(omega * self._damping, omega * self._lumped_damping)
        imaginary[-1, ~self._free] = 0.0
        return real + 1j * imaginary

    def receptances(self, loads: Array, omega: float) -> Complex:
        """Return the response of each load's own point, ``load' (K + i w C - w^2 M)^-1 load``.

        Parameters
        ----------
        loads : (n_dof, n_point)
            Unit forces.
        omega
            Angular frequency [1/s].

        Returns
        -------
        (n_point,) m/N

        Raises
        ------
        ValueError
            When the line is undamped and `omega` is one of its modes.
        """
        factor = BandedLU.of(self.dynamic_stiffness(omega))
        if factor is None:
            raise ValueError(f"an undamped mode lies exactly at {omega:g} 1/s")
        given = np.where(self._free[:, None], loads, 0.0)
        response = factor.solve(given.astype(np.complex128))
        return np.sum(given * response, axis=0)
