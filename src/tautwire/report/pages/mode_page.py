"""A page about modes: their table, shapes and spectra, beside the spectrum of the pre-sag."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np

from tautwire.analyses.vibration.wavelengths import (
    LineLengths,
    line_lengths,
    name_peaks,
    presag_spectrum,
)
from tautwire.files import write_text
from tautwire.report.figures.mode_figures import mode_figure, mode_spectrum_figure, spectrum_figure
from tautwire.report.parts.blocks import Heading, Section, Table, Text
from tautwire.report.parts.sections import chart
from tautwire.report.parts.words import number
from tautwire.report.writers.html import render
from tautwire.report.writers.project import project_block
from tautwire.results.equilibrium import Equilibrium
from tautwire.results.modes import Modes
from tautwire.specs.case import Case
from tautwire.version import __version__

MOST_SHAPES = 6
"""Modes whose shapes are drawn: a page of a screen or two; the table has all."""


def write_modes_report(
    case: Case, shape: Equilibrium, found: Modes, path: str | os.PathLike[str]
) -> Path:
    """Write a page about modes as a single HTML file, completely or not at all.

    Parameters
    ----------
    case
    shape
        Static state.
    found
    path
        File to write.

    Returns
    -------
    Path
        The file.
    """
    lengths = line_lengths(case)
    contents = [
        _summary(found, lengths),
        _shapes(found, case, shape, lengths),
        _presag(case, shape, lengths),
    ]
    return write_text(path, render(contents, _masthead(case, found)))


def _masthead(case: Case, found: Modes) -> dict[str, Any]:
    facts = {
        "Line": f"{case.line.spans} spans, {case.line.length():g} m",
        "Mesh": case.settings.mesh(),
        "Modes": str(len(found.frequencies)),
    }
    if len(found.frequencies):
        facts["Frequencies"] = f"{found.frequencies[0]:.3f} to {found.frequencies[-1]:.3f} Hz"
    return {
        "title": f"{case.title or case.name}: modes",
        "description": "",
        "facts": facts,
        "project": project_block(case.project),
        "version": __version__,
        "case_hash": case.hash()[:12],
    }


def _summary(found: Modes, lengths: LineLengths) -> Section:
    rows = tuple(
        (
            f"{found.frequencies[i]:.4f}",
            number(float(found.wavelengths[i]), 3),
            *(f"{100 * share:.1f}" for share in found.shares[i]),
            f"{found.residuals[i]:.0e}",
        )
        for i in found.ranked()
    )
    head = ("frequency [Hz]", "sensitive wavelength [m]", "contact x [%]", "contact y [%]",
            "contact z [%]", "messenger x [%]", "messenger y [%]", "messenger z [%]",
            "residual")  # fmt: skip
    table = Table(
        "Modes, most vertical contact wire first; shares of the kinetic energy by wire and "
        "direction (x along the track, y lateral, z vertical).",
        head,
        "r" * len(head),
        rows,
    )
    checks = Text(
        f"Undamped, droppers taut. Mass-orthogonality {found.orthogonality:.1e}, largest residual "
        f"{found.residuals.max(initial=0.0):.1e}; {found.counted} modes counted by inertia.",
        "note",
    )
    named = ", ".join(f"{name} {value:.4g} m" for name, value in lengths.named().items())
    return Section("summary", "Modes", (table, checks, Text(f"Lengths of the line: {named}.")))


def _shapes(found: Modes, case: Case, shape: Equilibrium, lengths: LineLengths) -> Section:
    blocks: list[object] = []
    named, marks = lengths.named(elements=False), case.line.support_marks()
    for i in found.ranked()[:MOST_SHAPES].tolist():
        title = f"{found.frequencies[i]:.3f} Hz"
        spectrum = mode_spectrum_figure(found, i, named)
        blocks += [
            Heading(f"{title}, sensitive to {found.wavelengths[i]:.3f} m"),
            chart(
                f"mode-{i}",
                mode_figure(found, i, shape.mast_x, marks),
                f"Vertical mode shape of all wires at {title}.",
                "Curves of the mode shape over the line.",
            ),
            chart(
                f"mode-spectrum-{i}",
                spectrum,
                f"Spectrum of the vertical contact-wire shape at {title}, Hann window over the "
                "whole line.",
                "Amplitude over wave number.",
            ),
        ]
    return Section("shapes", "Shapes and their spectra", tuple(blocks) or (Text("None."),))


def _presag(case: Case, shape: Equilibrium, lengths: LineLengths) -> Section:
    first, last = case.resolved_section()
    spectrum = presag_spectrum(shape, (first, last))
    named = lengths.named(elements=False)
    peaks = name_peaks(spectrum, named, count=20, above=1.5 / lengths.span)
    rows = tuple(
        (f"{p.abscissa:.4f}", f"{1.0 / p.abscissa:.3f}", f"{1e3 * p.value:.4f}", p.name)
        for p in peaks
        if np.isfinite(p.value)
    )
    blocks = (
        chart(
            "presag",
            spectrum_figure({"": spectrum}, named, "amplitude [mm]", scale=1e3),
            f"Spectrum of the static height of the contact wire, spans {first} to {last}, Hann "
            "window. The ideal line is periodic, so it consists of multiples of one per span.",
            "Amplitude of the pre-sag over wave number.",
        ),
        Table(
            "Highest peaks of the pre-sag spectrum.",
            ("wave number [1/m]", "wavelength [m]", "amplitude [mm]", "length of the line"),
            "rrrl",
            rows,
        ),
    )
    return Section("presag", "Pre-sag", blocks)
