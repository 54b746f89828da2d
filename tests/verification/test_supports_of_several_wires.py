"""Supports that hold several contact wires are counted once: twin wires, overlaps."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import tautwire as tw
from tautwire.analyses.force.contact_loss import nearest_place
from tautwire.report.figures.line_figures import line_figure
from tautwire.report.pages.run_page import write_report
from tautwire.report.parts.views import prepare

COARSE = {
    "scenario.speed": "150 km/h",
    "scenario.uplift_force": "120 N",
    "settings.nodes_between_droppers": 3,
}
"""A passage that is about places, not about forces."""


@pytest.fixture(scope="module", params=["dc-twin", "ac-simple-overlap"])
def run(request: pytest.FixtureRequest) -> tw.Run:
    """Return a passage of a line some of whose supports hold two contact wires."""
    model = tw.build(tw.load_case(request.param, COARSE))
    return tw.simulate(model, tw.find_shape(model))


def test_section_and_spans_are_those_of_the_track(run: tw.Run) -> None:
    """Limits of section and spans are the supports of the case, by number."""
    places = run.case.line.support_positions()
    statistics = tw.contact_statistics(run)
    first, last = run.case.resolved_section()
    assert run.equilibrium.support_x.size > len(places)
    assert run.equilibrium.mast_x == pytest.approx(places)
    assert statistics.section.start == pytest.approx(places[first - 1])
    assert statistics.section.end == pytest.approx(places[last])
    spans = statistics.pantograph().sharp.per_span
    assert [part.end for part in spans] == pytest.approx(list(places[first : last + 1]))


def test_uplift_of_a_support_is_that_of_its_highest_wire(run: tw.Run) -> None:
    """One number per support of the section, the largest of the wires that it holds."""
    uplift = tw.contact_statistics(run).uplift
    first, last = run.case.resolved_section()
    assert uplift.supports.tolist() == list(range(first, last + 2))
    numbers = run.equilibrium.support_number
    for support, found in zip(uplift.supports, uplift.uplift, strict=True):
        assert found <= run.support_uplift[:, numbers == support].max() + 1e-9
        assert found > 0.0


def test_places_are_named_by_the_number_of_the_support(run: tw.Run) -> None:
    """The last support is named by its own number, not by its row among the held wires."""
    places = run.case.line.support_positions()
    assert nearest_place(run.equilibrium, places[-1]) == f"support {len(places)}"


def test_report_and_file_count_supports_once(run: tw.Run, tmp_path: Path) -> None:
    """Ticks of figures carry numbers of supports; the file keeps the number of every held wire."""
    figure = run.plot.line().to_plotly_json()
    assert figure["layout"]["xaxis3"]["ticktext"][-1].startswith(f"{run.case.line.spans + 1}<br>")
    tw.save_run(run, tmp_path / "run.nc")
    again = tw.load_run(tmp_path / "run.nc")
    assert np.array_equal(again.equilibrium.support_number, run.equilibrium.support_number)
    assert again.to_xarray().sizes["support"] == run.equilibrium.support_x.size
    assert write_report(run, tmp_path / "report.html").stat().st_size > 1e6


def test_every_wire_is_drawn(run: tw.Run) -> None:
    """The figure of the line has every wire in side view and plan, and the sag of contact wires."""
    view = prepare(run, "line")
    figure = line_figure(view.run.case, view.run.equilibrium, 1).to_figure()
    drawn = [trace.name for trace in figure.data]
    for name, role in zip(run.equilibrium.wire_names, run.equilibrium.wire_roles, strict=True):
        assert drawn.count(name) == (3 if role == "contact" else 2)


def test_stagger_is_that_of_the_lowest_wire(run: tw.Run) -> None:
    """Where a head runs, the stagger is that of the wire it touches first."""
    shape = run.equilibrium
    s = np.linspace(shape.mast_x[1], shape.mast_x[-2], 200)
    low = shape.running_height(s)
    sides = shape.running_stagger(s)
    for wire in shape.of_role("contact"):
        x, y, z = wire.position.T
        lowest = np.interp(s, x, z, left=np.inf, right=np.inf) == low
        assert sides[lowest] == pytest.approx(np.interp(s[lowest], x, y))
