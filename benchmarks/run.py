"""Print what tautwire costs on this machine: ``python benchmarks/run.py``.

Each line is measured in a process of its own: a passage of AC simple at 320 km/h with steps of
1 ms, solved to the default tolerance on one thread. Figures are CPU time; the last columns say what
the machine could do at that moment (see machine.py).
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import os
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

WORKER = Path(__file__).with_name("passage.py")
EXUDYN = Path(__file__).with_name("exudyn_line.py")
HEAD = (
    "spans  NAD     DOF  it/step  CPU s per simulated s  MDOF-steps/s  set-up s  peak MB"
    "  dgemm GF/s  cache GB/s  DRAM GB/s  kernels"
)


def measured(level: str = "", **options: Any) -> dict[str, Any]:
    """Run the worker with some options, on an instruction set."""
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1"}
    if level:
        environment["TAUTWIRE_SIMD"] = level
    words = [word for name, value in options.items() for word in (f"--{name}", str(value))]
    answer = subprocess.run(
        [sys.executable, str(WORKER), *words],
        capture_output=True,
        text=True,
        check=True,
        env=environment,
    )
    return json.loads(answer.stdout)


def line(m: dict[str, Any]) -> str:
    """Return one line of the table."""
    rate = m["dof"] / m["cpu_per_s"] / 1000.0
    return (
        f"{m['spans']:5d}  {m['nodes']:3d}  {m['dof']:6d}  {m['iterations']:7.2f}"
        f"  {m['cpu_per_s']:9.3f} (median {m['median_per_s']:.3f})  {rate:12.0f}"
        f"  {m['setup_s']:8.2f}  {m['memory_mb']:7.0f}  {m['dgemm']:10.1f}"
        f"  {m['cached']:10.1f}  {m['memory']:9.1f}  {m['backend']}"
    )


def table(title: str, rows: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    """Print a table while it is measured and return its rows."""
    print(f"\n{title}\n{HEAD}", flush=True)
    done = []
    for row in rows:
        done.append(row)
        print(line(row), flush=True)
    return done


def main() -> None:
    """Measure meshes, line lengths and instruction sets."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=2.0, help="simulated seconds per line")
    seconds = parser.parse_args().seconds
    table("Meshes", (measured(nodes=n, seconds=seconds) for n in (9, 15, 18)))
    lengths = table(
        "Lengths of the line", (measured(spans=n, seconds=seconds) for n in (17, 34, 68))
    )
    cost = [row["cpu_per_s"] / row["spans"] for row in lengths]
    print(f"CPU time per span and second, 68 spans against 17: {cost[-1] / cost[0]:.3f}")
    if "AVX" in lengths[0]["backend"] or "SSE" in lengths[0]["backend"]:
        levels = ("v4", "v3", "v2") if "512" in lengths[0]["backend"] else ("v3", "v2")
        rows = table("Instruction sets", (measured(level, seconds=seconds) for level in levels))
        ratios = ", ".join(
            f"{name} {row['cpu_per_s'] / rows[0]['cpu_per_s']:.2f}"
            for name, row in zip(levels, rows, strict=True)
        )
        print(f"CPU time relative to the first: {ratios}")
    table("NumPy reference", [measured(seconds=0.3, backend="reference")])
    print("\nThe same two-wire line in Exudyn", flush=True)
    if importlib.util.find_spec("exudyn") is None:
        print("left out: exudyn is not installed (pip install exudyn==1.13.6)")
        return
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1"}
    subprocess.run([sys.executable, str(EXUDYN)], check=True, env=environment)


if __name__ == "__main__":
    main()
