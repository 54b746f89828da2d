"""``spans``: a table of longest spans over radius and wind."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from tautwire.assessment.data import read_file
from tautwire.assessment.span_table import SpanRow, span_table
from tautwire.cli.session import Answer
from tautwire.cli.views.tables import facts, heading, table
from tautwire.files import write_text
from tautwire.report.pages.span_page import write_span_page
from tautwire.report.parts.design.span_words import (
    LEGEND,
    span_head,
    span_notes,
    span_rows,
    spans_csv,
)
from tautwire.specs.span_table import SpanTable
from tautwire.version import __version__


def show_spans(answer: Answer, path: Path, out: Path | None) -> None:
    """Compute and show a table of longest spans."""
    spec = read_file(path, SpanTable)
    rows = span_table(spec)
    winds = spec.wind.speeds
    answer.document.update(
        {
            "name": spec.name,
            "version": __version__,
            "notes": span_notes(spec),
            "rows": [row.as_dict(winds) for row in rows],
        }
    )
    answer.show(*_view(spec, rows))
    if out is not None:
        if out.suffix.lower() in (".html", ".htm"):
            write_span_page(spec, rows, out)
        else:
            write_text(out, spans_csv(spec, rows))
        answer.document["file"] = str(out)


def _view(spec: SpanTable, rows: Sequence[SpanRow]) -> list[Any]:
    heads = span_head(spec)
    return [
        heading(spec.title or spec.name, "longest span"),
        table(heads, "r" * len(heads), span_rows(rows)),
        LEGEND,
        facts(("note", note) for note in span_notes(spec)),
    ]
