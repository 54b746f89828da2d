"""Series, shapes and notes of a figure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tautwire.report.writers.drawing.axes import Found, Layout
from tautwire.report.writers.drawing.values import (
    POINTS_PER_PIXEL,
    array,
    colour,
    dash,
    is_words,
    numbers,
    plain,
    symbol,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Trace = Mapping[str, Any]
_HATCHES = {"/": "///", "x": "xxx", ".": "...", "\\": "\\\\\\", "-": "---"}


def draw(found: Found, trace: Trace, traces: Sequence[Trace], layout: Layout, number: int) -> None:
    """Draw one series.

    Raises
    ------
    ValueError
        When the series is of a kind that no figure of the package has.
    """
    axes = found.of(trace.get("xaxis", "x"), trace.get("yaxis", "y"))
    kind = trace.get("type", "scatter")
    if kind in ("scatter", "scattergl"):
        _draw_curve(axes, found, trace, number)
    elif kind == "bar":
        _draw_bars(axes, found, trace, [t for t in traces if t.get("type") == "bar"], layout)
    elif kind == "box":
        _draw_boxes(axes, found, trace, [t for t in traces if t.get("type") == "box"])
    elif kind == "heatmap":
        _draw_map(axes, trace)
    else:
        raise ValueError(f"figures have no series of the kind {kind!r}")


def places(found: Found, trace: Trace, letter: str) -> NDArray[np.float64]:
    """Return where the values of a series lie along an axis; names are counted from 0."""
    values = trace.get(letter)
    if is_words(values):
        name = found.bases.get(trace.get(f"{letter}axis", letter), letter)
        order = {word: float(place) for place, word in enumerate(found.words[name])}
        return np.array([order[str(word)] for word in array(values)])
    if values is None:
        count = len(array(trace.get("y" if letter == "x" else "x")))
        start, step = trace.get(f"{letter}0", 0.0), trace.get(f"d{letter}", 1.0)
        return np.asarray(start + step * np.arange(count), dtype=np.float64)
    return numbers(values)


def _draw_curve(axes: Axes, found: Found, trace: Trace, number: int) -> None:
    x, y = places(found, trace, "x"), places(found, trace, "y")
    if not np.isfinite(y).any():
        return
    mode, line = str(trace.get("mode", "lines")), trace.get("line") or {}
    if trace.get("fill") in ("tozeroy", "tonexty", "toself"):
        axes.fill_between(x, y, color=colour(trace.get("fillcolor")), linewidth=0, zorder=1)
    if "lines" in mode:
        axes.plot(
            x, y,
            color=colour(line.get("color")),
            linestyle=dash(line.get("dash")),
            linewidth=POINTS_PER_PIXEL * float(line.get("width", 2)),
            drawstyle="steps-mid" if line.get("shape") == "hvh" else "default",
            zorder=2 + 0.01 * number,
        )  # fmt: skip
    marker = trace.get("marker") or {}
    if "markers" in mode and marker.get("opacity") != 0:
        _draw_symbols(axes, x, y, marker, 2.5 + 0.01 * number)
    if "text" in mode:
        for at_x, at_y, text in zip(x, y, array(trace.get("text")), strict=False):
            axes.text(at_x, at_y, plain(text), fontsize=6, ha="center", va="bottom")
    if trace.get("error_y"):
        _draw_errors(axes, x, y, trace["error_y"], colour(marker.get("color")))


def _draw_symbols(
    axes: Axes, x: NDArray[Any], y: NDArray[Any], marker: Mapping[str, Any], order: float
) -> None:
    shape, is_hollow = symbol(marker.get("symbol"))
    edge = (marker.get("line") or {}).get("color")
    shades = marker.get("color")
    tint = [colour(item) for item in shades] if isinstance(shades, list) else colour(shades)
    sizes = marker.get("size", 6)
    size = POINTS_PER_PIXEL * (numbers(sizes) if isinstance(sizes, (list, dict)) else float(sizes))
    look: dict[str, Any] = {"c": tint}
    if is_hollow and shape not in "|_+x":
        look = {"edgecolors": tint, "facecolors": "none"}
    elif shape not in "|_+x":
        look = {"c": tint, "edgecolors": colour(edge) if edge else "none"}
    axes.scatter(x, y, s=size**2, marker=shape, linewidths=0.6, zorder=order, **look)  # pyright: ignore[reportArgumentType]


def _draw_errors(
    axes: Axes, x: NDArray[Any], y: NDArray[Any], errors: Mapping[str, Any], tint: Any
) -> None:
    above = numbers(errors.get("array"))
    below = numbers(errors["arrayminus"]) if errors.get("arrayminus") is not None else above
    axes.errorbar(
        x, y,
        yerr=[np.maximum(below, 0.0), np.maximum(above, 0.0)],
        fmt="none",
        ecolor=colour(errors.get("color"), tint),
        elinewidth=POINTS_PER_PIXEL * float(errors.get("thickness", 2)),
        capsize=POINTS_PER_PIXEL * float(errors.get("width", 4)) / 2,
        capthick=POINTS_PER_PIXEL * float(errors.get("thickness", 2)),
    )  # fmt: skip


def _draw_bars(
    axes: Axes, found: Found, trace: Trace, bars: Sequence[Trace], layout: Layout
) -> None:
    x, y = places(found, trace, "x"), places(found, trace, "y")
    steps = np.diff(np.unique(x[np.isfinite(x)]))
    step = float(steps.min()) if steps.size else 1.0
    alike = [t for t in bars if (t.get("xaxis"), t.get("yaxis")) == (trace.get("xaxis"),
             trace.get("yaxis"))]  # fmt: skip
    given = trace.get("width")
    if given is not None or layout.get("barmode") == "overlay":
        width = numbers(given) if isinstance(given, (list, dict)) else float(given or 0.8 * step)
        centre = x
    else:
        width = step * (1.0 - float(layout.get("bargap", 0.2))) / len(alike)
        centre = x + width * ([t is trace for t in alike].index(True) - 0.5 * (len(alike) - 1))
    marker = trace.get("marker") or {}
    base = trace.get("base")
    under = 0.0 if base is None else numbers(base) if isinstance(base, (list, dict)) else base
    opacity = marker.get("opacity", 1.0)
    patches = axes.bar(
        centre, np.nan_to_num(y), width=width, bottom=under,
        color=colour(marker.get("color"), "#0b3d63"), edgecolor="#fff", linewidth=0.2,
        hatch=_HATCHES.get(str((marker.get("pattern") or {}).get("shape", ""))), zorder=2,
    )  # fmt: skip
    if isinstance(opacity, (list, dict)):
        for patch, share in zip(patches, numbers(opacity), strict=False):
            patch.set_alpha(float(share))


def _draw_boxes(axes: Axes, found: Found, trace: Trace, boxes: Sequence[Trace]) -> None:
    x, y = places(found, trace, "x"), places(found, trace, "y")
    width = 0.7 / len(boxes)
    shift = width * ([t is trace for t in boxes].index(True) - 0.5 * (len(boxes) - 1))
    tint = colour((trace.get("marker") or {}).get("color"))
    for place in np.unique(x):
        own = y[(x == place) & np.isfinite(y)]
        axes.boxplot(
            [own], positions=[place + shift], widths=0.8 * width, showfliers=False,
            manage_ticks=False, boxprops={"color": tint, "linewidth": 0.8},
            medianprops={"color": tint}, whiskerprops={"color": tint}, capprops={"color": tint},
        )  # fmt: skip
        axes.scatter(np.full(own.size, place + shift), own, s=3, color=tint, zorder=3)


def _draw_map(axes: Axes, trace: Trace) -> None:
    x, y, z = numbers(trace["x"]), numbers(trace["y"]), np.asarray(array(trace["z"]), dtype=float)
    image = axes.pcolormesh(
        x, y, z, cmap="RdBu_r", vmin=trace.get("zmin"), vmax=trace.get("zmax"),
        shading="nearest", rasterized=True,
    )  # fmt: skip
    bar = axes.figure.colorbar(image, ax=axes, pad=0.01, fraction=0.03)
    bar.set_label(plain(((trace.get("colorbar") or {}).get("title") or {}).get("text", "")))


def draw_shape(found: Found, shape: Mapping[str, Any]) -> None:
    """Draw a line or a rectangle: over the whole height of a panel where it refers to it."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Rectangle

    x_name, y_name = str(shape.get("xref", "x")), str(shape.get("yref", "y"))
    is_whole_y = y_name == "paper" or y_name.endswith(" domain")
    is_whole_x = x_name == "paper" or x_name.endswith(" domain")
    axes = found.any_with(_axis_of(y_name if is_whole_x else x_name))
    transform = axes.transData
    if is_whole_y:
        transform = axes.get_xaxis_transform()
    elif is_whole_x:
        transform = axes.get_yaxis_transform()
    x = [float(shape.get("x0", 0)), float(shape.get("x1", 1))]
    y = [float(shape.get("y0", 0)), float(shape.get("y1", 1))]
    if y_name == "paper":
        y = [0.0, 1.0]
    order = 0.5 if shape.get("layer") == "below" else 1.8
    look: dict[str, Any] = {"transform": transform, "zorder": order}
    if shape.get("type") == "line":
        line = shape.get("line") or {}
        look |= {"color": colour(line.get("color")), "linestyle": dash(line.get("dash"))}
        look |= {"linewidth": POINTS_PER_PIXEL * float(line.get("width", 1))}
        axes.add_line(Line2D(x, y, **look))
    else:
        look |= {"facecolor": colour(shape.get("fillcolor"), "none"), "alpha": shape.get("opacity")}
        axes.add_patch(Rectangle((x[0], y[0]), x[1] - x[0], y[1] - y[0], linewidth=0, **look))


