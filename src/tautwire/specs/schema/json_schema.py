"""The input format as JSON Schema."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from tautwire.specs.base import Spec
from tautwire.specs.case import Case
from tautwire.specs.schema.upgrade import READ_VERSIONS

JsonSchema = dict[str, Any]


def case_json_schema() -> JsonSchema:
    """Return the JSON Schema of a case file.

    Quantities are a number (SI) or a text with a unit; each carries ``unit`` and ``typical``.
    Every mapping may hold ``include`` instead of its required keys, one for which the catalogue has
    entries ``use``, one with lists ``table``, and the top level ``tables``, ``catalogue`` and
    ``template``.
    """
    schema = _any_of(Case.model_json_schema(by_alias=True, mode="validation"))
    specs = {spec.__name__: spec for spec in _below(Spec)}
    for name, definition in {Case.__name__: schema, **schema["$defs"]}.items():
        _allow_keys(definition, _bringing(specs.get(name, Spec)))
    files = {"anyOf": [_NAME, {"type": "array", "items": _NAME}]}
    schema["properties"]["catalogue"] = {**files, "description": "Own catalogue files."}
    schema["properties"]["template"] = {
        **_NAME,
        "description": "Library case of which the file is a copy.",
    }
    schema["properties"]["schema"] |= {"enum": list(READ_VERSIONS)}
    schema["properties"]["schema"].pop("const", None)
    schema["properties"]["tables"] = {
        "type": "object",
        "description": "CSV files, relative to the case file.",
        "properties": {
            "supports": {"type": "string", "description": "One row per support."},
            "droppers": {"type": "string", "description": "One row per dropper."},
            "wires": {"type": "string", "description": "One row per wire."},
            "bodies": {"type": "string", "description": "One row per body in the line of a wire."},
            "stays": {"type": "string", "description": "One row per stay of a wire."},
            "tension_lengths": {"type": "string", "description": "One row per tension length."},
            "overlaps": {"type": "string", "description": "One row per overlap, or one for all."},
        },
        "additionalProperties": False,
    }
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def _below(spec: type[Spec]) -> Iterator[type[Spec]]:
    """Yield all specs."""
    for own in spec.__subclasses__():
        yield own
        yield from _below(own)


def _bringing(spec: type[Spec]) -> tuple[str, ...]:
    """Return the keys of a mapping that bring others with them."""
    use = ("use",) if spec.catalogue_kinds else ()
    return ("include", *use, *(("table",) if spec.table_columns else ()))


def _any_of(node: Any) -> Any:
    """Replace ``oneOf`` by ``anyOf``: an empty list is both a list and a list of lists."""
    if isinstance(node, dict):
        return {("anyOf" if key == "oneOf" else key): _any_of(item) for key, item in node.items()}
    if isinstance(node, list):
        return [_any_of(item) for item in node]
    return node


def _allow_keys(definition: JsonSchema, keys: tuple[str, ...]) -> None:
    """Let keys that bring others with them stand in place of the required ones."""
    for key in keys:
        definition["properties"][key] = _BRINGING[key]
    required = definition.pop("required", None)
    ways = definition.get("anyOf", [{"required": required}] if required else [])
    if ways:
        given = [{"required": [key]} for key in keys]
        definition["anyOf"] = [*ways, *(way for way in given if way not in ways)]


_NAME = {"type": "string"}
_BRINGING = {
    "include": {
        **_NAME,
        "description": "Library name or file whose content this mapping completes or replaces.",
    },
    "use": {
        "anyOf": [_NAME, {"type": "array", "items": _NAME}],
        "description": "Catalogue entry, or several, whose numbers this mapping completes or "
        "replaces.",
    },
    "table": {
        **_NAME,
        "description": "CSV file whose columns stand for the lists of this mapping.",
    },
}
