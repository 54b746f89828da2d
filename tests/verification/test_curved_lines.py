"""Lines over curved, canted and inclined track: equalities and closed forms."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tautwire import load_equilibrium, save_equilibrium
from tautwire.analyses.design.supports import support_forces
from tautwire.analyses.road.dynamics import simulate
from tautwire.analyses.road.operate import operate
from tautwire.analyses.road.shape import find_shape
from tautwire.inputs.load import load_case
from tautwire.line import expand as expansion
from tautwire.line.alignment import alignment
from tautwire.model.build import Model, build
from tautwire.model.equations import equations
from tautwire.model.passage import plan_passage
from tautwire.numerics.motion.backend import make_stepper
from tautwire.numerics.motion.stepper import PantographInput, StepOptions
from tautwire.numerics.network.system import internal_force
from tautwire.numerics.newmark import Newmark
from tautwire.numerics.track import Track
from tautwire.results.equilibrium import Equilibrium
from tautwire.specs.case import Case
from tautwire.status import Status

from ..lines import AC_SIMPLE, moved, one_stage

Array = NDArray[np.float64]

SPANS, SPAN = 6, 55.0
OUTSIDE = (-0.2,) * (SPANS + 1)
CANTED = [
    {"straight": 40.0},
    {"transition": 60.0},
    {"arc": 150.0, "radius": 900.0, "side": "left", "cant": 0.12},
    {"transition": 50.0},
    {"straight": 40.0},
]
HILL = [
    {"at": 0.0, "height": 0.0},
    {"at": 150.0, "height": 3.0, "radius": 6000.0},
    {"at": 330.0, "height": 2.0},
]


def line(track: Any, **changes: Any) -> Case:
    """Return AC simple on a track, six spans at 250 km/h; ``changes`` as in :func:`ac_simple`."""
    given = {
        "line__spans": SPANS,
        "settings__section": (3, 4),
        "settings__nodes_between_droppers": 5,
        "settings__tolerance": 1e-11,
        "scenario__speed": 250.0 / 3.6,
        "scenario__uplift_force": 120.0,
        **changes,
    }
    case = Case.model_validate({**AC_SIMPLE, "schema": 2, "track": track})
    return case.with_(**{name.replace("__", "."): value for name, value in given.items()})


def arc(radius: float, side: str = "left", cant: float = 0.0) -> list[dict[str, Any]]:
    """Return a track in one arc."""
    return [{"arc": SPANS * SPAN, "radius": radius, "side": side, "cant": cant}]


def shape_of(case: Case) -> tuple[Model, Equilibrium]:
    """Return model and shape of a case."""
    model = build(case)
    return model, find_shape(model)


def force(case: Case) -> Array:
    """Return the contact force over a passage, ``(n_time,)`` [N]."""
    return simulate(*shape_of(case)).pantographs[0].contact_force


def first_forces(case: Case, backend: Any, steps: int = 250) -> Array:
    """Return the contact force over the first steps of 2 ms of a passage, ``(n_time,)`` [N]."""
    model, shape = shape_of(case)
    pantographs = plan_passage(model, shape, case.uplift_forces()).pantographs
    options = StepOptions(Newmark(), 2e-3, 5e4, tolerance=1e-11)
    system = equations(model, shape)
    return (
        make_stepper(system, pantographs, options, np.array([0]), backend)
        .advance(steps)
        .contact_force
    )


@cache
def straight_force() -> Array:
    """Return the contact force on the straight line."""
    return force(line([]))


def rms(difference: Array) -> float:
    """Return the root of the mean square."""
    return float(np.sqrt(np.mean(difference**2)))


@pytest.mark.slow
def test_large_radius_is_straight() -> None:
    """R = 1e8 m gives the force of the straight line within 0.02 N rms, and the difference falls
    as 1/R from 1e6 m on."""
    found = [rms(force(line(arc(radius))) - straight_force()) for radius in (1e6, 1e7, 1e8)]
    assert found[2] < 0.02
    assert found[0] / found[1] == pytest.approx(10.0, rel=0.1)
    assert found[1] / found[2] == pytest.approx(10.0, rel=0.2)


@pytest.mark.slow
@pytest.mark.parametrize("backend", ["native", "reference"])
def test_mirrored_line_mirrors(backend: str) -> None:
    """A curve to the right with staggers of the other sign gives the same force to rounding."""
    case = line(arc(900.0, cant=0.1), supports__contact_stagger=OUTSIDE)
    other = line(arc(900.0, "right", 0.1), supports__contact_stagger=tuple(-y for y in OUTSIDE))
    one, other = (first_forces(shortened(c), backend) for c in (case, other))
    assert one.max() > 100.0
    assert np.abs(one - other).max() < 1e-9


def shortened(case: Case) -> Case:
    """Return the first three spans of a line, coarsely divided."""
    coarse = {"settings.nodes_between_droppers": 3}
    staggers = case.supports.contact_staggers(SPANS + 1)[:4]
    first = {"line.spans": 3, "settings.section": (2, 2), "supports.contact_stagger": staggers}
    return case.with_(**coarse, **first)


def turned(side: str) -> str:
    """Return the other side."""
    return "right" if side == "left" else "left"


@pytest.mark.slow
@pytest.mark.parametrize("ends", [("anchored", "weighted"), ("weighted", "anchored")])
def test_line_run_from_the_other_end(ends: tuple[str, str]) -> None:
    """Counted from its other end and run backwards, a line gives the same force to 1e-3 N, with
    changing cant and with its weights at either end."""
    pieces: list[dict[str, Any]] = [
        {**piece, **({"side": turned(piece["side"])} if "side" in piece else {})}
        for piece in reversed(CANTED)
    ]
    pieces[0], pieces[-1] = {"straight": 30.0}, {"straight": 40.0}
    ahead, (left, right) = [*CANTED[:-1], {"straight": 30.0}], ends
    one = line(ahead, supports__contact_stagger=OUTSIDE, line__ends={"left": left, "right": right})
    other = line(
        pieces,
        supports__contact_stagger=tuple(-y for y in OUTSIDE),
        line__ends={"left": right, "right": left},
        scenario__direction="-x",
    )
    assert rms(force(one) - force(other)) < 1e-3


MOTIONS: dict[str, Callable[[Track], Track]] = {
    "translated": lambda track: replace(track, start=np.array([120.0, -30.0, 0.0])),
    "lifted": lambda track: replace(track, start=np.array([0.0, 0.0, 90.0])),
    "rotated": lambda track: replace(track, heading=0.7),
    "rotated on the axes": lambda track: replace(track, heading=np.pi / 2.0),
}


@pytest.mark.slow
@pytest.mark.parametrize("motion", MOTIONS)
def test_moved_line_is_the_same(motion: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Translated, lifted or rotated about the vertical, a line gives the same force to 0.02 N."""
    case = line({"pieces": CANTED, "profile": HILL}, supports__contact_stagger=OUTSIDE)
    still = force(case)
    monkeypatch.setattr(expansion, "alignment", lambda *a: MOTIONS[motion](alignment(*a)))
    assert rms(force(case) - still) < 0.02


