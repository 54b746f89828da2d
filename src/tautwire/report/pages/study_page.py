"""The report of a study: one self-contained HTML page."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tautwire.files import write_text
from tautwire.report.figures.study_figures import readable_axis, usual_figures
from tautwire.report.parts.blocks import (
    Callout,
    Cell,
    Details,
    Key,
    Keys,
    Section,
    Table,
    Text,
    Verdict,
)
from tautwire.report.parts.sections import chart
from tautwire.report.parts.words import counted, listing, number, with_error
from tautwire.report.writers.html import render
from tautwire.report.writers.project import project_block
from tautwire.signals.filters import SharpLowpass
from tautwire.specs.project import Project
from tautwire.studies.columns import BAND, FILTER, PANTOGRAPH
from tautwire.studies.table import Alike, StudyTable
from tautwire.text import MARK, marked
from tautwire.version import __version__

MOST_ROWS = 1000
"""Longest table of the page; the CSV file has all rows."""

_OUTCOMES = {"done": "passed", "failed": "failed", "refused": "failed", "missing": "unverified"}
_BANDS = ("0_2", "0_5", "5_20", "0_20", "0_50", "0_200")


def write_study_report(
    table: StudyTable,
    path: str | os.PathLike[str],
    facts: Mapping[str, str] | None = None,
    project: Project | None = None,
) -> Path:
    """Write the report of a study as a single HTML file, completely or not at all.

    Parameters
    ----------
    table
    path
        File to write.
    facts
        Further facts for the head of the page, such as what computed it.
    project
        Project block of the page.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    contents = [_summary(table), _figures(table), _rows(table), _definition(table)]
    head = _masthead(table, facts or {})
    head["project"] = project_block(project or Project())
    return write_text(path, render(contents, head))


def _masthead(table: StudyTable, facts: Mapping[str, str]) -> dict[str, Any]:
    study = table.study
    axes = [f"{axis.name.replace('_', ' ')} ({len(axis.coordinates)})" for axis in table.axes]
    return {
        "title": study.title or f"Study {study.name}",
        "description": study.description.strip(),
        "facts": {
            "Base case": Path(study.base).name,
            "Axes": listing(axes),
            "Cases": str(table.status.size),
            **facts,
        },
        "version": __version__,
        "case_hash": Path(study.base).name,
    }


def _summary(table: StudyTable) -> Section:
    counts = table.counts()
    keys = [
        Key(str(counts["done"]), "", "cases done"),
        Key(str(counts["failed"] + counts["refused"]), "", "failed or refused"),
    ]
    if counts["missing"]:
        keys.append(Key(str(counts["missing"]), "", "not computed"))
    cpu = table["cpu_s"].values
    if np.isfinite(cpu).any():
        keys.append(Key(number(float(np.nanmean(cpu)), 2), "s", "processor time per case"))
    memory = table["peak_memory_mb"].values
    if np.isfinite(memory).any():
        keys.append(Key(number(float(np.nanmax(memory)), 0), "MB", "largest memory of a worker"))
    blocks: list[object] = [Keys(tuple(keys))]
    if counts["missing"]:
        text = "The study was stopped; start it again with --resume to compute the rest."
        blocks.append(Callout((text,)))
    if table.mixture():
        blocks.append(Callout((table.mixture(),)))
    if table.failures():
        text = "Cases without a result, equal reasons together."
        blocks.append(_alike(text, table.failures(), "failed"))
    else:
        blocks.append(Text("No case failed.", "note"))
    if table.warned():
        blocks.append(
            _alike("Warnings of finished cases, equal ones together.", table.warned(), "unverified")
        )
    return Section("summary", "Summary", tuple(blocks))


def _alike(caption: str, found: Sequence[Alike], look: str) -> Table:
    rows = [
        (str(len(one.cases)), Verdict(one.status, look), one.reason, _numbers(one.cases))
        for one in found
    ]
    return Table(caption, ("cases", "status", "reason", "numbers"), "rlll", tuple(rows))


def _numbers(cases: tuple[int, ...]) -> str:
    shown = ", ".join(map(str, cases[:12]))
    return shown if len(cases) <= 12 else f"{shown}, …"


def _figures(table: StudyTable) -> Section:
    notes = (
        f"Filter: {SharpLowpass().describe()}, with the cut-off of each curve. The whole record is "
        "filtered, then the analysed section is cut out. The advised cut-off covers a quarter of "
        f"the shortest dropper or support interval.{_marks(table)}"
    )
    blocks = [
        chart(name, figure, f"{caption}. {notes}", caption + ".")
        for name, figure, caption in usual_figures(table)
    ]
    if not blocks:
        return Section("figures", "Figures", (Text("There is nothing to draw.", "note"),))
    return Section("figures", "Figures", tuple(blocks))


