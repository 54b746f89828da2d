"""Results in a notebook: what they tell in a line and as a table, their figures and tables."""

from __future__ import annotations

import json

import numpy as np
import plotly.graph_objects as go
import pytest

import tautwire as tw
from tautwire.report.pages.notebook import RunPlots
from tautwire.text import Told

from .synthetic import make_case, make_elasticity, make_equilibrium, make_run

CASE = make_case(pantographs=2)


@pytest.fixture(scope="module")
def run() -> tw.Run:
    """Return a made-up run of two pantographs."""
    return make_run(CASE)


def test_every_object_tells_what_matters_in_one_line(run: tw.Run) -> None:
    """Names and figures, never arrays; nothing in a text acts on terminal or page."""
    every: list[tuple[Told, str]] = [
        (CASE, "synthetic"),
        (make_equilibrium(CASE), "droppers 153"),
        (make_elasticity(CASE), "non-uniformity"),
        (run, "synthetic at"),
        (tw.contact_statistics(run), "sigma"),
    ]
    for thing, word in every:
        text = repr(thing)
        assert text.startswith(f"<{type(thing).__name__}: ")
        assert word in text
        assert len(text) < 600
        assert "\n" not in text
        assert "<table>" in thing._repr_html_()


def test_texts_of_a_case_stay_texts() -> None:
    """A title with HTML or an escape sequence is shown, not obeyed."""
    case = make_case(title="<b>fast</b>")
    assert "&lt;b&gt;" in case._repr_html_()
    assert "<b>" not in case._repr_html_()


@pytest.mark.parametrize(
    "name", ["force", "spectrum", "histogram", "spans", "line", "uplift", "uplift_history",
             "height", "droppers"],
)  # fmt: skip
def test_figures_of_a_run(run: tw.Run, name: str) -> None:
    """Every figure of the report is at hand and complete enough to be drawn."""
    figure = getattr(run.plot, name)()
    assert isinstance(figure, go.Figure)
    drawn = json.loads(str(figure.to_json()))
    assert drawn["data"]
    assert drawn["layout"]["xaxis"]["title"]


def test_animation_is_a_page_in_a_frame(run: tw.Run) -> None:
    """The page is quoted whole inside the frame, so that a notebook shows nothing else of it."""
    film = run.plot.animation()
    shown = film._repr_html_()
    assert shown.startswith("<iframe")
    assert shown.count("<") == 2
    assert len(repr(film)) < 100


def test_figures_are_found_by_tab(run: tw.Run) -> None:
    """What a notebook offers after ``run.plot.`` are the figures."""
    assert isinstance(run.plot, RunPlots)
    offered = {name for name in dir(run.plot) if not name.startswith("_")}
    assert {"force", "line", "spectrum", "uplift", "animation"} <= offered


def test_histories_as_tables(run: tw.Run) -> None:
    """Same numbers in both; before a pantograph enters there are none in the table."""
    data, table = run.to_xarray(), run.to_pandas()
    first = run.pantographs[0]
    assert data.contact_force.units == "N"
    assert np.array_equal(data.contact_force.sel(pantograph=first.name), first.contact_force)
    assert data.dropper_force.sizes["dropper"] == run.equilibrium.dropper_x.size
    column = table[first.name, "contact_force [N]"].to_numpy()
    assert np.array_equal(column[first.active], first.contact_force[first.active])
    assert np.isnan(column[~first.active]).all()


def test_the_figure_of_losses_needs_a_loss(run: tw.Run) -> None:
    """It is drawn where contact is lost, and refused in words where it never is."""
    drawn = json.loads(str(make_run(CASE, losses=True).plot.losses().to_json()))
    assert drawn["data"]
    with pytest.raises(tw.InputError, match="no contact is lost"):
        run.plot.losses()


def test_progress_bar_changes_nothing() -> None:
    """A run with a bar is the run without."""
    short = {"line.spans": 4, "scenario.uplift_force": "150 N",
             "settings.nodes_between_droppers": 3}  # fmt: skip
    plain, shown = (tw.run("ac-simple", overrides=short, progress=p) for p in (False, True))
    assert np.array_equal(plain.pantographs[0].contact_force, shown.pantographs[0].contact_force)
