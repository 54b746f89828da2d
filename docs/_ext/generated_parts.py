"""Fill in the parts of pages that come from the program itself.

A page holds a marker in an HTML comment; when the page is read, the marker is replaced by
Markdown made from the specs, the command line, or the stored validation table.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx

DOCS = Path(__file__).resolve().parents[1]
Schema = dict[str, Any]


def input_reference() -> str:
    """Return one section with a table for every spec of a case file."""
    from tautwire.specs.case import Case

    return _reference_of(Case.model_json_schema(by_alias=True))


def span_table_reference() -> str:
    """Return one section with a table for every spec of a file of a span table."""
    from tautwire.specs.span_table import SpanTable

    return _reference_of(SpanTable.model_json_schema(by_alias=True))


def _reference_of(schema: Schema) -> str:
    places = _places(schema)
    parts = [_spec_section(schema, ["the file"])]
    for name, spec in _in_order(schema, places):
        parts.append(_spec_section(spec, places[name]))
    return "\n\n".join(parts)


def _reference(schema: Schema) -> Iterator[tuple[str, bool]]:
    """Yield the names of specs a field can hold, and whether it holds a list of them."""
    if "$ref" in schema:
        yield schema["$ref"].rsplit("/", 1)[-1], False
    for key in ("anyOf", "oneOf", "allOf"):
        for inner in schema.get(key, []):
            yield from _reference(inner)
    for key in ("items", "additionalItems"):
        if key in schema:
            yield from ((name, True) for name, _ in _reference(schema[key]))


def _places(schema: Schema) -> dict[str, list[str]]:
    """Return the dotted paths at which every spec can stand."""
    found: dict[str, list[str]] = {}

    def visit(spec: Schema, path: str) -> None:
        for key, field in spec.get("properties", {}).items():
            for name, is_list in _reference(field):
                here = f"{path}.{key}".lstrip(".") + ("[n]" if is_list else "")
                if here not in found.setdefault(name, []):
                    found[name].append(here)
                    visit(schema["$defs"][name], here)

    visit(schema, "")
    return found


def _in_order(schema: Schema, places: dict[str, list[str]]) -> Iterator[tuple[str, Schema]]:
    """Yield the specs in the order in which an input file mentions them."""
    return ((name, schema["$defs"][name]) for name in places)


def _spec_section(spec: Schema, places: list[str]) -> str:
    heading = " and ".join(f"`{place}`" if place != "the file" else "The file" for place in places)
    text = [f"### {heading}", spec.get("description", "")]
    rows = [_row(key, field, spec) for key, field in spec.get("properties", {}).items()]
    text.append("| field | meaning | unit | range | typical | if left out |")
    text[-1] += "\n|---|---|---|---|---|---|\n" + "\n".join(rows)
    return "\n\n".join(text)


def _row(key: str, field: Schema, spec: Schema) -> str:
    cells = [
        f"`{key}`",
        field.get("description", ""),
        _first(field, "unit"),
        _range(field),
        _first(field, "typical"),
        _default(key, field, spec),
    ]
    return "| " + " | ".join(" ".join(cell.split()).replace("|", "\\|") for cell in cells) + " |"


def _branches(field: Schema) -> Iterator[Schema]:
    """Yield a field's schema and everything nested in it, references excluded."""
    yield field
    for key in ("anyOf", "oneOf", "allOf", "prefixItems"):
        for inner in field.get(key, []):
            yield from _branches(inner)
    if isinstance(field.get("items"), dict):
        yield from _branches(field["items"])


def _first(field: Schema, key: str) -> str:
    found = (branch[key] for branch in _branches(field) if branch.get(key))
    return str(next(found, ""))


def _range(field: Schema) -> str:
    for branch in _branches(field):
        if "enum" in branch:
            return ", ".join(f"`{word}`" for word in branch["enum"])
        bounds = [
            f"{sign} {branch[key]:g}"
            for key, sign in (
                ("exclusiveMinimum", ">"),
                ("minimum", "≥"),
                ("exclusiveMaximum", "<"),
                ("maximum", "≤"),
            )
            if key in branch
        ]
        if bounds:
            return ", ".join(bounds)
        if branch.get("type") == "boolean":
            return "`true`, `false`"
    return ""


def _default(key: str, field: Schema, spec: Schema) -> str:
    if key in spec.get("required", []):
        return "**required**"
    value = field.get("default")
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    if isinstance(value, int | float):
        return f"`{_number(value)}`"
    return f"`{value}`" if isinstance(value, str) and value else ""


def _number(value: float) -> str:
    """Write a number without padding: 0.0125, 1e6, 1e-4."""
    mantissa, _, exponent = f"{value:.6g}".partition("e")
    return f"{mantissa}e{int(exponent)}" if exponent else mantissa


