"""A page about runs beside measurements: numbers, coverage, forces, spans, spectra."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tautwire.assessment.measurement import MeasurementComparison
from tautwire.report.figures.force_figures import add_line_marks
from tautwire.report.figures.panels import Curve, Panel, panel_figure
from tautwire.report.pages.measured_page import reading_blocks
from tautwire.report.parts.blocks import Callout, Section, Table, Text, Verdict
from tautwire.report.parts.recordings.comparison import (
    HEADS,
    UNCHECKED,
    coverage_rows,
    number_row,
    outcome_of,
    percentile_rows,
    source_rows,
    span_rows,
    verdict_of,
)
from tautwire.report.parts.sections import MOST_ROWS, chart
from tautwire.report.parts.words import listing
from tautwire.report.writers.page import Page
from tautwire.report.writers.project import common_project, project_block
from tautwire.results.run import Run
from tautwire.specs.project import Project
from tautwire.version import __version__

_GROUPS = (("", 1), ("mean [N]", 2), ("σ [N]", 2), ("largest [N]", 2), ("smallest [N]", 2), ("", 1))
_SPAN_HEADS = ("span", *("simulated", "measured") * 4, "measured of it")


def compose_comparison(
    runs: Sequence[Run], found: Sequence[MeasurementComparison], project: Project | None = None
) -> Page:
    """Return a page about comparisons.

    Parameters
    ----------
    runs
        One for each comparison.
    found
    project
        Project block; by default that of the cases, where they agree.
    """
    contents = [
        section
        for number, (run, one) in enumerate(zip(runs, found, strict=True), 1)
        for section in _sections(run, one, "" if len(found) == 1 else str(number))
    ]
    block = project or common_project([run.case for run in runs])
    return Page(contents, _masthead(found, block))


def _masthead(found: Sequence[MeasurementComparison], project: Project) -> dict[str, Any]:
    names = list(dict.fromkeys(Path(one.label).name for one in found))
    return {
        "title": f"Measured and simulated: {listing(names)}",
        "description": "",
        "facts": {
            "Lines": listing(list(dict.fromkeys(one.coverage.case for one in found))),
            "Pantographs": listing(list(dict.fromkeys(one.pantograph for one in found))),
            "Tolerances": listing(list(dict.fromkeys(outcome_of(one) for one in found))),
        },
        "project": project_block(project),
        "version": __version__,
        "case_hash": listing(list(dict.fromkeys(one.coverage.case_hash[:12] for one in found))),
    }


def _sections(run: Run, one: MeasurementComparison, number: str) -> list[Section]:
    suffix, label = (f"-{number}", f" {number}: {Path(one.label).name}") if number else ("", "")
    return [
        Section(f"numbers{suffix}", f"Numbers{label}", _number_blocks(one)),
        Section(f"forces{suffix}", "Contact force over the line", _force_blocks(run, one, suffix)),
        Section(f"reading{suffix}", "The measurement", tuple(reading_blocks(one.evaluation))),
    ]


def _number_blocks(one: MeasurementComparison) -> tuple[object, ...]:
    rows = tuple((*number_row(row), _cell(verdict_of(row))) for row in one.rows)
    sources = tuple(source_rows(one))
    return (
        Callout(tuple(f"{note[:1].upper()}{note[1:]}." for note in one.notes)),
        Table(
            f"Simulated and measured force, {one.start:.1f} to {one.end:.1f} m. Filter of both: "
            f"{one.filter}.",
            HEADS,
            "lrrrrl",
            rows,
        ),
        Table("Tolerances and where they come from.",
              ("quantity", "standard", "clause", "compared with its text", "note"), "lllll",
              sources),
        Table("What this comparison covers: outside of it, it proves nothing.", ("", ""), "ll",
              tuple(coverage_rows(one.coverage))),
        Table("Force below which a share of the way lies.",
              ("share", "simulated", "measured", "difference"), "lrrr",
              tuple(percentile_rows(one))),
    )  # fmt: skip


def _cell(verdict: str) -> Verdict | str:
    outcomes = {"met": "passed", "missed": "failed"}
    if not verdict or verdict == "not judged":
        return verdict
    words = verdict.replace(UNCHECKED, f"{UNCHECKED} against the standard")
    return Verdict(words, outcomes.get(verdict, "unverified"))


def _force_blocks(run: Run, one: MeasurementComparison, suffix: str) -> tuple[object, ...]:
    curves = [
        Curve("simulated", one.position, one.simulated_force, 0),
        Curve("measured", one.position, one.measured_force, 1),
    ]
    panel = Panel("", curves, "contact force [N]", x_range=(one.start, one.end))
    figure = panel_figure([panel], "position along the track [m]", height=400)
    add_line_marks(figure, run, (one.start, one.end))
    blocks: list[object] = [
        chart(
            f"force{suffix}",
            figure,
            f"Both forces over the position; supports are numbered above, droppers ticked below. "
            f"{one.placement.text[:1].upper()}{one.placement.text[1:]}. Filter: {one.filter}.",
            "Curves of the simulated and the measured contact force over position.",
        ),
        Table("Span by span, over what was measured of each.", _SPAN_HEADS, "lrrrrrrrrr",
              tuple(span_rows(one)[:MOST_ROWS]), _GROUPS),
    ]  # fmt: skip
    spectra = {"simulated": one.simulated_spectrum, "measured": one.measured_spectrum}
    shown = [
        Curve(name, found.abscissa, found.value, look)
        for look, (name, found) in enumerate(spectra.items())
        if found is not None
    ]
    if shown:
        spans = np.diff(run.equilibrium.mast_x)
        marks = {"span": 1.0 / float(np.median(spans))}
        blocks.append(
            chart(
                f"spectrum{suffix}",
                panel_figure([Panel("", shown, "amplitude [N]", marks=marks)], "wave number [1/m]"),
                "Amplitude spectra of the unfiltered forces over the compared part, Hann window.",
                "Curves of the amplitudes of both forces over wave number.",
            )
        )
    else:
        blocks.append(Text("The common part is too short for spectra."))
    return tuple(blocks)
