"""Lines of any topology: equalities and balances that need no reference."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pydantic import ValidationError

from tautwire.analyses.road.dynamics import Choices, Simulation, simulate
from tautwire.analyses.road.elasticity import elasticity
from tautwire.analyses.road.shape import RESIDUAL, find_shape
from tautwire.errors import ModelError
from tautwire.inputs.load import load_case
from tautwire.line.expand import expand
from tautwire.model.build import build
from tautwire.model.equations import equations
from tautwire.numerics.elements import ancf
from tautwire.numerics.network.banded import Pattern
from tautwire.numerics.network.system import internal_force
from tautwire.numerics.statics.form_finding import find_form
from tautwire.results.equilibrium import Equilibrium
from tautwire.results.run import Run
from tautwire.specs.case import Case
from tautwire.status import Status

from ..lines import AC_SIMPLE, HAS_CORE

Array = NDArray[np.float64]
Record = Callable[..., bool]


def simple(**line: Any) -> dict[str, Any]:
    """Return AC simple as plain data, at 250 km/h, on a coarse mesh."""
    data = deepcopy(AC_SIMPLE)
    data["line"] |= line
    data["scenario"] = {"speed": 250 / 3.6, "uplift_force": 130.0}
    data["settings"] |= {"nodes_between_droppers": 4, "backend": "reference"}
    return data


def halved(wire: dict[str, Any]) -> dict[str, Any]:
    """Return a wire of half the tension, mass and stiffness."""
    return {name: 0.5 * value for name, value in wire.items()}


def twin() -> dict[str, Any]:
    """Return AC simple with its contact wire split in two halves without lateral distance."""
    data = simple()
    half = halved(data["wires"]["contact"])
    data["wires"] |= {"contact": half, "contact-2": {**half, "role": "contact"}}
    drop = data["droppers"]
    drop |= {"stiffness": 1e5, "mass": 0.5 * drop["mass"]}
    drop |= {name: 0.5 * drop[name] for name in ("clamp_contact", "clamp_messenger")}
    data["droppers"] = [{**drop, "to": "contact"}, {**drop, "to": "contact-2"}]
    data["supports"]["arm"] = {"mass": 0.5 * 0.73, "axial_stiffness": 0.5 * 17e6}
    data["settings"]["contact_stiffness"] = 1e5
    return data


def stitched(**stitch: Any) -> dict[str, Any]:
    """Return a stitched line of spans of 65 m."""
    data = simple(span_length=65.0)
    data["wires"]["contact"]["tension"], data["wires"]["messenger"]["tension"] = 27e3, 21e3
    wire = {"tension": 3.5e3, "mass": 0.31, "axial_stiffness": 3.9e6, "bending_stiffness": 20.0}
    place = {"role": "stitch", "from": -9.0, "to": 9.0, "clamped_to": "messenger"}
    data["wires"]["stitch"] = wire | place | stitch
    data["supports"]["encumbrance"] = 1.8
    drop = data["droppers"]
    between = {"positions": [11.5, 20.0, 28.5, 36.5, 45.0, 53.5], "presag": [0.0] * 6}
    about = {"from": "stitch", "about": "mast", "positions": [-5.0, 5.0], "presag": [0.0, 0.0]}
    data["droppers"] = [{**drop, **between}, {**drop, **about}]
    return data


def compound() -> dict[str, Any]:
    """Return a line with an auxiliary messenger wire."""
    data = simple()
    wire = {"tension": 12e3, "mass": 0.9, "axial_stiffness": 10e6, "bending_stiffness": 80.0}
    data["wires"]["auxiliary"] = {**wire, "below": 1.1}
    data["supports"]["encumbrance"] = 1.9
    drop = data["droppers"]
    upper = {"to": "auxiliary", "positions": [5.0, 16.0, 27.5, 39.0, 50.0], "presag": None}
    lower = {"from": "auxiliary", "positions": [2.5, 12.0, 22.0, 33.0, 43.0, 52.5]}
    lower["presag"] = [0.0, 0.02, 0.04, 0.04, 0.02, 0.0]
    data["droppers"] = [{**drop, **upper}, {**drop, **lower}]
    return data


def overlapping() -> dict[str, Any]:
    """Return two tension lengths that share three spans."""
    data = simple(spans=9)
    data["tension_lengths"] = [
        {"name": "T1", "masts": [1, 6], "ends": {"left": "anchored", "right": "weighted"}},
        {"name": "T2", "masts": [3, 10], "ends": "weighted", "fixed_point": 8},
    ]
    data["overlaps"] = [{"kind": "three-span", "rise": 0.3}]
    data["settings"]["section"] = [3, 6]
    return data


LINES = {"twin": twin, "stitched": stitched, "compound": compound, "overlap": overlapping}


def shape_of(data: dict[str, Any]) -> Equilibrium:
    return find_shape(build(Case.model_validate(data)))


def passed(data: dict[str, Any], duration: float) -> Run:
    """Return the beginning of a passage."""
    model = build(Case.model_validate(data))
    return simulate(model, find_shape(model), watch=lambda progress: progress.time >= duration)


def difference(a: Run, b: Run) -> float:
    """Return the rms of the difference of two contact forces [N]."""
    forces = [run.pantographs[0].contact_force for run in (a, b)]
    return float(np.sqrt(np.mean((forces[0] - forces[1]) ** 2)))


@pytest.mark.parametrize("name", LINES)
def test_shapes_are_in_balance(name: str) -> None:
    """Every topology is found in at most 12 Newton iterations; the supports carry its weight to
    0.01 %, and the equations of motion built from it are in balance to 1e-4 N."""
    model = build(Case.model_validate(LINES[name]()))
    shape = find_shape(model)
    assert shape.iterations <= 12
    assert shape.reaction == pytest.approx(shape.weight, rel=1e-4)
    system = equations(model, shape)
    residual = internal_force(system, shape.position).nodal - system.load
    assert np.abs(residual[~system.fixed]).max() <= 1e-4


@pytest.mark.parametrize("name", [*LINES, "simple"])
def test_found_lengths_give_the_heights_back(name: str) -> None:
    """With the found length given at every hanger, those of raised wires included, the shape that
    was found for given heights follows again from the first guess, to 0.001 mm."""
    model = build(Case.model_validate({"simple": simple, **LINES}[name]()))
    heights = find_form(model.form, RESIDUAL)
    given = model.form.system.with_(ties=heights.system.ties)
    slots = np.full(len(given.ties), -1)
    lengths = find_form(replace(model.form, system=given, tie_slot=slots), RESIDUAL)
    assert heights.newton.status is lengths.newton.status is Status.DONE
    r = [form.system.position.reshape(-1, 6)[:, :3] for form in (heights, lengths)]
    assert np.abs(r[0] - r[1]).max() <= 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("name", ["stitched", "twin", "compound"])
def test_statics_on_the_usual_mesh_are_converged(name: str, record_validation: Record) -> None:
    """On the mesh of a case that says nothing of it, dropper lengths, dropper forces, reactions and
    elasticity are within 0.3 mm, 0.2 %, 0.1 % and 0.2 % of those with even elements of 0.1 m."""
    found = []
    for settings in ({}, {"longest_element": 0.1, "graded_mesh": False}):
        data = LINES[name]()
        data["settings"] = {"contact_stiffness": 2e5, "section": [2, 2], **settings}
        model = build(Case.model_validate(data))
        shape = find_shape(model)
        found.append((shape, elasticity(model, shape).elasticity))
    (usual, soft), (fine, reference) = found
    lengths = usual.dropper_lengths_unstrained - fine.dropper_lengths_unstrained
    changes = {
        "dropper lengths": (1e3 * np.abs(lengths).max(), "mm", 0.3),
        "dropper forces": (furthest(usual.dropper_forces, fine.dropper_forces), "%", 0.2),
        "forces of steady arms": (furthest(usual.arm_forces, fine.arm_forces), "%", 0.1),
        "elasticity": (furthest(soft, reference), "%", 0.2),
    }
    for quantity, (value, unit, limit) in changes.items():
        assert record_validation(
            f"Statics on the usual mesh, {name} line",
            f"largest error of {quantity}",
            ours=float(value),
            unit=unit,
            allowed=(0.0, limit),
            source="even elements of 0.1 m",
        )


def furthest(a: Array, b: Array) -> float:
    """Return the largest relative difference [%]."""
    return 100.0 * float(np.abs(a / b - 1.0).max())


@pytest.mark.parametrize("name", ["twin", "stitched", "compound"])
def test_lengths_reproduce_heights(name: str) -> None:
    """The lengths that belong to given heights give these heights back, to 0.001 mm."""
    data = LINES[name]()
    model = build(Case.model_validate(data))
    shape = find_shape(model)
    sets = data["droppers"] if isinstance(data["droppers"], list) else [data["droppers"]]
    masts = np.array(model.line.masts)
    given = []
    for one in sets:
        upper, lower = one.get("from", "messenger"), one.get("to", "contact")
        rows: dict[int, list[tuple[float, float]]] = {}
        for hanger, length in zip(
            model.line.hangers, shape.dropper_lengths_unstrained, strict=True
        ):
            if not hanger.upper.run.startswith(upper) or hanger.lower.run != lower:
                continue
            s = hanger.lower.s
            about = one.get("about") == "mast"
            row = int(np.abs(masts - s).argmin()) - 1 if about else hanger.label.span - 1
            start = masts[row + 1] if about else masts[row]
            rows.setdefault(row, []).append((s - start, float(length)))
        table = [sorted(rows[row]) for row in sorted(rows)]
        given.append(
            {
                **one,
                "mode": "length",
                "presag": None,
                "positions": [[s for s, _ in row] for row in table],
                "lengths": [[length for _, length in row] for row in table],
            }
        )
    again = shape_of({**data, "droppers": given})
    assert again.dropper_heights == pytest.approx(shape.dropper_heights, abs=1e-6)
    assert again.position == pytest.approx(shape.position, abs=2e-6)


def test_joints_carry_the_stitch_tension() -> None:
    """At the clamps of a stitch wire its tension acts on the messenger wire, and between them the
    messenger wire's horizontal force is lower by it, to 1 % (read from the unstrained lengths)."""
    data = stitched()
    model = build(Case.model_validate(data))
    shape = find_shape(model)
    along = shape.joint_pulls[:, 0]
    assert along[0::2] == pytest.approx(3.5e3, rel=2e-3)
    assert along[1::2] == pytest.approx(-3.5e3, rel=1e-12)
    system = equations(model, shape)
    e = system.cables.coordinates(shape.position)
    force = ancf.force(e, system.cables.section)[2, 0]
    strand = model.mesh.strand("messenger")
    middle = 0.5 * (strand.s[1:] + strand.s[:-1])
    horizontal = force[strand.cables]
    inside, outside = np.abs(middle - 65.0) < 8.0, np.abs(middle - 97.5) < 20.0
    assert np.ptp(horizontal[inside]) <= 1e-3
    assert horizontal[outside].mean() - horizontal[inside].mean() == pytest.approx(3.5e3, rel=0.01)


