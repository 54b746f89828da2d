"""Plausible results without a computation, to test what is done with results.

The line looks like the AC benchmark line; histories are made of waves and noise of a fixed seed.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from tautwire.numerics.track import Track
from tautwire.results.droppers import DropperHistory
from tautwire.results.equilibrium import Elasticity, Equilibrium
from tautwire.results.run import PantographRecord, Run, Snapshots
from tautwire.specs.case import Case

DROPPERS = [4.5, 10.25, 16.0, 21.75, 27.5, 33.25, 39.0, 44.75, 50.5]
PRESAG = [0.0, 0.024, 0.041, 0.052, 0.055, 0.052, 0.041, 0.024, 0.0]


def make_case(spans: int = 17, pantographs: int = 1, **changes: Any) -> Case:
    """Return a valid case; ``changes`` replace parts of its input."""
    stages = [
        {"mass": 6.0, "stiffness": 9430.0},
        {"mass": 9.0, "stiffness": 14100.0, "damping": 0.1},
        {"mass": 5.8, "stiffness": 0.1, "damping": 70.0},
    ]
    names = ["front", "rear", "third"]
    data: dict[str, Any] = {
        "schema": 1,
        "name": "synthetic",
        "title": "Synthetic line for tests",
        "description": "Made up; no computation stands behind it.",
        "line": {"spans": spans, "span_length": 55.0},
        "wires": {
            "contact": {
                "tension": 22e3,
                "mass": 1.35,
                "axial_stiffness": 17e6,
                "bending_stiffness": 150.0,
            },
            "messenger": {
                "tension": 16e3,
                "mass": 1.08,
                "axial_stiffness": 13e6,
                "bending_stiffness": 130.0,
            },
        },
        "supports": {"encumbrance": 1.2, "contact_stagger": 0.2, "closure": "height"},
        "droppers": {
            "mode": "height",
            "positions": DROPPERS,
            "presag": PRESAG,
            "stiffness": "200 kN/m",
            "mass": 0.117,
            "clamp_contact": 0.165,
            "clamp_messenger": 0.195,
        },
        "pantographs": [
            {"name": names[i], "behind": 100.0 * i, "stages": stages} for i in range(pantographs)
        ],
        "scenario": {"speed": 320.0 / 3.6, "mean_force": 169.0},
        "settings": {"contact_stiffness": 2e5},
        "sources": [
            {"path": "wires", "source": "made up for tests", "confidence": "choice"},
            {"path": "droppers.presag", "source": "benchmark table", "confidence": "two sources"},
        ],
    }
    return Case.model_validate(data | changes)


def make_equilibrium(case: Case) -> Equilibrium:
    """Return a static state of the right shapes: parabolas, sags and forces as one expects."""
    spans, length = case.line.spans, 55.0
    marks = np.concatenate([[0.0], DROPPERS])
    starts = length * np.arange(spans, dtype=np.float64)
    station = np.append((starts[:, None] + marks).ravel(), spans * length)
    x = np.unique(np.concatenate([station, 0.5 * (station[1:] + station[:-1])]))
    supports = length * np.arange(spans + 1, dtype=np.float64)
    stagger = 0.2 * np.array([(-1.0) ** n for n in range(spans + 1)])
    dropper_x = (starts[:, None] + np.array(DROPPERS)).ravel()
    drops = np.append(np.tile([0.0, *PRESAG], spans), 0.0)
    sag = np.interp(x, station, drops)
    inner = np.mod(x, length)
    position = np.zeros((x.size, 2, 2, 3))
    position[:, :, 0, 0] = x[:, None]
    position[:, :, 0, 1] = np.interp(x, supports, stagger)[:, None]
    position[:, 0, 0, 2] = 5.3 - sag
    position[:, 1, 0, 2] = 6.5 - 4.0 * 0.46 * inner * (length - inner) / length**2
    position[:, :, 1, 0] = 1.0
    lengths = np.interp(dropper_x, x, position[:, 1, 0, 2] - position[:, 0, 0, 2])
    arms = np.arange(2, spans + 1)
    side = np.sign(stagger[1:-1])
    return Equilibrium(
        track=Track.straight(),
        position=position.ravel(),
        cable_lengths=np.tile(np.diff(x), 2),
        node_s=np.repeat(x, 2),
        node_wire=np.tile(np.arange(2), x.size),
        wire_names=("contact", "messenger"),
        wire_roles=("contact", "messenger"),
        dropper_span=np.repeat(np.arange(1, spans + 1), 9),
        dropper_number=np.tile(np.arange(1, 10), spans),
        dropper_wires=np.tile([1, 0], (dropper_x.size, 1)),
        dropper_x=dropper_x,
        dropper_lengths_unstrained=lengths - 0.0005,
        dropper_lengths=lengths,
        dropper_forces=np.tile([196.0, 74, 78, 83, 86, 83, 78, 74, 196], spans),
        dropper_heights=np.interp(dropper_x, x, position[:, 0, 0, 2]),
        support_number=np.arange(1, spans + 2),
        support_wire=np.zeros(spans + 1, dtype=np.int64),
        support_x=supports,
        support_heights=np.full(spans + 1, 5.3),
        arm_supports=arms,
        arm_forces=np.full(arms.size, 320.0),
        arm_angles=np.full(arms.size, 0.188),
        arm_ends=np.column_stack([supports[1:-1], stagger[1:-1] + 1.2 * side, 5.53 + 0 * side]),
        suspension_free_heights=np.full(spans - 1, 6.503),
        contact_preloads=np.zeros(spans + 1),
        joint_pulls=np.empty((0, 3)),
        end_pulls=np.array([[-22e3, -16e3], [22e3, 16e3]]),
        weight=2.5e4,
        reaction=2.5e4,
        iterations=6,
        residual=2e-5,
    )


def make_elasticity(case: Case) -> Elasticity:
    """Return the published elasticity of the benchmark line, for three spans."""
    rows = []
    values = [0.165, 0.273, 0.345, 0.388, 0.400, 0.388, 0.345, 0.273, 0.165]
    for span in range(case.line.spans // 2, case.line.spans // 2 + 3):
        start = 55.0 * (span - 1)
        rows.append((span, "support", 0, start, 0.206))
        for number, (x, value) in enumerate(zip(DROPPERS, values, strict=True), 1):
            rows.append((span, "dropper", number, start + x, value))
    span, kind, index, x, value = zip(*rows, strict=True)
    return Elasticity(
        100.0, np.array(span), tuple(kind), np.array(index), np.array(x), 1e-3 * np.array(value)
    )


def make_run(
    case: Case | None = None,
    *,
    status: str = "done",
    duration: float | None = None,
    force: float = 169.0,
    losses: bool = False,
    entering: bool = True,
    time_step: float = 1e-3,
) -> Run:
    """Return a run with histories like those of a passage.

    Parameters
    ----------
    case : Case, optional
    status : str
    duration : float s, optional
        Cut the histories short, as an interruption would.
    force : float N
        Mean contact force.
    losses : bool
        Add two losses of contact.
    entering : bool
        False: no pantograph ever enters the line.
    time_step : float s
    """
    case = case or make_case()
    equilibrium = make_equilibrium(case)
    total = (equilibrium.support_x[-1] - 10.0) / case.scenario.speed
    time = np.arange(0.0, total if duration is None else min(duration, total), time_step)
    records = tuple(
        _record(case, equilibrium, number, time, force, losses=losses, entering=entering)
        for number in range(len(case.pantographs))
    )
    lifts = [_bump(equilibrium.support_x, record) for record in records]
    droppers = [_bump(equilibrium.dropper_x, record) for record in records]
    taut = equilibrium.dropper_forces - 2600.0 * np.sum(droppers, axis=0)
    return Run(
        case=case,
        equilibrium=equilibrium,
        status=status,
        message="" if status == "done" else "interrupted at 320 m; start it again",
        time=time,
        pantographs=records,
        support_uplift=(0.7 * np.sum(lifts, axis=0)).astype(np.float32),
        droppers=DropperHistory.of_every_sample(np.maximum(taut, 0.0)),
        snapshots=_snapshots(equilibrium, records, time),
        counters={
            "dof": 16068,
            "steps": int(time.size),
            "iterations_mean": 2.1,
            "refactorisations": 3,
            "full_newton_steps": 0,
            "simulated_s": float(time.size * time_step),
            "cpu_s": 96.4,
            "wall_s": 97.0,
            "real_time_factor": 9.2,
            "tuning_passes": 3,
            "backend": "reference",
        },
        warnings=("element length 0.719 m: numerical lines from 124 Hz",),
        provenance={"version": "0.1.0", "commit": "", "created": "2026-11-22T12:00:00+00:00"},
    )


def _record(
    case: Case,
    equilibrium: Equilibrium,
    number: int,
    time: np.ndarray,
    mean: float,
    *,
    losses: bool,
    entering: bool,
) -> PantographRecord:
    random = np.random.default_rng(number)
    speed, behind = case.scenario.speed, case.pantographs[number].behind
    position = 5.0 + speed * time - behind
    active = (position >= 5.0) & entering
    wave = 2.0 * np.pi * position
    force = mean + 50.0 * np.sin(wave / 55.0 + number) + 16.0 * np.sin(wave / 27.5)
    force += 34.0 * np.sin(wave / 5.75) + random.normal(0.0, 18.0, time.size)
    if losses:
        for place in (400.0, 512.0):
            force[np.abs(position - place - behind / 9.0) < 0.4] = 0.0
    force = np.where(active, np.maximum(force, 0.0), 0.0)
    static = np.interp(position, equilibrium.contact.s, equilibrium.contact_position[:, 2])
    lift = 0.055 + 0.03 * np.sin(wave / 55.0 - 1.2)
    height = np.where(active, static + lift, static)
    stages = np.column_stack([lift + 0.004 * np.sin(wave / 5.75) * k for k in range(3)])
    return PantographRecord(
        name=case.pantographs[number].name,
        uplift_force=176.25 + number,
        target_mean=case.scenario.target_mean_force(),
        position=position,
        contact_force=force,
        gap=np.where(force > 0.0, -force / case.settings.contact_stiffness, 0.002),
        wire_height=height,
        wire_forces=force[:, None],
        stage_heights=np.where(active[:, None], stages, 0.0),
        active=active,
    )


def _bump(place: np.ndarray, record: PantographRecord) -> np.ndarray:
    """Return a smooth lift that travels with the pantograph, (n_time, n_place) m."""
    ahead = place[None, :] - record.position[:, None]
    return 0.085 * np.exp(-((ahead / 14.0) ** 2)) * record.active[:, None]


def _snapshots(
    equilibrium: Equilibrium, records: tuple[PantographRecord, ...], time: np.ndarray
) -> Snapshots:
    x = np.arange(0.0, equilibrium.support_x[-1] + 1.0, 1.25)
    frames = np.arange(0, time.size, 25)
    shape = equilibrium.contact.s
    lift = np.zeros((frames.size, x.size))
    for record in records:
        ahead = (x[None, :] - record.position[frames, None]) / 14.0
        lift += 0.085 * np.exp(-(ahead**2)) * record.active[frames, None]
    contact = np.interp(x, shape, equilibrium.contact_position[:, 2]) + lift
    messenger = np.interp(x, shape, equilibrium.messenger_position[:, 2]) + 0.6 * lift
    return both_wires(time[frames], x, contact, messenger)


def both_wires(
    time: np.ndarray, x: np.ndarray, contact: np.ndarray, messenger: np.ndarray
) -> Snapshots:
    """Return shapes of a contact and a messenger wire at the same places."""
    z = np.concatenate([contact, messenger], axis=1).astype(np.float32)
    return Snapshots(time, np.tile(x, 2), np.repeat(np.arange(2), x.size), z)
