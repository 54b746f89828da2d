"""Every line of the library finds its shape, and the page about the library says what it found."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from tautwire.analyses.road.elasticity import elasticity
from tautwire.analyses.road.shape import find_shape
from tautwire.catalogue.entries import list_entries
from tautwire.inputs.load import load_case
from tautwire.model.build import Model, build
from tautwire.model.equations import equations
from tautwire.model.passage import plan_passage
from tautwire.numerics.motion.backend import make_stepper
from tautwire.numerics.motion.dispersion import wave_stiffening
from tautwire.numerics.motion.stepper import StepBlock, StepOptions
from tautwire.numerics.newmark import Newmark
from tautwire.results.equilibrium import Equilibrium

from ..lines import HAS_CORE

CASES = [entry.name for entry in list_entries() if entry.kind == "case"]


@cache
def at_rest(name: str) -> tuple[Model, Equilibrium]:
    """Return a line on a mesh for 50 Hz and its static state."""
    model = build(load_case(name, {"settings.band": 50}))
    return model, find_shape(model)


@cache
def page() -> dict[str, list[str]]:
    """Return the rows of the table on the page by case."""
    text = (Path(__file__).parents[2] / "docs" / "library.md").read_text(encoding="utf-8")
    rows = [[cell.strip() for cell in row.split("|")] for row in text.splitlines()]
    return {row[1].strip("`"): row[2:-1] for row in rows if len(row) > 3 and "`" in row[1]}


@pytest.mark.parametrize("name", CASES)
def test_form_finding(name: str) -> None:
    """Form finding takes at most 12 iterations; the reactions are the weight to 0.01 %."""
    _, shape = at_rest(name)
    assert shape.iterations <= 12
    assert shape.reaction == pytest.approx(shape.weight, rel=1e-4)


@pytest.mark.parametrize("name", CASES)
def test_page_about_the_library(name: str) -> None:
    """Elasticity and its non-uniformity stand on the page, within 1 % and one point."""
    found = elasticity(*at_rest(name))
    *_, extent, nonuniformity, _ = page()[name]
    least, largest = (float(value) for value in re.findall(r"[\d.]+", extent))
    assert 1e3 * found.elasticity.min() == pytest.approx(least, rel=0.01)
    assert 1e3 * found.elasticity.max() == pytest.approx(largest, rel=0.01)
    assert 100.0 * found.nonuniformity == pytest.approx(float(nonuniformity), abs=1.0)


def losses(block: StepBlock) -> int:
    """Return how often contact is lost."""
    lost = block.gap >= 0.0
    return int(np.count_nonzero(lost[1:] & ~lost[:-1]))


@pytest.mark.skipif(not HAS_CORE, reason="no compiled core here")
@pytest.mark.parametrize("name", CASES)
def test_fast_path_against_full_newton(name: str) -> None:
    """The fast path is within 0.02 N rms of full Newton in double precision, with as many losses.

    Where it does not iterate a second time, no increment above the tolerance is left out.
    """
    model, shape = at_rest(name)
    settings, system = model.case.settings, equations(model, shape)
    plan = plan_passage(model, shape, model.case.uplift_forces())
    integrator, blocks = Newmark(), []
    for full, tolerance in ((False, settings.tolerance), (True, 1e-10)):
        options = StepOptions(
            integrator,
            settings.step(),
            settings.contact_stiffness,
            tolerance=tolerance,
            full_newton=full,
            stiffening=wave_stiffening(system, integrator),
        )
        stepper = make_stepper(system, plan.pantographs, options, np.empty(0, np.int64), "native")
        blocks.append(stepper.advance(100))
        if not full:
            assert stepper.counters.iterations < 150
            assert stepper.counters.notes["overlooked"] <= settings.tolerance
    fast, exact = blocks
    error = fast.contact_force - exact.contact_force
    assert np.sqrt(np.mean(error**2, axis=0)).max() <= 0.02
    assert losses(fast) == losses(exact)


def test_page_names_every_case() -> None:
    """The page has one row for each case and no other."""
    assert sorted(page()) == sorted(CASES)
