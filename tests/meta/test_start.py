"""The command line answers at once."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

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
