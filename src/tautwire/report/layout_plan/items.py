"""What a drawing is made of: strokes and labels on layers, in millimetres on the paper."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tautwire.text import printable

Array = NDArray[np.float64]
Anchor = Literal["start", "middle", "end"]
Box = tuple[float, float, float, float]

SMALL, NORMAL, LARGE = 1.8, 2.5, 3.5
"""Heights of capitals [mm]: nominal sizes of ISO 3098-1, the smallest for the many values."""

LETTER = 0.87
"""Width of a letter per height of capitals: that of a digit in DejaVu Sans, wide among the fonts
that stand in for "sans-serif", so that what is found to fit does so in all of them."""


@dataclass(frozen=True)
class Layer:
    """Strokes and labels that a drawing program shows or hides together.

    Attributes
    ----------
    name : str
    colour : str
        On paper, as ``#rrggbb``.
    index : int
        Number of the AutoCAD colour, seen on dark and light screens; 7 is black or white.
    width : float mm
        Of its strokes.
    dashes : tuple of float mm
        Stroke and gap in turn; empty where it is drawn through.
    """

    name: str
    colour: str
    index: int
    width: float
    dashes: tuple[float, ...] = ()


LAYERS: dict[str, Layer] = {
    layer.name: layer
    for layer in (
        Layer("FRAME", "#16202b", 7, 0.25),
        Layer("SUPPORTS", "#8d98a3", 8, 0.18),
        Layer("AXIS", "#16202b", 7, 0.25, (8.0, 1.5, 1.0, 1.5)),
        Layer("TRACK", "#16202b", 7, 0.35),
        Layer("ALIGNMENT", "#16202b", 7, 0.25),
        Layer("TENSION_LENGTHS", "#16202b", 7, 0.35),
        Layer("DROPPERS", "#55616e", 8, 0.18),
        Layer("ARMS", "#16202b", 7, 0.35),
        Layer("STITCH", "#8a3f73", 6, 0.35),
        Layer("AUXILIARY", "#00795a", 92, 0.35),
        Layer("MESSENGER", "#0b3d63", 150, 0.35),
        Layer("CONTACT", "#b02a1a", 1, 0.5),
        Layer("TEXT", "#16202b", 7, 0.18),
    )
}
"""By name, each drawn over those before. Widths of lines are those of ISO 128-2 [mm]: wires and
marks stand out from what only leads the eye."""


@dataclass(frozen=True, eq=False)
class Stroke:
    """A line of straight pieces through points ``(n, 2)`` [mm], y upwards."""

    layer: str
    points: Array


@dataclass(frozen=True)
class Label:
    """A text.

    Attributes
    ----------
    layer, text : str
    x, y : float mm
        Foot of the first, middle or last letter.
    height : float mm
        Of a capital.
    anchor : str
        Which letter stands at the place.
    is_upright : bool
        Read from the right: turned by 90 degrees.
    """

    layer: str
    text: str
    x: float
    y: float
    height: float = SMALL
    anchor: Anchor = "start"
    is_upright: bool = False


@dataclass(frozen=True)
class Image:
    """A picture: a data URI and its box, left, bottom, width and height [mm]."""

    uri: str
    box: Box


@dataclass
class Drawing:
    """Strokes, labels and images, to which more are added.

    Attributes
    ----------
    strokes : list of Stroke
    labels : list of Label
    images : list of Image
    """

    strokes: list[Stroke] = field(default_factory=list)
    labels: list[Label] = field(default_factory=list)
    images: list[Image] = field(default_factory=list)

    def stroke(self, layer: str, points: ArrayLike) -> None:
        """Add a line through points, ``(n, 2)`` [mm]."""
        self.strokes.append(Stroke(layer, np.asarray(points, dtype=float)))

    def text(
        self, layer: str, text: str, x: float, y: float, *, height: float = SMALL,
        anchor: Anchor = "start", is_upright: bool = False,
    ) -> None:  # fmt: skip
        """Add a text that is not empty, on one line; see :class:`Label`."""
        if line := " ".join(printable(text).split()):
            self.labels.append(Label(layer, line, x, y, height, anchor, is_upright))

    def box(self, layer: str, box: Box) -> None:
        """Add a rectangle: left, bottom, width, height [mm]."""
        x, y, width, height = box
        ends = (x, y), (x + width, y), (x + width, y + height), (x, y + height), (x, y)
        self.stroke(layer, ends)

    def ring(self, layer: str, centre: tuple[float, float], radius: float) -> None:
        """Add a small circle, of eight straight pieces."""
        turn = np.linspace(0.0, 2.0 * np.pi, 9)
        self.stroke(layer, np.array(centre) + radius * np.stack([np.cos(turn), np.sin(turn)], 1))

    def put(self, other: Drawing, x: float, y: float) -> None:
        """Add all of another drawing, moved by x and y [mm]."""
        by = np.array([x, y])
        self.strokes += [Stroke(one.layer, one.points + by) for one in other.strokes]
        self.labels += [
            Label(t.layer, t.text, t.x + x, t.y + y, t.height, t.anchor, t.is_upright)
            for t in other.labels
        ]


def text_width(text: str, height: float = SMALL) -> float:
    """Return how wide a text is at most, for a height of its capitals [mm].

    Letters of East Asian scripts count twice.
    """
    wide = sum(ord(letter) > 0x1100 for letter in text)  # where they begin: Hangul Jamo
    return LETTER * height * (len(text) + wide)


def cut_to(text: str, width: float, height: float = SMALL) -> str:
    """Return a text that is no wider than a width [mm]; where letters go, three dots stand."""
    if text_width(text, height) <= width:
        return text
    while text and text_width(f"{text}…", height) > width:
        text = text[:-1]
    return f"{text.rstrip()}…"


def spread(wanted: Sequence[float], pitch: float, low: float, high: float) -> Array:
    """Return places as near to the wanted ones as a pitch allows, within limits [mm].

    The least sum of squared moves: neighbours that are too close become one block, which stands at
    the mean of what its members want (pooled adjacent violators).

    Parameters
    ----------
    wanted
        Rising.
    pitch
        Least distance of neighbours; the limits have room for all.
    low, high
        Of the first and the last place.
    """
    blocks: list[tuple[float, int]] = []
    for number, place in enumerate(wanted):
        mean, count = place - number * pitch, 1
        while blocks and blocks[-1][0] > mean:
            before, size = blocks.pop()
            mean, count = (before * size + mean * count) / (size + count), size + count
        blocks.append((mean, count))
    steps = np.repeat([mean for mean, _ in blocks], [count for _, count in blocks])
    room = max(low, high - pitch * (len(wanted) - 1))
    return np.asarray(np.clip(steps, low, room) + pitch * np.arange(len(wanted)), dtype=float)