def test_nodes_are_numbered_along_the_track() -> None:
    """Numbering nodes by chainage keeps the band of a stitched line narrow (41 unknowns at most),
    whatever the number of spans; wire by wire it would grow with the line."""
    for spans in (3, 6):
        model = build(
            Case.model_validate(stitched() | {"line": {"spans": spans, "span_length": 65}})
        )
        assert Pattern(model.form.system).bandwidth <= 41


@pytest.mark.slow
def test_two_half_wires_are_one() -> None:
    """A contact wire split into two halves (everything on it halved, no lateral distance) gives the
    same dropper lengths and the same contact force, 0.1 N rms."""
    one, two = passed(simple(), 0.9), passed(twin(), 0.9)
    assert difference(one, two) <= 0.1
    both = two.equilibrium.dropper_lengths_unstrained
    assert both[0::2] == pytest.approx(one.equilibrium.dropper_lengths_unstrained, abs=1e-5)


@pytest.mark.slow
def test_a_slack_light_stitch_wire_changes_nothing() -> None:
    """A soft stitch wire (EA 20 kN) of 20 N and 1e-3 kg/m without droppers leaves the simple line's
    contact force, 0.1 N rms; at EA 1 MN it stiffens the support noticeably (0.56 N)."""
    data = simple()
    without = passed(data, 0.9)
    wire = {"tension": 20.0, "mass": 1e-3, "axial_stiffness": 2e4, "bending_stiffness": 0.1}
    place = {"role": "stitch", "from": -4.5, "to": 4.5, "clamped_to": "messenger"}
    data = simple()
    data["wires"]["stitch"] = wire | place
    assert difference(without, passed(data, 0.9)) <= 0.1


