"""Section of the inputs with source and confidence, conventions, cost and provenance."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import chain
from typing import Any, get_args

from pydantic import BaseModel

from tautwire.report.parts.blocks import Cell, Columns, Details, Heading, Section, Table, Text
from tautwire.report.parts.views import RunView
from tautwire.report.parts.words import MISSING, compact, counted, listing, number, quantity
from tautwire.specs.base import Quantity
from tautwire.specs.case import Case, Source
from tautwire.specs.line.support import Supports

GROUPS = ("track", "line", "wires", "supports", "droppers", "bodies", "stays", "irregularities",
          "pantographs", "scenario", "settings")  # fmt: skip
LONG = 12
"""Lists with more items than this are shortened."""

MOST_DIFFERENCES = 12
"""Inputs that differ between runs and are shown at once; with more, results move out of sight."""


def conditions_section(views: Sequence[RunView]) -> Section:
    """Write the section about everything that the numbers depend on."""
    blocks: list[object] = [conventions_table(views)]
    blocks.append(Heading("Inputs"))
    blocks.append(
        Text(
            "All values in SI units, defaults included. Numbers in brackets point to the list of "
            "sources; a value without one has no stated source.",
            "note",
        )
    )
    for view in views:
        blocks += input_blocks(view.run.case, view.label if len(views) > 1 else "")
    tables = (_cost_table(views), _provenance_table(views))
    blocks.append(Heading("Cost and provenance"))
    blocks += [Columns(tables)] if len(views) == 1 else tables
    return Section("inputs", "Inputs, conventions and provenance", tuple(blocks))


def conventions_table(views: Sequence[RunView]) -> Table:
    """List the conventions that decide the numbers, one column per run."""
    columns = [_conventions(view) for view in views]
    rows: list[tuple[Cell, ...]] = [
        (name, *(column[name] for column in columns)) for name in columns[0]
    ]
    return Table(
        caption="Conventions. Two results can be compared only if these agree.",
        head=("", *(view.label if len(views) > 1 else "used here" for view in views)),
        align="l" * (1 + len(columns)),
        rows=tuple(rows),
    )


def _conventions(view: RunView) -> dict[str, str]:
    case, section = view.run.case, view.statistics.section
    settings, line, supports = case.settings, case.line, case.supports
    integrator = settings.integrator
    method = {
        "newmark": "Newmark ¼-½",
        "hht": f"HHT-α, α = {integrator.alpha:g}",
        "extrapolated": "Newmark ¼-½, extrapolated from half and quarter steps",
    }
    tuned = case.scenario.target_mean_force()
    prescribed = "prescribed" if case.scenario.uplift_force is not None else "static + aerodynamic"
    condition = case.chosen_condition
    return {
        "condition": "as designed"
        if condition is None
        else "; ".join([condition.name, *condition.told()]),
        "contact stiffness": f"{1e-3 * settings.contact_stiffness:g} kN/m (penalty)",
        "closure at the supports": supports.closure,
        "wire ends": f"{line.ends.left} (left), {line.ends.right} (right)",
        "steady arms": "none" if supports.closure == "spring" else _arms(supports),
        "uplift stops": _stops(supports),
        "cantilevers": _cantilevers(supports),
        "messenger wire along the track": supports.messenger_longitudinal,
        "mesh": settings.mesh(),
        "time step": f"{1e3 * settings.step():g} ms",
        "step control": str(view.run.counters.get("step_control", settings.step_control.method)),
        "irregularities": _irregularities(view),
        "integrator": method[integrator.method],
        "damping": f"{line.damping.mass:g} 1/s · M + {line.damping.stiffness:g} s · K",
        "uplift force": prescribed if tuned is None else f"tuned to a mean of {tuned:.2f} N",
        "analysed section": f"spans {section.first_span} to {section.last_span}, "
        f"{section.start:g} to {section.end:g} m",
        "headline filter": view.lowpass.describe(),
        "running direction": case.scenario.direction,
        "backend": str(view.run.counters.get("backend", settings.backend)),
    }


def _arms(supports: Supports) -> str:
    kinds = {kind.arm.motion for kind in supports.kinds()}
    lengths = sorted({kind.arm.length for kind in supports.kinds()})
    return f"{', '.join(sorted(kinds))}, {listing([f'{length:g}' for length in lengths])} m"


def _stops(supports: Supports) -> str:
    gaps = sorted({k.stop.gap if k.stop is not None else 0.0 for k in supports.kinds()})
    return listing([f"gap {1e3 * gap:g} mm" if gap else "none" for gap in gaps])


def _cantilevers(supports: Supports) -> str:
    told = [k.cantilever.told() for k in supports.kinds() if k.cantilever is not None]
    rigid = ["rigid"] if len(told) < len(supports.kinds()) else []
    return " or ".join(dict.fromkeys([*told, *rigid]))


def _irregularities(view: RunView) -> str:
    """Name the irregularities of a run with their seed."""
    spec, parts = view.run.case.irregularities, []
    if spec.installation is not None:
        word = spec.installation.distribution
        parts.append(f"errors of dropper {spec.installation.of} ({word})")
    if spec.unevenness:
        kinds = listing(list(dict.fromkeys(part.kind for part in spec.unevenness)))
        parts.append(f"unevenness ({kinds})")
    return f"{listing(parts)}, seed {view.run.case.settings.seed}" if parts else "none"


def leaves(spec: BaseModel, path: str = "") -> Iterator[tuple[str, Any, str]]:
    """Yield path, value and SI unit of every value of a spec; items are numbered from 1."""
    for name, field in type(spec).model_fields.items():
        value, where = getattr(spec, name), f"{path}.{name}" if path else name
        if isinstance(value, BaseModel):
            yield from leaves(value, where)
        elif isinstance(value, tuple) and value and isinstance(value[0], BaseModel):
            for index, item in enumerate(value, 1):
                yield from leaves(item, f"{where}[{index}]")
        else:
            yield where, value, _unit((field.annotation, *field.metadata))


def _unit(annotation: Any) -> str:
    """Find the unit inside an annotation, however deep it lies."""
    if isinstance(annotation, Quantity):
        return annotation.unit
    inner = annotation if isinstance(annotation, tuple) else get_args(annotation)
    metadata = getattr(annotation, "__metadata__", ())
    return next(filter(None, map(_unit, chain(metadata, inner))), "")


def input_values(case: Case) -> list[tuple[str, str]]:
    """Return path and value, as text with its unit, of every input of a case."""
    every = [leaf for group in GROUPS for leaf in leaves_of_group(case, group)]
    return [(path, _shown(value, unit)) for path, value, unit in every]


def leaves_of_group(case: Case, group: str) -> Iterator[tuple[str, Any, str]]:
    """Yield the values of one top-level part of a case."""
    part = getattr(case, group)
    if part is case.track:
        found = [leaf for leaf in leaves(part, group) if leaf[1] not in (None, ())]
        level = [("track", "straight and level", "")]
        yield from level if case.track.is_straight_and_level else found
    elif isinstance(part, BaseModel):
        yield from leaves(part, group)
    else:
        for index, item in enumerate(part, 1):
            yield from leaves(item, f"{group}[{index}]")


def _shown(value: Any, unit: str) -> str:
    """Return a value as text; long lists are shortened, equal rows written once."""
    if value is None:
        return "not given"
    text = _plain(value)
    return f"{text} {unit}" if unit and isinstance(value, float | tuple) else text


def _plain(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return compact(value)
    if not isinstance(value, tuple):
        return str(value)
    if len(value) > 1 and isinstance(value[0], tuple) and len(set(value)) == 1:
        return f"{_plain(value[0])} in every span"
    shown = [f"({_plain(v)})" if isinstance(v, tuple) else _plain(v) for v in value[:LONG]]
    rest = len(value) - LONG
    return ", ".join(shown) + (f", … {counted(rest, 'more value')}" if rest > 0 else "")


def input_blocks(case: Case, label: str = "") -> list[object]:
    """Write inputs and sources of one case, folded away; of several, each with its label."""
    paths = [source.path for source in case.sources]
    groups = _grouped(case.sources)
    marks = {path: n for n, (_, _, members) in enumerate(groups, 1) for path in members}
    rows: list[tuple[Cell, ...]] = []
    for path, text in input_values(case):
        at = source_of(path, paths)
        known = ("", "") if at is None else (f"[{marks[paths[at]]}]", case.sources[at].confidence)
        rows.append((path, text, *known))
    inputs = Table("", ("input", "value", "source", "confidence"), "llll", tuple(rows))
    listed = Table(
        caption="Sources",
        head=("", "source", "confidence", "applies to"),
        align="llll",
        rows=tuple(
            (f"[{n}]", text, confidence, ", ".join(members))
            for n, (text, confidence, members) in enumerate(groups, 1)
        ),
    )
    name = f"{label}: inputs" if label else "All inputs"
    blocks: list[object] = [Details(f"{name} ({len(rows)} values)", (inputs,))]
    if not case.sources:
        blocks.append(Text("The case names no sources for its values.", "note"))
    elif label:
        blocks.append(Details(f"{label}: sources", (listed,)))
    else:
        blocks.insert(0, listed)
    return blocks


def _grouped(sources: Sequence[Source]) -> list[tuple[str, str, list[str]]]:
    """Return text, confidence and paths of the sources, each text once."""
    groups: dict[tuple[str, str], list[str]] = {}
    for source in sources:
        taken = f"From {source.template}, not checked for this line: " if source.template else ""
        groups.setdefault((taken + source.source, source.confidence), []).append(source.path)
    return [(text, confidence, paths) for (text, confidence), paths in groups.items()]


def source_of(path: str, sources: Sequence[str]) -> int | None:
    """Return the index of the source that names a path or the smallest group around it."""
    bare = re.sub(r"\[\d*\]", "", path)
    best, found = -1, None
    for index, source in enumerate(sources):
        for whole, part in ((path, source), (bare, re.sub(r"\[\d*\]", "", source))):
            is_exact_item = "[" in source and whole is bare
            inside = whole == part or whole.startswith((f"{part}.", f"{part}["))
            if inside and not is_exact_item and len(part) > best:
                best, found = len(part), index
    return found


def difference_blocks(views: Sequence[RunView]) -> list[object]:
    """List the inputs that are not the same in all runs; many of them are folded away."""
    values = [_with_whole_items(dict(input_values(view.run.case))) for view in views]
    paths = dict.fromkeys(path for column in values for path in column)
    cells = [(path, tuple(column.get(path) for column in values)) for path in paths]
    differing = [(path, texts) for path, texts in cells if len(set(texts)) > 1]
    gone = [path for path, texts in differing if None in texts]
    rows = [
        (path, *(MISSING if text is None else text for text in texts))
        for path, texts in differing
        if not any(path != whole and path.startswith(f"{whole}.") for whole in gone)
    ]
    head, align = ("input", *(view.label for view in views)), "l" * (1 + len(views))
    caption = "Inputs that are not the same in all runs." if rows else "All inputs are the same."
    blocks: list[object] = [Table(caption, head, align, tuple(rows[:MOST_DIFFERENCES]))]
    if rest := tuple(rows[MOST_DIFFERENCES:]):
        blocks.append(
            Details(f"{counted(len(rest), 'more difference')}", (Table("", head, align, rest),))
        )
    return blocks


def _with_whole_items(values: dict[str, str]) -> dict[str, str]:
    """Add items of lists as a whole, so that one which a run lacks is told in one row."""
    wholes = {
        match[0]: "given" for path in values for match in re.finditer(r"^.*?\[\d+\](?=\.)", path)
    }
    return {**wholes, **values}


def _cost_table(views: Sequence[RunView]) -> Table:
    """List what the computation cost."""
    names = {
        "dof": ("degrees of freedom", "", 0),
        "steps": ("time steps", "", 0),
        "iterations_mean": ("iterations per step", "", 2),
        "refactorisations": ("factorisations", "", 0),
        "full_newton_steps": ("steps by full Newton", "", 0),
        "simulated_s": ("simulated time", "s", 2),
        "cpu_s": ("CPU time", "s", 1),
        "wall_s": ("elapsed time", "s", 1),
        "real_time_factor": ("CPU time per simulated time", "", 2),
        "tuning_passes": ("passes to tune the mean force", "", 0),
    }
    rows = []
    for key, (title, unit, digits) in names.items():
        values = [view.run.counters.get(key) for view in views]
        if any(value is not None for value in values):
            rows.append((title, *(quantity(value, unit, digits) for value in values)))
    heads = [view.label if len(views) > 1 else "" for view in views]
    return Table(
        caption="Cost of the reported passage.",
        head=("", *heads),
        align="l" + "r" * len(views),
        rows=tuple(rows),
    )


def _provenance_table(views: Sequence[RunView]) -> Table:
    names = {
        "version": "tautwire",
        "commit": "commit",
        "created": "computed (UTC)",
        "python": "Python",
        "platform": "platform",
        "backend": "backend",
    }
    rows: list[tuple[Cell, ...]] = []
    for key, title in names.items():
        values = [str(view.run.provenance.get(key, "")) for view in views]
        if any(values):
            rows.append((title, *(value or number(None) for value in values)))
    rows.append(("SHA-256 of the case", *(view.run.case.hash() for view in views)))
    shapes = [view.run.equilibrium for view in views]
    found = [f"{s.iterations} Newton iterations, to {s.residual:.1e} N" for s in shapes]
    rows.append(("equilibrium", *found))
    heads = [view.label if len(views) > 1 else "" for view in views]
    return Table("Provenance.", ("", *heads), "l" * (1 + len(views)), tuple(rows))
