"""A page as PDF, without a browser: the blocks of the page, set by Typst."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from tautwire.errors import InputError, not_installed
from tautwire.report.parts.blocks import Animation, Chart, Details, Link, Pair, Section
from tautwire.report.writers.drawing.figure import figure_svg
from tautwire.specs.project import image_of
from tautwire.text import printable

WIDTH = 174.0
"""Of the text of an A4 page between its margins [mm]; the template has the same."""
GUTTER = 6.0
"""Between two figures side by side [mm]."""
ANNEX = "Tables"


def require_pdf() -> None:
    """Refuse to begin work for a PDF that cannot be made.

    Raises
    ------
    InputError
        When a package is missing.
    """
    for package in ("typst", "matplotlib"):
        if find_spec(package) is None:
            raise not_installed(package, "pdf")


def pdf_of(contents: Sequence[Section], masthead: Mapping[str, Any]) -> bytes:
    """Return a page as PDF.

    Numbers, words and figures are those of the HTML page. Folded tables go to the end; the moving
    picture is left out.

    Parameters
    ----------
    contents : sequence of Section
    masthead : dict
        Heading, description and key facts.

    Raises
    ------
    InputError
        When a package is missing.
    """
    require_pdf()
    import matplotlib as mpl
    import typst

    fonts = Path(mpl.get_data_path()) / "fonts" / "ttf"
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        page = _Page(folder)
        data = {"head": page.head(masthead), "sections": page.sections(contents)}
        (folder / "page.json").write_text(json.dumps(data), encoding="utf-8")
        template = files("tautwire.report").joinpath("templates", "page.typ")
        (folder / "page.typ").write_text(template.read_text(encoding="utf-8"), encoding="utf-8")
        try:
            return typst.compile(folder / "page.typ", root=folder, font_paths=[fonts], format="pdf")
        except typst.TypstError as error:
            raise InputError(f"the PDF cannot be set: {error.message}") from error


class _Page:
    """Puts what the template reads into a folder."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._figures = 0

    def head(self, masthead: Mapping[str, Any]) -> dict[str, Any]:
        """Return the head of the page."""
        block = masthead.get("project")
        return {
            "title": printable(masthead["title"]),
            "description": printable(masthead["description"]),
            "facts": [[name, printable(str(value))] for name, value in masthead["facts"].items()],
            "version": masthead["version"],
            "case_hash": masthead["case_hash"],
            "project": [list(row) for row in block.rows] if block else [],
            "logo": self._logo(block.logo) if block and block.logo else None,
        }

    def _logo(self, uri: str) -> str:
        kind, content = image_of(uri)
        name = f"logo.{'svg' if kind == 'svg+xml' else kind}"
        (self._folder / name).write_bytes(content)
        return name

    def sections(self, contents: Sequence[Section]) -> list[dict[str, Any]]:
        """Return the sections, and one of the tables that were folded."""
        sections, folded = [], []
        for section in contents:
            if section.blocks and all(isinstance(one, Animation) for one in section.blocks):
                continue  # paper does not move
            blocks = []
            for block in section.blocks:
                if isinstance(block, Details):
                    folded.append({"kind": "heading", "text": block.summary})
                    folded += [{"kind": "table", **asdict(table)} for table in block.tables]
                    text = f"{block.summary}: see “{ANNEX}” at the end."
                    blocks.append({"kind": "text", "role": "note", "text": text})
                else:
                    blocks += self._written(block)
            sections.append({"title": section.title, "blocks": blocks})
        if folded:
            sections.append({"title": ANNEX, "blocks": folded})
        return sections

    def _written(self, block: Any) -> list[dict[str, Any]]:
        if isinstance(block, Link):
            return []
        if isinstance(block, Chart):
            return [{"kind": "figures", "figures": [self._chart(block, WIDTH)]}]
        if isinstance(block, Pair):
            width = 0.5 * (WIDTH - GUTTER)
            charts = [self._chart(chart, width) for chart in (block.left, block.right)]
            return [{"kind": "figures", "figures": charts}]
        return [{"kind": block.kind, **asdict(block)}]

    def _chart(self, chart: Chart, width: float) -> dict[str, Any]:
        self._figures += 1
        name = f"figure-{self._figures}.svg"
        (self._folder / name).write_bytes(figure_svg(chart.json, width))
        return {"file": name, "caption": chart.caption, "summary": chart.summary}
