"""Supports that differ from mast to mast, and stops that the wire meets when it rises."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tautwire as tw
from tautwire.assessment.checks import checks
from tautwire.errors import InputError
from tautwire.model.equations import equations
from tautwire.model.passage import plan_passage
from tautwire.numerics.motion import backend
from tautwire.numerics.motion.stepper import StepOptions
from tautwire.numerics.newmark import Newmark

from ..lines import HAS_CORE, ac_simple, found, loaded

SHORT: dict[str, Any] = {
    "line.spans": 6,
    "scenario.speed": "250 km/h",
    "scenario.uplift_force": "150 N",
    "settings.time_step": "2 ms",
    "settings.nodes_between_droppers": 3,
    "settings.section": None,
}
TYPES = [{"name": "short", "arm": {"length": "0.9 m", "mass": "1 kg/m", "angle": "8 deg"}}]


def run_of(**changes: Any) -> tw.Run:
    """Return a passage of a short line."""
    model = tw.build(ac_simple(**SHORT, **changes))
    return tw.simulate(model, tw.find_shape(model))


@pytest.fixture(scope="module")
def free() -> tw.Run:
    """Return the passage without stops."""
    return run_of()


def test_stop_out_of_reach_changes_nothing(free: tw.Run) -> None:
    """A stop that no wire reaches leaves the forces as they are, to the solver's tolerance."""
    run = run_of(**{"supports.stop": {"gap": "0.5 m"}})
    force, other = (r.pantographs[0].contact_force for r in (free, run))
    assert np.abs(force - other).max() < 0.02
    assert not any("uplift stop" in text for text in tw.run(run.case).warnings)


def test_stop_holds_the_wire(free: tw.Run) -> None:
    """A stop at half the uplift is met; the wire rises by little more than the gap."""
    row = int(np.flatnonzero(free.equilibrium.support_number == 4)[0])
    gap = 0.5 * float(free.support_uplift[:, row].max())
    run = run_of(**{"supports.stop": {"gap": gap, "stiffness": "500 kN/m"}})
    assert gap < float(run.support_uplift[:, row].max()) < 1.25 * gap


@pytest.mark.skipif(not HAS_CORE, reason="no compiled core here")
def test_backends_agree_on_stops() -> None:
    """The compiled core and the reference meet a stop alike, while a head runs below it."""
    stop = {"supports.stop": {"gap": "1 mm"}, "settings.start": "50 m", "settings.ramp": 0.0}
    model, shape, system = found(ac_simple(**{**SHORT, **stop, "line.spans": 2}))
    heads = plan_passage(model, shape, model.case.uplift_forces()).pantographs
    at = 6 * model.mesh.nodes(at for _, at in model.line.contact_supports) + 2
    options = StepOptions(
        integrator=Newmark(), time_step=1e-3, contact_stiffness=5e4, tolerance=1e-12
    )
    native, reference = (
        backend.make_stepper(system, heads, options, at, choice).advance(150)
        for choice in ("native", "reference")
    )
    rise = native.observed - shape.position[at]
    assert rise.max() > 1e-3
    np.testing.assert_allclose(native.contact_force, reference.contact_force, rtol=0.0, atol=1e-5)
    np.testing.assert_allclose(native.observed, reference.observed, rtol=0.0, atol=1e-10)


def test_stop_under_a_force(free: tw.Run) -> None:
    """A wire pushed at its support has the flexibility of the line up to the gap, then less.

    ``u = (F + k gap) / (1/e + k)`` with the flexibility e, which is nearly constant here.
    """
    gap, stiffness, force = 0.01, 5e4, 200.0
    shape = free.equilibrium
    row = int(np.flatnonzero(shape.support_number == 4)[0])
    model = tw.build(ac_simple(**SHORT, **{"supports.stop": {"gap": gap, "stiffness": stiffness}}))
    bare = tw.build(ac_simple(**SHORT))
    node = shape.contact.nodes[np.abs(shape.contact.s - shape.support_x[row]).argmin()]
    load = np.zeros(shape.position.size)
    load[6 * node + 2] = 1.0

    def rise(of: tw.Model, size: float) -> float:
        pushed = loaded(equations(of, tw.find_shape(of)), size * load)
        return float(pushed.position[6 * node + 2] - shape.position[6 * node + 2])

    small = gap / 2.0 / (rise(bare, 1.0))
    assert rise(model, small) == pytest.approx(rise(bare, small), rel=1e-9)
    held = rise(model, force)
    carried = force - stiffness * (held - gap)
    assert rise(bare, carried) == pytest.approx(held, rel=5e-4)  # the bar leans by 2 mm on 10 m


