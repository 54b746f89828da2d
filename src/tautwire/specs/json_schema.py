"""The input format as JSON Schema."""

from __future__ import annotations

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
    definition["properties"]["include"] = {
        "type": "string",
        "description": "Library name or file whose content this mapping completes or replaces.",
    }
    required = definition.pop("required", None)
    if required:
        definition["anyOf"] = [{"required": required}, {"required": ["include"]}]
