"""Rows about ranked corrections, for the terminal, the crew's page and CSV alike."""

from __future__ import annotations

from tautwire.analyses.survey.corrections import Correction
from tautwire.analyses.survey.rank import TOGETHER, Figures, Ranking
from tautwire.text import csv_text

RANK_HEAD = ("", "place", "x\n[m]", "set\n[mm]", "to\n[mm]", "effect\n[N]", "σ alone\n[N]",
             "σ then\n[N]", "max then\n[N]", "min then\n[N]")  # fmt: skip
CREW_HEAD = ("", "place", "x [m]", "as built [mm]", "set to [mm]", "change [mm]", "done")
FIGURE_HEAD = ("", "σ [N]", "max [N]", "min [N]", "loss [%]")
SHOWN = 30
"""Corrections on the terminal; all are in the files."""


def place_of(one: Correction) -> str:
    """Name the place of a correction."""
    if one.kind == "dropper":
        return f"dropper {one.number} of span {one.span}"
    return f"{one.kind}, support {one.number}"


def rank_rows(ranking: Ranking) -> list[tuple[str, ...]]:
    """Return one row per correction, with the figures predicted for it and those before it."""
    rows = []
    for number, one in enumerate(ranking.ranked, 1):
        then = one.together
        gain = one.alone.standard_deviation - ranking.built.standard_deviation
        rows.append(
            (
                str(number),
                place_of(one.correction),
                f"{one.correction.x:.2f}",
                f"{1e3 * one.correction.change:+.1f}",
                _target(one.correction),
                f"{one.effect:.2f}",
                f"{gain:+.3f}",
                f"{then.standard_deviation:.2f}",
                f"{then.maximum:.1f}",
                f"{then.minimum:.1f}",
            )
        )
    return rows


def _target(one: Correction) -> str:
    return f"{1e3 * one.design:.0f}" if one.kind == "dropper" else "design"


def crew_rows(ranking: Ranking) -> list[tuple[str, ...]]:
    """Return the first corrections as a crew needs them, from left to right."""
    first = enumerate(ranking.ranked[:TOGETHER], 1)
    ordered = sorted(first, key=lambda item: item[1].correction.x)
    return [
        (
            str(number),
            place_of(one.correction),
            f"{one.correction.x:.2f}",
            f"{1e3 * one.correction.built:.0f}" if one.correction.kind == "dropper" else "",
            _target(one.correction),
            f"{1e3 * one.correction.change:+.0f}",
            "",
        )
        for number, one in ordered
    ]


def figure_rows(ranking: Ranking) -> list[tuple[str, ...]]:
    """Return the figures as built, and with the first corrections as predicted and computed."""
    count = min(TOGETHER, len(ranking.ranked))
    last = ranking.ranked[count - 1].together
    return [
        _figures("as built", ranking.built),
        _figures(f"first {count} corrected, predicted", last),
        _figures(f"first {count} corrected, computed", ranking.checked),
    ]


def _figures(name: str, one: Figures) -> tuple[str, ...]:
    return (
        name,
        f"{one.standard_deviation:.2f}",
        f"{one.maximum:.1f}",
        f"{one.minimum:.1f}",
        f"{100.0 * one.loss:.3f}",
    )


def corrections_csv(ranking: Ranking) -> str:
    """Return all corrections as CSV."""
    head = ("rank", "kind", "span or support", "number", "x [m]", "as built [m]", "design [m]",
            "effect [N]", "sigma alone [N]", "max alone [N]", "min alone [N]", "loss alone",
            "sigma then [N]", "max then [N]", "min then [N]", "loss then",
            "uplift change [m]")  # fmt: skip
    rows = []
    for number, one in enumerate(ranking.ranked, 1):
        told, alone, then = one.correction, one.alone, one.together
        rows.append(
            (
                number, told.kind, told.span, told.number, f"{told.x:.3f}",
                f"{told.built:.5f}", f"{told.design:.5f}", f"{one.effect:.4g}",
                *(f"{value:.5g}" for f in (alone, then) for value in vars(f).values()),
                f"{one.uplift:.5f}",
            )
        )  # fmt: skip
    return csv_text(head, rows)
