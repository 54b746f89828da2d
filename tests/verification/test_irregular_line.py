"""Irregular lines: the shape follows errors of installation, the head follows the surface, and the
step controls find what is lost, reproducibly."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import tautwire as tw
from tautwire.analyses.road.dynamics import Simulation
from tautwire.errors import ConvergenceError, ModelError
from tautwire.specs.case import Case

from ..lines import HAS_CORE, ac_simple

Array = NDArray[np.float64]
ROUGH = {
    "unevenness": [
        {
            "kind": "power law",
            "level": 6e-8,
            "reference": 1.0,
            "exponent": 2.0,
            "shortest": 0.3,
            "longest": 6.0,
        }
    ]
}


def irregular(irregularities: Any, **changes: Any) -> Case:
    """Return a short line with irregularities."""
    changes = {"line__spans": 4, "settings__section": [2, 3], "settings__seed": 3, **changes}
    return ac_simple(irregularities=irregularities, **changes)


@cache
def rough(method: str = "constant", seed: int = 3) -> tw.Run:
    """Return a passage along a line whose surface makes the pantograph jump."""
    case = irregular(ROUGH, settings__step_control=method, settings__seed=seed)
    model = tw.build(case)
    return tw.simulate(model, tw.find_shape(model))


def plain(method: str) -> tw.Run:
    """Return the same without wave correction."""
    control = {"method": method, "corrects_waves": False}
    case = irregular(ROUGH, settings__step_control=control)
    model = tw.build(case)
    return tw.simulate(model, tw.find_shape(model))


def test_height_errors_change_the_shape_by_what_was_drawn() -> None:
    """With errors of height the contact wire hangs at every dropper where it should plus what was
    drawn, within 1e-7 m, and dropper forces change."""
    case = irregular({"installation": {"of": "height", "amplitude": 1e-3}})
    model = tw.build(case)
    shape = tw.find_shape(model)
    perfect = tw.find_shape(tw.build(irregular({})))
    errors = model.irregularities.dropper_height
    assert np.abs(errors).max() > 0.9e-3
    assert shape.dropper_heights - perfect.dropper_heights == pytest.approx(errors, abs=1e-7)
    assert np.abs(shape.dropper_forces - perfect.dropper_forces).max() > 5.0
    assert shape.weight == pytest.approx(shape.reaction, abs=0.01)


def test_length_errors_lengthen_the_droppers() -> None:
    """With errors of length the unstrained lengths are those of the perfect line plus what was
    drawn; a longer dropper lets the wire down where it hangs."""
    values = [0.0, 0.0, 0.0, 0.0, 2e-3, 0.0, 0.0, 0.0, 0.0]
    case = irregular({"installation": {"of": "length", "distribution": "table", "values": values}})
    shape = tw.find_shape(tw.build(case))
    perfect = tw.find_shape(tw.build(irregular({})))
    longer = shape.dropper_lengths_unstrained - perfect.dropper_lengths_unstrained
    assert longer == pytest.approx(np.tile(values, 4), abs=1e-9)
    sunk = (shape.dropper_heights - perfect.dropper_heights)[4::9]
    assert np.all((sunk < -0.5e-3) & (sunk > -2e-3))


def test_length_errors_agree_with_length_mode() -> None:
    """The same errors of length, drawn in mode 'height' or added to the lengths of mode 'length',
    give the same shape within 1e-7 m."""
    errors = {"installation": {"of": "length", "amplitude": 1e-3}}
    by_height = tw.find_shape(tw.build(irregular(errors)))
    lengths = tw.find_shape(tw.build(irregular({}))).dropper_lengths_unstrained.reshape(4, 9)
    droppers = {
        "droppers__mode": "length",
        "droppers__length_kind": "unstrained",
        "droppers__lengths": lengths.tolist(),
    }
    by_length = tw.find_shape(tw.build(irregular(errors, **droppers)))
    assert by_height.dropper_heights == pytest.approx(by_length.dropper_heights, abs=1e-7)


def test_a_draw_that_needs_a_pushing_dropper_is_refused() -> None:
    """A draw that no tension-only dropper can hold is refused with dropper, place and cure, and
    the same draw as errors of length is allowed: a dropper hangs slack."""
    errors = {"of": "height", "amplitude": 20e-3}
    with pytest.raises(ModelError) as caught:
        tw.find_shape(tw.build(irregular({"installation": errors})))
    told = str(caught.value)
    assert "of span" in told
    assert "would have to push" in told
    assert "irregularities.installation" in told
    slack = tw.find_shape(tw.build(irregular({"installation": {**errors, "of": "length"}})))
    assert slack.dropper_forces.min() <= 0.0


def test_unevenness_leaves_the_static_shape_alone() -> None:
    """The running surface acts between wire and head only: shape and elasticity do not change."""
    bump = {"unevenness": [{"kind": "bump", "position": 80.0, "length": 2.0, "rise": -4e-3}]}
    uneven = tw.find_shape(tw.build(irregular(bump)))
    even = tw.find_shape(tw.build(irregular({})))
    assert np.array_equal(uneven.position, even.position)


def test_contact_follows_the_surface() -> None:
    """A surface that hangs down by 4 mm presses the head down where it passes: nothing changes
    before, force and penetration are stiffness times (head - wire - surface)."""
    bump = {"unevenness": [{"kind": "bump", "position": 80.0, "length": 2.0, "rise": -4e-3}]}
    runs = []
    for irregularities in ({}, bump):
        model = tw.build(irregular(irregularities))
        runs.append(tw.simulate(model, tw.find_shape(model)))
    even, uneven = (run.pantographs[0] for run in runs)
    before = even.position < 79.0 - 0.1
    inside = np.abs(even.position - 80.0) < 1.0
    change = uneven.contact_force - even.contact_force
    assert np.abs(change[before]).max() < 1e-6
    assert np.abs(change[inside]).max() > 100.0
    surface = -4e-3 * (0.5 + 0.5 * np.cos(np.pi * (uneven.position - 80.0)))
    head = runs[1].equilibrium
    assert head.support_x[-1] == pytest.approx(220.0)
    start = uneven.wire_height + np.where(inside, surface, 0.0) - uneven.gap
    assert np.ptp(start - uneven.stage_heights[:, 0]) < 1e-6


@pytest.mark.parametrize("method", ["constant", "variable", "adaptive"])
def test_same_seed_same_run(method: str) -> None:
    """The same case gives the same forces, events and irregularities to the last bit."""
    one = rough(method)
    rough.cache_clear()
    two = rough(method)
    assert one is not two
    assert one.irregularities is not None
    assert two.irregularities is not None
    assert one.pantographs[0].contact_force.tobytes() == two.pantographs[0].contact_force.tobytes()
    surface = two.irregularities.surface_height
    assert one.irregularities.surface_height.tobytes() == surface.tobytes()
    assert (one.events is None) == (method == "constant")
    if one.events is not None and two.events is not None:
        assert one.events.time.tobytes() == two.events.time.tobytes()
    assert tw.contact_loss(one)[0].count > 3


def test_another_seed_is_another_line() -> None:
    """Another seed gives other losses."""
    assert not np.array_equal(
        rough(seed=3).pantographs[0].contact_force, rough(seed=4).pantographs[0].contact_force
    )


FINGERPRINT = """
import hashlib, sys
from tests.verification.test_irregular_line import rough
run = rough("adaptive")
data = run.pantographs[0].contact_force.tobytes() + run.events.time.tobytes()
data += run.equilibrium.position.tobytes() + run.irregularities.surface_height.tobytes()
print(hashlib.sha256(data).hexdigest())
"""


def test_number_of_threads_changes_nothing(pytestconfig: pytest.Config) -> None:
    """One or two threads of BLAS and OpenMP: shape, irregularities, forces and events agree to the
    last bit."""
    prints = []
    for threads in ("1", "2"):
        names = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
        done = subprocess.run(
            [sys.executable, "-c", FINGERPRINT],
            env={**os.environ, **dict.fromkeys(names, threads)},
            cwd=pytestconfig.rootpath,
            capture_output=True,
            text=True,
            check=True,
        )
        prints.append(done.stdout.strip())
    assert len(prints[0]) == 64
    assert prints[0] == prints[1]


def test_variable_step_is_interpolation_of_its_own_constant_run() -> None:
    """What the paper's step adds: along a surface with 59 losses its durations are those that
    straight lines read from a constant step of the same size, within 0.1 ms in the median and
    within 0.2 ms for four losses of five; none of 1 ms or more is missed or new. In the paper's
    plain scheme: with the wave correction one loss of 1.9 ms falls into another step."""
    constant, variable = plain("constant"), plain("variable")
    match = tw.compare_losses({"variable": variable, "constant": constant}).matches[0]
    changes = np.abs([pair.difference for pair in match.pairs])
    assert variable.time == pytest.approx(constant.time, abs=1e-9)
    assert len(changes) > 50
    assert np.median(changes) < 0.1e-3
    assert np.mean(changes < 0.2e-3) > 0.8
    assert not match.missed
    assert not match.spurious


def test_adaptive_step_is_closer_to_a_fine_one_and_misses_nothing() -> None:
    """Against a constant step of 0.1 ms: the adaptive step misses and invents no loss of 1 ms or
    more, and its median error of duration is below 5 % and below half that of the constant 1 ms."""
    case = irregular(ROUGH, settings__time_step=1e-4)
    model = tw.build(case)
    fine = tw.simulate(model, tw.find_shape(model))
    runs = {"constant": rough(), "adaptive": rough("adaptive"), "fine": fine}
    coarse, adaptive = tw.compare_losses(runs).matches
    assert not adaptive.missed
    assert not adaptive.spurious
    assert len(adaptive.judged) >= 3
    assert adaptive.median_error < 0.05
    assert adaptive.median_error < 0.5 * coarse.median_error


@pytest.mark.parametrize("method", ["variable", "adaptive"])
def test_event_storm_ends_with_a_clear_status(method: str) -> None:
    """A surface that throws the pantograph off again and again ends the run after the given number
    of losses, with reason and cure and everything up to there; there is no endless loop."""
    storm = {"unevenness": [{"kind": "uniform", "spacing": 0.2, "amplitude": 20e-3}]}
    control = {"method": method, "most_losses": 20}
    case = irregular(storm, settings__step_control=control, settings__section=[1, 4])
    model = tw.build(case)
    with pytest.raises(ConvergenceError, match="following every loss is pointless") as caught:
        tw.simulate(model, tw.find_shape(model))
    assert "most_losses" in str(caught.value)
    partial = caught.value.partial
    assert isinstance(partial, tw.Run)
    assert partial.status == "failed"
    assert partial.events is not None
    assert 21 <= partial.events.opens.sum() < 60
    assert 0.0 < partial.time[-1] < 2.0


@pytest.mark.skipif(not HAS_CORE, reason="needs the compiled core")
@pytest.mark.parametrize("method", ["variable", "adaptive"])
def test_both_backends_find_the_same_events(method: str) -> None:
    """Compiled core and NumPy reference divide the same steps and find the same instants, within
    1e-6 s for the first few (both solve displacements to 1e-7 m)."""
    found = []
    for backend in ("native", "reference"):
        case = irregular(
            ROUGH,
            line__spans=2,
            settings__section=[1, 1],
            settings__step_control=method,
            settings__backend=backend,
            settings__nodes_between_droppers=2,
        )
        model = tw.build(case)
        run = tw.simulate(model, tw.find_shape(model), watch=lambda p: p.time > 0.45)
        assert run.events is not None
        found.append(run.events)
    count = min(4, len(found[0].time))
    assert count >= 2
    assert found[0].time[:count] == pytest.approx(found[1].time[:count], abs=1e-6)


def test_step_control_of_the_case_is_recorded() -> None:
    """What the case asks for is what runs, and the run says so with its numbers."""
    case = irregular(
        {}, settings__step_control={"method": "adaptive", "duration_tolerance": 0.05e-3}
    )
    model = tw.build(case)
    stepping = Simulation(model, tw.find_shape(model)).stepping
    assert stepping == tw.AdaptiveStep(1e-3, tolerance=0.05e-3, most_losses=500)
    counters = rough("adaptive").counters
    assert counters["step_control"].startswith("adaptive step from 0.5 ms")
    assert counters["windows"] > 0
    assert json.dumps(counters["refined_s"])
