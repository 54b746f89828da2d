"""Section of the losses of contact, one by one and run by run."""

from __future__ import annotations

import math
from collections.abc import Sequence

from tautwire.analyses.force.loss_comparison import SHORTEST, compare_losses
from tautwire.report.figures.loss_figures import MARGIN, enlarged_figure
from tautwire.report.parts.blocks import Cell, Columns, Details, Heading, Section, Table, Text
from tautwire.report.parts.sections import MOST_ROWS, chart, window_caption
from tautwire.report.parts.summary import statistics_of
from tautwire.report.parts.views import RunView, Series, series
from tautwire.report.parts.words import MISSING, number, quantity
from tautwire.results.loss_comparison import LossComparison, LossMatch
from tautwire.results.statistics import ARC_NOTE, ContactLoss, LossClass
from tautwire.text import marked


def loss_section(views: Sequence[RunView]) -> Section:
    """Write the section about losses of contact."""
    shown = series(views)
    blocks: list[object] = [Text(_sentence(item)) for item in shown]
    if any(statistics_of(item).contact_loss.count for item in shown):
        blocks.append(Text(f"{ARC_NOTE} {_reading(views)}", "note"))
        blocks.append(
            chart(
                "losses",
                enlarged_figure(views),
                "The longest losses of contact enlarged, unfiltered; samples are dots. Bars at "
                "zero force and below, one row for each run, are the losses from separation to "
                f"re-contact. {window_caption(views)}",
                f"Contact force from {1e3 * MARGIN:g} ms before to {1e3 * MARGIN:g} ms after the "
                "longest losses of contact.",
            )
        )
        tables = (_class_table(shown), _event_table(shown))
        if len(shown) == 1:
            blocks.append(Columns(tables))
        else:
            blocks += [tables[0], Details("All losses, one by one", tables[1:])]
    return Section("losses", "Losses of contact", (*blocks, *_comparison_blocks(views)))


def _sentence(item: Series) -> str:
    """Tell the losses of one pantograph in a sentence."""
    loss = statistics_of(item).contact_loss
    who = item.label or f"Pantograph {item.force.name}"
    if not loss.observed:
        return f"{who}: never in the analysed section."
    if not loss.count:
        none = marked("no loss of contact", is_carried=loss.is_carried)
        return f"{who}: {none} in the analysed section."
    longest = max(loss.events, key=lambda event: event.duration)
    losses = "1 loss" if loss.count == 1 else f"{loss.count} losses"
    losses = marked(losses, is_carried=loss.is_carried)
    return (
        f"{who}: {losses} of contact, {quantity(loss.percent, '%', 3)} of the time; "
        f"{loss.count_over()} of 5 ms or longer. The longest lasts "
        f"{quantity(1e3 * longest.duration, 'ms', 2)}, from t = {number(longest.start, 4)} s at "
        f"{longest.place}."
    )


def _reading(views: Sequence[RunView]) -> str:
    """Say where the instants of separation and re-contact come from."""
    located = [view.run.events is not None for view in views]
    if all(located):
        return "Instants of separation and re-contact are those of the step control."
    if any(located):
        return (
            "Instants are those of the step control where it located them, otherwise "
            "interpolated between samples."
        )
    return "Instants of separation and re-contact are interpolated between samples."


def _class_table(shown: Sequence[Series]) -> Table:
    losses = [statistics_of(item).contact_loss for item in shown]
    every = [loss.classes() for loss in losses]
    figures: list[tuple[str, list[str]]] = [
        (_class_name(part), [str(classes[index].count) for classes in every])
        for index, part in enumerate(every[0])
    ]
    figures.append(("all of 5 ms or longer", [str(loss.count_over()) for loss in losses]))
    figures.append(("share of time", [quantity(loss.percent, "%", 3) for loss in losses]))
    figures.append(
        ("share, 5 ms or longer", [quantity(loss.percent_over(), "%", 3) for loss in losses])
    )
    rows: list[tuple[Cell, ...]] = [
        (name, *(
            marked(text, is_carried=loss.is_carried)
            for text, loss in zip(texts, losses, strict=True)
        ))
        for name, texts in figures
    ]  # fmt: skip
    return Table(
        "Losses by duration, a surrogate for measured arcing.",
        ("", *(item.label or item.force.name for item in shown)),
        "l" + "r" * len(shown),
        tuple(rows),
    )


