"""What all specs share: frozen models, quantities with units, forms a value can take."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Self

from pydantic import BaseModel, ConfigDict, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from tautwire.text import shown
from tautwire.units import UnitError, expectation, parse_quantity

SMALLEST = 1e-30
"""Smallest size of a quantity other than 0: none in SI is smaller, and one over it is finite."""

SCALAR = "<scalar>"
LIST = "<list>"
TABLE = "<list of lists>"
MAPPING = "<mapping>"
NOTHING = "<nothing>"
FORMS = frozenset({SCALAR, LIST, TABLE, MAPPING, NOTHING})


def form_of(value: object) -> str:
    """Tell which form a value has, so that one branch of a union is tried and reported."""
    if value is None:
        return NOTHING
    if isinstance(value, (list, tuple)):
        return TABLE if any(isinstance(item, (list, tuple)) for item in value) else LIST
    if isinstance(value, (Mapping, BaseModel)):
        return MAPPING
    return SCALAR


@dataclass(frozen=True)
class Quantity:
    """Annotation of a float field: SI unit, allowed range, typical value.

    The field accepts a number (SI) or a text with a unit; it always holds a finite SI float. Where
    values out of range are written for something else, ``beyond`` says what that is called here.

    Examples
    --------
    ``tension: Annotated[float, Quantity("N", gt=0.0, typical="10 to 30 kN")]``
    """

    unit: str
    gt: float | None = None
    ge: float | None = None
    lt: float | None = None
    le: float | None = None
    typical: str = ""
    beyond: str = ""

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        number = core_schema.float_schema(
            gt=self.gt, ge=self.ge, lt=self.lt, le=self.le, allow_inf_nan=False
        )
        return core_schema.no_info_before_validator_function(self._to_si, number)

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        text = {"type": "string", "description": f"With a unit: {expectation(self.unit)}."}
        extra = {"unit": self.unit} | ({"typical": self.typical} if self.typical else {})
        return {"anyOf": [handler(schema), text]} | extra

    def _to_si(self, value: object) -> float:
        number = parse_quantity(value, self.unit)
        if number != 0.0 and abs(number) < SMALLEST:
            raise UnitError(f"got {shown(value)}, too small to be meant; give 0 or a usual value")
        return number


@dataclass(frozen=True)
class Typical:
    """Annotation of a field that is not a quantity: typical value, for the reference page."""

    text: str

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        return handler(schema) | {"typical": self.text}


class Spec(BaseModel):
    """Base of all specs: immutable, refuses unknown fields, changed by :meth:`with_`."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False, validate_by_name=True
    )

    named_items: ClassVar[type[Spec] | None] = None
    """What a spec with keys of any name holds under them."""

    catalogue_kinds: ClassVar[tuple[str, ...]] = ()
    """Kinds of catalogue entries that ``use`` may name in a mapping of this spec."""

    table_columns: ClassVar[tuple[str, ...]] = ()
    """Lists that ``table`` may give in a mapping of this spec, as columns of a CSV file."""

    optional_columns: ClassVar[tuple[str, ...]] = ()
    """Those of them that a table may lack."""

    def with_(self, **changes: Any) -> Self:
        """Return a validated copy with some fields changed.

        Parameters
        ----------
        **changes
            New values by field name; a field of a nested spec by its dotted path, as in
            ``case.with_(**{"scenario.speed": "275 km/h"})``.

        Returns
        -------
        Spec
            A new object of the same class.

        Raises
        ------
        pydantic.ValidationError
            When the changed spec is not valid.
        """
        own = {name: getattr(self, name) for name in type(self).model_fields}
        own |= self.model_extra or {}
        nested: dict[str, dict[str, Any]] = {}
        for path, value in changes.items():
            head, _, rest = path.partition(".")
            if rest:
                nested.setdefault(head, {})[rest] = value
            else:
                own[head] = value
        for head, inner in nested.items():
            child = own.get(head)
            own[head] = child.with_(**inner) if isinstance(child, Spec) else inner
        return type(self).model_validate(own)

    def to_dict(self) -> dict[str, Any]:
        """Return the spec as plain data in SI units, as it is written in a file."""
        return self.model_dump(mode="json", by_alias=True)


@dataclass(frozen=True)
class Problem:
    """A contradiction between fields.

    Attributes
    ----------
    path
        Field names and 0-based indices leading to the value at fault, from the case.
    text
        What is wrong and what to do, without the path.
    """

    path: tuple[str | int, ...]
    text: str

    def under(self, *parents: str | int) -> Problem:
        """Return the same problem seen from further up the tree."""
        return Problem((*parents, *self.path), self.text)


class ContradictionError(ValueError):
    """Fields that are valid one by one but not together; carries every problem found."""

    def __init__(self, problems: list[Problem]) -> None:
        self.problems = tuple(problems)
        super().__init__("; ".join(problem.text for problem in problems))


def refuse(problems: list[Problem]) -> None:
    """Raise :class:`ContradictionError` when there is any problem."""
    if problems:
        raise ContradictionError(problems)
