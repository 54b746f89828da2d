"""The input format described by itself: JSON Schema and the rows of the reference page."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from tautwire.specs.case import Case

JsonSchema = dict[str, Any]


def case_json_schema() -> JsonSchema:
    """Return the JSON Schema of a case file.

    Quantities are a number (SI) or a text with a unit; each carries ``unit`` and ``typical``.
    Every mapping may hold ``include`` instead of its required keys, and the top level ``tables``.
    """
    schema = _any_of(Case.model_json_schema(by_alias=True, mode="validation"))
    for definition in [schema, *schema["$defs"].values()]:
        _allow_include(definition)
    roof = schema["$defs"]["RoofMotion"]
    roof["properties"]["table"] = {"type": "string", "description": "CSV file of time and height."}
    roof["anyOf"].append({"required": ["table"]})
    schema["properties"]["tables"] = {
        "type": "object",
        "description": "CSV files, relative to the case file.",
        "properties": {
            "supports": {"type": "string", "description": "One row per support."},
            "droppers": {"type": "string", "description": "One row per dropper."},
        },
        "additionalProperties": False,
    }
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def _any_of(node: Any) -> Any:
    """Replace ``oneOf`` by ``anyOf``: an empty list is both a list and a list of lists."""
    if isinstance(node, dict):
        return {("anyOf" if key == "oneOf" else key): _any_of(item) for key, item in node.items()}
    if isinstance(node, list):
        return [_any_of(item) for item in node]
    return node


def _allow_include(definition: JsonSchema) -> None:
    if definition.get("type") != "object":
        return
    definition["properties"]["include"] = {
        "type": "string",
        "description": "Library name or file whose content this mapping completes or replaces.",
    }
    required = definition.pop("required", None)
    if required:
        definition["anyOf"] = [{"required": required}, {"required": ["include"]}]


@dataclass(frozen=True)
class FieldRow:
    """One field of the input format, as the reference page shows it.

    Attributes
    ----------
    path
        Where the field stands, as in ``pantographs[].stages[].mass``.
    kind
        What may be written: ``number or text``, ``list``, ``'height', 'lift'`` ...
    unit, default, allowed, typical, description
        Texts; empty where they do not apply. The default is ``required`` where there is none.
    """

    path: str
    kind: str
    unit: str
    default: str
    allowed: str
    typical: str
    description: str


def field_rows() -> tuple[FieldRow, ...]:
    """Return one row for every field of a case file, in the order of the format."""
    schema = Case.model_json_schema(by_alias=True, mode="validation")
    return tuple(_rows(schema, "", schema["$defs"]))


def _rows(model: JsonSchema, prefix: str, definitions: JsonSchema) -> Iterator[FieldRow]:
    required = model.get("required", [])
    for name, field in model["properties"].items():
        leaves = list(_leaves(field, definitions))
        nested = next((leaf for leaf in leaves if "properties" in leaf), None)
        path = f"{prefix}{name}"
        yield FieldRow(
            path=path,
            kind=" or ".join(dict.fromkeys(filter(None, map(_kind, leaves)))),
            unit=_first(field, leaves, "unit"),
            default="required" if name in required else _shown_default(field),
            allowed=_range(leaves),
            typical=_first(field, leaves, "typical"),
            description=field.get("description", ""),
        )
        if nested is not None:
            item = "[]" if field.get("type") == "array" else ""
            yield from _rows(nested, f"{path}{item}.", definitions)


def _leaves(node: JsonSchema, definitions: JsonSchema) -> Iterator[JsonSchema]:
    """Yield every form a value can take, lists before their items."""
    if "$ref" in node:
        yield from _leaves(definitions[node["$ref"].rsplit("/", 1)[1]], definitions)
        return
    branches = node.get("anyOf") or node.get("oneOf")
    if branches is None:
        yield node
    elif "unit" in node:
        yield {"type": "number", **branches[0], "unit": node["unit"]} | {
            key: node[key] for key in ("typical",) if key in node
        }
    else:
        for branch in branches:
            yield from _leaves(branch, definitions)
    for item in [node["items"]] if "items" in node else node.get("prefixItems", []):
        yield from _leaves(item, definitions)


def _kind(leaf: JsonSchema) -> str:
    if "const" in leaf:
        return repr(leaf["const"])
    if "enum" in leaf:
        return ", ".join(repr(word) for word in leaf["enum"])
    if leaf.get("type") == "null":
        return ""
    words = {
        "number": "quantity" if leaf.get("unit") else "number",
        "integer": "whole number",
        "string": "text",
        "boolean": "true, false",
        "array": "list",
        "object": "mapping",
    }
    return words.get(leaf.get("type", ""), "")


def _first(field: JsonSchema, leaves: list[JsonSchema], key: str) -> str:
    return next((str(node[key]) for node in [field, *leaves] if key in node), "")


def _shown_default(field: JsonSchema) -> str:
    default = field.get("default")
    if default is None or default == "" or isinstance(default, dict):
        return ""
    return f"{default:g}" if isinstance(default, float) else str(default)


def _range(leaves: list[JsonSchema]) -> str:
    signs = {"exclusiveMinimum": ">", "minimum": "≥", "exclusiveMaximum": "<", "maximum": "≤"}
    for leaf in leaves:
        bounds = [f"{sign} {leaf[key]:g}" for key, sign in signs.items() if key in leaf]
        if bounds:
            return ", ".join(bounds)
    return ""
