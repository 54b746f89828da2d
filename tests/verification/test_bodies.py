"""Bodies in the line of a wire: splices, insulators and section insulators."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tautwire.line.expand import expand
from tautwire.numerics.motion.backend import make_stepper
from tautwire.numerics.motion.stepper import StepOptions
from tautwire.numerics.newmark import Newmark
from tautwire.specs.case import Case

from ..lines import HAS_CORE, ac_simple, droppers_of, entering, found

ENDS = (24.0, 25.0)
MARKS = [
    {
        "name": "marks",
        "defects": [
            {"kind": "extra mass", "span": 2, "at": at, "wire": "contact", "mass": 1.0}
            for at in ENDS
        ],
    }
]
"""A condition that is not chosen and puts nodes where the ends of bodies are."""


def with_body(case: Case, **numbers: Any) -> Case:
    """Return a case with a body in span 2."""
    given = {"name": "insulator", "wire": "contact", "span": 2, "at": 24.5, "length": 1.0}
    return case.with_(bodies=[{**given, **numbers}])


def test_a_body_like_its_wire_changes_nothing() -> None:
    """With the wire's mass and stiffness shape, forces and loads stay as they are."""
    bare = ac_simple(conditions=MARKS)
    wire = bare.wires.contact
    own = {
        "mass": wire.mass * 1.0 / (1.0 + wire.tension / wire.axial_stiffness),
        "axial_stiffness": wire.axial_stiffness,
        "bending_stiffness": wire.bending_stiffness,
    }
    _, before, line = found(bare)
    _, after, changed = found(with_body(bare, **own))
    assert np.abs(after.position - before.position).max() < 1e-9
    assert np.abs(after.dropper_forces - before.dropper_forces).max() < 1e-6
    assert np.abs(changed.load - line.load).max() < 1e-6
    assert np.abs(changed.cables.mass - line.cables.mass).max() < 1e-12


def alone(**changes: Any) -> Case:
    """Return a contact wire without bending stiffness alone between three supports."""
    return ac_simple(
        **{
            "wires__messenger": None,
            "wires__contact__bending_stiffness": 0.0,
            "droppers": (),
            "supports__closure": "spring",
            "supports__spring": {"stiffness": 2e3},
            "supports__contact_stagger": 0.0,
            "settings__nodes_between_droppers": 41,
            **changes,
        }
    )


def test_sag_under_a_point_mass() -> None:
    """A string with the tension T sags by ``(w a b/2 + P a b/L)/T`` under a mass at a, L - a.

    Elements round the kinks off over their own length; the limit of two meshes does not.
    """
    a, b, mass = 20.0, 35.0, 4.0
    sags = []
    for count in (41, 81):
        case = with_body(alone(settings__nodes_between_droppers=count), at=a, length=0.0, mass=mass)
        _, shape, _ = found(case)
        x, _, z = shape.wires[0].position.T
        sags.append(case.supports.contact_heights(4)[1] - np.interp(55.0 + a, x, z))
        assert shape.reaction == pytest.approx(shape.weight, rel=1e-8)
    wire, gravity = case.wires.contact, case.line.gravity
    weight = wire.mass / (1.0 + wire.tension / wire.axial_stiffness)
    exact = gravity * (0.5 * weight * a * b + mass * a * b / (a + b)) / wire.tension
    assert 2.0 * sags[1] - sags[0] == pytest.approx(exact, rel=1e-4)


def test_weight_and_reactions() -> None:
    """A body weighs what it is told instead of its wire, and the supports carry it."""
    heavy = {"mass": 20.0, "end_mass": 1.5, "axial_stiffness": 30e6, "bending_stiffness": 2e3}
    bare, case = ac_simple(conditions=MARKS), with_body(ac_simple(), **heavy)
    _, shape, system = found(case)
    wire, cables = case.wires.contact, system.cables
    replaced = wire.mass / (1.0 + wire.tension / wire.axial_stiffness)
    ours = cables.mass @ cables.length
    _, _, without = found(bare)
    theirs = without.cables.mass @ without.cables.length
    assert ours - theirs == pytest.approx(20.0 - replaced, rel=1e-3)  # the messenger wire sags
    assert shape.reaction == pytest.approx(shape.weight, rel=1e-8)
    assert shape.weight == pytest.approx(
        (ours + expand_lumps(case) + system.ties.mass @ system.ties.length) * case.line.gravity
        + 2 * case.supports.arm.mass * case.supports.arm.length * case.line.gravity,
        rel=1e-9,
    )


def expand_lumps(case: Case) -> float:
    """Return the mass of all clamps and of the ends of bodies [kg]."""
    one = droppers_of(case)
    count = len(expand(case).hangers)
    clamps = count * (one.clamp_contact + one.clamp_messenger) + 2 * case.supports.clamp
    return clamps + sum(2.0 * body.end_mass for body in case.bodies)


@pytest.mark.parametrize(
    "numbers", [{"axial_stiffness": 1e9}, {"axial_stiffness": 3e6}, {"bending_stiffness": 2e3}]
)
def test_stiffness_of_a_body(numbers: dict[str, float]) -> None:
    """The EA or EI of a body under the tension of its wire moves no wire by a tenth of a mm.

    The tension decides the shape; with 3 MN a body is 0.6 % lighter per length, and a stiff one
    stays straight for its metre.
    """
    _, before, _ = found(ac_simple(conditions=MARKS))
    _, after, _ = found(with_body(ac_simple(), **numbers))
    moved = (after.position - before.position).reshape(-1, 6)[:, :3]
    assert 0.0 < np.abs(moved).max() < 1e-4


@pytest.mark.skipif(not HAS_CORE, reason="no compiled core here")
def test_both_backends_pass_under_bodies() -> None:
    """Core and reference agree to 2e-5 N under an insulator with clamps and a splice."""
    case = ac_simple(line__spans=2, settings__section=(1, 1))
    insulator = {"mass": 12.0, "end_mass": 1.0, "bending_stiffness": 2e3, "length": 1.0}
    bodies = [
        {"name": "insulator", "wire": "contact", "span": 1, "at": 12.5, **insulator},
        {"name": "splice", "wire": "messenger", "span": 1, "at": 14.0, "mass": 3.0},
    ]
    forces = [
        force_of(one, choice)
        for one in (case, case.with_(bodies=bodies))
        for choice in ("native", "reference")
    ]
    assert np.abs(forces[2] - forces[3]).max() < 2e-5
    assert np.abs(forces[3] - forces[1]).max() > 5.0


def force_of(case: Case, choice: Any) -> Any:
    """Return the contact force over the first 150 steps of a passage."""
    system, pantographs = entering(case)
    options = StepOptions(Newmark(), 1e-3, contact_stiffness=2e5, tolerance=1e-11)
    return (
        make_stepper(system, pantographs, options, np.array([2, 14]), choice)
        .advance(150)
        .contact_force
    )


def test_a_body_does_not_wear() -> None:
    """Where a contact wire wears, a body in its line keeps mass and stiffness."""
    case = ac_simple(
        conditions=[{"name": "worn", "wear": 0.1}],
        condition="worn",
        wires__contact__diameter=0.0132,
    )
    _, _, system = found(with_body(case, mass=12.0))
    wire, body = case.wires.contact, system.cables.mass > 10.0
    assert np.allclose(system.cables.axial[body], wire.axial_stiffness)
    worn = np.isclose(system.cables.mass, 0.9 * wire.mass)
    assert np.allclose(system.cables.axial[worn], 0.9 * wire.axial_stiffness)
    assert worn.sum() > 10 * body.sum() > 0
