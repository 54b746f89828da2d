"""A finished computation is on disk before anything else is done with it, and stays there."""

from __future__ import annotations

import json
import os
import re
import resource
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from tautwire.cli import commands
from tautwire.cli.folders import RESULTS, default_folder
from tautwire.files import FolderLock
from tautwire.results.storage import load_elasticity, load_equilibrium, load_run

from .conftest import SHORT, Invoke

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals, locks and limits of POSIX")

RUN = ("run", "ac-simple", *SHORT)
STATIC = ("static", "ac-simple", "--set", "line.spans=4",
          "--set", "settings.nodes_between_droppers=3")  # fmt: skip
COMMAND = (sys.executable, "-m", "tautwire")


def _names(folder: str | Path) -> set[str]:
    return {path.name for path in Path(folder).iterdir()}


def test_folder_of_another_run_is_refused(invoke: Invoke) -> None:
    """A folder with the files of a result is refused before anything is computed, with both cures;
    --force replaces them all, so that no file of the other run stays."""
    Path("out").mkdir()
    for name in ("run.nc", "report.html", "force-2.csv", "results.json", "notes.txt"):
        Path("out", name).write_text("of another run")
    refused = invoke(*RUN, "--out", "out", "--no-report")
    assert refused.code == 2
    assert "holds the files of another result (run.nc, results.json, report.html" in refused.err
    assert "another folder with --out" in refused.err
    assert "--force" in refused.err
    assert Path("out/run.nc").read_text() == "of another run"
    assert invoke(*RUN, "--out", "out", "--no-report", "--force").code == 0
    assert _names("out") == {"run.nc", "results.json", "droppers.csv", "force.csv", "notes.txt"}
    assert load_run("out/run.nc").status == "done"
    assert invoke(*STATIC, "--out", "out").code == 2
    assert invoke(*STATIC, "--out", "out", "--force").code == 0
    written = {
        "static.nc",
        "static.json",
        "line.xlsx",
        "workshop.xlsx",
        "static.html",
        "droppers.csv",
        "elasticity.csv",
        "supports.csv",
        "design.csv",
    }
    assert _names("out") == {*written, "notes.txt"}


@pytest.mark.parametrize("command", ["run", "static"])
def test_every_file_of_a_result_is_known(command: str) -> None:
    """What a command writes into its folder is recognised there as that of another result."""
    text = Path(commands.__path__[0], f"{command}.py").read_text(encoding="utf-8")
    written = re.findall(r'files\.write\(\s*"([^"]+)"', text)
    assert len(written) > 1
    assert set(written) <= set(RESULTS)


def test_what_is_set_names_the_default_folder(invoke: Invoke) -> None:
    """Two runs that differ by --set go to two folders."""
    assert invoke(*RUN, "--no-report").code == 0
    assert invoke(*RUN, "--no-report", "--set", "scenario.speed=275 km/h").code == 0
    first, second = sorted(_names("."))
    assert first.startswith("tautwire-ac-simple-spans-4-nodes_between_droppers-3-time_step-4-ms-")
    assert second.startswith("tautwire-ac-simple-spans-4-nodes_between_droppers-3-time_step-4-ms-")
    assert (
        str(default_folder("line", ["scenario.speed=275 km/h"])) == "tautwire-line-speed-275-km-h"
    )
    assert str(default_folder("line")) == "tautwire-line"


def test_folder_in_use_is_refused(invoke: Invoke) -> None:
    """While one process computes for a folder another is refused, whatever it would write; what a
    killed process left half-written goes when the folder is free."""
    Path("out").mkdir()
    Path("out/.run.nc.123.part").write_text("half")
    with FolderLock(Path("out")):
        refused = invoke(*STATIC, "--out", "out")
        assert refused.code == 2
        assert "out: another command is computing for this folder" in refused.err
        assert _names("out") == {".run.nc.123.part", ".lock"}
    assert invoke(*STATIC, "--out", "out").code == 0
    assert ".run.nc.123.part" not in _names("out")


