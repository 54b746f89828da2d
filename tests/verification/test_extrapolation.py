"""Richardson's extrapolation from half and quarter steps: order, sides of contacts, events."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import tautwire as tw
from tautwire.model.resolution import size
from tautwire.numerics.motion import backend
from tautwire.numerics.motion.stepper import StepBlock, StepOptions, Stepper
from tautwire.numerics.network.system import System, weight_load
from tautwire.numerics.newmark import Extrapolated, Integrator, Newmark
from tautwire.status import Status

from ..lines import HAS_CORE, ac_simple, entering, moved, wire_elements

Array = NDArray[Any]
CHOICES = ["native", "reference"] if HAS_CORE else ["reference"]
TWO_SPANS: dict[str, Any] = {"line__spans": 2, "settings__section": (1, 1)}
FINE = 2.5e-4
"""Step whose extrapolation is taken for exact [s]."""


@cache
def whip() -> tuple[System, Array]:
    """Return a soft wire of four elements, pinned at one end, that falls, and its start."""
    wire = wire_elements(np.full(4, 0.25), axial=40.0, bending=0.05, mass=1.0)
    fixed = np.zeros(wire.dof_count, dtype=bool)
    fixed[:3] = True
    return wire.with_(fixed=fixed, load=weight_load(wire, 9.81)), wire.position


def fallen(choice: Any, integrator: Integrator, time_step: float) -> Array:
    """Return where the nodes of the whip are after 0.16 s."""
    system, q = whip()
    options = StepOptions(integrator, time_step, 2e5, tolerance=1e-13)
    run = backend.make_stepper(system, (), options, np.array([2]), choice)
    run.start_from(q, np.zeros(system.dof_count))
    run.advance(round(0.16 / time_step))
    return run.coordinates[system.translations]


@pytest.mark.parametrize("choice", CHOICES)
def test_order_on_a_smooth_motion(choice: Any) -> None:
    """Halving the step divides the error by 2^4, order within 0.15, on a falling wire that turns
    far (self-convergence); plain Newmark with the shortest quarter step stays further off than the
    extrapolation with a step twice as long."""
    ends = [fallen(choice, Extrapolated(), dt) for dt in (4e-3, 2e-3, 1e-3)]
    change = np.linalg.norm(np.diff(ends, axis=0), axis=1)
    assert np.log2(change[0] / change[1]) == pytest.approx(Extrapolated().order, abs=0.15)
    plain = fallen(choice, Newmark(), 0.25e-3)
    assert np.linalg.norm(plain - ends[-1]) > 3.0 * change[1]


@cache
def line() -> tuple[tw.Model, tw.Equilibrium]:
    """Return five spans on which contact is lost and droppers slacken."""
    changes = {
        "line.spans": 5,
        "settings.nodes_between_droppers": 5,
        "settings.contact_stiffness": "200 kN/m",
        "scenario.uplift_force": "174 N",
    }
    model = tw.build(tw.load_case("ac-simple-plane", changes))
    return model, tw.find_shape(model)


@cache
def passed(integrator: Integrator, stepping: Any) -> tw.Run:
    """Return a passage under this line."""
    return tw.simulate(*line(), integrator=integrator, stepping=stepping)


def error(integrator: Integrator, time_step: float) -> float:
    """Return how far the contact force is from the finest extrapolated one [N rms]."""
    ratio = round(1e-3 / time_step)
    own = passed(integrator, tw.ConstantStep(time_step)).pantographs[0].contact_force
    fine = passed(Extrapolated(), tw.ConstantStep(FINE)).pantographs[0].contact_force
    own, exact = own[ratio - 1 :: ratio], fine[3::4]
    count = min(len(own), len(exact))
    middle = slice(count // 5, -count // 5)
    return float(np.sqrt(np.mean((own[:count] - exact[:count])[middle] ** 2)))


def test_error_of_the_force_where_contact_is_lost() -> None:
    """Where contact is lost and droppers slacken, a hundredth of the error of Newmark's steps of
    1 ms is left, and a third of that of 0.25 ms, the shorter of both parts; a quarter of it with
    steps half as long."""
    run = passed(Extrapolated(), tw.ConstantStep(1e-3))
    slack, lost = run.droppers.force == 0.0, run.pantographs[0].contact_force == 0.0
    assert np.count_nonzero(slack.any(axis=0)) > 20
    assert np.count_nonzero(lost[1:] & ~lost[:-1]) >= 3
    found = error(Extrapolated(), 1e-3)
    assert found < error(Newmark(), 1e-3) / 100.0
    assert found < error(Newmark(), 2.5e-4) / 3.0
    assert error(Extrapolated(), 5e-4) < found / 4.0


def test_contact_and_force_agree_at_every_sample() -> None:
    """Contact presses exactly while the gap is negative; nothing pushes that cannot."""
    record = passed(Extrapolated(), tw.ConstantStep(1e-3)).pantographs[0]
    np.testing.assert_array_equal(record.contact_force > 0.0, record.gap < 0.0)
    assert record.contact_force.min() == 0.0


@pytest.mark.parametrize(
    ("stepping", "within"),
    [(tw.VariableStep(1e-3), 0.5e-3), (tw.AdaptiveStep(1e-3), 0.05e-3)],
    ids=["variable", "adaptive"],
)
def test_losses_are_located(stepping: Any, within: float) -> None:
    """Losses last as long as at 0.05 ms: within half a step where they are noticed at samples only,
    within 0.05 ms with the adaptive step."""
    exact = tw.contact_loss(passed(Newmark(), tw.VariableStep(5e-5)))[0].events
    found = tw.contact_loss(passed(Extrapolated(), stepping))[0].events
    assert len(found) == len(exact) == 3
    differences = [a.duration - b.duration for a, b in zip(found, exact, strict=True)]
    assert np.abs(differences).max() <= within


def test_refinement_is_counted() -> None:
    """An adaptive step counts its windows beside the work of both parts."""
    counters = passed(Extrapolated(), tw.AdaptiveStep(1e-3)).counters
    assert counters["windows"] > 0
    assert 0.0 < counters["refined_s"] < counters["simulated_s"]
    assert counters["unsettled_windows"] == 0
    assert counters["steps"] > 6 * len(passed(Extrapolated(), tw.AdaptiveStep(1e-3)).time)


def under_way(choice: Any, **changes: Any) -> Stepper:
    """Return an extrapolated passage of two spans."""
    system, pantographs = entering(ac_simple(**TWO_SPANS))
    given = tuple(moved(p, **changes) for p in pantographs)
    options = StepOptions(Extrapolated(), 1e-3, 2e5, tolerance=3e-8)
    return backend.make_stepper(system, given, options, np.array([2]), choice)


@pytest.mark.parametrize("choice", CHOICES)
def test_marks_and_blocks(choice: Any) -> None:
    """Blocks of any size and steps that are taken back change no bit; both parts are counted, and
    the parts' kernels named."""
    whole = under_way(choice).advance(60)
    stepper = under_way(choice)
    mark = stepper.mark()
    stepper.advance(7, 0.4e-3)
    stepper.rewind(mark)
    parts = StepBlock.joined([stepper.advance(n) for n in (1, 20, 39)], Status.RUNNING)
    np.testing.assert_array_equal(parts.contact_force, whole.contact_force)
    np.testing.assert_array_equal(parts.time, whole.time)
    assert stepper.counters.steps == 6 * (60 + 7)
    assert stepper.time == whole.time[-1]
    assert backend.backend_of(stepper) == backend.backend_name(choice)


