"""Files without a seal are read in a process of their own first.

A damaged file can make the HDF5 library end the process, run for ever without heeding Ctrl-C, or
write tracebacks of its own. What a child process with limits has read to the end is safe to read.
"""

from __future__ import annotations

import json
import subprocess
import sys
from typing import NoReturn

SECONDS = 3.0
"""Processor time a child may spend on a file, which is to be refused within 5 s; both processes
together need about one to start."""
BYTES_PER_SECOND = 20e6
"""Size of a file that lengthens it by a second; reading makes 100 MB/s and more."""
MEMORY, MEMORY_PER_BYTE = 4 << 30, 64
"""Address space a child may use: for the libraries, and per byte of the file."""
COMMAND = ("-P", "-W", "ignore", "-m", "tautwire.results.storage")
"""Arguments of the Python interpreter; ``-P`` keeps it from importing out of the user's folder."""
_WALL = 15.0
"""Times the processor time after which a child that does nothing is ended."""


def tried(content: bytes, kind: str) -> str | None:
    """Read a file in a child process and return what is wrong with it, None when all is well.

    Parameters
    ----------
    content : bytes
        All of the file.
    kind : str
        ``"run"`` or ``"equilibrium"``.
    """
    limit = seconds_for(len(content))
    command = [sys.executable, *COMMAND, kind]
    try:
        child = subprocess.run(
            command, input=content, capture_output=True, timeout=_WALL * limit, check=False
        )
        answer = json.loads(child.stdout)
    except subprocess.TimeoutExpired:
        return "is damaged (reading it does not end)"
    except ValueError:
        return "is damaged (the HDF5 library cannot read it)"
    return answer["problem"]


def seconds_for(size: int) -> float:
    """Return the processor time [s] allowed for a file of ``size`` bytes."""
    return SECONDS + size / BYTES_PER_SECOND


def limit_process(size: int) -> None:
    """Limit further processor time and memory of this process, where the system can.

    The time is watched by a timer whose signal nothing handles: it ends the process even inside a
    library, and unlike the system's own limit it counts less than whole seconds.
    """
    try:
        import resource
        import signal
    except ImportError:  # not POSIX: the time limit of the parent remains
        return
    memory = MEMORY + MEMORY_PER_BYTE * size
    _, most = resource.getrlimit(resource.RLIMIT_AS)
    if most == resource.RLIM_INFINITY or memory < most:
        resource.setrlimit(resource.RLIMIT_AS, (memory, most))
    if hasattr(signal, "setitimer"):
        signal.setitimer(signal.ITIMER_PROF, seconds_for(size))


def answer_with(problem: str | None) -> NoReturn:
    """Tell the parent what was found, and end."""
    sys.stdout.write(json.dumps({"problem": problem}))
    sys.stdout.flush()
    sys.exit(0)
