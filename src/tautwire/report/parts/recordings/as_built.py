"""Rows about a line as built, for the terminal, the page and CSV alike."""

from __future__ import annotations

import math

from tautwire.analyses.survey.as_built import AsBuilt, BuiltDropper
from tautwire.line.expand import expand
from tautwire.report.parts.tables import columns_of_places, dropper_csv
from tautwire.text import csv_text

DROPPER_HEAD = ("span", "no.", "x\n[m]", "design\n[mm]", "as built\n[mm]", "±\n[mm]",
                "change\n[mm]", "force\n[N]", "state")  # fmt: skip
SUPPORT_HEAD = ("support", "x\n[m]", "contact\n[m]", "change\n[mm]", "±\n[mm]",
                "messenger\n[m]", "change\n[mm]", "±\n[mm]")  # fmt: skip
_HEIGHTS_OF = "contact", "messenger"


def summary_rows(built: AsBuilt) -> list[tuple[str, str]]:
    """Return what the survey was and how the estimate meets it."""
    slack = sum(one.state == "slack" for one in built.droppers)
    unsure = sum(one.state == "undecided" for one in built.droppers)
    change = [one.length - one.design for one in built.droppers if one.state != "slack"]
    spread = math.sqrt(sum(x * x for x in change) / max(len(change), 1))
    return [
        ("survey", f"{built.survey.label}, {len(built.survey.readings)} readings"),
        ("misfit", f"{built.misfit:.2f} times the stated accuracy (rms)"),
        ("droppers", f"{len(built.droppers)}: {slack} slack, {unsure} perhaps slack"),
        ("scatter", f"{1e3 * spread:.1f} mm rms about the design, as estimated"),
    ]


def finding_lines(built: AsBuilt) -> list[str]:
    """Return errors of allocation and odd readings, a sentence each."""
    lines = []
    for one in built.allocations:
        others = "".join(f", or {other.text}" for other in one.alternatives)
        lines.append(
            f"{one.hypothesis.text}{others} (likelier by exp({one.gain:.1f}); chance reaches "
            f"exp({one.threshold:.1f}))"
        )
    lines += [
        f"{one.where}: the {one.quantity} is off by {abs(by):.1f} times its accuracy; check it"
        for one, by in built.odd
    ]
    return lines


def dropper_rows(built: AsBuilt) -> list[tuple[str, ...]]:
    """Return one row per dropper."""
    return [_dropper_row(one) for one in built.droppers]


def _dropper_row(one: BuiltDropper) -> tuple[str, ...]:
    least = "≥ " if one.state == "slack" else ""
    return (
        str(one.span),
        str(one.dropper),
        f"{one.x:.2f}",
        f"{1e3 * one.design:.1f}",
        f"{least}{1e3 * one.length:.1f}",
        f"{1e3 * one.error:.1f}",
        f"{1e3 * (one.length - one.design):+.1f}",
        f"{one.force:.0f}",
        one.state,
    )


def support_rows(built: AsBuilt) -> list[tuple[str, ...]]:
    """Return one row per support; heights that the support does not give are left empty."""
    return [
        (
            str(one.support),
            f"{one.x:.2f}",
            *_height(one.contact_design, one.contact, one.contact_error),
            *_height(one.messenger_design, one.messenger, one.messenger_error),
        )
        for one in built.supports
    ]


def _height(design: float, value: float, error: float) -> tuple[str, str, str]:
    if math.isnan(value):
        return "", "", ""
    return f"{value:.4f}", f"{1e3 * (value - design):+.1f}", f"{1e3 * error:.1f}"


def droppers_csv(built: AsBuilt) -> str:
    """Return the droppers as CSV, a table that a case can name.

    The length of a slack dropper is the least that it can be.
    """
    hangers, droppers = expand(built.case).hangers, built.droppers
    places = columns_of_places(
        built.case,
        [one.span for one in droppers],
        [one.dropper for one in droppers],
        [one.x for one in droppers],
        [(hanger.upper.run, hanger.lower.run) for hanger in hangers],
    )
    values = {
        "unstrained length [m]": [f"{one.length:.6f}" for one in droppers],
        "standard error [mm]": [f"{1e3 * one.error:.2f}" for one in droppers],
        "length of the design [m]": [f"{one.design:.6f}" for one in droppers],
        "force [N]": [f"{one.force:.1f}" for one in droppers],
        "contact wire height [m]": [f"{one.height:.6f}" for one in droppers],
        "state": [one.state for one in droppers],
    }
    return dropper_csv(places, values)


def heights_csv(built: AsBuilt) -> str:
    """Return the heights at the supports as CSV."""
    parts = ("height [m]", "height, change [mm]", "height, ± [mm]")
    head = [f"{wire} {part}" for wire in _HEIGHTS_OF for part in parts]
    return csv_text(("support", "x [m]", *head), support_rows(built))