def test_reference_and_native_agree() -> None:
    """On a canted curve over a hill both time integrations give the same force."""
    case = shortened(line({"pieces": CANTED, "profile": HILL}, supports__contact_stagger=OUTSIDE))
    one, other = (first_forces(case, backend) for backend in ("native", "reference"))
    assert one.max() > 100.0
    assert rms(one - other) < 2e-5


TRACKS: dict[str, Any] = {
    "arc": arc(600.0),
    "canted": CANTED,
    "hill": {"profile": HILL},
    "all": {"pieces": CANTED, "profile": HILL},
}


@pytest.mark.parametrize("track", TRACKS)
@pytest.mark.parametrize("motion", ["swinging", "vertical"])
def test_shape_is_an_equilibrium(track: str, motion: str) -> None:
    """Found in at most 12 iterations; reactions carry the weight to 0.01 %; the line at rest, with
    all its supports, is in balance to 1e-4 N."""
    case = line(TRACKS[track], supports__contact_stagger=OUTSIDE, supports__arm={"motion": motion})
    if track == "hill":
        case = case.with_(**{"supports.contact_stagger": 0.2})
    model, shape = shape_of(case)
    assert shape.iterations <= 12
    assert shape.reaction == pytest.approx(shape.weight, rel=1e-9)
    system = equations(model, shape)
    unbalanced = internal_force(system, system.position).nodal - system.load
    assert np.abs(np.where(system.fixed, 0.0, unbalanced)).max() < 1e-4


