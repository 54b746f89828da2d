"""Scales and sheets: what was asked for, and what a line needs."""

from __future__ import annotations

import re
from dataclasses import dataclass

from tautwire.errors import InputError
from tautwire.text import shown

STEPS = (1000, 500, 250, 200, 100, 50, 20, 10, 5, 2, 1)
"""Scales that are tried in turn along the track: layout plans are drawn at 1:1000 or 1:500, and
the larger ones (ISO 5455 and 1:250) where spans are so short that texts need them."""
SMALLEST, LARGEST = 100_000, 1
"""Scale numbers that are read at all: from a map to the real size."""
_RATIO = 10
"""Heights and lateral positions are drawn ten times as large as lengths: 1:1000/1:100."""
_WRITTEN = re.compile(r"\s*1\s*:\s*(\d{1,9})\s*(?:/\s*1\s*:\s*(\d{1,9})\s*)?\Z")


@dataclass(frozen=True)
class Scale:
    """Scale numbers: along the track, and for heights and lateral positions."""

    along: int
    across: int

    def __str__(self) -> str:
        return f"1:{self.along}/1:{self.across}"

    def x(self, metres: float) -> float:
        """Return a length along the track on the paper [mm]."""
        return 1e3 * metres / self.along

    def y(self, metres: float) -> float:
        """Return a height or a lateral position on the paper [mm]."""
        return 1e3 * metres / self.across

    def in_words(self) -> str:
        """Say both."""
        return f"lengths 1:{self.along}, heights and lateral positions 1:{self.across}"


def scale_of(text: str) -> Scale:
    """Read a scale such as ``1:1000/1:100`` or ``1:500``, which makes heights 1:50.

    Raises
    ------
    InputError
        When it is none, or none that paper can show.
    """
    match = _WRITTEN.match(text)
    if match is None:
        raise InputError(
            f"scale {shown(text)}: write lengths and heights as in 1:1000/1:100, or lengths alone "
            "as in 1:500"
        )
    along = int(match[1])
    across = int(match[2]) if match[2] else max(along // _RATIO, 1)
    for number in (along, across):
        if not LARGEST <= number <= SMALLEST:
            raise InputError(
                f"scale {shown(text)}: 1:{number} is no scale of a layout plan; choose one between "
                f"1:{LARGEST} and 1:{SMALLEST}, as in 1:1000/1:100"
            )
    return Scale(along, across)


def default_scale(coarsest: float) -> Scale:
    """Return the scale of a plan that nobody chose one for.

    Parameters
    ----------
    coarsest
        Largest scale number along the track at which the texts stand clear of each other.
    """
    along = next((step for step in STEPS if step <= coarsest), STEPS[-1])
    return Scale(along, max(along // _RATIO, 1))


@dataclass(frozen=True)
class Paper:
    """A sheet: its name, width and height [mm]; a roll is as long and as high as it must be."""

    name: str
    width: float
    height: float

    @property
    def is_roll(self) -> bool:
        """Whether it has no size of its own."""
        return not self.width


SHEETS = (
    Paper("A3", 420.0, 297.0),
    Paper("A2", 594.0, 420.0),
    Paper("A1", 841.0, 594.0),
    Paper("A0", 1189.0, 841.0),
)
"""Sizes of ISO 216, lying."""
ROLL = Paper("roll", 0.0, 0.0)
PAPERS = {paper.name: paper for paper in (*SHEETS, ROLL)}


def paper_of(text: str) -> Paper:
    """Return the sheet with a name.

    Raises
    ------
    InputError
        When there is none.
    """
    found = {name.lower(): paper for name, paper in PAPERS.items()}.get(text.strip().lower())
    if found is None:
        raise InputError(f"paper {shown(text)}: choose one of {', '.join(PAPERS)}")
    return found
