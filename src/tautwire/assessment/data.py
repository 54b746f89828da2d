"""Reading of the data files that hold limits and published results."""

from __future__ import annotations

from collections.abc import Iterable
from importlib.resources import files
from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic_core import ErrorDetails

from tautwire.errors import InputError
from tautwire.faults import is_said_elsewhere, words_of
from tautwire.inputs.reading.documents import parse_document
from tautwire.inputs.reading.files import named, read_case_text
from tautwire.inputs.reading.grouping import grouped
from tautwire.specs.base import FORMS, ContradictionError

Entry = TypeVar("Entry", bound=BaseModel)


class Record(BaseModel):
    """Base of what stands in a data file: immutable, unknown keys refused."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False, validate_by_name=True
    )


def read_library(name: str, model: type[Entry]) -> Entry:
    """Read a data file of the package.

    Parameters
    ----------
    name : str
        File name inside the library.
    model : type
        What the file must hold.
    """
    text = files("tautwire").joinpath("catalogue", name).read_text(encoding="utf-8")
    return _parsed(text, name, ".yaml", model)


def read_file(path: str | Path, model: type[Entry]) -> Entry:
    """Read a data file of the user.

    Raises
    ------
    InputError
        When the file cannot be read or does not hold what it should; every fault is named.
    """
    source = Path(path)
    return _parsed(read_case_text(source), named(source), source.suffix, model)


def read_text(text: str, label: str, model: type[Entry]) -> Entry:
    """Read a text that a case keeps as a file of data.

    Raises
    ------
    InputError
        When it does not hold what it should; every fault is named.
    """
    return _parsed(text, label, ".yaml", model)


def _parsed(text: str, label: str, suffix: str, model: type[Entry]) -> Entry:
    content = parse_document(text, label, suffix)
    try:
        return model.model_validate(content)
    except ValidationError as error:
        faults = [text for fault in error.errors() for text in _sentences(label, fault)]
        raise InputError(grouped(faults)) from None


def _sentences(name: str, fault: ErrorDetails) -> list[str]:
    cause = fault.get("ctx", {}).get("error")
    if isinstance(cause, ContradictionError):
        return [f"{name}: {_place((*fault['loc'], *p.path))}: {p.text}" for p in cause.problems]
    if is_said_elsewhere(fault):
        return []
    return [f"{name}: {_place(fault['loc'])}: {words_of(fault)}"]


def _place(steps: Iterable[str | int]) -> str:
    """Return the path of a value as it is counted in the file."""
    path = ""
    for step in steps:
        if step not in FORMS:
            path += f"[{step + 1}]" if isinstance(step, int) else f".{step}"
    return path.lstrip(".") or "the file"
