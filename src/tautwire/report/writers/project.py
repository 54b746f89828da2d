"""The project block as a page shows it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from tautwire.specs.case import Case
from tautwire.specs.project import Project


@dataclass(frozen=True)
class ProjectBlock:
    """Rows of words and texts, and an image as text for a page; either may be empty."""

    rows: tuple[tuple[str, str], ...]
    logo: str


def project_block(project: Project) -> ProjectBlock | None:
    """Return the block at the head of a page; None where nothing was given."""
    if project.is_empty():
        return None
    return ProjectBlock(tuple(project.rows().items()), project.logo)


def common_project(cases: Sequence[Case]) -> Project:
    """Return the project that all cases belong to; an empty one where they differ."""
    first = cases[0].project
    return first if all(case.project == first for case in cases) else Project()
