"""``losses``: what a stored run says about contact loss, and several runs against the last."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from tautwire.results.run import Run
from tautwire.results.storage import save_run

from ..unit.synthetic import make_case, make_run
from .conftest import Invoke


@pytest.fixture(scope="module")
def stored(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with a run of two losses, the same sampled more coarsely, and a slower one."""
    folder = tmp_path_factory.mktemp("losses")
    case = make_case(pantographs=2)
    save_run(make_run(case, losses=True), folder / "fine.nc")
    save_run(make_run(case, losses=True, time_step=2e-3), folder / "coarse.nc")
    slow = make_case(scenario={"speed": 70.0, "mean_force": 169.0})
    save_run(make_run(slow, losses=True), folder / "slow.nc")
    save_run(_without_losses(make_run(case)), folder / "calm.nc")
    return folder


def _without_losses(run: Run) -> Run:
    records = tuple(
        dataclasses.replace(record, gap=np.full_like(record.gap, -1e-3))
        for record in run.pantographs
    )
    return dataclasses.replace(run, pantographs=records)


def test_losses_of_one_run(invoke: Invoke, stored: Path) -> None:
    """The table has start, duration, position and place of every loss, count above 5 ms, share and
    classes, and says that no arc is modelled."""
    outcome = invoke("losses", stored / "fine.nc")
    assert outcome.code == 0
    text = " ".join(outcome.out.split())
    for word in ("start [s]", "duration [ms]", "5 ms or longer", "share of time", "surrogate"):
        assert word in text


def test_losses_as_json(invoke: Invoke, stored: Path) -> None:
    """With ``--json`` the same stands in one document; counted losses are whole steps."""
    (run,) = invoke("losses", stored / "fine.nc", "--json").document["runs"]
    (counted,) = invoke("losses", stored / "fine.nc", "--json", "--counted").document["runs"]
    assert run["pantograph"] == "front"
    assert run["count"] == len(run["events"]) > 0
    steps = np.array([event["duration_ms"] for event in counted["events"]])
    assert steps == pytest.approx(np.round(steps), abs=1e-6)


def test_runs_are_compared_with_the_last(invoke: Invoke, stored: Path) -> None:
    """Several runs are matched loss by loss with the last one."""
    files = (stored / "coarse.nc", stored / "fine.nc")
    outcome = invoke("losses", *files, "--pantograph", "rear")
    assert outcome.code == 0
    assert "against the last run" in outcome.out
    compared = invoke("losses", *files, "--json").document["comparison"]
    assert compared["reference"]["count"] > 0
    assert len(compared["runs"]) == 1
    assert len(compared["runs"][0]["durations_ms"]) == compared["reference"]["count"]


def test_runs_without_losses(invoke: Invoke, stored: Path) -> None:
    """A run that never loses contact is compared as well; errors that do not exist are null."""
    outcome = invoke("losses", stored / "calm.nc", stored / "calm.nc", "--json")
    assert outcome.code == 0
    assert outcome.document["comparison"]["runs"][0]["median_error"] is None
    assert invoke("losses", stored / "calm.nc").code == 0


def test_other_passages_are_refused(invoke: Invoke, stored: Path) -> None:
    """Runs at different speeds cannot be matched in time; an unknown pantograph is named."""
    outcome = invoke("losses", stored / "slow.nc", stored / "fine.nc")
    assert outcome.code == 2
    assert "give runs of one passage" in outcome.err
    unknown = invoke("losses", stored / "fine.nc", "--pantograph", "middle")
    assert unknown.code == 2
    assert "there are: front, rear" in unknown.err
    missing = invoke("losses", "a.nc", "b.nc")
    assert missing.code == 2
    assert "2 problems" in missing.err
