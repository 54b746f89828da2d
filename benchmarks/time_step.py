"""What the time step costs in accuracy, the wave correction and extrapolation give back.

``python benchmarks/time_step.py``: passages of AC simple, plane reading, at 320 km/h. Errors are
those of the contact force over the analysed section, as computed and below 20 Hz (sharp), against
extrapolation with steps of 0.25 ms.
"""

from __future__ import annotations

import numpy as np
from passage import line_options

import tautwire as tw
from tautwire.analyses.force.section import analysed_section
from tautwire.results.run import Run

STEPS = (0.5e-3, 1e-3, 2e-3)
REFERENCE = tw.ConstantStep(0.25e-3)


def main() -> None:
    """Integrate and print the table."""
    parser = line_options(__doc__)
    parser.add_argument("--case", default="ac-simple-plane")
    given = parser.parse_args()
    line = {"line.spans": given.spans, "settings.nodes_between_droppers": given.nodes}
    model = tw.build(tw.load_case(given.case, {**line, "scenario.uplift_force": "174.2 N"}))
    shape = tw.find_shape(model)
    fine = tw.simulate(model, shape, stepping=REFERENCE, integrator=tw.Extrapolated())
    print(
        "step ms  scheme               CPU s  rms N, raw  rms N, 0-20 Hz  sigma 0-20  sigma 0-200"
        "    Fmax"
    )
    report(fine, fine)
    for step in STEPS:
        for scheme, waves in (
            (tw.Newmark(), False),
            (tw.Newmark(), True),
            (tw.Extrapolated(), True),
        ):
            stepping = tw.ConstantStep(step, corrects_waves=waves)
            report(tw.simulate(model, shape, stepping=stepping, integrator=scheme), fine)


def report(run: Run, finest: Run) -> None:
    """Print one line of the table."""
    name = run.case.pantographs[0].name
    coarse, exact = run.contact_force(name), finest.contact_force(name)
    inside = analysed_section(run).contains(coarse.position)
    there = np.searchsorted(exact.time, coarse.time[inside] - 0.5 * exact.time_step)
    sharp = tw.SharpLowpass()
    low = [sharp.apply(record.force, record.time_step) for record in (coarse, exact)]
    pairs = ((coarse.force, exact.force), low)
    errors = [float(np.sqrt(np.mean((own[inside] - fine[there]) ** 2))) for own, fine in pairs]
    sharply = tw.contact_statistics(run).pantograph(name).sharp
    sigma = sharply.standard_deviations
    scheme = "Newmark, corrected" if "corrected" in run.counters["step_control"] else "Newmark"
    scheme = "extrapolated" if "extrapolated" in run.counters["integrator"] else scheme
    print(
        f"{1e3 * coarse.time_step:7.2f}  {scheme:18s}"
        f" {run.counters['cpu_s']:8.2f} {errors[0]:11.3f} {errors[1]:15.3f}"
        f" {sigma['0_20']:11.2f} {sigma['0_200']:12.2f} {sharply.maximum:7.1f}",
        flush=True,
    )


if __name__ == "__main__":
    main()