def _axis_of(reference: str) -> str:
    return reference.removesuffix(" domain") if reference != "paper" else "x"


def draw_note(found: Found, note: Mapping[str, Any]) -> None:
    """Write a note at its place, which is one of the data or of the figure."""
    if not note.get("text"):
        return
    x_name, y_name = str(note.get("xref", "x")), str(note.get("yref", "y"))
    on_paper = [name == "paper" or name.endswith(" domain") for name in (x_name, y_name)]
    axes = found.any_with(_axis_of(y_name if on_paper[0] and not on_paper[1] else x_name))
    x, y = note.get("x", 0), float(note.get("y", 1))
    words = found.words.get(_axis_of(x_name), [])
    x = float(words.index(x)) if isinstance(x, str) and x in words else float(x)
    transform = {
        (False, False): axes.transData,
        (False, True): axes.get_xaxis_transform(),
        (True, False): axes.get_yaxis_transform(),
        (True, True): axes.transAxes,
    }[on_paper[0], on_paper[1]]
    if "paper" in (x_name, y_name) and len(found.pairs) > 1:
        y = _within(axes, found, y) if y_name == "paper" else y
    shift = POINTS_PER_PIXEL * np.array([note.get("xshift", 0), note.get("yshift", 0)], dtype=float)
    font = note.get("font") or {}
    axes.annotate(
        plain(note["text"]), (x, y), xycoords=transform, xytext=tuple(shift),
        textcoords="offset points", annotation_clip=not on_paper[0],
        ha={"left": "left", "right": "right"}.get(str(note.get("xanchor")), "center"),
        va={"top": "top", "bottom": "bottom"}.get(str(note.get("yanchor")), "center"),
        rotation=-float(note.get("textangle", 0)), color=colour(font.get("color")),
        fontsize=POINTS_PER_PIXEL * float(font.get("size", 12)),
        bbox={"facecolor": "#fff", "alpha": 0.85, "linewidth": 0, "pad": 0.6}
        if note.get("bgcolor") else None, zorder=4,
    )  # fmt: skip


