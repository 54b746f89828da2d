"""A drawing as PDF: its pictures on pages of their size, set by Typst."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

from tautwire.errors import InputError
from tautwire.report.layout_plan.items import Drawing
from tautwire.report.layout_plan.svg import svg_of
from tautwire.report.writers.pdf import require_pdf

LONGEST = 5080.0
"""Longest side of a page [mm]: 14 400 units of 1/72 inch, PDF 1.7 (ISO 32000-1), annex C."""


def pdf_of_drawings(drawings: Sequence[Drawing], size: tuple[float, float], title: str) -> bytes:
    """Return drawings of one size as PDF, one to a page.

    Parameters
    ----------
    drawings
    size
        Width and height of each [mm].
    title

    Raises
    ------
    InputError
        When a page would be too long, or what makes a PDF is not installed.
    """
    require_pdf()
    import matplotlib as mpl
    import typst

    if max(size) > LONGEST:
        raise InputError(
            f"the plan is {1e-3 * max(size):.2f} m long and a page of a PDF at most "
            f"{1e-3 * LONGEST:g} m; choose paper A3, A2, A1 or A0, or write it as SVG"
        )
    fonts = Path(mpl.get_data_path()) / "fonts" / "ttf"
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for number, drawing in enumerate(drawings):
            text = svg_of([drawing], size, title)
            (folder / f"{number}.svg").write_text(text, encoding="utf-8")
        width, height = (f"{side:.2f}mm" for side in size)
        source = (
            f"#set page(width: {width}, height: {height}, margin: 0mm)\n"
            f"#set document(title: sys.inputs.title)\n"
            f"#for number in range({len(drawings)}) "
            f'{{ image(str(number) + ".svg", width: {width}, alt: sys.inputs.title) }}\n'
        )
        (folder / "plan.typ").write_text(source, encoding="utf-8")
        try:
            return typst.compile(
                folder / "plan.typ",
                root=folder,
                font_paths=[fonts],
                format="pdf",
                sys_inputs={"title": title},
            )
        except typst.TypstError as error:
            raise InputError(f"the PDF cannot be set: {error.message}") from error
