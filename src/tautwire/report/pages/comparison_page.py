"""A page about runs beside measurements: numbers, coverage, forces, spans, spectra."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tautwire.assessment.comparison.coverage import covered
from tautwire.assessment.comparison.measurement import MeasurementComparison
from tautwire.assessment.comparison.points import PointComparison, judged
from tautwire.report.figures.force_figures import add_line_marks
from tautwire.report.figures.panels import Curve, Panel, panel_figure
from tautwire.report.pages.measured_page import reading_blocks
from tautwire.report.parts.blocks import Callout, Section, Table, Text, Verdict
from tautwire.report.parts.recordings.comparison import (
    HEADS,
    POINT_HEADS,
    UNCHECKED,
    coverage_rows,
    envelope_rows,
    length_rows,
    number_row,
    outcome_of,
    percentile_rows,
    point_rows,
    source_rows,
    span_rows,
    verdict_of,
)
from tautwire.report.parts.sections import MOST_ROWS, chart
from tautwire.report.parts.words import listing
from tautwire.report.writers.page import Page
from tautwire.report.writers.project import common_project, project_block
from tautwire.results.equilibrium import Elasticity
from tautwire.results.run import Run
from tautwire.specs.project import Project
from tautwire.version import __version__

_GROUPS = (("", 1), ("mean [N]", 2), ("σ [N]", 2), ("largest [N]", 2), ("smallest [N]", 2), ("", 1))
SOURCE_HEADS = ("quantity", "standard", "clause", "compared with its text", "note")
_SPAN_HEADS = ("span", *("simulated", "measured") * 4, "measured of it")


def compose_comparison(
    runs: Sequence[Run],
    found: Sequence[MeasurementComparison],
    project: Project | None = None,
    points: Sequence[tuple[Run, PointComparison]] = (),
) -> Page:
    """Return a page about comparisons.

    Parameters
    ----------
    runs
        One for each comparison.
    found
    project
        Project block; by default that of the cases, where they agree.
    points
        Elasticity and uplift at places, with the run of each.
    """
    contents = [
        section
        for number, (run, one) in enumerate(zip(runs, found, strict=True), 1)
        for section in _sections(run, one, "" if len(found) == 1 else str(number))
    ]
    contents += [
        _point_section(run, one, "" if len(points) == 1 else f"-{number}")
        for number, (run, one) in enumerate(points, 1)
    ]
    if len(found) > 1:
        rows = tuple(envelope_rows(covered([one.coverage for one in found])))
        table = Table("Outside of this the comparisons prove nothing.", ("", ""), "ll", rows)
        contents.append(Section("covers", "What the comparisons cover together", (table,)))
    every = [*runs, *(run for run, _ in points)]
    block = project or common_project([run.case for run in every])
    labels = [one.label for one in found] + [one.label for _, one in points]
    return Page(contents, _masthead(every, found, labels, block))


def _masthead(
    runs: Sequence[Run],
    found: Sequence[MeasurementComparison],
    labels: Sequence[str],
    project: Project,
) -> dict[str, Any]:
    names = _once(Path(label).name for label in labels)
    forces = {
        "Pantographs": listing(_once(one.pantograph for one in found)),
        "Tolerances": listing(_once(outcome_of(one) for one in found)),
    }
    return {
        "title": f"Measured and simulated: {listing(names)}",
        "description": "",
        "facts": {
            "Lines": listing(_once(run.case.name for run in runs)),
            **(forces if found else {}),
        },
        "project": project_block(project),
        "version": __version__,
        "case_hash": listing(_once(run.case.hash()[:12] for run in runs)),
    }


def _once(texts: Iterable[str]) -> list[str]:
    """Return texts, each once, in their order."""
    return list(dict.fromkeys(texts))


def _point_section(run: Run, one: PointComparison, suffix: str) -> Section:
    """Return elasticity and uplift at places: table, tolerances, and elasticity over the line."""
    verdicts = [_cell(verdict_of(row.numbers)) for row in one.rows]
    rows = [(*row, verdict) for row, verdict in zip(point_rows(one), verdicts, strict=True)]
    sources = tuple(source_rows(row.numbers for row in one.rows))
    blocks: list[object] = [Text(f"{note[:1].upper()}{note[1:]}.", "note") for note in one.notes]
    blocks.append(
        Table(
            f"{run.case.name} and {Path(one.label).name}; {judged(one.rows)}.",
            POINT_HEADS,
            "llrrrrl",
            tuple(rows[:MOST_ROWS]),
        )
    )
    if sources:
        blocks.append(Table("Tolerances and where they come from.", SOURCE_HEADS, "lllll", sources))
    if one.elasticity is not None:
        blocks.append(_elasticity_chart(one, one.elasticity, suffix))
    return Section(f"points{suffix}", "Elasticity and uplift at places", tuple(blocks))


def _elasticity_chart(one: PointComparison, found: Elasticity, suffix: str) -> object:
    rows = [row for row in one.rows if row.numbers.quantity == "elasticity"]
    order = np.argsort(found.x)
    at, values = [row.x for row in rows], [1e3 * row.numbers.measured for row in rows]
    curves = [
        Curve("simulated", found.x[order], 1e3 * found.elasticity[order], 0),
        Curve("measured", np.array(at), np.array(values), 1, mode="markers"),
    ]
    return chart(
        f"elasticity{suffix}",
        panel_figure([Panel("", curves, "elasticity [mm/N]")], "position along the track [m]"),
        f"Elasticity under {found.force:g} N, simulated over the line and as measured.",
        "Curve of the simulated elasticity over position, with the measured places.",
    )


def _sections(run: Run, one: MeasurementComparison, number: str) -> list[Section]:
    suffix, label = (f"-{number}", f" {number}: {Path(one.label).name}") if number else ("", "")
    return [
        Section(f"numbers{suffix}", f"Numbers{label}", _number_blocks(one)),
        Section(f"forces{suffix}", "Contact force over the line", _force_blocks(run, one, suffix)),
        Section(f"reading{suffix}", "The measurement", tuple(reading_blocks(one.evaluation))),
    ]


def _number_blocks(one: MeasurementComparison) -> tuple[object, ...]:
    rows = tuple((*number_row(row), _cell(verdict_of(row))) for row in one.rows)
    sources = tuple(source_rows(one.rows))
    return (
        Callout(tuple(f"{note[:1].upper()}{note[1:]}." for note in one.notes)),
        Table(
            f"Simulated and measured force, {one.start:.1f} to {one.end:.1f} m. Filter of both: "
            f"{one.filter}.",
            HEADS,
            "lrrrrl",
            rows,
        ),
        Table("Tolerances and where they come from.", SOURCE_HEADS, "lllll", sources),
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
    if one.tension_lengths:
        heads = ("tension length", *_SPAN_HEADS[1:])
        rows = tuple(length_rows(one))
        blocks.append(Table("By tension length.", heads, "lrrrrrrrrr", rows, _GROUPS))
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
