"""Contact losses on irregular lines: error and cost of each step control, against 0.05 ms.

Five passages of the reference line at 320 km/h. Installation errors are not the sixth: at 50 kN/m
the draws tried that the droppers can carry (up to 4 mm) make the pantograph lose contact twice at
most.

    python benchmarks/contact_loss.py [--quick] [--passages 5] [--json FILE]
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import Any

import tautwire as tw
from tautwire.results.loss_comparison import LossMatch
from tautwire.results.statistics import ContactLoss

TOLERANCES = (0.8e-3, 0.2e-3, 0.05e-3, 0.0125e-3)
REPEATS = 3
STEPPINGS: dict[str, Any] = {
    "constant 1 ms": tw.ConstantStep(1e-3),
    "constant 1 ms, plain": tw.ConstantStep(1e-3, corrects_waves=False),
    "variable 1 ms": tw.VariableStep(1e-3),
    "variable 1 ms, plain": tw.VariableStep(1e-3, corrects_waves=False),
    "constant 0.2 ms": tw.ConstantStep(0.2e-3),
    **{f"adaptive {1e3 * t:g} ms": tw.AdaptiveStep(1e-3, tolerance=t) for t in TOLERANCES},
    "constant 0.5 ms": tw.ConstantStep(0.5e-3),
}
REFERENCE = tw.ConstantStep(0.05e-3)


@dataclass(frozen=True)
class IrregularLine:
    """A kind of irregularity, with an amplitude for each contact stiffness that loses contact."""

    name: str
    by_stiffness: dict[str, dict[str, Any]] = field(default_factory=dict)


def _uniform(amplitude: str) -> dict[str, Any]:
    return {"unevenness": [{"kind": "uniform", "spacing": "1 m", "amplitude": amplitude}]}


def _spectrum(level: str) -> dict[str, Any]:
    part = {"kind": "power law", "level": level, "reference": 1.0, "exponent": 2}
    return {"unevenness": [{**part, "shortest": "0.3 m", "longest": "6 m"}]}


def _installed(amplitude: str) -> dict[str, Any]:
    return {"installation": {"of": "height", "distribution": "uniform", "amplitude": amplitude}}


LINES = (
    IrregularLine("uniform errors of height", {"200 kN/m": _installed("2.5 mm")}),
    IrregularLine(
        "uniform unevenness",
        {"50 kN/m": _uniform("1.8 mm"), "200 kN/m": _uniform("0.5 mm")},
    ),
    IrregularLine(
        "unevenness from a spectrum",
        {"50 kN/m": _spectrum("1e-7 m^3"), "200 kN/m": _spectrum("1e-8 m^3")},
    ),
)


def passages(*, quick: bool) -> Iterator[tuple[str, tw.Model, tw.Equilibrium]]:
    """Yield the passages: name, line, shape."""
    smaller = {"line.spans": 8} if quick else {}
    for line in LINES:
        for stiffness, irregularities in line.by_stiffness.items():
            changes = {
                "settings.contact_stiffness": stiffness,
                "scenario.uplift_force": "174.2 N",
                "settings.seed": 1,
                "settings.nodes_between_droppers": 4 if quick else 9,
                "irregularities": irregularities,
                **smaller,
            }
            model = tw.build(tw.load_case("ac-simple-plane", changes))
            yield f"{line.name}, {stiffness}", model, tw.find_shape(model)


def measured(
    model: tw.Model, shape: tw.Equilibrium, repeats: int
) -> Iterator[tuple[str, ContactLoss, float]]:
    """Yield how each step control reads the losses, and its CPU seconds (the least of some)."""
    best: dict[str, float] = {}
    runs: dict[str, tw.Run] = {}
    for _ in range(repeats):
        for name, stepping in STEPPINGS.items():
            run = tw.simulate(model, shape, stepping=stepping)
            runs[name] = run
            best[name] = min(best.get(name, float("inf")), run.counters["cpu_s"])
    counted = tw.contact_loss(runs["constant 1 ms"], counted=True)[0]
    yield "constant 1 ms, counted", counted, best["constant 1 ms"]
    for name, run in runs.items():
        yield name, tw.contact_loss(run)[0], best[name]


def own_constant_run(losses: dict[str, ContactLoss]) -> str:
    """Say how far the variable step departs from the straight lines through a constant run."""
    pair = {name: losses[name] for name in ("variable 1 ms", "constant 1 ms")}
    match = tw.compare_losses(pair, shortest=0.0).matches[0]
    return (
        f"\nvariable 1 ms against constant 1 ms, interpolated: {len(match.pairs)} losses, largest "
        f"difference {1e3 * match.largest_difference:.3f} ms"
    )


def row(match: LossMatch, cpu: float, base: float) -> str:
    """Return one line of the table."""
    bad = sum(p.error > 0.08 and abs(p.difference) > 0.2e-3 for p in match.judged)
    return (
        f"| {match.label} | {match.loss.count} | {len(match.missed)} | {len(match.spurious)} "
        f"| {100.0 * match.median_error:.2f} | {100.0 * match.largest_error:.1f} "
        f"| {1e3 * match.largest_difference:.3f} | {bad} | {cpu:.2f} | {cpu / base:.2f} |"
    )


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="8 spans, coarse mesh, one repeat")
    parser.add_argument("--passages", type=int, default=5, help="how many of the passages")
    parser.add_argument("--json", type=Path, help="file for all numbers")
    options = parser.parse_args()
    results = {}
    for name, model, shape in islice(passages(quick=options.quick), options.passages):
        run = tw.simulate(model, shape, stepping=REFERENCE)
        reference, cpu = tw.contact_loss(run)[0], run.counters["cpu_s"]
        long_enough = sum(event.duration >= 1e-3 for event in reference.events)
        print(
            f"\n{name}: {reference.count} losses, {long_enough} of 1 ms or longer, "
            f"{reference.count_over()} of 5 ms or longer; reference 0.05 ms in {cpu:.1f} s CPU\n"
        )
        print(
            "| step control | losses | missed | spurious | median error % | largest % "
            "| largest ms | beyond 8 % and 0.2 ms | CPU s | of 1 ms |"
        )
        print("|---" * 10 + "|")
        rows = list(measured(model, shape, 1 if options.quick else REPEATS))
        base = next(seconds for label, _, seconds in rows if label == "constant 1 ms")
        for label, loss, seconds in rows:
            comparison = tw.compare_losses({label: loss, "0.05 ms": reference})
            print(row(comparison.matches[0], seconds, base), flush=True)
            results.setdefault(name, {})[label] = {**comparison.as_dict(), "cpu_s": seconds}
        print(own_constant_run({label: loss for label, loss, _ in rows}), flush=True)
    if options.json:
        options.json.write_text(json.dumps(results, indent=1), encoding="utf-8")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