def _class_name(part: LossClass) -> str:
    if math.isinf(part.high):
        return f"{1e3 * part.low:g} ms or longer"
    return f"{1e3 * part.low:g} to {1e3 * part.high:g} ms"


def _event_table(shown: Sequence[Series]) -> Table:
    rows = [
        (
            item.label or item.force.name,
            number(event.start, 4),
            number(1e3 * event.duration, 2),
            number(event.position, 2),
            event.place,
        )
        for item in shown
        for event in statistics_of(item).contact_loss.events
    ]
    more = f" The first {MOST_ROWS} of {len(rows)}." if len(rows) > MOST_ROWS else ""
    return Table(
        f"Losses of contact in the analysed section, from the unfiltered gap.{more}",
        ("pantograph", "start [s]", "duration [ms]", "position [m]", "nearest"),
        "lrrrl",
        tuple(rows[:MOST_ROWS]),
    )


def _comparison_blocks(views: Sequence[RunView]) -> list[object]:
    """Compare the losses of the leading pantographs with those of the last run."""
    passages = {(v.run.case.scenario.speed, v.run.case.scenario.direction) for v in views}
    if len(views) < 2 or len(passages) > 1:
        return []
    losses: dict[str, ContactLoss] = {
        view.label: view.statistics.pantographs[0].contact_loss for view in views
    }
    if not any(loss.count for loss in losses.values()):
        return []
    compared = compare_losses(losses)
    text = (
        f"Leading pantographs, against the last run, {compared.label}. Losses that overlap, or lie "
        "less than 5 ms apart, are the same loss; the error of a duration is |t − t_ref|/t_ref. "
        f"Losses shorter than {1e3 * SHORTEST:g} ms, and those cut by the section, do not count."
    )
    tables = (_match_table(compared), _duration_table(compared))
    return [Heading("The runs loss by loss"), Text(text, "note"), *tables]


def _match_table(compared: LossComparison) -> Table:
    rows = [
        (
            match.label,
            marked(str(match.loss.count), is_carried=match.loss.is_carried),
            str(len(match.missed)),
            str(len(match.spurious)),
            quantity(100.0 * match.median_error, "%", 2),
            quantity(100.0 * match.largest_error, "%", 1),
            quantity(1e3 * match.largest_difference, "ms", 3),
        )
        for match in compared.matches
    ]
    heads = ("run", "losses", "missed", "spurious", "median error", "largest error", "")
    return Table(
        f"Against {compared.label} ({compared.reference.count} losses).",
        heads,
        "lrrrrrr",
        tuple(rows),
    )


def _duration_table(compared: LossComparison) -> Table:
    rows: list[tuple[float, tuple[Cell, ...]]] = []
    for index, event in enumerate(compared.reference.events):
        cells = [cell for match in compared.matches for cell in _pair_cells(match, index, compared)]
        own = number(1e3 * event.duration, 2)
        rows.append((event.start, (number(event.start, 4), event.place, own, *cells)))
    for column, match in enumerate(compared.matches):
        for event in match.spurious:
            cells = [MISSING] * (2 * len(compared.matches))
            cells[2 * column : 2 * column + 2] = number(1e3 * event.duration, 2), "spurious"
            start = number(event.start, 4)
            rows.append((event.start, (start, event.place, MISSING, *cells)))
    rows.sort(key=lambda row: row[0])
    count = len(compared.matches)
    return Table(
        "Durations [ms] and their errors, loss by loss.",
        ("start [s]", "nearest", compared.label, *("duration", "error") * count),
        "rlr" + "rr" * count,
        tuple(cells for _, cells in rows[:MOST_ROWS]),
        groups=(("", 3), *((match.label, 2) for match in compared.matches)),
    )


def _pair_cells(match: LossMatch, index: int, compared: LossComparison) -> tuple[str, str]:
    pair = match.partner(compared.reference.events[index])
    if pair is None:
        return MISSING, "missed"
    return number(1e3 * pair.other.duration, 2), quantity(100.0 * pair.error, "%", 1)
