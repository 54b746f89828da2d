"""The lateral position along a line as words, for tables of every kind."""

from __future__ import annotations

import math
from collections.abc import Sequence

from tautwire.assessment.design.lateral import LateralCheck, LateralPlace
from tautwire.text import csv_text

HEAD = (
    "span", "x\n[m]", "towards", "position\n[mm]", "allowed\n[mm]", "left\n[mm]",
    "estimate\nalone", "estimate\ntogether",
)  # fmt: skip
ALIGN = "rrlrrrrr"

EXPLAINED = (
    "Finite-element equilibrium under wind from either side, the worse one; positions towards the "
    "lee. Allowed: permissible position less deflection of supports and tolerances. Estimates: "
    "the contact wire by itself, and contact and messenger wire as one."
)


def lateral_rows(places: Sequence[LateralPlace]) -> list[tuple[str, ...]]:
    """Return one row per place, lengths in millimetres."""
    return [
        (
            str(one.span),
            f"{one.x:.1f}",
            one.towards,
            _mm(one.position),
            _mm(one.permissible - one.given),
            _mm(one.margin),
            _mm(one.alone),
            _mm(one.together),
        )
        for one in places
    ]


def _mm(value: float) -> str:
    return "" if math.isnan(value) else f"{1e3 * value:.0f}"


def worst_place(check: LateralCheck) -> str:
    """Say which place of the line has least left."""
    worst = min(check.worst, key=lambda one: one.margin)
    word = "exceeded by" if worst.margin < 0.0 else "left"
    return (
        f"span {worst.span}, x = {worst.x:.1f} m, {worst.wire!r} towards the {worst.towards}: "
        f"{1e3 * worst.position:.0f} of {1e3 * (worst.permissible - worst.given):.0f} mm, "
        f"{word} {1e3 * abs(worst.margin):.0f} mm"
    )


def lateral_csv(check: LateralCheck) -> str:
    """Return both sides of every span as CSV."""
    head = ("span", "wind towards", "wire", "x [m]", "position [m]", "deflection and tolerance [m]",
            "permissible [m]", "margin [m]", "estimate alone [m]", "estimate together [m]",
            "radius [m]", "cant or deficiency [m]", "height [m]")  # fmt: skip
    rows = (
        (one.span, one.towards, one.wire, *map(_cell, (one.x, one.position, one.given,
         one.permissible, one.margin, one.alone, one.together, one.radius, one.cant, one.height)))
        for one in check.places
    )  # fmt: skip
    return csv_text(head, rows)


def _cell(value: float) -> str:
    return "" if math.isnan(value) or value > 1e9 else f"{value:.4f}"  # straight: no radius
