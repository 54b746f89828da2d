"""Study files read and validated; all faults are told together."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from tautwire.catalogue.entries import list_entries
from tautwire.errors import InputError
from tautwire.faults import words_of
from tautwire.inputs.paths import fields_by_key
from tautwire.inputs.reading.documents import SUFFIXES, parse_document
from tautwire.inputs.reading.files import did_you_mean, read_case_text
from tautwire.inputs.reading.grouping import grouped
from tautwire.inputs.reading.reach import Reach
from tautwire.specs.base import ContradictionError, Spec
from tautwire.specs.study import (
    AXIS_FORMS,
    RANGE,
    SEEDS,
    SPREAD,
    VARIANTS,
    Range,
    Seeds,
    Spread,
    Study,
    Variants,
)
from tautwire.text import shown

_SPECS: dict[str, type[Spec]] = {RANGE: Range, SPREAD: Spread, SEEDS: Seeds, VARIANTS: Variants}
_AXIS = "a list, {from, to, step or count}, {low, high}, {seeds} or {variants}"


def load_study(path: str | os.PathLike[str]) -> Study:
    """Read a study from a YAML, TOML or JSON file.

    Parameters
    ----------
    path
        The file. A base case that is a file is looked for in its folder.

    Returns
    -------
    Study

    Raises
    ------
    InputError
        When the file cannot be read or is not a study; every fault is named.
    """
    file = Path(path)
    if file.suffix.lower() not in SUFFIXES:
        raise InputError(f"{file}: is no study file; its name must end in {', '.join(SUFFIXES)}")
    data = parse_document(read_case_text(file), str(file), file.suffix)
    study = make_study(data, label=str(file))
    if study.base in {entry.name for entry in list_entries()}:
        return study
    base = file.parent / study.base
    Reach.of(file.parent).check(base, str(file))
    return study.with_(base=str(base))


def make_study(data: Mapping[str, Any], *, label: str = "study") -> Study:
    """Validate a study given as plain data.

    Parameters
    ----------
    data
        The study as a file would hold it.
    label
        Name in messages.

    Raises
    ------
    InputError
        When anything is wrong; every fault is named with its place.

    Examples
    --------
    >>> data = {"schema": 1, "name": "x", "base": "ac-simple"}
    >>> make_study({**data, "axes": {"settings.seed": {"seeds": 3}}}).design
    'grid'
    """
    try:
        return Study.model_validate(dict(data))
    except ValidationError as error:
        faults = [text for fault in error.errors(include_url=False) for text in _texts(fault)]
        raise InputError(grouped(f"{label}: {text}" for text in faults)) from None


def _texts(fault: ErrorDetails) -> list[str]:
    path = [str(step) for step in fault["loc"] if step not in AXIS_FORMS]
    cause = fault.get("ctx", {}).get("error")
    if isinstance(cause, ContradictionError):
        return [
            f"{'.'.join([*path, *map(str, problem.path)]) or 'the study'}: {problem.text}"
            for problem in cause.problems
        ]
    return [f"{'.'.join(path) or 'the study'}: {_text(fault)}"]


def _text(fault: ErrorDetails) -> str:
    kind, limits = fault["type"], fault.get("ctx", {})
    got = f"got {shown(fault['input'])}"
    if kind == "missing":
        return f"is missing: {_description(fault)}"
    if kind == "extra_forbidden":
        fields = _fields(fault)
        name = str(fault["loc"][-1])
        return f"unknown key{did_you_mean(name, fields) or '; known are: ' + ', '.join(fields)}"
    if kind.startswith("union_tag"):
        return f"{got}; the values of an axis are {_AXIS}"
    if kind == "literal_error":
        words = str(limits["expected"])
        return f"{got}; choose {words}{did_you_mean(str(fault['input']), _quoted(words))}"
    return words_of(fault)


def _fields(fault: ErrorDetails) -> Mapping[str, Any]:
    form = next((str(step) for step in fault["loc"] if step in _SPECS), None)
    return fields_by_key(_SPECS[form] if form is not None else Study)


def _description(fault: ErrorDetails) -> str:
    field = _fields(fault).get(str(fault["loc"][-1]))
    return getattr(field, "description", None) or "give a value."


def _quoted(words: str) -> list[str]:
    return re.findall(r"'([^']*)'", words)
