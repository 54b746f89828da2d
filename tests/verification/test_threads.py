"""Several threads in one time integration: the same bits, whatever happens to the threads."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import tautwire as tw
from tautwire.errors import InputError
from tautwire.model.equations import equations
from tautwire.model.passage import plan_passage
from tautwire.numerics.motion import backend, native_stepper
from tautwire.numerics.motion.dispersion import wave_stiffening
from tautwire.numerics.motion.extrapolated_stepper import ExtrapolatedStepper
from tautwire.numerics.motion.stepper import COUNTED_NOTES, StepOptions, Stepper
from tautwire.numerics.newmark import HHT, Extrapolated, Newmark
from tautwire.status import Status
from tautwire.studies.execution import executor

from ..lines import HAS_CORE, RUNNABLE, ac_simple, entering

pytestmark = pytest.mark.skipif(not HAS_CORE, reason="no compiled core here")

ROOT = Path(__file__).parents[2]
SHARED = 5
"""Pieces of work that threads share in a step, at least: four in an iteration, one in a record."""
LINES: dict[str, dict[str, Any]] = {
    "ac-simple-plane": {"line.spans": 10, "settings.nodes_between_droppers": 9},
    "ac-stitched": {"settings.nodes_between_droppers": 5},
    "dc-twin": {"settings.nodes_between_droppers": 5},
    "compound": {"settings.nodes_between_droppers": 5},
}


def stepper_of(name: str, threads: int, **options: Any) -> Stepper:
    """Return the time integration of a library line whose rows are divided among threads."""
    case = tw.load_case(name, LINES[name])
    model = tw.build(case)
    shape = tw.find_shape(model)
    system = equations(model, shape)
    chosen = {"integrator": Newmark(), "time_step": 1e-3, "tolerance": 3e-8} | options
    chosen["contact_stiffness"] = case.settings.contact_stiffness
    if chosen.pop("stiffened", False):
        chosen["stiffening"] = wave_stiffening(system, chosen["integrator"])
    pantographs = plan_passage(model, shape, case.uplift_forces()).pantographs
    with backend.sharing(threads):
        made = backend.make_stepper(
            system, pantographs, StepOptions(**chosen), np.array([2, 14]), "native"
        )
    assert made.counters.notes["threads"] == threads
    return made


def helped_parts(stepper: Stepper) -> int:
    """Return how many parts of the work so far were done by another than the calling thread."""
    return stepper.counters.notes["helped_parts"]


def helped_stepper(name: str, **options: Any) -> Stepper:
    """Return the same time integration, whose second thread does every second part.

    Else the first one does most of both where other processes keep the processors busy.
    """
    usual = native_stepper._scheme
    with pytest.MonkeyPatch.context() as patch:
        awaiting = {"awaits_helpers": True}
        patch.setattr(native_stepper, "_scheme", lambda *given: usual(*given) | awaiting)
        return stepper_of(name, 2, **options)


def history(stepper: Stepper, steps: int, *size: float) -> NDArray[np.float64]:
    """Take steps and return contact and dropper forces and the coordinates at the end."""
    block = stepper.advance(steps, *size)
    assert block.status is Status.RUNNING
    parts = (block.contact_force, block.dropper_force, stepper.coordinates)
    return np.concatenate([part.ravel() for part in parts])


@pytest.mark.parametrize("kernels", RUNNABLE)
def test_every_kernel_gives_the_same_bits(kernels: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two threads and one give the same numbers bit by bit, also in steps of another size."""
    monkeypatch.setenv("TAUTWIRE_SIMD", kernels)
    one = stepper_of("ac-simple-plane", 1, stiffened=True)
    two = helped_stepper("ac-simple-plane", stiffened=True)
    for steps, *size in ((120,), (13, 2.3e-4), (40,)):
        assert np.array_equal(history(one, steps, *size), history(two, steps, *size))
    assert helped_parts(one) == 0
    assert helped_parts(two) >= SHARED * (120 + 13 + 40)


