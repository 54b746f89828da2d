"""A page before it is written: one content, two ways to write it."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tautwire.files import write_bytes, write_text
from tautwire.report.parts.blocks import Section
from tautwire.report.writers.html import render

PDF = ".pdf"


@dataclass(frozen=True)
class Page:
    """Sections, and heading, description and key facts at the head."""

    contents: Sequence[Section]
    masthead: Mapping[str, Any]

    def write(self, path: str | os.PathLike[str]) -> Path:
        """Write the page, completely or not at all: PDF where the name ends in .pdf, else HTML.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        InputError
            When the file cannot be written, or what makes a PDF is not installed.
        """
        if Path(path).suffix.lower() == PDF:
            from tautwire.report.writers.pdf import pdf_of

            return write_bytes(path, pdf_of(self.contents, self.masthead))
        return write_text(path, render(self.contents, dict(self.masthead)))