def _within(axes: Axes, found: Found, y: float) -> float:
    """Return a height of the whole plot as one of a panel."""
    boxes = [own.get_position() for own in found.pairs.values()]
    low, high = min(box.y0 for box in boxes), max(box.y1 for box in boxes)
    own = axes.get_position()
    return float((low + y * (high - low) - own.y0) / (own.y1 - own.y0))


def legend_handle(trace: Trace) -> Any:
    """Return what stands beside the name of a series in the legend."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    marker, line = trace.get("marker") or {}, trace.get("line") or {}
    if trace.get("type") == "bar":
        hatch = _HATCHES.get(str((marker.get("pattern") or {}).get("shape", "")))
        return Patch(
            facecolor=colour(marker.get("color"), "#0b3d63"), hatch=hatch, edgecolor="#fff"
        )
    mode = str(trace.get("mode", "lines"))
    tint = colour(marker.get("color") if "lines" not in mode else line.get("color"))
    shape, is_hollow = symbol(marker.get("symbol"))
    edge = (marker.get("line") or {}).get("color")
    return Line2D(
        [], [], color=tint, markersize=4,
        linestyle=dash(line.get("dash")) if "lines" in mode else "none",
        linewidth=POINTS_PER_PIXEL * float(line.get("width", 2)),
        marker=shape if "markers" in mode or trace.get("type") == "box" else "none",
        markerfacecolor="none" if is_hollow else tint,
        markeredgecolor=colour(edge) if edge and tint == "#fff" else tint,
    )  # fmt: skip