def test_arms_carry_the_pull_of_the_curve() -> None:
    """A bare contact wire pulls every inner support inwards with 2 T sin(L/2R)."""
    radius, bare = 800.0, {**AC_SIMPLE, "schema": 2, "track": arc(800.0), "droppers": []}
    bare["wires"] = {"contact": AC_SIMPLE["wires"]["contact"]}
    bare["supports"] = {"closure": "height", "contact_stagger": OUTSIDE}
    bare["line"] = {"spans": SPANS, "span_length": SPAN}
    bare["settings"] = {"nodes_between_droppers": 41, "section": [3, 4]}
    _, shape = shape_of(Case.model_validate(bare))
    lateral = shape.arm_forces * np.cos(shape.arm_angles)
    wanted = 2.0 * 22e3 * np.sin(0.5 * SPAN / radius)
    assert lateral[1:-1] == pytest.approx(np.full(SPANS - 3, wanted), rel=1e-4)
    wire = np.interp(shape.arm_ends[:, 0], shape.contact.s, shape.contact.position[:, 1])
    assert (shape.arm_ends[:, 1] < wire).all()


def test_side_of_given_arms_follows_the_curve() -> None:
    """Arms of given inclination stand outside a curve, on alternating sides of a straight."""
    given = {"supports__closure": "arm", "supports__arm": {"angle": 0.15}}
    _, curved = shape_of(line(arc(600.0), supports__contact_stagger=0.02, **given))
    _, flat = shape_of(line([], **given))
    assert (curved.arm_ends[:, 1] < -1.0).all()
    assert np.array_equal(np.sign(flat.arm_ends[:, 1]), [-1.0, 1.0, -1.0, 1.0, -1.0])


def test_gradient_takes_the_weight_along() -> None:
    """On a gradient of 30 per mille the wires' pulls at the upper and the lower end differ by the
    weight along the track; the arms' outer halves hang elsewhere."""
    gradient = 0.03
    profile = [{"at": 0.0, "height": 0.0}, {"at": 330.0, "height": 330.0 * gradient}]
    model, shape = shape_of(line({"profile": profile}))
    kind = model.line.registrations[0].kind
    arms = sum(0.5 * kind.carried_weight(9.81) for _ in model.line.registrations)
    assert shape.end_pulls.sum() == pytest.approx((shape.weight - arms) * gradient, rel=1e-9)
    assert shape.dropper_heights == pytest.approx(find_shape(build(line([]))).dropper_heights)


def test_weights_keep_the_tension_on_a_gradient() -> None:
    """With weights at both ends of a gradient of 30 per mille each wire has its tension at both;
    the fixed point takes the weight along the track, without the outer halves of the
    arms at other masts."""
    gradient, fixed = 0.03, 4
    profile = [{"at": 0.0, "height": 0.0}, {"at": 330.0, "height": 330.0 * gradient}]
    lengths = [{"name": "T1", "masts": [1, SPANS + 1], "ends": "weighted", "fixed_point": fixed}]
    level = shape_of(line([], tension_lengths=lengths))[1]
    model, shape = shape_of(line({"profile": profile}, tension_lengths=lengths))
    assert shape.end_pulls == pytest.approx(level.end_pulls, rel=1e-12)
    assert shape.reaction == pytest.approx(shape.weight, rel=1e-9)
    taken = sum(
        one.along + gradient * one.vertical
        for one in support_forces(model, shape)
        if one.support == fixed
    )
    kind = model.line.registrations[0].kind
    arms = sum(0.5 * kind.carried_weight(9.81) for _ in model.line.registrations[1:])
    assert taken == pytest.approx(-(shape.weight - arms) * gradient, rel=1e-4)


