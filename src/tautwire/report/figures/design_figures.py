"""Figures for those who design a line: tension, cantilevers, elasticity along it, wind."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tautwire.analyses.design.masts import Masts
from tautwire.assessment.design.lateral import LateralCheck
from tautwire.assessment.span_table import SpanRow
from tautwire.report.drawing import Drawing
from tautwire.report.figures import style
from tautwire.results.equilibrium import Elasticity, Equilibrium
from tautwire.specs.line.catenary import Line

STRAIGHT_AT = 2.0
"""Where straight track stands on an axis of radii, in units of the widest curve."""
_PLACES = {
    "support": ("square", "support %{customdata[0]}"),
    "dropper": ("circle", "dropper %{customdata[1]} of span %{customdata[0]}"),
    "middle": ("x-thin", "middle %{customdata[1]} of span %{customdata[0]}"),
}
"""Symbol and name of the places of which an elasticity is told."""


def tension_figure(masts: Masts) -> Drawing:
    """Draw the tension of the wires along the line, one curve per wire and state."""
    figure = Drawing(style.layout(360, top=64))
    for number, state in enumerate(masts.states):
        look = style.look(number)
        for row, one in enumerate(state.tensions):
            figure.add_scatter(
                x=list(one.x),
                y=[1e-3 * value for value in one.tension],
                name=f"{state.condition}, {one.wire}",
                mode="lines+markers",
                line={"color": look.colour, "width": 1.5, "dash": style.look(row).dash},
                marker={"size": 5},
                hovertemplate="%{y:.3f} kN",
            )
    figure.update_layout(
        xaxis=style.axis("position along the track [m]"), yaxis=style.axis("tension [kN]")
    )
    return style.fit_legend(figure)


def offset_figure(masts: Masts) -> Drawing:
    """Draw how far cantilevers stand from their place in the design, one curve per condition."""
    figure = Drawing(style.layout(340, top=64))
    rows = [one for one in masts.installation if one.what == "cantilever"]
    names = zip(masts.conditions, masts.temperatures, strict=True)
    for number, (name, degrees) in enumerate(names):
        look = style.look(number)
        figure.add_scatter(
            x=[one.x for one in rows],
            y=[1e3 * one.offsets[number] for one in rows],
            name=f"{name}, {degrees:g} °C",
            mode="markers",
            marker={"color": look.colour, "symbol": look.symbol},
            hovertemplate="%{y:.0f} mm",
        )
    figure.update_layout(
        xaxis=style.axis("position along the track [m]"),
        yaxis=style.axis("offset along the track [mm]"),
    )
    return style.fit_legend(figure)


def blown_figure(check: LateralCheck) -> Drawing:
    """Draw where the contact wires stand under wind from either side, to the left positive."""
    figure = Drawing(style.layout(360, top=64))
    sweep, given = check.sweep, check.places[0].given if check.places else 0.0
    for row, sign in enumerate((1.0, -1.0)):
        curves = (
            (f"wind towards the {('left', 'right')[row]}", sweep.position[row], style.look(row)),
            (f"permissible, {('left', 'right')[row]}", check.permissible[row] - given, None),
        )
        for name, values, look in curves:
            for wire in range(len(sweep.wire_names)):
                own = sweep.wire == wire
                line = (
                    {"color": style.SOFT, "width": 1.0}
                    if look is None
                    else {"color": look.colour, "width": 1.5, "dash": look.dash}
                )
                figure.add_scatter(
                    x=sweep.x[own].astype(np.float32),
                    y=(1e3 * sign * values[own]).astype(np.float32),
                    name=name,
                    legendgroup=name,
                    showlegend=wire == 0,
                    mode="lines",
                    line=line,
                    hovertemplate="%{y:.0f} mm",
                )
    figure.update_layout(
        xaxis=style.axis("position along the track [m]"), yaxis=style.axis("lateral position [mm]")
    )
    return style.fit_legend(figure)


def span_figure(rows: Sequence[SpanRow], winds: Sequence[float]) -> Drawing:
    """Draw the longest span over the radius, one curve per wind; straight track as widest."""
    figure = Drawing(style.layout(360, top=64))
    radii = [row.curve.radius_or_infinity for row in rows]
    widest = max((r for r in radii if np.isfinite(r)), default=1000.0)
    x = [r if np.isfinite(r) else STRAIGHT_AT * widest for r in radii]
    order = sorted(range(len(x)), key=lambda row: x[row])
    for number, wind in enumerate(winds):
        look = style.look(number)
        lengths = [rows[row].spans[number].length for row in order]
        figure.add_scatter(
            x=[x[row] for row in order],
            y=[length if np.isfinite(length) and length > 0.0 else None for length in lengths],
            name=f"{wind:g} m/s",
            mode="lines+markers",
            line={"color": look.colour, "width": 1.5, "dash": look.dash},
            hovertemplate="%{x:.0f} m: %{y:.1f} m",
        )
    axis = style.axis("radius [m]")
    figure.update_layout(xaxis={**axis, "type": "log"}, yaxis=style.axis("longest span [m]"))
    return style.fit_legend(figure)


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
