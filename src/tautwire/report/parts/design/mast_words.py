"""Forces on supports and the installation of cantilevers as words, for tables of every kind."""

from __future__ import annotations

import math
from collections.abc import Sequence

from tautwire.analyses.design.masts import Masts
from tautwire.analyses.design.supports import Installed, totals
from tautwire.specs.line.catenary import Line
from tautwire.text import csv_text

FORCE_HEAD = ("support", "x\n[m]", "vertical\n[N]", "lateral\n[N]", "along\n[N]")
CLEARANCE_HEAD = ("structure", "condition", "wire", "x\n[m]", "left\n[mm]", "needed\n[mm]", "")


def force_rows(masts: Masts, line: Line) -> list[tuple[str, ...]]:
    """Return one row per support: least and largest sum of the wires' forces over all states.

    Supports are named by their masts, where these have names.
    """
    marks = line.support_marks()
    per_state = [totals(one.forces) for one in masts.states]
    rows = []
    for same in zip(*per_state, strict=True):
        parts = ([getattr(one, name) for one in same] for name in ("vertical", "lateral", "along"))
        rows.append((marks[same[0].support - 1], f"{same[0].x:g}", *map(_extent, parts)))
    return rows


def _extent(values: Sequence[float]) -> str:
    low, high = (f"{value:.0f}".replace("-0", "0") if abs(value) < 0.5 else f"{value:.0f}"
                 for value in (min(values), max(values)))  # fmt: skip
    return low if low == high else f"{low} to {high}"


def installation_head(masts: Masts, chosen: slice) -> tuple[str, ...]:
    """Return the heading of some columns of the installation table."""
    return ("support", "", *(f"{value:g} °C" for value in masts.temperatures[chosen]))


def installation_rows(
    masts: Masts, line: Line, chosen: slice, wires: Sequence[str] | None = None
) -> list[tuple[str, ...]]:
    """Return one row per cantilever and weight, in millimetres.

    Parameters
    ----------
    masts
    line
        Names its supports.
    chosen
        Which temperatures.
    wires
        Whose cantilevers are told; all by default. Weights always are.
    """
    marks = line.support_marks()
    return [
        (marks[one.support - 1], f"{one.wire}, {one.what}", *map(_offset, one.offsets[chosen]))
        for one in masts.installation
        if wires is None or one.wire in wires or one.what == "weight"
    ]


def _offset(value: float) -> str:
    return "" if math.isnan(value) else f"{1e3 * value:+.0f}"


TENSION_HEAD = ("wire", "condition", "left\n[N]", "right\n[N]", "least\n[N]", "in span")


def tension_rows(masts: Masts) -> list[tuple[str, ...]]:
    """Return one row per wire and state: mean tension of its end spans, and the least."""
    rows = []
    for state in masts.states:
        for one in state.tensions:
            at = min(range(len(one.tension)), key=lambda number: round(one.tension[number], 1))
            values = (one.tension[0], one.tension[-1], one.tension[at])
            told = (f"{value:.0f}" for value in values)
            rows.append((one.wire, state.condition, *told, str(one.spans[at])))
    return sorted(rows, key=lambda row: row[0])


def tensions_csv(masts: Masts) -> str:
    """Return the mean tension of every wire in every span and state as CSV."""
    head = ("condition", "wire", "span", "x [m]", "tension [N]")
    return csv_text(
        head,
        (
            (state.condition, one.wire, span, f"{x:.2f}", f"{tension:.2f}")
            for state in masts.states
            for one in state.tensions
            for span, x, tension in zip(one.spans, one.x, one.tension, strict=True)
        ),
    )


def clearance_rows(masts: Masts) -> list[tuple[str, ...]]:
    """Return one row per structure: the state in which least is left."""
    rows = []
    for same in zip(*(one.clearances for one in masts.states), strict=True):
        worst = min(range(len(same)), key=lambda number: same[number].left_over)
        one = same[worst]
        rows.append(
            (
                one.structure,
                masts.states[worst].condition,
                one.wire,
                f"{one.x:.1f}",
                f"{1e3 * one.left_over:.0f}",
                f"{1e3 * one.required:.0f}",
                "within" if one.is_kept else "not within",
            )
        )
    return rows


def supports_csv(masts: Masts, line: Line) -> str:
    """Return the force of every wire on every support in every state as CSV.

    With the names and the chainage of the masts, where the line has them.
    """
    head = ("condition", "support", *_place_head(line), "x [m]", "wire", "held by",
            "lateral position [m]", "height [m]", "along [N]", "lateral [N]",
            "vertical [N]")  # fmt: skip
    return csv_text(
        head,
        (
            (
                state.condition,
                one.support,
                *_place(line, one.support),
                f"{one.x:.4f}",
                one.wire,
                one.held_by,
                f"{one.lateral_position:.4f}",
                f"{one.height:.4f}",
                *(f"{value:.2f}" for value in (one.along, one.lateral, one.vertical)),
            )
            for state in masts.states
            for one in state.forces
        ),
    )


def _place_head(line: Line) -> tuple[str, ...]:
    names = {"mast": line.masts, "chainage [m]": line.chainage}
    return tuple(name for name, given in names.items() if given is not None)


def _place(line: Line, support: int) -> tuple[str, ...]:
    mast = () if line.masts is None else (line.masts[support - 1],)
    chainage = () if line.chainage is None else (f"{line.chainage[support - 1]:.4f}",)
    return (*mast, *chainage)


def installation_csv(masts: Masts, line: Line) -> str:
    """Return the installation table as CSV, one column per temperature [mm]."""
    names = zip(masts.conditions, masts.temperatures, strict=True)
    told = (f"{n}, {t:g} degC [mm]" for n, t in names)
    head = ("support", *_place_head(line), "x [m]", "wire", "what", *told)
    return csv_text(head, (_installed(one, line) for one in masts.installation))


def _installed(one: Installed, line: Line) -> tuple[object, ...]:
    offsets = ("" if math.isnan(value) else f"{1e3 * value:.2f}" for value in one.offsets)
    place = (one.support, *_place(line, one.support), f"{one.x:.4f}")
    return (*place, one.wire, one.what, *offsets)
