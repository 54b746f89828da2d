"""Figures of the contact force: over position, as spectrum, as distribution, per span."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.line.expand import expand
from tautwire.line.measures import recurring
from tautwire.report.drawing import Drawing
from tautwire.report.figures import style
from tautwire.report.figures.packing import even, share, thinned
from tautwire.report.parts.views import WIDE_CUTOFF, RunView, Series, series
from tautwire.results.run import Run
from tautwire.results.statistics import FilteredStatistics
from tautwire.signals.bands import WIDEST
from tautwire.signals.spectra import PassingLine, Spectrum, amplitude_spectrum, passing_lines

Array = NDArray[np.float64]


def force_figure(views: Sequence[RunView]) -> Drawing:
    """Draw the contact force over position: unfiltered, up to 200 Hz and up to 20 Hz.

    With several contact wires, what each of them carries of the latter, so that it is seen where
    the head goes from one to the next. Supports are lines numbered on the upper axis, droppers
    ticks at the lower edge, the analysed section is shaded, losses of contact are marked on the
    zero line.
    """
    first, shown = views[0], series(views)
    single = len(shown) == 1
    figure = Drawing(style.layout(480, top=76))
    curves = sum(3 + len(item.force.shares) for item in shown)
    for item in shown:
        if not item.force.is_empty:
            _add_force_curves(figure, item, share(curves), single=single)
    _add_losses(figure, shown)
    add_line_marks(figure, first.run, first.section)
    figure.update_layout(
        xaxis=style.axis("position along the track [m]", showgrid=False, range=_opening(first)),
        yaxis=style.axis(
            "contact force [N]", zeroline=True, zerolinecolor=style.SOFT, rangemode="tozero"
        ),
    )
    return style.fit_legend(figure)


def _opening(view: RunView) -> list[float]:
    """Return the part of the line that is shown first: the section and a little more."""
    start, end = view.section
    margin = 0.02 * (end - start)
    return [start - margin, end + margin]


def _add_force_curves(figure: Drawing, item: Series, limit: int, *, single: bool) -> None:
    """Add the three curves of one pantograph.

    Of several series only the filtered curves show at first; one entry of the legend switches
    all unfiltered ones, another all up to 200 Hz.
    """
    look, force, cutoff = style.look(item.number), item.force, item.view.lowpass.cutoff
    raw = {"color": style.RAW if single else look.colour, "width": 1 if single else 0.7}
    wide = {"color": style.WIDE if single else look.colour, "width": 1.1}
    curves: list[tuple[str, Array | None, dict[str, Any], bool]] = [
        ("unfiltered", force.raw, raw, single),
        (f"0–{WIDE_CUTOFF:g} Hz", force.wide, wide, False),
    ]
    for name, values, line, is_shown in curves:
        if values is not None:
            _add_curve(
                figure,
                force.position,
                values,
                limit,
                name=name,
                line=line,
                legendgroup=name,
                showlegend=item.number == 0,
                visible=True if is_shown else "legendonly",
            )
    line = {"color": look.colour, "width": 2.2, "dash": look.dash}
    name = item.named(f"0–{cutoff:g} Hz")
    _add_curve(figure, force.position, force.low, limit, name=name, line=line)
    for number, (wire, values) in enumerate(force.shares.items(), 1):
        _add_curve(
            figure,
            force.position,
            values,
            limit,
            name=item.named(f"0–{cutoff:g} Hz on {wire}"),
            line={"color": style.look(item.number + number).colour, "width": 1.4, "dash": "dash"},
            visible=True if single else "legendonly",
        )


def _add_curve(figure: Drawing, position: Array, force: Array, limit: int, **more: Any) -> None:
    kept = thinned(force, limit)
    figure.add_scatter(
        **even(position[kept].astype(np.float32)),
        y=force[kept].astype(np.float32),
        mode="lines",
        hovertemplate="%{y:.0f} N",
        **more,
    )


def _add_losses(figure: Drawing, shown: Sequence[Series]) -> None:
    """Mark the losses of contact of all series on the zero line."""
    found = [
        (event, item.named(""))
        for item in shown
        for event in item.view.statistics.pantographs[
            item.view.forces.index(item.force)
        ].contact_loss.events
    ]
    if not found:
        return
    figure.add_scatter(
        x=[event.position for event, _ in found],
        y=[0.0] * len(found),
        mode="markers",
        name="contact loss",
        marker={"symbol": "x", "size": 9, "color": style.SLACK, "line": {"width": 1}},
        text=[f"{1e3 * e.duration:.1f} ms at {e.place} {who}" for e, who in found],
        hovertemplate="%{text}",
    )


def add_line_marks(figure: Drawing, run: Run, section: tuple[float, float]) -> None:
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
    ends = [shape.mast_x[0], shape.mast_x[-1]]
    figure.add_scatter(
        x=ends, y=[None, None], xaxis="x9", showlegend=False, hoverinfo="skip", mode="lines"
    )
    figure.add_vrect(
        x0=section[0], x1=section[1], fillcolor=style.SECTION, line={"width": 0}, layer="below"
    )
    figure.update_layout(
        xaxis9=style.support_axis(shape.mast_x.tolist(), run.case.line.support_marks()),
        yaxis9={"overlaying": "y", "range": [0, 1], "visible": False, "fixedrange": True},
    )


def spectrum_figure(views: Sequence[RunView]) -> Drawing:
    """Draw the amplitude spectrum of the unfiltered force over the analysed section.

    The frequencies at which spans and dropper intervals are passed are marked.
    """
    shown = series(views)
    figure, peaks = Drawing(style.layout(430, top=76)), []
    for item in shown:
        spectrum = section_spectrum(item)
        if spectrum is None:
            continue
        peaks.append(float(spectrum.value[1:].max()))
        look = style.look(item.number)
        kept = spectrum.abscissa <= WIDEST
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
        yaxis=style.axis(
            "amplitude [N]", type="log", dtick=1, exponentformat="none", range=_decades(peaks)
        ),
    )
    if len(speeds) == 1:
        lines = passings(views[0])
        _add_passing_lines(figure, lines)
        _add_wavelength_axis(figure, speeds.pop(), lines[0].length)
    return style.fit_legend(figure)


def _decades(peaks: Sequence[float]) -> list[float]:
    """Return the limits of the logarithmic axis: three and a half decades below the peak."""
    top = float(np.log10(max([*peaks, 1e-6]))) + 0.25
    return [top - 3.75, top]


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
    case, section = view.run.case, view.statistics.section
    found = recurring(expand(case), section.first_span, section.last_span)
    pairs = {"droppers": found.between, "support to dropper": found.beside}
    lengths = {name: length for name, length in pairs.items() if length is not None}
    speed = case.scenario.speed
    spans_only = passing_lines({"span": found.span}, speed, WIDEST)
    return (*spans_only, *passing_lines(lengths, speed, WIDEST, orders=2))


def _add_passing_lines(figure: Drawing, lines: Sequence[PassingLine]) -> None:
    heights = {"span": 0.99, "droppers": 0.99, "support to dropper": 0.92}
    for line in lines:
        name = line.name if line.order == 1 else f"{line.name} / {line.order}"
        figure.add_vline(x=line.frequency, line={"color": style.SOFT, "width": 1, "dash": "dot"})
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


def _add_wavelength_axis(figure: Drawing, speed: float, span: float) -> None:
    """Add an upper axis with wavelengths; it needs a curve of its own to be drawn."""
    lengths = style.wavelengths(span)
    figure.add_scatter(
        x=[0, WIDEST], y=[None, None], xaxis="x9", showlegend=False, hoverinfo="skip"
    )
    figure.update_layout(
        xaxis9={
            "overlaying": "x",
            "matches": "x",
            "side": "top",
            "title": {"text": "wavelength [m]", "standoff": 4, "font": {"size": 12}},
            "tickmode": "array",
            "tickvals": [speed / length for length in lengths],
            "ticktext": [f"{length:g}" for length in lengths],
            "tickfont": {"size": 11, "color": style.SOFT},
            "ticks": "outside",
            "ticklen": 3,
            "showgrid": False,
            "zeroline": False,
        }
    )


def histogram_figure(views: Sequence[RunView]) -> Drawing:
    """Draw the distribution of the low-passed force beside the normal one of equal mean and σ."""
    shown = series(views)
    figure = Drawing(style.layout(330, top=40, hovermode="closest", barmode="group"))
    for item in shown:
        headline = _headline(item)
        if headline.histogram.share.size:
            (_add_bars if len(shown) == 1 else _add_outline)(figure, item, headline)
    figure.update_layout(
        xaxis=style.axis("contact force [N]", showgrid=False),
        yaxis=style.axis("share of time [%]", rangemode="tozero"),
        bargap=0.15,
    )
    return style.fit_legend(figure, 380)


def _add_bars(figure: Drawing, item: Series, headline: FilteredStatistics) -> None:
    """Draw the distribution of a single series as bars, with the normal one."""
    edges, share = headline.histogram.edges, 100.0 * headline.histogram.share
    look, width = style.look(item.number), float(edges[1] - edges[0])
    figure.add_bar(
        x=edges[:-1] + 0.5 * width,
        y=share,
        name="simulated",
        marker=style.filling(look),
        hovertemplate="%{x:.0f} N: %{y:.1f} %<extra></extra>",
    )
    deviation = max(headline.standard_deviation, 1e-9)
    force = np.linspace(edges[0] - 2 * width, edges[-1] + 2 * width, 160)
    normal = np.exp(-0.5 * ((force - headline.mean) / deviation) ** 2) / np.sqrt(2 * np.pi)
    figure.add_scatter(
        x=force.astype(np.float32),
        y=(100 * width * normal / deviation).astype(np.float32),
        mode="lines",
        name="normal, same mean and σ",
        line={"color": style.SLACK, "width": 1.8, "dash": "dot"},
        hoverinfo="skip",
    )


def _add_outline(figure: Drawing, item: Series, headline: FilteredStatistics) -> None:
    """Draw the distribution of one of several series as a line through the classes."""
    edges, share = headline.histogram.edges, 100.0 * headline.histogram.share
    look, middle = style.look(item.number), 0.5 * (edges[:-1] + edges[1:])
    figure.add_scatter(
        x=middle,
        y=share,
        mode="lines+markers",
        name=item.label,
        line={"color": look.colour, "width": 1.8, "dash": look.dash},
        marker={"symbol": look.symbol, "size": 6},
        hovertemplate="%{x:.0f} N: %{y:.1f} %",
    )


def _headline(item: Series) -> FilteredStatistics:
    """Return the headline statistics of a series."""
    index = item.view.forces.index(item.force)
    return item.view.statistics.pantographs[index].headline


def spans_figure(views: Sequence[RunView]) -> Drawing:
    """Draw mean, standard deviation and extremes of the low-passed force per span."""
    shown = series(views)
    figure = Drawing(style.layout(330, top=40, hovermode="closest"))
    for item in shown:
        rows, look = _headline(item).per_span, style.look(item.number)
        span = np.array([row.span for row in rows], dtype=float)
        span += 0.14 * (item.number - 0.5 * (len(shown) - 1))
        numbers = np.array([(r.mean, r.standard_deviation, r.maximum, r.minimum) for r in rows]).T
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
    )
    return style.fit_legend(figure, 380)