@pytest.mark.slow
@pytest.mark.parametrize("name", ["stitched", "overlap"])
def test_mirrored_line_mirrors(name: str) -> None:
    """A line with opposite stagger gives the mirrored shape and the same contact force."""
    data = LINES[name]()
    mirrored = LINES[name]()
    mirrored["supports"]["contact_stagger"] *= -1.0
    if name == "overlap":
        data["overlaps"][0]["separation"] = mirrored["overlaps"][0]["separation"] = 0.0
    one, two = passed(data, 0.3), passed(mirrored, 0.3)
    a, b = (run.equilibrium.position.reshape(-1, 2, 3) for run in (one, two))
    assert a * [1.0, -1.0, 1.0] == pytest.approx(b, abs=1e-7)
    assert difference(one, two) <= 0.02


@pytest.mark.slow
def test_transfer_between_tension_lengths() -> None:
    """Through an overlap the pantograph changes wires: force on the first before, on the second
    after, on both in between, and the total never falls to the second wire alone being lifted off
    (the sum of the shares is the contact force)."""
    data = overlapping()
    data["settings"]["start"] = 120.0
    model = build(Case.model_validate(data))
    shape = find_shape(model)
    blocks = []
    for block in Simulation(model, shape, Choices()).blocks():
        blocks.append(block.steps)
        if block.progress.time > 2.2:
            break
    shares = np.concatenate([block.path_force for block in blocks])[:, 0]
    total = np.concatenate([block.contact_force for block in blocks])[:, 0]
    x = 120.0 + 250 / 3.6 * np.concatenate([block.time for block in blocks])
    assert np.nansum(shares, axis=1) == pytest.approx(total, abs=1e-9)
    before, after = (x > 140) & (x < 165), (x > 225) & (x < 260)
    assert (np.nan_to_num(shares[before, 1]) == 0.0).all()
    assert np.nan_to_num(shares[after, 0]).max() == 0.0
    assert shares[before, 0].mean() > 50.0
    assert shares[after, 1].mean() > 50.0
    both = (np.nan_to_num(shares) > 0.0).all(axis=1)
    assert both.any()
    assert ((x[both] > 165) & (x[both] < 220)).all()


