"""Page sections about the model, its readings, mesh and contact stiffness (II, III)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tautwire.report.parts.blocks import Cell, Section, Table, Text
from tautwire.report.parts.sections import chart
from tautwire.report.parts.words import number
from tautwire.reproductions.song2021 import published
from tautwire.reproductions.song2021.pages import drawings
from tautwire.reproductions.song2021.passages import MESHES, UNCALIBRATED, Reading, standard
from tautwire.reproductions.song2021.sections import mesh, stiffness
from tautwire.reproductions.song2021.sections.statics import largest_deviation

if TYPE_CHECKING:
    from tautwire.reproductions.song2021.reproduction import Material

SHARP = "Sharp low-pass over the whole record."
BAND_20 = "sharp low-pass at 20 Hz"


def readings_section(material: Material) -> Section:
    """Show which readings of what the paper leaves open fit Table 2, and which do not."""
    found = sorted(material.variants, key=lambda item: item.largest_deviation)
    rows = tuple(
        (
            item.group,
            item.label,
            *(number(item.numbers[name], 2) for name in published.QUANTITIES),
            number(100.0 * item.largest_deviation, 1),
        )
        for item in found
    )
    names = tuple(published.NAMES[name] for name in published.QUANTITIES)
    paper = ("paper", "Table 2", *(f"{v:g}" for v in published.PAPER.values()), "0.0")
    table = Table(
        "The numbers of Table 2 [N] under every reading, those that fit first; the last column is "
        "the largest deviation of a standard deviation from the paper's [%]. Readings of mesh, "
        "filter, window and model differ from the uncalibrated reading, NAD 9, in that one thing.",
        ("varied", "reading", *names, "deviation"),
        "ll" + "r" * (len(names) + 1),
        (paper, *rows),
    )
    text = (
        "The paper states neither the contact stiffness of its figures and tables nor damping, "
        "filter, steady arms, window or the load of the elasticity. Each was varied alone."
    )
    return Section("readings", "Readings of what is not stated", (Text(text), table))


def model_section(material: Material) -> Section:
    """Show Fig. 3 and Tables 1 and 2."""
    shape = material.statics.shape
    blocks = (
        chart("fig-3", drawings.configuration(shape), "Fig. 3 of the paper: initial configuration, "
              "found by one Newton solve. Heights and lateral positions are exaggerated.",
              "Side view and plan of the static line."),
        _table_1(material),
        _table_2(material),
    )  # fmt: skip
    return Section("model", "Model and validation (II)", blocks)


def _table_1(material: Material) -> Table:
    found = material.statics
    places = ("support", *(f"dropper {n}" for n in range(1, 6)))
    presag = tuple(number(v, 2) for v in next(iter(found.presag.values()))[:6])
    rows: list[tuple[Cell, ...]] = [
        (
            place,
            "0" if not i else f"{published.PRESAG[i - 1]:g}",
            presag[i],
            f"{published.ELASTICITY_BENCHMARK[i]:.3f}",
            f"{published.ELASTICITY_PAPER[i]:.4f}",
            *(number(values[i], 4) for values in found.elasticity.values()),
        )
        for i, place in enumerate(places)
    ]
    for label, wanted in (
        ("off the paper [%]", published.ELASTICITY_PAPER),
        ("off the benchmark [%]", published.ELASTICITY_BENCHMARK),
    ):
        values = [largest_deviation(own, wanted) for own in found.elasticity.values()]
        rows.append((label, "", "", "", "", *(number(v, 1) for v in values)))
    return Table(
        "Table 1 of the paper: pre-sag [mm] and elasticity [mm/N] of a span in the middle; the "
        "other half is the mirror image. Last rows: largest deviation.",
        ("", "pre-sag, paper", "found", "elasticity, benchmark", "paper", *found.elasticity),
        "lrrrr" + "r" * len(found.elasticity),
        tuple(rows),
    )


def _table_2(material: Material) -> Table:
    own = [item for item in material.variants if item.group == "reading"]
    rows = tuple(
        (
            published.NAMES[name],
            f"{published.BENCHMARK[name]:.2f}",
            f"{published.PAPER[name]:.2f}",
            *(number(item.numbers[name], 2) for item in own),
        )
        for name in published.QUANTITIES
    )
    return Table(
        f"Table 2 of the paper [N], by reading; NAD 9, {BAND_20}, spans 4 to 13.",
        ("", "benchmark", "paper", *(item.label for item in own)),
        "l" + "r" * (len(own) + 2),
        rows,
    )


def mesh_section(material: Material) -> Section:
    """Show Figs 4 to 6."""
    own, blocks = material.passages, []
    every = mesh.computed(own)
    for k in every:
        if k == UNCALIBRATED:
            blocks.append(
                chart(f"fig-4-{k.name}", drawings.mesh_forces(own, k), "Fig. 4 of the paper: "
                      f"contact force on four meshes, {k}. {SHARP}",
                      "Contact force of four meshes low-passed at 20 and 200 Hz.")
            )  # fmt: skip
        blocks.append(
            chart(f"fig-5-{k.name}", drawings.mesh_bars(own, k), "Fig. 5 of the paper: standard "
                  f"deviation by mesh and cut-off, {k}. {SHARP}",
                  "Bars of standard deviation by mesh and cut-off.")
        )  # fmt: skip
    if every:
        k = every[0]
        blocks += [
            chart(f"fig-6-{k.name}", drawings.mesh_spectra(own, k), "Fig. 6 of the paper: "
                  "spectrum of the unfiltered force (Hann window, spans 4 to 13) on four "
                  f"meshes, {k}, with element passing n v/Le.",
                  "Spectra of the contact force on four meshes in four bands."),
            _lines_table(material, every),
            _test_text(material, every),
        ]  # fmt: skip
    return Section("mesh", "Mesh size (III.A)", tuple(blocks) or (_nothing(),))


def _lines_table(material: Material, every: list[Reading]) -> Table:
    rows = []
    wanted = [(m, f) for m in MESHES for f in published.ELEMENT_PASSING[m]]
    wanted.append((9, 2.0 * published.ELEMENT_PASSING[9][0]))
    for m, frequency in wanted:
        cells: list[str] = []
        for k in every:
            for test in (
                mesh.force_comb(material.passages, standard(m, k)).test(frequency),
                mesh.force_comb(material.passages, standard(mesh.finer(m), k)).test(frequency),
                mesh.difference_comb(material.passages, m, k).test(frequency),
            ):
                mark = "" if test.stands_out else "\N{NO-BREAK SPACE}no"
                cells.append(f"{number(test.ratio, 1)}/{number(test.limit, 1)}{mark}")
        rows.append((f"NAD\N{NO-BREAK SPACE}{m}", f"{frequency:g}", *cells))
    heads = ("spectrum", "other mesh", "difference")
    return Table(
        "Element passing: power of the line over the mean power of the comb lines within 15 %, and "
        "the limit that 99 % of a background without lines keep ('no': does not stand out); on the "
        "mesh itself, at the same place on NAD 18 (for NAD 18: on NAD 15), and in the spectrum of "
        "the difference of the two histories, in which the background cancels. The force is a comb "
        "of the span-passing frequency, so the line appears at the nearest multiples.",
        ("mesh", "n\N{NO-BREAK SPACE}v/Le [Hz]", *(head for _ in every for head in heads)),
        "lr" + "rrr" * len(every),
        tuple(rows),
        (("", 2), *((str(k), 3) for k in every)),
    )


def _test_text(material: Material, every: list[Reading]) -> Text:
    """Say how often the test finds a line where there is none."""
    found = {k: mesh.false_alarms(material.passages, k) for k in every}
    parts = [f"{number(share, 1)} % of {places} ({k})" for k, (share, places) in found.items()]
    return Text(
        "The test itself: of the places between 100 and 250 Hz on NAD 18, where no element is "
        f"passed, {', '.join(parts)} stand out; 1 % is expected of a background without lines."
    )


def stiffness_section(material: Material) -> Section:
    """Show Figs 7 to 9."""
    own = material.passages
    every = stiffness.computed(own)
    if not every:
        return Section("stiffness", "Contact stiffness (III.B)", (_nothing(),))
    first = [one for one in every if one.line == every[0].line][-1]
    rows = tuple(
        (
            f"0–{cutoff} Hz",
            number(published.STIFFNESS_CHANGES[cutoff], 2),
            *(number(stiffness.change(own, one, cutoff), 2) for one in every),
        )
        for cutoff in stiffness.CUTOFFS
    )
    blocks = (
        chart("fig-7", drawings.stiffness_forces(own, first), "Fig. 7 of the paper: contact force "
              f"over two spans by contact stiffness, {first}. {SHARP}",
              "Contact force over two spans with six contact stiffnesses."),
        chart("fig-8", drawings.stiffness_spectra(own, first), "Fig. 8 of the paper: amplitude at "
              f"the multiples of the span-passing frequency by contact stiffness, {first}.",
              "Spectra of the contact force with six contact stiffnesses."),
        chart("fig-9", drawings.stiffness_curves(own), "Fig. 9 of the paper: standard deviation "
              f"over contact stiffness by cut-off. {SHARP}",
              "Standard deviation over contact stiffness."),
        Table("Change of the standard deviation from 50 to 500 kN/m [%].",
              ("cut-off", "paper", *(str(one) for one in every)), "lr" + "r" * len(every),
              rows),
    )  # fmt: skip
    return Section("stiffness", "Contact stiffness (III.B)", blocks)


def _nothing() -> Text:
    return Text("The passages for this section are missing.", "note")
