"""Sections of the line, force, spectrum, uplift, droppers, elasticity and animation."""

from __future__ import annotations

import json
from collections.abc import Sequence

import numpy as np

from tautwire.analyses.force.statistics import uniform_shares
from tautwire.report.drawing import Drawing
from tautwire.report.figures import animation, force_figures, line_figures
from tautwire.report.figures.design_figures import elasticity_figure
from tautwire.report.figures.loss_figures import irregularity_figure
from tautwire.report.parts import published
from tautwire.report.parts.blocks import (
    Animation,
    Button,
    Chart,
    Details,
    Pair,
    Section,
    Table,
    Text,
)
from tautwire.report.parts.fitting_words import BODY_HEAD, STAY_HEAD, body_rows, stay_rows
from tautwire.report.parts.tables import places_of_droppers
from tautwire.report.parts.views import WIDE_CUTOFF, RunView, series
from tautwire.report.parts.words import listing, number, quantity
from tautwire.results.equilibrium import Equilibrium
from tautwire.signals.bands import WIDEST
from tautwire.specs.case import Case
from tautwire.specs.line.catenary import Line

MOST_ROWS = 400
"""Longest table of the page."""


def script_safe(text: str) -> str:
    """Return JSON that cannot end the script element it stands in."""
    return text.replace("<", "\\u003c").replace(">", "\\u003e")


def chart(
    name: str,
    figure: Drawing,
    caption: str,
    summary: str,
    buttons: tuple[Button, ...] = (),
) -> Chart:
    """Turn a figure into a block of the page."""
    height = int(figure.layout.get("height", 400))
    return Chart(name, script_safe(figure.to_json()), caption, summary, height, buttons)


def line_section(views: Sequence[RunView]) -> Section:
    """Write the section of the static line of the first run."""
    view = views[0]
    shape = view.run.equilibrium
    which = f" Shown: {view.label}." if len(views) > 1 else ""
    exaggerated = "Heights and lateral positions are drawn larger than lengths along the track."
    blocks: list[object] = [
        chart(
            "line",
            line_figures.line_figure(view.run.case, shape, view.statistics.section.first_span),
            "Static line: side view; sag of the contact wire below the straight line between its "
            f"supports (pre-sag at the droppers); plan view with stagger. {exaggerated}{which}",
            "Side view, sag and plan view of the static line with droppers and steady arms.",
            position_buttons(view),
        ),
        Details("Droppers: lengths, forces, heights", (dropper_table(shape, view.run.case),)),
    ]
    if shape.arm_supports.size:
        blocks.append(
            Details("Steady arms: forces and inclination", (arm_table(view.run.case.line, shape),))
        )
    if rows := body_rows(view.run.case, shape):
        blocks.append(Details("Bodies in the line of wires", (_body_table(rows),)))
    if rows := stay_rows(view.run.case, shape):
        blocks.append(Details("Stays", (_stay_table(rows),)))
    blocks += _irregularity_blocks(views)
    blocks.append(
        Text(
            f"Weight of the line {quantity(shape.weight, 'N', 2)}, sum of the vertical support "
            f"reactions {quantity(shape.reaction, 'N', 2)}; {shape.iterations} Newton "
            f"iterations, largest out-of-balance force {shape.residual:.1e} N.",
            "note",
        )
    )
    return Section("line", "The line", tuple(blocks))


def _irregularity_blocks(views: Sequence[RunView]) -> list[object]:
    """Show what was drawn for the first run that has irregularities."""
    view = next((view for view in views if view.run.irregularities is not None), None)
    if view is None or view.run.irregularities is None:
        return []
    which = f" Shown: {view.label}." if len(views) > 1 else ""
    return [
        chart(
            "irregularities",
            irregularity_figure(view, view.run.irregularities),
            "Irregularities as drawn, seed "
            f"{view.run.irregularities.seed}: errors of installation change the static shape, "
            f"unevenness of the running surface acts between wire and head.{which}",
            "Depth of the running surface, its unevenness and errors of installation.",
            position_buttons(view),
        )
    ]


_NAMES = ("mast", "tension length", "from", "to")
"""Columns of a table of droppers that hold no numbers."""


