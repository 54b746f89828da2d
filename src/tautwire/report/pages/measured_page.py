"""A page about a recording: how it was read, faults, steps, figures, force, spectrum."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from tautwire.files import write_text
from tautwire.measured.evaluation import Evaluation
from tautwire.report.figures.panels import Curve, Panel, panel_figure
from tautwire.report.parts.blocks import Callout, Section, Table, Text
from tautwire.report.parts.recordings.measured import (
    COUNTED,
    EVENTS,
    event_rows,
    figure_rows,
    range_rows,
    step_rows,
    stretch_rows,
)
from tautwire.report.parts.sections import MOST_ROWS, chart
from tautwire.report.parts.words import number
from tautwire.report.writers.html import render
from tautwire.version import __version__


def write_measured_page(found: Evaluation, path: str | os.PathLike[str]) -> Path:
    """Write a page about a recording as a single HTML file, completely or not at all.

    Parameters
    ----------
    found
    path
        File to write.
    """
    blocks = tuple(reading_blocks(found))
    contents = [Section("reading", "What was recorded, and how it was read", blocks)]
    if found.force is not None:
        contents += [_figures(found), _history(found), _stretches(found)]
    if found.force is not None or found.events:
        contents.append(Section("events", "Events", (_events(found),)))
    if found.ranges:
        heads = ("channel", "least", "mean", "largest", "missing")
        table = Table("", heads, "lrrrr", tuple(range_rows(found)))
        contents.append(Section("channels", "Other channels", (table,)))
    return write_text(path, render(contents, _masthead(found)))


def _masthead(found: Evaluation) -> dict[str, Any]:
    return {
        "title": f"Recording {Path(found.label).name}",
        "description": "",
        "facts": {
            "Samples": str(found.samples),
            "Interval": f"{1e3 * found.interval:.4g} ms",
            "Way": f"{number(found.length)} m",
            "Direction": f"{found.direction} chainage",
            "Holds": f"up to {number(found.highest_frequency)} Hz",
        },
        "version": __version__,
        "case_hash": "",
    }


def reading_blocks(found: Evaluation) -> list[object]:
    """Return how a recording was read: faults, notes, steps of the processing."""
    faults = tuple(f"{one['kind']}, {one['channel']}: {one['text']}." for one in found.faults)
    blocks: list[object] = [Callout(faults) if faults else Text("No fault was found.")]
    blocks += [Text(f"{note[:1].upper()}{note[1:]}.", "note") for note in found.notes]
    if found.steps:
        blocks.append(
            Table("Every step of the processing, in order.", ("step", "with"), "ll",
                  tuple(step_rows(found)))
        )  # fmt: skip
    return blocks


def _figures(found: Evaluation) -> Section:
    assert found.force is not None
    rows = tuple(figure_rows(found.force, found.highest_frequency))
    return Section("figures", "Contact force", (Table("", ("", "", ""), "lrl", rows),))


def _history(found: Evaluation) -> Section:
    over, abscissa = found.abscissa
    name = over.partition(" ")[0]
    panel = Panel("contact force", [Curve("measured", abscissa, found.values)], "contact force [N]")
    blocks: list[object] = [
        chart(
            "force",
            panel_figure([panel], over, height=340),
            f"Processed contact force over the {name}; gaps are gaps. Filter: {_filter(found)}.",
            f"Curve of the measured contact force over {name}.",
        )
    ]
    if found.spectrum is not None:
        curve = Curve("measured", found.spectrum.abscissa, found.spectrum.value)
        blocks.append(
            chart(
                "spectrum",
                panel_figure([Panel("spectrum", [curve], "amplitude [N]")], "frequency [Hz]"),
                "Amplitude spectrum of the unfiltered force, Hann window, longest stretch without "
                "gaps.",
                "Curve of the amplitude of the force over frequency.",
            )
        )
    return Section("history", "History and spectrum", tuple(blocks))


def _filter(found: Evaluation) -> str:
    filters = [str(step["filter"]) for step in found.steps if "filter" in step]
    return "; ".join(filters) or "none"


def _stretches(found: Evaluation) -> Section:
    heads, align = COUNTED
    rows = tuple(stretch_rows(found)[:MOST_ROWS])
    return Section("stretches", "Stretches", (Table("", heads, align.lower(), rows),))


def _events(found: Evaluation) -> object:
    events = tuple(event_rows(found)[:MOST_ROWS])
    caption = "Losses and high forces of the filtered force; hard spots by the step of that name."
    if events:
        return Table(caption, EVENTS, "lrrr", events)
    shares = [step["examined_share"] for step in found.steps if "examined_share" in step]
    hard = "no hard spot" if any(shares) else "hard spots were not looked for (see the steps)"
    return Text(f"No loss of contact, no force above the limit; {hard}.")
