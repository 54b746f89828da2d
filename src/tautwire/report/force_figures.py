"""Figures of the contact force: over position, as spectrum, as distribution, per span."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tautwire.report import style
from tautwire.report.packing import thinned
from tautwire.report.views import WIDE_CUTOFF, RunView, Series, series
from tautwire.results.run import Run
from tautwire.signals.spectra import PassingLine, Spectrum, amplitude_spectrum, passing_lines

if TYPE_CHECKING:
    import plotly.graph_objects as go

Array = NDArray[np.float64]
HIGHEST = 200.0
WAVELENGTHS = (55.0, 20.0, 10.0, 5.0, 3.0, 2.0, 1.0, 0.5)


def force_figure(views: Sequence[RunView]) -> go.Figure:
    """Draw the contact force over position: unfiltered, up to 200 Hz and up to 20 Hz.

    Supports are lines numbered on the upper axis, droppers ticks at the lower edge, the analysed
    section is shaded, losses of contact are marked on the zero line.
    """
    import plotly.graph_objects as go

    first, shown = views[0], series(views)
    single = len(shown) == 1
    figure = go.Figure(layout=style.layout(480))
    for item in shown:
        if not item.force.is_empty:
            _add_force_curves(figure, item, single)
    for item in shown:
        _add_losses(figure, item)
    add_line_marks(figure, first.run, first.section)
    figure.update_layout(
        xaxis=style.axis("position along the track [m]", showgrid=False, range=_opening(first)),
        yaxis=style.axis(
            "contact force [N]", zeroline=True, zerolinecolor=style.SOFT, rangemode="tozero"
        ),
        margin={"t": 76},
        legend={"y": 1.09},
    )
    return figure


def _opening(view: RunView) -> list[float]:
    """Return the part of the line that is shown first: the section and a little more."""
    start, end = view.section
    margin = 0.02 * (end - start)
    return [start - margin, end + margin]


def _add_force_curves(figure: go.Figure, item: Series, single: bool) -> None:
    """Add the three curves of one pantograph; of several series only the filtered ones show."""
    look, force, cutoff = style.look(item.number), item.force, item.view.lowpass.cutoff
    curves: list[tuple[str, Array | None, dict[str, Any], bool]] = [
        ("unfiltered", force.raw, {"color": style.RAW, "width": 1}, single),
        (
            f"0-{WIDE_CUTOFF:g} Hz",
            force.wide,
            {"color": style.WIDE if single else look.colour, "width": 1.1},
            False,
        ),
        (
            f"0-{cutoff:g} Hz",
            force.low,
            {"color": look.colour, "width": 2.2, "dash": look.dash},
            True,
        ),
    ]
    for name, values, line, is_shown in curves:
        if values is None:
            continue
        kept = thinned(values)
        figure.add_scatter(
            x=force.position[kept].astype(np.float32),
            y=values[kept].astype(np.float32),
            name=item.named(name),
            mode="lines",
            line=line,
            visible=True if is_shown else "legendonly",
            hovertemplate="%{y:.0f} N",
        )


def _add_losses(figure: go.Figure, item: Series) -> None:
    events = item.view.statistics.pantographs[item.view.forces.index(item.force)].contact_loss
    if not events.events:
        return
    figure.add_scatter(
        x=[event.position for event in events.events],
        y=[0.0] * events.count,
        mode="markers",
        name=item.named("contact loss"),
        marker={"symbol": "x", "size": 9, "color": style.SLACK, "line": {"width": 1}},
        text=[f"{1e3 * e.duration:.1f} ms at {e.place}" for e in events.events],
        hovertemplate="loss of %{text}",
    )


def add_line_marks(figure: go.Figure, run: Run, section: tuple[float, float]) -> None:
    """Mark supports (upper axis), droppers (lower edge) and the analysed section."""
    shape = run.equilibrium
    labels = [
        f"dropper {n} of span {s}"
        for s, n in zip(shape.dropper_span, shape.dropper_number, strict=True)
    ]
    figure.add_scatter(
        x=shape.dropper_x.astype(np.float32),
        y=np.full(shape.dropper_x.size, 0.012, dtype=np.float32),
        yaxis="y9",
        mode="markers",
        marker={"symbol": "line-ns-open", "size": 9, "color": style.SOFT},
        text=labels,
        hovertemplate="%{text}<extra></extra>",
        name="droppers",
        showlegend=False,
    )
    ends = [shape.support_x[0], shape.support_x[-1]]
    figure.add_scatter(
        x=ends, y=[None, None], xaxis="x9", showlegend=False, hoverinfo="skip", mode="lines"
    )
    figure.add_vrect(
        x0=section[0], x1=section[1], fillcolor=style.SECTION, line_width=0, layer="below"
    )
    figure.update_layout(
        xaxis9=style.support_axis(shape.support_x.tolist()),
        yaxis9={"overlaying": "y", "range": [0, 1], "visible": False, "fixedrange": True},
    )


def spectrum_figure(views: Sequence[RunView]) -> go.Figure:
    """Draw the amplitude spectrum of the unfiltered force over the analysed section.

    The frequencies at which spans and dropper intervals are passed are marked.
    """
    import plotly.graph_objects as go

    shown = series(views)
    figure = go.Figure(layout=style.layout(430))
    for item in shown:
        spectrum = section_spectrum(item)
        if spectrum is None:
            continue
        look = style.look(item.number)
        kept = spectrum.abscissa <= HIGHEST
        figure.add_scatter(
            x=spectrum.abscissa[kept][1:].astype(np.float32),
            y=spectrum.value[kept][1:].astype(np.float32),
            name=item.label or "unfiltered force",
            mode="lines",
            line={"color": look.colour, "width": 1.4, "dash": look.dash},
            hovertemplate="%{y:.2f} N",
            showlegend=len(shown) > 1,
        )
    speeds = {view.run.case.scenario.speed for view in views}
    figure.update_layout(
        xaxis=style.axis("frequency [Hz]", range=[0, 50]),
        yaxis=style.axis("amplitude [N]", type="log", dtick=1, exponentformat="power"),
        margin={"t": 84},
        legend={"y": 1.14},
    )
    if len(speeds) == 1:
        _add_passing_lines(figure, passings(views[0]))
        _add_wavelength_axis(figure, speeds.pop())
    return figure


def section_spectrum(item: Series) -> Spectrum | None:
    """Return the amplitude spectrum of the unfiltered force over the section, Hann window."""
    force = item.force
    if force.is_empty:
        return None
    inside = item.view.statistics.section.contains(force.position)
    if inside.sum() < 64:
        return None
    return amplitude_spectrum(force.raw[inside], float(force.time[1] - force.time[0]), "hann")


def passings(view: RunView) -> tuple[PassingLine, ...]:
    """Return the passing frequencies of the commonest span, dropper and support distances."""
    shape, section = view.run.equilibrium, view.statistics.section
    spans = np.diff(shape.support_x)[section.first_span - 1 : section.last_span]
    lengths = {"span": _commonest(spans)}
    inside = (shape.dropper_span >= section.first_span) & (shape.dropper_span <= section.last_span)
    x, span = shape.dropper_x[inside], shape.dropper_span[inside]
    same_span = np.diff(span) == 0
    if same_span.any():
        lengths["droppers"] = _commonest(np.diff(x)[same_span])
    firsts = np.flatnonzero(np.diff(span, prepend=0))
    if firsts.size:
        gaps = x[firsts] - shape.support_x[span[firsts] - 1]
        lengths["support to dropper"] = _commonest(gaps)
    speed = view.run.case.scenario.speed
    spans_only = passing_lines({"span": lengths.pop("span")}, speed, HIGHEST)
    return (*spans_only, *passing_lines(lengths, speed, HIGHEST, orders=2))


def _commonest(values: Array) -> float:
    """Return the value met most often, to the centimetre."""
    found, number = np.unique(np.round(values, 2), return_counts=True)
    return float(found[number.argmax()])


def _add_passing_lines(figure: go.Figure, lines: Sequence[PassingLine]) -> None:
    heights = {"span": 0.99, "droppers": 0.99, "support to dropper": 0.92}
    for line in lines:
        name = line.name if line.order == 1 else f"{line.name} / {line.order}"
        figure.add_vline(
            x=line.frequency, line={"color": style.SOFT, "width": 1, "dash": "dot"}
        )
        figure.add_annotation(
            x=line.frequency,
            y=heights[line.name],
            yref="paper",
            text=f"{name} {line.length:g} m" if line.order == 1 else name,
            showarrow=False,
            xanchor="left",
            xshift=3,
            font={"size": 11, "color": style.SOFT},
            bgcolor="rgba(255,255,255,0.85)",
        )


def _add_wavelength_axis(figure: go.Figure, speed: float) -> None:
    """Add an upper axis with wavelengths; it needs a curve of its own to be drawn."""
    figure.add_scatter(
        x=[0, HIGHEST], y=[None, None], xaxis="x9", showlegend=False, hoverinfo="skip"
    )
    figure.update_layout(
        xaxis9={
            "overlaying": "x",
            "matches": "x",
            "side": "top",
            "title": {"text": "wavelength [m]", "standoff": 4, "font": {"size": 12}},
            "tickmode": "array",
            "tickvals": [speed / length for length in WAVELENGTHS],
            "ticktext": [f"{length:g}" for length in WAVELENGTHS],
            "tickfont": {"size": 11, "color": style.SOFT},
            "ticks": "outside",
            "ticklen": 3,
            "showgrid": False,
            "zeroline": False,
        }
    )


def histogram_figure(views: Sequence[RunView]) -> go.Figure:
    """Draw the distribution of the low-passed force beside the normal one of equal mean and σ."""
    import plotly.graph_objects as go

    shown = series(views)
    figure = go.Figure(layout=style.layout(330, hovermode="closest", barmode="group"))
    for item in shown:
        headline = _headline(item)
        edges, share = headline.histogram.edges, 100.0 * headline.histogram.share
        if not share.size:
            continue
        look, width = style.look(item.number), float(edges[1] - edges[0])
        figure.add_bar(
            x=edges[:-1] + 0.5 * width,
            y=share,
            name=item.label or "simulated",
            marker={"color": look.colour, "pattern": {"shape": look.pattern, "solidity": 0.25}},
            hovertemplate="%{x:.0f} N: %{y:.1f} %<extra></extra>",
        )
        force = np.linspace(edges[0] - 2 * width, edges[-1] + 2 * width, 160)
        reduced = (force - headline.mean) / max(headline.standard_deviation, 1e-9)
        normal = np.exp(-0.5 * reduced**2) / np.sqrt(2 * np.pi)
        figure.add_scatter(
            x=force.astype(np.float32),
            y=(100 * width * normal / max(headline.standard_deviation, 1e-9)).astype(np.float32),
            mode="lines",
            name=item.named("normal") if item.label else "normal, same mean and σ",
            line={"color": look.colour, "width": 1.6, "dash": "dot"},
            hoverinfo="skip",
        )
    figure.update_layout(
        xaxis=style.axis("contact force [N]", showgrid=False),
        yaxis=style.axis("share of time [%]", rangemode="tozero"),
        bargap=0.15,
        margin={"t": 46},
    )
    return figure


def _headline(item: Series) -> Any:
    """Return the headline statistics of a series."""
    index = item.view.forces.index(item.force)
    return item.view.statistics.pantographs[index].headline


def spans_figure(views: Sequence[RunView]) -> go.Figure:
    """Draw mean, standard deviation and extremes of the low-passed force per span."""
    import plotly.graph_objects as go

    shown = series(views)
    figure = go.Figure(layout=style.layout(330, hovermode="closest"))
    for item in shown:
        rows, look = _headline(item).per_span, style.look(item.number)
        span = np.array([row.span for row in rows], dtype=float)
        span += 0.14 * (item.number - 0.5 * (len(shown) - 1))
        numbers = np.array(
            [(r.mean, r.standard_deviation, r.maximum, r.minimum) for r in rows]
        ).T
        mean, deviation, highest, lowest = numbers
        common: dict[str, Any] = {"legendgroup": item.label, "x": span}
        figure.add_scatter(
            **common,
            y=mean,
            mode="markers",
            marker={"size": 1, "color": look.colour},
            error_y={
                "type": "data",
                "symmetric": False,
                "array": highest - mean,
                "arrayminus": mean - lowest,
                "thickness": 1,
                "width": 5,
            },
            showlegend=False,
            hoverinfo="skip",
        )
        figure.add_scatter(
            **common,
            y=mean,
            mode="markers",
            name=item.label or "mean, ± σ (thick), extremes (thin)",
            marker={"size": 8, "color": look.colour, "symbol": look.symbol},
            error_y={"type": "data", "array": deviation, "thickness": 4, "width": 0},
            customdata=np.column_stack([[row.span for row in rows], deviation, highest, lowest]),
            hovertemplate="span %{customdata[0]:.0f}: mean %{y:.1f} N, σ %{customdata[1]:.1f} N, "
            "%{customdata[3]:.0f} to %{customdata[2]:.0f} N<extra></extra>",
        )
    figure.update_layout(
        xaxis=style.axis("span", showgrid=False, dtick=1),
        yaxis=style.axis("contact force [N]", zeroline=True, zerolinecolor=style.SOFT),
        margin={"t": 46},
    )
    return figure
