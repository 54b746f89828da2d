"""Cantilevers that give way: force over stiffness, springs in series, limits, both backends."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tautwire.analyses.design.supports import support_forces
from tautwire.analyses.road.dynamics import simulate
from tautwire.analyses.road.shape import find_shape
from tautwire.analyses.vibration.modes import modes
from tautwire.errors import InputError
from tautwire.inputs.load import make_case
from tautwire.model.build import build
from tautwire.model.equations import equations
from tautwire.numerics.motion.backend import make_stepper
from tautwire.numerics.motion.stepper import StepOptions
from tautwire.numerics.network.system import System, tie_axial_force
from tautwire.numerics.newmark import Newmark
from tautwire.results.storage import load_run, save_run
from tautwire.specs.case import Case

from ..lines import HAS_CORE, ac_simple, entering, found, loaded, out_of_balance
from .test_conditions import states

Axes = dict[str, Any]
RIGID: Axes = {}


def cantilevered(case: Case, **places: Any) -> Case:
    """Return a case whose cantilevers give way at some places."""
    return case.with_(**{"supports.cantilever": places or None})


def pushed(system: System, node: int, direction: np.ndarray, force: float) -> np.ndarray:
    """Return how far the nodes move under a force on one of them, ``(n_node, 3)`` [m]."""
    load = np.zeros(system.dof_count)
    load[6 * node : 6 * node + 3] = force * direction
    moved = loaded(system, load).position - system.position
    return moved.reshape(-1, 6)[:, :3]


def test_the_design_stays_what_it_is() -> None:
    """Wires, arms and forces of the design are those of rigid cantilevers, and in balance."""
    _, rigid, _ = found(ac_simple())
    given = {"messenger": {"lateral": 2e5, "along": 3e3}, "arm": {"lateral": 1e5, "vertical": 5e4}}
    _, shape, system = found(cantilevered(ac_simple(), **given))
    assert out_of_balance(system, system.position) < 1e-4
    for name in ("dropper_lengths_unstrained", "dropper_forces", "arm_forces", "arm_ends"):
        assert np.abs(getattr(shape, name) - getattr(rigid, name)).max() < 1e-7, name
    for ours, theirs in zip(shape.wires, rigid.wires, strict=True):
        assert np.abs(ours.position - theirs.position).max() < 1e-9
    assert shape.reaction == pytest.approx(shape.weight, rel=1e-8)


@pytest.mark.parametrize(("name", "direction"), [("lateral", 1), ("vertical", 2), ("along", 0)])
def test_a_heel_gives_way_by_force_over_stiffness(name: str, direction: int) -> None:
    """A heel moves by the change of what its arm pulls over its stiffness, in each direction."""
    stiffness = {"lateral": 4e4, "vertical": 3e4, "along": 5e3}
    model, _, system = found(cantilevered(ac_simple(), arm=stiffness))
    node, heel = model.mesh.node(model.line.registrations[0].at), int(model.mesh.heels[0])
    load = np.zeros(system.dof_count)
    load[6 * node + direction] = 200.0
    moved = loaded(system, load)
    after = system.with_(position=moved.position)
    u = (after.position - system.position).reshape(-1, 6)[heel, direction]

    def pull(state: System) -> float:
        (tie,) = np.flatnonzero(state.ties.nodes[:, 0] == heel)
        axial = tie_axial_force(state, state.position)[tie]
        along = state.ties.state(state.position).direction[:, tie]
        return float(-axial * along[direction])

    assert u == pytest.approx((pull(after) - pull(system)) / stiffness[name], rel=1e-5)
    assert abs(u) > 1e-5


@pytest.mark.parametrize(("name", "direction"), [("lateral", 1), ("along", 0)])
def test_springs_of_the_messenger_wire_are_in_parallel(name: str, direction: int) -> None:
    """The stiffness of a suspended wire is that of its own and that of its spring together."""
    own = []
    for stiffness in (2e4, 3e5):
        soft = {"name": "soft", "cantilever": {"messenger": {name: stiffness}}}
        case = ac_simple(supports__types=[soft], supports__type=[None, "soft", None, None])
        model, _, system = found(case)
        node = model.mesh.node(model.line.suspensions[0].at)
        moved = pushed(system, node, np.eye(3)[direction], 20.0)[node, direction]
        own.append(20.0 / moved - stiffness)
    assert own[0] == pytest.approx(own[1], rel=0.01)
    assert own[0] > 0.0


def test_a_heel_is_in_series_with_its_arm() -> None:
    """Along an arm of stiffness k at the angle a, a heel of stiffness k_h adds cos^2(a)/k_h to 1/k,
    beside the stiffness of the wires."""
    stiffness, heel = [], 1e5
    for places in (RIGID, {"arm": {"lateral": heel}}):
        model, shape, system = found(cantilevered(ac_simple(), **places))
        node = model.mesh.node(model.line.registrations[0].at)
        angle = float(shape.arm_angles[0])
        side = np.sign(shape.arm_ends[0, 1])
        axis = np.array([0.0, side * np.cos(angle), np.sin(angle)])
        stiffness.append(20.0 / (pushed(system, node, axis, 20.0)[node] @ axis))
    arm = ac_simple().supports.arm
    bar = arm.axial_stiffness / arm.length
    both = 1.0 / (1.0 / bar + np.cos(angle) ** 2 / heel)
    assert stiffness[0] - stiffness[1] == pytest.approx(bar - both, rel=1e-3)


def test_without_limit_it_is_rigid() -> None:
    """Under 1 N upwards the line moves as with rigid cantilevers, but for 1/stiffness: 1e-9 m."""
    moved = []
    for stiffness in (None, 1e8, 1e9):
        one = {"lateral": stiffness, "vertical": stiffness}
        given = {} if stiffness is None else {"arm": one, "messenger": {"lateral": stiffness}}
        model, _, system = found(cantilevered(ac_simple(), **given))
        node = model.mesh.node(model.line.registrations[0].at)
        all_nodes = pushed(system, node, np.array([0.0, 0.0, 1.0]), 1.0)
        moved.append(np.concatenate([all_nodes[strand.nodes] for strand in model.mesh.strands]))
    off = [float(np.abs(one - moved[0]).max()) for one in moved[1:]]
    assert off[1] < 1e-9
    assert off[0] == pytest.approx(10.0 * off[1], rel=0.5)


def warm_line(**places: Any) -> Case:
    """Return a line anchored on the left and weighted on the right, 40 K warmer."""
    case = ac_simple(
        line__ends={"left": "anchored", "right": "weighted"},
        wires__contact__thermal_expansion=17e-6,
        wires__messenger__thermal_expansion=17e-6,
        droppers__thermal_expansion=17e-6,
        conditions=[{"name": "warm", "temperature": 55.0, "reference": 15.0}],
    )
    return cantilevered(case, **places)


def test_resisting_cantilevers_take_tension() -> None:
    """A messenger wire loses ``sum k u`` between its weights and its anchor, u its travel."""
    stiffness = 2e3
    (free,) = states(warm_line())[1].values()
    case = warm_line(messenger={"along": stiffness})
    model, found_states = build(case), states(case)[1]
    (held,) = found_states.values()
    row = held.wire_names.index("messenger")
    nodes = model.mesh.nodes(piece.at for piece in model.line.suspensions)
    assert held.operated is not None
    before = held.operated.design.position
    travel = (held.position - before).reshape(-1, 6)[nodes, 0]
    taken = free.end_pulls[0, row] - held.end_pulls[0, row]
    assert abs(taken) == pytest.approx(stiffness * travel.sum(), rel=0.02)
    assert travel[-1] > 0.05


def test_a_heel_without_stiffness_along_follows_the_wire() -> None:
    """In a condition the far end of an arm travels with its wire, as that of a rigid one does."""
    (rigid,) = states(warm_line())[1].values()
    (elastic,) = states(warm_line(arm={"lateral": 1e9, "vertical": 1e9}))[1].values()
    for ours, theirs in zip(elastic.wires, rigid.wires, strict=True):
        assert np.abs(ours.position - theirs.position).max() < 2e-6
    assert elastic.arm_ends == pytest.approx(rigid.arm_ends, abs=2e-6)


def test_forces_on_supports() -> None:
    """What the masts take of wires in their design does not depend on how they give way."""
    given = {"messenger": {"lateral": 2e5}, "arm": {"lateral": 1e5, "vertical": 5e4}}
    forces = []
    for places in (RIGID, given):
        model, shape, _ = found(cantilevered(ac_simple(), **places))
        forces.append([(f.along, f.lateral, f.vertical) for f in support_forces(model, shape)])
    assert np.abs(np.subtract(*forces)).max() < 1e-3


def test_a_broken_arm_leaves_its_heel() -> None:
    """Where an arm is broken its heel stands still and the wire is free."""
    broken = [
        {"name": "broken", "defects": [{"kind": "broken steady arm", "support": 2}]},
    ]
    case = ac_simple(conditions=broken, condition="broken", wires__contact__diameter=0.0132)
    _, rigid, _ = found(case)
    _, shape, _ = found(cantilevered(case, arm={"lateral": 1e9}))
    assert np.abs(shape.contact.position - rigid.contact.position).max() < 2e-6


@pytest.mark.skipif(not HAS_CORE, reason="no compiled core here")
def test_both_backends() -> None:
    """Core and reference agree to 2e-5 N on elastic cantilevers, which are felt in the force."""
    case = ac_simple(line__spans=2, settings__section=(1, 1))
    given = {
        "messenger": {"lateral": 1e5, "along": 4e3, "damping": 200.0, "mass": 6.0},
        "arm": {"lateral": 5e4, "vertical": 2e3, "along": 4e3, "damping": 50.0, "mass": 5.0},
    }
    forces = []
    for places, choice in ((given, "native"), (given, "reference"), (RIGID, "native")):
        system, pantographs = entering(cantilevered(case, **places))
        options = StepOptions(Newmark(), 1e-3, contact_stiffness=2e5, tolerance=1e-11)
        one = make_stepper(system, pantographs, options, np.array([2, 14]), choice)
        forces.append(one.advance(620).contact_force)
    assert np.abs(forces[0] - forces[1]).max() < 2e-5
    assert np.abs(forces[0] - forces[2]).max() > 1.0


def test_modes_know_the_cantilevers() -> None:
    """A soft suspension lowers no mode below zero and adds none; heels only move with the arms."""
    case = ac_simple(settings__nodes_between_droppers=2)
    soft = cantilevered(case, messenger={"lateral": 2e4}, arm={"lateral": 2e4, "vertical": 2e4})
    frequencies = []
    for one in (case, soft):
        model = build(one)
        _, shape, _ = found(one)
        frequencies.append(modes(model, shape, near=0.0, count=6).frequencies)
    assert np.all(frequencies[1] > 0.0)
    assert np.all(frequencies[1] <= frequencies[0] * (1.0 + 1e-6))


def test_in_a_curve_on_cant() -> None:
    """Where the axes of the track are none of the coordinates the line is in balance too."""
    case = ac_simple(
        track=[{"arc": 165.0, "radius": 800.0, "side": "left", "cant": 0.1}],
        supports__contact_stagger=-0.2,
    )
    given = {"messenger": {"lateral": 2e5}, "arm": {"lateral": 1e5, "vertical": 5e4}}
    _, rigid, _ = found(case)
    model, shape, system = found(cantilevered(case, **given))
    assert out_of_balance(system, system.position) < 1e-3
    assert np.abs(shape.contact.position - rigid.contact.position).max() < 1e-9
    node = model.mesh.node(model.line.suspensions[0].at)
    grounds = system.grounds
    own = [grounds.stiffness[row] for row in np.flatnonzero(grounds.node == node)]
    lateral = model.mesh.frames.axes[node, 1]
    assert lateral @ sum(own) @ lateral == pytest.approx(2e5)


def test_results_are_kept(tmp_path: Path) -> None:
    """A passage on elastic cantilevers is written, read and has one force per dropper."""
    case = cantilevered(ac_simple(), arm={"lateral": 1e5, "vertical": 5e4, "mass": 4.0})
    model = build(case)
    shape = find_shape(model)
    run = simulate(model, shape)
    path = tmp_path / "run.nc"
    save_run(run, path)
    again = load_run(path)
    assert again.droppers.force.shape[1] == 27
    assert again.equilibrium.wires[0].position == pytest.approx(shape.wires[0].position)
    assert np.count_nonzero(again.equilibrium.node_wire < 0) == 2


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "nothing": ({"cantilever": {}}, "supports.cantilever: says nothing; give messenger, arm"),
    "no direction": (
        {"cantilever": {"arm": {"mass": 5.0}}},
        "supports.cantilever.arm: has no stiffness; give lateral, vertical, along",
    ),
    "two vertical springs": (
        {"cantilever": {"messenger": {"vertical": 1e5}}},
        "supports.cantilever.messenger.vertical: is supports.messenger_stiffness",
    ),
    "no arm": (
        {
            "closure": "spring",
            "spring": {"stiffness": 300.0},
            "cantilever": {"arm": {"along": 1e4}},
        },
        "supports.cantilever.arm: needs a steady arm, and closure 'spring' has none",
    ),
    "plane arm": (
        {"arm": {"motion": "vertical"}, "cantilever": {"arm": {"lateral": 1e5}}},
        "supports.arm.motion: is 'vertical': such an arm holds the wire laterally",
    ),
    "no mass": (
        {"arm": {"mass": 0.0}, "cantilever": {"arm": {"lateral": 1e5}}},
        "supports.cantilever.arm.mass: is missing: neither the arm nor its heel has any",
    ),
    "hinge too": (
        {"hinge": -3.0, "cantilever": {"messenger": {"along": 1e4}}},
        "supports.cantilever.messenger.along: and supports.hinge both say",
    ),
    "fixed too": (
        {"messenger_longitudinal": "fixed", "cantilever": {"messenger": {"along": 1e4}}},
        "supports.cantilever.messenger.along: gives way, and messenger_longitudinal is 'fixed'",
    ),
    "of a type": (
        {"types": [{"name": "soft", "cantilever": {"messenger": {"along": 1e4}}}], "hinge": -3.0},
        "supports.types[1].cantilever.messenger.along: and supports.hinge both say",
    ),
}


@pytest.mark.parametrize("fault", REFUSED)
def test_refused(fault: str) -> None:
    """What contradicts an elastic cantilever is refused with place and cure."""
    supports, words = REFUSED[fault]
    data = ac_simple().to_dict()
    data["supports"] |= supports
    with pytest.raises(InputError) as caught:
        make_case(data)
    assert words in "\n".join(caught.value.problems)


def test_per_type() -> None:
    """A type of support has its own cantilever; the others stay rigid."""
    case = ac_simple(
        supports__types=[{"name": "soft", "cantilever": {"arm": {"lateral": 1e5}}}],
        supports__type=[None, "soft", None, None],
    )
    model, _, system = found(case)
    assert (model.mesh.heels >= 0).tolist() == [True, False]
    assert len(system.stays) == 1
    assert equations(model, found(case)[1]).ties.nodes.shape == (28, 2)
