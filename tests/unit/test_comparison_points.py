"""Elasticity and uplift measured at places, beside a run."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tautwire as tw
from tautwire.analyses.force.section import analysed_section
from tautwire.analyses.force.statistics import contact_statistics, passed_uplift
from tautwire.assessment.comparison.points import compare_points
from tautwire.errors import InputError
from tautwire.inputs.reading.survey import load_survey
from tautwire.measured.survey import Reading, Survey
from tautwire.report.figures.line_figures import uplift_figure
from tautwire.report.pages.comparison_page import compose_comparison
from tautwire.report.parts.views import prepare
from tautwire.results.run import Run

from .synthetic import make_case, make_elasticity, make_run


def uplifts(*values: tuple[int, float]) -> Survey:
    """Return a survey of uplifts [m] at supports."""
    readings = [
        Reading("uplift", value, np.nan, support=support, where=f"places.csv, row {row}")
        for row, (support, value) in enumerate(values, 2)
    ]
    return Survey("places.csv", tuple(readings))


def stopped() -> Run:
    """Return a passage over 17 spans of 55 m that stopped 361 m from support 1."""
    return make_run(status="partial", duration=4.0)


def test_supports_that_no_pantograph_reached_have_no_uplift(tmp_path: Path) -> None:
    """Of a run that stopped behind support 7, and began behind support 1, the uplifts at supports
    2 to 7 are compared; the others are named with the reason, as is the state of the run."""
    run = stopped()
    found = passed_uplift(run, analysed_section(run, (1, 17)))
    assert np.flatnonzero(np.isfinite(found.uplift)).tolist() == list(range(1, 7))
    survey = uplifts((1, 0.03), (2, 0.03), (7, 0.04), (8, 0.05), (12, 0.05))
    compared = compare_points(run, survey, elasticity=None, uplift=found.uplift)
    assert [row.place for row in compared.rows] == ["support 2", "support 7"]
    (unreached, state) = compared.notes
    assert "no pantograph reached the support of 3 of the uplifts" in unreached
    assert "support 1; support 8; support 12" in unreached
    assert "section" not in unreached
    assert "the run is not complete (partial, interrupted at 320 m; start it again)" in state
    page = compose_comparison([], [], None, [(run, compared)])
    assert "not complete" in page.write(tmp_path / "page.html").read_text(encoding="utf-8")


def test_a_complete_run_is_not_said_to_be_incomplete() -> None:
    """Nothing is left out, and nothing told, where all supports were passed."""
    run = make_run()
    uplift = passed_uplift(run, analysed_section(run, (1, 17))).uplift
    compared = compare_points(run, uplifts((5, 0.03)), elasticity=None, uplift=uplift)
    assert compared.notes == ()
    assert len(compared.rows) == 1


def test_statistics_and_figure_know_no_uplift_of_supports_not_reached() -> None:
    """A wave ahead of a pantograph that stopped is no uplift of the support that it reached, in
    the statistics as in the figure."""
    run = stopped()
    history = run.support_uplift.copy()
    history[-1, 9] = 0.5
    run = replace(run, support_uplift=history)
    found = contact_statistics(run, section=(4, 13)).uplift
    assert found.supports[np.isfinite(found.uplift)].tolist() == [4, 5, 6, 7]
    assert found.maximum < 0.5
    bars = uplift_figure([prepare(run, "a")]).to_figure().data[0].y
    assert np.flatnonzero(np.isfinite(np.array(bars, dtype=float))).tolist() == list(range(1, 7))


def test_elasticity_outside_the_analysed_section_is_said_to_be() -> None:
    """A place without computed elasticity is left out with the section and its setting."""
    run = make_run()
    survey = Survey("places.csv", (Reading("elasticity", 2e-4, np.nan, support=1, where="row 2"),))
    curve = make_elasticity(run.case)
    compared = compare_points(run, survey, elasticity=curve, uplift=np.full(18, np.nan))
    (note,) = compared.notes
    assert "outside the analysed section (spans 4 to 13, settings.section)" in note
    assert "support 1" in note


def test_negative_uplifts_are_told() -> None:
    """An uplift below zero is compared, and its row named for a look at its sign."""
    run = make_run()
    uplift = passed_uplift(run, analysed_section(run, (1, 17))).uplift
    survey = uplifts((5, -0.03), (6, 0.03))
    compared = compare_points(run, survey, elasticity=None, uplift=uplift)
    (note,) = compared.notes
    assert "1 of the uplifts are negative" in note
    assert "places.csv, row 2" in note
    assert len(compared.rows) == 2


def test_elasticity_that_no_wire_has_is_refused_by_cell(tmp_path: Path) -> None:
    """Zero and negative elasticities are refused row by row, together with other wrong cells of
    the row; an uplift below zero is read."""
    path = tmp_path / "places.csv"
    path.write_text(
        "Support,Elasticity [mm/N],Uplift [m]\n2,0,0.03\n3,-0.3,30\n4,0.3,0.03\n5,,-0.02\n"
    )
    with pytest.raises(InputError) as refused:
        load_survey(path, make_case())
    first, second = refused.value.problems
    assert "row 2: elasticity of 0 mm/N" in first
    assert "row 3: elasticity of -0.3 mm/N" in second
    assert "uplift of 30 m" in second


@pytest.fixture(scope="module", params=["dc-twin", "compound", "ac-simple-overlap"])
def several(request: pytest.FixtureRequest) -> tuple[Run, dict[str, Any]]:
    """A line on which droppers share span and number, and what tells two of them apart."""
    choices = {
        "dc-twin": {"span": 2, "by": "wire", "names": ("contact", "contact-2")},
        "compound": {"span": 2, "by": "wire", "names": ("contact", "auxiliary")},
        "ac-simple-overlap": {"span": 10, "by": "tension_length", "names": ("T1", "T2")},
    }
    case = tw.load_case(request.param)
    shape = tw.find_shape(tw.build(case))
    return replace(make_run(), case=case, equilibrium=shape), choices[request.param]


def _at_droppers(*rows: dict[str, Any]) -> Survey:
    readings = [
        Reading("elasticity", 3e-4, np.nan, dropper=1, where=f"row {number}", **row)
        for number, row in enumerate(rows, 2)
    ]
    return Survey("places.csv", tuple(readings))


def test_droppers_of_one_number_are_told_apart_by_wire_and_tension_length(
    several: tuple[Run, dict[str, Any]],
) -> None:
    """The column of the lower wire or tension length picks the dropper, whose place and name are
    told; without it all rows are refused at once with those that there are."""
    run, choice = several
    shape, span, by, names = run.equilibrium, choice["span"], choice["by"], choice["names"]
    flat = replace(
        make_elasticity(make_case()), x=np.array([-1e4, 1e4]), elasticity=np.array([0.0, 2e4])
    )  # an elasticity that tells the place
    none = np.full(len(shape.mast_x), np.nan)
    survey = _at_droppers(*({"span": span, by: name} for name in names))
    compared = compare_points(run, survey, elasticity=flat, uplift=none)
    alike = (shape.dropper_span == span) & (shape.dropper_number == 1)
    assert sorted(row.x for row in compared.rows) == sorted(shape.dropper_x[alike].tolist())
    places = [row.place for row in compared.rows]
    assert all(any(repr(name) in place for place in places) for name in names)
    doubtful = _at_droppers({"span": span}, {"span": span}, {"span": span, by: names[0]})
    with pytest.raises(InputError) as refused:
        compare_points(run, doubtful, elasticity=flat, uplift=none)
    assert len(refused.value.problems) == 2
    for text in (f"dropper 1 of span {span}, which may be any of 2", *names, "'Lower wire'"):
        assert text in refused.value.problems[0]
    wrong = _at_droppers({"span": span, "wire": "rope"})
    with pytest.raises(InputError, match="the lower wire 'rope'; those that the line has"):
        compare_points(run, wrong, elasticity=flat, uplift=none)


def test_columns_of_wire_and_tension_length_are_read(tmp_path: Path) -> None:
    """Headings as in the table of droppers that the program writes, and in words."""
    path = tmp_path / "places.csv"
    for heads in ("to,tension length", "Lower wire,Tension section"):
        path.write_text(
            f"Span,Dropper,{heads},Elasticity [mm/N]\n2,1,contact-2,T2,0.3\n2,2,,,0.3\n"
        )
        survey = load_survey(path, make_case())
        one, other = survey.readings
        assert (one.wire, one.tension_length) == ("contact-2", "T2")
        assert (other.wire, other.tension_length) == (None, None)
        assert survey.notes == ()