@pytest.mark.parametrize("name", LINES)
def test_native_and_reference_agree(name: str) -> None:
    """Both backends give the same contact force, and the same share of every contact wire, to
    2e-5 N rms at a tolerance of 1e-11 m."""
    if not HAS_CORE:
        pytest.skip("no compiled core")
    data = LINES[name]()
    data["settings"] |= {"tolerance": 1e-11, "start": 150.0 if name == "overlap" else 5.0}
    model = build(Case.model_validate(data))
    shape = find_shape(model)
    native, reference = (
        simulate(model, shape, backend=choice, watch=lambda progress: progress.time >= 0.15)
        for choice in ("native", "reference")
    )
    assert native.counters["backend"].startswith("native")
    assert difference(native, reference) <= 2e-5
    shares = [run.pantographs[0].wire_forces for run in (native, reference)]
    assert shares[0] == pytest.approx(shares[1], abs=1e-3, nan_ok=True)


def test_messenger_below_the_wire_it_carries_is_refused() -> None:
    """An auxiliary wire that would lie above the sagging messenger wire is refused by dropper."""
    data = compound()
    data["wires"]["auxiliary"]["below"] = 0.3
    with pytest.raises(ModelError, match=r"dropper 3 of span 1 .*auxiliary.* would have to push"):
        shape_of(data)


