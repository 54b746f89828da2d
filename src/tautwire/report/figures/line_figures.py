"""Figures of the line: its shape, uplift at supports, dropper forces, elasticity."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.force.section import reached_supports
from tautwire.line.pieces import Body, WireStay
from tautwire.report.drawing import Drawing, panels
from tautwire.report.figures import style
from tautwire.report.figures.force_figures import add_line_marks
from tautwire.report.figures.packing import share, simplified, thinned
from tautwire.report.parts.fitting_words import bodies_of, body_heights, stay_place, stays_of
from tautwire.report.parts.views import RunView
from tautwire.results.equilibrium import Equilibrium, WireShape
from tautwire.specs.case import Case

Array = NDArray[np.float64]
MESSENGER = "#6a7683"
DROPPER = "#9aa5b0"
_FINEST = {1: 5e-4, 2: 1e-4, 3: 5e-4}
"""How far a wire may be drawn from where it is, by panel [m]: a tenth of a pixel of the whole
panel, which shows 1.5 m to 200 px, or 60 mm of sag to 70 px."""


def line_figure(case: Case, shape: Equilibrium, first: int) -> Drawing:
    """Draw the static line: side view, sag of the contact wire below its supports, plan view.

    Parameters
    ----------
    case
    shape
    first
        Span from 1 at which it opens.
    """
    figure = panels([0.46, 0.24, 0.30], gap=0.05)
    marks = case.line.support_marks()
    _add_side_view(figure, shape, bodies_of(case))
    _add_sag(figure, shape)
    _add_plan(figure, shape)
    _add_stays(figure, shape, stays_of(case))
    figure.update_layout(style.layout(640, top=48, bottom=72, hovermode="closest"))
    x = {"showgrid": True, "gridcolor": style.SUPPORT, "tickvals": shape.mast_x}
    figure.update_xaxes(style.axis("", **x, showticklabels=False, range=_opening(shape, first)))
    figure.update_xaxes(
        ticktext=[f"{n}<br>{place}" for n, place in zip(marks, _places(case, shape), strict=True)],
        showticklabels=True,
        title={"text": "support and position along the track", "standoff": 14},
        row=3,
        col=1,
    )
    for row, title in enumerate(("height [m]", "sag [mm]", "lateral [mm]"), 1):
        figure.update_yaxes(**style.axis(title), row=row, col=1)
    figure.update_yaxes(autorange="reversed", row=2, col=1)
    return figure


def _places(case: Case, shape: Equilibrium) -> list[str]:
    """Return the chainage of every support, or its distance from support 1."""
    if case.line.chainage is None:
        return [f"{place:g} m" for place in shape.mast_x.round(2)]
    return [f"km {1e-3 * place:.3f}" for place in case.line.chainage]


def _opening(shape: Equilibrium, first: int) -> list[float]:
    """Return the first three spans of the section."""
    x = shape.mast_x
    last = min(first + 2, x.size - 1)
    margin = 0.03 * (x[last] - x[first - 1])
    return [float(x[first - 1] - margin), float(x[last] + margin)]


def _add_side_view(figure: Drawing, shape: Equilibrium, bodies: Sequence[Body]) -> None:
    top = _dropper_tops(shape)
    _add_segments(
        figure, (shape.dropper_x, top), (shape.dropper_x, shape.dropper_heights), "droppers", 1
    )
    for wire, line in _looks(shape):
        _add_wire(figure, wire, wire.position[:, 2], line, row=1, text="%{y:.4f} m")
    numbers = np.column_stack(
        [
            shape.dropper_span,
            shape.dropper_number,
            shape.dropper_forces,
            shape.dropper_lengths_unstrained,
            shape.dropper_lengths,
        ]
    )
    figure.add_scatter(
        x=shape.dropper_x.astype(np.float32),
        y=(0.5 * (top + shape.dropper_heights)).astype(np.float32),
        mode="markers",
        marker={"size": 10, "opacity": 0},
        customdata=numbers.astype(np.float32),
        hovertemplate="dropper %{customdata[1]} of span %{customdata[0]}<br>"
        "%{customdata[2]:.1f} N<br>%{customdata[3]:.4f} m unstrained<br>"
        "%{customdata[4]:.4f} m stretched<extra></extra>",
        showlegend=False,
        row=1,
        col=1,
    )
    _add_bodies(figure, shape, bodies)


def _add_stays(figure: Drawing, shape: Equilibrium, stays: Sequence[WireStay]) -> None:
    """Add the stays of wires to the side view and to the plan view."""
    if not stays:
        return
    on_wire = np.array([stay_place(shape, stay) for stay in stays])
    far = np.array([stay.end for stay in stays])
    far[:, 0] += [stay.at.s for stay in stays]
    for row, axis, scale in ((1, 2, 1.0), (3, 1, 1e3)):
        begin, end = ((at[:, 0], scale * at[:, axis]) for at in (on_wire, far))
        _add_segments(figure, begin, end, "stays", row)


def _add_bodies(figure: Drawing, shape: Equilibrium, bodies: Sequence[Body]) -> None:
    if not bodies:
        return
    ends = [body_heights(shape, body) for body in bodies]
    figure.add_scatter(
        x=[0.5 * (body.start + body.end) for body in bodies],
        y=[0.5 * (left + right) for left, right in ends],
        mode="markers",
        marker={"size": 9, "symbol": "square", "color": style.SLACK},
        name="bodies",
        text=[f"{body.name} in {body.run}" for body in bodies],
        hovertemplate="%{text}, x = %{x:.2f} m<extra></extra>",
        row=1,
        col=1,
    )


def _dropper_tops(shape: Equilibrium) -> Array:
    """Return the height of the upper end of every dropper, on the wire that carries it [m]."""
    tops = np.empty(shape.dropper_x.size)
    for number, wire in enumerate(shape.wires):
        own = shape.dropper_wires[:, 0] == number
        tops[own] = np.interp(shape.dropper_x[own], wire.position[:, 0], wire.position[:, 2])
    return tops


def _looks(shape: Equilibrium) -> list[tuple[WireShape, dict[str, Any]]]:
    """Return every wire with its line: contact wires last, in colours, the others dashed."""
    contacts = shape.of_role("contact")
    others = [wire for wire in shape.wires if wire not in contacts]
    groups = list(dict.fromkeys(map(_group, others)))
    carrying = [
        (
            wire,
            {
                "color": MESSENGER,
                "width": 1.8,
                "dash": style.DASHES[1 + groups.index(_group(wire)) % 5],
            },
        )
        for wire in others
    ]
    run = [(wire, {"color": style.look(n).colour, "width": 2.4}) for n, wire in enumerate(contacts)]
    return carrying + run


def _group(wire: WireShape) -> str:
    """Return the entry of the legend to which a wire belongs: one for all stitch wires."""
    return "stitch wires" if wire.role == "stitch" else wire.name


def _add_wire(
    figure: Drawing, wire: WireShape, y: Array, line: dict[str, Any], row: int, text: str
) -> None:
    group, metres = _group(wire), 1.0 if row == 1 else 1e-3
    points = simplified(np.column_stack([wire.position[:, 0], metres * y]), _FINEST[row])
    figure.add_scatter(
        x=points[:, 0].astype(np.float32),
        y=(points[:, 1] / metres).astype(np.float32),
        mode="lines",
        name=group,
        line=line,
        legendgroup=group,
        showlegend=not any(trace.get("legendgroup") == group for trace in figure.data),
        hovertemplate=f"{wire.name}, x = %{{x:.2f}} m<br>{text}<extra></extra>",
        row=row,
        col=1,
    )


def _add_segments(
    figure: Drawing,
    begins: tuple[Array, Array],
    ends: tuple[Array, Array],
    name: str,
    row: int,
) -> None:
    """Add separate straight pieces as one curve with gaps."""
    gap = np.full(begins[0].size, np.nan)
    x = np.column_stack([begins[0], ends[0], gap]).ravel()
    y = np.column_stack([begins[1], ends[1], gap]).ravel()
    is_arm = name == "steady arms"
    figure.add_scatter(
        x=x.astype(np.float32),
        y=y.astype(np.float32),
        mode="lines",
        name=name,
        line={"color": style.SLACK if is_arm else DROPPER, "width": 2 if is_arm else 1.2},
        hoverinfo="skip",
        row=row,
        col=1,
    )


def _add_sag(figure: Drawing, shape: Equilibrium) -> None:
    for wire, line in _looks(shape):
        if wire.role != "contact":
            continue
        number, (x, _, z) = shape.wire_names.index(wire.name), wire.position.T
        sag = 1e3 * (shape.support_line(number, x) - z)
        _add_wire(figure, wire, sag, line, row=2, text="%{y:.2f} mm below the supports")
        own = shape.dropper_wires[:, 1] == number
        place, height = shape.dropper_x[own], shape.dropper_heights[own]
        figure.add_scatter(
            x=place.astype(np.float32),
            y=(1e3 * (shape.support_line(number, place) - height)).astype(np.float32),
            mode="markers",
            marker={"size": 6, "color": "#fff", "line": {"color": line["color"], "width": 1.5}},
            name="at droppers",
            legendgroup="at droppers",
            showlegend=wire is shape.contact,
            hovertemplate="%{y:.2f} mm<extra>pre-sag at dropper</extra>",
            row=2,
            col=1,
        )


def _add_plan(figure: Drawing, shape: Equilibrium) -> None:
    for wire, line in _looks(shape):
        _add_wire(figure, wire, 1e3 * wire.position[:, 1], line, row=3, text="y = %{y:.1f} mm")
    if shape.arm_supports.size:
        rows = shape.arm_supports - 1
        foot_x = shape.support_x[rows]
        wires = (shape.wires[wire].position for wire in shape.support_wire[rows].tolist())
        foot_y = np.array(
            [1e3 * np.interp(x, r[:, 0], r[:, 1]) for x, r in zip(foot_x, wires, strict=True)]
        )
        ends = (shape.arm_ends[:, 0], 1e3 * shape.arm_ends[:, 1])
        _add_segments(figure, (foot_x, foot_y), ends, "steady arms", 3)


def uplift_figure(views: Sequence[RunView]) -> Drawing:
    """Draw the largest uplift of the contact wire at every support, pale outside the section."""
    figure = Drawing(style.layout(330, top=40, hovermode="closest", barmode="group", bargap=0.25))
    for number, view in enumerate(views):
        inside = view.statistics.uplift
        uplift = view.run.equilibrium.by_mast(view.run.support_uplift)
        supports = np.arange(1, uplift.shape[1] + 1)
        highest = 1e3 * uplift.max(axis=0) if uplift.shape[0] else np.full(supports.size, np.nan)
        highest[~reached_supports(view.run)] = np.nan
        highest[inside.supports - 1] = 1e3 * inside.uplift
        figure.add_bar(
            x=supports,
            y=highest,
            name=view.label,
            showlegend=len(views) > 1,
            marker=style.filling(style.look(number))
            | {"opacity": np.where(np.isin(supports, inside.supports), 1.0, 0.35)},
            hovertemplate="support %{x}: %{y:.1f} mm",
        )
    marks, every = views[0].run.case.line.support_marks(), _every(views[0])
    figure.update_layout(
        xaxis=style.axis(
            "support",
            showgrid=False,
            tickvals=list(range(1, len(marks) + 1, every)),
            ticktext=marks[::every],
        ),
        yaxis=style.axis("largest uplift [mm]", rangemode="tozero"),
    )
    return style.fit_legend(figure, 380)


def _every(view: RunView) -> int:
    """Return the step between numbered supports that leaves room for their numbers."""
    return max(1, view.run.case.line.spans // 17)


def uplift_history_figure(views: Sequence[RunView]) -> Drawing:
    """Draw the uplift over time at the support of the section where it is largest."""
    figure = Drawing(style.layout(330, top=40))
    for number, view in enumerate(views):
        support = highest_support(view)
        if support is None or view.run.time.size < 2:
            continue
        lifted = view.run.equilibrium.by_mast(view.run.support_uplift)
        history = 1e3 * lifted[:, support - 1].astype(float)
        kept, look = thinned(history, share(3 * len(views), 6000)), style.look(number)
        name = view.run.case.line.support_in_words(support)
        figure.add_scatter(
            x=view.run.time[kept].astype(np.float32),
            y=history[kept].astype(np.float32),
            mode="lines",
            name=f"{view.label}, {name}" if len(views) > 1 else name,
            line={"color": look.colour, "width": 1.6, "dash": look.dash},
            hovertemplate="%{y:.1f} mm",
            showlegend=True,
        )
    figure.update_layout(
        xaxis=style.axis("time [s]", showgrid=False),
        yaxis=style.axis("uplift [mm]", zeroline=True, zerolinecolor=style.SOFT),
    )
    return style.fit_legend(figure, 380)


def highest_support(view: RunView) -> int | None:
    """Return the 1-based support of the section with the largest uplift; None without any."""
    uplift = view.statistics.uplift
    if not np.isfinite(uplift.uplift).any():
        return None
    return int(uplift.supports[np.nanargmax(uplift.uplift)])


def height_figure(views: Sequence[RunView]) -> Drawing:
    """Draw the height of the contact wire at the pantographs beside its static height."""
    first = views[0]
    figure = Drawing(style.layout(350, top=76))
    wire = first.run.equilibrium.contact_position
    figure.add_scatter(
        x=wire[:, 0].astype(np.float32),
        y=wire[:, 2].astype(np.float32),
        mode="lines",
        name="static contact wire",
        line={"color": MESSENGER, "width": 1.4, "dash": "dot"},
        hovertemplate="%{y:.3f} m",
    )
    number = 0
    limit = share(3 * sum(len(view.forces) for view in views), 8000)
    for view in views:
        for record in view.run.pantographs:
            _add_height(figure, view, record.name, number, limit, many=len(views) > 1)
            number += 1
    add_line_marks(figure, first.run, first.section)
    start, end = first.section
    figure.update_layout(
        xaxis=style.axis("position along the track [m]", showgrid=False, range=[start, end]),
        yaxis=style.axis("height [m]"),
    )
    return style.fit_legend(figure)


def _add_height(
    figure: Drawing, view: RunView, name: str, number: int, limit: int, *, many: bool
) -> None:
    record, look = view.run.pantograph(name), style.look(number)
    position, height = record.position[record.active], record.wire_height[record.active]
    if not height.size:
        return
    kept = thinned(height, limit)
    label = f"at the pantograph, {name}" if len(view.run.pantographs) > 1 else "at the pantograph"
    figure.add_scatter(
        x=position[kept].astype(np.float32),
        y=height[kept].astype(np.float32),
        mode="lines",
        name=f"{view.label}, {label}" if many else label,
        line={"color": look.colour, "width": 1.8, "dash": look.dash},
        hovertemplate="%{y:.3f} m",
    )


def dropper_figure(views: Sequence[RunView]) -> Drawing:
    """Draw the range of the dropper forces during the passage and how long they are slack."""
    figure = panels([0.68, 0.32], gap=0.07)
    first = views[0]
    shape = first.run.equilibrium
    gaps = np.diff(shape.dropper_x)
    room = float(gaps.min()) if gaps.size else 5.0
    for number, view in enumerate(views):
        shift = room * 0.8 * ((number + 0.5) / len(views) - 0.5)
        _add_droppers(figure, view, number, shift, 0.62 * room / len(views), many=len(views) > 1)
    figure.update_layout(style.layout(470, top=44, hovermode="closest", barmode="overlay"))
    x = {"gridcolor": style.SUPPORT, "tickvals": shape.mast_x}
    figure.update_xaxes(style.axis("", **x, showticklabels=False, range=list(first.section)))
    figure.update_xaxes(
        ticktext=first.run.case.line.support_marks(),
        showticklabels=True,
        title={"text": "support", "standoff": 6},
        row=2,
        col=1,
    )
    figure.update_yaxes(
        **style.axis("force [N]", zeroline=True, zerolinecolor=style.SOFT), row=1, col=1
    )
    figure.update_yaxes(**style.axis("slack [ms]", rangemode="tozero"), row=2, col=1)
    return style.fit_legend(figure)


def _add_droppers(
    figure: Drawing, view: RunView, number: int, shift: float, width: float, *, many: bool
) -> None:
    data, look = view.statistics.droppers, style.look(number)
    labels = np.column_stack(
        [data.span, data.number, data.minimum, data.maximum, data.static_force]
    )
    place = "dropper %{customdata[1]:.0f} of span %{customdata[0]:.0f}: "
    prefix = f"{view.label}, " if many else ""
    marker = style.filling(look)
    common: dict[str, Any] = {"x": data.position + shift, "customdata": labels, "col": 1}
    figure.add_bar(
        **common,
        base=data.minimum,
        y=data.maximum - data.minimum,
        width=width,
        name=f"{prefix}range",
        marker=marker,
        hovertemplate=place + "%{customdata[2]:.0f} to %{customdata[3]:.0f} N, "
        "static %{customdata[4]:.0f} N<extra></extra>",
        row=1,
    )
    figure.add_scatter(
        **common,
        y=data.static_force,
        mode="markers",
        name="static",
        showlegend=number == 0,
        marker={
            "symbol": "line-ew-open",
            "size": 5 if many else 9,
            "color": "#8d99a5" if not many else style.INK,
            "line": {"width": 2},
        },
        hoverinfo="skip",
        row=1,
    )
    figure.add_bar(
        **common,
        y=1e3 * data.slack_time,
        width=width,
        name=f"{prefix}slack",
        marker=marker,
        showlegend=False,
        hovertemplate=place + "slack for %{y:.0f} ms<extra></extra>",
        row=2,
    )
