"""The report as PDF: the content of the page, set without a browser."""

from __future__ import annotations

import importlib.util
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import plotly.graph_objects as go
import pytest

from tautwire.errors import InputError
from tautwire.report.drawing import Drawing
from tautwire.report.parts.blocks import (
    Animation,
    Callout,
    Columns,
    Details,
    Heading,
    Key,
    Keys,
    Pair,
    Section,
    Table,
    Text,
    Verdict,
)
from tautwire.report.parts.sections import chart
from tautwire.report.writers import pdf
from tautwire.report.writers.drawing.figure import figure_svg
from tautwire.report.writers.page import Page

ACTING = '#panic("x") $ a_b *c* @d `e` \\ <f> // g "h" [i] \N{GREEK SMALL LETTER SIGMA}'
"""A text of which Typst would obey every part, were it read as markup."""


def curves() -> Drawing:
    """Return a figure with two curves, bars, a shape and a note."""
    figure = Drawing({"height": 300, "barmode": "group"})
    figure.add_scatter(x=[0.0, 1.0], y=[1.0, np.nan], name="one $", mode="lines+markers")
    figure.add_scatter(x=np.arange(3), y=np.arange(3.0), name="two", error_y={"array": [1, 1, 1]})
    figure.add_bar(x=[0, 1], y=[1, 2], name="three")
    figure.add_vline(x=0.5)
    figure.add_annotation(x=0.5, y=1, text="a note<br>in <b>two</b> lines")
    figure.update_layout(xaxis={"title": {"text": "position [m]"}})
    return figure


@pytest.fixture
def contents() -> list[Section]:
    """Return sections with every kind of block."""
    table = Table(
        "a caption", ("", "value"), "lr", (("row", "12.5"), ("x", Verdict("y", "failed")))
    )
    drawn = chart("c", curves(), "what it shows", "in words")
    blocks = (
        Text(ACTING), Text("plainly", "statement"), Heading("a heading"), Callout(("mind this",)),
        Keys((Key("1.5", "N", "force"),)), table, Columns((table, table)), drawn,
        Pair(drawn, replace(drawn, name="d")), Details("folded", (table,)),
    )  # fmt: skip
    film = Animation("{}", ("a",), "moves", "moves", 1, 1)
    return [Section("a", ACTING, blocks), Section("film", "Animation", (film,))]


def head() -> dict[str, object]:
    """Return the head of a page."""
    return {"title": ACTING, "description": ACTING, "facts": {"Speed": ACTING}, "version": "1",
            "case_hash": "abc", "project": None}  # fmt: skip


def test_page_is_set_and_its_texts_act_on_nothing(contents: list[Section], tmp_path: Path) -> None:
    """Every kind of block is set, whatever the texts say; the same page gives the same file."""
    first = Page(contents, head()).write(tmp_path / "a.pdf").read_bytes()
    assert first.startswith(b"%PDF-")
    assert first == Page(contents, head()).write(tmp_path / "b.PDF").read_bytes()


def test_content_is_that_of_the_page(contents: list[Section], tmp_path: Path) -> None:
    """What the template is given holds every table and caption; only the animation is left out."""
    sections = pdf._Page(tmp_path).sections(contents)
    assert [section["title"] for section in sections] == [ACTING, pdf.ANNEX]
    text = json.dumps(sections)
    assert text.count("12.5") == 4
    assert text.count("what it shows") == 3
    assert len(list(tmp_path.glob("figure-*.svg"))) == 3


def test_figure_shows_what_the_page_shows() -> None:
    """Names of axes and series, notes and ticks stand in the drawing as texts."""
    drawing = figure_svg(str(curves().to_json()), 170.0).decode()
    texts = re.sub(r"\s+", " ", " ".join(re.findall(r">([^<>]+)</text>", drawing)))
    for expected in ("position [m]", "one $", "two", "three", "a note"):
        assert expected in texts
    assert drawing == figure_svg(str(curves().to_json()), 170.0).decode()


def test_curve_is_drawn_to_scale() -> None:
    """A straight line from corner to corner of the given range ends in the corners of the axes."""
    figure = go.Figure(
        layout={"height": 300, "xaxis": {"range": [0, 2]}, "yaxis": {"range": [0, 4]}}
    )
    figure.add_scatter(x=[0.0, 2.0], y=[0.0, 4.0], line={"color": "#123456"})
    drawing = figure_svg(str(figure.to_json()), 170.0).decode()
    ground = re.search(r'id="patch_2">\s*<path d="M ([\d. LMz\n]+)"', drawing)
    line = re.search(r'<path d="M ([\d. L\n]+)"[^>]*stroke: #123456', drawing)
    assert ground is not None
    assert line is not None
    corners = np.array(re.findall(r"[\d.]+", ground[1]), dtype=float).reshape(-1, 2)
    ends = np.array(re.findall(r"[\d.]+", line[1]), dtype=float).reshape(-1, 2)
    low, high = corners.min(axis=0), corners.max(axis=0)
    assert ends == pytest.approx(np.array([[low[0], high[1]], [high[0], low[1]]]), abs=1e-3)


def test_every_kind_of_series_is_drawn_or_refused() -> None:
    """Boxes and maps of studies are drawn; a kind that no figure has is never left out silently."""
    figure = go.Figure()
    figure.add_box(x=["a", "a", "b"], y=[1.0, 2.0, 3.0], name="boxes")
    assert b"</svg>" in figure_svg(str(figure.to_json()), 80.0)
    figure = go.Figure()
    figure.add_heatmap(x=[0.0, 1.0], y=[0.0, 1.0], z=[[0.0, 1.0], [2.0, 3.0]])
    assert b"<image" in figure_svg(str(figure.to_json()), 80.0)
    figure.add_pie(values=[1, 2])
    with pytest.raises(ValueError, match="'pie'"):
        figure_svg(str(figure.to_json()), 80.0)


def test_missing_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the packages of the extra, the message says what to install."""
    monkeypatch.setattr(pdf, "find_spec", lambda name: None if name == "typst" else importlib.util)
    with pytest.raises(InputError, match=r"pip install 'tautwire\[pdf\]'"):
        pdf.require_pdf()
