"""Cantilevers that turn take their share of the tension: closed form, both signs, nothing."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tautwire.analyses.design.supports import support_forces
from tautwire.analyses.design.tensions import tension_profiles
from tautwire.errors import InputError
from tautwire.formulas.temperature import tension_at_fixed_point
from tautwire.inputs.load import make_case
from tautwire.model.build import build
from tautwire.specs.case import Case

from .test_conditions import ALPHA, EA, T, at, bare, states

SPAN, SPANS, RADIUS, ARM, WARMING = 50.0, 12, 1000.0, 4.0, 40.0
ENDS = {"left": "anchored", "right": "weighted"}


def half_length(
    hinge: float | None, *, stiffness: float = EA, curved: bool = True, warming: float = WARMING
) -> Case:
    """Return half a tension length of a single wire from its fixed point to its weights."""
    stagger = 0.0 if curved else 0.2
    data = bare(at(15.0 + warming), spans=SPANS, span=SPAN, ends=ENDS, stagger=stagger).to_dict()
    data["wires"]["contact"]["axial_stiffness"] = stiffness
    data["settings"]["nodes_between_droppers"] = 10
    data["supports"]["hinge"] = hinge
    if curved:
        data["track"] = [{"arc": SPAN * SPANS, "radius": RADIUS, "side": "left"}]
    return make_case(data)


def fixed_tension(case: Case) -> float:
    """Return the tension at the fixed point in the condition of a case [N]."""
    (shape,) = states(case)[1].values()
    return -float(shape.end_pulls[0, 0])


@pytest.mark.parametrize("pull_off", [True, False])
def test_tension_drop_is_the_closed_form(pull_off: bool) -> None:
    """In a curve hinged cantilevers of length d change the tension at the fixed point to
    ``T exp(-alpha dT s^2 / 2Rd)``, within 2 % of the change for a stiff wire; the supports stand at
    L, 2L ... s - L, whose sum is that of an even load over ``sqrt(s (s - L))``."""
    hinge = -ARM if pull_off else ARM  # a curve to the left pulls the wire away from the right
    cases = (half_length(one, stiffness=10 * EA) for one in (hinge, None))
    found, free = map(fixed_tension, cases)
    s = SPAN * SPANS
    radius = RADIUS if pull_off else -RADIUS
    distance = math.sqrt(s * (s - SPAN))
    expected = T - tension_at_fixed_point(T, distance, ALPHA * WARMING, radius, ARM)
    assert free - found == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize("pull_off", [True, False])
def test_tension_drop_of_an_elastic_wire(pull_off: bool) -> None:
    """Support by support, ``dT = T (L/R) u/d`` with the travel u of a wire that also gives way to
    the change of its tension, within 2 %."""
    sign = 1.0 if pull_off else -1.0
    tension = np.full(SPANS, T)
    for _ in range(30):
        u = np.cumsum(SPAN * (ALPHA * WARMING + (tension - T) / EA))
        for i in range(SPANS - 1, 0, -1):
            mean = 0.5 * (tension[i] + tension[i - 1])
            tension[i - 1] = tension[i] - sign * mean * SPAN / RADIUS * u[i - 1] / ARM
    found, free = (fixed_tension(half_length(one)) for one in (-sign * ARM, None))
    assert free - found == pytest.approx(T - tension[0], rel=0.02)


def test_zigzag_cancels_on_straight_track() -> None:
    """On straight track with all masts on one side pull-off and push-off take turns: what one takes
    the next gives back, and the change alternates from span to span."""
    case = half_length(-ARM, curved=False)
    free = fixed_tension(half_length(None, curved=False))
    last = 4.0 * T * 0.2 / SPAN * ALPHA * WARMING * SPAN * SPANS / ARM
    assert abs(fixed_tension(case) - free) < last
    model = build(case.with_condition("55 degC"))
    (shape,) = states(case)[1].values()
    (profile,) = tension_profiles(model, shape)
    steps = np.diff(profile.tension)[4:]
    assert np.all(steps[1:] * steps[:-1] < 0.0)
    travel = ALPHA * WARMING * np.array(profile.spans[:-1]) * SPAN
    expected = 4.0 * T * 0.2 / SPAN * travel[4:] / ARM
    assert np.abs(steps) == pytest.approx(expected, rel=0.15)


def test_cantilevers_take_the_wire_towards_the_mast() -> None:
    """A cantilever turned by u/d holds the wire nearer to its mast by d - sqrt(d^2 - u^2)."""
    (shape,) = states(half_length(-ARM))[1].values()
    (free,) = states(half_length(None))[1].values()
    at_mast = [int(np.abs(free.contact.s - SPAN * n).argmin()) for n in (6, 11)]
    moved = shape.contact.position[at_mast, 1] - free.contact.position[at_mast, 1]
    u = free.contact.position[at_mast, 0] - free.contact.s[at_mast]
    assert moved == pytest.approx(-(ARM - np.sqrt(ARM**2 - u**2)), rel=0.1)


def test_nothing_turns_without_travel() -> None:
    """At the temperature of the design hinges change nothing."""
    design, found = states(half_length(-ARM, warming=0.0))
    assert np.abs(found["15 degC"].position - design.position).max() < 1e-9


def test_hinge_at_the_wire_is_refused() -> None:
    """A hinge where the wire is has no lever."""
    with pytest.raises(InputError, match=r"supports\.hinge"):
        half_length(0.1)


def test_masts_take_what_the_wire_loses() -> None:
    """Along the track a mast is pulled by its lateral force times u/d, and all masts together by
    what the wire loses from its weights to its anchor."""
    case = half_length(-ARM, curved=False)
    (shape,) = states(case)[1].values()
    forces = support_forces(build(case.with_condition("55 degC")), shape)
    assert abs(sum(one.along for one in forces)) < 0.1
    for one in forces[1:-1]:
        travel = ALPHA * WARMING * one.x
        distance = -ARM - one.lateral_position
        assert one.along == pytest.approx(-one.lateral * travel / distance, rel=0.05)


def test_fixed_point_holds_in_a_curve() -> None:
    """Weighted at both ends, a wire travels from its fixed point in a curve as on the straight."""
    lengths = [{"name": "T1", "masts": [1, 5], "ends": "weighted", "fixed_point": 2}]
    track = [{"arc": 4 * SPAN, "radius": RADIUS, "side": "left"}]
    data = bare(at(55.0), spans=4, span=SPAN).to_dict()
    case = make_case(data | {"tension_lengths": lengths, "track": track})
    design, found = states(case)
    moved = found["55 degC"].contact.position[:, 0] - design.contact.position[:, 0]
    s = design.contact.s - SPAN
    assert np.abs(moved[np.abs(s) < 1e-6]).max() < 1e-5
    assert moved[[0, -1]] == pytest.approx(ALPHA * WARMING * s[[0, -1]], rel=2e-3)
