"""Two pantographs on one line: what the leading one feels of the trailing one, and when."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tautwire.analyses.force.statistics import contact_statistics
from tautwire.analyses.road.dynamics import Simulation
from tautwire.analyses.road.pipeline import run_case
from tautwire.errors import ConvergenceError
from tautwire.numerics.motion.stepper import StepBlock
from tautwire.specs.case import Case
from tautwire.specs.scenario import TUNING_TOLERANCE

from ..lines import ac_simple, entering, moved, passage, stepper

Array = NDArray[np.float64]
BEHIND, STEPS = 20.0, 400
COARSE = "coarse passage of the mean-force tuning"


def train(count: int, **changes: Any) -> Case:
    """Return two spans with one or two pantographs 20 m apart at 216 km/h."""
    given = {
        "line__spans": 2,
        "settings__section": (1, 1),
        "settings__contact_stiffness": 5e4,
        "scenario__speed": 60.0,
    }
    case = ac_simple(**{**given, **changes})
    front = case.pantographs[0]
    rear = front.with_(name="rear", behind=BEHIND)
    return case.with_(pantographs=(front, rear)[:count])


@cache
def alone() -> StepBlock:
    """Return the passage of the leading pantograph alone."""
    return passage(train(1), tolerance=1e-11).advance(STEPS)


@cache
def together() -> StepBlock:
    """Return the passage of both."""
    return passage(train(2), tolerance=1e-11).advance(STEPS)


def entry_time() -> float:
    """Return when the trailing pantograph enters [s]."""
    case = train(2)
    return BEHIND / case.scenario.speed


def test_leading_force_is_that_of_the_single_run_until_the_other_touches() -> None:
    """Until the trailing pantograph touches the wire the leading one feels nothing at all."""
    touched = int(np.flatnonzero(together().contact_force[:, 1] > 0.0)[0])
    assert together().time[touched] >= entry_time()
    assert np.array_equal(together().contact_force[:touched, 0], alone().contact_force[:touched, 0])
    assert touched > 320
    assert alone().contact_force[touched - 100 : touched].min() > 1.0


def test_leading_force_until_the_first_wave_can_arrive() -> None:
    """The first wave that can arrive is a longitudinal one, sqrt(EA/m) = 3.3 km/s, 6 ms for
    20 m. Until then the leading force differs by less than 0.01 N, and not by nothing only because
    an implicit step is felt everywhere."""
    touched = int(np.flatnonzero(together().contact_force[:, 1] > 0.0)[0])
    wave = BEHIND / np.sqrt(15e6 / 1.35)
    before = together().time < together().time[touched] + wave
    change = np.abs(together().contact_force - alone().contact_force[:, :1])[before, 0]
    assert change[touched:].size >= 5
    assert alone().contact_force[before][touched:].min() > 10.0
    assert change.max() < 0.01


def test_trailing_pantograph_has_its_own_history() -> None:
    """The trailing pantograph starts when the train has carried it to the start, with a force of
    its own, and is not a copy of the leading one: the wire moves already."""
    force, dt = together().contact_force, 1e-3
    enters = int(np.ceil(entry_time() / dt))
    assert (force[: enters - 1, 1] == 0.0).all()
    assert np.isnan(together().gap[: enters - 2, 1]).all()
    assert np.isfinite(together().gap[enters:, 1]).all()
    late = force[enters:, 1]
    assert late.max() > 50.0
    assert np.abs(late - force[: len(late), 0]).max() > 1.0


def test_vanishing_second_pantograph_changes_nothing() -> None:
    """A second pantograph that is lowered (below the wire, pulled down) has no contact force and
    leaves the run of the first unchanged to 1e-9."""
    system, (front, rear) = entering(train(2))
    low = moved(
        rear, start_height=rear.start_height - 0.3, stage_forces=np.array([0.0, 0.0, -50.0])
    )
    wire = 6 * system.paths[0].nodes[::20] + 2
    run = stepper(
        system,
        1e-3,
        pantographs=(front, low),
        tolerance=1e-11,
        observed=wire,
        contact_stiffness=5e4,
    )
    both, one = run.advance(STEPS), alone()
    assert (both.contact_force[:, 1] == 0.0).all()
    assert np.abs(both.contact_force[:, 0] - one.contact_force[:, 0]).max() <= 1e-9
    assert np.abs(both.observed - one.observed).max() <= 1e-9


def test_order_of_the_pantographs_does_not_matter() -> None:
    """Exchanging the two in the list exchanges their columns, to rounding."""
    system, (front, rear) = entering(train(2))
    near = moved(rear, start_time=0.05)
    a = stepper(system, 1e-3, pantographs=(front, near), tolerance=1e-11).advance(150)
    b = stepper(system, 1e-3, pantographs=(near, front), tolerance=1e-11).advance(150)
    assert a.contact_force[:, 1].max() > 10.0
    assert b.contact_force[:, ::-1] == pytest.approx(a.contact_force, abs=1e-6)


@pytest.mark.slow
def test_transverse_waves_arrive_later_and_are_larger() -> None:
    """With the messenger wire held along the track, the leading pantograph feels less than a
    quarter of what it feels later until four fifths of the way of the contact wire's transverse
    wave are over (short waves run ahead of it, by bending)."""
    speed, behind, steps = 40.0, 60.0, 2500
    case = ac_simple(
        line__spans=3,
        settings__section=(1, 1),
        scenario__speed=speed,
        supports__messenger_longitudinal="fixed",
    )
    front = case.pantographs[0]
    rear = front.with_(name="rear", behind=behind)
    one = passage(case, tolerance=1e-9).advance(steps)
    two = passage(case.with_(pantographs=(front, rear)), tolerance=1e-9).advance(steps)
    change = np.abs(two.contact_force[:, 0] - one.contact_force[:, 0])
    enters, way = behind / speed, behind / (np.sqrt(22e3 / 1.35) - speed)
    before = change[(two.time > enters) & (two.time < enters + 0.8 * way)]
    after = change[two.time > enters + way]
    assert len(before) > 500
    assert len(after) > 300
    assert np.sqrt((before**2).mean()) < 0.25 * np.sqrt((after**2).mean())


@pytest.mark.parametrize("method", ["constant", "variable", "adaptive"])
@pytest.mark.parametrize("forces", [(150.0, 150.0), (150.0, 0.0), (0.0, 150.0), (0.0, 0.0)])
def test_every_step_control_follows_every_pantograph(
    method: str, forces: tuple[float, float]
) -> None:
    """Whatever the step control and whichever pantograph is lowered, a passage ends with its
    statistics: a lowered pantograph is without contact all the time, in one loss."""
    changes = {"settings__time_step": 2e-3, "settings__step_control": {"method": method}}
    run = run_case(train(2, **changes).with_(**{"scenario.uplift_force": forces}))
    assert run.status == "done"
    for entry, force in zip(contact_statistics(run).pantographs, forces, strict=True):
        loss = entry.contact_loss
        assert loss.percent < 90.0 if force else loss.percent == pytest.approx(100.0)
        assert loss.count > 0 if force else loss.count == 1


@pytest.mark.parametrize("direction", ["+x", "-x"])
@pytest.mark.parametrize("start", [0.0, 0.002, 5.0])
@pytest.mark.parametrize("ends", ["anchored", "weighted"])
def test_passage_from_the_anchor_stays_on_the_wire(start: float, direction: str, ends: str) -> None:
    """A pantograph may start at the anchor itself; the last step ends before the far one, whatever
    the step, and also where a weight lets the end of the wire move."""
    held = {"left": "anchored", "right": ends}
    given = {"settings__start": start, "settings__time_step": 3.3e-3, "line__ends": held}
    run = run_case(train(1, scenario__direction=direction, **given))
    assert run.status == "done"
    position = run.pantographs[0].position
    assert 0.0 < position.min() < position.max() < 110.0
    assert np.ptp(position) > 110.0 - 2.0 * start - 1.0


@pytest.mark.parametrize("guess", [50.0, 128.0, 360.0])
@pytest.mark.parametrize("count", [1, 2])
def test_two_passages_meet_the_force(count: int, guess: float) -> None:
    """From first guesses within a factor of three the second passage has the wanted mean force,
    for each pantograph on its own."""
    given = {"line__spans": 4, "settings__section": (2, 3), "settings__nodes_between_droppers": 5}
    case = train(count, **given)
    run = run_case(case.with_(**{"scenario.mean_force": 120.0, "scenario.uplift_guess": guess}))
    assert run.counters["tuning_passes"] <= 2
    statistics = contact_statistics(run)
    for own in statistics.pantographs:
        assert own.sharp.mean == pytest.approx(120.0, abs=TUNING_TOLERANCE)


def test_right_guess_takes_one_passage() -> None:
    """A guess that is right is kept, here one of 1.6 times the mean force, which a coarse passage
    confirms before the only one on the case's own mesh."""
    case = train(1).with_(**{"scenario.mean_force": 120.0})
    tuned = run_case(case)
    force = tuned.pantographs[0].uplift_force
    watched: set[int | str] = set()
    again = run_case(
        case.with_(**{"scenario.uplift_guess": force}),
        watch=lambda name, _: bool(watched.add(name)),
    )
    assert watched == {COARSE, 1}
    assert again.pantographs[0].uplift_force == force


