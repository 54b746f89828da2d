"""Plain figures: curves in panels one above the other, and grouped bars."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tautwire.report.drawing import Drawing
from tautwire.report.figures import style
from tautwire.report.figures.packing import thinned

MOST_POINTS = 8000
"""Points of a curve: four per pixel of a wide screen, two of which are extremes."""
GAP = 46
"""Room between two panels for tick labels and a title [px]."""


@dataclass(frozen=True, eq=False)
class Curve:
    """A series of a panel.

    Attributes
    ----------
    name : str
        Legend entry; curves of the same name share one.
    x, y : (n,)
        NaN interrupts the curve.
    look : int
        Number of the look, from 0.
    mode : str
        ``"lines"``, ``"markers"`` or ``"lines+markers"``.
    width : float
        Of the line [px].
    dash : str
        Dash of the line; that of the look by default.
    """

    name: str
    x: ArrayLike
    y: ArrayLike
    look: int = 0
    mode: str = "lines"
    width: float = 1.4
    dash: str = ""


@dataclass(frozen=True, eq=False)
class Panel:
    """Curves over a common axis.

    Attributes
    ----------
    title : str
    curves : sequence of Curve
    y_title : str
    x_range : (low, high), optional
    marks : mapping of str to float
        Named places on the horizontal axis.
    more : mapping
        Further settings of the vertical axis.
    """

    title: str
    curves: Sequence[Curve]
    y_title: str
    x_range: tuple[float, float] | None = None
    marks: Mapping[str, float] = field(default_factory=dict)
    more: Mapping[str, Any] = field(default_factory=dict)


def panel_figure(
    panels: Sequence[Panel], x_title: str, height: int = 300, *, shared: bool = False
) -> Drawing:
    """Draw panels one above the other.

    Parameters
    ----------
    panels
    x_title
        Title of the lowest horizontal axis.
    height
        Of each panel [px].
    shared
        Whether all panels zoom together.
    """
    figure = Drawing(style.layout(60 + height * len(panels), top=62))
    gap = GAP / (height * len(panels))
    part = (1.0 - gap * (len(panels) - 1)) / len(panels)
    seen: set[str] = set()
    for number, panel in enumerate(panels):
        suffix = "" if number == 0 else str(number + 1)
        top = 1.0 - number * (part + gap)
        _add_axes(figure, panel, suffix, (max(0.0, top - part), top))
        if number == len(panels) - 1:
            figure.layout[f"xaxis{suffix}"]["title"] = {"text": x_title, "standoff": 8}
        if shared and number:
            figure.layout[f"xaxis{suffix}"]["matches"] = "x"
        for curve in panel.curves:
            _add_curve(figure, curve, suffix, show=curve.name not in seen)
            seen.add(curve.name)
        _add_marks(figure, panel.marks, suffix, top - part, top)
    return style.fit_legend(figure)


def _add_axes(figure: Drawing, panel: Panel, suffix: str, domain: tuple[float, float]) -> None:
    range_ = None if panel.x_range is None else list(panel.x_range)
    figure.update_layout(
        {
            f"xaxis{suffix}": style.axis("", anchor=f"y{suffix}", range=range_),
            f"yaxis{suffix}": style.axis(
                panel.y_title, anchor=f"x{suffix}", domain=list(domain), **panel.more
            ),
        }
    )
    figure.add_annotation(
        text=panel.title,
        xref="paper",
        yref="paper",
        x=0,
        y=domain[1],
        xanchor="left",
        yanchor="bottom",
        showarrow=False,
        font={"size": 12, "color": style.SOFT},
    )


def _add_curve(figure: Drawing, curve: Curve, suffix: str, *, show: bool) -> None:
    look = style.look(curve.look)
    x, y = np.asarray(curve.x, dtype=float), np.asarray(curve.y, dtype=float)
    kept = thinned(y, MOST_POINTS)
    figure.add_scatter(
        x=x[kept].astype(np.float32),
        y=y[kept].astype(np.float32),
        name=curve.name,
        legendgroup=curve.name,
        showlegend=show and bool(curve.name),
        mode=curve.mode,
        line={"color": look.colour, "dash": curve.dash or look.dash, "width": curve.width},
        marker={"color": look.colour, "symbol": look.symbol, "size": 7},
        xaxis=f"x{suffix}",
        yaxis=f"y{suffix}",
        hovertemplate="%{y:.4g}",
    )


def _add_marks(
    figure: Drawing, marks: Mapping[str, float], suffix: str, bottom: float, top: float
) -> None:
    """Draw a line at every named place, its name beside it."""
    for name, place in marks.items():
        figure.add_shape(
            type="line",
            xref=f"x{suffix}",
            yref="paper",
            x0=place,
            x1=place,
            y0=max(0.0, bottom),
            y1=top,
            layer="below",
            line={"color": style.RAW, "width": 1, "dash": "dot"},
        )
        figure.add_annotation(
            text=name,
            xref=f"x{suffix}",
            yref="paper",
            x=place,
            y=top,
            xanchor="left",
            yanchor="top",
            textangle=-90,
            showarrow=False,
            font={"size": 10, "color": style.SOFT},
        )


def bar_figure(
    groups: Sequence[str], series: Mapping[str, ArrayLike], y_title: str, height: int = 360
) -> Drawing:
    """Draw grouped bars.

    Parameters
    ----------
    groups
        Names along the horizontal axis.
    series
        Values by legend entry, one per group.
    y_title
    height
        [px]
    """
    figure = Drawing(style.layout(height, top=62, barmode="group"))
    for number, (name, values) in enumerate(series.items()):
        numbers: NDArray[np.float64] = np.asarray(values, dtype=float)
        figure.add_bar(
            x=list(groups),
            y=[None if math.isnan(v) else round(v, 4) for v in numbers.tolist()],
            name=name,
            marker=style.filling(style.look(number)),
            hovertemplate="%{y:.2f}",
        )
    figure.update_layout(xaxis=style.axis(""), yaxis=style.axis(y_title, rangemode="tozero"))
    return style.fit_legend(figure)
