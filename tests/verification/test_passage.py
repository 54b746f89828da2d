"""The passage of a pantograph: fast against full Newton, mirrored lines, conventions."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tautwire.numerics.elements import ancf
from tautwire.numerics.elements.hermite import derivative_tables
from tautwire.numerics.elements.quadrature import gauss_unit
from tautwire.numerics.motion.stepper import StepBlock
from tautwire.status import Status

from ..lines import ac_simple, passage

Array = NDArray[np.float64]
STEPS = 200
SHORT: dict[str, Any] = {"line__spans": 2, "settings__section": (1, 1)}

UNEQUAL: dict[str, Any] = {
    "line__span_length": [50.0, 63.0, 44.0],
    "droppers__positions": [
        [4.0, 14.0, 25.0, 36.0, 46.0],
        [4.5, 15.0, 26.0, 37.0, 48.0, 58.5],
        [5.0, 14.0, 22.0, 30.0, 39.0],
    ],
    "droppers__presag": [
        [0.0, 0.02, 0.03, 0.021, 0.0],
        [0.0, 0.02, 0.035, 0.03, 0.02, 0.0],
        [0.0, 0.015, 0.02, 0.012, 0.0],
    ],
    "supports__contact_stagger": [0.2, -0.25, 0.15, -0.2],
    "supports__contact_height": [5.3, 5.31, 5.29, 5.3],
    "supports__encumbrance": [1.2, 1.25, 1.2, 1.15],
}


def run(steps: int = STEPS, *, full: bool = False, tolerance: float = 1e-12, **changes: Any) -> Any:
    """Return the histories of a passage that goes well."""
    stepper = passage(ac_simple(**changes), full_newton=full, tolerance=tolerance)
    block: StepBlock = stepper.advance(steps)
    assert block.status is Status.RUNNING
    assert len(block.time) == steps
    return block


@cache
def reference() -> StepBlock:
    """Return the passage over the first 18 m of two spans, solved to 1e-12 m."""
    return run(**SHORT)


def reversed_line() -> dict[str, Any]:
    """Return the unequal line seen from its other end, run in the other direction."""
    lengths = UNEQUAL["line__span_length"]
    positions = zip(lengths, UNEQUAL["droppers__positions"], strict=True)
    return {
        "line__span_length": lengths[::-1],
        "droppers__positions": [[a - v for v in row[::-1]] for a, row in positions][::-1],
        "droppers__presag": [row[::-1] for row in UNEQUAL["droppers__presag"][::-1]],
        **{name: UNEQUAL[name][::-1] for name in UNEQUAL if name.startswith("supports")},
        "scenario__direction": "-x",
    }


# ---- the solver ---------------------------------------------------------------------------------


def test_modified_newton_equals_full_newton() -> None:
    """Solved to 1e-12 m, the fast path and full Newton give the same contact force to 1e-4 N, with
    droppers going slack on the way."""
    fast, full = reference(), run(full=True, **SHORT)
    assert (fast.dropper_force == 0.0).any()
    assert fast.contact_force == pytest.approx(full.contact_force, abs=1e-4)
    assert fast.dropper_force == pytest.approx(full.dropper_force, abs=1e-3)


def test_default_tolerance_is_invisible() -> None:
    """At the default tolerance of 3e-8 m the algebraic error of the contact force is at most
    0.1 N rms (theory, section 8)."""
    tolerance = ac_simple().settings.tolerance
    coarse = run(tolerance=tolerance, **SHORT)
    error = coarse.contact_force - reference().contact_force
    assert tolerance == 3e-8
    assert float(np.sqrt((error**2).mean())) <= 0.1


def test_few_iterations_per_step() -> None:
    """At the default tolerance the fast path needs at most three iterations per step on average
    and never factors anew on this line."""
    stepper = passage(ac_simple(**SHORT))
    stepper.advance(STEPS)
    assert stepper.counters.steps == STEPS
    assert stepper.counters.iterations <= 3 * STEPS
    assert stepper.counters.refactorisations == 0


def test_blocks_do_not_matter() -> None:
    """Advancing in one call or in many gives the very same histories."""
    stepper = passage(ac_simple(**SHORT), tolerance=1e-12)
    parts = [stepper.advance(n) for n in (1, 7, 92, 100)]
    forces = np.concatenate([p.contact_force for p in parts])
    assert np.array_equal(forces, reference().contact_force)
    assert stepper.time == pytest.approx(0.2)


def test_leaving_the_line_is_reported() -> None:
    """A pantograph that runs off the wire ends the integration within one step of the end."""
    case = ac_simple(**SHORT, settings__start=50.0, settings__time_step=4e-3)
    stepper = passage(case)
    block = stepper.advance(300)
    reached = 50.0 + stepper.time * case.scenario.speed
    assert block.status is Status.OFF_THE_LINE
    assert len(block.time) == stepper.counters.steps
    assert 110.0 - 4e-3 * case.scenario.speed <= reached <= 110.0


def test_time_step_converges() -> None:
    """Halving the step halves the error of the contact force at least (contact and slackening cost
    the second order): differences against 0.25 ms fall monotonically."""
    fine = run(240, **SHORT, settings__time_step=2.5e-4)
    errors = []
    for factor in (4, 2):
        dt = 2.5e-4 * factor
        steps = 240 // factor
        coarse = run(steps, **SHORT, settings__time_step=dt)
        error = coarse.contact_force[:, 0] - fine.contact_force[factor - 1 :: factor, 0]
        errors.append(float(np.sqrt((error**2).mean())))
    assert errors[1] <= 0.5 * errors[0]
    assert errors[0] <= 10.0


# ---- symmetry -----------------------------------------------------------------------------------


@cache
def unequal() -> StepBlock:
    """Return the passage over the start of the unequal line."""
    return run(**UNEQUAL)


def test_line_mirrored_in_y() -> None:
    """A line with all staggers of the other sign gives the same forces and heights to rounding."""
    ahead = unequal()
    stagger = [-v for v in UNEQUAL["supports__contact_stagger"]]
    mirrored = run(**{**UNEQUAL, "supports__contact_stagger": stagger})
    assert mirrored.contact_force == pytest.approx(ahead.contact_force, abs=1e-6)
    assert mirrored.observed == pytest.approx(ahead.observed, abs=1e-10)


def test_line_mirrored_in_x_runs_in_the_other_direction() -> None:
    """A line seen from its other end and run in direction -x gives the same forces, dropper forces
    and uplifts in reversed order, to rounding."""
    ahead, back = unequal(), run(**reversed_line())
    assert ahead.contact_force.max() > 150.0
    assert back.contact_force == pytest.approx(ahead.contact_force, abs=1e-6)
    assert back.stages == pytest.approx(ahead.stages, abs=1e-10)
    assert back.observed[:, ::-1] == pytest.approx(ahead.observed, abs=1e-10)
    assert back.dropper_force[:, ::-1] == pytest.approx(ahead.dropper_force, abs=1e-5)


# ---- conventions --------------------------------------------------------------------------------


def patch_gauss_points(monkeypatch: pytest.MonkeyPatch, count: int) -> None:
    """Let the wire element use another number of Gauss points."""
    points, weights = gauss_unit(count)
    first, second = derivative_tables(points)
    for name, value in {
        "QUADRATURE_POINTS": count,
        "_POINTS": points,
        "_WEIGHTS": weights,
        "_FIRST": first,
        "_SECOND": second,
        "_BOTH": np.concatenate([first, second]),
        "_W_FIRST_T": (weights[:, None] * first).T,
        "_W_SECOND_T": (weights[:, None] * second).T,
    }.items():
        assert hasattr(ancf, name)
        monkeypatch.setattr(ancf, name, value)


def test_three_gauss_points_would_do(monkeypatch: pytest.MonkeyPatch) -> None:
    """Three Gauss points instead of five change the contact force by less than 0.1 N (theory,
    section 1); the change is not zero, so the rule is really used."""
    case = {**SHORT, "settings__nodes_between_droppers": 9}
    five = run(100, **case)
    patch_gauss_points(monkeypatch, 3)
    three = run(100, **case)
    change = np.abs(three.contact_force - five.contact_force).max()
    assert 0.0 < change < 0.1


def test_weighted_ends_run() -> None:
    """With weights at both ends the wire ends move along the track, and the force differs from
    the anchored one only after a longitudinal wave has come back from the end."""
    stepper = passage(ac_simple(**SHORT, line__ends="weighted"), tolerance=1e-12)
    block = stepper.advance(STEPS)
    change = np.abs(block.contact_force - reference().contact_force)
    end = stepper.coordinates.reshape(-1, 2, 6)[-1, :, 0]
    assert block.status is Status.RUNNING
    assert change.max() > 0.01
    assert np.abs(end - 110.0).max() > 1e-6
    assert np.abs(end - 110.0).max() < 0.05


def test_fixed_messenger_wire_changes_the_passage() -> None:
    """Holding the messenger wire along the track is felt in the contact force."""
    fixed = run(**SHORT, supports__messenger_longitudinal="fixed")
    assert np.abs(fixed.contact_force - reference().contact_force).max() > 1.0


@pytest.mark.parametrize(
    "changes",
    [
        {"line__damping": {"mass": 0.0, "stiffness": 0.0}},
        {"droppers__stiffness": 1e7},
        {"droppers__stiffness": "200 kN"},
        {"settings__contact_stiffness": 2e6},
        {"supports__closure": "spring", "supports__spring": {"stiffness": 300.0}},
        {"supports__closure": "spring", "supports__spring": {"stiffness": 0.0, "mass": 1.0}},
    ],
    ids=["undamped", "stiff droppers", "droppers with EA", "stiff contact", "springs", "dead load"],
)
def test_extreme_lines_agree_with_full_newton(changes: dict[str, Any]) -> None:
    """Zero damping, stiff droppers, stiff contact and spring supports run, and give the force that
    full Newton gives to 1e-3 N."""
    fast = run(80, **SHORT, **changes)
    full = run(80, full=True, **SHORT, **changes)
    assert fast.contact_force.max() > 20.0
    assert fast.contact_force == pytest.approx(full.contact_force, abs=1e-3)


@pytest.mark.parametrize("wires", [("messenger",), ("contact",), ("messenger", "contact")])
def test_wires_without_bending_stiffness(wires: tuple[str, ...]) -> None:
    """A rope without bending stiffness is the limit of one that bends ever more easily: from 1e-3
    N m^2 to none the contact force changes by less than 1e-3 N, where 195 N m^2 are worth more
    than 1e-2 N."""

    def force(stiffness: float) -> Array:
        changes = {f"wires__{name}__bending_stiffness": stiffness for name in wires}
        return np.asarray(run(**SHORT, **changes).contact_force)

    limp, supple = force(0.0), force(1e-3)
    assert np.abs(limp - supple).max() < 1e-3
    assert np.abs(limp - reference().contact_force).max() > 1e-2


def test_damping_follows_its_coefficients() -> None:
    """More stiffness-proportional damping smooths the contact force (theory, section 4)."""
    smooth = run(**SHORT, line__damping={"mass": 0.0125, "stiffness": 5e-4})
    spread = [np.std(np.diff(b.contact_force[100:, 0])) for b in (reference(), smooth)]
    assert spread[1] < 0.9 * spread[0]
