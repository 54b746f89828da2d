"""Sections of pages about the design of a line: supports, lateral position, checks."""

from __future__ import annotations

from collections.abc import Sequence

from tautwire.analyses.design.masts import Masts
from tautwire.assessment.design.checks import DesignCheck
from tautwire.assessment.design.lateral import LateralCheck
from tautwire.report.figures import design_figures
from tautwire.report.parts.blocks import Callout, Section, Table, Text
from tautwire.report.parts.design import check_words
from tautwire.report.parts.design.lateral_words import (
    ALIGN,
    EXPLAINED,
    HEAD,
    lateral_rows,
    worst_place,
)
from tautwire.report.parts.design.mast_words import (
    CLEARANCE_HEAD,
    FORCE_HEAD,
    TENSION_HEAD,
    clearance_rows,
    force_rows,
    installation_head,
    installation_rows,
    tension_rows,
)
from tautwire.report.parts.sections import chart
from tautwire.specs.line.catenary import Line


def supports_section(masts: Masts, line: Line) -> Section:
    """Write the section of supports: forces, installation, tensions, structures."""
    blocks: list[object] = []
    if masts.exceeded:
        blocks.append(Callout(tuple(f"{name}: {text}" for name, text in masts.exceeded)))
    blocks.append(
        Table(
            "Forces of all wires on every support, least to largest of all states: upwards, level "
            "to the left of rising chainage (radial in a curve), and along the track. Weight of "
            "cantilevers and wind on them are not in it.",
            FORCE_HEAD,
            "rrrrr",
            tuple(force_rows(masts, line)),
        )
    )
    if masts.installation:
        blocks.append(
            Table(
                "Installation: how far cantilevers stand along the track from their place in the "
                "design, positive towards rising chainage, and weights above theirs [mm].",
                installation_head(masts, slice(None)),
                "rl" + "r" * len(masts.temperatures),
                tuple(installation_rows(masts, line, slice(None))),
            )
        )
        offsets = "Place of the cantilevers along the track from that in the design."
        blocks.append(chart("offsets", design_figures.offset_figure(masts), offsets, offsets))
    profile = "Tension of the wires along the line, one curve per wire and condition."
    blocks += [
        chart("tension", design_figures.tension_figure(masts), profile, profile),
        Table(
            "Mean tension of the wires in their outermost spans and in the span with least.",
            TENSION_HEAD,
            "llrrrr",
            tuple(tension_rows(masts)),
        ),
    ]
    if any(one.clearances for one in masts.states):
        blocks.append(
            Table(
                "Structures: what is left between the highest wire, lifted by a passing "
                "pantograph, and the structure, in the state with least.",
                CLEARANCE_HEAD,
                "lllrrrl",
                tuple(clearance_rows(masts)),
            )
        )
    return Section("supports", "Supports, installation, structures", tuple(blocks))


def lateral_section(check: LateralCheck) -> Section:
    """Write the section of the lateral position under wind."""
    blocks: list[object] = []
    if check.faults:
        blocks.append(Callout(check.faults))
    if check.worst:
        caption = (
            "Contact wire over the track under wind from either side, and what is permissible."
        )
        blocks += [
            Text(f"Worst place: {worst_place(check)}.", "statement"),
            chart("blown", design_figures.blown_figure(check), caption, caption),
            Table(EXPLAINED, HEAD, ALIGN, tuple(lateral_rows(check.worst))),
        ]
    blocks += [Text(note, "note") for note in check.notes]
    return Section("lateral", f"Lateral position: {check.wind}", tuple(blocks))


def checks_section(checks: Sequence[DesignCheck]) -> Section:
    """Write the section of the checks of the design."""
    table = Table(
        "This line: finite-element equilibrium of the design and all conditions; estimate: the "
        "closed form.",
        check_words.HEAD,
        "lrrrl",
        tuple(check_words.check_rows(checks)),
    )
    sources = Table(
        "Where the limits come from, and whether somebody compared them with the text.",
        ("limit", "source"),
        "ll",
        tuple(check_words.source_rows(checks)),
    )
    return Section("checks", "Checks of the design", (table, sources))
