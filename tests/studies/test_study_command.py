"""``tautwire study`` on the command line: real short passages, files, exit codes."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tautwire.analyses.force.statistics import contact_statistics
from tautwire.analyses.road.pipeline import run_case
from tautwire.inputs.load import load_case
from tautwire.results.storage import load_run

from .conftest import SMALL

STUDY = {
    "schema": 1,
    "name": "short",
    "title": "A short study",
    "base": "ac-simple",
    "overrides": SMALL,
    "keep_runs": True,
    "axes": {
        "scenario.speed": ["250 km/h", "300 km/h", "600 km/h"],
        "m": {
            "variants": {
                "as it is": {},
                "diverging": {
                    "settings.time_step": "50 ms",
                    "settings.contact_stiffness": 1e9,
                },
            }
        },
    },
}
"""Two cases that work, two with steps that are far too coarse, two that are refused."""


def tautwire(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run the command in a folder."""
    return subprocess.run(
        [sys.executable, "-m", "tautwire", *arguments],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )


def write(folder: Path, study: dict[str, Any]) -> None:
    (folder / "study.json").write_text(json.dumps(study))


@pytest.fixture(scope="module")
def finished(
    tmp_path_factory: pytest.TempPathFactory,
) -> tuple[Path, subprocess.CompletedProcess[str]]:
    """Folder and outcome of a finished study."""
    folder = tmp_path_factory.mktemp("command")
    write(folder, STUDY)
    (folder / "block.yaml").write_text("client: Valley Railway\n", encoding="utf-8")
    options = ("--workers", "2", "--project", "block.yaml", "--json")
    return folder, tautwire(folder, "study", "study.json", *options)


def test_document(finished: tuple[Path, subprocess.CompletedProcess[str]]) -> None:
    """One JSON document on standard output: counts, grouped failures, rows; exit code 0.

    The two cases with steps of 50 ms fail: their passage stops, or ends with a record that is too
    coarse for 20 Hz, which depends on rounding, so on the kernels. What counts is that no reason
    is listed twice because of the numbers in it.
    """
    _, outcome = finished
    assert outcome.returncode == 0, outcome.stderr
    document = json.loads(outcome.stdout)
    counts = document["cases"]
    assert counts == {"total": 6, "done": 2, "failed": 2, "refused": 2, "missing": 0}
    assert document["computed_now"] == 4
    *diverged, refused = sorted(document["failures"], key=lambda failure: failure["status"])
    assert sorted(case for group in diverged for case in group["cases"]) == [2, 4]
    known = ("The passage stopped at", "the contact force cannot be filtered")
    assert all(group["reason"].startswith(known) for group in diverged), diverged
    reasons = {re.sub(r"t = [\d.]+ s", "", group["reason"]) for group in diverged}
    assert len(reasons) == len(diverged)
    assert refused["cases"] == [5, 6]
    assert "wave speed" in refused["reason"]
    assert "mesh: elements of up to" in outcome.stderr
    assert "of 4 cases" in outcome.stderr
    assert [axis["name"] for axis in document["axes"]] == ["speed", "m"]
    assert len(document["rows"]) == 6


def test_numbers_are_those_of_a_run(
    finished: tuple[Path, subprocess.CompletedProcess[str]],
) -> None:
    """A row holds exactly what ``run`` and ``contact_statistics`` give for its case."""
    row = json.loads(finished[1].stdout)["rows"][2]
    case = load_case("ac-simple", {**SMALL, "scenario.speed": "300 km/h"})
    expected = contact_statistics(run_case(case)).pantograph()
    for kind, part in expected.filtered.items():
        assert row[f"front.{kind}.std_0_20 [N]"] == pytest.approx(
            part.standard_deviations["0_20"], rel=1e-9
        )
        assert row[f"front.{kind}.maximum [N]"] == pytest.approx(part.maximum, rel=1e-9)
    assert row["front.uplift_force [N]"] == 150.0
    assert row["advised_cutoff [Hz]"] == pytest.approx(75.0)


def test_files(finished: tuple[Path, subprocess.CompletedProcess[str]]) -> None:
    """Table, arrays, document, report and the kept runs are in the folder."""
    folder = finished[0] / "tautwire-study-short"
    written = json.loads(finished[1].stdout)["files"]
    assert set(written) == {"table.csv", "table.nc", "study.json", "study.html"}
    assert len((folder / "table.csv").read_text().splitlines()) == 7
    page = (folder / "study.html").read_text(encoding="utf-8")
    assert "A short study" in page
    assert "<dd>Valley Railway</dd>" in page
    row = json.loads(finished[1].stdout)["rows"][0]
    run = load_run(folder / "runs" / f"{row['key']}.nc")
    assert run.case.scenario.speed == pytest.approx(250 / 3.6)
    assert len(list((folder / "runs").glob("*.nc"))) == 2


