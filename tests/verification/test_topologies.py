"""The compiled core on lines of any topology against the general banded NumPy stepper."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tautwire.numerics.motion import backend
from tautwire.numerics.motion.native_line import NodeOrder, NotAChainError
from tautwire.numerics.motion.stepper import StepOptions
from tautwire.numerics.network.parts import Cables, Path, Stays
from tautwire.numerics.network.system import System
from tautwire.numerics.newmark import HHT, Newmark
from tautwire.status import Status

from ..lines import HAS_CORE
from ..topologies import TOPOLOGIES, hanging, under_way

pytestmark = pytest.mark.skipif(not HAS_CORE, reason="no compiled core here")

STEPS = 150


def run(name: str, choice: Any, steps: int = STEPS, **options: Any) -> tuple[Any, Any]:
    """Return histories and stepper of a pantograph under a line."""
    system = TOPOLOGIES[name]().system()
    chosen = {"integrator": Newmark(), "time_step": 1e-3, "contact_stiffness": 5e4}
    chosen |= {"tolerance": 3e-8} | options
    observed = np.arange(1, system.dof_count, 41)
    stepper = backend.make_stepper(system, (under_way(),), StepOptions(**chosen), observed, choice)
    return stepper.advance(steps), stepper


@pytest.mark.parametrize("name", TOPOLOGIES)
def test_same_as_the_reference(name: str) -> None:
    """Both backends give the same forces and coordinates when both are solved to 1e-12 m."""
    (native, _), (reference, _) = (
        run(name, choice, tolerance=1e-12) for choice in ("native", "reference")
    )
    assert native.status is reference.status is Status.RUNNING
    assert np.abs(reference.contact_force).max() > 50.0
    np.testing.assert_allclose(native.contact_force, reference.contact_force, rtol=0.0, atol=2e-5)
    np.testing.assert_allclose(native.observed, reference.observed, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(native.dropper_force, reference.dropper_force, rtol=0.0, atol=2e-3)


@pytest.mark.parametrize("options", [{"integrator": HHT(-0.1)}, {"time_step": 2.5e-4}], ids=str)
def test_other_steps_on_a_stitched_line(options: dict[str, Any]) -> None:
    """HHT and small steps agree on a line with clamps, too."""
    (native, _), (reference, _) = (
        run("stitched", choice, tolerance=1e-12, **options) for choice in ("native", "reference")
    )
    np.testing.assert_allclose(native.contact_force, reference.contact_force, rtol=0.0, atol=2e-5)


@pytest.mark.parametrize("name", ["simple", "stitched", "twin", "compound", "graded"])
def test_few_sweeps(name: str) -> None:
    """At 1 ms and 216 km/h a step takes at most 2.5 sweeps over the line, 2.8 on a graded mesh.

    The bounds are the goals set for any topology; the factor made at rest serves throughout.
    """
    system = hanging(TOPOLOGIES[name]().system())
    wire = system.position.reshape(-1, 6)[system.paths[0].nodes]
    given = under_way(22.0, float(np.interp(22.0, wire[:, 0], wire[:, 2])), velocity=60.0)
    options = StepOptions(Newmark(), 1e-3, 5e4, tolerance=3e-8)
    stepper = backend.make_stepper(system, (given,), options, np.array([2]), "native")
    block = stepper.advance(400)  # until well before the anchored end
    counters = stepper.counters
    assert len(block.time) == 400
    assert block.contact_force[100:].mean() == pytest.approx(160.0, abs=60.0)
    assert counters.iterations / counters.steps <= (2.8 if name == "graded" else 2.5)
    assert counters.refactorisations == counters.full_newton_steps == 0


@pytest.mark.parametrize("name", ["stitched", "twin", "single"])
def test_full_newton(name: str) -> None:
    """The exact matrix leads to the same motion as the approximate one."""
    fast, _ = run(name, "native", steps=60, tolerance=1e-11)
    full, stepper = run(name, "native", steps=60, tolerance=1e-11, full_newton=True)
    assert stepper.counters.full_newton_steps == 60
    np.testing.assert_allclose(fast.contact_force, full.contact_force, rtol=0.0, atol=1e-4)


@pytest.mark.parametrize("path", [True, False])
def test_without_pantograph(path: bool) -> None:
    """Wires swing alike in both backends when nothing runs under them, with or without a path."""
    system = TOPOLOGIES["stitched"]().system()
    system = system if path else system.with_(paths=system.paths[:0])
    options = StepOptions(Newmark(), 1e-3, 5e4, tolerance=1e-12)
    middle = 6 * (system.node_count // 2) + np.arange(3)
    native = backend.make_stepper(system, (), options, middle, "native").advance(50)
    assert native.contact_force.shape == native.gap.shape == (50, 0)
    if path:
        reference = backend.make_stepper(system, (), options, middle, "reference").advance(50)
        np.testing.assert_allclose(native.observed, reference.observed, rtol=0.0, atol=1e-9)
    assert np.ptp(native.observed[:, 2]) > 1e-4


def halved(system: System) -> System:
    """Return two wires of half the stiffness and mass in place of one, each of them a path."""
    cables, path, count = system.cables, system.paths[0], system.node_count
    half = cables.with_(axial=cables.axial / 2, bending=cables.bending / 2, mass=cables.mass / 2)
    both = np.concatenate([half.nodes, half.nodes + count])
    pairs = {
        name: np.tile(getattr(half, name), 2) for name in ("length", "axial", "bending", "mass")
    }
    second = Path("contact-2", path.nodes + count, path.cables + len(cables))
    return system.with_(
        cables=Cables(nodes=both, **pairs),
        node_mass=np.tile(system.node_mass / 2, 2),
        load=np.tile(system.load / 2, 2),
        fixed=np.tile(system.fixed, 2),
        position=np.tile(system.position, 2),
        stays=Stays.none(),
        paths=(path, second),
    )


def test_two_half_wires_under_one_head() -> None:
    """Two wires of half the properties and contact stiffness carry the force of one wire."""
    one = TOPOLOGIES["single"]().system().with_(stays=Stays.none())
    options = {"integrator": Newmark(), "time_step": 1e-3, "tolerance": 1e-12}
    forces = []
    for system, stiffness in ((one, 5e4), (halved(one), 2.5e4)):
        given = StepOptions(contact_stiffness=stiffness, **options)  # type: ignore[arg-type]
        stepper = backend.make_stepper(system, (under_way(),), given, np.array([2]), "native")
        block = stepper.advance(400)
        assert len(block.time) == 400
        forces.append(block.contact_force)
    assert forces[0].max() > 100.0
    np.testing.assert_allclose(forces[1], forces[0], rtol=0.0, atol=1e-5)


def test_wires_that_branch_are_refused() -> None:
    """A node with two elements to its right, and a ring, cannot be laid end to end."""
    with pytest.raises(NotAChainError, match="two wire elements to one side"):
        NodeOrder.of(np.array([[0, 1], [0, 2]]), 3)
    with pytest.raises(NotAChainError, match="ring"):
        NodeOrder.of(np.array([[0, 1], [1, 0]]), 2)


def test_order_of_the_core_follows_the_wires() -> None:
    """Every node stands once in the chain; neighbours in it are joined by the cable it names."""
    system = TOPOLOGIES["stitched"]().system()
    order = NodeOrder.of(system.cables.nodes, system.node_count)
    np.testing.assert_array_equal(np.sort(order.nodes), np.arange(system.node_count))
    np.testing.assert_array_equal(order.nodes[order.place], np.arange(system.node_count))
    joined = order.cables >= 0
    pairs = np.stack([order.nodes[:-1], order.nodes[1:]], axis=1)
    np.testing.assert_array_equal(pairs[joined], system.cables.nodes[order.cables[joined]])
    assert joined.sum() == len(system.cables)
    assert (~joined).sum() == 2
