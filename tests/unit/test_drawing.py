"""Figures as plain data say what the package plotly would."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import Any

import numpy as np
import plotly.graph_objects as go
import pytest
from plotly.subplots import make_subplots

from tautwire.report.drawing import Drawing, panels

LAYOUT = {"height": 300, "xaxis": {"title": {"text": "x"}}, "hovermode": None}


def plain(figure: go.Figure) -> dict[str, Any]:
    """Return the content of a figure of plotly, without its template."""
    content = json.loads(str(figure.to_json()))
    content["layout"].pop("template", None)
    return content


def test_traces_and_layout_are_those_of_plotly() -> None:
    """Arrays of every type, gaps, lines over the height and settings changed key by key."""
    ours, theirs = Drawing(LAYOUT), go.Figure(layout=LAYOUT)
    curves: list[dict[str, Any]] = [
        {"x": np.arange(3), "y": np.array([1.0, np.nan, 2.0])},
        {"x": np.array([0, 70_000]), "y": np.arange(2, dtype=np.float32)},
        {"x": [0.5, float("nan")], "y": [None, 2], "customdata": np.ones((2, 3))},
    ]
    for figure in (ours, theirs):
        for curve in curves:
            figure.add_scatter(**curve, mode="lines")
        figure.add_bar(x=["a", "b"], y=[1, 2], marker={"color": "#123456"})
        figure.add_vline(x=0.5, line={"width": 1})
        figure.add_vrect(x0=0.0, x1=1.0, line={"width": 0}, layer="below")
        figure.add_annotation(x=0.5, y=1, text="here")
        figure.update_layout({"xaxis": {"range": [0, 1]}}, yaxis={"tickvals": np.array([1.5])})
    assert json.loads(ours.to_json()) == plain(theirs)
    assert plain(ours.to_figure()) == plain(theirs)


@pytest.mark.parametrize(("rows", "columns"), [(2, 1), (2, 2)])
def test_panels_stand_where_plotly_puts_them(rows: int, columns: int) -> None:
    """Places of the axes, what they share, titles, and the panel that a curve goes to."""
    titles = [f"panel {number}" for number in range(rows * columns)]
    ours = panels([2.0, 1.0], columns=columns, gap=0.1, gap_across=0.05, titles=titles)
    theirs = make_subplots(
        rows=rows,
        cols=columns,
        row_heights=[2.0, 1.0],
        vertical_spacing=0.1,
        horizontal_spacing=0.05,
        shared_xaxes=columns == 1,
        subplot_titles=titles,
    )
    theirs.update_annotations(font=None)
    for figure in (ours, theirs):
        figure.add_scatter(x=[0, 1], y=[1, 2], row=2, col=columns)
        figure.update_xaxes(showticklabels=True, row=1)
        figure.update_yaxes({"title": {"text": "y"}}, row=2, col=1)
    expected = plain(theirs)
    drawn = json.loads(ours.to_json())
    for note in expected["layout"]["annotations"]:
        note.pop("font", None)
    assert drawn["data"] == expected["data"]
    assert drawn["layout"]["annotations"] == [
        {**note, "x": pytest.approx(note["x"]), "y": pytest.approx(note["y"])}
        for note in expected["layout"].pop("annotations")
    ]
    for name, axis in expected["layout"].items():
        assert drawn["layout"][name].pop("domain") == pytest.approx(axis.pop("domain"))
        assert drawn["layout"][name] == axis


def test_a_wrong_key_is_found_by_plotly() -> None:
    """What plotly.js does not know is refused when a figure is made for a notebook."""
    figure = Drawing()
    figure.add_scatter(x=[0], y=[0], colour="red")
    with pytest.raises(ValueError, match="colour"):
        figure.to_figure()


def test_drawing_needs_no_plotly() -> None:
    """The figures of a report are made without the package plotly."""
    code = (
        "import sys; from tautwire.report.drawing import panels;"
        "figure = panels([1.0], gap=0.1); figure.add_scatter(x=[0], y=[1]); figure.to_json();"
        "print('plotly' in sys.modules)"
    )
    answer = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert answer.stdout.strip() == "False"
