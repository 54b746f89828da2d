"""The layout plan of a line, and the files that it becomes."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from tautwire.errors import InputError
from tautwire.files import write_bytes
from tautwire.report.layout_plan.content import Content, content_of
from tautwire.report.layout_plan.dxf import dxf_of, require_dxf
from tautwire.report.layout_plan.items import Drawing
from tautwire.report.layout_plan.pdf import pdf_of_drawings
from tautwire.report.layout_plan.scale import (
    STEPS,
    Paper,
    Scale,
    default_scale,
    paper_of,
    scale_of,
)
from tautwire.report.layout_plan.sheets import (
    APART,
    FOOT,
    TITLE,
    Sheets,
    Title,
    check_paper,
    default_paper,
    legend,
    title_block,
)
from tautwire.report.layout_plan.strip import Piece, Strip
from tautwire.report.layout_plan.svg import svg_of
from tautwire.report.layout_plan.zones import HEAD, Layout, coarsest
from tautwire.report.writers.pdf import require_pdf
from tautwire.results.equilibrium import Equilibrium
from tautwire.specs.case import Case
from tautwire.text import DESIGN
from tautwire.version import __version__


@dataclass(frozen=True)
class LayoutPlan:
    """Plan and elevation of a line true to scale, by :func:`tautwire.layout_plan`.

    Attributes
    ----------
    sheets : Sheets
        Scale, paper and content.
    """

    sheets: Sheets

    @property
    def scale(self) -> str:
        """Along the track, and of heights and lateral positions, as in ``1:1000/1:100``."""
        return str(self.sheets.layout.scale)

    @property
    def paper(self) -> str:
        """Name of the sheets: A3, A2, A1, A0 or roll."""
        return self.sheets.paper.name

    @property
    def pages(self) -> int:
        """How many sheets SVG and PDF have."""
        return len(self.sheets.drawings)

    @property
    def left_out(self) -> int:
        """How many pieces of the track are too short on the paper for any text about them."""
        return self._strip[1]

    @cached_property
    def _strip(self) -> tuple[Drawing, int]:
        layout = self.sheets.layout
        strip = Strip(layout, Piece(0, len(layout.content.supports) - 1))
        return strip.drawn(), strip.left_out

    def write(self, path: str | os.PathLike[str]) -> Path:
        """Write the plan, completely or not at all.

        Parameters
        ----------
        path
            SVG and PDF have sheets, in SVG below each other; DXF has the line in one strip, in
            metres along the track from support 1, the rails of the elevation at y = 0.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        InputError
            When the name ends in none of ``.svg``, ``.pdf`` and ``.dxf``, what writes the kind is
            not installed, or the file cannot be written.
        """
        return write_bytes(path, _KINDS[kind_of(path)](self))

    def _svg(self) -> bytes:
        return svg_of(self.sheets.drawings, self.sheets.size, self.sheets.title.heading).encode()

    def _pdf(self) -> bytes:
        sheets = self.sheets
        return pdf_of_drawings(sheets.drawings, sheets.size, sheets.title.heading)

    def _dxf(self) -> bytes:
        layout, title = self.sheets.layout, self.sheets.title
        whole = Drawing()
        rails = layout.rails
        whole.put(self._strip[0], 0.0, -rails)
        below = -rails - APART - FOOT
        whole.put(title_block(title, title.rows), -HEAD, below)
        whole.put(legend(layout.content, layout.scale), TITLE - HEAD + APART, below)
        return dxf_of(whole, layout.scale.along).encode()


_KINDS: dict[str, Callable[[LayoutPlan], bytes]] = {
    ".svg": LayoutPlan._svg,
    ".pdf": LayoutPlan._pdf,
    ".dxf": LayoutPlan._dxf,
}
_REQUIRED: dict[str, Callable[[], None]] = {".pdf": require_pdf, ".dxf": require_dxf}


def kind_of(path: str | os.PathLike[str]) -> str:
    """Return the ending of a file that a plan can be written to.

    Raises
    ------
    InputError
        When it is none of them.
    """
    kind = Path(path).suffix.lower()
    if kind not in _KINDS:
        raise InputError(
            f"{os.fspath(path)}: a plan is written as {', '.join(_KINDS)}; choose a name that ends "
            "in one of them"
        )
    return kind


def problems_before(
    paths: Sequence[str | os.PathLike[str]], scale: str | None, paper: str | None
) -> list[str]:
    """Return what is wrong with files, scale and paper before a line is computed for them."""
    checks: list[Callable[[], object]] = [lambda path=path: _ready(path) for path in paths]
    checks += [] if scale is None else [lambda: scale_of(scale)]
    checks += [] if paper is None else [lambda: paper_of(paper)]
    problems: list[str] = []
    for check in checks:
        try:
            check()
        except InputError as error:
            problems += [text for text in error.problems if text not in problems]
    return problems


def _ready(path: str | os.PathLike[str]) -> None:
    if (require := _REQUIRED.get(kind_of(path))) is not None:
        require()


def layout_plan(
    case: Case, shape: Equilibrium, *, scale: str | None = None, paper: str | None = None
) -> LayoutPlan:
    """Draw the layout plan of a line: plan and elevation true to scale, and what stands beside.

    Supports with names and chainage, spans, staggers with side, heights above the rails,
    encumbrance, droppers with place and length, wires by name, tension lengths with their ends,
    mid-point anchors and overlaps, curves, cant and gradients; a title block with the project.

    Parameters
    ----------
    case
        The line.
    shape
        Its static state, by :func:`tautwire.find_shape`.
    scale
        Along the track, and of heights and lateral positions, as in ``1:1000/1:100`` or, with
        heights ten times as large, ``1:500``; by default 1:1000, or the next larger scale at which
        all texts stand clear of each other.
    paper
        ``A3``, ``A2``, ``A1``, ``A0`` or ``roll``; by default the smallest that the plan fits on.

    Raises
    ------
    InputError
        When scale or paper cannot be read, or do not suit the line.

    Examples
    --------
    >>> import tautwire as tw
    >>> case = tw.load_case("ac-simple", {"line.spans": 6})
    >>> plan = tw.layout_plan(case, tw.find_shape(tw.build(case)))
    >>> plan.scale, plan.paper
    ('1:1000/1:100', 'A3')
    >>> plan.write("plan.svg")  # doctest: +SKIP
    """
    if problems := problems_before((), scale, paper):
        raise InputError(problems)
    content = content_of(case, shape)
    chosen = _suiting(content, None if scale is None else scale_of(scale))
    layout = Layout(content, chosen)
    own: Paper = default_paper(layout) if paper is None else paper_of(paper)
    check_paper(layout, own)
    return LayoutPlan(Sheets(layout, own, _title(case, chosen)))


def _suiting(content: Content, scale: Scale | None) -> Scale:
    """Return the scale, or one for the line where none is asked for.

    Raises
    ------
    InputError
        When the texts would run into each other.
    """
    most = coarsest(content)
    if scale is None:
        return default_scale(most)
    if scale.along > most:
        cure = next((step for step in STEPS if step <= most), None)
        other = "" if cure is None else f"; choose 1:{cure} or larger"
        raise InputError(
            f"scale {scale}: the texts of neighbouring supports or droppers would run into each "
            f"other, which need at least 1:{int(most)} along the track{other}"
        )
    return scale


def _title(case: Case, scale: Scale) -> Title:
    chosen = case.chosen_condition
    has_defects = chosen is not None and len(chosen.defects) > 0
    state = f"{case.condition or DESIGN}{'; broken parts drawn too' if has_defects else ''}"
    rows = {
        **case.project.rows(),
        "Case": f"{case.name} ({case.hash()[:12]})",
        "State": state,
        "Scale": str(scale),
        "Program": f"tautwire {__version__}",
    }
    return Title(f"Layout plan: {case.title or case.name}", tuple(rows.items()), case.project.logo)
