"""A figure as SVG: the same data and layout that the HTML page shows, drawn by Matplotlib."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from tautwire.errors import not_installed
from tautwire.report.writers.drawing import axes as frames
from tautwire.report.writers.drawing import marks
from tautwire.report.writers.drawing.values import colour, plain

if TYPE_CHECKING:
    from matplotlib.figure import Figure

INCH = 25.4
"""Millimetres."""
PIXELS_PER_INCH = 132.0
"""Of the page's figures: one 640 pixels high fills half of an A4 sheet."""
_SETTINGS: dict[Any, Any] = {
    "svg.fonttype": "none",
    "svg.hashsalt": "tautwire",  # names inside a file are the same at each writing
    "font.family": "DejaVu Sans",
    "font.size": 7.0,
    "axes.linewidth": 0.5,
    "xtick.major.width": 0.5,
    "ytick.major.width": 0.5,
    "hatch.linewidth": 0.6,
    "path.simplify_threshold": 0.4,  # pixels at 72 to the inch: below what a printer shows
}


def figure_svg(content: str, width: float) -> bytes:
    """Draw a figure.

    Parameters
    ----------
    content : str
        Data and layout as the page has them, JSON of the Plotly schema.
    width : float
        [mm]

    Returns
    -------
    bytes
        An SVG image; its texts are texts.

    Raises
    ------
    InputError
        When Matplotlib is not installed.
    """
    try:
        import matplotlib as mpl
    except ImportError:
        raise not_installed("matplotlib", "pdf") from None
    specification = json.loads(content)
    image = io.BytesIO()
    with mpl.rc_context(dict(_SETTINGS)):
        figure = _drawn(specification["data"], specification["layout"], width / INCH)
        figure.savefig(image, format="svg", metadata={"Date": None, "Creator": None})
    return image.getvalue()


def _drawn(data: list[dict[str, Any]], layout: Mapping[str, Any], width: float) -> Figure:
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    height = float(layout.get("height", 400)) / PIXELS_PER_INCH
    figure = Figure(figsize=(width, height))
    FigureCanvasSVG(figure)
    shown = [trace for trace in data if trace.get("visible") in (None, True)]
    entries = _legend_entries(shown)
    rows = _rows_of_legend(entries, width)
    room = frames.Room(width, height, legend_rows=rows)
    found = frames.make_axes(figure, shown, layout, room)
    for number, trace in enumerate(shown):
        marks.draw(found, trace, shown, layout, number)
    for shape in layout.get("shapes", []):
        marks.draw_shape(found, shape)
    for note in layout.get("annotations", []):
        marks.draw_note(found, note)
    frames.finish_axes(found, layout)
    if entries:
        _add_legend(figure, entries, rows)
    return figure


def _legend_entries(shown: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the series that a legend names, each name once; none where there is one series."""
    named = [t for t in shown if t.get("name") and t.get("showlegend") is not False]
    is_asked = any(trace.get("showlegend") for trace in named)
    entries = list({trace["name"]: trace for trace in named}.values())
    return entries if len(entries) > 1 or is_asked else []


def _per_row(entries: list[dict[str, Any]], width: float) -> int:
    """Return how many entries stand side by side: 0.058 inches per letter of 7 points."""
    widest = max(0.058 * len(plain(entry["name"])) for entry in entries) + 0.45
    return max(1, min(len(entries), int(width // widest)))


def _rows_of_legend(entries: list[dict[str, Any]], width: float) -> int:
    return -(-len(entries) // _per_row(entries, width)) if entries else 0


def _add_legend(figure: Figure, entries: list[dict[str, Any]], rows: int) -> None:
    handles = [marks.legend_handle(entry) for entry in entries]
    figure.legend(
        handles,
        [plain(entry["name"]) for entry in entries],
        loc="upper left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=-(-len(entries) // rows),
        frameon=False,
        handlelength=2.4,
        columnspacing=1.4,
        borderaxespad=0.1,
        labelcolor=colour("#16202b"),
    )
