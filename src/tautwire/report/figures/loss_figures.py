"""Figures of contact loss: the longest losses enlarged, and what disturbs the contact."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from tautwire.report.drawing import Drawing, panels
from tautwire.report.figures import style
from tautwire.report.figures.panels import Curve, Panel, panel_figure
from tautwire.report.parts.summary import statistics_of
from tautwire.report.parts.views import RunView, Series, series
from tautwire.results.equilibrium import Equilibrium
from tautwire.results.irregularity import DrawnIrregularities
from tautwire.results.statistics import LossEvent

MOST_ENLARGED = 6
"""Losses drawn enlarged, the longest: three rows of two fill a screen."""
COLUMNS = 2
MARGIN = 0.012
"""Time shown before and after a loss [s]."""
ROW = 12.0
"""Distance of the bars of two series that mark their losses [N]."""
SPACING = 0.02
"""Distance of the points at which the surface is drawn [m]."""


def enlarged_figure(views: Sequence[RunView]) -> Drawing:
    """Draw the unfiltered force around the longest losses, one panel each, in order of time.

    Runs of one speed share the panels: the same instant is the same place.
    """
    shown = series(views)
    chosen = _longest(shown)
    rows = -(-len(chosen) // COLUMNS)
    figure = panels(
        [1.0] * rows,
        columns=COLUMNS,
        gap=0.26 / rows,
        gap_across=0.1,
        titles=[f"{1e3 * e.duration:.2f} ms at {e.place}" for _, e in chosen],
    )
    for note in figure.layout["annotations"]:
        note["font"] = {"size": 12, "color": style.SOFT}
    figure.update_layout(style.layout(90 + 235 * rows, top=84, hovermode="closest"))
    for number, (owner, event) in enumerate(chosen):
        place: dict[str, Any] = {"row": number // COLUMNS + 1, "col": number % COLUMNS + 1}
        for item in shown if _is_one_passage(views) else [owner]:
            _add_force(figure, item, event, place, is_first=number == 0)
        figure.update_xaxes(**style.axis("", tickformat=".3f", nticks=6), **place)
        figure.update_yaxes(**style.axis(""), **place)
    for column in range(1, min(COLUMNS, len(chosen)) + 1):
        last = rows if column <= len(chosen) - COLUMNS * (rows - 1) else rows - 1
        figure.update_xaxes(title={"text": "time [s]", "standoff": 8}, row=last, col=column)
    figure.update_yaxes(title={"text": "contact force [N]", "standoff": 8}, col=1)
    return style.fit_legend(figure)


def _is_one_passage(views: Sequence[RunView]) -> bool:
    """Tell whether the pantographs of all runs are at the same place at the same time."""
    scenarios = [view.run.case.scenario for view in views]
    return len({(s.speed, s.direction) for s in scenarios}) == 1


def _longest(shown: Sequence[Series]) -> list[tuple[Series, LossEvent]]:
    """Choose the longest losses of all series that do not show the same stretch of time."""
    pool = [(item, event) for item in shown for event in statistics_of(item).contact_loss.events]
    chosen: list[tuple[Series, LossEvent]] = []
    for item, event in sorted(pool, key=lambda pair: -pair[1].duration):
        middle = event.start + 0.5 * event.duration
        if len(chosen) < MOST_ENLARGED and all(
            abs(middle - other.start - 0.5 * other.duration)
            > 0.5 * (event.duration + other.duration) + MARGIN
            for _, other in chosen
        ):
            chosen.append((item, event))
    return sorted(chosen, key=lambda pair: pair[1].start)


def _add_force(
    figure: Drawing, item: Series, event: LossEvent, place: dict[str, int], *, is_first: bool
) -> None:
    """Add the force around a loss, and its losses as bars at zero force and below."""
    low, high = event.start - MARGIN, event.start + event.duration + MARGIN
    kept = (item.force.time >= low) & (item.force.time <= high)
    look = style.look(item.number)
    common: dict[str, Any] = {"legendgroup": str(item.number), **place}
    figure.add_scatter(
        x=item.force.time[kept],
        y=item.force.raw[kept].astype(np.float32),
        mode="lines+markers",
        line={"color": look.colour, "width": 1.4, "dash": look.dash},
        marker={"color": look.colour, "symbol": look.symbol, "size": 4},
        name=item.named("unfiltered"),
        showlegend=is_first,
        hovertemplate="%{x:.4f} s: %{y:.0f} N",
        **common,
    )
    for loss in statistics_of(item).contact_loss.events:
        end = loss.start + loss.duration
        if loss.start < high and end > low:
            figure.add_scatter(
                x=[loss.start, end],
                y=[-ROW * item.number] * 2,
                mode="lines+markers",
                line={"color": look.colour, "width": 6},
                marker={"color": look.colour, "symbol": "line-ns-open", "size": 14},
                opacity=0.6,
                name=item.named("lost"),
                showlegend=False,
                hovertemplate=f"lost for {1e3 * loss.duration:.2f} ms",
                **common,
            )


def irregularity_figure(view: RunView, drawn: DrawnIrregularities) -> Drawing:
    """Draw what the head meets, the running surface, and the errors of installation."""
    shape, curves = view.run.equilibrium, []
    x = np.arange(shape.mast_x[0], shape.mast_x[-1], SPACING)
    sag = _sag(shape, x)
    panels = [
        Panel(
            "depth of the running surface below the supports, at rest",
            [Curve("running surface", x, 1e3 * sag)],
            "[mm]",
            view.section,
            more={"autorange": "reversed"},
        )
    ]
    if drawn.is_uneven:
        surface = np.interp(x, drawn.surface_x, drawn.surface_height)
        panels[0] = Panel(
            panels[0].title,
            [
                Curve("running surface", x, 1e3 * (sag - surface), width=1.0),
                Curve("contact wire", x, 1e3 * sag, 1),
            ],
            "[mm]",
            view.section,
            more={"autorange": "reversed"},
        )
        curves = [Curve("unevenness", x, 1e3 * surface, 2, width=1.0, dash="solid")]
        panels.append(Panel("unevenness of the running surface", curves, "[mm]", view.section))
    if drawn.is_installed_wrong:
        errors = drawn.dropper_height if drawn.dropper_height.any() else drawn.dropper_length
        what = "height at the dropper" if drawn.dropper_height.any() else "length of the dropper"
        points = [Curve("error of installation", shape.dropper_x, 1e3 * errors, 3, "markers")]
        panels.append(Panel(f"error of the {what}", points, "[mm]", view.section))
    return panel_figure(panels, "position along the track [m]", 190, shared=True)


def _sag(shape: Equilibrium, x: Any) -> Any:
    """Return the depth of the contact wire below the straight line between supports [m]."""
    wire = shape.contact_position
    straight = shape.support_line(shape.wires.index(shape.contact), x)
    return straight - np.interp(x, wire[:, 0], wire[:, 2])
