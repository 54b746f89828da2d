"""What a step costs on lines of several kinds, per degree of freedom, beside two wires.

Twelve spans of 55 m, made of straight wires that hang at rest; run from the repository's root as
``python -m benchmarks.topologies``.
"""

from __future__ import annotations

import argparse
import itertools
import time
from collections.abc import Callable

import numpy as np
from tests.topologies import Network, Wire, even, hanging, under_way

from tautwire.numerics.motion.backend import backend_name, make_stepper
from tautwire.numerics.motion.stepper import StepOptions
from tautwire.numerics.network.parts import TENSION_ONLY
from tautwire.numerics.newmark import Newmark

SPAN, SPANS, ELEMENT = 55.0, 12, 55.0 / 80.0
LENGTH = SPAN * SPANS
SIMPLE = np.array([4.5, 10.25, 16.0, 21.75, 27.5, 33.25, 39.0, 44.75, 50.5])
START, BLOCK, BLOCKS, WARM_UP = 60.0, 100, 20, 300


def along(marks: np.ndarray) -> np.ndarray:
    """Return places of one span in all spans [m]."""
    return (SPAN * np.arange(SPANS)[:, None] + marks).ravel()


def wire(height: float, tension: float, mass: float, y: float = 0.0) -> Wire:
    """Return a wire over the whole line."""
    return Wire(even(0.0, LENGTH, ELEMENT), height, tension, mass, y)


def supported(line: Network, messenger: int) -> Network:
    """Hold the messenger wire at every support."""
    for x in SPAN * np.arange(SPANS + 1):
        node = line.node(messenger, x)
        line.grounds.append((node, np.diag([0.0, 5e5, 5e5]), np.diag([0.0, 1e3, 1e3])))
    return line


def two_wires() -> Network:
    """Return a simple catenary."""
    line = Network(wire(0.0, 22e3, 1.35), wire(1.2, 16e3, 1.08))
    line.tie(1, 0, along(SIMPLE), 2e5, TENSION_ONLY)
    return supported(line, 1)


def stitched() -> Network:
    """Return a catenary with a stitch wire at every inner support."""
    supports = SPAN * np.arange(1, SPANS)
    stitches = [Wire(even(x - 9.0, x + 9.0, ELEMENT), 1.2, 3.5e3, 0.31) for x in supports]
    line = Network(wire(0.0, 27e3, 1.07), wire(1.6, 21e3, 1.07), *stitches)
    line.tie(1, 0, along(np.array([13.0, 20.25, 27.5, 34.75, 42.0])), 3e5, TENSION_ONLY)
    for k, x in enumerate(supports, start=2):
        line.tie(k, 0, np.array([x - 5.0, x + 5.0]), 3e5, TENSION_ONLY)
        line.clamps += [(line.node(1, end), line.node(k, end)) for end in (x - 9.0, x + 9.0)]
    return supported(line, 1)


def twin() -> Network:
    """Return two contact wires on alternating droppers."""
    line = Network(wire(0.0, 10e3, 0.9, -0.02), wire(1.4, 20e3, 1.3), wire(0.0, 10e3, 0.9, 0.02))
    marks = np.array([5.0, 15.0, 25.0, 35.0, 45.0])
    line.tie(1, 0, along(marks), 2e5, TENSION_ONLY)
    line.tie(1, 2, along(marks + 5.0), 2e5, TENSION_ONLY)
    return supported(line, 1)


def compound() -> Network:
    """Return a contact wire under an auxiliary wire under a messenger wire."""
    line = Network(wire(0.0, 12e3, 1.0), wire(0.6, 12e3, 0.9), wire(1.6, 20e3, 1.3))
    line.tie(1, 0, along(np.arange(2.5, SPAN, 5.0)), 3e5, TENSION_ONLY)
    line.tie(2, 1, along(np.array([5.0, 15.0, 25.0, 35.0, 45.0, 50.0])), 3e5, TENSION_ONLY)
    return supported(line, 2)


def graded() -> Network:
    """Return a simple catenary with nodes close to droppers and supports."""
    marks = np.append(along(np.append(0.0, SIMPLE)), LENGTH)
    near = np.array([0.15, 0.5])
    pieces = [
        np.concatenate([[a], a + near, np.linspace(a + 0.5, b - 0.5, 5)[1:-1], (b - near)[::-1]])
        for a, b in itertools.pairwise(marks)
    ]
    x = np.append(np.concatenate(pieces), LENGTH)
    line = Network(Wire(x, 0.0, 22e3, 1.35), Wire(x, 1.2, 16e3, 1.08))
    line.tie(1, 0, along(SIMPLE), 2e5, TENSION_ONLY)
    return supported(line, 1)


LINES: tuple[Callable[[], Network], ...] = (two_wires, stitched, twin, compound, graded)


def main() -> None:
    """Measure and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--speed", type=float, default=250.0, help="km/h")
    given = parser.parse_args()
    print(
        f"{backend_name('native')}, {given.speed:g} km/h, 1 ms, thread CPU time, least of {BLOCKS}"
    )
    print("line         DOF  us/step  sweeps/step  ns/(DOF step)  of two wires")
    first = None
    for make in LINES:
        system = hanging(make().system(80.0))
        contact = system.position.reshape(-1, 6)[system.paths[0].nodes]
        height = float(np.interp(START, contact[:, 0], contact[:, 2]))
        pantograph = under_way(START, height, given.speed / 3.6)
        options = StepOptions(Newmark(), 1e-3, 5e4, tolerance=3e-8)
        stepper = make_stepper(system, (pantograph,), options, np.array([2]), "native")
        stepper.advance(WARM_UP)
        sweeps, spent = stepper.counters.iterations, []
        for _ in range(BLOCKS):
            begin = time.thread_time()
            stepper.advance(BLOCK)
            spent.append((time.thread_time() - begin) / BLOCK)
        sweeps = (stepper.counters.iterations - sweeps) / (BLOCK * BLOCKS)
        cost = 1e9 * min(spent) / system.dof_count
        first = first or cost
        print(
            f"{make.__name__:10s} {system.dof_count:6d} {1e6 * min(spent):8.1f} {sweeps:12.2f}"
            f" {cost:14.2f} {cost / first:13.2f}"
        )


if __name__ == "__main__":
    main()