def test_resume_and_refusal(finished: tuple[Path, subprocess.CompletedProcess[str]]) -> None:
    """Again without --resume is refused (2); with it nothing is computed and numbers stay."""
    folder, before = finished
    again = tautwire(folder, "study", "study.json")
    assert again.returncode == 2
    assert "add --resume" in again.stderr
    resumed = tautwire(folder, "study", "study.json", "--resume", "--json")
    assert resumed.returncode == 0
    document = json.loads(resumed.stdout)
    assert (document["computed_now"], document["kept_from_before"]) == (0, 4)
    assert document["rows"] == json.loads(before.stdout)["rows"]


def test_text_for_people(finished: tuple[Path, subprocess.CompletedProcess[str]]) -> None:
    """On a terminal of 80 columns the summary shows counts, reasons and the cases."""
    shown = tautwire(finished[0], "study", "study.json", "--resume")
    assert shown.returncode == 0
    for part in ("2 done, 2 failed, 2 refused", "wave speed", "table.csv", "study.html"):
        assert part in shown.stdout
    assert max(map(len, shown.stdout.splitlines())) <= 80


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"axes": {"scenario.sped": [1], "line.spans": ["x"]}}, ["did you mean 'speed'"]),
        ({"base": "ac-simpel"}, ["did you mean 'ac-simple'"]),
        ({"design": "x", "name": ""}, ["design: got 'x'", "name: "]),
        ({"axes": {"scenario.speed": ["700 km/h"]}}, ["none of the 1 cases is valid"]),
    ],
)
def test_study_file_with_errors(tmp_path: Path, changes: dict[str, Any], words: list[str]) -> None:
    """A study file with errors is refused with all of them; exit code 2 and no folder."""
    write(tmp_path, {**STUDY, **changes})
    outcome = tautwire(tmp_path, "study", "study.json")
    assert outcome.returncode == 2
    for part in words:
        assert part in outcome.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["study.json"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--workers", "0"], "--workers: got 0"),
        (["--workers", "2", "--cluster", "tcp://127.0.0.1:1"], "exclude each other"),
        (["--out", "study.json"], "is a file, a folder is needed"),
    ],
)
def test_wrong_options(tmp_path: Path, arguments: list[str], words: str) -> None:
    """Options that make no sense are refused with exit code 2."""
    write(tmp_path, STUDY)
    outcome = tautwire(tmp_path, "study", "study.json", *arguments)
    assert outcome.returncode == 2
    assert words in outcome.stderr


def test_every_case_fails(tmp_path: Path) -> None:
    """When every case fails the command ends with 1 and the grouped reasons; files are written."""
    axes = {"settings.contact_stiffness": [1e9, 9e8]}
    overrides = {**SMALL, "settings.time_step": "50 ms"}
    write(tmp_path, {**STUDY, "axes": axes, "overrides": overrides})
    outcome = tautwire(tmp_path, "study", "study.json", "--workers", "1", "--json")
    assert outcome.returncode == 1
    assert "every case failed" in outcome.stderr
    document = json.loads(outcome.stdout)
    assert document["error"]["kind"] == "computation"
    assert document["failures"][0]["cases"] == [1, 2]


@pytest.mark.slow
@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_interruption_keeps_what_is_finished(tmp_path: Path, number: int, code: int) -> None:
    """A signal stops the study with 130 or 143, table written; --resume computes the rest."""
    axes = {"settings.seed": {"seeds": 30}}
    write(tmp_path, {**STUDY, "axes": axes, "keep_runs": False})
    process = subprocess.Popen(
        [sys.executable, "-m", "tautwire", "study", "study.json", "--workers", "2", "--json"],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ},
    )
    rows = tmp_path / "tautwire-study-short" / "rows"
    while len(list(rows.glob("??/*.json"))) < 3:
        assert process.poll() is None
        time.sleep(0.02)
    process.send_signal(number)
    out, _ = process.communicate(timeout=60)
    assert process.returncode == code
    first = json.loads(out)
    assert first["cases"]["done"] >= 3
    assert first["cases"]["missing"] > 0
    assert set(first["files"]) >= {"table.csv", "study.html"}
    resumed = tautwire(tmp_path, "study", "study.json", "--resume", "--json")
    second = json.loads(resumed.stdout)
    assert second["cases"]["done"] == 30
    assert second["computed_now"] == 30 - first["cases"]["done"]
    same = [row["front.sharp.mean [N]"] for row in second["rows"]]
    assert np.ptp(same) == 0.0