def position_buttons(view: RunView) -> tuple[Button, ...]:
    """Return buttons for the section of a run, its whole line and two spans of its middle."""
    part = view.statistics.section
    return spans_buttons(view.run.equilibrium, part.first_span, part.last_span)


def spans_buttons(shape: Equilibrium, first: int, last: int) -> tuple[Button, ...]:
    """Return buttons for the spans from first to last, the whole line and two spans between."""
    x, middle = shape.mast_x, (first + last) // 2
    ends = (float(x[0]), float(x[-1]))
    two = (float(x[middle - 1]), float(x[min(middle + 1, x.size - 1)]))
    section = (float(x[first - 1]), float(x[last]))
    ranges = {"analysed section": section, "whole line": ends, "two spans": two}
    buttons = []
    for label, (low, high) in ranges.items():
        margin = 0.02 * (high - low)
        buttons.append(Button(label, low - margin, high + margin))
    return tuple(buttons)


def dropper_table(shape: Equilibrium, case: Case) -> Table:
    """List the droppers of the static line, with masts, chainage and wires where they are told."""
    count = min(shape.dropper_x.size, MOST_ROWS)
    columns = {
        name: [number(v, 3) if isinstance(v, float) else str(v) for v in values[:count]]
        for name, values in places_of_droppers(shape, case).items()
        if name != "position [m]"  # from the support; the line is measured along x here
    }
    for name, values, digits in (
        ("unstrained length [m]", shape.dropper_lengths_unstrained, 4),
        ("stretched length [m]", shape.dropper_lengths, 4),
        ("force [N]", shape.dropper_forces, 1),
        ("height of the wire below [m]", shape.dropper_heights, 4),
    ):
        columns[name] = [number(value, digits) for value in values[:count]]
    return Table(
        caption="Droppers, clamp to clamp."
        + (
            f" The first {count} of {shape.dropper_x.size}." if shape.dropper_x.size > count else ""
        ),
        head=tuple(columns),
        align="".join("l" if name in _NAMES else "r" for name in columns),
        rows=tuple(zip(*columns.values(), strict=True)),
    )


def arm_table(line: Line, shape: Equilibrium) -> Table:
    """List the steady arms of the static line."""
    held = shape.arm_supports - 1
    rows = [
        (
            line.support_in_words(support).removeprefix("support "),
            shape.wire_names[wire],
            number(force, 1),
            number(np.degrees(angle), 2),
        )
        for support, wire, force, angle in zip(
            shape.support_number[held].tolist(),
            shape.support_wire[held].tolist(),
            shape.arm_forces,
            shape.arm_angles,
            strict=True,
        )
    ]
    return Table(
        "Steady arms; tension is positive, the angle when the far end is above the wire.",
        ("support", "wire", "force [N]", "angle [°]"),
        "llrr",
        tuple(rows[:MOST_ROWS]),
    )


def _body_table(rows: list[tuple[str, ...]]) -> Table:
    return Table(
        "Splices and insulators, with the mass that they have in place of the wire and at its "
        "ends; heights at rest.",
        tuple(head.replace("\n", " ") for head in BODY_HEAD),
        "llrrrrr",
        tuple(rows[:MOST_ROWS]),
    )


def _stay_table(rows: list[tuple[str, ...]]) -> Table:
    return Table(
        "Stays of wires at rest; a pull is positive.",
        tuple(head.replace("\n", " ") for head in STAY_HEAD),
        "llrrr",
        tuple(rows[:MOST_ROWS]),
    )


def filters_caption(views: Sequence[RunView]) -> str:
    """Name the filters of the force curves with every number."""
    low = list(dict.fromkeys(view.lowpass.describe() for view in views))
    return (
        f"Filters: {'; '.join(low)}; the same with a cut-off of {WIDE_CUTOFF:g} Hz. The whole "
        "record is filtered, then cut."
    )


def window_caption(views: Sequence[RunView]) -> str:
    """Name the analysed section."""
    parts = list(dict.fromkeys((v.statistics.section.first_span, v.statistics.section.last_span)
                               for v in views))  # fmt: skip
    return f"Analysed section: {listing([f'spans {a} to {b}' for a, b in parts])}."


