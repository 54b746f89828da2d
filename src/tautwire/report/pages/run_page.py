"""The report: one self-contained HTML page that needs no network."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from tautwire.assessment.checks import Criteria
from tautwire.errors import InputError
from tautwire.report.parts import sections
from tautwire.report.parts.conditions import conditions_section
from tautwire.report.parts.losses import loss_section
from tautwire.report.parts.summary import summary_section
from tautwire.report.parts.views import RunView, labels_of, prepare
from tautwire.report.parts.words import listing, speed
from tautwire.report.writers.page import Page
from tautwire.report.writers.project import common_project, project_block
from tautwire.results.equilibrium import Elasticity
from tautwire.results.run import Run
from tautwire.specs.project import Project
from tautwire.text import DESIGN


def compose_report(
    runs: Run | Sequence[Run],
    elasticity: Elasticity | Sequence[Elasticity | None] | None = None,
    *,
    labels: Sequence[str] | None = None,
    title: str | None = None,
    criteria: Criteria | None = None,
    project: Project | None = None,
) -> Page:
    """Return the report of one run, or of several runs overlaid, to be written in several ways.

    See :func:`write_report` for the parameters and what is raised.
    """
    every = [runs] if isinstance(runs, Run) else list(runs)
    if not every:
        raise InputError("a report needs at least one run")
    given = _matched(elasticity, len(every))
    views = [
        prepare(run, label, data)
        for run, label, data in zip(every, labels_of(every, labels), given, strict=True)
    ]
    judged_by = criteria or Criteria()
    found = [judged_by.checks(view.statistics, view.run.case, view.run.accuracy) for view in views]
    contents = [
        summary_section(views, found),
        sections.line_section(views),
        sections.force_section(views),
        loss_section(views),
        sections.spectrum_section(views),
        sections.uplift_section(views),
        sections.dropper_section(views),
        sections.elasticity_section(views),
        conditions_section(views),
        sections.animation_section(views),
    ]
    return Page(contents, _masthead(views, title, project))


def write_report(
    runs: Run | Sequence[Run],
    path: str | os.PathLike[str],
    elasticity: Elasticity | Sequence[Elasticity | None] | None = None,
    *,
    labels: Sequence[str] | None = None,
    title: str | None = None,
    criteria: Criteria | None = None,
    project: Project | None = None,
) -> Path:
    """Write the report of one run, or of several runs overlaid, as one file: HTML or PDF.

    The HTML page holds its scripts and data, asks no other machine for anything and forbids the
    browser to do so. It is written completely or not at all.

    Parameters
    ----------
    runs : Run or sequence of Run
        Also partial ones.
    path : str or path
        File to write; PDF where its name ends in .pdf, which needs the extra ``pdf``.
    elasticity : Elasticity or sequence of Elasticity or None, optional
        For the runs in their order; a single one belongs to the first.
    labels : sequence of str, optional
        Names of the runs in legends; by default case name and what tells them apart.
    title : str, optional
        Heading of the page; by default the title of the case.
    criteria : Criteria, optional
        What the runs are judged by: supply system, free space for uplift, own limits; by default
        AC, the uplift not judged, the limits of the package.
    project : Project, optional
        Project block of the page; by default that of the cases, where they agree.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        When there is no run, labels or elasticities do not match, or the file cannot be written.

    Examples
    --------
    >>> write_report(run, "run.html")  # doctest: +SKIP
    """
    page = compose_report(
        runs, elasticity, labels=labels, title=title, criteria=criteria, project=project
    )
    return page.write(path)


def _matched(
    elasticity: Elasticity | Sequence[Elasticity | None] | None, runs: int
) -> list[Elasticity | None]:
    """Return one elasticity or None per run."""
    given = [elasticity] if isinstance(elasticity, Elasticity) else list(elasticity or ())
    if len(given) > runs:
        raise InputError(f"{len(given)} elasticities were given for {runs} runs")
    return given + [None] * (runs - len(given))


def _masthead(
    views: Sequence[RunView], title: str | None, project: Project | None
) -> dict[str, Any]:
    """Return heading, description and key facts of the page."""
    first = views[0].run.case
    own_title = first.title or first.name
    many = len(views) > 1
    facts = {
        "Speed": _each(views, lambda view: speed(view.run.case.scenario.speed)),
        "Line": _each(views, _line_in_words),
        **_conditions(views),
        "Analysed section": _each(views, _section_in_words),
        "Pantographs": listing(
            list(dict.fromkeys(force.name for view in views for force in view.forces))
        ),
        "Contact stiffness": _each(
            views, lambda view: f"{1e-3 * view.run.case.settings.contact_stiffness:g} kN/m"
        ),
        "Status": _each(views, lambda view: view.run.status),
        "Computed": _each(
            views, lambda view: str(view.run.provenance.get("created", ""))[:10] or "–"
        ),
    }
    common = len({view.run.case.name for view in views}) == 1
    heading = f"{own_title if common else 'Runs compared'}: {listing([v.label for v in views])}"
    return {
        "title": title or (heading if many else own_title),
        "description": "" if many else first.description.strip(),
        "project": project_block(project or common_project([view.run.case for view in views])),
        "facts": facts,
        "version": _each(views, lambda view: str(view.run.provenance.get("version", ""))),
        "case_hash": _each(views, lambda view: view.run.case.hash()[:12]),
    }


def _conditions(views: Sequence[RunView]) -> dict[str, str]:
    """Return the conditions of runs, where one is not as designed."""
    names = [view.run.case.condition for view in views]
    return (
        {"Condition": _each(views, lambda v: v.run.case.condition or DESIGN)} if any(names) else {}
    )


def _each(views: Sequence[RunView], tell: Callable[[RunView], str]) -> str:
    """Return what is to be told of every run, equal texts once."""
    return listing(list(dict.fromkeys(map(tell, views))))


def _line_in_words(view: RunView) -> str:
    line = view.run.case.line
    return f"{line.spans} spans, {line.length():g} m"


def _section_in_words(view: RunView) -> str:
    section = view.statistics.section
    return f"spans {section.first_span} to {section.last_span}"
