"""What ``run`` shows on the terminal."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

from tautwire.assessment.checks import Check
from tautwire.assessment.references import (
    ReferenceRow,
    compare_with_reference,
    load_references,
)
from tautwire.cli.progress import duration
from tautwire.cli.views.conditions_view import condition_facts
from tautwire.cli.views.loss_view import loss_cells, loss_view
from tautwire.cli.views.tables import batched, facts, heading, table
from tautwire.inputs.overrides import OVERRIDDEN
from tautwire.report.parts.words import MISSING, counted, quantity, readable, speed, with_error
from tautwire.results.accuracy import error_of
from tautwire.results.run import Run
from tautwire.results.statistics import ContactLoss, PantographStatistics, RunStatistics
from tautwire.specs.case import Case
from tautwire.text import marked

MOST_LOSSES = 10
"""Losses of contact of one pantograph that are listed."""
MOST_COLUMNS = 4
"""Columns of numbers that a table may have before another one is begun."""

UNCHECKED = "not checked: nobody compared the limit with the standard's text"

QUANTITIES = {
    "mean": "mean",
    "maximum": "largest",
    "minimum": "smallest",
    "statistical_maximum": "mean + 3 σ",
    "statistical_minimum": "mean − 3 σ",
    "uplift": "uplift at supports",
    "loss_percent": "contact loss",
}


def run_view(run: Run, statistics: RunStatistics, checks: Sequence[Check]) -> list[Any]:
    """Return the tables of a run."""
    parts: list[Any] = [
        heading(run.case.title or run.case.name, speed(run.case.scenario.speed)),
        _facts(run, statistics),
        heading("Contact force [N]", "over the section"),
        *(_force_table(run, some) for some in batched(_columns(statistics), MOST_COLUMNS)),
        heading("Passage", _uplift(run, statistics)),
        *(_passage_table(run, some) for some in batched(statistics.pantographs, MOST_COLUMNS)),
        *_losses(statistics),
        heading("Limits", "" if all(check.verified for check in checks) else UNCHECKED),
        _check_table(checks, many=len(run.pantographs) > 1),
        *(f"{check.name}: {check.explanation}" for check in checks if check.explanation),
    ]
    return parts + reference_view(run, statistics)


def _facts(run: Run, statistics: RunStatistics) -> Any:
    section, counters = statistics.section, run.counters
    changed = changed_inputs(run.case)
    spans = f"spans {section.first_span} to {section.last_span}"
    passes = counters.get("tuning_passes") or 0
    work = f"{counters.get('steps', 0)} steps, {duration(counters.get('cpu_s', 0.0))} of CPU time"
    if passes:
        work += f" for the last of {counted(passes, 'passage')}"
    return facts(
        [
            ("status", run.status),
            *condition_facts(run.case),
            ("section", f"{spans}, {section.start:g} to {section.end:g} m"),
            ("contact stiffness", f"{1e-3 * run.case.settings.contact_stiffness:g} kN/m"),
            ("set for this run", ", ".join(changed) or "nothing"),
            ("headline filter", statistics.pantographs[0].headline.description),
            ("work", work),
            ("step control", str(counters.get("step_control", ""))),
            ("backend", str(counters.get("backend", ""))),
            *error_facts(run),
        ]
    )  # fmt: skip


def error_facts(run: Run) -> list[tuple[str, str]]:
    """Say where the numerical errors come from that stand behind ±."""
    found = run.accuracy
    if found is None:
        return []
    facts = [("± is", f"the numerical error, {found.kind}: {found.told}, {duration(found.cpu_s)}")]
    errors = {record.name: found.of(record.name, "history") for record in run.pantographs}
    told = ", ".join(
        f"{quantity(error, 'N', 2)} rms ({name})"
        for name, error in errors.items()
        if math.isfinite(error)
    )
    return [*facts, ("error of F(t)", f"{told}, unfiltered, from the time step")] if told else facts


def _columns(statistics: RunStatistics) -> list[tuple[str, PantographStatistics, str]]:
    """Return heading, pantograph and kind of filter of every column."""
    many = len(statistics.pantographs) > 1
    return [
        (f"{entry.name}\n{_short(kind)}" if many else _short(kind), entry, kind)
        for entry in statistics.pantographs
        for kind in entry.filtered
    ]


def _short(kind: str) -> str:
    return {"butterworth": "Butterworth"}.get(kind, kind)


def _force_table(run: Run, columns: Sequence[tuple[str, PantographStatistics, str]]) -> Any:
    parts = [entry.filtered[kind] for _, entry, kind in columns]
    low = f"0_{parts[0].cutoff:g}"

    def told(name: str, values: Iterable[float]) -> list[str]:
        errors = (error_of(run.accuracy, entry.name, kind, name) for _, entry, kind in columns)
        return [with_error(v, e, 2) for v, e in zip(values, errors, strict=True)]

    def seen(name: str, values: Iterable[float], band: str) -> list[str]:
        pairs = zip(told(name, values), parts, strict=True)
        return [marked(text, is_carried=part.carries(band)) for text, part in pairs]

    def headline(name: str) -> list[str]:
        return seen(name, (getattr(part, name) for part in parts), low)

    rows = [("mean", *told("mean", (part.mean for part in parts)))]
    for band in parts[0].standard_deviations:
        values = seen(band, (part.standard_deviations[band] for part in parts), band)
        rows.append((f"σ {band.replace('_', '-')} Hz", *values))
    rows += [
        (f"{QUANTITIES[name]}, 0-{parts[0].cutoff:g} Hz", *headline(name))
        for name in ("maximum", "minimum", "statistical_maximum", "statistical_minimum")
    ]  # fmt: skip
    return table(("", *(head for head, _, _ in columns)), "l" + "r" * len(columns), rows)


def _uplift(run: Run, statistics: RunStatistics) -> str:
    uplift = statistics.uplift
    if not math.isfinite(uplift.maximum):
        return ""
    support = uplift.supports[uplift.uplift == uplift.maximum][0]
    where = run.case.line.support_in_words(int(support))
    error = 1e3 * error_of(run.accuracy, "uplift")
    return f"largest uplift at a support {with_error(1e3 * uplift.maximum, error)} mm ({where})"


def _passage_table(run: Run, entries: Sequence[PantographStatistics]) -> Any:
    losses = [entry.contact_loss for entry in entries]

    def share(loss: ContactLoss) -> str:
        error = error_of(run.accuracy, loss.pantograph, "loss")
        return f"{with_error(loss.percent, error, 3)} %"

    rows = [
        ("uplift force", *(quantity(entry.uplift_force, "N", 2) for entry in entries)),
        ("tuned to a mean of", *(_target(entry) for entry in entries)),
        ("contact losses", *loss_cells(losses, lambda loss: str(loss.count))),
        ("5 ms or longer", *loss_cells(losses, lambda loss: str(loss.count_over()))),
        ("share of time", *loss_cells(losses, share)),
        ("longest", *loss_cells(losses, lambda loss: quantity(1e3 * loss.longest, "ms"))),
    ]
    heads = ("", *(entry.name for entry in entries))
    return table(heads, "l" + "r" * len(entries), rows)


def _losses(statistics: RunStatistics) -> list[Any]:
    """List the longest losses of every pantograph that lost contact."""
    lost = [entry.contact_loss for entry in statistics.pantographs if entry.contact_loss.count]
    return [part for loss in lost for part in loss_view(loss, MOST_LOSSES)]


def _target(entry: PantographStatistics) -> str:
    return "not tuned" if entry.target_mean is None else quantity(entry.target_mean, "N", 2)


def _check_table(checks: Sequence[Check], *, many: bool) -> Any:
    rows = []
    for check in checks:
        name = f"{check.name}, {check.pantograph}" if many and check.pantograph else check.name
        sign = "≤" if check.sense == "maximum" else "≥"
        found = {True: "within", False: "not within", None: MISSING}[check.within]
        rows.append(
            (
                name,
                marked(readable(check.value, check.unit, check.error), is_carried=check.is_carried),
                f"{sign} {readable(check.limit, check.unit)}",
                check.standard,
                found,
                "checked" if check.verified else "not checked",
            )
        )
    heads = ("", "value", "limit", "standard", "value is", "limit is")
    return table(heads, "Lrrlll", rows)


def changed_inputs(case: Case) -> list[str]:
    """Return the paths of the inputs that were set for this run."""
    return [source.path for source in case.sources if source.source == OVERRIDDEN]


def reference_view(run: Run, statistics: RunStatistics) -> list[Any]:
    """Return comparisons with published results of the same reference line and speed."""
    parts: list[Any] = []
    changed = set(changed_inputs(run.case)) - {"scenario.speed"}
    library, name, speed = load_references(), run.case.name, run.case.scenario.speed
    every: list[ReferenceRow] = []
    for reference in library.of_case(name, speed):
        rows = compare_with_reference(statistics, reference, accuracy=run.accuracy)
        every += rows
        known = "remembered, not read" if reference.provisional else "published"
        known += ", for the line as published" if changed else ""
        parts += [heading(reference.title, known), reference_table(rows)]
    return [*parts, *(own.text for own in library.explain(name, speed, every))]


def reference_table(rows: Iterable[ReferenceRow]) -> Any:
    """Return the numbers of a run beside published ones."""
    cells = [
        (
            _quantity_name(row.quantity),
            marked(readable(row.value, row.unit, row.error), is_carried=row.is_carried),
            _published(row),
            _outcome(row),
        )
        for row in rows
    ]
    return table(("", "this run", "published", "comparison"), "lrrr", cells)


def _quantity_name(name: str) -> str:
    if name.startswith("std_"):
        return f"σ {name[4:].replace('_', '-')} Hz"
    return QUANTITIES.get(name, name)


def _published(row: ReferenceRow) -> str:
    if row.target is not None:
        return readable(row.target, row.unit)
    low, high = readable(row.low, row.unit), readable(row.high, row.unit)
    return high if low == high else f"{low.split()[0]} to {high}"


def _outcome(row: ReferenceRow) -> str:
    if row.deviation is not None and math.isfinite(row.deviation):
        return f"{'+' if row.deviation >= 0 else ''}{quantity(100 * row.deviation, '%')}"
    if row.inside is None:
        return MISSING
    return "inside" if row.inside else "outside"