@pytest.mark.parametrize("choice", CHOICES)
def test_stop_before_contact_changes(choice: Any) -> None:
    """Asked to, the integration stops before the step in which contact begins or ends, and goes on
    from there as if nothing had been asked."""
    whole = under_way(choice).advance(100)
    touching = whole.gap[:, 0] < 0.0
    change = int(np.flatnonzero(touching[1:] != touching[:-1])[0]) + 1
    stepper = under_way(choice)
    stepper.advance(1)
    block = stepper.advance(100, until_crossing=True)
    assert 1 + len(block.time) == change
    np.testing.assert_array_equal(block.contact_force, whole.contact_force[1:change])
    np.testing.assert_array_equal(block.refused_gap, whole.gap[change])
    again = stepper.advance(5)
    np.testing.assert_array_equal(again.contact_force, whole.contact_force[change : change + 5])


@pytest.mark.parametrize("choice", CHOICES)
def test_leaving_the_wire_is_told(choice: Any) -> None:
    """A pantograph that runs off the end of the wire stops both parts at the same instant."""
    system, _ = entering(ac_simple(**TWO_SPANS))
    end = float(system.position[6 * system.paths[0].nodes[-1]])
    stepper = under_way(choice, start_x=end - 0.5)
    block = stepper.advance(50)
    assert block.status is Status.OFF_THE_LINE
    assert len(block.time) == len(block.contact_force) == 5
    assert stepper.time == pytest.approx(5e-3)


def test_two_pantographs_and_wires() -> None:
    """Two pantographs under two contact wires: what the wires carry adds up to the force on each
    head, and the extrapolated force is near to that of quarter steps."""
    changes = {
        "line.spans": 4,
        "settings.nodes_between_droppers": 4,
        "settings.graded_mesh": False,
        "settings.section": [2, 3],
    }
    case = tw.load_case("dc-twin", changes)
    model = tw.build(case)
    shape = tw.find_shape(model)
    runs = [
        tw.simulate(model, shape, integrator=scheme, stepping=tw.ConstantStep(step))
        for scheme, step in ((Extrapolated(), 1e-3), (Newmark(), 2.5e-4))
    ]
    for own, short in zip(runs[0].pantographs, runs[1].pantographs, strict=True):
        force = own.contact_force[200:]
        near = short.contact_force[3::4][200 : 200 + len(force)]
        assert 0.0 < np.sqrt(np.mean((force[: len(near)] - near) ** 2)) < 2.0


def test_case_chooses_it() -> None:
    """``settings.integrator: extrapolated`` is what ``--accurate`` sets; the run names it, and its
    steps are foretold, six for one."""
    model, shape = line()
    case = model.case.with_(**{"settings.integrator": "extrapolated"})
    assert size(case).steps == 6 * size(model.case).steps
    run = tw.simulate(tw.build(case), shape)
    assert run.counters["integrator"] == Extrapolated().describe()
    own = passed(Extrapolated(), tw.ConstantStep(1e-3))
    np.testing.assert_array_equal(
        run.pantographs[0].contact_force, own.pantographs[0].contact_force
    )
