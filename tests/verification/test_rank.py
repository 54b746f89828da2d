"""Ranked corrections: superposed differences against full passages, and going on after a stop."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tautwire.analyses.survey.as_built import with_values
from tautwire.analyses.survey.rank import rank
from tautwire.analyses.survey.surveyed_line import SurveyedLine
from tautwire.errors import InputError
from tautwire.model.build import build
from tautwire.specs.case import Case

from ..lines import AC_SIMPLE


def design(spans: int = 5) -> Case:
    """Return a line at 160 km/h on a coarse mesh."""
    settings = {**AC_SIMPLE["settings"], "nodes_between_droppers": 2, "section": [2, spans - 1]}
    data = {**AC_SIMPLE, "line": {"spans": spans, "span_length": 55.0}, "settings": settings}
    data["scenario"] = {"speed": 160.0 / 3.6, "uplift_force": 110.0}
    return Case.model_validate(data)


def wrong(case: Case, changes: dict[int, float]) -> Case:
    """Return a case with some unknowns changed."""
    line = SurveyedLine(build(case))
    values = line.design.values.copy()
    for row, change in changes.items():
        values[row] += change
    return with_values(case, line, values)


def test_the_culprit_comes_first_and_its_gain_is_that_of_a_full_passage(tmp_path: Path) -> None:
    """A dropper 20 mm too short comes before one of 4 mm two spans on; what both gain together is
    that of the corrected line within 0.05 N; a ranking goes on from the passages that are kept."""
    case = design()
    built = wrong(case, {13: -0.020, 31: 0.004})
    ranking = rank(case, built, keep=tmp_path / "passages")
    first, second = ranking.ranked
    assert (first.correction.span, first.correction.number) == (2, 5)
    assert abs(first.correction.change - 0.020) < 1e-4
    assert (second.correction.span, second.correction.number) == (4, 5)
    assert ranking.built.standard_deviation > ranking.checked.standard_deviation + 0.2
    missed = second.together.standard_deviation - ranking.checked.standard_deviation
    assert abs(missed) < 0.05
    assert ranking.cpu > 0.0
    again = rank(case, built, keep=tmp_path / "passages")
    assert again.cpu == 0.0
    assert again.ranked == ranking.ranked


def test_what_cannot_be_ranked_is_refused() -> None:
    """A line as designed has nothing to correct; another line is not the same one as built."""
    case = design(3)
    with pytest.raises(InputError, match="nothing deviates"):
        rank(case, wrong(case, {3: 0.001}))
    with pytest.raises(InputError, match="other spans or dropper places"):
        rank(case, design(4))


@pytest.mark.slow
def test_a_planted_culprit_is_among_the_first_three() -> None:
    """Among scatter of 3 mm a dropper of 20 mm, a slack one and a support of 30 mm are found, and
    the first ten gain what a full passage says within 15 % or 0.3 N."""
    random, case = np.random.default_rng(3), design(6)
    line = SurveyedLine(build(case))
    culprits = {22: -0.020, 30: 0.040, line.droppers + 2: 0.030}
    for row, change in culprits.items():
        scatter = dict(enumerate(random.normal(0.0, 0.003, line.count).tolist()))
        ranking = rank(case, wrong(case, {**scatter, row: change}))
        assert row in [one.correction.row for one in ranking.ranked[:3]]
        last = ranking.ranked[min(10, len(ranking.ranked)) - 1].together
        gain = ranking.built.standard_deviation - ranking.checked.standard_deviation
        missed = last.standard_deviation - ranking.checked.standard_deviation
        assert abs(missed) < max(0.3, 0.15 * gain)