@pytest.mark.parametrize("name", [name for name in LINES if name != "ac-simple-plane"])
def test_every_topology_gives_the_same_bits(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """So it is with stitch wires, two contact wires and an auxiliary wire."""
    monkeypatch.setenv("TAUTWIRE_SIMD", RUNNABLE[-1])  # narrow registers: many rows
    one, two = stepper_of(name, 1), helped_stepper(name)
    assert np.array_equal(history(one, 60), history(two, 60))
    assert helped_parts(two) >= SHARED * 60


@pytest.mark.parametrize(
    "options",
    [{"full_newton": True}, {"integrator": HHT(-0.1)}, {"time_step": 3e-3}, {"time_step": 1e-2}],
    ids=["full Newton", "HHT", "3 ms", "10 ms"],
)
def test_every_way_of_stepping_gives_the_same_bits(options: dict[str, Any]) -> None:
    """So it is with full Newton, HHT and with long steps, whose influence reaches far."""
    one = stepper_of("ac-simple-plane", 1, **options)
    two = helped_stepper("ac-simple-plane", **options)
    assert np.array_equal(history(one, 5), history(two, 5))
    assert helped_parts(two) >= SHARED * 5


@pytest.mark.slow
def test_many_repeats_give_the_same_bits() -> None:
    """500 times the same 12 steps by two threads that share them as it comes, from the same state,
    and more until both have done some."""
    stepper = stepper_of("ac-simple-plane", 2)
    stepper.advance(100)
    mark = stepper.mark()
    first = history(stepper, 12)
    repeats, latest = 0, time.monotonic() + 60.0
    while repeats < 500 or helped_parts(stepper) == 0:
        assert time.monotonic() < latest, f"{repeats} repeats, {helped_parts(stepper)} parts helped"
        stepper.rewind(mark)
        assert np.array_equal(history(stepper, 12), first)
        repeats += 1


FORK = """
import os, sys, time, warnings
import numpy as np
from tests.verification.test_threads import helped_parts, history, stepper_of
warnings.simplefilter("ignore")
stepper = stepper_of("ac-simple-plane", 2)
stepper.advance(40)
mark = stepper.mark()
here = history(stepper, 40)
while helped_parts(stepper) == 0:
    stepper.rewind(mark)
    assert np.array_equal(history(stepper, 40), here)
child = os.fork()
if child == 0:
    helped = helped_parts(stepper)
    time.sleep(0.6)  # longer than kReview in team.cpp: alone and with helpers are tried in turn
    same = True
    for _ in range(2):
        stepper.rewind(mark)
        same &= np.array_equal(history(stepper, 40), here)
    same &= helped_parts(stepper) == helped
    del stepper
    os._exit(0 if same else 1)
_, status = os.waitpid(child, 0)
stepper.rewind(mark)
assert np.array_equal(history(stepper, 40), here)
sys.exit(os.waitstatus_to_exitcode(status))
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system does not fork")
def test_a_forked_process_goes_on_alone() -> None:
    """A process forked after helpers have worked, in which none lives, gets the same numbers and
    does not wait."""
    done = subprocess.run([sys.executable, "-c", FORK], cwd=ROOT, timeout=120, check=False)
    assert done.returncode == 0


def test_a_short_line_has_one_thread() -> None:
    """A line that is not divided takes one thread, however many it may use, and says so."""
    system, pantographs = entering(ac_simple(line__spans=2, settings__section=(1, 1)))
    options = StepOptions(Newmark(), 1e-3, 2e5, tolerance=3e-8)
    with backend.sharing(2):
        stepper = backend.make_stepper(system, pantographs, options, np.array([2]), "native")
    stepper.advance(20)
    assert stepper.counters.notes["threads"] == 1
    assert helped_parts(stepper) == 0


def test_accurate_steps_count_work_and_name_threads() -> None:
    """Of the parts of an extrapolated step work is summed up, the largest increment is the larger
    one, and the threads are those of each."""
    for threads in (1, 2):
        stepper = stepper_of("ac-simple-plane", threads, integrator=Extrapolated())
        assert isinstance(stepper, ExtrapolatedStepper)
        stepper.advance(12)
        own = [part.counters.notes for part in stepper.parts]
        found = stepper.counters.notes
        for name in COUNTED_NOTES:
            assert found[name] == sum(notes[name] for notes in own)
        assert found["solved_rows"] > max(notes["solved_rows"] for notes in own)
        assert found["overlooked"] == max(notes["overlooked"] for notes in own)
        assert found["threads"] == threads


def test_one_thread_unless_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    """One thread by default and in workers of studies; the environment comes before all."""
    monkeypatch.delenv(backend.THREADS_VARIABLE, raising=False)
    assert backend.thread_count() == 1
    with backend.sharing(2):
        assert backend.thread_count() == 2
        monkeypatch.setenv(backend.THREADS_VARIABLE, "1")
        assert backend.thread_count() == 1
    assert executor._environment()[backend.THREADS_VARIABLE] == "1"
    monkeypatch.setenv(backend.THREADS_VARIABLE, "two")
    with pytest.raises(InputError, match="TAUTWIRE_THREADS: got 'two'"):
        backend.thread_count()
