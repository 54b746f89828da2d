"""Figures of sections II and III of the paper, drawn from this program's passages."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from tautwire.report.drawing import Drawing
from tautwire.report.figures.panels import Curve, Panel, bar_figure, panel_figure
from tautwire.reproductions.song2021 import published
from tautwire.reproductions.song2021.passages import (
    MESHES,
    STIFFNESSES,
    Reading,
    standard,
)
from tautwire.reproductions.song2021.sections import mesh, stiffness
from tautwire.reproductions.song2021.sections.forces import Passages
from tautwire.results.equilibrium import Equilibrium

Array = NDArray[np.float64]

FORCE = "contact force [N]"
POSITION = "position along the track [m]"
DEVIATION = "standard deviation [N]"
FREQUENCY = "frequency [Hz]"
BANDS = ((0.0, 100.0), (100.0, 160.0), (160.0, 200.0), (200.0, 300.0))
"""Of Fig. 6 [Hz]."""


def two_spans(supports: Array) -> tuple[float, float]:
    """Return the limits of two spans in the middle of the line [m]."""
    middle = supports.size // 2
    return float(supports[middle - 1]), float(supports[middle + 1])


def configuration(shape: Equilibrium) -> Drawing:
    """Draw Fig. 3."""
    contact, messenger = shape.contact_position, shape.messenger_position
    number = np.searchsorted(shape.contact.s, shape.dropper_x - 1e-6)
    gap = np.full(number.size, np.nan)
    x = np.stack([shape.dropper_x, shape.dropper_x, gap], axis=1).ravel()
    z = np.stack([contact[number, 2], messenger[number, 2], gap], axis=1).ravel()
    y = [
        Curve("contact wire", contact[:, 0], contact[:, 1], 0, width=1.8),
        Curve("messenger wire", messenger[:, 0], messenger[:, 1], 1, width=1.8),
    ]
    side = [
        Curve("contact wire", contact[:, 0], contact[:, 2], 0, width=1.8),
        Curve("messenger wire", messenger[:, 0], messenger[:, 2], 1, width=1.8),
        Curve("droppers", x, z, 5, width=1.0, dash="solid"),
    ]
    return panel_figure(
        [Panel("side view", side, "height [m]"), Panel("plan", y, "lateral [m]")],
        POSITION,
        220,
        shared=True,
    )


def mesh_forces(passages: Passages, k: Reading) -> Drawing:
    """Draw Fig. 4."""
    supports = passages.run(standard(9, k)).equilibrium.support_x
    panels = []
    for letter, cutoff in (("a", 20.0), ("b", 200.0)):
        curves = []
        for number, m in enumerate(MESHES):
            name = standard(m, k)
            inside = passages.inside(name)
            position = passages.force(name).position[inside]
            force = passages.low_passed(name, cutoff)[inside]
            curves.append(Curve(f"NAD {m}", position, force, number))
        title = f"({letter}) low-passed at {cutoff:g} Hz"
        panels.append(Panel(title, curves, FORCE, two_spans(supports)))
    return panel_figure(panels, POSITION, 270, shared=True)


def mesh_bars(passages: Passages, k: Reading) -> Drawing:
    """Draw Fig. 5."""
    found = mesh.deviations(passages, k)
    series = {
        f"NAD {m}": [float(found[cutoff][number]) for cutoff in mesh.CUTOFFS]
        for number, m in enumerate(MESHES)
    }
    return bar_figure([f"0–{cutoff} Hz" for cutoff in mesh.CUTOFFS], series, DEVIATION)


def mesh_spectra(passages: Passages, k: Reading) -> Drawing:
    """Draw Fig. 6."""
    lines = {f"NAD {m}: {f:g}": f for m, pair in published.ELEMENT_PASSING.items() for f in pair}
    lines["NAD 9, n = 2: 247.3"] = 2.0 * published.ELEMENT_PASSING[9][0]
    panels = []
    for letter, (low, high) in zip("abcd", BANDS, strict=True):
        curves = []
        for number, m in enumerate(MESHES):
            spectrum = passages.spectrum(standard(m, k))
            band = (spectrum.abscissa >= low) & (spectrum.abscissa <= high)
            curves.append(Curve(f"NAD {m}", spectrum.abscissa[band], spectrum.value[band], number))
        marks = _apart({name: f for name, f in lines.items() if low < f < high}, high - low)
        title = f"({letter}) {low:g} to {high:g} Hz"
        panels.append(Panel(title, curves, "amplitude [N]", (low, high), marks))
    return panel_figure(panels, FREQUENCY, 250)


def _apart(marks: Mapping[str, float], width: float) -> dict[str, float]:
    """Write marks that lie closer than a hundredth of the width as one, at the first of them."""
    found: dict[str, float] = {}
    for name, place in sorted(marks.items(), key=lambda item: item[1]):
        last = next(reversed(found), None)
        if last is not None and place - found[last] < 0.01 * width:
            found[f"{last}, {name}"] = found.pop(last)
        else:
            found[name] = place
    return found


def stiffness_forces(passages: Passages, own: stiffness.Series) -> Drawing:
    """Draw Fig. 7."""
    supports = passages.run(own.names[0]).equilibrium.support_x
    low, high = two_spans(supports)
    curves = []
    for number, (k, name) in enumerate(zip(STIFFNESSES, own.names, strict=True)):
        position = passages.force(name).position
        shown = (position >= low) & (position <= high)
        force = passages.low_passed(name, 200.0)[shown]
        curves.append(Curve(f"{k} kN/m", position[shown], force, number))
    return panel_figure([Panel("0 to 200 Hz", curves, FORCE, (low, high))], POSITION, 380)


def stiffness_spectra(passages: Passages, own: stiffness.Series) -> Drawing:
    """Draw Fig. 8."""
    panels = []
    for letter, (low, high) in zip("ab", stiffness.BANDS, strict=True):
        curves = []
        for number, (k, name) in enumerate(zip(STIFFNESSES, own.names, strict=True)):
            found = mesh.force_comb(passages, name, 200.0)
            band = (found.abscissa >= low) & (found.abscissa <= high)
            curves.append(Curve(f"{k} kN/m", found.abscissa[band], found.value[band], number))
        title = f"({letter}) {low:g} to {high:g} Hz"
        panels.append(Panel(title, curves, "amplitude [N]", (low, high)))
    return panel_figure(panels, FREQUENCY, 290)


def stiffness_curves(passages: Passages) -> Drawing:
    """Draw Fig. 9 for every line and mesh with all stiffnesses."""
    panels = []
    for own in stiffness.computed(passages):
        curves = [
            Curve(f"0–{cutoff} Hz", STIFFNESSES, stiffness.deviations(passages, own, cutoff),
                  number, "lines+markers")
            for number, cutoff in enumerate(stiffness.CUTOFFS)
        ]  # fmt: skip
        panels.append(Panel(str(own), curves, DEVIATION, more={"rangemode": "tozero"}))
    return panel_figure(panels, "contact stiffness [kN/m]", 300)
