"""The damped Newton iteration: quadratic convergence, limited steps, honest failures."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from tautwire.numerics.statics.newton import NewtonResult, NewtonSettings, damped_newton
from tautwire.status import Status

Array = NDArray[np.float64]


def arctan_root(start: float, limit: float, iterations: int = 40) -> NewtonResult:
    """Solve arctan(x) = 0, where plain Newton diverges from |x| > 1.39."""
    return damped_newton(
        np.array([start]),
        np.arctan,
        lambda x, r: -r * (1.0 + x**2),
        np.array([limit]),
        NewtonSettings(1e-10, 1e-10, iterations),
    )


def test_quadratic_convergence() -> None:
    """Near the root of x^2 = 2 each increment is about the square of the one before over 2 x."""
    result = damped_newton(
        np.array([1.5]),
        lambda x: x**2 - 2.0,
        lambda x, r: -r / (2.0 * x),
        np.array([10.0]),
        NewtonSettings(1e-14, 1e-12),
    )
    steps = 10.0 * np.array(result.increments[:4])
    assert result.status is Status.DONE
    assert result.x[0] == pytest.approx(np.sqrt(2.0), rel=1e-15)
    assert np.allclose(steps[1:] / steps[:-1] ** 2, 1.0 / (2.0 * np.sqrt(2.0)), rtol=0.06)


def test_limited_steps_converge_where_plain_newton_diverges() -> None:
    """From x = 3 plain Newton on arctan diverges; with steps of at most 1 it finds the root."""
    damped, plain = arctan_root(3.0, 1.0), arctan_root(3.0, 1e12, 10)
    assert damped.status is Status.DONE
    assert abs(damped.x[0]) <= 1e-10
    assert plain.status is not Status.DONE


def test_no_component_moves_further_than_its_limit() -> None:
    """All components of a step are scaled together so that none exceeds its limit."""
    visited: list[Array] = []

    def direction(x: Array, r: Array) -> Array:
        visited.append(x.copy())
        return -r * np.array([1.0, 100.0])

    damped_newton(
        np.array([1.0, 1.0]),
        lambda x: x,
        direction,
        np.array([0.5, 0.2]),
        NewtonSettings(1e-12, 1e-12, 3),
    )
    step = visited[1] - visited[0]
    assert np.allclose(step, [-0.002, -0.2], rtol=1e-12)


def test_both_conditions_must_hold() -> None:
    """A tiny increment alone is not convergence: the residual counts as well."""
    result = damped_newton(
        np.array([1.0]),
        lambda x: x,
        lambda _x, _r: np.array([1e-12]),
        np.array([1.0]),
        NewtonSettings(1e-6, 1e-6, 5),
    )
    assert result.status is Status.NOT_CONVERGED
    assert result.iterations == 5


def test_singular_tangent_is_reported() -> None:
    """No direction ends the iteration as singular, at the last iterate."""
    result = damped_newton(
        np.array([1.0]), lambda x: x, lambda _x, _r: None, np.ones(1), NewtonSettings(1e-6, 1e-6)
    )
    assert result.status is Status.SINGULAR
    assert result.x[0] == 1.0


def test_not_a_number_is_reported() -> None:
    """A direction that is not finite ends the iteration; the iterate stays finite."""
    result = damped_newton(
        np.array([1.0]),
        lambda x: x,
        lambda _x, _r: np.array([np.nan]),
        np.ones(1),
        NewtonSettings(1e-6, 1e-6),
    )
    assert result.status is Status.NOT_FINITE
    assert np.isfinite(result.x).all()