def test_contact_wire_alone() -> None:
    """A contact wire without messenger wire (tram) hangs between springs: the sag is that of a
    string less what its bending stiffness takes away at both supports,
    m g L^2 / 8 T (1 - 4 sqrt(EI/T) / L)."""
    data = simple(span_length=30.0)
    del data["wires"]["messenger"]
    data["supports"] = {"closure": "spring", "spring": {"stiffness": 1e4}, "contact_stagger": 0.2}
    data["droppers"] = []
    data["settings"] |= {"nodes_between_droppers": 31, "graded_mesh": True}
    shape = shape_of(data)
    wire = shape.contact
    middle = float(np.interp(45.0, wire.s, wire.position[:, 2]))
    sag = 1.35 * 9.81 * 30.0**2 / (8.0 * 22e3) * (1.0 - 4.0 * np.sqrt(195.0 / 22e3) / 30.0)
    assert 5.3 - middle == pytest.approx(sag, rel=0.003)


def test_raised_wires_leave_the_running_height() -> None:
    """In an overlap the contact wire is raised at the support before its anchor by the given rise
    and has no droppers from where it leaves the running height."""
    line = expand(Case.model_validate(overlapping()))
    raised = [r for r in line.registrations if r.at.run == "T1 contact" and r.at.s == 55.0 * 4]
    assert raised[0].z == pytest.approx(5.6)
    last = max(h.lower.s for h in line.hangers if h.lower.run == "T1 contact" and h.lower.s < 220)
    way = np.sqrt(2.0 * 22e3 * (0.3 + 0.055) / (1.35 * 9.81))
    assert 220.0 - way - 5.75 < last <= 220.0 - way


@pytest.mark.parametrize("rise", [None, 0.25, 0.3, 0.35, 0.4, 0.45, 0.6, 0.8])
def test_raised_wires_keep_the_droppers_that_pull(rise: float | None) -> None:
    """Whatever the rise, 0.5 m if none is given, the last droppers of a raised wire pull."""
    data = LINES["overlap"]()
    data["overlaps"] = [{"kind": "three-span"} | ({} if rise is None else {"rise": rise})]
    model = build(Case.model_validate(data))
    shape = find_shape(model)
    running, raised = (model.line.masts[mast] for mast in (3, 4))
    hangers = [
        (h.lower.s, force)
        for h, force in zip(model.line.hangers, shape.dropper_forces, strict=True)
        if h.lower.run == "T1 contact"
    ]
    assert min(force for _, force in hangers) > 0.0
    kept = sum(running < s < raised for s, _ in hangers)
    assert kept >= (0 if rise == 0.8 else 1)


def test_droppers_of_two_messengers_at_one_place() -> None:
    """Two droppers at one place of a raised wire, one of given length, hang together or not."""
    data = overlapping()
    one = data["droppers"]
    wires = data["wires"]
    wires["messenger-2"] = {**wires["messenger"], "role": "messenger", "side": 0.3}
    lengths = [1.0] * len(one["positions"])
    other = {**one, "from": "messenger-2", "mode": "length", "presag": None, "lengths": lengths}
    model = build(Case.model_validate({**data, "droppers": [one, other]}))
    places = [h.lower.s for h in model.line.hangers if h.upper.run == "T1 messenger-2"]
    first = [h.lower.s for h in model.line.hangers if h.upper.run == "T1 messenger"]
    assert set(places) == set(first) - {model.line.masts[4]}


