"""What the fast path's tolerance costs: contact forces against the full Newton method.

``python benchmarks/accuracy.py``: whole passages of AC simple, the compiled core as it runs by
default (constant factor in single precision, residual in double, default tolerance) against its own
full Newton method in double precision to 1e-10 m. The last line is a passage with many losses of
contact at 500 kN/m, whose number must be the same.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from passage import line_options

import tautwire as tw
from tautwire.model.equations import equations
from tautwire.model.passage import plan_passage
from tautwire.numerics.motion.backend import make_stepper
from tautwire.numerics.motion.stepper import StepBlock, StepOptions
from tautwire.numerics.newmark import Newmark
from tautwire.status import Status

TIGHT = 1e-10
PASSAGES: dict[str, dict[str, Any]] = {
    "50 kN/m": {"settings.contact_stiffness": "50 kN/m"},
    "200 kN/m": {"settings.contact_stiffness": "200 kN/m"},
    "500 kN/m, uneven": {
        "settings.contact_stiffness": "500 kN/m",
        "irregularities": {
            "unevenness": [{"kind": "uniform", "spacing": "1 m", "amplitude": "0.5 mm"}]
        },
    },
}


def both(case: tw.Case) -> Iterator[StepBlock]:
    """Yield the whole passage on the fast path, then with full Newton."""
    model = tw.build(case)
    shape = tw.find_shape(model)
    plan = plan_passage(model, shape, case.uplift_forces())
    system = equations(model, shape)
    settings = case.settings
    steps = round(plan.duration / settings.step())
    for full_newton, tolerance in ((False, settings.tolerance), (True, TIGHT)):
        options = StepOptions(
            Newmark(),
            settings.step(),
            settings.contact_stiffness,
            tolerance=tolerance,
            full_newton=full_newton,
        )
        nothing = np.empty(0, dtype=np.int64)
        stepper = make_stepper(system, plan.pantographs, options, nothing, "native")
        block = stepper.advance(steps)
        assert block.status is Status.RUNNING, block.status.sentence
        yield block


def losses(block: StepBlock) -> int:
    """Return how often contact is lost."""
    lost = block.gap[:, 0] >= 0.0
    return int(np.count_nonzero(lost[1:] & ~lost[:-1]))


def main() -> None:
    """Integrate and print the table."""
    given = line_options(__doc__).parse_args()
    print("passage           steps  std N  rms error N  max error N  losses  with full Newton")
    for name, changes in PASSAGES.items():
        line = {"line.spans": given.spans, "settings.nodes_between_droppers": given.nodes}
        fast, full = both(tw.load_case("ac-simple-plane", changes | line))
        error = fast.contact_force - full.contact_force
        print(
            f"{name:16s} {len(fast.time):6d} {full.contact_force.std():6.1f}"
            f" {np.sqrt(np.mean(error**2)):12.5f} {np.abs(error).max():12.4f}"
            f" {losses(fast):7d} {losses(full):17d}",
            flush=True,
        )


if __name__ == "__main__":
    main()
