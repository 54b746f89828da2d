"""Look of the figures: colours, dashes and the layout they share.

The colours differ in brightness and every series also has its own dash, so the figures can be
read in black and white and by colour-blind readers.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

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
FONT = 'system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif'


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


def support_axis(positions: Sequence[float], **more: Any) -> dict[str, Any]:
    """Return the upper axis that numbers the supports and draws a line at each of them."""
    return {
        "overlaying": "x",
        "matches": "x",
        "side": "top",
        "title": {"text": "support", "standoff": 4, "font": {"size": 12}},
        "tickmode": "array",
        "tickvals": list(positions),
        "ticktext": [str(n) for n in range(1, len(positions) + 1)],
        "tickfont": {"size": 11, "color": SOFT},
        "ticks": "outside",
        "ticklen": 3,
        "tickcolor": SUPPORT,
        "gridcolor": SUPPORT,
        "showgrid": True,
        "zeroline": False,
    } | more


def layout(height: int, **more: Any) -> dict[str, Any]:
    """Return what all figures share."""
    return {
        "template": "none",
        "height": height,
        "margin": {"l": 68, "r": 16, "t": 34, "b": 52},
        "font": {"family": FONT, "size": 13, "color": INK},
        "paper_bgcolor": "#fff",
        "plot_bgcolor": "#fff",
        "hovermode": "x unified",
        "hoverlabel": {"font": {"family": FONT, "size": 12}},
        "legend": {
            "orientation": "h",
            "x": 0,
            "xanchor": "left",
            "y": 1.02,
            "yanchor": "bottom",
            "yref": "paper",
        },
        "dragmode": "zoom",
    } | more
