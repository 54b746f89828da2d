"""A page about the conditions of a line, side by side."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tautwire.analyses.design.masts import Masts
from tautwire.assessment.design.checks import DesignCheck
from tautwire.assessment.design.lateral import LateralCheck
from tautwire.files import write_text
from tautwire.report.figures import condition_figures as figures
from tautwire.report.parts.blocks import Callout, Section, Table, Text
from tautwire.report.parts.condition_words import condition_rows, end_rows
from tautwire.report.parts.design import defect_words
from tautwire.report.parts.design.sections import (
    checks_section,
    lateral_section,
    supports_section,
)
from tautwire.report.parts.sections import chart
from tautwire.report.writers.html import render
from tautwire.report.writers.project import project_block
from tautwire.results.design.conditions import ConditionState
from tautwire.specs.case import Case
from tautwire.version import __version__


@dataclass(frozen=True)
class ConditionsPage:
    """What the page is about.

    Attributes
    ----------
    case : Case
    states : sequence of ConditionState
        The design first.
    masts : Masts
        Forces on supports and installation of these states.
    lateral : LateralCheck or None
        Lateral position under wind, where it is required.
    checks : tuple of DesignCheck
    """

    case: Case
    states: Sequence[ConditionState]
    masts: Masts
    lateral: LateralCheck | None = None
    checks: tuple[DesignCheck, ...] = ()


def write_conditions_page(page: ConditionsPage, path: str | os.PathLike[str]) -> Path:
    """Write the conditions of a line as a single HTML file, completely or not at all.

    Parameters
    ----------
    page
        What it is about.
    path
        File to write.

    Returns
    -------
    Path
        The file.
    """
    case, states = page.case, page.states
    possible = [one for one in states if not one.fault]
    contents = [
        _summary(case, states, possible),
        _ends(possible),
        supports_section(page.masts, case.line),
    ]
    defects = tuple(defect_words.defect_rows(possible))
    if defects:
        contents.append(_defects(defects))
    if page.lateral is not None:
        contents.append(lateral_section(page.lateral))
    if page.checks:
        contents.append(checks_section(page.checks))
    contents.append(_figures(possible))
    return write_text(path, render(contents, _masthead(case, states)))


def _masthead(case: Case, states: Sequence[ConditionState]) -> dict[str, Any]:
    first, last = case.resolved_section()
    return {
        "title": f"{case.title or case.name}: conditions",
        "description": case.description,
        "facts": {
            "Line": f"{case.line.spans} spans, {case.line.length():g} m",
            "Analysed section": f"spans {first} to {last}",
            "Conditions": str(len(states) - 1),
            "Mesh": case.settings.mesh(),
        },
        "project": project_block(case.project),
        "version": __version__,
        "case_hash": case.hash()[:12],
    }


def _summary(
    case: Case, states: Sequence[ConditionState], possible: Sequence[ConditionState]
) -> Section:
    first, last = case.resolved_section()
    blocks: list[object] = []
    faults = tuple(f"{one.name}: {line}" for one in states for line in one.fault.splitlines())
    if faults:
        blocks.append(Callout(faults))
    blocks += [
        Table(
            "In what the conditions differ from the design, defects with their places.",
            ("condition", "what differs"),
            "ll",
            tuple((one.name, "; ".join(one.told) or "nothing") for one in states),
        ),
        Table(
            f"Spans {first} to {last}. Lateral positions are positive to the left of rising "
            "chainage.",
            ("", *(one.name for one in possible)),
            "l" + "r" * len(possible),
            tuple(condition_rows(possible)),
        ),
    ]
    return Section("summary", "Side by side", tuple(blocks))


def _ends(states: Sequence[ConditionState]) -> Section:
    table = Table(
        "Tension and travel of the ends of the wires; travel is positive when the wire grows.",
        ("wire", "end", "condition", "tension [N]", "travel [mm]", "state"),
        "lllrrl",
        tuple(end_rows(states)),
    )
    blocks: list[object] = [table]
    figure = figures.travel_figure(states)
    if figure.data:
        caption = "Travel of the ends that move over the temperature of the conditions."
        blocks.append(chart("travel", figure, caption, "Travel over temperature."))
    return Section("ends", "Ends of the wires", tuple(blocks))


def _defects(rows: tuple[tuple[str, ...], ...]) -> Section:
    table = Table(
        "Conditions with defects: the largest differences from the design with their places, "
        "droppers that have become slack, and the softest place (that of the design).",
        defect_words.HEAD,
        defect_words.ALIGN,
        rows,
    )
    return Section("defects", "Defects", (table,))


def _figures(states: Sequence[ConditionState]) -> Section:
    drawn = [
        ("lateral", figures.lateral_figure, "Lateral position of the contact wire."),
        ("height", figures.height_figure, "Height of the contact wire."),
        ("droppers", figures.dropper_figure, "Forces of the droppers."),
    ]
    if any(one.elasticity is not None for one in states):
        drawn.append(("elasticity", figures.elasticity_figure, "Elasticity."))
    blocks: list[object] = [
        chart(name, draw(states), caption, f"{caption} One curve per condition.")
        for name, draw, caption in drawn
    ]
    return Section("line", "Along the line", tuple(blocks) or (Text("None."),))
