"""Where the time of a step goes, and how far each part is from the limits of the machine.

``python benchmarks/profile_steps.py --nodes 15``. Each part's arithmetic and memory traffic per
iteration are counted from the algorithm (per station, both wires; single precision counts half) and
set against the matrix product and the triad of the same process.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import machine
from passage import WARM_UP, line_options, prepare

from tautwire.numerics.motion.backend import backend_name
from tautwire.numerics.motion.native_stepper import NativeStepper

STEPS = 1000


@dataclass(frozen=True)
class Work:
    """What one iteration does per station.

    Attributes
    ----------
    flops : float
        Floating-point operations in double precision; two in single count as one.
    bytes : float
        Memory that must be read or written at least once.
    """

    flops: float
    bytes: float


# Two wires per station. Elements: forces 380, inertia 70, strains 30; damping 162 in single
# precision; state 36; rotation 66 and factor 72 in single precision; assembly 40.
ELIMINATION = Work(
    flops=2 * (380 + 70 + 30 + 36 + 40) + 162 + 66 + 72,
    bytes=2 * (8 * (18 + 6 + 14 + 1) + 4 * (45 + 36 + 4 + 6)),
)
# Diagonal 72, lower factor 72 and rotation 66 in single precision; update 6.
SUBSTITUTION = Work(flops=72 + 72 + 66 + 2 * 6, bytes=2 * (8 * 12 + 4 * (21 + 36 + 4 + 6)))


def main() -> None:
    """Measure and print the table."""
    given = line_options(__doc__).parse_args()
    here = machine.measure()
    stepper, dofs = prepare(given.spans, given.nodes, "native")
    assert isinstance(stepper, NativeStepper)
    stepper.advance(WARM_UP)
    before, iterations = stepper.timings, stepper.counters.iterations
    begin = time.perf_counter()
    stepper.advance(STEPS)
    total = time.perf_counter() - begin
    here = machine.measure().best_with(here)
    spent = {name: value - before[name] for name, value in stepper.timings.items()}
    iterations = stepper.counters.iterations - iterations
    print(f"{backend_name()}, {given.spans} spans, NAD {given.nodes}, {dofs} DOF", end=", ")
    print(f"{iterations / STEPS:.2f} iterations and {1e6 * total / STEPS:.0f} us per step")
    print(f"machine: dgemm {here.dgemm:.1f} GFlop/s, triad {here.cached:.1f} GB/s in cache\n")
    print("part             us/step  share  GFlop/s  of dgemm    GB/s  of triad")
    stations = dofs / 12
    for name, work in (("elimination", ELIMINATION), ("substitution", SUBSTITUTION)):
        rate = stations * iterations / spent[name] / 1e9
        print(
            f"{name:15s} {1e6 * spent[name] / STEPS:8.1f} {spent[name] / total:6.1%}"
            f" {work.flops * rate:8.1f} {work.flops * rate / here.dgemm:9.0%}"
            f" {work.bytes * rate:7.1f} {work.bytes * rate / here.cached:9.0%}"
        )
    rest = spent["total"] - sum(
        spent[n] for n in ("elimination", "substitution", "contacts", "records")
    )
    for name, value in (
        ("contacts", spent["contacts"]),
        ("records", spent["records"]),
        ("time loop", rest),
        ("Python", total - spent["total"]),
    ):
        print(f"{name:15s} {1e6 * value / STEPS:8.1f} {value / total:6.1%}")


if __name__ == "__main__":
    main()
