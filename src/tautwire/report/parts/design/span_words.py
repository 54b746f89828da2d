"""Longest spans as words, for the terminal, tables and the page."""

from __future__ import annotations

import math
from collections.abc import Sequence

from tautwire.assessment.gauge import gauge_head, gauge_rule
from tautwire.assessment.span_table import SpanRow
from tautwire.formulas.lateral import LongestSpan
from tautwire.specs.span_table import GaugeRule, SpanTable
from tautwire.text import csv_text

LEGEND = "o: wind to the outside governs, r: radial pull, l: longest span allowed"

_MARKS = {
    "wind to the inside": "",
    "wind to the outside": " o",
    "stagger": "",
    "radial pull": " r",
    "limit": " l",
}


def span_notes(spec: SpanTable) -> list[str]:
    """Say what stands behind the numbers."""
    notes = [
        "the wires swing as one, with the tension given; droppers and suspension do not resist",
        "supports stand still; deduct their deflection from the permissible position",
    ]
    if isinstance(spec.permissible, GaugeRule):
        rule, head = gauge_rule(spec.permissible.rule), gauge_head(spec.permissible.head)
        state = "verified" if rule.verified else "not checked against the standard"
        notes.append(f"{rule.name}: {state}; {rule.confidence}, {rule.source}")
        notes.append(f"head {head.id}: half width {head.half_width:g} m, {head.source}")
    return notes


def span_head(spec: SpanTable) -> tuple[str, ...]:
    """Return the heading of the table of longest spans."""
    heads = ("radius\n[m]", "stagger\n[m]", "permissible\n[m]")
    return (*heads, *(f"{wind:g} m/s\n[m]" for wind in spec.wind.speeds))


def span_rows(rows: Sequence[SpanRow]) -> list[tuple[str, ...]]:
    """Return one row per radius: stagger, permissible position, longest span per wind."""
    return [
        (
            radius_in_words(row),
            " / ".join(f"{value:+.2f}" for value in row.curve.stagger),
            f"{row.permissible:.3f}",
            *(_span(span) for span in row.spans),
        )
        for row in rows
    ]


def radius_in_words(row: SpanRow) -> str:
    """Return the radius of a row, or that it is straight."""
    radius = row.curve.radius_or_infinity
    return "straight" if math.isinf(radius) else f"{radius:g}"


def _span(span: LongestSpan) -> str:
    if span.length == 0.0:
        return "stagger too large"
    if math.isinf(span.length):
        return "no limit"
    return f"{span.length:.1f}{_MARKS[span.governs]}"


def spans_csv(spec: SpanTable, rows: Sequence[SpanRow]) -> str:
    """Return one CSV row per radius and wind."""
    head = ["radius_m", "stagger_left_m", "stagger_right_m", "cant_m", "permissible_m", "wind_m_s",
            "longest_span_m", "governs", "lateral_position_m"]  # fmt: skip
    cells = [
        [radius_in_words(row), *row.curve.stagger, row.curve.cant, f"{row.permissible:.4f}",
         entry["wind_m_s"], _cell(entry["longest_m"]), entry["governs"], _cell(entry["lateral_m"])]
        for row in rows
        for entry in row.as_dict(spec.wind.speeds)["spans"]
    ]  # fmt: skip
    return csv_text(head, cells)


def _cell(value: float | None) -> str:
    return "" if value is None else f"{value:.4f}"
