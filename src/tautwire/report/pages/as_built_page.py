"""A page about a line as built: findings, heights, droppers."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np

from tautwire.analyses.survey.as_built import AsBuilt
from tautwire.files import write_text
from tautwire.report.figures.panels import Curve, Panel, panel_figure
from tautwire.report.parts.blocks import Callout, Section, Table, Text
from tautwire.report.parts.recordings.as_built import (
    DROPPER_HEAD,
    SUPPORT_HEAD,
    dropper_rows,
    finding_lines,
    summary_rows,
    support_rows,
)
from tautwire.report.parts.sections import chart
from tautwire.report.writers.html import render
from tautwire.version import __version__


def write_as_built_page(built: AsBuilt, path: str | os.PathLike[str]) -> Path:
    """Write a page about a line as built as a single HTML file, completely or not at all.

    Parameters
    ----------
    built
    path
        File to write.
    """
    findings = tuple(f"{line[:1].upper()}{line[1:]}." for line in finding_lines(built))
    blocks: list[object] = [
        Callout(findings) if findings else Text("No dropper hangs in the wrong place."),
        Table("", ("", ""), "ll", tuple(summary_rows(built))),
        *(Text(f"{note[:1].upper()}{note[1:]}.", "note") for note in built.survey.notes),
    ]
    droppers = Table(
        "Unstrained lengths. A slack dropper is at least as long as the distance that it spans.",
        DROPPER_HEAD, "rrrrrrrrl", tuple(dropper_rows(built)),
    )  # fmt: skip
    supports = Table("", SUPPORT_HEAD, "r" * len(SUPPORT_HEAD), tuple(support_rows(built)))
    contents = [
        Section("findings", "What the survey tells", tuple(blocks)),
        Section("changes", "Changes from the design", (_changes(built),)),
        Section("droppers", "Droppers", (droppers,)),
        Section("supports", "Supports", (supports,)),
    ]
    return write_text(path, render(contents, _masthead(built)))


def _changes(built: AsBuilt) -> Any:
    x = np.array([one.x for one in built.droppers])
    change = np.array([1e3 * (one.length - one.design) for one in built.droppers])
    error = np.array([1e3 * one.error for one in built.droppers])
    curves = [
        Curve("as built less design", x, change),
        Curve("plus two standard errors", x, change + 2.0 * error),
        Curve("less two standard errors", x, change - 2.0 * error),
    ]
    panel = Panel("dropper lengths", curves, "change of length [mm]")
    return chart(
        "changes",
        panel_figure([panel], "distance from support 1 [m]"),
        "Estimated lengths of the droppers less those of the design, and two standard errors to "
        "either side.",
        "Curve of the change of the dropper lengths over the distance.",
    )


def _masthead(built: AsBuilt) -> dict[str, Any]:
    return {
        "title": f"{built.case.name} as built",
        "description": built.case.title,
        "facts": {
            "Spans": str(built.case.line.spans),
            "Droppers": str(len(built.droppers)),
            "Readings": str(len(built.survey.readings)),
        },
        "version": __version__,
        "case_hash": built.case.hash(),
    }
