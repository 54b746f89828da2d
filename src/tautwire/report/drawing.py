"""Figures as plain data: what plotly.js draws, made without the Python package plotly.

A figure is a list of traces and a layout, both as the reference of plotly.js describes them. The
package plotly checks every key of every trace against that reference each time one is set, which
takes longer than all the rest of a report; here :meth:`Drawing.to_figure` asks it to, once, when
someone wants one of its figures.
"""

from __future__ import annotations

import base64
import json
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import plotly.graph_objects as go

_WHOLE = (np.int8, np.int16, np.int32)
"""Whole numbers that plotly.js reads from bytes, the shortest first; it reads none of 64 bits."""
_PLAIN = ("range", "domain")
"""Attributes that plotly.js reads as lists only."""


class Drawing:
    """Traces and layout of one figure.

    Attributes
    ----------
    data : list of dict
        Traces.
    layout : dict
    columns : int
        Panels side by side, see :func:`panels`.

    Parameters
    ----------
    layout
        Settings to begin with.
    columns
    """

    def __init__(self, layout: Mapping[str, Any] | None = None, columns: int = 1) -> None:
        self.data: list[dict[str, Any]] = []
        self.layout: dict[str, Any] = {}
        self.columns = columns
        self.update_layout(layout or {})

    def add(self, kind: str, *, row: int = 1, col: int = 1, **trace: Any) -> None:
        """Add a trace to a panel.

        Parameters
        ----------
        kind
            ``"scatter"``, ``"bar"``, ``"box"`` or ``"heatmap"``.
        row, col
            Panel, from 1.
        **trace
            Attributes of the trace.
        """
        suffix = self._suffix(row, col)
        axes = {"xaxis": f"x{suffix}", "yaxis": f"y{suffix}"} if suffix else {}
        self.data.append({"type": kind, **axes, **trace})

    def add_scatter(self, **trace: Any) -> None:
        """Add a curve or points."""
        self.add("scatter", **trace)

    def add_bar(self, **trace: Any) -> None:
        """Add bars."""
        self.add("bar", **trace)

    def add_annotation(self, **note: Any) -> None:
        """Add a text."""
        self.layout.setdefault("annotations", []).append(note)

    def add_shape(self, **shape: Any) -> None:
        """Add a line or an area."""
        self.layout.setdefault("shapes", []).append(shape)

    def add_vline(self, x: float, **shape: Any) -> None:
        """Add a line over the whole height at `x`."""
        self.add_shape(type="line", x0=x, x1=x, y0=0, y1=1, xref="x", yref="y domain", **shape)

    def add_vrect(self, x0: float, x1: float, **shape: Any) -> None:
        """Add an area over the whole height from `x0` to `x1`."""
        self.add_shape(type="rect", x0=x0, x1=x1, y0=0, y1=1, xref="x", yref="y domain", **shape)

    def update_layout(self, settings: Mapping[str, Any] | None = None, **more: Any) -> None:
        """Change the layout; settings that are mappings are changed key by key."""
        _merge(self.layout, {**(settings or {}), **more})

    def update_xaxes(self, settings: Mapping[str, Any] | None = None, **more: Any) -> None:
        """Change the horizontal axes, of one panel where ``row`` and ``col`` say so."""
        self._update_axes("xaxis", {**(settings or {}), **more})

    def update_yaxes(self, settings: Mapping[str, Any] | None = None, **more: Any) -> None:
        """Change the vertical axes, of one panel where ``row`` and ``col`` say so."""
        self._update_axes("yaxis", {**(settings or {}), **more})

    def _update_axes(self, axis: str, settings: dict[str, Any]) -> None:
        row, col = settings.pop("row", None), settings.pop("col", None)
        for name in [key for key in self.layout if key.startswith(axis)]:
            at = int(name[len(axis) :] or 1) - 1
            if row in (None, at // self.columns + 1) and col in (None, at % self.columns + 1):
                _merge(self.layout[name], settings)

    def _suffix(self, row: int, col: int) -> str:
        number = (row - 1) * self.columns + col
        return "" if number == 1 else str(number)

    def to_dict(self) -> dict[str, Any]:
        """Return traces and layout as plotly.js reads them: lists, texts, numbers."""
        plain = _plain({"data": self.data, "layout": self.layout})
        assert isinstance(plain, dict)
        return plain

    def to_json(self) -> str:
        """Return traces and layout as JSON."""
        return json.dumps(self.to_dict(), allow_nan=False, ensure_ascii=False)

    def to_figure(self) -> go.Figure:
        """Return a figure of the package plotly, which checks every key."""
        import plotly.graph_objects as go

        return go.Figure(self.data, {"template": "none", **self.layout})


def panels(
    heights: Sequence[float],
    *,
    columns: int = 1,
    gap: float,
    gap_across: float = 0.0,
    titles: Sequence[str] = (),
) -> Drawing:
    """Return a figure of panels in rows and columns, to be filled.

    Panels of one column share a horizontal axis; of several, each has its own.

    Parameters
    ----------
    heights
        Of the rows, from above, in any unit.
    columns
    gap, gap_across
        Room between rows and between columns, as a share of the figure.
    titles
        Above each panel, row by row.
    """
    rows = len(heights)
    room = (1.0 - gap * (rows - 1)) / sum(heights)
    width = (1.0 - gap_across * (columns - 1)) / columns
    figure, top = Drawing(columns=columns), 1.0
    for row, height in enumerate(heights, 1):
        bottom = top - room * height
        for col in range(1, columns + 1):
            suffix, left = figure._suffix(row, col), (col - 1) * (width + gap_across)
            shared = {"matches": f"x{rows}"} if columns == 1 and row < rows else {}
            figure.layout[f"xaxis{suffix}"] = {
                "anchor": f"y{suffix}", "domain": [left, left + width], **shared
            }  # fmt: skip
            figure.layout[f"yaxis{suffix}"] = {
                "anchor": f"x{suffix}", "domain": [max(0.0, bottom), top]
            }  # fmt: skip
            if (number := (row - 1) * columns + col) <= len(titles):
                _add_title(figure, titles[number - 1], left + 0.5 * width, top)
        top = bottom - gap
    return figure


def _add_title(figure: Drawing, text: str, x: float, y: float) -> None:
    figure.add_annotation(
        text=text,
        x=x,
        y=y,
        xref="paper",
        yref="paper",
        xanchor="center",
        yanchor="bottom",
        showarrow=False,
    )


def _merge(old: dict[str, Any], new: Mapping[str, Any]) -> None:
    for key, value in new.items():
        if isinstance(value, Mapping):
            _merge(old.setdefault(key, {}), value)
        else:
            old[key] = value


def _plain(value: Any, key: str = "") -> Any:
    """Return data without NumPy types and without settings that are None."""
    if isinstance(value, Mapping):
        return {name: _plain(own, name) for name, own in value.items() if own is not None}
    if isinstance(value, np.ndarray):
        return _of_bytes(value) if value.size and key not in _PLAIN else _plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [_plain(own) for own in value]
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _of_bytes(values: NDArray[Any]) -> Any:
    """Return an array as plotly.js reads it from bytes; as a list where it cannot."""
    if values.dtype.kind in "iu":
        low, high = int(values.min()), int(values.max())
        fitting = [t for t in _WHOLE if np.iinfo(t).min <= low and high <= np.iinfo(t).max]
        values = values.astype(fitting[0] if fitting else np.float64)
    if values.dtype.kind not in "if" or values.dtype.itemsize > 8:
        return _plain(values.tolist())
    packed = {
        "dtype": f"{values.dtype.kind}{values.dtype.itemsize}",
        "bdata": base64.b64encode(np.ascontiguousarray(values).tobytes()).decode("ascii"),
    }
    return packed if values.ndim == 1 else packed | {"shape": str(values.shape)[1:-1]}
