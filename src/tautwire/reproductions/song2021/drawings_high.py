"""Figures of sections IV and V of the paper, drawn from this program's results."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from tautwire.report.panels import Curve, Figure, Panel, panel_figure
from tautwire.reproductions.song2021 import sources, steps
from tautwire.reproductions.song2021.cutoffs import Curves
from tautwire.reproductions.song2021.drawings import DEVIATION, FORCE, POSITION
from tautwire.reproductions.song2021.forces import Passages
from tautwire.reproductions.song2021.passages import SPEEDS, irregular
from tautwire.reproductions.song2021.vibration import Found
from tautwire.results.equilibrium import Equilibrium

Array = NDArray[np.float64]

AROUND = 0.012
"""Time shown to either side of a loss [s]."""


def presag(shapes: Mapping[str, Equilibrium], section: tuple[float, float]) -> Figure:
    """Draw Figs 10 and 17: how far the contact wire lies below the supports."""
    curves = []
    for number, (name, shape) in enumerate(shapes.items()):
        contact = shape.contact_position
        level = np.interp(contact[:, 0], shape.support_x, shape.support_heights)
        sag = 1e3 * (contact[:, 2] - level)
        curves.append(Curve(name, contact[:, 0], sag, number))
    panels = [Panel("", curves, "height over supports [mm]", section)]
    if len(shapes) == 2:
        first, second = (shape.contact_position for shape in shapes.values())
        off = Curve("deviation", first[:, 0], 1e3 * (first[:, 2] - second[:, 2]), 2)
        panels.append(Panel("deviation from the ideal line", [off], "deviation [mm]", section))
    return panel_figure(panels, POSITION, 260, shared=True)


def source_spectra(found: sources.Sources) -> Figure:
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
        more = {"type": "log", "exponentformat": "power"}
        title = f"({letter}) {label if is_presag else f'contact force at {label}'}"
        panels.append(Panel(title, [curve], f"amplitude [{unit}]", (0.05, 1.1), marks, more))
    return panel_figure(panels, "wave number [1/m]", 250, shared=True)


def mode(found: Found) -> Figure:
    """Draw Figs 13 and 14: shape of the contact wire and its spectrum."""
    shape = Curve("contact wire", found.x, found.shape, 0, width=1.0)
    spectrum = Curve("spectrum", found.wavenumber, found.amplitude, 1)
    marks = {f"{found.name} = {found.wanted:.4g} m": 1.0 / found.wanted}
    panels = [
        Panel("(a) vertical shape over the track [m]", [shape], "shape [1]"),
        Panel("(b) spectrum of the shape", [spectrum], "amplitude [1]", (0.0, 1.1), marks),
    ]
    return panel_figure(panels, "wave number [1/m]", 250)


def speed_curves(curves: Mapping[str, Curves]) -> Figure:
    """Draw Fig. 15, a panel per reading."""
    panels = []
    for name, own in curves.items():
        lines = [
            Curve(label, SPEEDS, values, number, "lines+markers")
            for number, (label, values) in enumerate(
                {"0–20 Hz": own.low, "0–0.9 1/m": own.suggested, "0–200 Hz": own.high}.items()
            )
        ]
        panels.append(Panel(name, lines, DEVIATION, more={"rangemode": "tozero"}))
    return panel_figure(panels, "speed [km/h]", 240)


def event(passages: Passages, stiffness: int, when: float) -> Figure:
    """Draw Fig. 16 from a separation: penetration, line through the step, located instant."""
    run = passages.run(irregular("1ms", stiffness))
    record = run.pantographs[0]
    at = int(np.searchsorted(run.time, when)) - 1
    shown = slice(max(0, at - 4), at + 5)
    time, depth = 1e3 * (run.time - run.time[at]), -1e6 * record.gap
    fine = passages.run(irregular("0.2ms", stiffness))
    near = np.abs(fine.time - run.time[at]) <= 5e-3
    curves = [
        Curve("time step 1 ms", time[shown], depth[shown], 0, "lines+markers"),
        Curve("line through the step", time[at : at + 2], depth[at : at + 2], 1, width=2.6),
        Curve("located instant", [1e3 * (when - run.time[at])], [0.0], 2, "markers"),
        Curve("time step 0.2 ms", 1e3 * (fine.time[near] - run.time[at]),
              -1e6 * fine.pantographs[0].gap[near], 3, width=1.0),
    ]  # fmt: skip
    more = {"zeroline": True, "zerolinecolor": "#55616e"}
    title = f"separation at t = {when:.4f} s"
    return panel_figure([Panel(title, curves, "penetration [µm]", None, {}, more)],
                        "time from the last step in contact [ms]", 360)  # fmt: skip


def step_forces(passages: Passages, stiffness: int, whens: tuple[float, ...]) -> Figure:
    """Draw Fig. 18: the force with both steps, and enlarged around losses."""
    names = {"1 ms": irregular("1ms", stiffness), "0.2 ms": irregular("0.2ms", stiffness)}
    variable = irregular("variable", stiffness)
    if passages.has(variable):
        names["variable step"] = variable
    curves = []
    for number, (label, name) in enumerate(names.items()):
        record = passages.run(name).pantographs[0]
        on = record.active
        time = passages.run(name).time[on]
        curves.append(Curve(label, time, record.contact_force[on], number, width=1.0))
    inside = passages.inside(names["1 ms"])
    time = passages.force(names["1 ms"]).time[inside]
    panels = [Panel("analysed section", curves, FORCE, (float(time[0]), float(time[-1])))]
    for when in whens:
        marks = {"located separation": when}
        own = [_cut(curve, when) for curve in curves]
        limits = (when - AROUND, when + 2.0 * AROUND)
        panels.append(Panel(f"around t = {when:.3f} s", own, FORCE, limits, marks))
    return panel_figure(panels, "time [s]", 270)


def _cut(curve: Curve, when: float) -> Curve:
    x, y = np.asarray(curve.x), np.asarray(curve.y)
    near = np.abs(x - when) <= 4.0 * AROUND
    mode = "lines" if curve.look else "lines+markers"
    return Curve(curve.name, x[near], y[near], curve.look, mode, curve.width)


def telling_losses(table: steps.LossTable) -> tuple[float, ...]:
    """Choose two losses to enlarge: a long one, and one that 1 ms counts badly or not at all."""
    located, counted = (table.durations[n] for n in (steps.LOCATED_1, steps.COUNTED_1))
    both = np.isfinite(located)
    if not both.any():
        return ()
    error = np.where(both, np.abs(np.nan_to_num(counted) - located) / located, -1.0)
    error = np.where(located > 1e-3, error, -1.0)
    long = int(np.nanargmax(np.where(both, located, np.nan)))
    return tuple(float(table.time[i]) for i in dict.fromkeys((long, int(np.argmax(error)))))
