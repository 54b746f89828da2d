"""What ``static`` shows of supports, installation, structures and the lateral position."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from tautwire.analyses.design.masts import Masts
from tautwire.assessment.design.checks import DesignCheck
from tautwire.assessment.design.lateral import LateralCheck
from tautwire.cli.views.tables import facts, heading, table
from tautwire.report.parts.design import check_words
from tautwire.report.parts.design.lateral_words import ALIGN, HEAD, lateral_rows, worst_place
from tautwire.report.parts.design.mast_words import (
    CLEARANCE_HEAD,
    FORCE_HEAD,
    TENSION_HEAD,
    clearance_rows,
    force_rows,
    installation_head,
    installation_rows,
    tension_rows,
)
from tautwire.specs.line.catenary import Line

MOST_COLUMNS = 5
"""Temperatures beside each other on a terminal of 80 columns."""


def masts_view(masts: Masts, line: Line, contact: tuple[str, ...]) -> Iterator[Any]:
    """Yield the tables of supports.

    Parameters
    ----------
    masts
    line
        Names its supports.
    contact
        Names of the contact wires, whose cantilevers are told.
    """
    states = len(masts.states)
    extent = f"least to largest of {states} states" if states > 1 else "all wires together"
    yield heading("Forces on supports", f"{extent}; lateral: to the left")
    yield table(FORCE_HEAD, "rrrrr", force_rows(masts, line))
    for first in range(0, len(masts.temperatures), MOST_COLUMNS):
        chosen = slice(first, first + MOST_COLUMNS)
        yield heading("Installation", "mm from the design; weights upwards")
        rows = installation_rows(masts, line, chosen, contact)
        yield table(installation_head(masts, chosen), "rL" + "r" * len(rows[0][2:]), rows)
    if states > 1:
        yield heading("Tension along the line", "means of the outermost spans, and the least span")
        yield table(TENSION_HEAD, "LLrrrr", tension_rows(masts))
    if any(one.clearances for one in masts.states):
        yield heading("Structures", "distance to the lifted wire, least of all states")
        yield table(CLEARANCE_HEAD, "LLLrrrl", clearance_rows(masts))
    if masts.exceeded:
        yield heading("Requirements that are not kept")
        yield facts(masts.exceeded)


def lateral_view(check: LateralCheck) -> Iterator[Any]:
    """Yield the table of the lateral position, the worse side of every span."""
    yield heading("Lateral position", f"{check.wind} from either side")
    if check.worst:
        yield table(HEAD, ALIGN, lateral_rows(check.worst))
        yield facts([("worst place", worst_place(check))])
    yield facts([*(("note", one) for one in check.notes), *(("fault", f) for f in check.faults)])


def checks_view(checks: Sequence[DesignCheck]) -> Iterator[Any]:
    """Yield the table of the checks of the design with the sources of its limits."""
    if not checks:
        return
    yield heading("Design", "this line: finite elements, design and all conditions")
    yield table(check_words.HEAD, "Lrrrl", check_words.check_rows(checks))
    yield facts(check_words.source_rows(checks))
