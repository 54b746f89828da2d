"""Numerical errors: companions, widths, digits, and that they survive being stored."""

from __future__ import annotations

import functools
import math
from pathlib import Path

import numpy as np
import pytest

import tautwire as tw
from tautwire.analyses.force.statistics import contact_statistics
from tautwire.analyses.road.accuracy import (
    ADVISED,
    FACTOR,
    LEAST,
    coarser,
    figures,
    history_errors,
    with_accuracy,
)
from tautwire.analyses.road.dynamics import simulate
from tautwire.analyses.road.shape import find_shape
from tautwire.cli.views.documents import run_document
from tautwire.model.build import build
from tautwire.report.parts.words import with_error
from tautwire.results.accuracy import rounded
from tautwire.results.run import Run
from tautwire.specs.case import Case
from tautwire.specs.step_control import StepControl

from ..lines import HAS_CORE, ac_simple, found


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (52.378, 0.32, "52.4 ± 0.4"),
        (52.378, 0.12, "52.38 ± 0.12"),
        (52.378, 0.0001, "52.38 ± 0.01"),
        (52.378, 0.0, "52.38 ± 0.00"),
        (294.3, 12.0, "294 ± 12"),
        (294.3, 34.0, "290 ± 40"),
        (294.3, 0.3, "294.3 ± 0.3"),
        (-4.26, 0.5, "\N{MINUS SIGN}4.3 ± 0.5"),
        (52.378, math.nan, "52.38"),
        (math.nan, 0.1, "–"),
    ],
)
def test_no_digit_without_meaning(value: float, error: float, text: str) -> None:
    """The error is rounded up to its first digit, two behind a 1, and the value with it."""
    assert with_error(value, error, 2) == text


def test_numbers_for_programs_have_no_digit_without_meaning() -> None:
    """JSON holds the statistics that have an error bar to the digits that a person reads."""
    run = _passage()
    statistics = contact_statistics(run)
    own, accuracy = statistics.pantographs[0], run.accuracy
    assert accuracy is not None
    told = run_document(run, statistics, (), ())["pantographs"][0]["sharp"]
    keys = {"mean_n": "mean", "max_n": "maximum", "min_n": "minimum"}
    for key, name in keys.items():
        value = getattr(own.sharp, name)
        error = accuracy.of(own.name, "sharp", name)
        assert told[key] == rounded(value, error) != value
        assert (
            with_error(value, error, 9).split(" ")[0]
            == with_error(told[key], error, 9).split(" ")[0]
        )
    band = own.sharp.standard_deviations["0_20"]
    assert told["std_0_20_n"] == rounded(band, accuracy.of(own.name, "sharp", "0_20")) != band


@pytest.mark.skipif(not HAS_CORE, reason="a step of 0.125 ms takes minutes without the core")
def test_history_error_is_richardsons() -> None:
    """The error of the unfiltered force that two steps tell is within a tenth that against an
    eighth of the step, over the section; half the step leaves a quarter."""
    case = ac_simple(
        settings__nodes_between_droppers=6,
        settings__time_step=1e-3,
        settings__contact_stiffness=5e4,
        line__spans=4,
        settings__section=(2, 3),
    )

    def passed(factor: float, case: Case = case) -> Run:
        own = case.with_(**{"settings.time_step": factor * 1e-3})
        model = build(own)
        return simulate(model, find_shape(model), uplift_forces=[160.0])

    whole, half, exact = passed(1.0), passed(0.5), passed(0.125)
    told = dict(history_errors(whole, passed(math.sqrt(2.0))))["front/history"]
    again = dict(history_errors(half, passed(math.sqrt(0.5))))["front/history"]
    true = dict(history_errors(exact, whole))["front/history"]
    assert told == pytest.approx(true, rel=0.1)
    assert told / again == pytest.approx(4.0, rel=0.1)


