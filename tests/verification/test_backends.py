"""The compiled core against the NumPy reference: one physics, two implementations."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tautwire.errors import InputError
from tautwire.inputs.load import load_case
from tautwire.model.preflight import preflight
from tautwire.numerics.elements import ancf
from tautwire.numerics.motion import backend
from tautwire.numerics.motion.dispersion import wave_stiffening
from tautwire.numerics.motion.stepper import (
    RoofMotion,
    StepBlock,
    StepOptions,
    SurfaceProfile,
    reachable_tolerance,
)
from tautwire.numerics.newmark import HHT, Newmark
from tautwire.status import Status

from ..lines import HAS_CORE, ac_simple, droppers_of, entering, moved, straight_wire

pytestmark = pytest.mark.skipif(not HAS_CORE, reason="no compiled core here")

Array = NDArray[np.float64]
STEPS = 150
TWO_SPANS: dict[str, Any] = {"line__spans": 2, "settings__section": (1, 1)}


def random_cables(count: int) -> tuple[Array, ancf.CableSection]:
    """Return strongly bent and stretched elements."""
    rng = np.random.default_rng(7)
    length = rng.uniform(0.3, 1.0, count)
    e = np.zeros((4, 3, count))
    tangent = np.array([1.0, 0.1, 0.05])[:, None] + 0.1 * rng.normal(size=(3, count))
    e[0] = rng.normal(size=(3, count))
    e[2] = e[0] + length * tangent
    e[1], e[3] = tangent + 0.1 * rng.normal(size=(2, 3, count))
    section = ancf.CableSection(length, np.full(count, 15e6), np.full(count, 195.0))
    return e, section


@pytest.mark.parametrize("count", [1, 5, 37])
def test_element_kernels(count: int) -> None:
    """Forces and tangents of both backends agree to 1e-10 on random states, any lane remainder."""
    e, section = random_cables(count)
    for native, reference in (
        (backend.cable_force(e, section, "native"), ancf.force(e, section)),
        (backend.cable_tangent(e, section, "native"), ancf.tangent(e, section)),
    ):
        assert np.abs(native - reference).max() <= 1e-10 * np.abs(reference).max()


def passage(choice: Any, case: dict[str, Any], **options: Any) -> tuple[StepBlock, Any]:
    """Return the first steps of a passage with one backend."""
    roof = options.pop("roof", None)
    system, pantographs = entering(ac_simple(**case))
    if roof is not None:
        pantographs = tuple(moved(p, roof=roof) for p in pantographs)
    chosen = {"integrator": Newmark(), "time_step": 1e-3, "contact_stiffness": 2e5}
    chosen |= {"tolerance": 3e-8} | options
    stepper = backend.make_stepper(
        system, pantographs, StepOptions(**chosen), np.array([2, 14]), choice
    )
    return stepper.advance(STEPS), stepper


CASES: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "plain": (TWO_SPANS, {}),
    "HHT": (TWO_SPANS, {"integrator": HHT(-0.1)}),
    "small step, soft contact": (TWO_SPANS, {"time_step": 2e-4, "contact_stiffness": 5e4}),
    "weighted ends": (TWO_SPANS | {"line__ends": "weighted"}, {}),
    "swinging arms": (TWO_SPANS | {"supports__arm__motion": "swinging"}, {}),
    "springs": (
        TWO_SPANS
        | {"supports__closure": "spring", "supports__spring": {"stiffness": 300.0, "mass": 0.4}},
        {},
    ),
    "stiff droppers": (TWO_SPANS | {"droppers__stiffness": "5 MN/m"}, {}),
    "no damping": (TWO_SPANS | {"line__damping": {"mass": 0.0, "stiffness": 0.0}}, {}),
    "other direction": (TWO_SPANS | {"scenario__direction": "-x"}, {}),
    "roof motion": (
        TWO_SPANS,
        {"roof": RoofMotion(np.array([0.0, 0.05, 0.1]), np.array([0.0, 0.02, 0.0]))},
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_same_passage(name: str) -> None:
    """Both backends give the same force within 1e-5 N when both are solved to 1e-12 m."""
    case, options = CASES[name]
    (native, _), (reference, _) = (
        passage(choice, case, tolerance=1e-12, **options) for choice in ("native", "reference")
    )
    assert native.status is reference.status is Status.RUNNING
    np.testing.assert_allclose(native.contact_force, reference.contact_force, rtol=0.0, atol=1e-5)
    np.testing.assert_allclose(native.gap, reference.gap, rtol=0.0, atol=1e-10)
    np.testing.assert_allclose(native.stages, reference.stages, rtol=0.0, atol=1e-10)
    stiffness = droppers_of(ac_simple(**case)).stiffness.of_length(1.0)
    forces = native.dropper_force, reference.dropper_force
    np.testing.assert_allclose(*forces, rtol=0.0, atol=2e-10 * stiffness)
    np.testing.assert_allclose(native.observed, reference.observed, rtol=0.0, atol=1e-10)


def test_fast_path_against_full_newton() -> None:
    """The default tolerance leaves an rms error below 0.1 N in the contact force."""
    fast, _ = passage("native", TWO_SPANS)
    full, _ = passage("native", TWO_SPANS, full_newton=True, tolerance=1e-10)
    error = fast.contact_force - full.contact_force
    assert np.sqrt(np.mean(error**2)) <= 0.1
    assert np.abs(error).max() <= 0.5


def test_state_that_is_not_finite_is_an_error() -> None:
    """A state that blows up ends with a status, never with a force of zero."""
    system, pantographs = entering(ac_simple(**TWO_SPANS))
    system = system.with_(load=np.where(np.arange(system.dof_count) == 302, np.nan, system.load))
    options = StepOptions(Newmark(), 1e-3, 2e5, tolerance=3e-8)
    stepper = backend.make_stepper(system, pantographs, options, np.array([2]), "native")
    assert stepper.advance(3).status in (Status.NOT_FINITE, Status.NOT_CONVERGED)


def test_leaving_the_wire_is_told() -> None:
    """A pantograph that runs off the end of the wire stops the integration with its status."""
    system, pantographs = entering(ac_simple(**TWO_SPANS))
    end = system.position[6 * system.paths[0].nodes[-1]]
    late = tuple(moved(p, start_x=float(end) - 0.5) for p in pantographs)
    options = StepOptions(Newmark(), 1e-3, 2e5, tolerance=3e-8)
    for choice in ("native", "reference"):
        stepper = backend.make_stepper(system, late, options, np.array([2]), choice)  # type: ignore[arg-type]
        block = stepper.advance(50)
        assert block.status is Status.OFF_THE_LINE
        assert len(block.time) == 5


KERNELS: tuple[str, ...] = backend._load()[0].built if HAS_CORE else ("none",)  # type: ignore[union-attr]


@pytest.mark.parametrize("name", KERNELS)
def test_every_set_of_kernels(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every set of kernels, that without vector types too, gives the reference's numbers.

    Element forces and tangents to 1e-10, the force of a passage solved to 1e-12 m to 1e-5 N.
    """
    monkeypatch.setenv(backend.SIMD_VARIABLE, name)
    core = backend._load()[0]
    assert core is not None
    if name not in core.runnable:
        pytest.skip(f"this processor cannot run the kernels {name}")
    e, section = random_cables(19)
    for given, expected in (
        (backend.cable_force(e, section, "native"), ancf.force(e, section)),
        (backend.cable_tangent(e, section, "native"), ancf.tangent(e, section)),
    ):
        assert np.abs(given - expected).max() <= 1e-10 * np.abs(expected).max()
    (native, _), (reference, _) = (
        passage(choice, TWO_SPANS, tolerance=1e-12) for choice in ("native", "reference")
    )
    assert core.instruction_set() == name
    np.testing.assert_allclose(native.contact_force, reference.contact_force, rtol=0.0, atol=1e-5)