def test_met_stops_are_told(tmp_path: Path) -> None:
    """A stop that is met is a warning of the run with place, instant and gap, and a limit."""
    case = ac_simple(**SHORT, **{"supports.stop": {"gap": "8 mm"}})
    run = tw.run(case)
    (first, *_) = [text for text in run.warnings if text.startswith("uplift stop")]
    assert "gap 8.0 mm" in first
    assert "at t = " in first
    (row,) = [r for r in checks(tw.contact_statistics(run), case) if "uplift stop" in r.name]
    assert row.limit == pytest.approx(8e-3 / 1.5)
    assert row.within is False


def test_type_everywhere_is_no_type(free: tw.Run) -> None:
    """A type with the arm that all have, at every support, changes nothing."""
    arm = free.case.supports.arm.model_dump()
    types = {"supports.types": [{"name": "usual", "arm": arm}], "supports.type": ["usual"] * 7}
    force = run_of(**types).pantographs[0].contact_force
    assert np.array_equal(force, free.pantographs[0].contact_force)


def test_arms_of_a_type() -> None:
    """Where a type stands, the arm has its length, its mass hangs there, and its side is kept."""
    own = [None, None, "short", None, "short", None, None]
    model = tw.build(ac_simple(**SHORT, **{"supports.types": TYPES, "supports.type": own}))
    shape = tw.find_shape(model)
    r = np.column_stack([np.interp(shape.support_x, shape.contact.s, c)
                         for c in shape.contact.position.T])  # fmt: skip
    at = shape.arm_supports - 1
    lengths = np.linalg.norm((shape.arm_ends - r[at])[:, 1:], axis=1)
    numbers = shape.support_number[at]
    wanted = np.where(np.isin(numbers, (3, 5)), 0.9, 1.22)
    assert lengths == pytest.approx(wanted, abs=1e-3)
    assert shape.reaction == pytest.approx(shape.weight, rel=1e-10)


@pytest.mark.parametrize(
    ("supports", "words"),
    [
        ({"type": [None, "x", *[None] * 5], "types": TYPES}, "got 'x'; a type is one of short"),
        ({"type": [None, "short", None], "types": TYPES}, "supports.type: has 3 values; 6 spans"),
        ({"type": [None, "x", *[None] * 5]}, "a type is described in supports.types, or null"),
        ({"types": [*TYPES, *TYPES]}, "'short' is there twice; rename one"),
        ({"types": [{"name": "a", "share": 0.3}]}, "belongs to closure 'lift'; the"),
        ({"types": [{"arm": {}}]}, "name"),
        ({"stop": {}}, "gap"),
        ({"stop": {"gap": "-1 mm"}}, "supports.stop.gap: got '-1 mm' (-0.001 m); must be"),
        ({"stop": {"gap": "80 mm", "stiffness": 0}}, "supports.stop.stiffness: got 0"),
        ({"stop": "80 mm"}, "supports.stop"),
    ],
)  # fmt: skip
def test_bad_supports(supports: dict[str, Any], words: str) -> None:
    """What is impossible about types and stops is refused with its place."""
    changes = {f"supports.{key}": value for key, value in supports.items()}
    with pytest.raises(InputError) as caught:
        tw.load_case("ac-simple", {"line.spans": 6, **changes})
    assert words in str(caught.value)
