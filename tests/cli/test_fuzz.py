"""Damaged files end in a message and an exit code: never in a traceback, never in waiting.

The test lasts two minutes and is the same every time but for its length, which the machine decides;
``TAUTWIRE_FUZZ_INPUTS`` sets a number of inputs instead, ``TAUTWIRE_FUZZ_SEED`` another seed.
"""

from __future__ import annotations

import math
import os
import signal
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import islice, takewhile
from pathlib import Path
from types import FrameType

import pytest
import yaml

from tautwire.catalogue.entries import read_entry
from tautwire.errors import InputError
from tautwire.inputs.reading.recording import load_recording
from tautwire.studies.axes import write_out
from tautwire.studies.plan import plan_study
from tautwire.studies.study_file import load_study

from ..mutations import Seed, mutants
from .conftest import Invoke

DURATION = 120.0
"""Seconds that the test lasts."""
MOST_CASES = 100
"""Cases of a study that are made; a study of thousands is work, not damage."""
PATIENCE = 5.0
"""Seconds of work that one input may cost."""
WAITING = 60.0
"""Seconds of waiting after which an input hangs, whatever else the machine does."""
SUPPORTS = "support,x,encumbrance [mm]\n" + "".join(
    f"{i},{60 * i - 60},1200\n" for i in range(1, 6)
)
DROPPERS = "span;dropper;position;presag [mm]\n" + "".join(
    f"{s};{d};{12 * d},5;{10 * d}\n" for s in range(1, 5) for d in range(1, 5)
)
ROOF = "time [ms],height [mm]\n0,0\n500,2\n1000,-2\n"
PROFILE = "x,height [mm]\n" + "".join(f"{i},{i % 3}\n" for i in range(40))
RECORD = "time [ms]\tposition\tforce [kN]\n" + "".join(
    f"{i}\t{0.2 * i:.1f}\t0,1{i}\n" for i in range(40)
)
TABLES = {"supports.csv": SUPPORTS, "droppers.csv": DROPPERS, "roof.csv": ROOF,
          "profile.csv": PROFILE}  # fmt: skip
USE = """
schema: 1
include: ac-simple
name: tables
line: {spans: 4}
tables: {supports: supports.csv, droppers: droppers.csv}
irregularities: {unevenness: [{kind: profile, table: profile.csv}]}
pantographs: [{include: benchmark-2015-pantograph, name: p, roof_motion: {table: roof.csv}}]
"""
STUDY = {
    "schema": 1, "name": "s", "base": "ac-simple", "design": "grid", "samples": 4,
    "overrides": {"line.spans": 6},
    "axes": {
        "scenario.speed": ["250 km/h", "300 km/h"],
        "settings.contact_stiffness": {"from": "50 kN/m", "to": "200 kN/m", "count": 3},
        "droppers.presag[5]": {"low": "50 mm", "high": "60 mm", "scale": "linear"},
        "settings.seed": {"seeds": 2},
        "mesh": {"variants": {"fine": {"settings.nodes_between_droppers": 9}, "coarse": {}}},
    },
}  # fmt: skip


def seeds() -> list[Seed]:
    """Return good files of every kind and language."""
    case = yaml.safe_load(read_entry("ac-simple"))
    two = yaml.safe_load(read_entry("ac-simple-two-pantographs"))
    two |= {"settings": {"step_control": {"method": "adaptive"}}, "line": {"span_length": [50] * 9}}
    found = [Seed(f"case.{language}", case) for language in ("yaml", "toml", "json")]
    found += [Seed("case.yaml", two), Seed("case.yaml", read_entry("ac-simple"))]
    found += [Seed(f"study.{language}", STUDY) for language in ("yaml", "toml", "json")]
    found += [Seed(name, text) for name, text in TABLES.items()]
    return [*found, Seed("record.csv", RECORD)]


class TooLong(BaseException):
    """An input took longer than it may."""


@contextmanager
def patient() -> Iterator[None]:
    """Give up after :data:`PATIENCE` or :data:`WAITING`, where the system has alarms."""

    def ring(number: int, frame: FrameType | None) -> None:
        raise TooLong

    if not hasattr(signal, "setitimer"):
        yield
        return
    clocks = ((signal.ITIMER_PROF, signal.SIGPROF, PATIENCE),
              (signal.ITIMER_REAL, signal.SIGALRM, WAITING))  # fmt: skip
    before = [signal.signal(number, ring) for _, number, _ in clocks]
    for clock, _, seconds in clocks:
        signal.setitimer(clock, seconds)
    try:
        yield
    finally:
        for (clock, number, _), handler in zip(clocks, before, strict=True):
            signal.setitimer(clock, 0.0)
            signal.signal(number, handler)


def outcome_of(seed: Seed, invoke: Invoke) -> str:
    """Use a damaged file as its kind is used, and return what is wrong with that; empty if fine."""
    try:
        with patient():
            if seed.name.startswith("study"):
                return _planned(Path(seed.name))
            if seed.name == "record.csv":
                return _recorded(Path(seed.name))
            told = invoke("check", seed.name if seed.name.startswith("case") else "tables.yaml")
    except TooLong:
        return f"more than {PATIENCE:g} s of work, or {WAITING:g} s of waiting"
    except Exception as error:  # noqa: BLE001 - whatever comes out is the finding
        return f"{type(error).__name__}: {error}"
    if told.code not in (0, 2) or "Traceback" in told.err:
        return f"exit code {told.code}: {told.err[-300:]}"
    return "control character" if "\x1b" in told.err + told.out else ""


def _planned(path: Path) -> str:
    try:
        study = load_study(path)
        sizes = [dimension.size for dimension in write_out(study)[0]]
        if math.prod(sizes) <= MOST_CASES:
            plan_study(study)
    except InputError as error:
        return "" if len(str(error)) < 20_000 else "a very long message"
    return ""


def _recorded(path: Path) -> str:
    try:
        load_recording(path)
    except InputError as error:
        return "" if len(str(error)) < 20_000 else "a very long message"
    return ""


def _inputs(number: int, seed: int) -> Iterator[tuple[Seed, bytes]]:
    """Return as many damaged files as are asked for, or as fit into the time."""
    endless = mutants(seeds(), seed)
    if number:
        return islice(endless, number)
    end = time.monotonic() + DURATION
    return takewhile(lambda _: time.monotonic() < end, endless)


@pytest.mark.slow
def test_damaged_files(invoke: Invoke) -> None:
    """Case, study and tables damaged at random are read or refused, each within 5 s of work."""
    number = int(os.environ.get("TAUTWIRE_FUZZ_INPUTS", "0"))
    seed = int(os.environ.get("TAUTWIRE_FUZZ_SEED", "9"))
    bad: list[str] = []
    tried: Counter[str] = Counter()
    Path("tables.yaml").write_text(USE, encoding="utf-8")
    for good, content in _inputs(number, seed):
        for name, text in TABLES.items():
            Path(name).write_text(text, encoding="utf-8")
        Path(good.name).write_bytes(content)
        tried[good.name] += 1
        if fault := outcome_of(good, invoke):
            kept = f"found-{len(bad)}-{good.name}"
            Path(kept).write_bytes(content)
            bad.append(f"{kept}: {fault}")
    assert not bad, "\n".join(bad)
    assert min(tried[good.name] for good in seeds()) > 0