def test_companions_are_coarser() -> None:
    """The step is sqrt(2), elements are 2 times as long; each alone too."""
    case = ac_simple(settings__nodes_between_droppers=15, settings__time_step=1e-3)
    settings = coarser(case).settings
    assert settings.step() == pytest.approx(1e-3 * math.sqrt(2.0))
    assert settings.nodes_between_droppers == 8
    assert coarser(case, mesh=False).settings.nodes_between_droppers == 15
    assert coarser(case, step=False).settings.step() == pytest.approx(1e-3)
    band = case.with_(**{"settings.nodes_between_droppers": None, "settings.band": 200.0})
    assert coarser(band).settings.band == pytest.approx(100.0)
    assert coarser(band, mesh=False).settings.band == pytest.approx(200.0)


@functools.cache
def _passage(nodes: int = 5, step: float = 1e-3, error: str = "estimate") -> Run:
    case = ac_simple(
        settings__nodes_between_droppers=nodes,
        settings__time_step=step,
        settings__contact_stiffness=5e4,
        settings__error=error,
    )
    return _run(case)


def _run(case: Case) -> Run:
    model, shape, _ = found(case)
    return with_accuracy(tw.simulate(model, shape))


def test_bars_contain_a_finer_passage() -> None:
    """On three spans every bar contains the figure with mesh and step halved twice, and no bar of
    the force is wider than a tenth of the standard deviation."""
    run, fine = _passage(), _passage(17, 0.25e-3, "none")
    assert fine.accuracy is None
    assert run.accuracy is not None
    exact = dict(figures(fine))
    assert f"front/butterworth/{ADVISED}" in exact
    for name, value in figures(run):
        width = run.accuracy.of(*name.split("/"))
        assert abs(value - exact[name]) <= width, name
    sharp = tw.contact_statistics(run).pantograph().sharp
    assert run.accuracy.of("front", "sharp", "0_20") <= 0.1 * sharp.standard_deviation


def test_width_is_the_change_of_the_companion() -> None:
    """The width of the mean is the factor times the change, on top of the least width."""
    run = _passage()
    assert run.accuracy is not None
    case = coarser(run.case).with_(**{"settings.error": "none"})
    own, other = (tw.contact_statistics(r).pantograph().sharp for r in (run, _run(case)))
    width = FACTOR * abs(own.mean - other.mean) + LEAST * own.standard_deviation
    assert run.accuracy.of("front", "sharp", "mean") == pytest.approx(width, rel=1e-9)
    assert math.isnan(run.accuracy.of("rear", "sharp", "mean"))


def test_errors_are_stored(tmp_path: Path) -> None:
    """A run that is read again has its errors, and one without has none."""
    run = _passage()
    path = tmp_path / "run.nc"
    tw.save_run(run, path)
    assert tw.load_run(path).accuracy == run.accuracy
    assert run.accuracy is not None
    assert run.accuracy.as_dict()["widths"]["front/sharp/0_20"] > 0.0


def test_waves_are_corrected_by_default() -> None:
    """Every step control corrects; a stored null is the word of a version that did not."""
    assert StepControl().corrects_waves
    assert StepControl(method="variable").corrects_waves
    stored = {"method": "constant", "corrects_waves": None}
    assert not StepControl.model_validate(stored).corrects_waves
    assert StepControl.model_validate({**stored, "method": "adaptive"}).corrects_waves
    assert "wave speed corrected" in _passage().counters["step_control"]


def test_correction_takes_error_away() -> None:
    """Beside 0.1 ms the force of 1 ms is at least 1.5 times closer with the wave correction."""
    case = ac_simple(settings__nodes_between_droppers=9, settings__contact_stiffness=5e4)
    model, shape, _ = found(case)
    fine = tw.simulate(model, shape, stepping=tw.ConstantStep(1e-4)).contact_force("front")
    errors = []
    for corrects in (False, True):
        stepping = tw.ConstantStep(1e-3, corrects_waves=corrects)
        force = tw.simulate(model, shape, stepping=stepping).contact_force("front")
        there = np.searchsorted(fine.time, force.time - 0.5e-4)
        within = there < len(fine.time)
        errors.append(float(np.std(force.force[within] - fine.force[there[within]])))
    assert errors[1] < errors[0] / 1.5
