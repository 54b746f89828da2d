"""What a passage did that its model cannot describe is named."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from tautwire.analyses.road.validity import judged, outside_the_model
from tautwire.results.run import Run
from tautwire.studies.execution.task import Job, perform

from .synthetic import make_case, make_run


def changed(run: Run, **histories: Any) -> Run:
    """Return a run whose first pantograph has other histories."""
    first = dataclasses.replace(run.pantographs[0], **histories)
    return dataclasses.replace(run, pantographs=(first, *run.pantographs[1:]))


@pytest.fixture
def run() -> Run:
    """A plausible run."""
    return make_run(make_case(spans=4), duration=0.5)


def test_plausible_run_is_not_blamed(run: Run) -> None:
    """Losses of contact and usual uplifts are inside the model; so is a run without a step."""
    assert outside_the_model(run) == ()
    assert outside_the_model(make_run(make_case(spans=4), losses=True)) == ()
    assert outside_the_model(make_run(make_case(spans=4), status="partial", duration=0.0)) == ()


def test_fallen_head_is_named_with_its_place(run: Run) -> None:
    """A head 14 m below the wire; before it has entered, or lowered, it may be there."""
    gap = run.pantographs[0].gap.copy()
    gap[100] = 14.0
    (text,) = outside_the_model(changed(run, gap=gap))
    assert "hangs 14.00 m below the wire at t = 0.100 s" in text
    assert outside_the_model(changed(run, gap=gap, uplift_force=0.0)) == ()
    absent = np.zeros(gap.size, dtype=bool)
    assert outside_the_model(changed(run, gap=gap, active=absent)) == ()
    gap[:] = np.nan
    assert outside_the_model(changed(run, gap=gap)) == ()


def test_pierced_wire_is_named(run: Run) -> None:
    """A penetration of decimetres is not the give of a collector strip."""
    gap = run.pantographs[0].gap.copy()
    gap[7] = -0.4
    (text,) = outside_the_model(changed(run, gap=gap))
    assert "stands 0.400 m above the wire" in text
    assert "settings.contact_stiffness" in text


def test_uplift_above_the_messenger_is_named(run: Run) -> None:
    """Above the messenger wire nothing is known, at a support or under the pantograph."""
    uplift = run.support_uplift.copy()
    uplift[30, 2] = 2.5
    (text,) = outside_the_model(dataclasses.replace(run, support_uplift=uplift))
    assert "rises by 2.50 m at support 3" in text
    height = run.pantographs[0].wire_height + 3.0
    (text,) = outside_the_model(changed(run, wire_height=height))
    assert "above the messenger wire at rest" in text


def test_tuning_below_its_tolerance_is_named(run: Run) -> None:
    """A mean force of 0.05 N, met to 0.1 N, says nothing; it is among the warnings of the run."""
    case = run.case.with_(**{"scenario.mean_force": 0.05})
    told = judged(dataclasses.replace(run, case=case)).warnings[-1]
    assert told.startswith("outside the model: the mean force of 0.05 N is met to 0.1 N")
    assert "200 %" in told


def test_rows_of_a_study_carry_the_warnings() -> None:
    """A case of a study whose head goes through the wire is done, and its row says so."""
    case = make_case(spans=3, settings={"contact_stiffness": 100.0, "time_step": 2e-3})
    row = perform(Job("key", case.to_dict())).row
    assert row["status"] == "done", row["reason"]
    assert "it has gone through it" in row["values"]["warnings"]
