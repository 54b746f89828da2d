"""The door: a library name or a file becomes a validated case, or all its faults are told."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from tautwire.catalogue.entries import list_entries
from tautwire.errors import InputError
from tautwire.inputs.attached import with_image, with_limits
from tautwire.inputs.book.workbook import case_of, is_workbook, open_workbook
from tautwire.inputs.composition import Composition, compose, compose_data
from tautwire.inputs.messages import describe
from tautwire.inputs.overrides import Overrides, apply_overrides
from tautwire.inputs.paths import Path as ValuePath
from tautwire.inputs.paths import PathError, find_target, format_path, parse_path, value_at
from tautwire.inputs.reading.grouping import grouped
from tautwire.inputs.reading.reach import Reach
from tautwire.inputs.reading.tables import cells_by_list
from tautwire.specs.case import Case
from tautwire.specs.schema.upgrade import SCHEMA_VERSION
from tautwire.specs.settings import NOT_GIVEN


def load_case(name_or_path: str | os.PathLike[str], overrides: Overrides = ()) -> Case:
    """Load a case from the library or from a YAML, TOML or JSON file.

    Parameters
    ----------
    name_or_path
        Name of a library case, such as ``"ac-simple"``, or path of a file; a workbook (XLSX) or a
        CSV table of supports becomes a case by the meaning of its headings.
    overrides
        Values that replace those of the file: a mapping from path to value, or texts
        ``"path=value"``. Items of lists are numbered from 1, as in ``"droppers.presag[5]"``.

    Returns
    -------
    Case
        The validated case.

    Raises
    ------
    InputError
        When anything is wrong; every fault is named with its place and its cure.

    Examples
    --------
    >>> load_case("ac-simple", ["scenario.speed=275 km/h"]).scenario.target_mean_force()
    143.35625
    """
    reference = name_or_path if isinstance(name_or_path, str) else Path(name_or_path)
    _refuse_pantograph(reference)
    if is_workbook(reference):
        return _validated(_compose_workbook(Path(reference)), overrides)
    return _validated(compose(reference), overrides)


def make_case(data: Mapping[str, Any], overrides: Overrides = ()) -> Case:
    """Validate a case given as plain data, as a file would hold it.

    Parameters
    ----------
    data
        The case; quantities are SI numbers or texts with a unit.
    overrides
        Values that replace those of the data, as in :func:`load_case`.

    Raises
    ------
    InputError
        When anything is wrong; every fault is named with its place and its cure.
    """
    return _validated(compose_data({"schema": SCHEMA_VERSION, **data}), overrides)


def _compose_workbook(path: Path) -> Composition:
    data, tables = case_of(open_workbook(path))
    composition = compose_data(data, str(path))
    composition.cells |= cells_by_list(tables.origins)
    return composition


def _refuse_pantograph(reference: str | Path) -> None:
    for entry in list_entries():
        if entry.name == reference and entry.kind != "case":
            raise InputError(
                f"{entry.name}: is a {entry.kind}, not a case; put 'include: {entry.name}' into "
                "the pantographs of a case"
            )


def _validated(composition: Composition, overrides: Overrides) -> Case:
    data, problems = apply_overrides(composition.values, overrides, composition.shelf)
    for part in composition.incomplete:
        data.pop(part, None)
    if "schema" not in data:
        problems.append(
            f"schema: is missing; write 'schema: {SCHEMA_VERSION}', the version of the input format"
        )
    if isinstance(data.get("project"), Mapping):  # an image that was set for this run
        data["project"], faults = with_image(data["project"], Path(), Reach.of(Path()), "--set")
        problems += faults
    data, faults = with_limits(data, Path(), Reach.of(Path()), "--set")
    problems += faults
    problems += _unknown_sources(data)
    _state_defaults(data)
    case = None
    try:
        case = Case.model_validate(data)
    except ValidationError as error:
        problems += [
            sentence
            for sentence in describe(error, data, composition.cells)
            if not sentence.startswith(tuple(composition.incomplete))
        ]
    told = [*composition.problems, *(f"{composition.label}: {text}" for text in problems)]
    if case is None or told:
        raise InputError(told)
    return case


STATED_DEFAULTS: dict[ValuePath, str] = {
    ("settings", "contact_stiffness"): "the value of the reference model of EN 50318:2002 is used"
}
"""Values that no line or pantograph determines, and what is used where they are not given."""


def _state_defaults(data: dict[str, Any]) -> None:
    """Add to the sources of a case that values were chosen because none were given."""
    sources = data.get("sources", [])
    if not isinstance(sources, (list, tuple)):
        return
    marks = [
        {"path": format_path(path), "source": f"{NOT_GIVEN}; {text}", "confidence": "choice"}
        for path, text in STATED_DEFAULTS.items()
        if value_at(data, path) is None
    ]
    if marks:
        data["sources"] = [*sources, *marks]


def _unknown_sources(data: Mapping[str, Any]) -> list[str]:
    """Name the entries of 'sources' whose path leads to nothing."""
    problems: dict[str, str] = {}
    entries = data.get("sources")
    for entry in entries if isinstance(entries, list) else []:
        path = entry.get("path") if isinstance(entry, Mapping) else None
        if isinstance(path, str) and path not in problems:
            try:
                find_target(parse_path(path))
            except PathError as error:
                problems[path] = f"sources: the path {path!r} leads to nothing: {error}"
    return grouped(problems.values())
