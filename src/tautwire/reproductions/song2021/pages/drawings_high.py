"""Figures of sections IV and V of the paper, drawn from this program's results."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from tautwire.report.drawing import Drawing
from tautwire.report.figures.panels import Curve, Panel, panel_figure
from tautwire.reproductions.song2021 import sources
from tautwire.reproductions.song2021.claims import Condition
from tautwire.reproductions.song2021.pages.drawings import DEVIATION, POSITION
from tautwire.reproductions.song2021.passages import SPEEDS
from tautwire.reproductions.song2021.sections.cutoffs import Curves
from tautwire.reproductions.song2021.sections.vibration import Found
from tautwire.results.equilibrium import Equilibrium

Array = NDArray[np.float64]

SAG = "height over supports [mm]"


def presag(shape: Equilibrium, section: tuple[float, float]) -> Drawing:
    """Draw Fig. 10: how far the contact wire lies below the supports."""
    curve = Curve("contact wire", shape.contact_position[:, 0], sag(shape), 0)
    return panel_figure([Panel("", [curve], SAG, section)], POSITION, 260)


def sag(shape: Equilibrium) -> Array:
    """Return the height of the contact wire over its supports [mm]."""
    contact = shape.contact_position
    level = np.interp(contact[:, 0], shape.support_x, shape.support_heights)
    return 1e3 * (contact[:, 2] - level)


def source_spectra(found: sources.Sources) -> Drawing:
    """Draw Fig. 11 over wave number, DD, SD and their fractions marked."""
    marks = {f"{name} {value:.3g} m": 1.0 / value for name, value in found.lengths.items()}
    panels = []
    for letter, (label, own) in zip("abcd", found.combs.items(), strict=False):
        is_presag = label == sources.PRESAG
        scale, unit = (1e3, "mm") if is_presag else (1.0, "N")
        low = own.abscissa >= 0.05
        curve = Curve(
            "multiples of 1/span", own.abscissa[low], scale * own.value[low], 0, "lines+markers",
            1.0,
        )  # fmt: skip
        more = {"type": "log", "exponentformat": "power", "dtick": 1}
        title = f"({letter}) {label if is_presag else f'contact force at {label}'}"
        panels.append(Panel(title, [curve], f"amplitude [{unit}]", (0.05, 1.1), marks, more))
    return panel_figure(panels, "wave number [1/m]", 250, shared=True)


def mode(found: Found) -> Drawing:
    """Draw Figs 13 and 14: shape of the contact wire and its spectrum."""
    shape = Curve("contact wire", found.x, found.shape, 0, width=1.0)
    spectrum = Curve("spectrum", found.wavenumber, found.amplitude, 1, dash="solid")
    marks = {f"{found.name} = {found.wanted:.4g} m": 1.0 / found.wanted}
    panels = [
        Panel("(a) vertical shape over the track [m]", [shape], "shape [1]"),
        Panel("(b) spectrum of the shape", [spectrum], "amplitude [1]", (0.0, 1.1), marks),
    ]
    return panel_figure(panels, "wave number [1/m]", 250)


def speed_curves(curves: Mapping[Condition, Curves]) -> Drawing:
    """Draw Fig. 15, a panel per reading."""
    panels = []
    for condition, own in curves.items():
        lines = [
            Curve(label, SPEEDS, values, number, "lines+markers")
            for number, (label, values) in enumerate(
                {"0–20 Hz": own.low, "0–0.9 1/m": own.suggested, "0–200 Hz": own.high}.items()
            )
        ]
        panels.append(Panel(condition.text, lines, DEVIATION, more={"rangemode": "tozero"}))
    return panel_figure(panels, "speed [km/h]", 240)
