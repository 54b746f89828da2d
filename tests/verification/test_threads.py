"""Several threads in one time integration: the same bits, whatever happens to the threads."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import tautwire as tw
from tautwire.errors import InputError
from tautwire.model.equations import equations
from tautwire.model.passage import plan_passage
from tautwire.numerics.motion import backend
from tautwire.numerics.motion.dispersion import wave_stiffening
from tautwire.numerics.motion.stepper import StepOptions, Stepper
from tautwire.numerics.newmark import HHT, Newmark
from tautwire.status import Status
from tautwire.studies.execution import executor

from ..lines import HAS_CORE, RUNNABLE

pytestmark = pytest.mark.skipif(not HAS_CORE, reason="no compiled core here")

ROOT = Path(__file__).parents[2]
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
    one, two = (stepper_of("ac-simple-plane", threads, stiffened=True) for threads in (1, 2))
    for steps, *size in ((120,), (13, 2.3e-4), (40,)):
        assert np.array_equal(history(one, steps, *size), history(two, steps, *size))


@pytest.mark.parametrize("name", [name for name in LINES if name != "ac-simple-plane"])
def test_every_topology_gives_the_same_bits(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """So it is with stitch wires, two contact wires and an auxiliary wire."""
    monkeypatch.setenv("TAUTWIRE_SIMD", RUNNABLE[-1])  # narrow registers: many rows
    one, two = (history(stepper_of(name, threads), 60) for threads in (1, 2))
    assert np.array_equal(one, two)


@pytest.mark.parametrize(
    "options",
    [{"full_newton": True}, {"integrator": HHT(-0.1)}, {"time_step": 3e-3}, {"time_step": 1e-2}],
    ids=["full Newton", "HHT", "3 ms", "10 ms"],
)
def test_every_way_of_stepping_gives_the_same_bits(options: dict[str, Any]) -> None:
    """So it is with full Newton, HHT and with long steps, whose influence reaches far."""
    one, two = (history(stepper_of("ac-simple-plane", threads, **options), 5) for threads in (1, 2))
    assert np.array_equal(one, two)


@pytest.mark.slow
def test_many_repeats_give_the_same_bits() -> None:
    """500 times the same 12 steps by two threads, from the same state."""
    stepper = stepper_of("ac-simple-plane", 2)
    stepper.advance(100)
    mark = stepper.mark()
    first = history(stepper, 12)
    for _ in range(500):
        stepper.rewind(mark)
        assert np.array_equal(history(stepper, 12), first)


FORK = """
import os, sys, warnings
import numpy as np
from tests.verification.test_threads import history, stepper_of
warnings.simplefilter("ignore")
stepper = stepper_of("ac-simple-plane", 2)
stepper.advance(40)
mark = stepper.mark()
here = history(stepper, 40)
child = os.fork()
if child == 0:
    stepper.rewind(mark)
    same = np.array_equal(history(stepper, 40), here)
    del stepper
    os._exit(0 if same else 1)
_, status = os.waitpid(child, 0)
stepper.rewind(mark)
assert np.array_equal(history(stepper, 40), here)
sys.exit(os.waitstatus_to_exitcode(status))
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system does not fork")
def test_a_forked_process_goes_on_alone() -> None:
    """A forked process, in which no helper lives, gets the same numbers and does not wait."""
    done = subprocess.run([sys.executable, "-c", FORK], cwd=ROOT, timeout=120, check=False)
    assert done.returncode == 0


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
