"""The page that a crew takes out: what to set, to which length, and what it gains."""

from __future__ import annotations

import os
from pathlib import Path

from tautwire.analyses.survey.rank import Ranking
from tautwire.files import write_text
from tautwire.report.parts.blocks import Section, Table, Text
from tautwire.report.parts.recordings.rank import (
    CREW_HEAD,
    FIGURE_HEAD,
    crew_rows,
    figure_rows,
)
from tautwire.report.writers.html import render
from tautwire.version import __version__

TOLERANCE = 2.0
"""Tolerance of a fitted length [mm]. From memory: what a crew can set and measure on the line."""


def write_rank_page(ranking: Ranking, path: str | os.PathLike[str]) -> Path:
    """Write the crew's page as a single HTML file, completely or not at all.

    Parameters
    ----------
    ranking
    path
        File to write.
    """
    crew = Table(
        f"Unstrained dropper lengths, clamp to clamp, each to within {TOLERANCE:g} mm; heights "
        "at supports by the change. The first column is the order of effect on the contact force, "
        "the rows follow the line.",
        CREW_HEAD, "rlrrrrl", tuple(crew_rows(ranking)),
    )  # fmt: skip
    figures = Table("Force up to 20 Hz.", FIGURE_HEAD, "lrrrr", tuple(figure_rows(ranking)))
    note = Text(
        "Computed: a passage over the whole line with these corrections made; this is what they "
        "gain. Predicted: the sum of the changes that each makes after those before it, from "
        "passages over a few spans.",
        "note",
    )
    contents = [
        Section("corrections", "Corrections", (crew,)),
        Section("gain", "What they gain", (figures, note)),
    ]
    case = ranking.case
    masthead = {
        "title": f"Corrections of {case.name}",
        "description": case.title,
        "facts": {
            "Speed": f"{3.6 * case.scenario.speed:.0f} km/h",
            "Length": f"{ranking.length:.0f} m",
            "Passages": str(ranking.passages),
        },
        "version": __version__,
        "case_hash": case.hash(),
    }
    return write_text(path, render(contents, masthead))
