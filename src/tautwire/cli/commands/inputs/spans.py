"""``spans``: a table of longest spans over radius and wind."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from tautwire.assessment.data import read_file
from tautwire.assessment.gauge import gauge_head, gauge_rule
from tautwire.assessment.span_table import SpanRow, span_table
from tautwire.cli.session import Answer
from tautwire.cli.views.tables import facts, heading, table
from tautwire.files import write_text
from tautwire.formulas.lateral import LongestSpan
from tautwire.specs.span_table import GaugeRule, SpanTable
from tautwire.text import csv_text
from tautwire.version import __version__

_MARKS = {
    "wind to the inside": "",
    "wind to the outside": " o",
    "stagger": "",
    "radial pull": " r",
    "limit": " l",
}


def show_spans(answer: Answer, path: Path, out: Path | None) -> None:
    """Compute and show a table of longest spans."""
    spec = read_file(path, SpanTable)
    rows = span_table(spec)
    winds = spec.wind.speeds
    answer.document.update(
        {
            "name": spec.name,
            "version": __version__,
            "notes": _notes(spec),
            "rows": [row.as_dict(winds) for row in rows],
        }
    )
    answer.show(*_view(spec, rows))
    if out is not None:
        _write(out, spec, rows)
        answer.document["file"] = str(out)


def _notes(spec: SpanTable) -> list[str]:
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


def _view(spec: SpanTable, rows: Sequence[SpanRow]) -> list[Any]:
    heads = ["radius\n[m]", "stagger\n[m]", "permissible\n[m]"]
    heads += [f"{wind:g} m/s\n[m]" for wind in spec.wind.speeds]
    body = [
        (
            _radius(row),
            " / ".join(f"{value:+.2f}" for value in row.curve.stagger),
            f"{row.permissible:.3f}",
            *(_span(span) for span in row.spans),
        )
        for row in rows
    ]
    legend = "o: wind to the outside governs, r: radial pull, l: longest span allowed"
    return [
        heading(spec.title or spec.name, "longest span"),
        table(heads, "r" * len(heads), body),
        legend,
        facts(("note", note) for note in _notes(spec)),
    ]


def _radius(row: SpanRow) -> str:
    radius = row.curve.radius_or_infinity
    return "straight" if math.isinf(radius) else f"{radius:g}"


def _span(span: LongestSpan) -> str:
    if span.length == 0.0:
        return "stagger too large"
    if math.isinf(span.length):
        return "no limit"
    return f"{span.length:.1f}{_MARKS[span.governs]}"


def _write(out: Path, spec: SpanTable, rows: Sequence[SpanRow]) -> None:
    """Write one CSV row per radius and wind."""
    head = ["radius_m", "stagger_left_m", "stagger_right_m", "cant_m", "permissible_m", "wind_m_s",
            "longest_span_m", "governs", "lateral_position_m"]  # fmt: skip
    cells = [
        [_radius(row), *row.curve.stagger, row.curve.cant, f"{row.permissible:.4f}",
         entry["wind_m_s"], _cell(entry["longest_m"]), entry["governs"], _cell(entry["lateral_m"])]
        for row in rows
        for entry in row.as_dict(spec.wind.speeds)["spans"]
    ]  # fmt: skip
    write_text(out, csv_text(head, cells))


def _cell(value: float | None) -> str:
    return "" if value is None else f"{value:.4f}"
