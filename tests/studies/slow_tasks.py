"""Tasks that stand in for the physics: they note in a file what they begin and end.

The file is named by the environment variable ``TASK_LOG``; every line is written at once.
"""

from __future__ import annotations

import os
import signal
import time
from typing import Any

from tautwire.errors import ConvergenceError
from tautwire.specs.case import Case

NAP = 0.15
Numbers = dict[str, Any]


def note(word: str, case: Case) -> None:
    """Append a line to the log; short appends are not mixed up between processes."""
    log = os.open(os.environ["TASK_LOG"], os.O_WRONLY | os.O_APPEND | os.O_CREAT)
    os.write(log, f"{word} {case.settings.seed} {os.getpid()}\n".encode())
    os.close(log)


def nap(case: Case, keep_run: bool) -> tuple[Numbers, bytes | None]:
    """Sleep a little and return the seed squared."""
    note("begin", case)
    time.sleep(NAP)
    note("end", case)
    return {"square": case.settings.seed**2}, b"a run" if keep_run else None


def murder(case: Case, keep_run: bool) -> tuple[Numbers, bytes | None]:
    """Like :func:`nap`, but the case with seed 3 kills its process."""
    note("begin", case)
    if case.settings.seed == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return nap(case, keep_run)


def stumble(case: Case, keep_run: bool) -> tuple[Numbers, bytes | None]:
    """Fail for every third seed, each time with another number; crash for seed 4."""
    if case.settings.seed % 3 == 0:
        raise ConvergenceError(f"stopped at t = {1.5 + case.settings.seed:.3f} s; try less")
    if case.settings.seed == 4:
        raise RuntimeError("an error nobody thought of")
    return nap(case, keep_run)


def swell(case: Case, keep_run: bool) -> tuple[Numbers, bytes | None]:
    """Return a run file that is larger with every seed."""
    numbers, _ = nap(case, keep_run)
    return numbers, bytes(6000 * (1 + case.settings.seed))
