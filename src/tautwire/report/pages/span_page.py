"""A page about longest spans over radius and wind."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from tautwire.assessment.span_table import SpanRow
from tautwire.files import write_text
from tautwire.report.figures.design_figures import span_figure
from tautwire.report.parts.blocks import Section, Table, Text
from tautwire.report.parts.design.span_words import LEGEND, span_head, span_notes, span_rows
from tautwire.report.parts.sections import chart
from tautwire.report.writers.html import render
from tautwire.specs.span_table import SpanTable
from tautwire.version import __version__


def write_span_page(spec: SpanTable, rows: Sequence[SpanRow], path: str | os.PathLike[str]) -> Path:
    """Write a table of longest spans as a single HTML file, completely or not at all.

    Parameters
    ----------
    spec
        What was asked for.
    rows
        One per radius.
    path
        File to write.

    Returns
    -------
    Path
        The file.
    """
    winds = spec.wind.speeds
    caption = "Longest span over the radius, one curve per wind; straight track at the right edge."
    blocks = (
        Table(f"Longest span; {LEGEND}.", span_head(spec), "r" * (3 + len(winds)),
              tuple(span_rows(rows))),
        chart("spans", span_figure(rows, winds), caption, caption),
        *(Text(note, "note") for note in span_notes(spec)),
    )  # fmt: skip
    wires = ", ".join(f"{1e3 * d:g} mm" for d in spec.wires.diameters)
    masthead = {
        "title": spec.title or spec.name,
        "description": "",
        "facts": {
            "Wires": f"{1e-3 * spec.wires.tension:g} kN, {wires}",
            "Wind": ", ".join(f"{wind:g} m/s" for wind in winds),
            "Drag": f"{spec.wind.drag:g}, further factors {spec.wind.factor:g}",
        },
        "project": None,
        "version": __version__,
        "case_hash": "",
    }
    return write_text(path, render([Section("spans", "Longest spans", blocks)], masthead))