def _rows(table: StudyTable) -> Section:
    axes = [(axis, *readable_axis(axis)) for axis in table.axes]
    columns = list(_columns(table))
    rows: list[tuple[Cell, ...]] = []
    for index in np.ndindex(*table.status.shape):
        if len(rows) == MOST_ROWS:
            break
        places = dict(zip(table.names, index, strict=True))
        of_axis = {a.name: places[d.name] for d in table.dimensions for a in d.axes}
        values = [values[of_axis[axis.name]] for axis, _, values in axes]
        shown = [f"{v:g}" if isinstance(v, float) else str(v) for v in values]
        status = str(table.status[index])
        cells = [text(index) for _, text in columns]
        rows.append((str(len(rows) + 1), *shown, Verdict(status, _OUTCOMES[status]), *cells))
    more = (
        f" The first {MOST_ROWS} of {table.status.size}." if table.status.size > MOST_ROWS else ""
    )
    block = Table(
        f"Cases, filter {_kind(table)}, forces of the section at 0 to 20 Hz.{more}{_marks(table)}",
        ("case", *(title for _, title, _ in axes), "status", *(head for head, _ in columns)),
        "r" + "r" * len(axes) + "l" + "r" * len(columns),
        tuple(rows),
    )
    many = len(rows) > 60
    return Section("cases", "Cases", (Details("All cases", (block,)) if many else block,))


def _marks(table: StudyTable) -> str:
    """Say what the mark means, where it stands."""
    if not any(table.marked.ravel()):
        return ""
    return f" {MARK}: mesh and time step do not carry the figure (settings.band)."


def _kind(table: StudyTable) -> str:
    kinds = table.labels[FILTER]
    return "sharp" if "sharp" in kinds or not kinds else kinds[0]


def _columns(table: StudyTable) -> Any:
    """Yield heading and text of the columns of the table of cases."""
    if "std" not in table.variables:
        return
    kind = table.labels[FILTER].index(_kind(table))
    names = table.labels[PANTOGRAPH]
    for who, name in enumerate(names):
        own = f"{name}: " if len(names) > 1 else ""

        def force(index: tuple[int, ...], quantity: str, at: int = who) -> str:
            place = (*index, at, kind)
            return with_error(float(table[quantity].values[place]), table.error(quantity, place))

        def single(index: tuple[int, ...], quantity: str, digits: int, at: int = who) -> str:
            place = (*index, at)
            value = float(table[quantity].values[place])
            return with_error(value, table.error(quantity, place), digits)

        yield f"{own}uplift force [N]", lambda i, f=single: f(i, "uplift_force", 1)
        yield f"{own}mean [N]", lambda i, f=force: f(i, "mean")
        for band in _BANDS:
            if band in table.labels[BAND]:
                at = table.labels[BAND].index(band)
                yield (
                    f"{own}σ {band.replace('_', '–')} Hz [N]",
                    lambda i, w=who, b=at, c=f"std_{band}": marked(
                        with_error(
                            float(table["std"].values[(*i, w, kind, b)]),
                            table.error("std", (*i, w, kind, b)),
                        ),
                        is_carried=table.carries(i, c),
                    ),
                )
        yield f"{own}σ advised [N]", lambda i, f=force: f(i, "std_advised")
        yield f"{own}max [N]", lambda i, f=force: f(i, "maximum")
        yield f"{own}min [N]", lambda i, f=force: f(i, "minimum")
        yield (
            f"{own}loss [%]",
            lambda i, f=single: marked(
                f(i, "loss_percent", 2), is_carried=table.carries(i, "losses")
            ),
        )
    yield (
        "uplift [mm]",
        lambda i: with_error(
            1e3 * float(table["uplift_max"].values[i]), 1e3 * table.error("uplift_max", i)
        ),
    )


def _definition(table: StudyTable) -> Section:
    study = table.study
    rows = [("base case", study.base), ("design", study.design)]
    rows += [(f"override {path}", _text(value)) for path, value in study.overrides.items()]
    for path, axis in study.to_dict()["axes"].items():
        rows.append((f"axis {path}", _text(axis)))
    if study.samples is not None:
        rows.append(("Latin hypercube", f"{counted(study.samples, 'sample')}, seed {study.seed}"))
    rows.append(("program", f"tautwire {__version__}"))
    block = Table("The study as it was given.", ("", ""), "ll", tuple(rows))
    return Section("study", "The study", (block,))


def _text(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
