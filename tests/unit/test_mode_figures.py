"""Figures of modes, spectra over wave number, the contact spring and the wire's motion."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tautwire.analyses.vibration.contact_wire import wavenumber_spectrum
from tautwire.analyses.vibration.space_time import SpaceTime
from tautwire.report.figures import mode_figures
from tautwire.results.modes import Modes, ModeWire


@pytest.fixture
def waves() -> Modes:
    """Two made-up modes with wavelengths of 2.875 and 5 m."""
    x = np.arange(0.0, 110.0, 0.25)
    shapes = np.stack([np.sin(2.0 * np.pi * x / length) for length in (2.875, 5.0)])
    moves = np.zeros((2, x.size, 3))
    moves[:, :, 2] = shapes
    wires = (ModeWire("contact", x, moves), ModeWire("messenger", x, 0.0 * moves))
    shares = np.zeros((2, 6))
    shares[:, 2] = 1.0
    return Modes(
        "made up", "0", np.array([44.0, 45.0]), wires, x, shapes, shares,
        np.array([2.875, 5.0]), np.zeros(2), 0.0, 2,
    )  # fmt: skip


def traces(figure: Any) -> dict[str, Any]:
    """Return the curves of a figure by name, checked by plotly."""
    return {trace.name: trace for trace in figure.to_figure().data if trace.name}


def test_mode_shape(waves: Modes) -> None:
    """All wires are drawn one above the other, the larger scaled to 1."""
    drawn = traces(mode_figures.mode_figure(waves, 0, np.array([0.0, 55.0, 110.0]), "123"))
    assert set(drawn) == {"contact", "messenger"}
    assert np.abs(drawn["contact"].y).max() == pytest.approx(1.0)
    assert np.allclose(drawn["messenger"].y, 2.4)


def test_mode_spectrum_peaks_at_its_wavelength(waves: Modes) -> None:
    """The spectrum of a mode peaks at its wavelength, where the length of the line is marked."""
    figure = mode_figures.mode_spectrum_figure(waves, 0, {"DD/2": 2.875, "mast": 0.1}).to_figure()
    curve = figure.data[0]
    assert 1.0 / curve.x[np.argmax(curve.y)] == pytest.approx(2.875, rel=0.02)
    assert [note.text for note in figure.layout.annotations] == ["DD/2"]
    assert figure.layout.shapes[0].x0 == pytest.approx(1.0 / 2.875)


def test_spectra_side_by_side() -> None:
    """Several spectra share a figure with a logarithmic axis, each named."""
    x = np.arange(400) * 0.25
    spectra = {
        name: wavenumber_spectrum(np.sin(2.0 * np.pi * x / length), 0.25)
        for name, length in (("short", 2.0), ("long", 10.0))
    }
    figure = mode_figures.spectrum_figure(spectra, {}, "amplitude [mm]", scale=1e3)
    assert set(traces(figure)) == {"short", "long"}
    assert figure.layout["yaxis"]["type"] == "log"


def test_space_time_map() -> None:
    """A large map is thinned and keeps to the section; the path of the pantograph is drawn."""
    time, x = np.linspace(0.0, 5.0, 1000), np.linspace(0.0, 900.0, 1300)
    motion = SpaceTime(time, x, np.outer(np.sin(time), np.cos(x)), {"front": 80.0 * time})
    figure = mode_figures.space_time_figure(motion, (200.0, 500.0))
    heat = figure.to_figure().data[0]
    assert heat.x.min() >= 200.0
    assert heat.x.max() <= 500.0
    assert heat.z.shape == (len(heat.y), len(heat.x))
    assert max(heat.z.shape) <= mode_figures.MAP_POINTS
    assert heat.zmax == -heat.zmin
    assert "front" in traces(figure)
