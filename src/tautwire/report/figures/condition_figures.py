"""Figures of the conditions of a line over each other."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tautwire.report.drawing import Drawing
from tautwire.report.figures import style
from tautwire.results.design.conditions import ConditionState
from tautwire.results.equilibrium import Equilibrium

Array = NDArray[np.float64]
Curve = Callable[[ConditionState], tuple[Array, Array]]


def lateral_figure(states: Sequence[ConditionState]) -> Drawing:
    """Draw the lateral position of the first contact wire, to the left positive."""
    return _over_line(states, _wire(1, 1e3), "lateral position [mm]", "%{y:.0f} mm")


def height_figure(states: Sequence[ConditionState]) -> Drawing:
    """Draw the height of the first contact wire."""
    return _over_line(states, _wire(2, 1.0), "height [m]", "%{y:.4f} m")


def dropper_figure(states: Sequence[ConditionState]) -> Drawing:
    """Draw the forces of the droppers."""

    def forces(state: ConditionState) -> tuple[Array, Array]:
        shape = _shape(state)
        return shape.dropper_x, shape.dropper_forces

    return _over_line(states, forces, "dropper force [N]", "%{y:.1f} N", mode="markers")


def elasticity_figure(states: Sequence[ConditionState]) -> Drawing:
    """Draw the elasticity, where it was computed."""

    def values(state: ConditionState) -> tuple[Array, Array]:
        found = state.elasticity
        none = np.empty(0)
        return (none, none) if found is None else (found.x, 1e3 * found.elasticity)

    return _over_line(states, values, "elasticity [mm/N]", "%{y:.3f} mm/N")


def _shape(state: ConditionState) -> Equilibrium:
    assert state.shape is not None
    return state.shape


def _wire(axis: int, scale: float) -> Curve:
    def curve(state: ConditionState) -> tuple[Array, Array]:
        position = _shape(state).contact.position
        return position[:, 0], scale * position[:, axis]

    return curve


def _over_line(
    states: Sequence[ConditionState], curve: Curve, title: str, hover: str, mode: str = "lines"
) -> Drawing:
    """Draw one curve per state over the line."""
    figure = Drawing(style.layout(360, top=64))
    for number, state in enumerate(states):
        look = style.look(number)
        x, y = curve(state)
        line: dict[str, Any] = {"color": look.colour, "width": 1.5, "dash": look.dash}
        figure.add_scatter(
            x=x.astype(np.float32),
            y=y.astype(np.float32),
            name=state.name,
            mode=mode,
            line=line,
            marker={"color": look.colour, "symbol": style.SYMBOLS[number % len(style.SYMBOLS)]},
            hovertemplate=hover,
        )
    figure.update_layout(xaxis=style.axis("position along the track [m]"), yaxis=style.axis(title))
    return style.fit_legend(figure)


def travel_figure(states: Sequence[ConditionState]) -> Drawing:
    """Draw how far the ends of wires travel over the temperature of the conditions."""
    figure = Drawing(style.layout(340, top=64))
    points: dict[str, list[tuple[float, float]]] = {}
    for state in states:
        operated = _shape(state).operated
        if operated is None or operated.condition.temperature is None:
            continue
        for end in state.ends:
            name = f"{end.wire}, {end.side}"
            points.setdefault(name, []).append((operated.condition.temperature, 1e3 * end.travel))
    moving = {name: sorted(own) for name, own in points.items() if any(y for _, y in own)}
    for number, (name, own) in enumerate(moving.items()):
        look = style.look(number)
        figure.add_scatter(
            x=[t for t, _ in own],
            y=[y for _, y in own],
            name=name,
            mode="lines+markers",
            line={"color": look.colour, "width": 1.5, "dash": look.dash},
            hovertemplate="%{x:g} °C: %{y:.1f} mm",
        )
    figure.update_layout(
        xaxis=style.axis("temperature [°C]"), yaxis=style.axis("travel of the end [mm]")
    )
    return style.fit_legend(figure)
