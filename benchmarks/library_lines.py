"""What a step costs on lines of the library, block by block in turn, beside AC simple.

Run from the repository's root as ``python -m benchmarks.library_lines``.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass, field
from typing import Any

from tautwire.analyses.road.dynamics import Simulation
from tautwire.analyses.road.shape import find_shape
from tautwire.inputs.load import load_case
from tautwire.model.build import build
from tautwire.numerics.motion.backend import backend_name

GRADED: dict[str, Any] = {}
NAD_9 = {"settings.nodes_between_droppers": 9}
AT_250 = {"scenario.mean_force": None, "scenario.uplift_force": 130, "scenario.uplift_guess": None}
LINES = {
    "ac-simple": GRADED,
    "ac-stitched": GRADED,
    "adif-c350": GRADED,
    "dc-twin": GRADED,
    "adif-ca220-3kv": GRADED,
    "compound": GRADED,
    "ac-simple, NAD 9": NAD_9,
    "ac-stitched, NAD 9": NAD_9,
    "dc-twin, NAD 9": NAD_9,
    "compound, NAD 9": NAD_9,
    "ac-simple-curve, NAD 9": {
        **NAD_9,
        "line.spans": 41,
        "tension_lengths[1].masts": [1, 23],
        "tension_lengths[1].fixed_point": 12,
        "tension_lengths[2].masts": [20, 42],
        "tension_lengths[2].fixed_point": 31,
        "track": [{"straight": 800}, {"transition": 80},
                  {"arc": 500, "radius": 1200, "side": "left", "cant": 0.09},
                  {"transition": 80}, {"straight": 795}],
        "supports.contact_stagger": 0.2,
    },
}  # fmt: skip
"""Names with their settings; the last one is two tension lengths of 1,210 m with an overlap in a
curve."""
STEP = 1e-3
WARM_UP, BLOCK = 700, 100


@dataclass
class Passage:
    """A passage under way and what its blocks have cost [s]."""

    name: str
    simulation: Simulation
    setup: float
    cost: list[float] = field(default_factory=list)
    sweeps: float = 0.0

    def advance(self) -> None:
        """Take a block of steps."""
        counters = self.simulation.stepper.counters
        before, cpu = counters.iterations, time.thread_time()
        self.simulation.stepper.advance(BLOCK)
        self.cost.append(time.thread_time() - cpu)
        self.sweeps += (counters.iterations - before) / BLOCK


def prepared(name: str, changes: dict[str, Any], start: float) -> Passage:
    """Return a passage whose pantographs press fully."""
    cpu = time.process_time()
    own = {"settings.start": start, "settings.time_step": STEP, "scenario.speed": 250 / 3.6}
    case = load_case(name.partition(",")[0], {**AT_250, **own, **changes})
    model = build(case)
    simulation = Simulation(model, find_shape(model))
    simulation.stepper.advance(1)
    passage = Passage(name, simulation, time.process_time() - cpu)
    simulation.stepper.advance(WARM_UP)
    return passage


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--blocks", type=int, default=15, help="blocks of 0.1 s measured per line")
    blocks = parser.parse_args().blocks
    starts = {name: 1000.0 if "curve" in name else 5.0 for name in LINES}
    passages = [prepared(name, changes, starts[name]) for name, changes in LINES.items()]
    for _ in range(blocks):
        for passage in passages:
            passage.advance()
    print(f"{backend_name('native')}, 250 km/h, 1 ms, thread CPU time, least of {blocks}")
    print("line                        DOF  us/step  sweeps/step  ns/(DOF step)  of ac-simple  "
          "CPU s/s  set-up s")  # fmt: skip
    reference: dict[bool, float] = {}
    for passage in passages:
        dof = passage.simulation.shape.position.size
        step, sweeps = min(passage.cost) / BLOCK, passage.sweeps / blocks
        own = 1e9 * step / dof
        beside = reference.setdefault("NAD" in passage.name, own)
        print(f"{passage.name:23s} {dof:7d} {1e6 * step:8.0f} {sweeps:12.2f} {own:14.2f} "
              f"{own / beside:13.2f} {step / STEP:8.2f} {passage.setup:9.1f}")  # fmt: skip


if __name__ == "__main__":
    main()
