"""What ``static`` shows of the conditions of a line, side by side."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from tautwire.cli.views.tables import batched, facts, heading, table
from tautwire.report.parts.condition_words import condition_rows, end_rows
from tautwire.results.design.conditions import ConditionState
from tautwire.specs.case import Case

MOST_COLUMNS = 3
"""Conditions beside each other on a terminal of 80 columns."""


def condition_facts(case: Case) -> list[tuple[str, str]]:
    """Return the condition that a case has chosen, in words; nothing for the design."""
    condition = case.chosen_condition
    if condition is None:
        return []
    return [("condition", "; ".join([condition.name, *condition.told()]))]


def conditions_view(states: Sequence[ConditionState]) -> Iterator[Any]:
    """Yield the tables of all conditions.

    Parameters
    ----------
    states
        The design first.
    """
    yield heading("Conditions", "analysed section; unstrained lengths as designed")
    yield facts([(one.name, "; ".join(one.told) or "as designed") for one in states])
    possible = [one for one in states if not one.fault]
    for group in batched(possible, MOST_COLUMNS):
        names = [one.name for one in group]
        yield heading("Contact wire")
        yield table(("", *names), "l" + "r" * len(group), condition_rows(group))
    slack = [(one.name, ", ".join(one.slack)) for one in possible if one.slack]
    if slack:
        yield heading("Slack droppers")
        yield facts(slack)
    ends = end_rows(possible)
    if ends:
        yield heading("Ends of the wires", "travel is positive when the wire grows")
        heads = ("wire", "end", "condition", "tension\n[N]", "travel\n[mm]", "")
        yield table(heads, "lllrrL", ends)
    impossible = [(one.name, one.fault) for one in states if one.fault]
    if impossible:
        yield heading("No such state")
        yield facts(impossible)
