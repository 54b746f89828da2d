"""The page that a crew takes out: what to set, to which length, and what it changes."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from tautwire.analyses.survey.rank import Ranking
from tautwire.files import write_text
from tautwire.report.parts.blocks import Callout, Section, Table, Text
from tautwire.report.parts.recordings.rank import (
    CREW_HEAD,
    FIGURE_GROUPS,
    FIGURE_HEAD,
    RISES,
    crew_rows,
    figure_rows,
    worse_lines,
)
from tautwire.report.parts.words import counted
from tautwire.report.writers.html import render
from tautwire.version import __version__

TOLERANCE = 2.0
"""Tolerance of a fitted length [mm]. From memory: what a crew can set and measure on the line."""


def write_rank_page(rankings: Sequence[Ranking], path: str | os.PathLike[str]) -> Path:
    """Write the crew's page as a single HTML file, completely or not at all.

    Parameters
    ----------
    rankings : sequence of Ranking
        One per tension length.
    path
        File to write.
    """
    crew = Table(
        f"Unstrained dropper lengths, clamp to clamp, each to within {TOLERANCE:g} mm; heights "
        "at supports by the change. The first column is the order of effect on the contact force, "
        f"the rows follow the line. {RISES}: by itself this correction raises σ.",
        CREW_HEAD, "rlrrrrl", tuple(crew_rows(rankings)),
    )  # fmt: skip
    rows = tuple(figure_rows(rankings))
    figures = Table("Force up to 20 Hz.", FIGURE_HEAD, "l" + "r" * 10, rows, FIGURE_GROUPS)
    note = Text(
        "Computed: a passage over the whole line with these corrections made; this is what they "
        "change. Predicted: the sum of the changes that each makes after those before it, from "
        "passages over a few spans.",
        "note",
    )
    worse = tuple(f"{text}." for text in worse_lines(rankings))
    warnings = (Callout(worse),) if worse else ()
    contents = [
        Section("corrections", "Corrections", (crew,)),
        Section("change", "What they change", (*warnings, figures, note)),
    ]
    return write_text(path, render(contents, _masthead(rankings)))


def _masthead(rankings: Sequence[Ranking]) -> dict[str, Any]:
    case, *others = (ranking.case for ranking in rankings)
    speeds = sorted({round(3.6 * ranking.case.scenario.speed) for ranking in rankings})
    more = f" and {counted(len(others), 'other')}" if others else ""
    return {
        "title": f"Corrections of {case.name}{more}",
        "description": "" if others else case.title,
        "facts": {
            "Speed": ", ".join(f"{speed} km/h" for speed in speeds),
            "Length": f"{sum(ranking.length for ranking in rankings):.0f} m",
            "Passages": str(sum(ranking.passages for ranking in rankings)),
        },
        "version": __version__,
        "case_hash": case.hash()[:12] + more,
    }
