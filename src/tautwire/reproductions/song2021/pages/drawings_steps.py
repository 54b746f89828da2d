"""Figures of section V of the paper, drawn from this program's results."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from tautwire.report.drawing import Drawing
from tautwire.report.figures.panels import Curve, Panel, panel_figure
from tautwire.reproductions.song2021.pages.drawings import FORCE, POSITION
from tautwire.reproductions.song2021.pages.drawings_high import SAG, sag
from tautwire.reproductions.song2021.sections.irregular import (
    COARSE,
    FINE,
    FINEST,
    HEIGHTS,
    VARIABLE,
)
from tautwire.reproductions.song2021.sections.steps import (
    COUNTED_1,
    REFERENCE,
    StepRun,
    Trial,
    Wire,
)
from tautwire.results.equilibrium import Equilibrium

Array = NDArray[np.float64]

LABELS: Mapping[str, str] = {
    COARSE: "1 ms",
    VARIABLE: "variable step",
    FINE: "0.2 ms",
    FINEST: "0.05 ms",
}
"""Ways to step that are drawn, in the order of their looks."""

AROUND = 0.012
"""Time shown before a loss; twice as much after it [s]."""

BESIDE = 4e-3
"""Time shown to either side of a separation [s]."""


def separation(wire: Wire, when: float) -> Drawing:
    """Draw Fig. 16 from a separation: the undivided step, the line through it, where it was cut.

    Parameters
    ----------
    wire
    when
        About when contact is lost [s].
    """
    variable, coarse = wire.runs[VARIABLE], wire.runs[COARSE]
    located = float(variable.separations[np.argmin(np.abs(variable.separations - when))])
    at = int(np.searchsorted(variable.time, located)) - 1
    begin, end = float(variable.time[at]), float(variable.time[at + 1])
    first = int(np.argmin(np.abs(coarse.time - begin)))
    line = slice(first, first + 2)
    divided = [(begin, -1e6 * variable.gap[at]), (located, 0.0), (end, -1e6 * variable.gap[at + 1])]
    curves = [
        _depth("1 ms", coarse, begin, 0, mode="lines+markers"),
        Curve("line through the step", 1e3 * (coarse.time[line] - begin),
              -1e6 * coarse.gap[line], 1, width=3.0),
        Curve("divided step", [1e3 * (t - begin) for t, _ in divided],
              [depth for _, depth in divided], 2, "markers"),
        _depth("0.05 ms", wire.runs[FINEST], begin, 3, width=1.0),
    ]  # fmt: skip
    marks = {"located": 1e3 * (located - begin)}
    more = {"zeroline": True, "zerolinecolor": "#55616e"}
    title = f"separation at t = {located:.5f} s"
    return panel_figure([Panel(title, curves, "penetration [µm]", None, marks, more)],
                        "time from the begin of the step [ms]", 380)  # fmt: skip


def _depth(
    name: str, run: StepRun, begin: float, look: int, *, mode: str = "lines", width: float = 1.4
) -> Curve:
    near = np.abs(run.time - begin) <= BESIDE
    return Curve(name, 1e3 * (run.time[near] - begin), -1e6 * run.gap[near], look, mode, width)


def irregular_presag(
    trials: Sequence[Trial], ideal: Equilibrium, section: tuple[float, float]
) -> Drawing:
    """Draw Fig. 17: the running surface with each irregularity, beside the ideal line.

    Parameters
    ----------
    trials
        One per irregularity.
    ideal
        Static state of the ideal line.
    section
        Part shown [m].
    """
    x = ideal.contact_position[:, 0]
    level = sag(ideal)
    panels: list[Panel] = []
    deviations: list[Curve] = []
    for number, trial in enumerate(trials, 1):
        wire = trial.wires[0]
        heights = sag(wire.shape)
        if wire.drawn.is_uneven:
            heights = heights + 1e3 * np.interp(x, wire.drawn.surface_x, wire.drawn.surface_height)
        name = "heights at droppers" if trial.kind == HEIGHTS else "running surface"
        curves = [Curve("ideal", x, level, 0), Curve(name, x, heights, number, dash="solid")]
        panels.append(Panel(f"{name}, seed {wire.drawn.seed}", curves, SAG, section))
        deviations.append(Curve(name, x, heights - level, number, width=1.0, dash="solid"))
    panels.append(Panel("deviation from the ideal line", deviations, "deviation [mm]", section))
    return panel_figure(panels, POSITION, 230, shared=True)


def step_forces(wire: Wire, whens: Sequence[float]) -> Drawing:
    """Draw Fig. 18: the unfiltered force by time step, and enlarged around losses.

    Parameters
    ----------
    wire
    whens
        When the enlarged losses begin [s].
    """
    curves = [
        Curve(label, wire.runs[step].time, wire.runs[step].force, number, width=0.8, dash="solid")
        for number, (step, label) in enumerate(LABELS.items())
    ]
    time = wire.runs[COARSE].time
    panels = [Panel("analysed section", curves, FORCE, (float(time[0]), float(time[-1])))]
    for when in whens:
        shown = [_cut(curve, when) for curve in curves]
        limits = (when - AROUND, when + 2.0 * AROUND)
        panels.append(Panel(f"around t = {when:.3f} s", shown, FORCE, limits))
    return panel_figure(panels, "time [s]", 280)


def _cut(curve: Curve, when: float) -> Curve:
    """Cut a curve around an instant; samples of 1 ms are marked."""
    x, y = np.asarray(curve.x), np.asarray(curve.y)
    near = np.abs(x - when) <= 3.0 * AROUND
    mode = "lines+markers" if curve.look < 2 else "lines"
    return Curve(curve.name, x[near], y[near], curve.look, mode, 1.2, "solid")


def telling_losses(wire: Wire) -> tuple[float, ...]:
    """Choose losses to enlarge: the longest, and one that 1 ms does not see or counts worst.

    Parameters
    ----------
    wire
    """
    match = wire.against(REFERENCE)[COUNTED_1]
    if not match.judged:
        return ()
    longest = max(match.judged, key=lambda pair: pair.reference.duration).reference
    others = [e for e in match.missed if abs(e.start - longest.start) > 3.0 * AROUND]
    if not others:
        pairs = sorted(match.judged, key=lambda pair: pair.error)
        others = [p.reference for p in pairs if abs(p.reference.start - longest.start) > 3 * AROUND]
    return longest.start, *(event.start for event in others[-1:])
