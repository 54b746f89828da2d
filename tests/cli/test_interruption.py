"""Ctrl-C and SIGTERM: what was computed is kept, readable and marked."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tautwire.cli.interrupts import Interrupts
from tautwire.cli.progress import PassageWatch, duration
from tautwire.cli.session import Answer, Interrupted
from tautwire.results.storage import load_run

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")

LONG = (
    "--set", "line.spans=4",
    "--set", "settings.nodes_between_droppers=3",
    "--set", "settings.time_step=50 us",
    "--set", "scenario.uplift_force=150 N",
)  # fmt: skip
"""A passage of many small steps, so that it is still under way when the signal comes."""


@pytest.fixture
def process(tmp_path: Path) -> Iterator[subprocess.Popen[str]]:
    """A run in a process of its own that has begun its passage."""
    command = [sys.executable, "-m", "tautwire", "run", "ac-simple", *LONG, "--out", "result",
               "--no-report", "--json"]  # fmt: skip
    with subprocess.Popen(
        command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stderr is not None
        for line in process.stderr:
            if line.startswith("passage"):
                break
        yield process
        process.kill()


@pytest.mark.parametrize(("number", "code"), [(signal.SIGTERM, 143), (signal.SIGINT, 130)])
def test_signal_keeps_partial_result(
    process: subprocess.Popen[str], tmp_path: Path, number: int, code: int
) -> None:
    """The first signal stops the passage; its files are complete, readable and marked."""
    process.send_signal(number)
    out, err = process.communicate(timeout=60)
    assert process.returncode == code
    assert "Traceback" not in err
    assert json.loads(out)["status"] == "partial"
    stored = load_run(tmp_path / "result" / "run.nc")
    assert stored.status == "partial"
    assert "interrupted" in stored.message
    assert 0.0 < stored.time[-1] < 2.3
    names = {path.name for path in (tmp_path / "result").iterdir()}
    assert names == {"run.nc", "results.json", "droppers.csv", "force.csv"}


def test_second_signal_stops_at_once() -> None:
    """The first signal is a request; the second, or one outside a passage, ends the command."""
    interrupts = Interrupts()
    with interrupts.handled():
        with interrupts.patient():
            os.kill(os.getpid(), signal.SIGTERM)
            assert interrupts.requested == signal.SIGTERM
            assert interrupts.exit_code == 143
            with pytest.raises(Interrupted):
                os.kill(os.getpid(), signal.SIGINT)
        with pytest.raises(Interrupted):
            os.kill(os.getpid(), signal.SIGTERM)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_watch_speaks_sparsely(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Away from a terminal progress is a line per passage and one now and then."""
    from tautwire.analyses.road.dynamics import Progress

    now = [100.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    with PassageWatch(Answer(as_json=True), Interrupts(), is_tuned=True) as watch:
        for step in range(100):
            now[0] += 1.0
            assert watch(1 + step // 50, Progress(step % 50 / 5.0, 10.0, step % 50)) is False
    told = capsys.readouterr()
    assert told.out == ""
    lines = told.err.splitlines()
    assert len(lines) == 6
    assert lines[0] == "passage 1 of the mean-force tuning: 10.0 s to simulate"
    assert lines[1] == "passage 1 of the mean-force tuning: 40 %, about 30 s left"


@pytest.mark.parametrize(
    ("seconds", "text"), [(42.4, "42 s"), (200.0, "3 min 20 s"), (7500.0, "2 h 5 min")]
)
def test_duration(seconds: float, text: str) -> None:
    """Times are told as people say them."""
    assert duration(seconds) == text
