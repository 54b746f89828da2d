"""Figures of the elasticity: uplift per force along the line."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tautwire.report.drawing import Drawing
from tautwire.report.figures import style
from tautwire.results.equilibrium import Elasticity, Equilibrium
from tautwire.specs.line.catenary import Line

_PLACES = {
    "support": ("square", "support %{customdata[0]}"),
    "dropper": ("circle", "dropper %{customdata[1]} of span %{customdata[0]}"),
    "middle": ("x-thin", "middle %{customdata[1]} of span %{customdata[0]}"),
}
"""Symbol and name of the places of which an elasticity is told."""


def _add_places(figure: Drawing, label: str, data: Elasticity, colour: str) -> None:
    """Mark the places of an elasticity, one kind after the other."""
    kinds = np.array(data.kind)
    for kind, (symbol, name) in _PLACES.items():
        own, line = kinds == kind, {"color": colour, "line": {"width": 1.6, "color": colour}}
        figure.add_scatter(
            x=data.x[own].astype(np.float32),
            y=(1e3 * data.elasticity[own]).astype(np.float32),
            mode="markers",
            legendgroup=label,
            showlegend=False,
            marker={"symbol": symbol, "size": 7, **line},
            customdata=np.column_stack([data.span[own], data.index[own]]),
            hovertemplate=f"{name}: %{{y:.4f}} mm/N<extra></extra>",
        )


def elasticity_figure(
    elasticities: Sequence[tuple[str, Elasticity]], line: Line, shape: Equilibrium
) -> Drawing:
    """Draw the elasticity over position, of one or several lines.

    Parameters
    ----------
    elasticities : sequence of (label, Elasticity)
    line, shape
        Give names and positions of the supports.
    """
    figure = Drawing(style.layout(360, top=40, hovermode="closest"))
    for number, (label, data) in enumerate(elasticities):
        look, order = style.look(number), np.argsort(data.x)
        figure.add_scatter(
            x=data.x[order].astype(np.float32),
            y=(1e3 * data.elasticity[order]).astype(np.float32),
            mode="lines",
            name=label,
            legendgroup=label,
            showlegend=len(elasticities) > 1,
            line={"color": look.colour, "width": 1.6, "dash": look.dash},
            hoverinfo="skip",
        )
        _add_places(figure, label, data, look.colour)
    inside = shape.mast_x
    figure.update_layout(
        xaxis=style.axis(
            "support",
            tickvals=inside,
            ticktext=line.support_marks(),
            gridcolor=style.SUPPORT,
        ),
        yaxis=style.axis("elasticity [mm/N]", rangemode="tozero"),
    )
    return style.fit_legend(figure)
