"""Page section about the high-frequency components (IV)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from tautwire.analyses.force.section import analysed_section
from tautwire.report.parts.blocks import Heading, Section, Table, Text
from tautwire.report.parts.sections import chart
from tautwire.report.parts.words import MISSING, number
from tautwire.reproductions.song2021 import published, sources
from tautwire.reproductions.song2021.pages import drawings_high
from tautwire.reproductions.song2021.passages import (
    SPEEDS,
    UNCALIBRATED,
    standard,
)
from tautwire.reproductions.song2021.sections import vibration

if TYPE_CHECKING:
    from tautwire.reproductions.song2021.reproduction import Material

_FIGURES = {"DD/2": "Fig. 13", "SD/2": "Fig. 14", "DD/4": "As Fig. 13", "SD/4": "As Fig. 14"}


def sources_section(material: Material) -> Section:
    """Show Figs 10, 11, 13, 14 and 15."""
    blocks: list[object] = [Heading("Source of the high-frequency components (IV.A)")]
    blocks += _source_blocks(material)
    blocks.append(Heading("Amplification: modes (IV.B)"))
    for name in vibration.FRACTIONS:
        found = material.modes.get(name)
        if found is None:
            continue
        if found.numbers:
            blocks.append(_mode_chart(name, found))
        else:
            text = f"{name}: none of {found.searched} modes is sensitive to it."
            blocks.append(Text(text, "note"))
    if material.modes:
        blocks.append(_control_table(material.modes))
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
    name = standard(9, UNCALIBRATED)
    blocks: list[object] = []
    if material.passages.has(name):
        run = material.passages.run(name)
        section = analysed_section(run)
        blocks.append(
            chart("fig-10", drawings_high.presag(run.equilibrium,
                  (section.start, section.end)), "Fig. 10 of the paper: pre-sag of the contact "
                  "wire, NAD 9.", "Static height of the contact wire over the supports.")
        )  # fmt: skip
    found = material.sources.get(UNCALIBRATED)
    if found is None:
        return blocks
    blocks.append(
        chart("fig-11", drawings_high.source_spectra(found), "Fig. 11 of the paper: amplitudes of "
              f"pre-sag and contact force ({UNCALIBRATED}) at the multiples of 1/span, over wave "
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


def _control_table(modes: Mapping[str, vibration.Found]) -> Table:
    rows = []
    for name in vibration.FRACTIONS:
        own = [modes[name]] if name in modes else []
        every = sorted([*own, *vibration.controls(modes, name)], key=lambda found: found.wanted)
        for found in every:
            numbers = found.numbers
            cells = (
                (number(numbers["frequency"], 2), number(numbers["participation"], 2),
                 number(numbers["concentration"], 2), number(found.score, 3))
                if numbers
                else (MISSING,) * 4
            )  # fmt: skip
            rows.append(
                (_unbroken(found.name), number(found.wanted, 3),
                 _unbroken(f"{found.sensitive} of {found.searched}"), *cells)
            )  # fmt: skip
    return Table(
        "Modes sensitive to the line's own lengths, and to control wavelengths that mean nothing "
        "to it. Sensitive: the spectrum of the contact wire peaks within 1 % of the wavelength. "
        "Participation: share of the vertical contact wire in the kinetic energy; concentration: "
        "share of the spectrum within 5 % of the wavelength; score: their product.",
        ("length", "[m]", "sensitive modes", "best [Hz]", "participation", "concentration",
         "score"),
        "lrrrrrr",
        tuple(rows),
    )  # fmt: skip


def _unbroken(text: str) -> str:
    return text.replace(" ", "\N{NO-BREAK SPACE}")


def _cutoff_table(material: Material) -> Table:
    rows = tuple(
        (
            condition.text,
            f"{speed}",
            f"{published.CUTOFFS[speed]:g}",
            number(float(own.cutoff[i]), 2),
            *(number(float(v[i]), 2) for v in (own.low, own.suggested, own.high)),
            number(100.0 * float(1.0 - own.suggested[i] / own.high[i]), 1),
            number(100.0 * float(1.0 - own.low[i] / own.high[i]), 1),
        )
        for condition, own in material.curves.items()
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
