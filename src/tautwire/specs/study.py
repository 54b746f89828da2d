"""Studies: one case computed many times, with some of its values changed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from tautwire.specs.base import LIST, Problem, Spec, Typical, refuse
from tautwire.specs.pantograph import Name
from tautwire.text import shown

RANGE, SPREAD, SEEDS, VARIANTS = "<range>", "<interval>", "<seeds>", "<variants>"
AXIS_FORMS = frozenset({LIST, RANGE, SPREAD, SEEDS, VARIANTS})
MOST_VALUES = 100_000
"""Values of an axis, and cases of a study: their rows are files of one folder each."""

Scale = Literal["linear", "log"]


def _number_or_text(value: object) -> object:
    if isinstance(value, (int, float, str)) and not isinstance(value, bool):
        return value
    raise ValueError(f"got {shown(value)}; expected a number, or a text with a unit")


Value = Annotated[
    Any, BeforeValidator(_number_or_text, json_schema_input_type=float | str), Typical("50 kN/m")
]


class Range(Spec):
    """Evenly spaced values."""

    first: Value = Field(alias="from", description="First value.")
    last: Value = Field(alias="to", description="Last value, included where a step meets it.")
    step: Value | None = Field(
        default=None, description="Distance between values; this or a count."
    )
    count: Annotated[int, Field(ge=1, le=MOST_VALUES, strict=True), Typical("5")] | None = Field(
        default=None, description="Number of values, both ends included; this or a step."
    )
    scale: Scale = Field(
        default="linear",
        description="With a count: 'linear' (equal differences) or 'log' (equal ratios).",
    )

    @model_validator(mode="after")
    def _check_division(self) -> Range:
        if (self.step is None) == (self.count is None):
            refuse([Problem((), "give either a step or a count beside 'from' and 'to'")])
        if self.step is not None and self.scale == "log":
            refuse([Problem(("scale",), "got 'log' with a step; give a count")])
        return self


class Spread(Spec):
    """An interval from which a Latin hypercube draws values."""

    low: Value = Field(description="Smallest value.")
    high: Value = Field(description="Largest value.")
    scale: Scale = Field(
        default="linear",
        description="'linear' (uniform) or 'log' (uniform in the logarithm).",
    )


class Seeds(Spec):
    """Consecutive whole numbers, for repetitions that differ in their random numbers."""

    seeds: Annotated[int, Field(ge=1, le=MOST_VALUES, strict=True), Typical("20")] = Field(
        description="Number of seeds."
    )
    first: Annotated[int, Field(ge=0, le=2**31, strict=True), Typical("0")] = Field(
        default=0, description="First seed."
    )


class Variants(Spec):
    """Named groups of changes that belong together, such as a mesh with its time step."""

    variants: dict[str, dict[str, Any]] = Field(
        min_length=1, description="Name of each variant, and its values by path."
    )


def _form_of_axis(value: object) -> str | None:
    """Tell which form an axis has from its keys."""
    if isinstance(value, (list, tuple)):
        return LIST
    if isinstance(value, (Range, Spread, Seeds, Variants)):
        return {Range: RANGE, Spread: SPREAD, Seeds: SEEDS, Variants: VARIANTS}[type(value)]
    if not isinstance(value, Mapping):
        return None
    keys = {"low": SPREAD, "high": SPREAD, "seeds": SEEDS, "variants": VARIANTS}
    found = [form for key, form in keys.items() if key in value]
    return found[0] if found else RANGE


Axis = Annotated[
    Annotated[
        tuple[Any, ...],
        Field(min_length=1, max_length=MOST_VALUES),
        Tag(LIST),
    ]
    | Annotated[Range, Tag(RANGE)]
    | Annotated[Spread, Tag(SPREAD)]
    | Annotated[Seeds, Tag(SEEDS)]
    | Annotated[Variants, Tag(VARIANTS)],
    Discriminator(_form_of_axis),
]


class Study(Spec):
    """A base case and the values of it that vary.

    Axes with ``{low, high}`` are drawn together as one Latin hypercube of ``samples`` points.
    """

    schema_version: Annotated[Literal[1], Typical("1")] = Field(
        alias="schema", description="Version of the input format."
    )
    name: Annotated[Name, Typical("speed-and-stiffness")] = Field(
        description="Short name, used in results and folder names."
    )
    title: Annotated[str, Field(max_length=200)] = Field(
        default="", description="One line for the report."
    )
    description: str = Field(default="", description="Free text for the report.")
    base: Annotated[str, Field(min_length=1), Typical("ac-simple")] = Field(
        description="Name of a library case, or path of a case file beside the study file."
    )
    overrides: dict[str, Any] = Field(
        default={}, description="Values of the base case replaced in all cases, by path."
    )
    design: Literal["grid", "zip"] = Field(
        default="grid",
        description="'grid' (every combination) or 'zip' (first values together, then second "
        "values, and so on).",
    )
    axes: Annotated[dict[str, Axis], Field(min_length=1, max_length=20)] = Field(
        description="What varies: path of a value (a name of your own for variants) and its "
        "values: a list, {from, to, step or count}, {low, high}, {seeds} or {variants}.",
    )
    samples: Annotated[int, Field(ge=1, le=MOST_VALUES, strict=True), Typical("50")] | None = Field(
        default=None, description="Number of points of the Latin hypercube of {low, high} axes."
    )
    seed: Annotated[int, Field(ge=0, le=2**32 - 1, strict=True), Typical("0")] = Field(
        default=0, description="Seed of the Latin hypercube."
    )
    keep_runs: Annotated[bool, Field(strict=True)] = Field(
        default=False, description="Keep the histories of every case as a netCDF file."
    )

    @model_validator(mode="after")
    def _check_samples(self) -> Study:
        is_drawn = any(isinstance(axis, Spread) for axis in self.axes.values())
        if is_drawn and self.samples is None:
            refuse([Problem(("samples",), "is missing: axes with {low, high} need it")])
        if self.samples is not None and not is_drawn:
            refuse([Problem(("samples",), "is given, but no axis has {low, high}")])
        return self
