"""Newmark and HHT-alpha time integration, and what is extrapolated from Newmark's.

With the unknown ``a`` at the end of the step::

    q = q_n + dt v_n + dt^2 ((1/2 - beta) a_n + beta a)
    v = v_n + dt ((1 - gamma) a_n + gamma a)
    M a + (1 + alpha) g(q, v) - alpha g_n = 0,   g = C v + Q(q, v) - load

N. M. Newmark, J. Eng. Mech. Div. ASCE 85 (1959) 67-94; H. M. Hilber, T. J. R. Hughes and
R. L. Taylor, Earthq. Eng. Struct. Dyn. 5 (1977) 283-292, doi:10.1002/eqe.4290050306.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Newmark:
    """Average-acceleration Newmark method (beta 1/4, gamma 1/2): no numerical dissipation."""

    order: int = 2

    @property
    def alpha(self) -> float:
        """HHT parameter; zero for Newmark."""
        return 0.0

    @property
    def beta(self) -> float:
        """Newmark parameter beta."""
        return 0.25

    @property
    def gamma(self) -> float:
        """Newmark parameter gamma."""
        return 0.5

    def describe(self) -> str:
        """Name with parameters, as written to results."""
        return "Newmark (beta 1/4, gamma 1/2)"


@dataclass(frozen=True)
class HHT:
    """HHT-alpha method: second order with dissipation of the highest frequencies.

    Parameters
    ----------
    alpha
        Between -1/3 (most dissipative) and 0 (Newmark).
    """

    alpha: float
    order: int = 2

    def __post_init__(self) -> None:
        if not -1.0 / 3.0 <= self.alpha <= 0.0:
            raise ValueError(f"HHT alpha must lie in [-1/3, 0], got {self.alpha}")

    @property
    def beta(self) -> float:
        """Newmark parameter beta = (1 - alpha)^2 / 4."""
        return 0.25 * (1.0 - self.alpha) ** 2

    @property
    def gamma(self) -> float:
        """Newmark parameter gamma = 1/2 - alpha."""
        return 0.5 - self.alpha

    def describe(self) -> str:
        """Name with parameters, as written to results."""
        return f"HHT-alpha (alpha {self.alpha:g})"


@dataclass(frozen=True)
class Extrapolated:
    """Newmark's method with half and with quarter steps, extrapolated to steps of no length.

    Order 4 where the motion is smooth (:mod:`tautwire.numerics.motion.extrapolated_stepper`).
    """

    base: Newmark = Newmark()
    order: int = 4

    @property
    def alpha(self) -> float:
        """HHT parameter of both parts."""
        return self.base.alpha

    @property
    def beta(self) -> float:
        """Newmark parameter beta of both parts."""
        return self.base.beta

    @property
    def gamma(self) -> float:
        """Newmark parameter gamma of both parts."""
        return self.base.gamma

    def describe(self) -> str:
        """Name with parameters, as written to results."""
        return f"{self.base.describe()}, extrapolated from half and quarter steps"


Integrator = Newmark | HHT | Extrapolated
