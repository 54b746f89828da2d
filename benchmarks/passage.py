"""Measure one passage of AC simple in this process and print it as one JSON line."""

from __future__ import annotations

import argparse
import json
import resource
import time
from dataclasses import asdict

import machine
import numpy as np

import tautwire as tw
from tautwire.model.equations import equations
from tautwire.model.passage import plan_passage
from tautwire.numerics.motion.backend import backend_name, make_stepper
from tautwire.numerics.motion.stepper import StepOptions, Stepper
from tautwire.numerics.newmark import Newmark

BLOCK = 100
WARM_UP = 300


def prepare(spans: int, nodes: int, backend: str) -> tuple[Stepper, int]:
    """Load, build, find the shape and factor; return the time integration and its size."""
    case = tw.load_case("ac-simple-plane").with_(
        **{
            "line.spans": spans,
            "settings.nodes_between_droppers": nodes,
            "settings.section": None,
        }
    )
    model = tw.build(case)
    shape = tw.find_shape(model)
    system = equations(model, shape)
    pantographs = plan_passage(model, shape, case.uplift_forces()).pantographs
    settings = case.settings
    options = StepOptions(
        Newmark(), settings.step(), settings.contact_stiffness, tolerance=settings.tolerance
    )
    observed = 6 * model.mesh.nodes(at for _, at in model.line.contact_supports) + 2
    stepper = make_stepper(system, pantographs, options, observed, backend)  # type: ignore[arg-type]
    stepper.advance(1)
    return stepper, system.dof_count


def measure(spans: int, nodes: int, seconds: float, backend: str = "auto") -> dict[str, object]:
    """Return the cost of a stretch of a passage."""
    before = machine.measure()
    begin = time.process_time()
    stepper, dofs = prepare(spans, nodes, backend)
    setup = time.process_time() - begin
    stepper.advance(WARM_UP)
    spent, iterations, start = [], stepper.counters.iterations, time.perf_counter()
    blocks = max(3, round(seconds * 1000.0 / BLOCK))
    for _ in range(blocks):
        begin = time.process_time()
        stepper.advance(BLOCK)
        spent.append(time.process_time() - begin)
    steps, wall = blocks * BLOCK, time.perf_counter() - start
    here = machine.measure().best_with(before)
    return {
        "backend": backend_name(backend),  # type: ignore[arg-type]
        "spans": spans,
        "nodes": nodes,
        "dof": dofs,
        "iterations": (stepper.counters.iterations - iterations) / steps,
        "cpu_per_s": sum(spent) / steps * 1000.0,
        "wall_per_s": wall / steps * 1000.0,
        "median_per_s": float(np.median(spent)) / BLOCK * 1000.0,
        "setup_s": setup,
        "memory_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
        **asdict(here),
    }


def line_options(description: str | None) -> argparse.ArgumentParser:
    """Return a parser that knows the size of the line."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--spans", type=int, default=17)
    parser.add_argument("--nodes", type=int, default=9, help="nodes between droppers (NAD)")
    return parser


def main() -> None:
    """Read the options and print the measurement."""
    parser = line_options(__doc__)
    parser.add_argument("--seconds", type=float, default=2.0, help="simulated seconds measured")
    parser.add_argument("--backend", default="auto", choices=["auto", "native", "reference"])
    given = parser.parse_args()
    print(json.dumps(measure(given.spans, given.nodes, given.seconds, given.backend)))


if __name__ == "__main__":
    main()
