"""Figures of modes, of spectra over wave number, of the contact spring, of the wire's motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.analyses.vibration.modes import mode_spectrum
from tautwire.analyses.vibration.space_time import SpaceTime
from tautwire.report.drawing import Drawing
from tautwire.report.figures import style
from tautwire.report.figures.packing import thinned
from tautwire.results.modes import Modes
from tautwire.signals.spectra import Spectrum

Array = NDArray[np.float64]

MAP_POINTS = 400
"""Most points of a map along one axis."""


def mode_figure(modes: Modes, number: int, support_x: Array, marks: Sequence[str]) -> Drawing:
    """Draw the vertical shape of all wires in one mode, scaled to a largest value of 1.

    Parameters
    ----------
    modes
    number
        0-based.
    support_x : (n_support,) m
    marks
        What stands at each support.
    """
    figure = Drawing(style.layout(360, top=76))
    curves = [(wire.name, wire.s, wire.displacements[number, :, 2]) for wire in modes.wires]
    apart = 2.4  # shapes from -1 to 1, with room between neighbours
    largest = max(1e-300, *(float(np.abs(z).max()) for _, _, z in curves))
    for at, (name, x, z) in enumerate(curves):
        kept, offset = thinned(z), apart * at
        look = style.look(at)
        figure.add_scatter(
            x=x[kept].astype(np.float32),
            y=(z[kept] / largest + offset).astype(np.float32),
            name=name,
            mode="lines",
            line={"color": look.colour, "width": 1.1},
            hoverinfo="skip",
        )
    figure.update_layout(
        xaxis=style.axis("position along the track [m]", showgrid=False),
        xaxis9=style.support_axis(support_x.tolist(), marks),
        yaxis=style.axis(
            "vertical mode shape [1]",
            tickvals=[apart * at + z for at in range(len(curves)) for z in (-1, 0, 1)],
            ticktext=["−1", "0", "1"] * len(curves),
        ),
    )
    ends = [float(support_x[0]), float(support_x[-1])]
    figure.add_scatter(
        x=ends, y=[None, None], xaxis="x9", showlegend=False, hoverinfo="skip", mode="lines"
    )
    return figure


def mode_spectrum_figure(modes: Modes, number: int, lengths: Mapping[str, float]) -> Drawing:
    """Draw the spectrum of a mode's vertical contact-wire shape with the line's lengths named."""
    return spectrum_figure(
        {"": mode_spectrum(modes, number)},
        lengths,
        "amplitude [share of the largest]",
        is_log=False,
    )


def spectrum_figure(
    spectra: Mapping[str, Spectrum],
    lengths: Mapping[str, float],
    title: str,
    *,
    highest: float = 1.2,
    scale: float = 1.0,
    is_log: bool = True,
) -> Drawing:
    """Draw spectra over wave number, with the wavelength above and the line's lengths named.

    Parameters
    ----------
    spectra : mapping of str to Spectrum
        Label of the legend and spectrum over wave number.
    lengths
        Name and length [m] of what is marked.
    title
        Of the vertical axis.
    highest
        Upper end of the wave numbers [1/m].
    scale
        Factor of the values.
    is_log
        Whether the vertical axis is logarithmic.
    """
    figure = Drawing(style.layout(400, top=96))
    top = 0.0
    for at, (label, spectrum) in enumerate(spectra.items()):
        kept = (spectrum.abscissa <= highest) & (spectrum.abscissa > 0.0)
        look = style.look(at)
        values = scale * spectrum.value[kept]
        top = max(top, float(values.max(initial=0.0)))
        figure.add_scatter(
            x=spectrum.abscissa[kept].astype(np.float32),
            y=values.astype(np.float32),
            name=label,
            mode="lines",
            line={"color": look.colour, "width": 1.3, "dash": look.dash},
            showlegend=len(spectra) > 1,
            hovertemplate="%{x:.4f} 1/m: %{y:.4g}",
        )
    add_lengths(figure, lengths, highest)
    limits: dict[str, Any] = {"rangemode": "tozero"}
    if is_log:
        decade = float(np.log10(max(top, 1e-12))) + 0.3
        limits = {"type": "log", "range": [decade - 4.3, decade], "exponentformat": "power"}
    figure.update_layout(
        xaxis=style.axis("wave number [1/m]", range=[0, highest]), yaxis=style.axis(title, **limits)
    )
    _add_wavelengths(figure, highest, lengths.get("span"))
    return style.fit_legend(figure)


def add_lengths(figure: Drawing, lengths: Mapping[str, float], highest: float) -> None:
    """Mark the wave numbers of lengths with dotted lines and their names."""
    for at, (name, length) in enumerate(lengths.items()):
        if 1.0 / length <= highest:
            figure.add_vline(
                x=1.0 / length,
                line={"color": style.SOFT, "width": 1, "dash": "dot"},
            )
            figure.add_annotation(
                text=name,
                x=1.0 / length,
                y=1,
                xref="x",
                yref="y domain",
                xanchor="right" if at % 2 else "left",
                yanchor="top",
                showarrow=False,
                font={"size": 11, "color": style.SOFT},
            )


def _add_wavelengths(figure: Drawing, highest: float, span: float | None) -> None:
    """Add an upper axis with wavelengths; it needs a curve of its own to be drawn."""
    shown = [length for length in style.wavelengths(span) if 1.0 / length <= highest]
    figure.add_scatter(
        x=[0, highest], y=[None, None], xaxis="x2", showlegend=False, hoverinfo="skip"
    )
    figure.update_layout(
        xaxis2={
            "overlaying": "x",
            "matches": "x",
            "side": "top",
            "title": {"text": "wavelength [m]", "standoff": 4, "font": {"size": 12}},
            "tickmode": "array",
            "tickvals": [1.0 / length for length in shown],
            "ticktext": [f"{length:g}" for length in shown],
            "tickfont": {"size": 11, "color": style.SOFT},
            "ticks": "outside",
            "ticklen": 3,
            "tickcolor": style.SUPPORT,
            "showgrid": False,
            "zeroline": False,
        }
    )


def space_time_figure(motion: SpaceTime, section: tuple[float, float]) -> Drawing:
    """Draw a map of the wire's vertical velocity over position and time.

    Parameters
    ----------
    motion
    section
        Part of the track to show [m].
    """
    inside = (motion.x >= section[0]) & (motion.x <= section[1])
    columns = _some(np.flatnonzero(inside))
    rows = _some(np.arange(len(motion.time)))
    shown = motion.velocity[np.ix_(rows, columns)]
    limit = float(np.percentile(np.abs(shown), 99.5)) or 1.0
    figure = Drawing(style.layout(560, top=60))
    figure.add(
        "heatmap",
        x=motion.x[columns].astype(np.float32),
        y=motion.time[rows].astype(np.float32),
        z=shown.astype(np.float32),
        zmin=-limit,
        zmax=limit,
        colorscale="RdBu_r",
        colorbar={"title": {"text": "m/s"}, "thickness": 14},
        hovertemplate="%{x:.1f} m, %{y:.3f} s: %{z:.3f} m/s<extra></extra>",
    )
    for name, path in motion.paths.items():
        figure.add_scatter(
            x=path[rows],
            y=motion.time[rows],
            name=name,
            mode="lines",
            line={"color": style.INK, "width": 1.2, "dash": "dot"},
            hoverinfo="skip",
        )
    figure.update_layout(
        hovermode="closest",
        xaxis=style.axis("position along the track [m]", range=list(section), showgrid=False),
        yaxis=style.axis("time [s]", showgrid=False),
    )
    return figure


def _some(numbers: NDArray[np.int64]) -> NDArray[np.int64]:
    """Thin out to at most :data:`MAP_POINTS`."""
    stride = max(1, -(-len(numbers) // MAP_POINTS))
    return numbers[::stride]
