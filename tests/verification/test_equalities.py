"""Forces under a passage that must be equal because the lines are the same line."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tautwire.analyses.force.statistics import contact_statistics
from tautwire.analyses.road.dynamics import simulate
from tautwire.analyses.road.pipeline import run_case
from tautwire.analyses.road.shape import find_shape
from tautwire.model.build import build
from tautwire.model.passage import plan_passage
from tautwire.numerics.motion.backend import Choice, make_stepper
from tautwire.numerics.motion.stepper import PantographInput, StepOptions
from tautwire.numerics.network.cuts import copies
from tautwire.numerics.network.parts import Clamps, Path
from tautwire.numerics.network.system import System, internal_force
from tautwire.numerics.newmark import Newmark
from tautwire.specs.case import Case

from ..lines import found
from .test_general_lines import LINES, simple

Array = NDArray[Any]
Record = Callable[..., bool]
CASE = "Equalities, force over a passage at 250 km/h"
STIFFNESS = 2e5


def rms(a: Array, b: Array) -> float:
    """Return the rms of the difference of two forces [N]."""
    return float(np.sqrt(np.mean((a - b) ** 2)))


def entering(data: dict[str, Any]) -> tuple[System, PantographInput, float]:
    """Return a line at rest, the pantograph that enters it, and the time of its passage [s]."""
    case = Case.model_validate(data)
    model, shape, system = found(case)
    plan = plan_passage(model, shape, case.uplift_forces())
    return system, plan.pantographs[0], plan.duration


def force(
    system: System,
    given: PantographInput,
    duration: float,
    *,
    stiffness: float = STIFFNESS,
    backend: Choice = "auto",
    tolerance: float = 1e-10,
) -> Array:
    """Return the contact force of a pantograph, ``(n_time,)`` [N]."""
    options = StepOptions(Newmark(), 1e-3, stiffness, tolerance=tolerance)
    run = make_stepper(system, (given,), options, np.empty(0, dtype=np.int64), backend)
    return run.advance(int(duration / 1e-3)).contact_force[:, 0]


def moved(system: System, by: tuple[float, float, float]) -> System:
    """Return a line somewhere else."""
    shift = np.array(by)
    position = system.position.reshape(-1, 2, 3).copy()
    position[:, 0] += shift
    stays = system.stays.with_(end=system.stays.end + shift)
    grounds = system.grounds.with_(free=system.grounds.free + shift)
    return system.with_(position=position.ravel(), stays=stays, grounds=grounds)


def beside(system: System, lateral: float) -> System:
    """Return a line and the same once more beside it, each with its contact wire as a path."""
    both, count = copies(system, 2), system.node_count
    position = both.position.reshape(2, -1, 2, 3).copy()
    position[1, :, 0, 1] += lateral
    ends, free = both.stays.end.copy(), both.grounds.free.copy()
    ends[len(system.stays) :, 1] += lateral
    free[len(system.grounds) :, 1] += lateral
    path = system.paths[0]
    other = Path("other", path.nodes + count, path.cables + len(system.cables))
    return both.with_(
        position=position.ravel(),
        stays=both.stays.with_(end=ends),
        grounds=both.grounds.with_(free=free),
        paths=(path, other),
        damping=system.damping,
    )


def doubled(system: System) -> System:
    """Return a line of doubled tensions, masses and stiffnesses."""
    cables, ties, stays, grounds = system.cables, system.ties, system.stays, system.grounds
    wires = {name: 2.0 * getattr(cables, name) for name in ("axial", "bending", "mass")}
    bars = {name: 2.0 * getattr(ties, name) for name in ("stiffness", "axial", "mass")}
    return system.with_(
        cables=cables.with_(**wires),
        ties=ties.with_(**bars),
        stays=stays.with_(stiffness=2.0 * stays.stiffness, mass=2.0 * stays.mass),
        grounds=grounds.with_(stiffness=2.0 * grounds.stiffness, damping=2.0 * grounds.damping),
        node_mass=2.0 * system.node_mass,
        load=2.0 * system.load,
    )


def test_two_lines_under_one_head_are_one_of_doubled_properties(record_validation: Record) -> None:
    """Two equal lines side by side at one height, 0.2 m apart, as in the middle of an overlap: the
    head feels one line of doubled tension, mass and stiffness, to 0.1 N rms."""
    system, given, duration = entering(simple(spans=6))
    two = force(beside(system, 0.2), given, duration)
    one = force(doubled(system), given, duration, stiffness=2.0 * STIFFNESS)
    assert record_validation(
        CASE,
        "two equal wires of an overlap against one of doubled properties",
        ours=rms(one, two),
        unit="N rms",
        allowed=(0.0, 0.1),
        source="equality",
    )
    assert one.max() > 150.0


def test_a_line_that_no_head_reaches_changes_nothing(record_validation: Record) -> None:
    """A second tension length 3 m aside leaves the contact force, to 1e-6 N at any instant."""
    system, given, duration = entering(simple(spans=6))
    given = replace(given, reach=0.8)
    lines = system, beside(system, 3.0)
    alone, two = (force(line, given, duration, tolerance=1e-13) for line in lines)
    assert record_validation(
        CASE,
        "a second tension length that no head reaches, largest difference",
        ours=float(np.abs(alone - two).max()),
        unit="N",
        allowed=(0.0, 1e-6),
        source="equality",
    )


def mirrored(system: System) -> System:
    """Return a line with left and right exchanged."""
    flip = np.array([1.0, -1.0, 1.0])
    turn = np.outer(flip, flip)
    stays, grounds, clamps = system.stays, system.grounds, system.clamps
    return system.with_(
        position=(system.position.reshape(-1, 3) * flip).ravel(),
        load=(system.load.reshape(-1, 3) * flip).ravel(),
        stays=stays.with_(end=stays.end * flip),
        grounds=grounds.with_(
            free=grounds.free * flip,
            stiffness=grounds.stiffness * turn,
            damping=grounds.damping * turn,
        ),
        clamps=clamps.with_(offset=clamps.offset * flip),
    )


@pytest.mark.parametrize("name", [*LINES, "simple"])
def test_a_mirrored_line_gives_the_same_force(name: str) -> None:
    """With left and right exchanged, every topology gives the same force, to rounding (1e-6 N)."""
    data = {"simple": simple, **LINES}[name]()
    data["settings"]["start"] = 160.0 if name == "overlap" else 5.0
    system, given, _ = entering(data)
    forces = [force(line, given, 0.5, tolerance=1e-12) for line in (system, mirrored(system))]
    assert np.abs(forces[0] - forces[1]).max() <= 1e-6
    assert np.ptp(system.position.reshape(-1, 6)[:, 1]) > 0.1


@pytest.mark.parametrize("name", [*LINES, "simple"])
def test_a_line_elsewhere_gives_the_same_force(name: str) -> None:
    """Translated along the track and lifted, every topology gives the same force, 0.02 N rms."""
    data = {"simple": simple, **LINES}[name]()
    data["settings"]["start"] = 160.0 if name == "overlap" else 5.0
    system, given, _ = entering(data)
    there = replace(given, start_x=given.start_x + 137.31, start_height=given.start_height + 2.083)
    forces = [
        force(system, given, 1.0),
        force(moved(system, (137.31, 0.0, 2.083)), there, 1.0),
    ]
    assert rms(*forces) <= 0.02
    assert np.ptp(forces[0]) > 20.0


AUXILIARY = 0.4
"""Share that the auxiliary wire has of the messenger wire that is divided."""


def with_a_tied_auxiliary(system: System, messenger: Array, cables: Array) -> System:
    """Return a line whose messenger wire is two wires, tied to each other at every node.

    The second wire has :data:`AUXILIARY` of tension, mass and stiffness; droppers and supports are
    on the first.
    """
    after = np.zeros(system.node_count, dtype=np.int64)
    after[messenger] = 1
    place = np.arange(system.node_count) + np.cumsum(after) - after
    host, aux = place[messenger], place[messenger] + 1
    count = system.node_count + len(messenger)

    def spread(values: Array, of_host: float, of_aux: float) -> Array:
        own = values.reshape(system.node_count, -1)
        out = np.zeros((count, own.shape[1]))
        out[place] = own
        out[host], out[aux] = of_host * own[messenger], of_aux * own[messenger]
        return out.ravel()

    parts = system.cables
    wires = {name: getattr(parts, name).copy() for name in ("axial", "bending", "mass")}
    for values in wires.values():
        values[cables] *= 1.0 - AUXILIARY
    again = parts.chosen(np.isin(np.arange(len(parts)), cables))
    again = again.with_(
        nodes=np.stack([aux[:-1], aux[1:]], axis=1),
        **{name: AUXILIARY * getattr(again, name) for name in ("axial", "bending", "mass")},
    )
    split = parts.with_(nodes=place[parts.nodes], **wires).joined(again)
    ties, stays, grounds = system.ties, system.stays, system.grounds
    whole = system.with_(
        cables=split,
        ties=ties.with_(nodes=place[ties.nodes]),
        stays=stays.with_(node=place[stays.node]),
        grounds=grounds.with_(node=place[grounds.node]),
        node_mass=spread(system.node_mass, 1.0, 0.0),
        load=spread(system.load, 1.0 - AUXILIARY, AUXILIARY),
        fixed=spread(system.fixed, 1.0, 1.0) > 0.0,
        position=spread(system.position, 1.0, 1.0),
        paths=tuple(replace(path, nodes=place[path.nodes]) for path in system.paths),
    )
    missing = (whole.load - internal_force(whole, whole.position).nodal).reshape(-1, 6)[aux, :3]
    stiffness = np.full(len(aux), 1e7)
    joints = Clamps(np.stack([host, aux], axis=1), stiffness, -missing / stiffness[:, None])
    return whole.with_(clamps=joints)


@pytest.mark.slow
@pytest.mark.parametrize(("backend", "share"), [("auto", 1.0), ("reference", 0.12)])
def test_an_auxiliary_wire_tied_everywhere_is_one_wire(
    backend: Choice, share: float, record_validation: Record
) -> None:
    """A messenger wire and an auxiliary wire, tied at every node, are one wire with the sums of
    tension, mass and stiffnesses: 0.1 N rms, over the passage and with the reference at first."""
    data = simple(spans=6)
    model, _, system = found(Case.model_validate(data))
    strand = model.mesh.strand("messenger")
    _, given, duration = entering(data)
    two = with_a_tied_auxiliary(system, strand.nodes, strand.cables)
    forces = [
        force(line, given, share * duration, backend=backend, tolerance=1e-9)
        for line in (system, two)
    ]
    assert record_validation(
        CASE,
        f"auxiliary wire tied at every node against one wire, backend {backend}",
        ours=rms(*forces),
        unit="N rms",
        allowed=(0.0, 0.1),
        source="equality",
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", ["simple", "stitched", "twin", "compound"])
def test_running_backwards_gives_the_same_force(name: str, record_validation: Record) -> None:
    """A line that looks the same from both ends gives the same force in both directions."""
    data = {"simple": simple, **LINES}[name]()
    data["line"] |= {"spans": 6, "ends": "anchored"}
    forces = []
    for direction in ("+x", "-x"):
        data["scenario"]["direction"] = direction
        forces.append(force(*entering(data)))
    assert record_validation(
        CASE,
        f"run backwards, {name}",
        ours=rms(*forces),
        unit="N rms",
        allowed=(0.0, 0.02),
        source="equality",
    )


# ---- lines that differ far away, and on finer meshes ---------------------------------------------


def overlapping(spans: int, first: int, last: int) -> dict[str, Any]:
    """Return AC simple in two tension lengths that share the spans from ``first`` to ``last``."""
    data = simple(spans=spans)
    data["tension_lengths"] = [
        {"name": "T1", "masts": [1, last + 1], "ends": {"left": "anchored", "right": "weighted"}},
        {
            "name": "T2",
            "masts": [first, spans + 1],
            "ends": {"left": "weighted", "right": "anchored"},
        },
    ]
    data["overlaps"] = [{"kind": "three-span", "rise": 0.35}]
    data["settings"]["backend"] = "auto"
    return data


def statistics_in(data: dict[str, Any], spans: tuple[int, int]) -> dict[str, float]:
    """Return statistics of the force, below 20 Hz and in bands, within some spans [N]."""
    data["settings"]["section"] = list(spans)
    case = Case.model_validate(data)
    model = build(case)
    end = 55.0 * (spans[1] + 1) / case.scenario.speed
    run = simulate(model, find_shape(model), watch=lambda progress: progress.time >= end)
    sharp = contact_statistics(run).pantograph().sharp
    values = {"mean": sharp.mean, "Fmax": sharp.maximum, "Fmin": sharp.minimum}
    bands = {f"sigma {band} Hz": value for band, value in sharp.standard_deviations.items()}
    return values | bands


@pytest.mark.slow
def test_a_cut_far_away_hardly_moves_the_statistics(record_validation: Record) -> None:
    """An overlap 330 m beyond the analysed section, with weights on both sides, moves no statistic
    by more than 3 %. The line without it has weights too, at its end: between anchors, where the
    wires cannot move along the track, the least force is 4 % higher and sigma below 2 Hz 1.4 %
    lower, cut or not."""
    whole = simple(spans=20)
    whole["line"]["ends"] = {"left": "anchored", "right": "weighted"}
    whole["settings"]["backend"] = "auto"
    cut = overlapping(20, 15, 17)
    before, after = (statistics_in(data, (5, 8)) for data in (whole, cut))
    changes = {name: 100.0 * (after[name] / value - 1.0) for name, value in before.items()}
    for name, change in changes.items():
        assert record_validation(
            "AC simple, 250 km/h, cut 330 m beyond the section",
            f"change of {name}",
            ours=change,
            unit="%",
            allowed=(-3.0, 3.0),
            source="the same line in one tension length, weighted at the same side",
        )


@pytest.mark.slow
def test_force_in_an_overlap_is_converged(record_validation: Record) -> None:
    """Through an overlap at 300 km/h, mean force held, half the elements and half the step move
    the largest force below 20 Hz by less than 3 %."""
    largest = []
    for nodes, step in ((7, 1e-3), (13, 5e-4)):
        data = overlapping(10, 4, 6)
        data["scenario"] = {"speed": 300 / 3.6, "mean_force": 150.0}
        data["settings"] |= {"nodes_between_droppers": nodes, "time_step": step, "section": [4, 6]}
        run = run_case(Case.model_validate(data))
        sharp = contact_statistics(run).pantograph().sharp
        assert sharp.mean == pytest.approx(150.0, abs=1.0)
        largest.append(sharp.maximum)
    assert record_validation(
        "Overlap of AC simple, 300 km/h, mesh and step halved",
        "change of Fmax, sharp",
        ours=100.0 * (largest[1] / largest[0] - 1.0),
        unit="%",
        allowed=(-3.0, 3.0),
        source="the same line, 7 nodes between droppers and 1 ms",
    )