@pytest.mark.parametrize("choice", ["auto", "native"])
def test_unknown_kernels_are_refused(choice: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """A misspelt instruction set is refused with those there are, never computed by NumPy."""
    monkeypatch.setenv(backend.SIMD_VARIABLE, "avx2")
    with pytest.raises(InputError, match=r"TAUTWIRE_SIMD: got 'avx2'; .*plain.* fastest"):
        backend.backend_name(choice)
    assert backend.backend_name("reference") == "reference (NumPy)"


def test_misspelt_kernels_end_the_program(tmp_path: Path) -> None:
    """The command line ends with exit code 2 and the names that are allowed."""
    answer = subprocess.run(
        [sys.executable, "-m", "tautwire", "--version"],
        capture_output=True,
        text=True,
        env=os.environ | {backend.SIMD_VARIABLE: "AVX512"},
        cwd=tmp_path,
        check=False,
    )
    assert answer.returncode == 2
    assert "TAUTWIRE_SIMD: got 'AVX512'" in answer.stderr
    assert "Traceback" not in answer.stderr


def test_native_is_refused_where_it_cannot_compute() -> None:
    """The compiled core asked for by name on wires that branch is an error, 'auto' says its way."""
    system = straight_wire(20.0, 40)
    branch = system.cables.with_(
        nodes=np.where(system.cables.nodes == [[39, 40]], [[38, 40]], system.cables.nodes)
    )
    system = system.with_(cables=branch)
    options = StepOptions(Newmark(), 1e-3, 2e5, tolerance=3e-8)
    with pytest.raises(
        InputError, match="'native' cannot compute this line, because a node has two"
    ):
        backend.make_stepper(system, (), options, np.array([2]), "native")
    stepper = backend.make_stepper(system, (), options, np.array([2]))
    assert "two wire elements" in stepper.counters.notes["general_solver"]


FINE: dict[str, Any] = TWO_SPANS | {"settings__nodes_between_droppers": 9}


@pytest.mark.parametrize("time_step", [3.4e-3, 5e-3])
def test_long_steps(time_step: float) -> None:
    """Both backends take the same long steps, to equal forces within 1e-4 N.

    There the prediction is so poor that the tangent at it, or at an iterate, is indefinite.
    """
    system, pantographs = entering(ac_simple(**FINE))
    options = StepOptions(Newmark(), time_step, 2e5, tolerance=1e-11)
    steps = round(0.75 / time_step)
    native, reference = (
        backend.make_stepper(system, pantographs, options, np.array([2]), choice)  # type: ignore[arg-type]
        for choice in ("native", "reference")
    )
    blocks = native.advance(steps), reference.advance(steps)
    assert [len(block.time) for block in blocks] == [steps, steps]
    np.testing.assert_allclose(*(b.contact_force for b in blocks), rtol=0.0, atol=1e-4)
    assert native.counters.full_newton_steps > 0


@pytest.mark.parametrize("time_step", [1e-3, 2e-3])
def test_smallest_tolerance(time_step: float) -> None:
    """The smallest tolerance that is allowed, 1e-12 m, is reached as far as rounding lets it."""
    case = ac_simple(**TWO_SPANS | {"settings__nodes_between_droppers": 15})
    system, pantographs = entering(case)
    options = StepOptions(Newmark(), time_step, 2e5, tolerance=1e-12)
    assert 1e-12 < reachable_tolerance(system, options) < 2e-11
    stepper = backend.make_stepper(system, pantographs, options, np.array([2]), "native")
    steps = round(1.0 / time_step)
    assert len(stepper.advance(steps).time) == steps


@pytest.mark.parametrize("nodes", [9, 15])
def test_advised_step_runs(nodes: int) -> None:
    """The step that the check advises for a head on its contact spring can be computed."""
    case = ac_simple(**TWO_SPANS | {"settings__nodes_between_droppers": nodes})
    too_long = case.with_(**{"settings.time_step": 0.01})
    (advice,) = (a for a in preflight(too_long) if "on the contact spring" in a.text)
    found = re.match(r"settings.time_step: ([\d.]+) ms", advice.cure)
    assert found is not None
    step = 1e-3 * float(found[1])
    assert step > 3e-3
    system, pantographs = entering(case)
    options = StepOptions(Newmark(), step, 2e5, tolerance=3e-8)
    stepper = backend.make_stepper(system, pantographs, options, np.array([2]), "native")
    steps = round(1.0 / step)
    assert len(stepper.advance(steps).time) == steps


def test_full_newton_alike() -> None:
    """Full Newton needs as many iterations in both backends: their tangents are the same.

    Droppers that are stretched but shorten so fast that they carry no force are slack in both.
    """
    case = load_case("ac-simple", {"line.spans": 4, "settings.section": (2, 2)})
    system, pantographs = entering(case)
    options = StepOptions(Newmark(), 3e-3, 2e5, tolerance=3e-8, full_newton=True)
    counts = []
    for choice in ("native", "reference"):
        stepper = backend.make_stepper(system, pantographs, options, np.array([2]), choice)  # type: ignore[arg-type]
        assert len(stepper.advance(280).time) == 280
        counts.append(stepper.counters.iterations)
    assert counts[0] == pytest.approx(counts[1], abs=3)


@pytest.mark.parametrize("choice", ["native", "reference"])
def test_rewound_integration_repeats_itself(choice: Any) -> None:
    """After going back to a mark the same steps follow, to the last bit."""
    system, pantographs = entering(ac_simple(**TWO_SPANS))
    options = StepOptions(Newmark(), 1e-3, 2e5, tolerance=3e-8)
    stepper = backend.make_stepper(system, pantographs, options, np.array([2]), choice)
    stepper.advance(20)
    mark = stepper.mark()
    first = stepper.advance(10)
    stepper.rewind(mark)
    again = stepper.advance(10)
    np.testing.assert_array_equal(first.contact_force, again.contact_force)
    np.testing.assert_array_equal(first.time, again.time)
    stepper.rewind(mark)
    halved = stepper.advance(20, 5e-4)
    assert halved.time[-1] == pytest.approx(first.time[-1], rel=1e-12)


@pytest.mark.parametrize("choice", ["native", "reference"])
def test_blocks_of_any_size_are_the_same_passage(choice: Any) -> None:
    """Steps taken one by one, in growing blocks or at once, with steps of another size tried and
    taken back between them, give the same numbers to the last bit."""
    system, pantographs = entering(ac_simple(**TWO_SPANS))
    options = StepOptions(Newmark(), 1e-3, 2e5, tolerance=3e-8)
    passages = []
    for sizes in ([60], [1, 1, 2, 3, 5, 8, 13, 21, 6], [20, 20, 20]):
        stepper = backend.make_stepper(system, pantographs, options, np.array([2]), choice)
        blocks = []
        for size in sizes:
            mark = stepper.mark()
            stepper.advance(2, 0.3e-3)
            stepper.rewind(mark)
            blocks.append(stepper.advance(size))
        passages.append(StepBlock.joined(blocks, Status.RUNNING))
    for other in passages[1:]:
        np.testing.assert_array_equal(passages[0].time, other.time)
        np.testing.assert_array_equal(passages[0].stages, other.stages)


def test_other_steps_and_uneven_wires() -> None:
    """Both backends agree within 1e-5 N with changing steps on a wire with an uneven surface."""
    x = np.linspace(0.0, 20.0, 401)
    surface = SurfaceProfile(0.0, 0.05, 2e-4 * np.sin(2.0 * np.pi * x / 1.3))
    system, pantographs = entering(ac_simple(**TWO_SPANS))
    uneven = tuple(moved(p, surface=surface) for p in pantographs)
    options = StepOptions(Newmark(), 1e-3, 2e5, tolerance=1e-12)
    forces = []
    for choice in ("native", "reference"):
        stepper = backend.make_stepper(system, uneven, options, np.array([2]), choice)  # type: ignore[arg-type]
        parts = [stepper.advance(30), stepper.advance(40, 2.5e-4), stepper.advance(20)]
        forces.append(np.concatenate([p.contact_force for p in parts]))
    smooth = backend.make_stepper(system, pantographs, options, np.array([2])).advance(30)
    assert np.abs(forces[0][:30] - smooth.contact_force).max() > 1.0
    np.testing.assert_allclose(forces[0], forces[1], rtol=0.0, atol=1e-5)


def test_wave_stiffening() -> None:
    """Both backends agree within 1e-5 N when the step's error on waves is taken off the wires."""
    forces = []
    for choice in ("native", "reference"):
        system, pantographs = entering(ac_simple(**TWO_SPANS))
        stiffening = wave_stiffening(system, Newmark())
        options = StepOptions(Newmark(), 1e-3, 2e5, tolerance=1e-12, stiffening=stiffening)
        stepper = backend.make_stepper(system, pantographs, options, np.array([2]), choice)  # type: ignore[arg-type]
        forces.append(stepper.advance(STEPS).contact_force)
    plain, _ = passage("native", TWO_SPANS, tolerance=1e-12)
    assert np.abs(forces[0] - plain.contact_force).max() > 0.1
    np.testing.assert_allclose(forces[0], forces[1], rtol=0.0, atol=1e-5)


@pytest.mark.parametrize("choice", ["native", "reference"])
def test_stop_before_contact_changes(choice: Any) -> None:
    """Asked to, the integration stops before the step in which contact begins or ends."""
    system, pantographs = entering(ac_simple(**TWO_SPANS))
    options = StepOptions(Newmark(), 1e-3, 2e5, tolerance=3e-8)
    whole = backend.make_stepper(system, pantographs, options, np.array([2]), choice).advance(100)
    touching = whole.gap[:, 0] < 0.0
    change = int(np.flatnonzero(touching[1:] != touching[:-1])[0]) + 1
    stepper = backend.make_stepper(system, pantographs, options, np.array([2]), choice)
    stepper.advance(1)
    block = stepper.advance(100, until_crossing=True)
    assert 1 + len(block.time) == change
    np.testing.assert_array_equal(block.contact_force, whole.contact_force[1:change])
