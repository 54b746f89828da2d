"""What a comparison with a measurement speaks of: line, pantograph, speeds, length.

EN 50318 and IEC 63453 bind the validity of a simulation method to the conditions in which it was
compared; this record states them, so that a run outside of them is recognised.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tautwire.measured.recording import Recording
from tautwire.plain import Plain, named
from tautwire.results.run import Run
from tautwire.specs.case import Case


@dataclass(frozen=True)
class Coverage(Plain):
    """Conditions of one comparison.

    Attributes
    ----------
    case, case_hash : str
    line_type : str
        Simple, stitched or compound, or a contact wire alone, and how many contact wires.
    wires : mapping of str to float N
        Tension of every wire by name.
    spans : (int, int)
        First and last compared span.
    span_lengths : (float, float) m
        Shortest and longest of the compared spans.
    length : float m
    pantograph : str
    masses : tuple of float kg
        Of its stages, the head first: what kind of pantograph it is.
    pantographs, spacing : int, tuple of float m
        How many run, and their distances behind the first.
    simulated_speed, measured_speed : float m/s
        The second is the mean over the recording.
    direction : str
        Of the run.
    highest_frequency : float Hz
        That the recorded samples hold.
    """

    case: str
    case_hash: str
    line_type: str
    wires: dict[str, float] = field(metadata=named("tensions_n"))
    spans: tuple[int, int]
    span_lengths: tuple[float, float] = field(metadata=named("span_lengths_m"))
    length: float = field(metadata=named("length_m"))
    pantograph: str
    masses: tuple[float, ...] = field(metadata=named("masses_kg"))
    pantographs: int
    spacing: tuple[float, ...] = field(metadata=named("behind_m"))
    simulated_speed: float = field(metadata=named("simulated_speed_kmh", 3.6))
    measured_speed: float = field(metadata=named("measured_speed_kmh", 3.6))
    direction: str
    highest_frequency: float = field(metadata=named("highest_frequency_hz"))


def coverage_of(
    run: Run, pantograph: str, recording: Recording, part: tuple[float, float]
) -> Coverage:
    """State the conditions of a comparison over a part of the line [m]."""
    case, supports = run.case, run.equilibrium.mast_x
    first = int(np.searchsorted(supports, part[0], side="right"))
    last = int(np.searchsorted(supports, part[1], side="left"))
    first, last = max(first, 1), min(max(last, first, 1), len(supports) - 1)
    lengths = np.diff(supports)[first - 1 : last]
    time, way = recording.time, recording.distance
    assert way is not None
    return Coverage(
        case=case.name,
        case_hash=case.hash(),
        line_type=line_type(case),
        wires={name: float(wire.tension) for name, wire in case.wires.named()},
        spans=(first, last),
        span_lengths=(float(lengths.min()), float(lengths.max())),
        length=part[1] - part[0],
        pantograph=pantograph,
        masses=next(
            tuple(float(stage.mass) for stage in one.stages)
            for one in case.pantographs
            if one.name == pantograph
        ),
        pantographs=len(case.pantographs),
        spacing=tuple(float(entry.behind) for entry in case.pantographs),
        simulated_speed=float(case.scenario.speed),
        measured_speed=float((way[-1] - way[0]) / (time[-1] - time[0])),
        direction=case.scenario.direction,
        highest_frequency=recording.highest_frequency,
    )


def line_type(case: Case) -> str:
    """Say what kind of line a case is."""
    wires = case.wires
    if wires.of_role("stitch"):
        kind = "stitched"
    elif wires.of_role("auxiliary"):
        kind = "compound"
    else:
        kind = "simple" if wires.of_role("messenger") else "contact wire alone"
    count = len(wires.of_role("contact"))
    return kind if count == 1 else f"{kind}, {count} contact wires"


def covered(parts: Sequence[Coverage]) -> dict[str, Any]:
    """Sum up what several comparisons cover: the envelope within which they speak."""
    speeds = [3.6 * part.simulated_speed for part in parts]
    measured = [3.6 * part.measured_speed for part in parts]
    tensions: dict[str, list[float]] = {}
    for part in parts:
        for name, tension in part.wires.items():
            tensions.setdefault(name, []).append(tension)
    return {
        "lines": sorted({part.case for part in parts}),
        "line_types": sorted({part.line_type for part in parts}),
        "pantographs": sorted({part.pantograph for part in parts}),
        "pantograph_masses_kg": sorted({part.masses for part in parts}),
        "numbers_of_pantographs": sorted({part.pantographs for part in parts}),
        "speed_kmh": [round(min(speeds), 6), round(max(speeds), 6)],
        "measured_speed_kmh": [round(min(measured), 6), round(max(measured), 6)],
        "directions": sorted({part.direction for part in parts}),
        "tensions_n": {
            name: [min(values), max(values)] for name, values in sorted(tensions.items())
        },
        "span_lengths_m": [
            min(part.span_lengths[0] for part in parts),
            max(part.span_lengths[1] for part in parts),
        ],
        "length_m": sum(part.length for part in parts),
    }
