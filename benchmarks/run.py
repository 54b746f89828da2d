"""Print what tautwire costs on this machine, in one table: ``python benchmarks/run.py``.

Each row is measured in a process of its own. Passages are those of AC simple at 320 km/h with steps
of 1 ms, solved to the default tolerance on one thread; their figures are seconds per simulated
second. The whole run is ``tautwire run ac-simple`` with NAD 9, its imports and files included.
Beside each figure stands what the machine could do at that moment (see machine.py), and ``work``:
the CPU time in units of the matrix product of that moment, GFlop. It is what a run is compared by:

    python benchmarks/run.py --store FILE      # keep this run
    python benchmarks/run.py --compare FILE    # benchmarks/stored.json by default

The last line tells what costs more than 10 % more work than stored, or has fallen by more than 10 %
against Exudyn; the exit code is 1 then. Ratios to a matrix product belong to a processor: the line
says so where the stored rows are from another one.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import machine

from tautwire.numerics.motion.backend import _load

HERE = Path(__file__).parent
STORED = HERE / "stored.json"
REGRESSION = 0.10
"""Share by which the work of a row may grow before it is told."""
LEVELS = {"v4": "AVX-512", "v3": "AVX2", "v2": "SSE4.2"}
EXUDYN = "two wires"
HEAD = (
    f"{'':22s}{'CPU s':>8s}{'wall s':>8s}{'work':>9s}{'stored':>9s}{'DOF':>8s}{'it/step':>8s}"
    f"{'MB':>6s}{'dgemm GF/s':>11s}{'cache GB/s':>11s}{'DRAM GB/s':>10s}  kernels"
)

Row = dict[str, Any]


def passage(level: str = "", repeats: int = 1, **options: Any) -> Row:
    """Measure a passage, on an instruction set; of several repeats the one of least work."""
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1"}
    if level:
        environment["TAUTWIRE_SIMD"] = level
    words = [word for name, value in options.items() for word in (f"--{name}", str(value))]
    command = [sys.executable, str(HERE / "passage.py"), *words]
    rows = []
    for _ in range(repeats):
        answer = subprocess.run(
            command, capture_output=True, text=True, check=True, env=environment
        )
        found = json.loads(answer.stdout)
        found |= {"cpu_s": found["cpu_per_s"], "wall_s": found["wall_per_s"]}
        rows.append(found | {"work": found["cpu_s"] * found["dgemm"]})
    return min(rows, key=lambda row: row["work"])


def whole_run(repeats: int = 1, **changes: Any) -> Row:
    """Measure ``tautwire run ac-simple``; of several repeats the one of least work."""
    sets = [word for path, value in changes.items() for word in ("--set", f"{path}={value}")]
    rows = []
    for _ in range(repeats):
        with tempfile.TemporaryDirectory() as folder:
            command = [sys.executable, "-m", "tautwire", "run", "ac-simple", *sets, "--json"]
            before, begin = machine.measure(), time.perf_counter()
            spent = _children()
            answer = subprocess.run(
                [*command, "--out", folder], capture_output=True, text=True, check=True
            )
            cpu, wall = _children() - spent, time.perf_counter() - begin
        here, told = machine.measure().best_with(before), json.loads(answer.stdout)
        rows.append(
            {
                "cpu_s": cpu,
                "wall_s": wall,
                "work": cpu * here.dgemm,
                "dof": told["cost"]["dof"],
                "iterations": told["cost"]["iterations_mean"],
                "backend": told["conventions"]["backend"],
                **vars(here),
            }
        )
    return min(rows, key=lambda row: row["work"])


def beside_exudyn() -> Row:
    """Measure the two-wire line in tautwire and in Exudyn, a general program; takes minutes."""
    before = machine.measure()
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, str(HERE / "exudyn_line.py")]
    answer = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
    told = re.search(
        r"^tautwire (.*): ([\d.]+) CPU s.*\nExudyn: ([\d.]+) CPU s", answer.stdout, re.MULTILINE
    )
    assert told is not None, answer.stdout
    here, cpu, theirs = machine.measure().best_with(before), float(told[2]), float(told[3])
    return {
        "cpu_s": cpu,
        "work": cpu * here.dgemm,
        "backend": told[1],
        "exudyn_cpu_s": theirs,
        "ratio": theirs / cpu,
        **vars(here),
    }


def _children() -> float:
    """Return the CPU time of all processes that were started and have ended [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def rows_of(seconds: float, repeats: int, spans: int) -> dict[str, Callable[[], Row]]:
    """Return what is measured, by name; what the processor lacks is left out later."""

    def own(**options: Any) -> Callable[[], Row]:
        return lambda: passage(repeats=repeats, **{"seconds": seconds, "spans": spans, **options})

    rows = {f"{spans} spans, NAD {nodes}": own(nodes=nodes) for nodes in (9, 15, 18)}
    rows |= {f"{n * spans} spans, NAD 9": own(spans=n * spans) for n in (2, 4)}
    rows |= {f"NAD 9, {name}": own(level=level) for level, name in LEVELS.items()}
    rows["NAD 9, NumPy"] = own(backend="reference", seconds=0.15 * seconds)
    rows["whole run, NAD 9"] = lambda: whole_run(
        repeats, **{"settings.nodes_between_droppers": 9, "line.spans": spans, **_inside(spans)}
    )
    if importlib.util.find_spec("exudyn") is not None:
        rows[EXUDYN] = beside_exudyn
    return rows


def _inside(spans: int) -> dict[str, str]:
    """Return the section of a line that is shorter than the case's own section asks for."""
    return {} if spans >= 17 else {"settings.section": f"[2, {spans - 1}]"}


def line(name: str, row: Row, stored: Mapping[str, Row]) -> str:
    """Return one line of the table."""
    known = stored.get(name, {}).get("work")
    before = "" if known is None else f"{known:.2f}"
    beside = f", {row['ratio']:.0f} times Exudyn" if "ratio" in row else ""
    number = {key: value for key, value in row.items() if isinstance(value, (int, float))}

    def cell(key: str, form: str) -> str:
        return format(number[key], form) if key in number else " " * int(form.split(".")[0])

    return (
        f"{name:22s}{cell('cpu_s', '8.3f')}{cell('wall_s', '8.3f')}{cell('work', '9.2f')}"
        f"{before:>9s}{cell('dof', '8.0f')}{cell('iterations', '8.2f')}{cell('memory_mb', '6.0f')}"
        f"{cell('dgemm', '11.1f')}{cell('cached', '11.1f')}{cell('memory', '10.1f')}"
        f"  {row['backend']}{beside}"
    )


def compared(rows: Mapping[str, Row], stored: Mapping[str, Row]) -> tuple[str, bool]:
    """Say in one line what costs more work than stored, and whether anything does.

    Rows that other kernels have computed are not compared.
    """
    both = [n for n in rows if n in stored and rows[n]["backend"] == stored[n]["backend"]]
    told = [words for n in both if (words := _slower(n, rows[n], stored[n]))]
    elsewhere = {stored[n]["processor"] for n in both} - {rows[n]["processor"] for n in both}
    here = f" (stored on {elsewhere.pop()}; here {rows[both[0]]['processor']})" if elsewhere else ""
    if not both:
        return "nothing to compare with", False
    if not told:
        return (
            f"no regression of more than {REGRESSION:.0%} in {len(both)} rows compared{here}",
            False,
        )
    return f"REGRESSION in {len(told)} of {len(both)} rows compared: {', '.join(told)}{here}", True


def _slower(name: str, row: Row, stored: Row) -> str:
    """Say what of a row is more than a regression; nothing where all is as it was."""
    grown = row["work"] / stored["work"] - 1.0
    fallen = (
        row["ratio"] / stored["ratio"] - 1.0 if {"ratio"} <= row.keys() & stored.keys() else 0.0
    )
    if grown > REGRESSION:
        return f"{name}: work +{grown:.0%}"
    return f"{name}: ratio to Exudyn {fallen:.0%}" if fallen < -REGRESSION else ""


def available(name: str) -> bool:
    """Tell whether the processor has the kernels of a row."""
    level = next((level for level, words in LEVELS.items() if name.endswith(words)), None)
    core = None if level is None else _load()[0]
    return level is None or (core is not None and level in core.runnable)


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print, store and compare."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--seconds", type=float, default=2.0, help="simulated seconds per row")
    parser.add_argument("--repeats", type=int, default=3, help="measurements per row")
    parser.add_argument("--spans", type=int, default=17, help="length of the line")
    parser.add_argument("--only", nargs="*", help="parts of the names of rows")
    parser.add_argument("--store", type=Path, help="file to keep the rows in")
    parser.add_argument("--compare", type=Path, default=STORED, help="file of stored rows")
    given = parser.parse_args(arguments)
    stored = json.loads(given.compare.read_text()) if given.compare.exists() else {}
    print(HEAD, flush=True)
    rows: dict[str, Row] = {}
    for name, measure in rows_of(given.seconds, given.repeats, given.spans).items():
        if given.only and not any(part in name for part in given.only):
            continue
        if not available(name):
            print(f"{name:22s} not on this processor")
            continue
        rows[name] = measure() | {"processor": machine.processor()}
        print(line(name, rows[name], stored), flush=True)
    if EXUDYN not in rows and not given.only:
        print(f"{EXUDYN:22s} Exudyn is not installed (pip install exudyn==1.13.6)")
    text, has_regressed = compared(rows, stored)
    print(text)
    if given.store:
        given.store.write_text(json.dumps(rows, indent=1) + "\n")
    return int(has_regressed)


if __name__ == "__main__":
    sys.exit(main())
