"""The page of a static line: heights, droppers, elasticity, supports, checks, workshop sheet."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from tautwire.analyses.design.masts import Masts
from tautwire.analyses.design.workshop import WorkshopSheet
from tautwire.assessment.design.checks import DesignCheck
from tautwire.assessment.design.lateral import LateralCheck
from tautwire.report.figures import line_figures
from tautwire.report.figures.design_figures import elasticity_figure
from tautwire.report.parts.blocks import Callout, Details, Key, Keys, Section, Table, Text
from tautwire.report.parts.conditions import input_blocks
from tautwire.report.parts.design.sections import (
    checks_section,
    lateral_section,
    supports_section,
)
from tautwire.report.parts.design.workshop_words import workshop_section
from tautwire.report.parts.sections import arm_table, chart, dropper_table, spans_buttons
from tautwire.report.parts.words import number, quantity
from tautwire.report.writers.page import Page
from tautwire.report.writers.project import project_block
from tautwire.results.equilibrium import Elasticity, Equilibrium
from tautwire.specs.case import Case
from tautwire.version import __version__


@dataclass(frozen=True)
class StaticPage:
    """What the page is about.

    Attributes
    ----------
    case : Case
    shape : Equilibrium
    elasticity : Elasticity or None
    masts : Masts
        Forces on the supports.
    lateral : LateralCheck or None
    checks : tuple of DesignCheck
    workshop : WorkshopSheet or None
        Of the design; None in a condition.
    warnings : tuple of str
        What is unusual about the line.
    """

    case: Case
    shape: Equilibrium
    elasticity: Elasticity | None
    masts: Masts
    lateral: LateralCheck | None = None
    checks: tuple[DesignCheck, ...] = ()
    workshop: WorkshopSheet | None = None
    warnings: tuple[str, ...] = ()


def compose_static_page(page: StaticPage) -> Page:
    """Return the page of a static line, to be written in several ways."""
    contents = [
        _summary(page),
        _line(page),
        _elasticity(page),
        supports_section(page.masts, page.case.line),
    ]
    if page.lateral is not None:
        contents.append(lateral_section(page.lateral))
    if page.checks:
        contents.append(checks_section(page.checks))
    if page.workshop is not None:
        contents.append(workshop_section(page.case, page.shape, page.workshop))
    contents.append(Section("inputs", "Inputs and sources", tuple(input_blocks(page.case))))
    return Page(contents, _masthead(page.case))


def _masthead(case: Case) -> dict[str, Any]:
    first, last = case.resolved_section()
    condition = {} if case.condition is None else {"Condition": case.condition}
    return {
        "title": f"{case.title or case.name}: static state",
        "description": case.description.strip(),
        "facts": {
            "Line": f"{case.line.spans} spans, {case.line.length():g} m",
            "Wires": ", ".join(
                f"{name} {1e-3 * wire.tension:g} kN" for name, wire in case.wires.named()
            ),
            **condition,
            "Analysed section": f"spans {first} to {last}",
            "Mesh": case.settings.mesh(),
        },
        "project": project_block(case.project),
        "version": __version__,
        "case_hash": case.hash()[:12],
    }


def _summary(page: StaticPage) -> Section:
    blocks: list[object] = [Callout(page.warnings)] if page.warnings else []
    blocks.append(Keys(tuple(_keys(page))))
    blocks.append(_span_table(page.case, page.shape))
    return Section("summary", "Summary", tuple(blocks))


def _keys(page: StaticPage) -> list[Key]:
    shape, (first, last) = page.shape, page.case.resolved_section()
    x = np.concatenate([wire.position[:, 0] for wire in shape.of_role("contact")])
    inside = x[(x >= shape.mast_x[first - 1]) & (x <= shape.mast_x[last])]
    heights = shape.running_height(inside)
    section = f"contact wire, spans {first} to {last}"
    keys = [
        Key(number(heights.min(), 3), "m", f"lowest {section}"),
        Key(number(heights.max(), 3), "m", f"highest {section}"),
    ]
    if shape.dropper_forces.size:
        least = quantity(float(shape.dropper_forces.min()), "N", 0)
        largest = number(float(shape.dropper_forces.max()), 0)
        keys.append(Key(largest, "N", f"largest dropper force; least {least}"))
    if shape.arm_forces.size:
        largest = number(float(shape.arm_forces.max()), 0)
        keys.append(Key(largest, "N", "largest pull of a steady arm"))
    if page.elasticity is not None:
        values, share = 1e3 * page.elasticity.elasticity, 100.0 * page.elasticity.nonuniformity
        stiff = f"{number(float(values.min()), 2)} to {number(float(values.max()), 2)} mm/N"
        keys.append(Key(number(share), "%", f"non-uniformity of the elasticity; {stiff}"))
    return keys


def _span_table(case: Case, shape: Equilibrium) -> Table:
    """List the spans: length, droppers and their forces, height at the support that begins them."""
    marks, lowest = case.line.support_marks(), -shape.by_mast(-shape.support_heights)
    arms = shape.support_number[shape.arm_supports - 1]
    rows = []
    for span in range(1, case.line.spans + 1):
        own, held = shape.dropper_span == span, arms == span
        rows.append(
            (
                str(span),
                marks[span - 1],
                *([f"{case.line.chainage[span - 1]:.3f}"] if case.line.chainage else []),
                f"{shape.mast_x[span] - shape.mast_x[span - 1]:g}",
                number(float(lowest[span - 1]), 4),
                str(int(own.sum())),
                _extent(shape.dropper_forces[own]),
                _extent(shape.arm_forces[held]),
            )
        )
    chainage = ("chainage [m]",) if case.line.chainage else ()
    return Table(
        "Spans; support, height of the lowest contact wire and steady arms are those on the left.",
        ("span", "support", *chainage, "length [m]", "height [m]", "droppers",
         "dropper forces [N]", "arm force [N]"),
        "rl" + "r" * (5 + len(chainage)),
        tuple(rows),
    )  # fmt: skip


def _extent(values: np.ndarray) -> str:
    if not values.size:
        return ""
    low, high = float(values.min()), float(values.max())
    return number(low) if high - low < 0.05 else f"{number(low)} to {number(high)}"


def _line(page: StaticPage) -> Section:
    case, shape = page.case, page.shape
    first, last = case.resolved_section()
    blocks: list[object] = [
        chart(
            "line",
            line_figures.line_figure(case, shape, first),
            "Side view; sag of the contact wire below the straight line between its supports "
            "(pre-sag at the droppers); plan view with stagger. Heights and lateral positions are "
            "drawn larger than lengths along the track.",
            "Side view, sag and plan view of the static line with droppers and steady arms.",
            spans_buttons(shape, first, last),
        ),
        Details("Droppers: lengths, forces, heights", (dropper_table(shape, page.case),)),
    ]
    if shape.arm_supports.size:
        arms = (arm_table(case.line, shape),)
        blocks.append(Details("Steady arms: forces and inclination", arms))
    text = (
        f"Weight of the line {quantity(shape.weight, 'N', 2)}, sum of the vertical support "
        f"reactions {quantity(shape.reaction, 'N', 2)}; {shape.iterations} Newton iterations, "
        f"largest out-of-balance force {shape.residual:.1e} N."
    )
    return Section("line", "The line", (*blocks, Text(text, "note")))


def _elasticity(page: StaticPage) -> Section:
    found = page.elasticity
    if found is None:
        text = Text("The elasticity was not computed.")
        return Section("elasticity", "Elasticity", (text,))
    caption = (
        f"Static uplift per vertical force, under {found.force:g} N, at supports (squares), "
        "droppers (circles) and between (crosses). Non-uniformity (max − min)/(max + min): "
        f"{number(100.0 * found.nonuniformity)} %."
    )
    figure = elasticity_figure([(page.case.name, found)], page.case.line, page.shape)
    block = chart("elasticity", figure, caption, "Curve of the elasticity over position.")
    return Section("elasticity", "Elasticity", (block,))
