"""First section: the result in words, key numbers, statistics, limits and published results."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from tautwire.assessment.checks import Check
from tautwire.report.figures.animation import filmed
from tautwire.report.figures.line_figures import highest_support
from tautwire.report.parts import published
from tautwire.report.parts.blocks import (
    Callout,
    Cell,
    Columns,
    Heading,
    Key,
    Keys,
    Link,
    Section,
    Table,
    Text,
    Verdict,
)
from tautwire.report.parts.conditions import difference_blocks
from tautwire.report.parts.views import RunView, Series, series
from tautwire.report.parts.words import (
    MISSING,
    band,
    counted,
    listing,
    number,
    quantity,
    readable,
    speed,
    with_error,
)
from tautwire.results.accuracy import error_of
from tautwire.results.statistics import FilteredStatistics, PantographStatistics
from tautwire.text import marked

_KNOWN = {
    "seen": "a document that was read",
    "secondary source": "documents that quote the standard",
    "memory": "memory, without a document",
}
"""Confidence of a limit in words."""
BANDS = ("0_2", "0_5", "5_20", "0_20", "0_50", "0_100", "0_200")


def summary_section(views: Sequence[RunView], found: Sequence[Sequence[Check]]) -> Section:
    """Write the first section.

    Parameters
    ----------
    views : sequence of RunView
    found : sequence of sequences of Check
        Checks of each run.
    """
    shown = series(views)
    blocks: list[object] = []
    cautions = tuple(line for view in views for line in _cautions(view, many=len(views) > 1))
    blocks += [Callout(cautions)] if cautions else []
    if len(views) > 1:
        blocks += [Heading("What differs between the runs"), _beside_each_other(views)]
        blocks += [*difference_blocks(views), Heading("Results")]
    blocks += [Text(_statement(view, many=len(views) > 1), "statement") for view in views]
    if len(shown) == 1 and math.isfinite(statistics_of(shown[0]).headline.mean):
        blocks.append(_keys(views[0]))
    if filmed(views):
        blocks.append(Link("See the passage move", "animation"))
    tables = (_force_table(shown), _passage_table(shown))
    blocks += [Columns(tables)] if len(shown) == 1 else tables
    blocks += [Text(_filter_statement(shown), "note"), Heading("Limits")]
    blocks.append(Text(_verdict_statement(found), "plain"))
    blocks.append(_check_table(views, found))
    notes = _limit_notes(found)
    blocks += [Text(notes, "note")] if notes else []
    compared = [b for v in views for b in published.force_blocks(v, named=len(views) > 1)]
    blocks += [Heading("Published results"), *compared] if compared else []
    return Section("summary", "Summary", tuple(blocks))


def statistics_of(item: Series) -> PantographStatistics:
    """Return the statistics of a series."""
    return item.view.statistics.pantographs[item.view.forces.index(item.force)]


def _cautions(view: RunView, *, many: bool) -> tuple[str, ...]:
    """Say what limits the use of a run: its status, notes and warnings."""
    run, prefix = view.run, f"{view.label}: " if many else ""
    lines = []
    if run.status != "done":
        meaning = {
            "partial": "The run is partial; what was computed up to then is valid.",
            "failed": "The run failed; its numbers must not be used.",
        }.get(run.status, f"The status of the run is {run.status!r}.")
        lines.append(f"{prefix}{meaning} {run.message}".strip())
    lines += [f"{prefix}{note[:1].upper()}{note[1:]}." for note in view.statistics.notes]
    lines += [f"{prefix}Warning: {warning}" for warning in run.warnings]
    return tuple(lines)


def _statement(view: RunView, *, many: bool) -> str:
    """Tell the result of a run in a few sentences."""
    part = view.statistics.section
    spans = f"spans {part.first_span} to {part.last_span}"
    subject = f"{view.label}: at" if many else "At"
    start = f"{subject} {speed(view.run.case.scenario.speed)}, over {spans}, "
    sentences = [_force_sentence(entry) for entry in view.statistics.pantographs]
    uplift, support = view.statistics.uplift.maximum, highest_support(view)
    text = start + "; ".join(sentences) + "."
    if support is not None:
        text += (
            f" At the supports the contact wire rises by at most {quantity(1e3 * uplift, 'mm')} "
            f"({view.run.case.line.support_in_words(support)})."
        )
    return text


def _force_sentence(entry: PantographStatistics) -> str:
    values, loss = entry.headline, entry.contact_loss
    if not math.isfinite(values.mean):
        return f"pantograph {entry.name} was never in the analysed section"
    share = values.standard_deviation / values.mean if values.mean else math.nan
    text = (
        f"pantograph {entry.name} presses on the contact wire with a mean of "
        f"{quantity(values.mean, 'N')} and a standard deviation of "
        f"{quantity(values.standard_deviation, 'N')} ({number(100 * share, 0)} % of the mean), "
        f"between {quantity(values.minimum, 'N', 0)} and {quantity(values.maximum, 'N', 0)} "
        f"({band(f'0_{values.cutoff:g}')}, {_short(values.kind)} filter)"
    )
    if not loss.count:
        return f"{text}, and {marked('never loses contact', is_carried=loss.is_carried)}"
    losses = (
        f"it loses contact {counted(loss.count, 'time')}, at most for "
        f"{quantity(1e3 * loss.longest, 'ms')}"
    )
    return f"{text}; {marked(losses, is_carried=loss.is_carried)}"


def _beside_each_other(views: Sequence[RunView]) -> Table:
    """Put results side by side, and figures of the lines where they differ."""
    lines, results = [_line_figures(v) for v in views], [_result_figures(v) for v in views]
    rows = []
    for columns in (lines, results):
        for name in dict.fromkeys(name for column in columns for name in column):
            found = [column.get(name, _Figure(math.nan, MISSING)) for column in columns]
            if columns is results or len({figure.text for figure in found}) > 1:
                texts = (f"{one.text}{_change(one.value, found[0].value)}" for one in found)
                rows.append((name, *texts))
    return Table(
        caption="Lines and results; in brackets the difference from the first run. Forces are "
        "those of the leading pantograph, with the headline filter.",
        head=("", *(view.label for view in views)),
        align="l" + "r" * len(views),
        rows=tuple(rows),
    )


@dataclass(frozen=True)
class _Figure:
    """A number and how it is written."""

    value: float
    text: str


def _line_figures(view: RunView) -> dict[str, _Figure]:
    """Return the figures by which lines are told apart."""
    case, data = view.run.case, view.elasticity
    spans, wires = case.line.span_lengths(), case.wires
    ratio = case.scenario.speed / wires.contact.wave_speed()
    found = {
        "spans": (float(len(spans)), "", 0),
        "shortest span": (min(spans), "m", 1),
        "longest span": (max(spans), "m", 1),
        **{f"tension, {name}": (1e-3 * wire.tension, "kN", 2) for name, wire in wires.named()},
        "speed": (3.6 * case.scenario.speed, "km/h", 0),
        "speed over wave speed": (ratio, "", 3),
    }
    if data is not None:
        found |= {
            "least elasticity": (1e3 * float(data.elasticity.min()), "mm/N", 3),
            "largest elasticity": (1e3 * float(data.elasticity.max()), "mm/N", 3),
            "non-uniformity of the elasticity": (1e2 * data.nonuniformity, "%", 1),
        }
    return {
        name: _Figure(value, quantity(value, unit, digits))
        for name, (value, unit, digits) in found.items()
    }


def _result_figures(view: RunView) -> dict[str, _Figure]:
    """Return what a passage is judged by, of its leading pantograph."""
    entry = view.statistics.pantographs[0]
    part, loss = entry.headline, entry.contact_loss
    forces = {
        "standard deviation": part.standard_deviation,
        "largest force": part.maximum,
        "smallest force": part.minimum,
    }
    uplift = 1e3 * view.statistics.uplift.maximum
    return {
        "mean contact force": _Figure(part.mean, quantity(part.mean, "N")),
        **{
            name: _Figure(value, f"{_headline_cell(part, value)} N")
            for name, value in forces.items()
        },
        "largest uplift at a support": _Figure(uplift, quantity(uplift, "mm")),
        "contact loss": _Figure(loss.percent, _if_seen(entry, quantity(loss.percent, "%", 3))),
    }


def _change(value: float, first: float) -> str:
    """Return the difference from the first run as a share of it; nothing where there is none."""
    if not (math.isfinite(value) and math.isfinite(first)) or first == 0.0:
        return ""
    share = number(100.0 * (value / first - 1.0))
    return "" if share == number(0.0) else f" ({'+' if value > first else ''}{share} %)"


def _short(kind: str) -> str:
    return {"sharp": "sharp", "butterworth": "Butterworth"}.get(kind, kind)


def _keys(view: RunView) -> Keys:
    entry = view.statistics.pantographs[0]
    values, loss = entry.headline, entry.contact_loss
    share = 100 * values.standard_deviation / values.mean if values.mean else math.nan
    low = band(f"0_{values.cutoff:g}")
    return Keys(
        (
            Key(number(values.mean), "N", "mean contact force"),
            Key(_headline_cell(values, values.standard_deviation), "N",
                f"standard deviation σ, {low}"),
            Key(_headline_cell(values, share), "%", "σ as a share of the mean"),
            Key(_headline_cell(values, values.maximum), "N", f"largest force, {low}"),
            Key(_headline_cell(values, values.minimum), "N", f"smallest force, {low}"),
            Key(number(1e3 * view.statistics.uplift.maximum), "mm", "largest uplift at a support"),
            Key(_if_seen(entry, number(loss.percent, 2)), "%",
                f"contact loss, {counted(loss.count, 'event')}"),
        )
    )  # fmt: skip


def _force_table(shown: Sequence[Series]) -> Table:
    """Put the statistics of every series side by side, one column per filter."""
    entries = [(item, statistics_of(item)) for item in shown]
    columns = [(item, kind, e.filtered[kind]) for item, e in entries for kind in e.filtered]
    rows: list[tuple[Cell, ...]] = [
        ("mean", *(_told(item, kind, "mean", c.mean) for item, kind, c in columns))
    ]
    for name in BANDS:
        cells = [
            marked(
                _told(item, kind, name, c.standard_deviations.get(name)), is_carried=c.carries(name)
            )
            for item, kind, c in columns
        ]
        rows.append((f"σ, {band(name)}", *cells))
    for title, name in (
        ("largest", "maximum"),
        ("smallest", "minimum"),
        ("mean + 3 σ", "statistical_maximum"),
        ("mean − 3 σ", "statistical_minimum"),
    ):
        cells = [
            marked(
                _told(item, kind, name, getattr(c, name)), is_carried=c.carries(f"0_{c.cutoff:g}")
            )
            for item, kind, c in columns
        ]
        rows.append((title, *cells))
    groups = [(item.label, len(entry.filtered)) for item, entry in entries if item.label]
    return Table(
        caption="Contact force over the analysed section [N]",
        head=("", *(_short(kind) for _, kind, _ in columns)),
        align="l" + "r" * len(columns),
        rows=tuple(rows),
        groups=(("", 1), *groups) if groups else (),
    )


def _told(item: Series, kind: str, name: str, value: float | None) -> str:
    """Return a figure of the force with its numerical error, where the run has one."""
    return with_error(value, _error(item, statistics_of(item).name, kind, name), 2)


def _error(item: Series, *path: str) -> float:
    return error_of(item.view.run.accuracy, *path)


def _filter_statement(shown: Sequence[Series]) -> str:
    """Name the filters of the table with every number, and the other conventions."""
    parts = [part for item in shown for part in statistics_of(item).filtered.values()]
    filters = {part.kind: part.description for part in parts}
    found = [item.view.run.accuracy for item in shown if item.view.run.accuracy is not None]
    ways = dict.fromkeys(f" ± is the numerical error of mesh and step ({a.told})." for a in found)
    return (
        f"Filters: {'; '.join(filters.values())}. Standard deviations divide by the number of "
        "samples; mean and extremes are those of the force up to 20 Hz. Contact loss is read from "
        "the unfiltered gap between wire and head, its ends interpolated between samples."
        + "".join(ways)
    )


def _passage_table(shown: Sequence[Series]) -> Table:
    """Put uplift force, contact loss, uplift and contact height of every series side by side."""
    entries = [(item, statistics_of(item)) for item in shown]
    target = [quantity(e.target_mean, "N", 2) for _, e in entries]
    rows: list[tuple[Cell, ...]] = [
        ("uplift force", *(quantity(e.uplift_force, "N", 2) for _, e in entries)),
        ("tuned to a mean of", *(t if t != number(None) else "not tuned" for t in target)),
        ("contact losses", *(_if_seen(e, str(e.contact_loss.count)) for _, e in entries)),
        ("share of time", *(
            _if_seen(e, f"{with_error(e.contact_loss.percent, _error(i, e.name, 'loss'), 3)} %")
            for i, e in entries)),
        ("longest loss", *(
            _if_seen(e, quantity(1e3 * e.contact_loss.longest, "ms", 2)) for _, e in entries)),
        ("share, 5 ms or more", *(
            _if_seen(e, quantity(e.contact_loss.percent_over(), "%", 3)) for _, e in entries)),
        ("largest uplift at a support", *(
            f"{with_error(1e3 * i.view.statistics.uplift.maximum, 1e3 * _error(i, 'uplift'))} mm"
            for i, _ in entries)),
        ("range of contact height", *(
            quantity(1e3 * e.contact_height_range, "mm") for _, e in entries)),
    ]  # fmt: skip
    heads = [item.label or entry.name for item, entry in entries]
    return Table(
        caption="Passage over the analysed section",
        head=("", *heads),
        align="l" + "r" * len(heads),
        rows=tuple(rows),
    )


def _if_seen(entry: PantographStatistics, text: str) -> str:
    """Return the figure of losses, or a dash for a pantograph that never was in the section."""
    loss = entry.contact_loss
    return marked(text, is_carried=loss.is_carried) if loss.observed > 0.0 else MISSING


def _headline_cell(part: FilteredStatistics, value: float, digits: int = 1) -> str:
    """Return a figure of the force up to the headline cut-off."""
    return marked(number(value, digits), is_carried=part.carries(f"0_{part.cutoff:g}"))


def _verdict_statement(found: Sequence[Sequence[Check]]) -> str:
    """Say what the checks prove, and what they do not."""
    every = [check for row in found for check in row]
    if not every:
        return "No limit applies to this speed and supply system."
    unverified = [check for check in every if not check.verified]
    failed = list(dict.fromkeys(check.name for check in every if check.passed is False))
    outside = list(dict.fromkeys(c.name for c in unverified if c.within is False))
    parts = []
    if failed:
        parts.append(f"Not within: {listing(failed)}.")
    if len(unverified) == len(every):
        parts.append(
            "None of the limits below was checked against the text of its standard, so no verdict "
            "is given."
        )
    elif unverified:
        parts.append(
            f"Of {len(every)} limits, {len(unverified)} were not checked against the text of the "
            "standard; there no verdict is given."
        )
    if any(check.within is not None for check in unverified):
        parts.append(
            f"Beside the limits that were not checked, not within: {listing(outside)}."
            if outside
            else "Beside the limits that were not checked, every value lies within."
        )
    known = dict.fromkeys(f"{check.name[:1].upper()}{check.name[1:]}: {check.explanation}."
                          for check in every if check.explanation)  # fmt: skip
    return " ".join([*parts, *known]) or "Every value lies within its limit."


def _check_table(views: Sequence[RunView], found: Sequence[Sequence[Check]]) -> Table:
    many, is_checked = len(views) > 1, all(check.verified for row in found for check in row)
    rows = []
    for view, row in zip(views, found, strict=True):
        for check in row:
            who = [view.label] if many else []
            who += [check.pantograph] if check.pantograph and len(view.forces) > 1 else []
            sign = "≤" if check.sense == "maximum" else "≥"
            rows.append(
                (
                    ", ".join([check.name, *who]),
                    marked(
                        readable(check.value, check.unit, check.error), is_carried=check.is_carried
                    ),
                    f"{sign} {readable(check.limit, check.unit)}",
                    *(() if is_checked else (_within(check),)),
                    Verdict(check.words, check.verdict.replace("no value", "unverified")),
                    _standard(check),
                )
            )
    caption = (
        "Limits. No verdict is given beside a limit that nobody has checked against the text of "
        "its standard, whether the value lies within it or not."
    )
    head = ("criterion", "value", "limit", "value is", "verdict", "standard")
    return Table(
        caption=f"{'Limits.' if is_checked else caption} Forces are those of the headline filter.",
        head=tuple(name for name in head if name != "value is" or not is_checked),
        align="lrrll" if is_checked else "lrrlll",
        rows=tuple(rows),
    )


def _limit_notes(found: Sequence[Sequence[Check]]) -> str:
    """Say where the limits that nobody checked are known from."""
    known: dict[str, list[str]] = {}
    for check in (check for row in found for check in row if not check.verified):
        known.setdefault(_KNOWN.get(check.confidence, check.confidence), []).append(check.name)
    return " ".join(
        f"Limits known from {how}: {'; '.join(dict.fromkeys(names))}."
        for how, names in known.items()
    )


def _standard(check: Check) -> str:
    edition = f"{check.standard}:{check.edition}" if check.edition else check.standard
    text = f"{edition}, {check.clause}" if check.clause else edition
    return f"{text}; checked by {check.checked_by}, {check.checked_on}" if check.verified else text


def _within(check: Check) -> str:
    return {None: MISSING, True: "within", False: "not within"}[check.within]
