"""Page section about the time step (V)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from tautwire.analyses.force.section import analysed_section
from tautwire.report.parts.blocks import Details, Section, Table, Text
from tautwire.report.parts.sections import chart
from tautwire.report.parts.words import MISSING, number
from tautwire.reproductions.song2021 import published
from tautwire.reproductions.song2021.pages import drawings_steps
from tautwire.reproductions.song2021.passages import FULL, UNCALIBRATED
from tautwire.reproductions.song2021.sections import steps
from tautwire.reproductions.song2021.sections.irregular import ideal

if TYPE_CHECKING:
    from tautwire.reproductions.song2021.reproduction import Material

_INTRODUCTION = (
    "The paper assumes the irregularity 'as a set of random uniform number' and states neither "
    "what it is nor its size. Readings: the contact wire is installed at wrong heights at the "
    "droppers, up to 2 mm (beyond 3 mm droppers would be slack at rest), or its running surface is "
    "uneven every 0.7 m, up to 1 mm for the stiff plane reading and up to 2 mm for the "
    f"uncalibrated one. {len(FULL.seeds)} random wires each, judged together; NAD 9, the uplift "
    "force of the ideal line. Each "
    "wire is passed with a constant step of 1 ms, read by counting samples without contact and by "
    "interpolating between samples; with the paper's variable step of 1 ms, in which steps end "
    "where contact opens or closes (|δ| < 0.1 mm); with 0.2 ms, counted; with steps refined around "
    "losses until their durations settle (adaptive); and with 0.05 ms, which the others are "
    "measured by. Losses from 1 ms on count."
)


def steps_section(material: Material) -> Section:
    """Show Figs 16 to 18 and Table 3."""
    blocks: list[object] = [Text(_INTRODUCTION)]
    trials = material.trials
    if trials:
        blocks += _figures(material)
        blocks += [_summary(trials), _against_paper(trials)]
        first = next((t for t in trials if t.losses()[steps.REFERENCE].count), trials[0])
        for trial in trials:
            if not trial.losses()[steps.REFERENCE].count:
                blocks.append(Text(f"{trial.name}: no contact is lost.", "note"))
            elif trial is first:
                blocks.append(_loss_table(trial, beside=True))
            else:
                blocks.append(Details(f"Table 3 for {trial.name}", (_loss_table(trial),)))
    return Section("steps", "Variable time step (V)", tuple(blocks))


def _figures(material: Material) -> list[object]:
    plain = [t for t in material.trials if not t.is_corrected]
    own = [t for t in plain if t.reading == UNCALIBRATED] or plain[:1]
    run = material.passages.run(ideal(own[0].reading))
    section = analysed_section(run)
    whens = {trial.kind: drawings_steps.telling_losses(trial.wires[0]) for trial in own}
    blocks: list[object] = []
    for trial in own:
        if whens[trial.kind] and not blocks:
            blocks.append(
                chart("fig-16", drawings_steps.separation(trial.wires[0], whens[trial.kind][0]),
                      "Fig. 16 of the paper, drawn from a separation of this passage. The line "
                      "through the undivided step meets zero near the located instant; the history "
                      "of 0.05 ms separates elsewhere, because a step of 1 ms has changed the "
                      "motion before.", "Penetration around a separation.")
            )  # fmt: skip
    blocks += [
        chart("fig-17", drawings_steps.irregular_presag(own, run.equilibrium,
              (section.start, section.end)), "Fig. 17 of the paper: running surface with "
              "irregularities, beside the ideal line.",
              "Static height of the irregular contact wire."),
        *(
            chart(f"fig-18-{trial.kind}", drawings_steps.step_forces(
                  trial.wires[0], whens[trial.kind]), "Fig. 18 of the paper, "
                  f"{trial.name}: unfiltered contact force by time step, enlarged around the "
                  "longest loss and around one that 1 ms misses or counts worst.",
                  "Contact force by time step.")
            for trial in own
        ),
    ]  # fmt: skip
    return blocks


def _summary(trials: list[steps.Trial]) -> Table:
    rows: list[tuple[str, ...]] = []
    for trial in trials:
        matches = trial.against(steps.REFERENCE)
        if not trial.losses()[steps.REFERENCE].count:
            continue
        for label, loss in trial.losses().items():
            match = matches.get(label)
            rows.append(
                (
                    _unbroken(trial.name),
                    _unbroken(label),
                    str(loss.count),
                    number(loss.percent, 2),
                    *(
                        (MISSING,) * 4
                        if match is None
                        else (
                            str(len(match.missed)),
                            str(len(match.spurious)),
                            _percent(match.median_error),
                            _percent(match.largest_error),
                        )
                    ),
                    number(trial.cpu(steps.WAYS[label][0]), 1),
                )
            )
    return Table(
        "Losses of contact by way to find them: share of the time lost; losses missed, losses "
        "invented and errors of durations beside 0.05 ms; processor time.",
        ("wire", "way", "losses", "lost [%]", "missed", "invented", "median", "largest", "CPU [s]"),
        "llrrrrrrr",
        tuple(rows),
        (("", 6), ("error [%]", 2), ("", 1)),
    )


def _against_paper(trials: list[steps.Trial]) -> Table:
    rows: list[tuple[str, ...]] = []
    columns = {
        steps.COUNTED_1: published.LOSS_CONSTANT_1,
        steps.COUNTED_5: published.LOSS_CONSTANT_5,
    }
    for label, column in columns.items():
        median, largest, missed = steps.published_errors(column)
        rows.append(
            (
                "the paper",
                _unbroken(label),
                "16",
                number(median, 1),
                number(largest, 1),
                str(missed),
            )
        )
        for trial in trials:
            match = trial.against(steps.PAPER)[label]
            rows.append(
                (_unbroken(trial.name), _unbroken(label), str(match.loss.count),
                 _percent(match.median_error), _percent(match.largest_error),
                 str(len(match.missed)))
            )  # fmt: skip
    return Table(
        "The same as the paper compares: differences from the variable step. Losses 'missed' are "
        "those of the variable step.",
        ("wire", "way", "losses", "median [%]", "largest [%]", "missed"),
        "llrrrr",
        tuple(rows),
    )


def _percent(share: float) -> str:
    return MISSING if math.isnan(share) else number(100.0 * share, 1)


def _loss_table(trial: steps.Trial, *, beside: bool = False) -> Table:
    matches = trial.against(steps.REFERENCE)
    rows: list[tuple[str, ...]] = []
    for i, event in enumerate(trial.losses()[steps.REFERENCE].events):
        pairs = {label: match.partner(event) for label, match in matches.items()}
        rows.append(
            (
                str(i + 1),
                number(event.start, 4),
                *(MISSING if p is None else number(1e3 * p.other.duration, 2)
                  for p in pairs.values()),
                number(1e3 * event.duration, 2),
                *(_published_row(i) if beside else ()),
            )
        )  # fmt: skip
    head = ("loss", "time [s]", *matches, steps.REFERENCE)
    if beside:
        head += ("1 ms", "0.2 ms", "variable")
    text = f"Table 3 of the paper, {trial.name}: duration of contact losses [ms]; a dash: not seen."
    if beside:
        text += " Beside it the losses as published: they belong to another random wire."
    groups = (("", 2), ("here", len(head) - 5), ("the paper", 3)) if beside else ()
    return Table(text, head, "r" * len(head), tuple(rows), groups)


def _unbroken(text: str) -> str:
    return text.replace(" ", "\N{NO-BREAK SPACE}")


def _published_row(i: int) -> tuple[str, ...]:
    columns = (published.LOSS_CONSTANT_1, published.LOSS_CONSTANT_5, published.LOSS_VARIABLE)
    if i >= len(columns[0]):
        return ("",) * 3
    return tuple(MISSING if c[i] is None else f"{c[i]:.2f}" for c in columns)
