"""Rows about ranked corrections, for the terminal, the crew's page and CSV alike."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from tautwire.analyses.survey.corrections import Correction
from tautwire.analyses.survey.rank import Figures, Ranked, Ranking
from tautwire.report.parts.words import counted
from tautwire.specs.line.catenary import Line
from tautwire.text import csv_text

RANK_HEAD = ("", "place", "x\n[m]", "set\n[mm]", "to\n[mm]", "effect\n[N]", "σ alone\n[N]",
             "σ then\n[N]", "max then\n[N]", "min then\n[N]")  # fmt: skip
CREW_HEAD = ("", "place", "from support [m]", "as built [mm]", "set to [mm]", "change [mm]", "done")
FIGURE_HEAD = ("line", "corrected", "as built", "predicted", "computed",
               *("as built", "computed") * 3)  # fmt: skip
FIGURE_GROUPS = (("", 2), ("σ [N]", 3), ("max [N]", 2), ("min [N]", 2), ("loss [%]", 2))
"""Heading of the figures of a line, and the upper one: as built, and with the first corrections as
computed; of σ as predicted, too."""
FIGURE_NARROW = ("", "set", "σ [N]\nbuilt", "\npredicted", "\nthen", "max [N]\nbuilt", "\nthen",
                 "min [N]\nbuilt", "\nthen", "loss [%]\nbuilt", "\nthen")  # fmt: skip
"""The same for the terminal."""
RISES = "\N{UPWARDS ARROW}"
"""Mark of a correction that raises the standard deviation when it is made alone."""
SHOWN = 30
"""Corrections on the terminal; all are in the files."""


def line_names(rankings: Sequence[Ranking]) -> list[str]:
    """Name the lines; those of one name are told apart by their numbers."""
    names = [ranking.case.name for ranking in rankings]
    return [
        name if names.count(name) == 1 else f"{name} ({number})"
        for number, name in enumerate(names, 1)
    ]


def listed(rankings: Sequence[Ranking]) -> list[tuple[int, Ranked]]:
    """Return all corrections with the number of their line, from 0, in the order of the list."""
    found = [(line, one) for line, ranking in enumerate(rankings) for one in ranking.ranked]
    return sorted(found, key=lambda item: item[1].place)


def place_of(one: Correction, line: Line) -> str:
    """Name the place of a correction, by masts and chainage where the line has them."""
    if one.kind != "dropper":
        return f"{one.kind}, {line.support_in_words(one.number)}"
    parts = [f"dropper {one.number} of span {one.span}"]
    if line.masts is not None:
        parts.append(f"mast {line.masts[one.span - 1]} to {line.masts[one.span]}")
    if line.chainage is not None:
        parts.append(f"km {line.chainage_at(one.x) / 1e3:.3f}")
    return ", ".join(parts)


def rank_rows(rankings: Sequence[Ranking]) -> list[tuple[str, ...]]:
    """Return one row per correction, with the figures predicted for it and those before it."""
    names, rows = line_names(rankings), []
    for line, one in listed(rankings):
        ranking, then = rankings[line], one.together
        alone = _rise(ranking, one)
        rows.append(
            (
                str(one.place),
                _in_line(place_of(one.correction, ranking.case.line), names, line),
                f"{one.correction.x:.2f}",
                f"{1e3 * one.correction.change:+.1f}",
                _target(one.correction),
                f"{one.effect:.2f}",
                f"{alone:+.3f} {RISES if alone > 0.0 else ' '}",
                f"{then.standard_deviation:.2f}",
                f"{then.maximum:.1f}",
                f"{then.minimum:.1f}",
            )
        )
    return rows


def _rise(ranking: Ranking, one: Ranked) -> float:
    """Return by how much a correction alone raises the standard deviation [N]."""
    return one.alone.standard_deviation - ranking.built.standard_deviation


def worse_lines(rankings: Sequence[Ranking]) -> list[str]:
    """Say of which lines the first corrections together raise the standard deviation."""
    return [
        f"{name}: with the first {counted(one.made, 'correction')} σ is "
        f"{one.checked.standard_deviation:.2f} N, more than the "
        f"{one.built.standard_deviation:.2f} N as built: deviations that made up for each other "
        f"are corrected in part; leave out those that raise σ alone ({RISES}), or make more of "
        "them (--first)"
        for name, one in zip(line_names(rankings), rankings, strict=True)
        if one.checked.standard_deviation > one.built.standard_deviation
    ]


def _in_line(text: str, names: Sequence[str], line: int) -> str:
    """Say of which line something is told, where there are several."""
    return text if len(names) == 1 else f"{names[line]}: {text}"


def _target(one: Correction) -> str:
    return f"{1e3 * one.design:.0f}" if one.kind == "dropper" else "design"


def crew_rows(rankings: Sequence[Ranking]) -> list[tuple[str, ...]]:
    """Return the first corrections as a crew needs them, line by line and from left to right."""
    names, rows = line_names(rankings), []
    for line, ranking in enumerate(rankings):
        spec = ranking.case.line
        masts = spec.support_positions()
        for one in sorted(ranking.ranked[: ranking.made], key=lambda one: one.correction.x):
            told = one.correction
            rows.append(
                (
                    f"{one.place} {RISES}" if _rise(ranking, one) > 0.0 else str(one.place),
                    _in_line(place_of(told, spec), names, line),
                    f"{told.x - masts[told.span - 1]:.2f}" if told.kind == "dropper" else "",
                    f"{1e3 * told.built:.0f}" if told.kind == "dropper" else "",
                    _target(told),
                    f"{1e3 * told.change:+.0f}",
                    "",
                )
            )
    return rows


def figure_rows(rankings: Sequence[Ranking]) -> list[tuple[str, ...]]:
    """Return one row for every line with corrections that are made, under :data:`FIGURE_HEAD`."""
    rows = []
    for name, one in zip(line_names(rankings), rankings, strict=True):
        if one.made:
            predicted = one.ranked[one.made - 1].together
            rows.append((name, str(one.made), *_figures(one.built, predicted, one.checked)))
    return rows


def _figures(built: Figures, predicted: Figures, checked: Figures) -> Iterator[str]:
    yield from (f"{one.standard_deviation:.2f}" for one in (built, predicted, checked))
    yield from (f"{one.maximum:.1f}" for one in (built, checked))
    yield from (f"{one.minimum:.1f}" for one in (built, checked))
    yield from (f"{100.0 * one.loss:.3f}" for one in (built, checked))


def corrections_csv(rankings: Sequence[Ranking]) -> str:
    """Return all corrections as CSV."""
    head = ("rank", "line", "kind", "span or support", "number", "place", "x [m]", "as built [m]",
            "design [m]", "effect [N]", "sigma alone [N]", "max alone [N]", "min alone [N]",
            "loss alone", "sigma then [N]", "max then [N]", "min then [N]", "loss then",
            "uplift change [m]")  # fmt: skip
    names, rows = line_names(rankings), []
    for line, one in listed(rankings):
        told, alone, then = one.correction, one.alone, one.together
        rows.append(
            (
                one.place, names[line], told.kind, told.span, told.number,
                place_of(told, rankings[line].case.line), f"{told.x:.3f}",
                f"{told.built:.5f}", f"{told.design:.5f}", f"{one.effect:.4g}",
                *(f"{value:.5g}" for f in (alone, then) for value in vars(f).values()),
                f"{one.uplift:.5f}",
            )
        )  # fmt: skip
    return csv_text(head, rows)
