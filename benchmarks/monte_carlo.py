"""Monte Carlo over irregular lines: cases per minute, memory, and what a second worker costs.

    python benchmarks/monte_carlo.py [--study FILE] [--blocks 15 85 15 85] [--json FILE]

The cases of a study file (examples/studies/irregular-seeds.yaml) are computed in blocks, by one
worker and by two in turn, so that both meet the same machine. Printed per block: wall and CPU
seconds, load of the machine, largest memory of the workers early and late in the block.
"""

from __future__ import annotations

import argparse
import json
import os
import tempfile
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import median

from tautwire.studies.execution.executor import LocalWorkers
from tautwire.studies.plan import Plan, plan_study
from tautwire.studies.run import Options, run_study
from tautwire.studies.store import Store
from tautwire.studies.study_file import load_study

STUDY = Path(__file__).parents[1] / "examples" / "studies" / "irregular-seeds.yaml"


@dataclass(frozen=True)
class Block:
    """Cases computed in one go.

    Attributes
    ----------
    workers, cases, failed : int
    wall : float s
        Of the whole block.
    cpu_mean, cpu_median : float s
        Per case.
    memory_early, memory_late : float MB
        Largest memory of the workers after the first and after the last quarter of the cases.
    load : float
        Load average of the machine over the last minute, at the end.
    """

    workers: int
    cases: int
    failed: int
    wall: float
    cpu_mean: float
    cpu_median: float
    memory_early: float
    memory_late: float
    load: float

    @property
    def per_minute(self) -> float:
        """Cases per minute."""
        return 60.0 * self.cases / self.wall


def compute_block(plan: Plan, folder: Path, workers: int, cases: int) -> Block:
    """Compute some more cases of a study.

    Parameters
    ----------
    plan
    folder
        What is there already is not computed again.
    workers
        Number of processes.
    cases
        How many.
    """
    store = Store(folder)
    before = store.finished()
    begin = time.perf_counter()
    run_study(
        plan,
        folder,
        executor=LocalWorkers(workers, folder),
        options=Options(resume=True),
        watch=lambda progress: progress.computed >= cases,
    )
    wall = time.perf_counter() - begin
    keys = sorted(store.finished() - before, key=lambda k: store.row_path(k).stat().st_mtime)
    rows = [row for key in keys if (row := store.load(key)) is not None]
    done = [row["cost"] for row in rows if row["status"] == "done"]
    quarter = max(1, len(done) // 4)
    cpu = [cost["cpu_s"] for cost in done]
    return Block(
        workers=workers,
        cases=len(rows),
        failed=len(rows) - len(done),
        wall=wall,
        cpu_mean=sum(cpu) / len(cpu),
        cpu_median=median(cpu),
        memory_early=max(cost["peak_memory_mb"] for cost in done[:quarter]),
        memory_late=max(cost["peak_memory_mb"] for cost in done[-quarter:]),
        load=os.getloadavg()[0],
    )


def summary(blocks: Sequence[Block]) -> dict[str, float]:
    """Return CPU seconds per case by number of workers, their ratio, and the wall efficiency."""
    found: dict[str, float] = {}
    for workers in (1, 2):
        own = [block for block in blocks if block.workers == workers]
        cases = sum(block.cases for block in own)
        found[f"cpu_s_per_case_{workers}"] = sum(b.cpu_mean * b.cases for b in own) / cases
        found[f"cases_per_minute_{workers}"] = 60.0 * cases / sum(b.wall for b in own)
    found["cpu_ratio"] = found["cpu_s_per_case_2"] / found["cpu_s_per_case_1"]
    found["wall_efficiency"] = found["cases_per_minute_2"] / (2.0 * found["cases_per_minute_1"])
    found["memory_growth"] = max(block.memory_late / block.memory_early - 1.0 for block in blocks)
    return found


def main() -> None:
    """Compute the blocks and print them."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--study", type=Path, default=STUDY)
    parser.add_argument("--blocks", type=int, nargs="+", default=[15, 85, 15, 85])
    parser.add_argument("--out", type=Path, help="folder of the study; a temporary one by default")
    parser.add_argument("--json", type=Path)
    chosen = parser.parse_args()
    plan = plan_study(load_study(chosen.study))
    blocks: list[Block] = []
    with tempfile.TemporaryDirectory() as spare:
        folder = chosen.out or Path(spare)
        for number, cases in enumerate(chosen.blocks):
            block = compute_block(plan, folder, 1 + number % 2, cases)
            blocks.append(block)
            print(block, f"{block.per_minute:.1f} cases per minute", flush=True)
    total = summary(blocks)
    print({name: round(value, 3) for name, value in total.items()})
    if chosen.json:
        document = {"blocks": [asdict(block) for block in blocks], "summary": total}
        chosen.json.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
