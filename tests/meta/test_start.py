"""The command line answers at once."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from ..lines import HAS_CORE

IMPORT_SECONDS = 0.1
HELP_SECONDS = 0.5


def _cpu_seconds(*arguments: str) -> float:
    """Return the least CPU time of three Python processes with these arguments."""
    resource = pytest.importorskip("resource", reason="CPU time of children is known on POSIX only")
    times = []
    for _ in range(3):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(
            [sys.executable, *arguments],
            check=True,
            capture_output=True,
            env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
        )
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        times.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return min(times)


def test_import_is_quick() -> None:
    """``import tautwire`` adds less than 0.1 s of CPU to the start of Python."""
    assert _cpu_seconds("-c", "import tautwire") - _cpu_seconds("-c", "pass") < IMPORT_SECONDS


def test_help_is_quick() -> None:
    """``tautwire --help`` takes less than 0.5 s of CPU."""
    code = "import sys; sys.argv = ['tautwire', '--help']; from tautwire.cli import main; main()"
    assert _cpu_seconds("-c", code) < HELP_SECONDS


CALLS = 3_600_000
"""Calls of a short run, imports included: 3.07 million with Python 3.11, and room for as much again
as a page of the report takes."""
HEAVY = (
    *("plotly.graph_objects", "h5netcdf", "xarray", "pandas"),
    *("scipy.signal", "scipy.optimize", "scipy.stats", "scipy.sparse.linalg"),
)
"""Packages that take 0.1 s and more to import and that a run has no use for."""
_COUNTED = """
import contextlib, cProfile, io, json, pstats, sys
profile, told = cProfile.Profile(), io.StringIO()
with contextlib.redirect_stdout(told), contextlib.redirect_stderr(told):
    profile.enable()
    from tautwire.cli.app import run_command_line
    code = run_command_line(sys.argv[1:])
    profile.disable()
print(json.dumps([code, pstats.Stats(profile).total_calls, sorted(sys.modules)]))
"""


@pytest.mark.skipif(not HAS_CORE, reason="steps in NumPy are thousands of calls each")
def test_run_has_a_budget_of_calls(tmp_path: Path) -> None:
    """A whole run, of a short line, makes no more calls than it did, which does not depend on what
    else the machine does, and imports nothing heavy that it does not need."""
    given = {
        "line.spans": 4,
        "settings.section": "[2, 3]",
        "settings.nodes_between_droppers": 4,
        "scenario.mean_force": "null",
        "scenario.uplift_force": "150 N",
    }
    sets = [word for path, value in given.items() for word in ("--set", f"{path}={value}")]
    answer = subprocess.run(
        [sys.executable, "-c", _COUNTED, "run", "ac-simple", *sets, "--out", str(tmp_path / "run")],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
    )
    code, calls, modules = json.loads(answer.stdout)
    assert code == 0
    assert (tmp_path / "run" / "report.html").exists()
    assert calls < CALLS
    assert not set(HEAVY) & set(modules)
