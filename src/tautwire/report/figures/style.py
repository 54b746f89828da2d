"""Look of the figures: colours, dashes and the layout they share.

The colours differ in brightness and every series also has its own dash, so the figures can be
read in black and white and by colour-blind readers.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from tautwire.report.drawing import Drawing

INK = "#16202b"
SOFT = "#55616e"
GRID = "#e6eaee"
SUPPORT = "#c9d1d9"
SECTION = "#f0f4f8"
RAW = "#b3bcc5"
WIDE = "#5fa3cc"
SLACK = "#d55e00"
COLOURS = ("#0b3d63", "#d55e00", "#009e73", "#b0578d", "#b58900", "#3a9bdc")
DASHES = ("solid", "dash", "dot", "dashdot", "longdash", "longdashdot")
PATTERNS = ("", "/", "x", ".", "\\", "-")
SYMBOLS = ("circle", "square", "diamond", "triangle-up", "x", "cross")
_WAVELENGTHS = (20.0, 10.0, 5.0, 3.0, 2.0, 1.5, 1.0, 0.7, 0.5)
"""Labelled wavelengths of an upper axis below the span [m]: round numbers that do not touch."""
FONT = 'system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif'


def wavelengths(span: float | None) -> tuple[float, ...]:
    """Return the wavelengths that an upper axis labels [m]: the span if known, round numbers."""
    if span is None:
        return _WAVELENGTHS
    return (round(span, 2), *(length for length in _WAVELENGTHS if length < 0.6 * span))


@dataclass(frozen=True)
class Look:
    """Colour, dash, pattern and symbol of one series."""

    colour: str
    dash: str
    pattern: str
    symbol: str


def look(number: int) -> Look:
    """Return the look of series `number` (from 0)."""
    return Look(
        COLOURS[number % len(COLOURS)],
        DASHES[number % len(DASHES)],
        PATTERNS[number % len(PATTERNS)],
        SYMBOLS[number % len(SYMBOLS)],
    )


def filling(item: Look) -> dict[str, Any]:
    """Return the marker of bars: the colour, hatched in white from the second series on."""
    pattern = {
        "shape": item.pattern,
        "fillmode": "overlay",
        "fgcolor": "#fff",
        "size": 7,
        "solidity": 0.28,
    }
    return {"color": item.colour, "pattern": pattern}


def fit_legend(figure: Drawing, width: int = 880) -> Drawing:
    """Make room above the plot for the rows of the legend and return the figure.

    Parameters
    ----------
    figure : Figure
    width : int
        Width of the plot to expect [px].
    """
    shown = [trace for trace in figure.data if trace.get("showlegend") is not False]
    names = [trace["name"] for trace in shown if trace.get("name")]
    widths = [7.2 * len(name) + 48 for name in names]
    if sum(widths) > width:
        per_row = max(1, int(width // max(widths)))
        extra = 19 * (-(-len(names) // per_row) - 1)
        figure.layout["margin"]["t"] += extra
        figure.layout["height"] += extra
    return figure


def axis(title: str, **more: Any) -> dict[str, Any]:
    """Return the settings of an axis."""
    return {
        "title": {"text": title, "standoff": 8},
        "showline": True,
        "linecolor": SOFT,
        "ticks": "outside",
        "tickcolor": SOFT,
        "ticklen": 4,
        "gridcolor": GRID,
        "zeroline": False,
    } | more


def support_axis(positions: Sequence[float], marks: Sequence[str], **more: Any) -> dict[str, Any]:
    """Return the upper axis that names the supports and draws a line at each of them."""
    return {
        "overlaying": "x",
        "matches": "x",
        "side": "top",
        "title": {"text": "support", "standoff": 4, "font": {"size": 12}},
        "tickmode": "array",
        "tickvals": list(positions),
        "ticktext": list(marks),
        "tickfont": {"size": 11, "color": SOFT},
        "ticks": "outside",
        "ticklen": 3,
        "tickcolor": SUPPORT,
        "gridcolor": SUPPORT,
        "showgrid": True,
        "zeroline": False,
    } | more


def layout(height: int, top: int = 34, bottom: int = 52, **more: Any) -> dict[str, Any]:
    """Return what all figures share; ``top`` and ``bottom`` are margins in pixels."""
    return {
        "height": height,
        "margin": {"l": 72, "r": 40, "t": top, "b": bottom},
        "font": {"family": FONT, "size": 13, "color": INK},
        "paper_bgcolor": "#fff",
        "plot_bgcolor": "#fff",
        "hovermode": "x unified",
        "hoverlabel": {"font": {"family": FONT, "size": 12}},
        "legend": {
            "orientation": "h",
            "x": 0,
            "xanchor": "left",
            "y": 0.995,
            "yanchor": "top",
            "yref": "container",
        },
        "dragmode": "zoom",
        "modebar": {
            "orientation": "v",
            "bgcolor": "rgba(0,0,0,0)",
            "color": "#9aa5b0",
            "activecolor": INK,
        },
    } | more
