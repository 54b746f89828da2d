"""A run beside published results of the same reference line."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from tautwire.assessment.references import (
    ElasticityReference,
    Reference,
    ReferenceRow,
    compare_elasticity,
    compare_with_reference,
    load_references,
)
from tautwire.report.parts.blocks import Cell, Table, Text
from tautwire.report.parts.views import RunView
from tautwire.report.parts.words import MISSING, SPACE, band, number, quantity, readable
from tautwire.text import marked

NAMES = {
    "mean": "mean force",
    "maximum": "largest force",
    "minimum": "smallest force",
    "statistical_maximum": "mean + 3 σ",
    "statistical_minimum": "mean − 3 σ",
    "uplift": "largest uplift at a support",
    "loss_percent": "contact loss",
}
CHANGED = (
    "Published results hold for the reference line as published; where an input was changed, the "
    "comparison shows the effect of the change."
)


@dataclass(frozen=True)
class _Comparison:
    """One reference, and the run's numbers beside it."""

    title: str
    about: str
    rows: tuple[ReferenceRow, ...]


def force_blocks(view: RunView, *, named: bool) -> list[object]:
    """Compare the statistics of a run with the references of its line and speed.

    Parameters
    ----------
    view : RunView
    named : bool
        Whether the captions name the run.
    """
    case, library = view.run.case, load_references()
    found = [
        _Comparison(
            _titled(reference),
            f"filter: {reference.filter}",
            compare_with_reference(view.statistics, reference, accuracy=view.run.accuracy),
        )
        for reference in library.of_case(case.name, case.scenario.speed)
    ]
    if not found:
        return []
    filters = view.statistics.pantographs[0].headline.description
    caption = f"Statistics of {_whose(view, named=named)} beside published results; {filters}."
    rows = [row for one in found for row in one.rows]
    known = library.explain(case.name, case.scenario.speed, rows)
    return [*_tables(found, caption), *(Text(own.text) for own in known), Text(CHANGED, "note")]


def elasticity_blocks(view: RunView, *, named: bool) -> list[object]:
    """Compare the elasticity in the middle of the line with the references of this line."""
    data = view.elasticity
    if data is None:
        return []
    middle = (int(data.span.min()) + int(data.span.max())) // 2
    present = {
        int(index)
        for span, kind, index in zip(data.span, data.kind, data.index, strict=True)
        if span == middle and kind in ("support", "dropper")
    }
    found = [
        _Comparison(_titled(reference), reference.note, compare_elasticity(data, reference, middle))
        for reference in load_references().elasticities_of_case(view.run.case.name)
        if present >= set(range(len(reference.droppers) + 1))
    ]
    if not found:
        return []
    caption = (
        f"Elasticity of {_whose(view, named=named)} in span {middle}, under {data.force:g} N, "
        "beside published results."
    )
    return [*_tables(found, caption), Text(CHANGED, "note")]


def _whose(view: RunView, *, named: bool) -> str:
    return view.label if named else "this run"


def _titled(reference: Reference | ElasticityReference) -> str:
    return f"{reference.title[:1].upper()}{reference.title[1:]}"


def _tables(found: Sequence[_Comparison], caption: str) -> list[Table]:
    """Return the numbers side by side, and where they come from."""
    quantities = dict.fromkeys(row.quantity for one in found for row in one.rows)
    rows = []
    for name in quantities:
        matches = [next((r for r in one.rows if r.quantity == name), None) for one in found]
        own = next(row for row in matches if row is not None)
        cells: list[Cell] = [
            _quantity_name(name),
            marked(readable(own.value, own.unit, own.error), is_carried=own.is_carried),
        ]
        for row in matches:
            cells += [MISSING, ""] if row is None else [_published(row), _outcome(row)]
        rows.append(tuple(cells))
    marks = [f"[{mark}]" for mark in "abcdefghijklmnopqrstuvwxyz"[: len(found)]]
    numbers = Table(
        caption=caption,
        head=("", "this run", *(head for mark in marks for head in (mark, "comparison"))),
        align="lr" + "rr" * len(found),
        rows=tuple(rows),
    )
    origins = tuple(
        (mark, one.title, _confidence(one.rows), _origin(one))
        for mark, one in zip(marks, found, strict=True)
    )
    return [numbers, Table("", ("", "published result", "known from", "source"), "llll", origins)]


def _origin(one: _Comparison) -> str:
    sources = dict.fromkeys(row.source for row in one.rows)
    return "; ".join([*sources, *([one.about] if one.about else [])])


def _confidence(rows: Sequence[ReferenceRow]) -> str:
    """Return the confidence common to most rows, and the exceptions."""
    every = [row.confidence for row in rows]
    common = max(dict.fromkeys(every), key=every.count)
    others = [f"{_quantity_name(r.quantity)}: {r.confidence}" for r in rows
              if r.confidence != common]  # fmt: skip
    return f"{common} ({', '.join(others)})" if others else common


def _quantity_name(name: str) -> str:
    if name.startswith("std_"):
        return f"σ, {band(name[4:])}"
    return NAMES.get(name, name.removeprefix("elasticity at "))


def _published(row: ReferenceRow) -> str:
    if row.target is not None:
        return readable(row.target, row.unit)
    low, high = readable(row.low, row.unit), readable(row.high, row.unit)
    return low if low == high else f"{low.split(SPACE)[0]} to {high}"


def _outcome(row: ReferenceRow) -> str:
    if row.deviation is not None and math.isfinite(row.deviation):
        return f"{'+' if row.deviation >= 0 else ''}{quantity(100 * row.deviation, '%')}"
    if row.inside is None:
        return number(None)
    return "inside" if row.inside else "outside"
