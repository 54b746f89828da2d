"""The bordered system of shape finding: its matrix is the derivative of its residual."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tautwire.analyses.road.shape import RESIDUAL
from tautwire.model.build import build
from tautwire.numerics.statics.form_finding import FormFinder, find_form
from tautwire.status import Status

from ..lines import ac_simple

LENGTHS = [1.029, 0.909, 0.822, 0.772, 0.754, 0.772, 0.822, 0.909, 1.029]
VARIANTS: dict[str, dict[str, Any]] = {
    "spring droppers": {},
    "droppers with EA": {"droppers__stiffness": "200 kN"},
    "given lengths": {"droppers__mode": "length", "droppers__lengths": LENGTHS},
    "arms": {"supports__closure": "arm", "supports__arm": {"angle": "10 deg"}},
    "lift": {"supports__closure": "lift"},
}


def unfolded(band: NDArray[np.float64]) -> NDArray[np.float64]:
    """Turn general banded storage, with room for its factor, into a dense matrix."""
    width, n = (len(band) - 1) // 3, band.shape[1]
    matrix = np.zeros((n, n))
    for offset in range(-width, width + 1):
        row = band[2 * width - offset]
        matrix += np.diag(row[offset:] if offset >= 0 else row[:offset], offset)
    return matrix


@pytest.mark.parametrize("variant", VARIANTS)
def test_bordered_matrix_is_the_derivative_of_the_residual(variant: str) -> None:
    """d(Q - G)/d(q, L0) along random steps of coordinates and lengths equals central differences
    to 1e-6: gravity and dropper stiffness follow the lengths (theory, section 2)."""
    finder = FormFinder(build(ac_simple(line__spans=2, **VARIANTS[variant])).form)
    start = finder.problem.system
    x = np.concatenate([start.position, start.cables.length, start.ties.length])
    matrix = unfolded(finder.bordered_band(finder.unpack(x)))
    rng = np.random.default_rng(41)
    for _ in range(3):
        step = np.where(finder.problem.held & ~finder.replaced, 0.0, rng.normal(size=len(matrix)))
        dx = finder.pack_step(step)
        h = 1e-6
        difference = (finder.residual(x + h * dx) - finder.residual(x - h * dx)) / (2.0 * h)
        assert np.abs(matrix @ step - difference).max() <= 1e-6 * np.abs(difference).max()


@pytest.mark.parametrize("variant", VARIANTS)
def test_prescribed_values_are_kept(variant: str) -> None:
    """Shape finding leaves x of every node and every held coordinate exactly where it was put."""
    problem = build(ac_simple(line__spans=2, **VARIANTS[variant])).form
    form = find_form(problem, RESIDUAL)
    before, after = problem.system.position, form.system.position
    kept = problem.held.copy()
    kept[problem.cable_slot] = True
    kept[problem.tie_slot[problem.tie_slot >= 0]] = True
    assert form.newton.status is Status.DONE
    assert np.array_equal(before[kept], after[kept])
    given = problem.tie_slot < 0
    assert np.array_equal(problem.system.ties.length[given], form.system.ties.length[given])