def test_head_on_two_half_wires_lifts_them_as_one() -> None:
    """Under a rigid head two half wires have the elasticity of the whole wire, to 1e-9."""
    values = []
    for data in (simple(), twin()):
        model = build(Case.model_validate(data))
        values.append(elasticity(model, find_shape(model)).elasticity)
    assert values[1] == pytest.approx(values[0], rel=1e-9)


def test_graded_mesh_gives_the_converged_lengths() -> None:
    """With nine nodes between attachments, graded, dropper lengths of a stitched line are within
    0.3 mm of those on a mesh four times as fine; nine even nodes miss them by millimetres."""
    lengths = {}
    for name, nodes, graded in (("even", 9, False), ("graded", 9, True), ("fine", 33, True)):
        data = stitched()
        data["settings"] |= {"nodes_between_droppers": nodes, "graded_mesh": graded}
        lengths[name] = shape_of(data).dropper_lengths_unstrained
    assert np.abs(lengths["graded"] - lengths["fine"]).max() <= 0.3e-3
    assert np.abs(lengths["even"] - lengths["fine"]).max() >= 2e-3


def test_longest_element_refines_long_intervals() -> None:
    """No element is longer than asked for, and no interval has fewer than it had."""
    data = simple()
    data["settings"]["longest_element"] = 0.5
    steps = [np.diff(s.s) for s in build(Case.model_validate(data)).mesh.strands]
    assert max(own.max() for own in steps) <= 0.5 + 1e-9
    assert min(own.max() for own in steps) >= 0.4


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"wires": {"stitch": {"to": -10.0}}}, "not right of"),
        ({"wires": {"stitch": {"clamped_to": "nothing"}}}, "there are the wires"),
        ({"wires": {"stitch": {"from": None}}}, "needs it"),
        ({"wires": {"stitch": {"below": 0.5}}}, "belongs to wires of role 'auxiliary' only"),
        ({"wires": {"stitch": {"role": "y"}}}, "role"),
        ({"wires": {"second": {"tension": 1e4, "mass": 1.0, "axial_stiffness": 1e7,
                               "bending_stiffness": 100.0}}}, "a wire that is not named after"),
        ({"supports": {"encumbrance": None}}, "height of the messenger wire"),
        ({"tension_lengths": [{"name": "T1", "masts": [1, 4], "ends": "weighted"}]}, "hold"),
        ({"tension_lengths": [{"name": "T1", "masts": [1, 3]}]}, "has supports 1 to 4"),
        ({"overlaps": [{"rise": 0.3}]}, "needs tension_lengths"),
    ],
)  # fmt: skip
def test_impossible_lines_are_refused(changes: dict[str, Any], message: str) -> None:
    """Contradictions about wires and tension lengths are refused when the case is read."""
    data = stitched()
    for part, values in changes.items():
        if isinstance(values, dict):
            for key, value in values.items():
                own = data[part].get(key)
                data[part][key] = {**own, **value} if isinstance(own, dict) else value
        else:
            data[part] = values
    with pytest.raises(ValidationError, match=message):
        Case.model_validate(data)


@pytest.mark.parametrize("split", [0.0, 30.0, 60.0])
def test_droppers_counted_from_masts_leave_a_wire_like_those_of_the_spans(split: float) -> None:
    """Where a raised wire leaves its droppers does not depend on whether they are counted along the
    span or from the mast on either side of it."""
    case = load_case("ac-simple-overlap")
    (one,) = case.dropper_sets
    positions = [x - 55.0 if x > split else x for x in one.positions]
    order = sorted(range(len(positions)), key=positions.__getitem__)
    about = {
        "droppers.about": "mast",
        "droppers.positions": [positions[n] for n in order],
        "droppers.presag": [one.presag[n] for n in order],
    }
    hung = [
        {(one.lower.run, round(one.lower.s, 3)) for one in expand(told).hangers}
        for told in (case, case.with_(**about))
    ]
    inside = [{place for place in places if 60.0 < place[1] < 985.0} for places in hung]
    assert inside[0] == inside[1]
    assert ("T1 contact", 505.25) in hung[0]
