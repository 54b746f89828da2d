"""Recordings made from a known contact force, as a measuring train would write them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import tautwire as tw
from tautwire.measured.recording import Recording
from tautwire.signals.filters import SharpLowpass

Array = NDArray[np.float64]

SPANS = (55.0, 50.0, 60.0, 45.0, 55.0, 60.0, 50.0, 55.0, 48.0, 60.0, 52.0, 57.0, 50.0, 60.0)
RATE = 1000.0
STRIP_MASS = 3.0
SENSOR_BASE = 1.0


@dataclass(frozen=True, eq=False)
class Truth:
    """The force that really acted, over time and position on the line."""

    time: Array
    position: Array
    force: Array
    speed: float


@cache
def passage_run(speed_kmh: float = 250.0) -> tw.Run:
    """Compute a passage over a line of unequal spans, held in memory for all recordings."""
    count = [round(span / 9.0) for span in SPANS]
    positions = [
        list(np.linspace(4.5, span - 4.5, n)) for span, n in zip(SPANS, count, strict=True)
    ]
    changes: dict[str, Any] = {
        "line.spans": len(SPANS),
        "line.span_length": list(SPANS),
        "droppers.positions": positions,
        "droppers.presag": [[0.0] * n for n in count],
        "settings.section": [3, 12],
        "settings.nodes_between_droppers": 5,
        "scenario.speed": f"{speed_kmh} km/h",
        "scenario.uplift_force": "120 N",
    }
    case = tw.load_case("ac-simple", changes)
    model = tw.build(case)
    return tw.simulate(model, tw.find_shape(model))


@cache
def passage(speed_kmh: float = 250.0) -> Truth:
    """Return the force of that passage between the outer spans."""
    run = passage_run(speed_kmh)
    force = run.contact_force(run.pantographs[0].name)
    inside = (force.position > 60.0) & (force.position < sum(SPANS) - 60.0)
    start = force.time[inside][0]
    return Truth(
        force.time[inside] - start,
        force.position[inside],
        force.force[inside],
        run.case.scenario.speed,
    )


def record(truth: Truth, seed: int, *, sensors: int = 4, stagger: bool = True) -> Recording:
    """Return a clean recording: noise, an odometer that drifts, a strip that vibrates.

    The force is split over the sensors by the lateral position of the wire and, with four sensors,
    unevenly over two strips; each strip's own vibration loads its sensors and its accelerometer.
    """
    rng = np.random.default_rng(seed)
    time = np.arange(truth.time[0], truth.time[-1], 1.0 / RATE)
    force = np.interp(time, truth.time, truth.force)
    position = np.interp(time, truth.time, truth.position)
    lateral = 0.2 * _zigzag(position)
    strips = 1 if sensors == 2 else 2
    shares = [1.0] if strips == 1 else [0.55, 0.45]
    forces, accelerations, of_force, of_acc = [], [], [], []
    for strip in range(strips):
        vibration = _vibration(rng, len(time))
        carried = shares[strip] * force + STRIP_MASS * vibration
        right = 0.5 + lateral / SENSOR_BASE
        for share in (right, 1.0 - right):
            noise = rng.normal(0.0, 0.5, len(time))
            forces.append(np.round(carried * share + noise, 2))
            of_force.append(strip + 1)
        accelerations.append(vibration + rng.normal(0.0, 0.02, len(time)))
        of_acc.append(strip + 1)
    drift = 1.0 + rng.uniform(-3e-3, 3e-3)
    distance = (position - position[0]) * drift + 3.0
    return Recording(
        label=f"run {seed}",
        time=time,
        forces=np.array(forces),
        force_strips=np.array(of_force),
        accelerations=np.array(accelerations),
        acceleration_strips=np.array(of_acc),
        speed=truth.speed * np.ones(len(time)) + rng.normal(0.0, 0.02, len(time)),
        distance=distance,
        stagger=lateral + rng.normal(0.0, 0.005, len(time)) if stagger else None,
    )


DIALECTS = ("plain", "German", "MAT")


def write_file(recording: Recording, path: Path, dialect: str, *, time: bool = True) -> Path:
    """Write a recording as a recorder would: headings, units and decimals of its own."""
    german, comma = dialect == "German", ";" if dialect == "German" else ","
    force, head = (1e-3, "Kraft {}_{} [kN]") if german else (1.0, "F_{}_{} [N]")
    columns = {"Zeit [s]" if german else "time [s]": recording.time} if time else {}
    sensors: dict[int, int] = {}
    for strip, values in zip(recording.force_strips.tolist(), recording.forces, strict=True):
        sensors[strip] = sensors.get(strip, 0) + 1
        columns[head.format(strip, sensors[strip])] = force * values
    for strip, values in zip(
        recording.acceleration_strips.tolist(), recording.accelerations, strict=True
    ):
        columns[f"AccZ_{strip}_1 [m/s^2]"] = values
    assert recording.speed is not None
    assert recording.distance is not None
    columns["Geschwindigkeit [km/h]" if german else "speed [km/h]"] = 3.6 * recording.speed
    columns["Weg [m]" if german else "position [m]"] = recording.distance
    if recording.stagger is not None:
        columns["Seitenlage [mm]" if german else "stagger [mm]"] = 1e3 * recording.stagger
    if recording.height is not None:
        columns["Fahrdrahthöhe [mm]" if german else "height [mm]"] = 1e3 * recording.height
    if dialect == "MAT":
        from scipy.io import savemat

        named = {f"c{n}": {"data": values, "unit": head.rpartition("[")[2].rstrip("]")}
                 for n, (head, values) in enumerate(columns.items())}  # fmt: skip
        names = [head.partition(" [")[0].replace(" ", "_") for head in columns]
        savemat(path, dict(zip(names, named.values(), strict=True)))
        return path
    rows = np.column_stack(list(columns.values()))
    text = "\n".join(comma.join(f"{value:.6f}" for value in row) for row in rows.tolist())
    text = text.replace("nan", "")
    if german:
        text = text.replace(".", ",")
    path.write_text(comma.join(columns) + "\n" + text + "\n", encoding="utf-8")
    return path


def _zigzag(position: Array) -> Array:
    """Return the stagger over the position, between -1 and 1, support by support."""
    supports = np.concatenate([[0.0], np.cumsum(SPANS)])
    return np.interp(position, supports, (-1.0) ** np.arange(len(supports)))


def _vibration(rng: np.random.Generator, count: int) -> Array:
    """Return the acceleration of a strip: noise between 5 and 100 Hz, 4 m/s2 rms."""
    noise = rng.normal(size=count)
    band = SharpLowpass(100.0).apply(noise, 1.0 / RATE) - SharpLowpass(5.0).apply(noise, 1.0 / RATE)
    return 4.0 * band / band.std()