def test_frame_of_the_track_accelerates_the_stages() -> None:
    """Over a crest of radius R every stage seems lighter by m v^2/R; in a canted curve heavier by
    m v^2/R times the sine of the cant angle."""
    speed, mass = 60.0, 8.0
    given = PantographInput(one_stage(mass), 0.0, 150.0, 5.3, speed, np.array([100.0]), 0.0)
    profile = {"profile": HILL}
    over = moved(given, track=alignment(line(profile).track, line(profile).line))
    crest = 1.0 / 6000.0
    slope = np.interp(150.0, [150.0 - 60.0, 150.0 + 60.0], [0.02, -1.0 / 180.0])
    expected = 100.0 + mass * speed**2 * crest / np.sqrt(1.0 - slope**2)
    assert over.external(0.0)[0] == pytest.approx(expected, rel=1e-4)
    canted = line(arc(900.0, cant=0.12))
    curve = moved(given, track=alignment(canted.track, canted.line))
    assert curve.external(0.0)[0] == pytest.approx(100.0 - mass * speed**2 / 900.0 * 0.08)


@pytest.mark.slow
@pytest.mark.parametrize("backend", ["native", "reference"])
def test_wire_beside_the_head_ends_the_passage(backend: Any) -> None:
    """A head that no wire reaches stops the time integration; it does not run on without force."""
    case = shortened(line([]))
    model, shape = shape_of(case)
    (given,) = plan_passage(model, shape, case.uplift_forces()).pantographs
    options = StepOptions(Newmark(), 1e-3, 5e4, tolerance=3e-8)
    short = moved(given, reach=0.17)
    stepper = make_stepper(equations(model, shape), (short,), options, np.array([0]), backend)
    block = stepper.advance(2000)
    assert block.status is Status.OFF_THE_LINE
    lateral = np.interp(
        short.position(block.time[-1]), shape.contact.s, shape.contact.position[:, 1]
    )
    assert abs(lateral) == pytest.approx(0.17, abs=0.01)


def test_condition_that_changes_nothing_gives_the_design() -> None:
    """On a canted curve over a hill a condition without change is the design."""
    case = line({"pieces": CANTED, "profile": HILL}, supports__contact_stagger=OUTSIDE)
    case = case.with_(conditions=({"name": "same"},))
    design = find_shape(build(case))
    same = operate(build(case.with_condition("same")), design)
    assert np.abs(same.position - design.position).max() < 1e-8
    assert same.arm_forces == pytest.approx(design.arm_forces, rel=1e-6)
    assert same.arm_ends == pytest.approx(design.arm_ends, abs=1e-8)


def test_stored_shape_keeps_its_frame(tmp_path: Path) -> None:
    """A static state that is written and read has the same heights and staggers."""
    case = line({"pieces": CANTED, "profile": HILL}, supports__contact_stagger=OUTSIDE)
    _, shape = shape_of(case)
    save_equilibrium(shape, tmp_path / "shape.nc", case)
    read, again = load_equilibrium(tmp_path / "shape.nc")
    assert read == case
    assert np.array_equal(again.contact.position, shape.contact.position)
    at_masts = np.interp(again.support_x, again.contact.s, again.contact.position[:, 1])
    assert at_masts == pytest.approx(OUTSIDE, abs=1e-9)


@pytest.mark.slow
def test_overlap_in_a_curve_of_the_library() -> None:
    """The head goes over from one tension length to the next in a canted curve, natively; both
    wires stay on the head, and the shape takes at most 12 iterations."""
    model, shape = shape_of(load_case("ac-simple-curve", {"settings.band": 20}))
    assert shape.iterations <= 12
    assert shape.reaction == pytest.approx(shape.weight, rel=1e-9)
    run = simulate(model, shape, backend="native")
    (record,) = run.pantographs
    first, second = np.nan_to_num(record.wire_forces.T)
    assert first[record.position > 620.0].max() == 0.0
    assert second[record.position < 430.0].max() == 0.0
    assert np.sum((first > 0.0) & (second > 0.0)) > 10
