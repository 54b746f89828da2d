"""Page sections about the high-frequency components and the time step (IV, V)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from tautwire.analyses.section import analysed_section
from tautwire.report.blocks import Heading, Section, Table, Text
from tautwire.report.sections import chart
from tautwire.report.words import number
from tautwire.reproductions.song2021 import drawings_high, published, sources, steps
from tautwire.reproductions.song2021.passages import (
    FITTING,
    IRREGULARITY,
    SPEEDS,
    irregular,
    standard,
)

if TYPE_CHECKING:
    from tautwire.reproductions.song2021.reproduction import Material

_FIGURES = {"DD/2": "Fig. 13", "SD/2": "Fig. 14", "DD/4": "As Fig. 13", "SD/4": "As Fig. 14"}


def sources_section(material: Material) -> Section:
    """Show Figs 10, 11, 13, 14 and 15."""
    blocks: list[object] = [Heading("Source of the high-frequency components (IV.A)")]
    blocks += _source_blocks(material)
    blocks.append(Heading("Amplification: modes (IV.B)"))
    for name, found in material.modes.items():
        if found.numbers:
            blocks.append(_mode_chart(name, found))
        else:
            text = f"{name}: none of {found.searched} modes is sensitive to it."
            blocks.append(Text(text, "note"))
    blocks.append(Heading("Suggested frequency range (IV.C)"))
    if material.curves:
        blocks += [
            chart("fig-15", drawings_high.speed_curves(material.curves), "Fig. 15 of the paper: "
                  "standard deviation over speed by cut-off, under each reading. Sharp low-pass.",
                  "Standard deviation over speed for three cut-offs."),
            _cutoff_table(material),
        ]  # fmt: skip
    return Section("components", "High-frequency components (IV)", tuple(blocks))


def _source_blocks(material: Material) -> list[object]:
    name = standard(9, FITTING)
    blocks: list[object] = []
    if material.passages.has(name):
        run = material.passages.run(name)
        section = analysed_section(run)
        blocks.append(
            chart("fig-10", drawings_high.presag({"contact wire": run.equilibrium},
                  (section.start, section.end)), "Fig. 10 of the paper: pre-sag of the contact "
                  "wire, NAD 9.", "Static height of the contact wire over the supports.")
        )  # fmt: skip
    found = material.sources.get(FITTING)
    if found is None:
        return blocks
    blocks.append(
        chart("fig-11", drawings_high.source_spectra(found), "Fig. 11 of the paper: amplitudes of "
              f"pre-sag and contact force ({FITTING} kN/m) at the multiples of 1/span, over wave "
              "number; lengths of the line marked. Hann window, spans 4 to 13, unfiltered.",
              "Spectra of pre-sag and contact force over wave number.")
    )  # fmt: skip
    rows = tuple(
        (label, number(energy, 1), number(width, 1))
        for label, own in found.combs.items()
        for energy, width in (sources.outside_share(own, found.lengths),)
    )
    blocks.append(
        Table("Waves shorter than 10 m: share of the energy outside the six regions, and share of "
              "the wave numbers outside them [%].", ("spectrum", "energy", "wave numbers"), "lrr",
              rows)
    )  # fmt: skip
    return blocks


def _mode_chart(name: str, found: drawings_high.Found) -> object:
    numbers = found.numbers
    caption = (
        f"{_FIGURES[name]} of the paper: mode at {numbers['frequency']:.2f} Hz, sensitive "
        f"wavelength {numbers['wavelength']:.3f} m; {name} is {found.wanted:.4g} m. Vertical "
        f"contact wire {100 * numbers['participation']:.0f} % of its kinetic energy; best of "
        f"{found.searched} modes; residual {numbers['residual']:.1e}."
    )
    summary = f"Shape and spectrum of the mode sensitive to {name}."
    return chart(f"mode-{name.replace('/', '-')}", drawings_high.mode(found), caption, summary)


def _cutoff_table(material: Material) -> Table:
    rows = tuple(
        (
            name.replace(" ", "\N{NO-BREAK SPACE}"),
            f"{speed}",
            f"{published.CUTOFFS[speed]:g}",
            number(float(own.cutoff[i]), 2),
            *(number(float(v[i]), 2) for v in (own.low, own.suggested, own.high)),
            number(100.0 * float(1.0 - own.suggested[i] / own.high[i]), 1),
            number(100.0 * float(1.0 - own.low[i] / own.high[i]), 1),
        )
        for name, own in material.curves.items()
        for i, speed in enumerate(SPEEDS)
    )
    return Table(
        "Suggested cut-off of 0.9 1/m, standard deviations [N], and the share of σ(0–200) that a "
        "cut-off misses [%].",
        ("reading", "speed [km/h]", "cut-off, paper [Hz]", "found", "σ 20 Hz", "σ suggested",
         "σ 200 Hz", "suggested misses", "20 Hz miss"),
        "lrrrrrrrr",
        rows,
    )  # fmt: skip


def steps_section(material: Material) -> Section:
    """Show Figs 16 to 18 and Table 3."""
    blocks: list[object] = [
        Text(
            "The paper assumes an irregularity 'as a set of random uniform number' without its "
            f"size. Here every dropper's pre-sag deviates at random by up to "
            f"{1e3 * IRREGULARITY:g} mm (beyond 3 mm droppers would be slack at rest). A constant "
            "step counts the samples without contact; 'located' puts separation and re-contact "
            "where the straight line through the penetrations of neighbouring samples crosses "
            "zero, which is the first iteration of the paper's variable step."
        )
    ]
    for k, table in material.losses.items():
        blocks += _loss_blocks(material, k, table)
    blocks.append(_published_table())
    return Section("steps", "Variable time step (V)", tuple(blocks))


def _loss_blocks(material: Material, k: int, table: steps.LossTable) -> list[object]:
    own = material.passages
    whens = drawings_high.telling_losses(table)
    blocks: list[object] = [Heading(f"Contact stiffness {k} kN/m")]
    if k == FITTING:
        run = own.run(irregular("1ms", k))
        section = analysed_section(run)
        if whens:
            starts = steps.located(run).start
            when = float(starts[np.argmin(np.abs(starts - whens[0]))])
            blocks.append(
                chart("fig-16", drawings_high.event(own, k, when), "Fig. 16 of the paper, drawn "
                      "from a separation of this run.", "Penetration around a separation.")
            )  # fmt: skip
        blocks.append(
            chart("fig-17", drawings_high.presag({"with irregularities": run.equilibrium,
                  "ideal": own.run(standard(9, k)).equilibrium}, (section.start, section.end)),
                  "Fig. 17 of the paper: pre-sag with irregularities, beside the ideal line.",
                  "Static height of the irregular contact wire.")
        )  # fmt: skip
        blocks.append(
            chart("fig-18", drawings_high.step_forces(own, k, whens), "Fig. 18 of the paper: "
                  "unfiltered contact force with both time steps, and enlarged around two losses.",
                  "Contact force with two time steps.")
        )  # fmt: skip
    blocks.append(
        _loss_table(k, table)
        if table.time.size
        else Text("No contact is lost at this contact stiffness.", "note")
    )
    return blocks


def _loss_table(k: int, table: steps.LossTable) -> Table:
    names = list(table.durations)
    reference = steps.VARIABLE if steps.VARIABLE in names else steps.LOCATED_1
    rows = []
    for i, start in enumerate(table.time.tolist()):
        values = {name: float(table.durations[name][i]) for name in names}
        wanted = values[reference]
        errors = [100.0 * abs(values[n] - wanted) / wanted for n in names[:2]]
        rows.append(
            (str(i + 1), number(start, 4), *(number(1e3 * values[n], 2) for n in names),
             *(number(e, 1) for e in errors))
        )  # fmt: skip
    return Table(
        f"Table 3 of the paper, {k} kN/m: duration of contact losses [ms] in the analysed section; "
        f"errors |t − t_ref|/t_ref with '{reference}' as reference [%]; "
        "verdicts use losses from 1 ms on. A dash: not seen.",
        ("loss", "time [s]", *names, *(f"error, {n}" for n in names[:2])),
        "r" * (4 + len(names)),
        tuple(rows),
    )


def _published_table() -> Table:
    def shown(value: float | None) -> str:
        return "not counted" if value is None else f"{value:.2f}"

    columns = (published.LOSS_CONSTANT_1, published.LOSS_CONSTANT_5, published.LOSS_VARIABLE)
    rows = tuple(
        (str(i), *(shown(v) for v in values))
        for i, values in enumerate(zip(*columns, strict=True), 1)
    )
    return Table(
        "Table 3 as published [ms]. Its losses belong to another random wire, so only their errors "
        "can be compared.",
        ("loss", "1 ms", "0.2 ms", "variable step"),
        "rrrr",
        rows,
    )
