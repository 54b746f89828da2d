"""Where the time of a step goes, and how far each part is from the limits of the machine.

``python benchmarks/profile_steps.py --nodes 15``. Each part's arithmetic and memory traffic are
counted from the algorithm (per node that is swept, in iterations over the whole line and over some
rows; single precision counts half) and set against the matrix product and the triad of the same
process. Times are those of the fastest of blocks of steps.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import machine
from passage import WARM_UP, line_options, prepare

from tautwire.numerics.motion.backend import backend_name
from tautwire.numerics.motion.native_stepper import NativeStepper

STEPS, BLOCKS = 20, 60
LANES = {"native (AVX-512)": 8, "native (AVX2)": 4}
"""Doubles in a register; two where no other number is given. A row holds two nodes to a lane."""


@dataclass(frozen=True)
class Work:
    """What one iteration does per node.

    Attributes
    ----------
    flops : float
        Floating-point operations in double precision; two in single count as one.
    bytes : float
        Memory that must be read or written at least once.
    """

    flops: float
    bytes: float


# Elements: forces 142 (axial 62, the rest 80), inertia 70, strains 30; state 36; assembly 40; in
# single precision bending 215, damping 162, rotation 66 and factor 72.
ELIMINATION = Work(
    flops=142 + 70 + 30 + 36 + 40 + (215 + 162 + 66 + 72) / 2,
    bytes=8 * (18 + 12 + 6 + 10 + 1) + 4 * (45 + 36 + 4 + 6),
)
# Diagonal 72, lower factor 72 and rotation 66 in single precision; update 6.
SUBSTITUTION = Work(flops=(72 + 72 + 66) / 2 + 6, bytes=8 * 12 + 4 * (21 + 36 + 4 + 6))


@dataclass(frozen=True)
class Block:
    """The fastest block of steps: wall time of the parts and nodes swept, per step."""

    spent: dict[str, float]
    formed: float
    solved: float


def fastest(stepper: NativeStepper, nodes: int, lanes: int) -> Block:
    """Return the fastest of some blocks."""
    best: Block | None = None
    for _ in range(BLOCKS):
        before = dict(stepper.timings), work(stepper, nodes, lanes)
        begin = time.perf_counter()
        stepper.advance(STEPS)
        total = time.perf_counter() - begin
        spent = {k: (v - before[0][k]) / STEPS for k, v in stepper.timings.items()}
        swept = [
            (now - then) / STEPS
            for now, then in zip(work(stepper, nodes, lanes), before[1], strict=True)
        ]
        if best is None or total / STEPS < best.spent["step"]:
            best = Block(spent | {"step": total / STEPS}, *swept)
    assert best is not None
    return best


def work(stepper: NativeStepper, nodes: int, lanes: int) -> tuple[float, float]:
    """Return for how many nodes residuals were formed, and how many were solved for."""
    counters = stepper.counters
    whole, row = counters.iterations * nodes, 2 * lanes
    return (
        whole + row * counters.notes["local_rows"],
        whole + row * counters.notes["solved_rows"],
    )


def main() -> None:
    """Measure and print the table."""
    given = line_options(__doc__).parse_args()
    here = machine.measure()
    stepper, dofs = prepare(given.spans, given.nodes, "native")
    assert isinstance(stepper, NativeStepper)
    stepper.advance(WARM_UP)
    nodes, lanes = dofs // 6, LANES.get(backend_name(), 2)
    block = fastest(stepper, nodes, lanes)
    here = machine.measure().best_with(here)
    print(f"{backend_name()}, {given.spans} spans, NAD {given.nodes}, {dofs} DOF", end=", ")
    print(f"{1e6 * block.spent['step']:.0f} us per step;")
    print(f"the line is formed {block.formed / nodes:.2f} times", end=" and ")
    print(f"solved for {block.solved / nodes:.2f} times per step")
    print(f"machine: dgemm {here.dgemm:.1f} GFlop/s, triad {here.cached:.1f} GB/s in cache\n")
    print("part             us/step  share  GFlop/s  of dgemm    GB/s  of triad")
    for name, work_of, count in (
        ("elimination", ELIMINATION, block.formed),
        ("substitution", SUBSTITUTION, block.solved),
    ):
        rate = count / block.spent[name] / 1e9
        print(
            line_of(name, block) + f" {work_of.flops * rate:8.1f}"
            f" {work_of.flops * rate / here.dgemm:9.0%}"
            f" {work_of.bytes * rate:7.1f} {work_of.bytes * rate / here.cached:9.0%}"
        )
    spent = block.spent
    parts = ("elimination", "substitution", "contacts", "records")
    spent["time loop"] = spent["total"] - sum(spent[name] for name in parts)
    spent["Python"] = spent["step"] - spent["total"]
    for name in ("contacts", "records", "time loop", "Python"):
        print(line_of(name, block))


def line_of(name: str, block: Block) -> str:
    """Return the time of a part and its share."""
    spent = block.spent[name]
    return f"{name:15s} {1e6 * spent:8.1f} {spent / block.spent['step']:6.1%}"


if __name__ == "__main__":
    main()
