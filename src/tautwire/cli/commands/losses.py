"""``losses``: contact losses of stored runs, one by one and run by run."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from tautwire.analyses.force.contact_loss import contact_loss
from tautwire.analyses.force.loss_comparison import compare_losses
from tautwire.cli.commands.results import load_runs
from tautwire.cli.session import Answer
from tautwire.cli.views.loss_view import loss_cells, loss_view, not_carried
from tautwire.cli.views.tables import facts, heading, table
from tautwire.errors import InputError
from tautwire.report.parts.views import labels_of
from tautwire.report.parts.words import MISSING, number, quantity
from tautwire.results.loss_comparison import LossComparison
from tautwire.results.run import Run
from tautwire.results.statistics import ARC_NOTE, ContactLoss
from tautwire.text import MARK, marked
from tautwire.version import __version__


def show_losses(
    answer: Answer, paths: Sequence[Path], pantograph: str | None, *, counted: bool
) -> None:
    """List the losses of contact of every run, and compare them with those of the last run."""
    runs = load_runs(paths)
    _refuse_different_passages(runs, paths)
    losses = {
        label: _losses_of(run, pantograph, counted=counted)
        for label, run in zip(labels_of(runs), runs, strict=True)
    }
    answer.document.update(
        {
            "version": __version__,
            "note": ARC_NOTE,
            "runs": [
                {"file": str(path), "label": label, "pantograph": loss.pantograph, **loss.as_dict()}
                for path, (label, loss) in zip(paths, losses.items(), strict=True)
            ],
        }
    )
    if len(losses) == 1:
        for loss in losses.values():
            answer.show(*loss_view(loss))
        return
    compared = compare_losses(losses)
    answer.document["comparison"] = compared.as_dict()
    answer.show(*_comparison_view(compared, losses))


def _refuse_different_passages(runs: Sequence[Run], paths: Sequence[Path]) -> None:
    """Refuse runs whose pantographs are not at the same place at the same time."""
    first = runs[0].case.scenario
    for run, path in zip(runs, paths, strict=True):
        scenario = run.case.scenario
        if (scenario.speed, scenario.direction) != (first.speed, first.direction):
            raise InputError(
                f"{path}: runs at {3.6 * scenario.speed:g} km/h in direction {scenario.direction}, "
                f"{paths[0]} at {3.6 * first.speed:g} km/h in direction {first.direction}; losses "
                "are matched in time, so give runs of one passage"
            )


def _losses_of(run: Run, pantograph: str | None, *, counted: bool) -> ContactLoss:
    name = run.pantographs[0].name if pantograph is None else run.pantograph(pantograph).name
    found = contact_loss(run, counted=counted)
    return next(loss for loss in found if loss.pantograph == name)


def _comparison_view(compared: LossComparison, losses: Mapping[str, ContactLoss]) -> list[Any]:
    """Return both tables of a comparison: totals, and durations loss by loss."""
    rows = [
        (
            match.label,
            *loss_cells([match.loss], lambda loss: str(loss.count)),
            *loss_cells([match.loss], lambda loss: str(loss.count_over())),
            str(len(match.missed)),
            str(len(match.spurious)),
            _percent(match.median_error),
            _percent(match.largest_error),
        )
        for match in compared.matches
    ]
    own = compared.reference
    none = (MISSING, MISSING, MISSING, MISSING)
    counts = (str(own.count), str(own.count_over()))
    told = (marked(count, is_carried=own.is_carried) for count in counts)
    rows.append((compared.label, *told, *none))
    heads = ("", "losses", "≥ 5 ms", "missed", "spurious", "median error", "largest")
    durations = [
        (
            number(event.start, 4),
            event.place,
            number(1e3 * event.duration, 2),
            *(
                MISSING if pair is None else number(1e3 * pair.other.duration, 2)
                for pair in (match.partner(event) for match in compared.matches)
            ),
        )
        for event in own.events
    ]
    labels = ("start [s]", "nearest", compared.label, *(m.label for m in compared.matches))
    parts = [
        heading("Losses of contact", f"{own.pantograph}, against the last run"),
        table(heads, "Lrrrrrr", rows),
        heading("Durations [ms]"),
        table(labels, "rl" + "r" * len(losses), durations),
    ]
    lone = [
        (f"{word} by {match.label}", f"{1e3 * event.duration:.2f} ms at {event.start:.4f} s, "
         f"{event.place}")
        for match in compared.matches
        for word, events in (("missed", match.missed), ("invented", match.spurious))
        for event in events
    ]  # fmt: skip
    unsure = {
        (f"{MARK} {label}", not_carried(loss))
        for label, loss in losses.items()
        if not loss.is_carried
    }
    return [*parts, facts([*lone, *sorted(unsure), ("note", ARC_NOTE)])]


def _percent(share: float) -> str:
    return MISSING if math.isnan(share) else quantity(100.0 * share, "%", 2)