def force_section(views: Sequence[RunView]) -> Section:
    """Write the section of the force over position, its distribution, the spans one by one."""
    filters, window = filters_caption(views), window_caption(views)
    shaded = "shaded" if len({view.section for view in views}) == 1 else "shaded for the first run"
    low = "; ".join(dict.fromkeys(view.lowpass.describe() for view in views))
    hidden = (
        "" if len(series(views)) == 1 else " Unfiltered and 200 Hz curves: click in the legend."
    )
    blocks: list[object] = [
        chart(
            "force",
            force_figures.force_figure(views),
            f"Contact force over position. Numbered lines are supports, ticks below are droppers; "
            f"the analysed section is {shaded}. {window} {filters}{hidden}",
            "Curves of the contact force over position.",
            position_buttons(views[0]),
        ),
        Pair(
            chart(
                "spans",
                force_figures.spans_figure(views),
                f"Contact force per span: mean, standard deviation, extremes. Filter: {low}.",
                "Mean, standard deviation and extremes of the force in each span.",
            ),
            chart(
                "histogram",
                force_figures.histogram_figure(views),
                f"Distribution of the contact force, classes of 10 N. {window} Filter: {low}.",
                "Share of time per class of contact force beside a normal distribution.",
            ),
        ),
    ]
    transfer = _transfer_table(views)
    if transfer.rows:
        blocks.insert(1, transfer)
    return Section("force", "Contact force", tuple(blocks))


def _transfer_table(views: Sequence[RunView]) -> Table:
    """Return which contact wire carries what, and where; without rows where there is but one."""
    rows = []
    for item in series(views):
        position, total = item.force.position, float(item.force.raw.sum())
        for wire, share in uniform_shares(item.view.run, item.force.name).items():
            touched = position[share > 0.0]
            rows.append(
                (
                    item.named(wire),
                    number(float(touched.min()), 1),
                    number(float(touched.max()), 1),
                    number(100.0 * float(share.sum()) / total, 1),
                    number(float(share[share > 0.0].mean()), 1),
                    number(float(share.max()), 1),
                )
            )
    return Table(
        "Contact wires under the head, over the whole passage, unfiltered.",
        ("wire", "touched from [m]", "to [m]", "share of the force [%]",
         "mean while touched [N]", "largest [N]"),
        "lrrrrr",
        tuple(rows),
    )  # fmt: skip


def spectrum_section(views: Sequence[RunView]) -> Section:
    """Write the section of the spectrum."""
    highest = WIDEST
    buttons = tuple(Button(f"0–{f:g} Hz", 0.0, f) for f in (20.0, 50.0, 100.0, highest))
    speeds = {view.run.case.scenario.speed for view in views}
    passing = (
        " Dotted lines: frequencies at which spans, droppers and the distance from a support to "
        "its first dropper are passed, and halves of these lengths."
        if len(speeds) == 1
        else " The runs have different speeds; passing frequencies are not marked."
    )
    block = chart(
        "spectrum",
        force_figures.spectrum_figure(views),
        f"Amplitude spectrum of the unfiltered contact force, Hann window over the section. "
        f"{window_caption(views)}{passing} Lines that are multiples of speed over element length "
        "are numerical.",
        "Amplitude of the contact force over frequency, logarithmic.",
        buttons,
    )
    return Section("spectrum", "Spectrum", (block,))


def uplift_section(views: Sequence[RunView]) -> Section:
    """Write the section of the uplift at supports and height of the contact point."""
    blocks = (
        Pair(
            chart(
                "uplift",
                line_figures.uplift_figure(views),
                "Largest uplift of the contact wire at the supports, from the static state, "
                f"unfiltered. {window_caption(views)} Supports outside it are pale: the ends of "
                "the line act on them.",
                "Bars of the largest uplift at each support.",
            ),
            chart(
                "uplift-history",
                line_figures.uplift_history_figure(views),
                "Uplift over time at the support of the section where it is largest, unfiltered.",
                "Curve of the uplift at one support over time.",
            ),
        ),
        chart(
            "height",
            line_figures.height_figure(views),
            "Height of the contact wire at the pantograph, unfiltered, beside its static height.",
            "Curves of the contact-wire height at the pantograph over position.",
            position_buttons(views[0]),
        ),
    )
    return Section("uplift", "Uplift", blocks)


