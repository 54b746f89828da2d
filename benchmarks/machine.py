"""What the machine can do at the moment: arithmetic and memory, measured with NumPy.

Shared machines change from minute to minute; every figure of the benchmarks is therefore shown next
to these, measured in the same process just before and after.
"""

from __future__ import annotations

import platform
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

_MATRIX = 768
_CACHED, _LARGE = 100_000, 4_000_000


@dataclass(frozen=True)
class Machine:
    """Speed of one core.

    Attributes
    ----------
    dgemm : float GFlop/s
        Matrix product in double precision.
    cached, memory : float GB/s
        Triad ``a = b + c`` with arrays of 2.4 MB and 96 MB together.
    """

    dgemm: float
    cached: float
    memory: float

    def best_with(self, other: Machine) -> Machine:
        """Return the better figures of two measurements."""
        return Machine(
            max(self.dgemm, other.dgemm),
            max(self.cached, other.cached),
            max(self.memory, other.memory),
        )


def _fastest(work: object, repeats: int) -> float:
    """Return the shortest CPU time of a call [s]."""
    assert callable(work)
    best = float("inf")
    for _ in range(repeats):
        begin = time.process_time()
        work()
        best = min(best, time.process_time() - begin)
    return best


def _triad(count: int, calls: int) -> float:
    b, c, a = (np.full(count, value) for value in (1.0, 2.0, 0.0))

    def work() -> None:
        for _ in range(calls):
            np.add(b, c, out=a)

    return calls * 24.0 * count / _fastest(work, 7) / 1e9


def processor() -> str:
    """Return the name of the processor, as far as the system tells it."""
    told = Path("/proc/cpuinfo")
    lines = told.read_text(encoding="utf-8").splitlines() if told.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


def measure() -> Machine:
    """Measure the machine in about half a second."""
    a = np.ones((_MATRIX, _MATRIX))
    out = np.empty_like(a)
    seconds = _fastest(lambda: np.matmul(a, a, out=out), 7)
    return Machine(2.0 * _MATRIX**3 / seconds / 1e9, _triad(_CACHED, 40), _triad(_LARGE, 1))
