"""Every field of an input file is documented."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from tautwire.specs.case import Case

SCHEMA = Case.model_json_schema(by_alias=True)
SPECS = {"Case": SCHEMA, **SCHEMA["$defs"]}
FIELDS = [
    (spec, name, field)
    for spec, schema in SPECS.items()
    for name, field in schema.get("properties", {}).items()
]


def _nested(schema: Any) -> Iterator[dict[str, Any]]:
    """Yield a schema and everything inside it."""
    if isinstance(schema, dict):
        yield schema
        for inner in schema.values():
            yield from _nested(inner)
    elif isinstance(schema, list):
        for inner in schema:
            yield from _nested(inner)


@pytest.mark.parametrize(("spec", "name", "field"), FIELDS, ids=lambda value: str(value)[:30])
def test_field_has_a_text(spec: str, name: str, field: dict[str, Any]) -> None:
    """Every field says what it is, in a sentence that ends with a full stop."""
    text = field.get("description", "")
    assert text.endswith("."), f"{spec}.{name}"


@pytest.mark.parametrize(("spec", "name", "field"), FIELDS, ids=lambda value: str(value)[:30])
def test_quantity_has_a_unit(spec: str, name: str, field: dict[str, Any]) -> None:
    """Every real number carries its unit, or stands for a group whose fields do."""
    parts = list(_nested(field))
    if any(part.get("type") == "number" for part in parts):
        assert any("unit" in part or "$ref" in part for part in parts), f"{spec}.{name}"


@pytest.mark.parametrize("spec", SPECS)
def test_spec_has_a_text(spec: str) -> None:
    """Every group of fields says what it stands for."""
    assert SPECS[spec].get("description")
