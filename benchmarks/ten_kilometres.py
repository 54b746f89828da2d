"""What 10 km in nine tension lengths with eight overlaps cost under two pantographs.

AC simple at 250 km/h, 9 nodes between droppers, steps of 1 ms. Set-up, CPU seconds per simulated
second, sweeps and memory are those of the product itself: shape, passage with everything that it
keeps, statistics and result file. Run as ``python benchmarks/ten_kilometres.py``, with ``--whole``
for the whole passage (some 144 s of it) instead of its beginning.
"""

from __future__ import annotations

import argparse
import resource
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import machine

import tautwire as tw
from tautwire.analyses.road.dynamics import Progress
from tautwire.numerics.motion.backend import backend_name

SPANS, SHARED = 23, 3
"""Spans of a tension length, and those of them that it shares with the next: nine make 10 km."""
BLOCK = 0.4
"""Simulated time over which a cost is taken [s]: a span of AC simple takes 0.8 s."""


def kilometres(count: int) -> tw.Case:
    """Return a line of so many tension lengths, each weighted at both ends, and two heads."""
    step = SPANS - SHARED
    lengths: list[dict[str, Any]] = [
        {
            "name": f"T{k + 1}",
            "masts": [k * step + 1, k * step + SPANS + 1],
            "ends": "weighted",
            "fixed_point": k * step + 1 + SPANS // 2,
        }
        for k in range(count)
    ]
    pressed = {"mean_force": None, "uplift_force": 130, "uplift_guess": None}
    return tw.load_case(
        "ac-simple-two-pantographs",
        {
            "line.spans": count * step + SHARED,
            "tension_lengths": lengths,
            "overlaps": [{"kind": "three-span", "rise": 0.35}] * (count - 1),
            "supports.closure": "height",
            "supports.contact_stagger": 0.2,
            "scenario.speed": 250 / 3.6,
            "settings.nodes_between_droppers": 9,
            "settings.time_step": 1e-3,
            "settings.section": None,
            **{f"scenario.{name}": value for name, value in pressed.items()},
        },
    )


@dataclass
class Watch:
    """Takes the cost of every stretch of a passage, and stops it after a while.

    The first call, 20 ms into the passage, ends the set-up: the first factor is in it.
    """

    seconds: float
    begin: float = field(default_factory=time.process_time)
    reached: float = 0.0
    setup: float = 0.0
    cost: list[float] = field(default_factory=list)

    def __call__(self, progress: Progress) -> bool:
        """Take the cost since the last stretch; tell whether the passage is long enough."""
        now, simulated = time.process_time(), progress.time - self.reached
        if not self.setup:
            self.setup = now - self.begin
            self.begin, self.reached = now, progress.time
        elif simulated > BLOCK - 1e-9:
            self.cost.append((now - self.begin) / simulated)
            self.begin, self.reached = now, progress.time
        return progress.time > self.seconds - 1e-9


def memory() -> float:
    """Return the largest memory of this process so far [MB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--lengths", type=int, default=9, help="tension lengths")
    parser.add_argument("--seconds", type=float, default=10.0, help="simulated time")
    parser.add_argument("--whole", action="store_true", help="the whole passage")
    given = parser.parse_args()
    before = machine.measure()
    watch = Watch(float("inf") if given.whole else given.seconds)
    model = tw.build(kilometres(given.lengths))
    shape = tw.find_shape(model)
    highest = [memory()]
    run = tw.simulate(model, shape, watch=watch)
    highest.append(memory())
    tw.contact_statistics(run)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "run.nc"
        tw.save_run(run, file)
        size = file.stat().st_size / 1e6
    highest.append(memory())
    here = machine.measure().best_with(before)
    cost = sorted(watch.cost)
    length = model.case.line.support_positions()[-1] / 1e3
    print(
        f"{backend_name('native')}, {length:.2f} km, {shape.position.size} degrees of freedom,"
        f" {len(shape.dropper_x)} droppers, {run.time[-1]:.1f} s of the passage"
    )
    print(f"{here.dgemm:.0f} GFlop/s, triad {here.cached:.0f} GB/s in cache, {here.memory:.0f} not")
    print(f"set-up {watch.setup:.1f} CPU s; {run.counters['iterations_mean']:.2f} sweeps per step")
    print(f"CPU s per simulated s: least {cost[0]:.2f}, median {cost[len(cost) // 2]:.2f}")
    print("memory [MB] at most: shape {:.0f}, passage {:.0f}, file {:.0f}".format(*highest))
    print(f"file {size:.0f} MB")


if __name__ == "__main__":
    main()