def dropper_section(views: Sequence[RunView]) -> Section:
    """Write the section of the dropper forces and slack time."""
    if not views[0].run.equilibrium.dropper_x.size:
        return Section("droppers", "Droppers", (Text("The line has no droppers."),))
    blocks: list[object] = [
        chart(
            "droppers",
            line_figures.dropper_figure(views),
            "Droppers of the analysed section while a pantograph is in it or within half a span: "
            "range of the force and static force (dash), unfiltered; below, how long they are "
            "slack.",
            "Bars of the force range and of the slack time of each dropper.",
            position_buttons(views[0]),
        )
    ]
    for view in views:
        data = view.statistics.droppers
        if not data.span.size or not np.isfinite(data.maximum).any():
            continue
        worst, loaded = int(np.argmax(data.slack_time)), int(np.nanargmax(data.maximum))
        slack = int((data.slack_time > 0).sum())
        prefix = f"{view.label}: " if len(views) > 1 else ""
        text = (
            f"{prefix}{slack} of {data.span.size} droppers go slack; the longest time is "
            f"{quantity(1e3 * data.slack_time[worst], 'ms', 0)} (dropper {data.number[worst]} of "
            f"span {data.span[worst]}). The largest force is "
            f"{quantity(data.maximum[loaded], 'N', 0)} (dropper {data.number[loaded]} of span "
            f"{data.span[loaded]})."
        )
        blocks.append(Text(text))
    return Section("droppers", "Dropper forces", tuple(blocks))


def elasticity_section(views: Sequence[RunView]) -> Section:
    """Write the section of the elasticity."""
    given = [(view.label, view.elasticity) for view in views if view.elasticity is not None]
    if not given:
        text = "The elasticity was not computed with this run; “tautwire static” computes it."
        return Section("elasticity", "Elasticity", (Text(text),))
    forces = list(dict.fromkeys(f"{data.force:g} N" for _, data in given))
    uneven = listing(
        [
            f"{label + ': ' if len(given) > 1 else ''}{number(100 * data.nonuniformity)} %"
            for label, data in given
        ]
    )
    case = views[0].run.case
    block = chart(
        "elasticity",
        elasticity_figure(given, case.line, views[0].run.equilibrium),
        f"Static uplift per vertical force, under {listing(forces)}, at supports (squares), "
        f"droppers (circles) and between (crosses). Non-uniformity (max − min)/(max + min): "
        f"{uneven}. Ends {case.line.ends.left}/{case.line.ends.right}, closure "
        f"{case.supports.closure}, messenger wire along the track "
        f"{case.supports.messenger_longitudinal}.",
        "Curve of the elasticity over position.",
    )
    compared = [b for v in views for b in published.elasticity_blocks(v, named=len(views) > 1)]
    return Section("elasticity", "Elasticity", (block, *compared))


def animation_section(views: Sequence[RunView]) -> Section:
    """Write the section of the animation."""
    usable = animation.filmed(views)
    if not usable:
        text = Text("There is nothing to show: no pantograph moved under the line.")
        return Section("animation", "Animation", (text,))
    first = usable[0]
    length = animation.visible_length(first)
    block = Animation(
        json=script_safe(json.dumps(animation.films(views), allow_nan=False)),
        films=tuple(view.label for view in usable),
        caption="The passage: wires (dashed: the static contact wire), droppers (slack ones "
        "bowed, dashed and orange) and head of the pantograph, heights exaggerated by the factor "
        "shown; below, the contact force at the "
        "same position, unfiltered (thin) and low-passed (thick). The analysed section is shaded. "
        "Filter: "
        + "; ".join(dict.fromkeys(view.lowpass.describe() for view in usable))
        + ". Frame and knee of the pantograph are a symbol. Keys: space plays, arrows step.",
        summary="Animation of the pantograph running under the line, with the contact force.",
        exaggeration=animation.exaggeration(first, length),
        length=round(length),
    )
    return Section("animation", "Animation", (block,))