@pytest.mark.parametrize("stopped_in", [1, COARSE, 2])
def test_stopped_tuning_keeps_the_last_finished_passage(stopped_in: int | str) -> None:
    """A tuning that is stopped in its second passage, or in a coarse one before it, keeps the first
    as a whole; in its first, what there is of it."""
    case = train(1).with_(**{"scenario.mean_force": 120.0, "scenario.uplift_guess": 140.0})
    whole = run_case(case, watch=lambda number, _: number == stopped_in)
    assert whole.status == "partial"
    if stopped_in == 1:
        assert whole.time[-1] < 0.1
        return
    assert whole.counters["tuning_passes"] == 1
    assert whole.time[-1] > 1.5
    assert "after passage 1, which is kept as a whole" in whole.message
    assert "instead of 120.0 N" in whole.message


def test_failed_tuning_keeps_the_last_finished_passage(monkeypatch: pytest.MonkeyPatch) -> None:
    """The same when a later passage fails, and when Ctrl-C comes between two passages; a coarse
    passage that fails only leaves the next force less well known."""
    from tautwire.analyses.road import mean_force

    carried_out, own = mean_force.carried_out, [0]
    case = train(1).with_(**{"scenario.mean_force": 120.0, "scenario.uplift_guess": 140.0})

    def failing(simulation: Simulation, *arguments: Any) -> Any:
        if simulation.model.case != case:
            raise ConvergenceError("coarse passages fail")
        own[0] += 1
        if own[0] == 2:
            raise ConvergenceError("the second passage fails")
        if own[0] == 4:
            raise KeyboardInterrupt
        return carried_out(simulation, *arguments)

    monkeypatch.setattr(mean_force, "carried_out", failing)
    with pytest.raises(ConvergenceError, match=r"second passage fails.*kept as a whole") as caught:
        run_case(case)
    assert caught.value.partial.time[-1] > 1.5
    kept = run_case(case)
    assert kept.status == "partial"
    assert kept.counters["tuning_passes"] == 1
