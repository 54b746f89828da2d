"""Figures of a study: forces and uplift over an axis, deviations by mesh and over seeds."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.report.drawing import Drawing
from tautwire.report.figures import style
from tautwire.report.parts.words import band as band_text
from tautwire.studies.axes import SAMPLE, AxisValues, Dimension
from tautwire.studies.columns import BAND, FILTER, PANTOGRAPH
from tautwire.studies.table import StudyTable

Array = NDArray[np.float64]

CUTOFFS = ("0_20", "advised", "0_200")
"""Bands of the curves: to 20 Hz, to the advised cut-off, to 200 Hz."""

BAR_BANDS = ("0_2", "0_5", "5_20", "0_20", "0_50", "0_100", "0_200")
MOST_SERIES = 6
"""With more combinations of the other axes than this, curves show their mean and range."""

MOST_TICKS = MOST_BOXES = 12
"""Labelled values and boxes of an axis: what fits side by side with a number of five digits."""

MESH = "settings.nodes_between_droppers"
SEED = "settings.seed"
_READABLE = {"m/s": ("km/h", 3.6), "N/m": ("kN/m", 1e-3), "s": ("ms", 1e3)}


@dataclass(frozen=True, eq=False)
class Group:
    """Figures of the cases along one dimension, the others held at one place.

    Attributes
    ----------
    label : str
        Where the others are held.
    values : mapping of str to (n,) array
        Standard deviations [N] by band, ``"advised"`` for the advised cut-off; ``"maximum"`` and
        ``"minimum"`` of the force up to 20 Hz [N]; ``"uplift"``, the largest at a support [mm].
    """

    label: str
    values: dict[str, Array]


def readable_axis(axis: AxisValues) -> tuple[str, list[float | str]]:
    """Return title and values of an axis in the units people use."""
    unit, factor = _READABLE.get(axis.unit, (axis.unit, 1.0))
    title = f"{axis.name.replace('_', ' ')}{f' [{unit}]' if unit else ''}"
    values = [
        float(f"{value * factor:.6g}") if isinstance(value, (int, float)) else value
        for value in axis.coordinates
    ]
    return title, values


def groups(
    table: StudyTable, name: str, kind: str = "sharp", *, by_pantograph: bool = True
) -> list[Group]:
    """Return figures of the cases along a dimension, one group per place on all others.

    Parameters
    ----------
    table
    name
        Name of the dimension.
    kind
        Kind of filter.
    by_pantograph
        Groups for each pantograph; otherwise those of the leading one, for what all share.
    """
    if "std" not in table.variables or kind not in table.labels[FILTER]:
        return []
    along = table.names.index(name)
    through = table.labels[FILTER].index(kind)
    others = [d for d in table.dimensions if d.name != name]
    found = []
    names = table.labels[PANTOGRAPH] if by_pantograph else table.labels[PANTOGRAPH][:1]
    for who, pantograph in enumerate(names):
        by_band = {
            band: np.moveaxis(table["std"].values[..., who, through, number], along, -1)
            for number, band in enumerate(table.labels[BAND])
        }
        advised = table["std_advised"].values[..., who, through]
        by_band["advised"] = np.moveaxis(advised, along, -1)
        for extreme in ("maximum", "minimum"):
            values = table[extreme].values[..., who, through]
            by_band[extreme] = np.moveaxis(values, along, -1)
        by_band["uplift"] = np.moveaxis(1e3 * table["uplift_max"].values, along, -1)
        for index in np.ndindex(*(d.size for d in others)):
            words = [_place(d, at) for d, at in zip(others, index, strict=True)]
            if len(names) > 1:
                words.append(pantograph)
            values = {band: array[index] for band, array in by_band.items()}
            found.append(Group(", ".join(words), values))
    return found


def _place(dimension: Dimension, at: int) -> str:
    """Say where on a dimension something is held."""
    if dimension.name == SAMPLE:
        return f"sample {at + 1}"
    words = []
    for axis in dimension.axes:
        title, values = readable_axis(axis)
        value = values[at]
        unit = title[title.index("[") + 1 : -1] if "[" in title else ""
        shown = f"{value:g}" if isinstance(value, float) else str(value)
        name = "NAD" if axis.path == MESH else axis.name.replace("_", " ")
        words.append(f"{name} {shown}{f' {unit}' if unit else ''}")
    return ", ".join(words)


@dataclass(frozen=True)
class Drawn:
    """What a figure draws over an axis.

    Attributes
    ----------
    title : str
        Of the vertical axis.
    unit : str
    curves : mapping of str to str
        Words by the name of a value of a :class:`Group`.
    by_pantograph : bool
        Whether every pantograph has its own.
    """

    title: str
    unit: str
    curves: dict[str, str]
    by_pantograph: bool = True


def axis_figure(table: StudyTable, axis: AxisValues, name: str, drawn: Drawn) -> Drawing:
    """Draw figures of the cases over an axis, one curve per place on all others.

    Parameters
    ----------
    table
    axis
        Numbers, or names.
    name
        Name of its dimension.
    drawn
        What is drawn.
    """
    title, values = readable_axis(axis)
    x = np.array(values, dtype=float if axis.is_numeric else str)
    order = np.argsort(x, kind="stable") if axis.is_numeric else np.arange(x.size)
    found = groups(table, name, by_pantograph=drawn.by_pantograph)
    figure = Drawing(style.layout(430, top=76))
    add = _add_curves if len(found) <= MOST_SERIES else _add_ranges
    add(figure, x, found, order, drawn)
    figure.update_layout(
        xaxis=style.axis(title, **(_scale(axis, x[order]) if axis.is_numeric else {})),
        yaxis=style.axis(f"{drawn.title} [{drawn.unit}]", rangemode="tozero"),
    )
    return style.fit_legend(figure)


def _scale(axis: AxisValues, x: Array) -> dict[str, Any]:
    """Return scale and ticks of an axis of numbers that rise."""
    is_log = axis.unit == "N/m" and x[0] > 0.0 and x[-1] / x[0] >= 5.0
    ticks: dict[str, Any] = {"tickvals": x, "ticktext": [f"{value:g}" for value in x]}
    return {"type": "log" if is_log else "linear", **(ticks if len(x) <= MOST_TICKS else {})}


def _add_curves(
    figure: Drawing, x: NDArray[Any], found: Sequence[Group], order: Any, drawn: Drawn
) -> None:
    """Add the curves of every group, in its colour."""
    for number, group in enumerate(found):
        look = style.look(number)
        for dash, (key, words) in zip(style.DASHES, drawn.curves.items(), strict=False):
            figure.add_scatter(
                x=x[order],
                y=group.values[key][order],
                name=", ".join(filter(None, (group.label, words))),
                mode="lines+markers" if x.dtype.kind == "f" else "markers",
                line={"color": look.colour, "width": 1.8, "dash": dash},
                marker={"symbol": look.symbol, "size": 7},
                hovertemplate=f"%{{y:.1f}} {drawn.unit}",
            )


def _add_ranges(
    figure: Drawing, x: NDArray[Any], found: Sequence[Group], order: Any, drawn: Drawn
) -> None:
    """Add mean and range over many groups."""
    for number, (key, words) in enumerate(drawn.curves.items()):
        every = np.array([group.values[key][order] for group in found])
        look = style.look(number)
        mean = _finite(np.nanmean, every)
        low, high = _finite(np.nanmin, every), _finite(np.nanmax, every)
        figure.add_scatter(
            x=x[order],
            y=mean,
            error_y={"type": "data", "symmetric": False, "array": high - mean,
                     "arrayminus": mean - low, "thickness": 1.2},
            name=", ".join(filter(None, (words, f"mean and range of {len(found)}"))),
            mode="lines+markers" if x.dtype.kind == "f" else "markers",
            line={"color": look.colour, "width": 1.8, "dash": look.dash},
            marker={"symbol": look.symbol, "size": 7},
            hovertemplate=f"%{{y:.1f}} {drawn.unit}",
        )  # fmt: skip


def _finite(reduce: Callable[..., Any], values: Array) -> Array:
    """Reduce over the groups; NaN where no group has a value."""
    empty = ~np.isfinite(values).any(axis=0)
    filled = np.where(empty, 0.0, values)
    return np.where(empty, np.nan, reduce(filled, axis=0))


def band_figure(table: StudyTable, axis: AxisValues, name: str) -> Drawing:
    """Draw bars of the standard deviation per band and value of an axis, such as the mesh.

    With several combinations of the other axes, bars are their mean.
    """
    found = groups(table, name)
    bands = [band for band in BAR_BANDS if band in table.labels[BAND]]
    figure = Drawing(style.layout(400, top=76, barmode="group"))
    _, values = readable_axis(axis)
    label = "NAD" if axis.path == MESH else axis.name.replace("_", " ")
    for at, value in enumerate(values):
        every = np.array([[group.values[band][at] for band in bands] for group in found])
        shown = f"{value:g}" if isinstance(value, float) else str(value)
        figure.add_bar(
            x=[band_text(band) for band in bands],
            y=_finite(np.nanmean, every),
            name=f"{label} {shown}",
            marker=style.filling(style.look(at)),
            hovertemplate="%{y:.1f} N",
        )
    figure.update_layout(
        xaxis=style.axis("band"), yaxis=style.axis("standard deviation [N]", rangemode="tozero")
    )
    return style.fit_legend(figure)


def box_figure(table: StudyTable, name: str) -> Drawing:
    """Draw the spread of the standard deviation over seeds or samples, one box per cut-off."""
    found = groups(table, name)
    figure = Drawing(style.layout(400, top=76, boxmode="group"))
    figure.update_layout(hovermode="closest")
    for number, cutoff in enumerate(CUTOFFS):
        x = [group.label or "all cases" for group in found for _ in group.values[cutoff]]
        y = np.concatenate([group.values[cutoff] for group in found])
        kept = np.isfinite(y)
        figure.add(
            "box",
            x=[label for label, is_kept in zip(x, kept, strict=True) if is_kept],
            y=y[kept],
            name=cutoff_text(cutoff),
            boxpoints="all",
            jitter=0.4,
            pointpos=0,
            marker={"color": style.look(number).colour, "size": 4},
            line={"width": 1.4},
        )
    figure.update_layout(
        xaxis=style.axis("", type="category"),
        yaxis=style.axis("standard deviation [N]", rangemode="tozero"),
    )
    return style.fit_legend(figure)


def scatter_figure(table: StudyTable, axis: AxisValues, name: str) -> Drawing:
    """Draw the standard deviation of every sample over one of the drawn values."""
    title, values = readable_axis(axis)
    figure = Drawing(style.layout(400, top=76))
    figure.update_layout(hovermode="closest")
    found = groups(table, name)
    for number, cutoff in enumerate(CUTOFFS):
        look = style.look(number)
        figure.add_scatter(
            x=np.tile(np.array(values, dtype=float), len(found)),
            y=np.concatenate([group.values[cutoff] for group in found]),
            name=cutoff_text(cutoff),
            mode="markers",
            marker={"color": look.colour, "symbol": look.symbol, "size": 6, "opacity": 0.75},
            hovertemplate="%{x:.5g}: %{y:.1f} N",
        )
    figure.update_layout(
        xaxis=style.axis(title), yaxis=style.axis("standard deviation [N]", rangemode="tozero")
    )
    return style.fit_legend(figure)


def usual_figures(table: StudyTable) -> Iterator[tuple[str, Drawing, str]]:
    """Yield name, figure and caption of the figures that suit the axes of a study."""
    if not groups(table, table.names[0]):
        return
    for dimension in table.dimensions:
        if dimension.size < 2:
            continue
        is_repeated = dimension.name == SAMPLE or any(a.path == SEED for a in dimension.axes)
        if is_repeated and len(groups(table, dimension.name)) <= MOST_BOXES:
            text = "Spread of the standard deviation of the contact force over the "
            yield (
                f"spread-{dimension.name}",
                box_figure(table, dimension.name),
                text + "repetitions",
            )
        for axis in dimension.axes:
            yield from _axis_figures(table, axis, dimension)


def _axis_figures(
    table: StudyTable, axis: AxisValues, dimension: Dimension
) -> Iterator[tuple[str, Drawing, str]]:
    if axis.path == SEED:
        return
    words = axis.name.replace("_", " ")
    if not axis.is_numeric or axis.path == MESH:
        text = f"Standard deviation of the contact force by band and {words}"
        if math.prod(d.size for d in table.dimensions if d is not dimension) > 1:
            text += ", mean over all other axes"
        yield f"bands-{axis.name}", band_figure(table, axis, dimension.name), text
    if dimension.name == SAMPLE:
        if axis.is_numeric:
            text = f"Standard deviation of the contact force of every sample over {words}"
            yield f"samples-{axis.name}", scatter_figure(table, axis, dimension.name), text
        return
    shown = [] if axis.path == MESH else [("extremes", EXTREMES), ("uplift", UPLIFT)]
    if axis.is_numeric:
        shown.insert(0, ("over", DEVIATIONS))
    for what, drawn in shown:
        figure = axis_figure(table, axis, dimension.name, drawn)
        yield f"{what}-{axis.name}", figure, f"{drawn.title.capitalize()} over {words}"


def cutoff_text(cutoff: str) -> str:
    """Return a band of the curves in words."""
    return "0 to the advised cut-off" if cutoff == "advised" else band_text(cutoff)


DEVIATIONS = Drawn(
    "standard deviation of the contact force", "N", {key: cutoff_text(key) for key in CUTOFFS}
)
EXTREMES = Drawn(
    "largest and smallest contact force", "N",
    {"maximum": f"largest, {band_text('0_20')}", "minimum": f"smallest, {band_text('0_20')}"},
)  # fmt: skip
UPLIFT = Drawn("largest uplift at a support", "mm", {"uplift": ""}, by_pantograph=False)
