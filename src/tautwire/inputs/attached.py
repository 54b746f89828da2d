"""What a case keeps of other files and no number depends on: project block, image, limits."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from tautwire.errors import InputError
from tautwire.faults import words_of
from tautwire.inputs.reading.documents import parse_document
from tautwire.inputs.reading.files import did_you_mean, named, read_case_text, read_image
from tautwire.inputs.reading.reach import Reach
from tautwire.specs.case import Case
from tautwire.specs.project import MOST_LOGO_BYTES, Project, data_uri

LOGO = "logo"
KEPT = "data:"
"""Begins an image that is kept as text."""
LIMITS = "limits"
YAML = ".yaml"


def load_project(path: Path) -> Project:
    """Read a project block from a YAML, TOML or JSON file of its keys.

    Raises
    ------
    InputError
        With every fault of the file, and of the image that it names.
    """
    label = named(path)
    data = parse_document(read_case_text(path), label, path.suffix)
    own = data.get("project")
    if isinstance(own, Mapping) and len(data) == 1:
        data = dict(own)  # as it stands in a case
    data, problems = with_image(data, path.parent, Reach.of(path.parent), label)
    if problems:
        raise InputError(problems)
    try:
        return Project.model_validate(data)
    except ValidationError as error:
        raise InputError([f"{label}: {_sentence(fault)}" for fault in error.errors()]) from None


def with_project(case: Case, path: Path | None) -> Case:
    """Return a case with the project block of a file; as it is where there is no file."""
    return case if path is None else case.with_(project=load_project(path))


def with_image(
    project: Mapping[str, Any], folder: Path, reach: Reach, label: str
) -> tuple[dict[str, Any], list[str]]:
    """Put the image in the place of its path; return the block, and what is wrong with the image.

    Parameters
    ----------
    project
        As it was written.
    folder
        Where relative paths start.
    reach
        What may be read.
    label
        Name of the document, in messages.
    """
    logo = project.get(LOGO)
    if not isinstance(logo, str) or not logo or logo.startswith(KEPT):
        return dict(project), []
    path = folder / logo
    try:
        reach.check(path, label)
        return {**project, LOGO: data_uri(read_image(path, MOST_LOGO_BYTES))}, []
    except InputError as error:
        problems = [f"{label}: project.{LOGO}: {text}" for text in error.problems]
    except ValueError as error:
        problems = [f"{label}: project.{LOGO}: {named(path)}: {error}"]
    return {key: value for key, value in project.items() if key != LOGO}, problems


def with_limits(
    case: Mapping[str, Any], folder: Path, reach: Reach, label: str
) -> tuple[dict[str, Any], list[str]]:
    """Put the text of a file of limits in the place of its path; return what is wrong with it.

    Parameters
    ----------
    case
        The case as it was written, or a part of it.
    folder
        Where relative paths start.
    reach
        What may be read.
    label
        Name of the document, in messages.
    """
    limits = case.get(LIMITS)
    if not isinstance(limits, str) or not limits or "\n" in limits:  # the text itself
        return dict(case), []
    path = folder / limits
    try:
        reach.check(path, label)
        text = read_case_text(path)
        parse_document(text, named(path), YAML)
    except InputError as error:
        problems = [f"{label}: {LIMITS}: {text}" for text in error.problems]
        return {key: value for key, value in case.items() if key != LIMITS}, problems
    return {**case, LIMITS: f"{text.rstrip()}\n"}, []


def _sentence(fault: Any) -> str:
    *_, key = fault["loc"] or ("the file",)
    if fault["type"] != "extra_forbidden":
        return f"{key}: {words_of(fault)}"
    keys = ", ".join(Project.model_fields)
    return f"{key}: unknown key{did_you_mean(str(key), Project.model_fields)}; there are: {keys}"
