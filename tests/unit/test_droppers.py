"""Forces of droppers are kept while pantographs are near; elsewhere their extremes are."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from tautwire.analyses.force.statistics import contact_statistics
from tautwire.analyses.road import recorder
from tautwire.analyses.road.dynamics import Progress, simulate
from tautwire.analyses.road.shape import find_shape
from tautwire.inputs.load import load_case
from tautwire.model.build import Model, build
from tautwire.results.droppers import DropperHistory
from tautwire.results.equilibrium import Equilibrium
from tautwire.results.run import Run
from tautwire.results.storage.reading import load_run
from tautwire.results.storage.writing import save_run

NEAR = 60.0
REAR = {"line.spans": 6, "pantographs[2].behind": 40, "settings.nodes_between_droppers": 4}


@cache
def line() -> tuple[Model, Equilibrium]:
    """Return six spans of AC simple under two pantographs, 40 m apart."""
    fields = {"scenario.mean_force": None, "scenario.uplift_force": 250}
    model = build(load_case("ac-simple-two-pantographs", {**REAR, **fields}))
    return model, find_shape(model)


@pytest.fixture(scope="module")
def whole() -> Run:
    """Return a passage with all forces."""
    return simulate(*line())


@pytest.fixture
def near(monkeypatch: pytest.MonkeyPatch) -> Run:
    """Return the same passage with the forces within 60 m of the pantographs."""
    monkeypatch.setattr(recorder, "NEAR", NEAR)
    return simulate(*line())


def test_all_forces_of_a_short_line_are_kept(whole: Run) -> None:
    """On a line shorter than a kilometre nothing is left out."""
    history = whole.droppers
    assert history.force.shape == (whole.time.size, whole.equilibrium.dropper_x.size)
    assert not history.first.any()
    assert not np.isnan(history.force).any()
    assert np.isnan(history.least).all()


def test_forces_near_the_pantographs_are_kept(whole: Run, near: Run) -> None:
    """Samples with a pantograph within 60 m are those of the whole history, and there are fewer."""
    place = near.equilibrium.dropper_x
    heads = np.array([record.position for record in near.pantographs])
    is_near = (np.abs(heads[:, :, None] - place) <= NEAR).any(axis=0)
    kept = near.dropper_force
    assert np.array_equal(kept[is_near], whole.dropper_force[is_near])
    assert not np.isnan(kept[is_near]).any()
    assert near.droppers.force.size < 0.7 * whole.droppers.force.size


def test_statistics_of_droppers_do_not_depend_on_what_is_kept(whole: Run, near: Run) -> None:
    """Extremes and slack times in the analysed section are those of the whole history."""
    ours, all_of_them = (contact_statistics(run).droppers for run in (near, whole))
    assert np.array_equal(ours.minimum, all_of_them.minimum)
    assert np.array_equal(ours.maximum, all_of_them.maximum)
    assert ours.slack_time == pytest.approx(all_of_them.slack_time, abs=1e-12)
    assert all_of_them.slack_time.max() > 0.01
    assert near.droppers.slack_time.max() > 0.0


def test_what_is_kept_survives_the_file(near: Run, tmp_path: Path) -> None:
    """A file gives back windows, first samples and extremes."""
    save_run(near, tmp_path / "run.nc")
    read = load_run(tmp_path / "run.nc").droppers
    for name in ("force", "first", "least", "largest", "slack_time"):
        ours, theirs = getattr(read, name), getattr(near.droppers, name)
        assert np.array_equal(ours, theirs, equal_nan=True)


def test_stopped_passage(monkeypatch: pytest.MonkeyPatch) -> None:
    """Forces after the end of a stopped passage are not numbers; statistics are empty there."""
    monkeypatch.setattr(recorder, "NEAR", NEAR)

    def stop(progress: Progress) -> bool:
        return progress.time > 1.0

    run = simulate(*line(), watch=stop)
    force = run.dropper_force
    assert force.shape[0] == run.time.size < 1100
    assert np.isfinite(force[-1]).any()
    assert np.isnan(force[-1]).any()
    assert np.isfinite(contact_statistics(run).droppers.minimum).all()


def test_history_of_every_sample_cut() -> None:
    """A whole history that is cut is the whole history of fewer samples."""
    force = np.arange(12.0).reshape(4, 3)
    cut = DropperHistory.of_every_sample(force).until(2)
    assert np.array_equal(cut.at(np.arange(2)), force[:2])
    assert cut.force.shape == (2, 3)
