"""A plan on sheets: strips below each other, a frame, a title block and a legend."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from tautwire.errors import InputError
from tautwire.report.layout_plan.content import Content
from tautwire.report.layout_plan.items import (
    LARGE,
    NORMAL,
    SMALL,
    Drawing,
    Image,
    cut_to,
    text_width,
)
from tautwire.report.layout_plan.scale import PAPERS, SHEETS, STEPS, Paper, Scale
from tautwire.report.layout_plan.strip import SIGN, Piece, Strip, end_sign
from tautwire.report.layout_plan.zones import CLEAR, HEAD, Layout, coarsest

EDGE = 10.0
"""Between the edge of the paper and the frame [mm], as ISO 5457 has it on three sides."""
FOOT = 36.0
"""Height of the title block and the legend beside it [mm]: seven rows of 5 mm."""
TITLE = 180.0
"""Width of the title block [mm], after ISO 7200."""
APART = 6.0
"""Between strips, and between strips and title block [mm]."""
_LINE = 5.0
"""Height of a row of the title block [mm]."""
_COLUMN = 62.0
"""Width of a column of the legend [mm]: three of them stand beside the title block on A3."""
NOTE = (
    "The track is drawn straight: lengths along its axis, heights and lateral positions",
    "square to the plane of the rails; L is left of rising distance.",
)

_SIGNS = {
    "anchored": "anchored end",
    "weighted": "tensioned end",
    "mid-point": "mid-point anchor",
}


@dataclass(frozen=True)
class Title:
    """What the title block says: heading, rows of words and texts, and an image or nothing."""

    heading: str
    rows: tuple[tuple[str, str], ...]
    logo: str


@dataclass(frozen=True)
class Sheets:
    """A plan on paper of one size.

    Attributes
    ----------
    layout : Layout
    paper : Paper
    title : Title
    """

    layout: Layout
    paper: Paper
    title: Title

    @cached_property
    def size(self) -> tuple[float, float]:
        """Width and height of a sheet [mm]."""
        if not self.paper.is_roll:
            return self.paper.width, self.paper.height
        strip = HEAD + self.layout.scale.x(self.layout.content.length) + self.layout.tail
        width = max(strip, SHEETS[0].width - 2.0 * EDGE)
        return width + 2.0 * EDGE, self.layout.height + 2.0 * EDGE + FOOT + APART

    @cached_property
    def pieces(self) -> tuple[Piece, ...]:
        """Parts of the line, one to a strip."""
        if self.paper.is_roll:
            return (Piece(0, len(self.layout.content.supports) - 1),)
        return pieces_of(self.layout.content, room_along(self.layout, self.paper))

    @cached_property
    def drawings(self) -> tuple[Drawing, ...]:
        """The sheets, their origin at the bottom left."""
        each = strips_on(self.layout, self.paper)
        groups = [self.pieces[k : k + each] for k in range(0, len(self.pieces), each)]
        return tuple(
            self._sheet(group, f"{number} of {len(groups)}")
            for number, group in enumerate(groups, start=1)
        )

    def _sheet(self, pieces: Sequence[Piece], number: str) -> Drawing:
        sheet, (width, height) = Drawing(), self.size
        top = height - EDGE
        for piece in pieces:
            top -= self.layout.height
            sheet.put(Strip(self.layout, piece).drawn(), EDGE + HEAD, top)
            top -= APART
        sheet.box("TRACK", (EDGE, EDGE, width - 2.0 * EDGE, height - 2.0 * EDGE))
        supports = self.layout.content.supports
        first, last = supports[pieces[0].first], supports[pieces[-1].last]
        part = f"{first.mark} to {last.mark} ({first.chainage} to {last.chainage})"
        rows = (*self.title.rows, ("Supports", part), ("Sheet", number))
        sheet.put(title_block(self.title, rows), width - EDGE - TITLE, EDGE)
        if self.title.logo:
            box = (width - EDGE - 42.0, EDGE + FOOT - 14.0, 40.0, 12.0)
            sheet.images.append(Image(self.title.logo, box))
        sheet.put(legend(self.layout.content, self.layout.scale), EDGE, EDGE)
        return sheet


def title_block(title: Title, rows: Sequence[tuple[str, str]]) -> Drawing:
    """Return a heading above two columns of words and texts; its bottom left is the origin."""
    block, half = Drawing(), 0.5 * TITLE
    block.box("TRACK", (0.0, 0.0, TITLE, FOOT))
    room = TITLE - (50.0 if title.logo else 2.0 * CLEAR)
    height = LARGE if text_width(title.heading, LARGE) <= room else NORMAL
    heading = cut_to(title.heading, room, height)
    block.text("TEXT", heading, CLEAR, FOOT - 6.0, height=height)
    most = -(-len(rows) // 2)
    line = min(_LINE, (FOOT - 10.0) / most)
    for number, (word, text) in enumerate(rows):
        x = half * (number // most)
        y = FOOT - 12.5 - line * (number % most)
        block.text("TEXT", word, x + CLEAR, y)
        block.text("TEXT", cut_to(text, half - 26.0), x + 24.0, y)
    return block


def legend(content: Content, scale: Scale) -> Drawing:
    """Return what lines and signs mean; its bottom left is the origin."""
    found = Drawing()
    entries = [(role.upper(), text) for role, text in content.legend]
    entries += [("ARMS", "steady arm"), ("AXIS", "track axis, plan"), ("TRACK", "rails, elevation")]
    count = len(entries) + len(_SIGNS)
    for number, (layer, text) in enumerate(entries):
        x, y = _entry(number, count)
        found.stroke(layer, [(x, y + 0.5 * SMALL), (x + 10.0, y + 0.5 * SMALL)])
        found.text("TEXT", cut_to(text, _COLUMN - 14.0), x + 12.0, y)
    for number, (kind, text) in enumerate(
        (
            ("anchored", "anchored end"),
            ("weighted", "tensioned end"),
            ("mid-point", "mid-point anchor"),
        ),
        start=len(entries),
    ):
        x, y = _entry(number, count)
        end_sign(found, (x + 5.0, y + SIGN), kind, 1)
        found.text("TEXT", text, x + 12.0, y)
    for number, text in enumerate((f"Scale: {scale.in_words()}.", *NOTE)):
        found.text("TEXT", text, CLEAR, CLEAR + 3.0 * (len(NOTE) - number))
    return found


def _entry(number: int, count: int) -> tuple[float, float]:
    """Return the place of an entry of the legend, of which three columns hold all [mm]."""
    rows = max(4, -(-count // 3))
    column, row = divmod(number, rows)
    return 2.0 * CLEAR + _COLUMN * column, FOOT - 5.0 - 4.0 * _LINE / rows * row


def pieces_of(content: Content, room: float) -> tuple[Piece, ...]:
    """Return the parts of a line, each from support to support and no longer than a room [m].

    The longest span must be no longer.
    """
    supports, found, first = content.supports, [], 0
    for number in range(1, len(supports)):
        if supports[number].s - supports[first].s > room + 1e-9:
            found.append(Piece(first, number - 1))
            first = number - 1
    return (*found, Piece(first, len(supports) - 1))


def room_along(layout: Layout, paper: Paper) -> float:
    """Return which length of track a strip on a sheet shows [m]."""
    width = paper.width - 2.0 * EDGE - HEAD - layout.tail
    return 1e-3 * width * layout.scale.along


def strips_on(layout: Layout, paper: Paper) -> int:
    """Return how many strips a sheet holds below each other."""
    if paper.is_roll:
        return 1
    room = paper.height - 2.0 * EDGE - FOOT
    return int(room // (layout.height + APART))


def fits(layout: Layout, paper: Paper) -> bool:
    """Tell whether every span fits on a sheet, and a strip below it."""
    longest = layout.content.longest_span
    return paper.is_roll or (strips_on(layout, paper) > 0 and longest <= room_along(layout, paper))


def default_paper(layout: Layout) -> Paper:
    """Return the smallest sheet that a plan fits on, or the roll."""
    return next(paper for paper in PAPERS.values() if fits(layout, paper))


def check_paper(layout: Layout, paper: Paper) -> None:
    """Refuse a sheet that is too small.

    Raises
    ------
    InputError
        With what is too large, and a sheet or a scale that works.
    """
    if fits(layout, paper):
        return
    content, scale = layout.content, layout.scale
    if strips_on(layout, paper):
        what = f"a strip shows {room_along(layout, paper):.1f} m, and the longest span has "
        what += f"{content.longest_span:g} m"
    else:
        what = f"a strip is {layout.height:.0f} mm high, and the sheet has room for "
        what += f"{paper.height - 2.0 * EDGE - FOOT - APART:.0f} mm"
    smaller = (Scale(along, max(along // 10, scale.across)) for along in reversed(STEPS))
    most = coarsest(content)
    tried = [one for one in smaller if scale.along <= one.along <= most and one != scale]
    other = next((one for one in tried if fits(Layout(content, one), paper)), None)
    cure = f"choose paper {default_paper(layout).name}"
    cure += f", or the scale {other}" if other is not None else ""
    raise InputError(f"paper {paper.name} at the scale {scale}: {what}; {cure}")
