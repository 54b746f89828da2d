"""What ``static`` shows on the terminal."""

from __future__ import annotations

from typing import Any

import numpy as np

from tautwire.cli.views.conditions_view import condition_facts
from tautwire.cli.views.tables import facts, heading, table
from tautwire.report.parts.fitting_words import BODY_HEAD, STAY_HEAD, body_rows, stay_rows
from tautwire.report.parts.words import number, quantity
from tautwire.results.equilibrium import Elasticity, Equilibrium
from tautwire.specs.case import Case

MOST_SPANS = 40
"""Lines with more spans show the analysed section only."""


def static_view(case: Case, shape: Equilibrium, elasticity: Elasticity | None) -> list[Any]:
    """Return the tables of a static state, one span in full and the others in short."""
    first, last = case.resolved_section()
    span = (first + last) // 2
    return [
        heading(case.title or case.name, "static state"),
        _facts(case, shape, elasticity),
        heading(f"Span {span}", "the middle of the analysed section; all spans with --out"),
        _span_table(shape, elasticity, span),
        heading("Line", "support: at the beginning of the span"),
        _line_table(case, shape),
        *_fittings(case, shape),
    ]


def _fittings(case: Case, shape: Equilibrium) -> list[Any]:
    """Return the bodies and stays on wires, if there are any."""
    found: list[Any] = []
    if rows := body_rows(case, shape):
        found += [heading("Bodies", "at rest"), table(BODY_HEAD, "llrrrrr", rows)]
    if rows := stay_rows(case, shape):
        found += [heading("Stays", "at rest; a pull is positive"), table(STAY_HEAD, "llrrr", rows)]
    return found


def _facts(case: Case, shape: Equilibrium, elasticity: Elasticity | None) -> Any:
    spring = case.supports.closure == "spring"
    arms = "vertical springs instead of steady arms" if spring else _arms(shape)
    return facts(
        [
            ("line", f"{case.line.spans} spans, {case.line.length():g} m"),
            *condition_facts(case),
            ("shape", f"{shape.iterations} iterations, residual {shape.residual:.1e} N"),
            ("weight", f"{shape.weight:.2f} N, reactions {shape.reaction:.2f} N"),
            ("dropper forces", _extent(shape.dropper_forces, "N")),
            ("steady arms", arms),
            *_elasticity_facts(elasticity),
        ]
    )


def _elasticity_facts(elasticity: Elasticity | None) -> list[tuple[str, str]]:
    if elasticity is None:
        return [("elasticity", "not computed")]
    values = 1e3 * elasticity.elasticity
    extent = f"{values.min():.3f} to {values.max():.3f} mm/N under {elasticity.force:g} N"
    return [
        ("elasticity", extent),
        ("non-uniformity", f"{100 * elasticity.nonuniformity:.1f} %"),
    ]


def _arms(shape: Equilibrium) -> str:
    if not len(shape.arm_forces):
        return "none"
    pulls = _extent(shape.arm_forces, "N")
    return f"pull {pulls}, inclination {_extent(np.degrees(shape.arm_angles), '°')}"


def _extent(values: Any, unit: str) -> str:
    if not len(values):
        return "none"
    low, high = float(np.min(values)), float(np.max(values))
    return quantity(low, unit) if high - low < 0.05 else f"{number(low)} to {quantity(high, unit)}"


def _span_table(shape: Equilibrium, elasticity: Elasticity | None, span: int) -> Any:
    at = _elasticity_in(span, elasticity)
    left = shape.mast_x[span - 1]
    lowest = -shape.by_mast(-shape.support_heights)
    rows = [
        ("support", "0.000", "", "", "", f"{lowest[span - 1]:.4f}",
         at.get(("support", 0), "")),
    ]  # fmt: skip
    for i in np.flatnonzero(shape.dropper_span == span):
        index = int(shape.dropper_number[i])
        rows.append(
            (
                f"dropper {index}",
                f"{shape.dropper_x[i] - left:.3f}",
                f"{shape.dropper_lengths_unstrained[i]:.4f}",
                f"{shape.dropper_lengths[i]:.4f}",
                f"{shape.dropper_forces[i]:.1f}",
                f"{shape.dropper_heights[i]:.4f}",
                at.get(("dropper", index), ""),
            )
        )
    heads = (
        "",
        "at [m]",
        "unstrained\n[m]",
        "stretched\n[m]",
        "force\n[N]",
        "wire height\n[m]",
        "elasticity\n[mm/N]",
    )
    return table(heads, "lrrrrrr", rows)


def _elasticity_in(span: int, elasticity: Elasticity | None) -> dict[tuple[str, int], str]:
    """Return the elasticity of the points of a span by kind and number; none without it."""
    if elasticity is None:
        return {}
    points = zip(
        elasticity.span, elasticity.kind, elasticity.index, elasticity.elasticity, strict=True
    )
    return {
        (kind, int(index)): f"{1e3 * value:.4f}" for s, kind, index, value in points if s == span
    }


def _line_table(case: Case, shape: Equilibrium) -> Any:
    spans = range(1, case.line.spans + 1)
    if case.line.spans > MOST_SPANS:
        first, last = case.resolved_section()
        spans = range(first, min(last, first + MOST_SPANS - 1) + 1)
    supports = shape.support_number[shape.arm_supports - 1]
    lowest = -shape.by_mast(-shape.support_heights)
    rows = []
    for span in spans:
        own = shape.dropper_span == span
        arms = supports == span
        rows.append(
            (
                str(span),
                f"{shape.mast_x[span] - shape.mast_x[span - 1]:g}",
                str(int(own.sum())),
                _extent(shape.dropper_forces[own], ""),
                _extent(shape.arm_forces[arms], "") if arms.any() else "",
                _extent(np.degrees(shape.arm_angles[arms]), "") if arms.any() else "",
                f"{lowest[span - 1]:.4f}",
            )
        )
    heads = (
        "span",
        "length\n[m]",
        "droppers",
        "dropper forces\n[N]",
        "arm force\n[N]",
        "arm angle\n[°]",
        "height at\nsupport [m]",
    )
    return table(heads, "rrrrrrr", rows)