@pytest.mark.parametrize(
    "place", ["contact_statistics", "run_view", "run_document", "write_dropper_table", "to_json"]
)
def test_error_in_the_evaluation_keeps_the_run(
    place: str, invoke: Invoke, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever fails after the passage, run.nc is whole, and the message says where it is."""

    def broken(*_: object, **__: object) -> None:
        raise ZeroDivisionError("division by zero")

    monkeypatch.setattr(f"tautwire.cli.commands.run.{place}", broken)
    outcome = invoke(*RUN, "--out", "out")
    assert outcome.code == 1
    assert "the passage is kept in out/run.nc" in outcome.err
    assert load_run("out/run.nc").status == "done"


def _limited(size: int) -> None:
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of 200 kB."""
    place = tmp_path / "small"
    place.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=200k", "tmpfs", str(place)]
    if subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("mounting is not allowed")
    yield place
    subprocess.run(["umount", str(place)], check=True)


def _check_full(out: Path, done: subprocess.CompletedProcess[str]) -> None:
    assert done.returncode == 1, done.stderr
    assert "Traceback" not in done.stderr
    assert f"{out}/run.nc: cannot be written" in done.stderr
    assert "make room on the disk" in done.stderr
    assert json.loads(done.stdout)["status"] == "done"
    assert {"results.json", "droppers.csv"} <= _names(out)
    assert not [name for name in _names(out) if name.endswith(".part")]


def test_full_disk_costs_one_file(small_disk: Path) -> None:
    """On a disk that is too small for run.nc every file with room is still written, nothing is left
    half-written, and the exit code is 1."""
    out = small_disk / "out"
    done = subprocess.run(
        [*COMMAND, *RUN, "--set", "settings.time_step=1 ms", "--out", str(out), "--json"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    _check_full(out, done)


def test_file_too_large_costs_one_file(tmp_path: Path) -> None:
    """The same where files, not the disk, are limited in size."""
    done = subprocess.run(
        [*COMMAND, *RUN, "--out", "out", "--json", "--no-report"],
        capture_output=True, text=True, check=False, cwd=tmp_path,
        preexec_fn=lambda: _limited(120_000),
    )  # fmt: skip
    assert done.returncode == 1, done.stderr
    assert "out/run.nc: cannot be written (File too large)" in done.stderr
    assert {"results.json", "droppers.csv"} <= _names(tmp_path / "out")


def test_closed_output_keeps_every_file(tmp_path: Path) -> None:
    """With standard output closed from the start all files are written and whole."""
    command = " ".join(f"'{word}'" for word in [*COMMAND, *RUN, "--out", "out", "--no-report"])
    done = subprocess.run(
        ["sh", "-c", f"{command} >&-"], capture_output=True, text=True, check=False, cwd=tmp_path
    )
    assert done.returncode == 1
    assert "standard output cannot be written" in done.stderr
    assert "Traceback" not in done.stderr
    assert _names(tmp_path / "out") == {"run.nc", "results.json", "droppers.csv", "force.csv"}
    assert load_run(tmp_path / "out" / "run.nc").status == "done"


def test_stopped_static_keeps_its_shape(invoke: Invoke, monkeypatch: pytest.MonkeyPatch) -> None:
    """SIGTERM during the elasticity ends ``static`` with 143; shape and droppers are kept."""
    from tautwire.analyses.road import elasticity

    computed = elasticity._flexibilities

    def interrupted(*arguments: object) -> object:
        os.kill(os.getpid(), signal.SIGTERM)
        return computed(*arguments)  # pyright: ignore[reportArgumentType]

    monkeypatch.setattr(elasticity, "_flexibilities", interrupted)
    outcome = invoke(*STATIC, "--out", "out", "--json")
    assert outcome.code == 143
    assert outcome.document["status"] == "partial"
    assert outcome.document["elasticity"] is None
    kept = {"static.nc", "static.json", "droppers.csv", "line.xlsx", "supports.csv", "design.csv"}
    assert _names("out") == kept
    _, shape = load_equilibrium("out/static.nc")
    assert np.isfinite(shape.position).all()
    assert load_elasticity("out/static.nc") is None


def test_nonsense_is_named_everywhere(invoke: Invoke) -> None:
    """A head that goes through the wire is told on the terminal, in JSON, in run.nc, in the
    report."""
    soft = ("--set", "settings.contact_stiffness=1 kN/m")
    outcome = invoke(*RUN, *soft, "--out", "out", "--json")
    assert outcome.code == 0
    (told,) = [text for text in outcome.document["warnings"] if text.startswith("outside")]
    assert "gone through it" in told
    assert told in " ".join(outcome.err.split())
    assert told in load_run("out/run.nc").warnings
    assert "gone through it" in Path("out/report.html").read_text(encoding="utf-8")