def command_reference() -> str:
    """Return one section per command with its arguments and options."""
    from typer.main import get_command

    from tautwire.cli.app import app

    group: Any = get_command(app)
    return "\n\n".join(_command_section(name, group.commands[name]) for name in group.commands)


def _command_section(name: str, command: Any) -> str:
    lines = [f"## `tautwire {name}`", (command.help or "").replace("\b", "").strip()]
    rows = [
        f"| {_spelling(parameter)} | {' '.join((getattr(parameter, 'help', '') or '').split())} |"
        for parameter in command.params
        if not getattr(parameter, "hidden", False)
    ]
    if rows:
        lines.append("| argument or option | meaning |\n|---|---|\n" + "\n".join(rows))
    return "\n\n".join(lines)


def _spelling(parameter: Any) -> str:
    """Return an argument or option as it is typed."""
    value = parameter.metavar or ""
    if parameter.param_type_name == "argument":
        return f"`{value or parameter.name.upper()}`"
    return ", ".join(f"`{word} {value}`".replace(" `", "`") for word in parameter.opts)


def validation_table() -> str:
    """Return one table per case from the rows that the tests stored."""
    path = DOCS / "validation.json"
    rows = json.loads(path.read_text(encoding="utf-8")) if path.exists() else []
    cases = list(dict.fromkeys(row["case"] for row in rows))
    return "\n\n".join(
        _case_table(case, [row for row in rows if row["case"] == case]) for case in cases
    )


def _case_table(case: str, rows: list[dict[str, Any]]) -> str:
    head = (
        "| quantity | unit | tautwire | source | tolerance | verdict | from |\n" + "|---" * 7 + "|"
    )
    lines = [
        "| "
        + " | ".join(
            (
                row["quantity"],
                row["unit"],
                f"{row['ours']:.5g}",
                "" if row["target"] is None else f"{row['target']:g}",
                row["tolerance"],
                row["verdict"] + (f" ({row['note']})" if row["note"] else ""),
                row["source"],
            )
        )
        + " |"
        for row in rows
    ]
    return f"## {case}\n\n{head}\n" + "\n".join(lines)


def gallery() -> str:
    """Return the notebooks of the gallery, run."""
    from notebooks import gallery as run_notebooks

    return run_notebooks()


def result_file_reference() -> str:
    """Return one table per group of a result file."""
    from tautwire.results import layout

    root = (
        *(layout.TIME, layout.NAMES, layout.STAGE_COUNT, *layout.RUN, *layout.DROPPERS),
        *(*layout.PANTOGRAPH, *layout.PANTOGRAPH_SCALARS),
    )
    groups = {
        "The file itself": root,
        "Group `snapshots`: shapes of the wires now and then": layout.SNAPSHOTS,
        "Group `events`: losses of contact, with a variable or adaptive step": layout.EVENTS,
        "Group `irregularities`: what was drawn, where there are any": layout.IRREGULARITIES,
        "Group `equilibrium`: the static line": layout.EQUILIBRIUM,
        "Group `elasticity`": layout.ELASTICITY,
    }
    return "\n\n".join(_entries(title, entries) for title, entries in groups.items())


def _entries(title: str, entries: tuple[Any, ...]) -> str:
    rows = [_quantity(one.name, one.dimensions, one.units, one.text) for one in entries]
    head = "| variable | over | unit | meaning |\n|---|---|---|---|\n"
    return f"### {title}\n\n{head}" + "\n".join(rows)


def _quantity(name: str, dimensions: tuple[str, ...], unit: str, text: str) -> str:
    return f"| `{name}` | {', '.join(dimensions)} | {'' if unit == '1' else unit} | {text} |"


def study_table_reference() -> str:
    """Return the quantities of the table of a study."""
    from tautwire.studies import columns

    rows = [_quantity(name, (), "1", text) for name, text in columns.TEXTS.items()]
    rows += [
        _quantity(one.name, one.dimensions, one.unit, one.text)
        for one in (*columns.KNOWN, *columns.COST)
    ]
    return "| quantity | one for each | unit | meaning |\n|---|---|---|---|\n" + "\n".join(rows)


MARKERS: dict[str, Callable[[], str]] = {
    "<!-- input reference -->": input_reference,
    "<!-- command reference -->": command_reference,
    "<!-- span table reference -->": span_table_reference,
    "<!-- result file reference -->": result_file_reference,
    "<!-- study table reference -->": study_table_reference,
    "<!-- validation table -->": validation_table,
    "<!-- gallery -->": gallery,
}


def fill_in(app: Sphinx, docname: str, source: list[str]) -> None:
    """Replace the markers of a page that is being read."""
    for marker, generate in MARKERS.items():
        if marker in source[0]:
            source[0] = source[0].replace(marker, generate())
            app.env.note_reread()
            if docname == "validation":
                app.env.note_dependency(str(DOCS / "validation.json"))


def setup(app: Sphinx) -> dict[str, bool]:
    """Register with Sphinx."""
    app.connect("source-read", fill_in)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
