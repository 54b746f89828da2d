"""Do error bars contain what a fine mesh and a short step give? Random lines of all topologies.

    python benchmarks/error_bars.py [--lines 60] [--seed 1] [--json FILE]

Every line is a library line of three to five spans with random speed, mesh and contact stiffness.
Its bars are compared with the same passage with mesh and step halved twice, under the same uplift
force. A line counts as contained when all its headline figures are.
"""

from __future__ import annotations

import argparse
import json
import random
import time
from pathlib import Path
from typing import Any

import tautwire as tw
from tautwire.analyses.road.accuracy import figures, with_accuracy
from tautwire.errors import TautwireError
from tautwire.specs.case import Case

BASES = (
    "ac-simple",
    "ac-simple-plane",
    "ac-stitched",
    "dc-twin",
    "compound",
    "tram",
    "en50318-2002",
)
FIGURES = ("mean", "0_20", "0_200", "maximum", "minimum", "loss", "uplift")
HALVINGS = 2


def random_case(chance: random.Random, base: str) -> Case:
    """Return a line of at most five spans; raises where the draw is not admissible."""
    nodes = chance.randint(4, 9)
    spans = chance.randint(3, 5)
    case = tw.load_case(base)
    share = chance.uniform(0.6, 1.05)
    return tw.load_case(
        base,
        {
            "line.spans": spans,
            "scenario.speed": round(share * case.scenario.speed, 2),
            "settings.nodes_between_droppers": nodes,
            "settings.graded_mesh": False,
            "settings.section": [2, spans - 1],
            "settings.contact_stiffness": chance.choice(["50 kN/m", "100 kN/m", "200 kN/m"]),
            "settings.error": "estimate",
        },
    )


def finer(case: Case) -> Case:
    """Return the case with mesh and step halved twice."""
    settings, times = case.settings, 2**HALVINGS
    nodes = settings.nodes_between_droppers
    assert nodes is not None
    return case.with_(
        **{
            "settings.time_step": settings.step() / times,
            "settings.nodes_between_droppers": times * (nodes - 1) + 1,
        }
    )


def passage(case: Case, forces: list[float] | None = None) -> tw.Run:
    """Run one passage."""
    model = tw.build(case)
    return tw.simulate(model, tw.find_shape(model), uplift_forces=forces)


def measured(case: Case) -> dict[str, Any]:
    """Return error, width and cost of one line."""
    run = passage(case)
    begin = time.process_time()
    run = with_accuracy(run)
    cost = time.process_time() - begin
    assert run.accuracy is not None, run.warnings
    exact = dict(figures(passage(finer(case), _forces(run))))
    rows = {}
    for name, value in figures(run):
        if name.split("/")[-1] in FIGURES and "butterworth" not in name:
            rows[name] = (value, value - exact[name], run.accuracy.of(*name.split("/")))
    loss = exact[f"{case.pantographs[0].name}/loss"]
    spent = run.accuracy.cpu_s / run.counters["cpu_s"]
    return {"figures": rows, "companion": spent, "with_shape_s": cost, "loss": loss}


def _forces(run: tw.Run) -> list[float]:
    return [record.uplift_force for record in run.pantographs]


def main() -> None:
    """Draw lines, compare, print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--lines", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--json", type=Path)
    given = parser.parse_args()
    chance, found = random.Random(given.seed), []
    while len(found) < given.lines:
        base = chance.choice(BASES)
        try:
            case = random_case(chance, base)
            row = measured(case)
        except TautwireError as error:
            print(f"{base}: not admissible: {str(error)[:90]}", flush=True)
            continue
        missed = [n for n, (_, error, width) in row["figures"].items() if abs(error) > width]
        found.append({"base": base, "nodes": case.settings.nodes_between_droppers, **row})
        print(
            f"{base:16s} NAD {case.settings.nodes_between_droppers} companion "
            f"{row['companion']:.2f} {'outside: ' + ', '.join(missed) if missed else 'contained'}",
            flush=True,
        )
        if given.json:
            given.json.write_text(json.dumps(found, indent=1), encoding="utf-8")
    inside = sum(all(abs(e) <= w for _, e, w in row["figures"].values()) for row in found)
    print(f"{inside} of {len(found)} lines contained")


if __name__ == "__main__":
    main()
