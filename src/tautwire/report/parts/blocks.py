"""What a page is made of; the template turns each block into HTML."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar


@dataclass(frozen=True)
class Text:
    """A paragraph; ``role`` is ``plain``, ``statement`` or ``note``."""

    text: str
    role: str = "plain"
    kind: ClassVar[str] = "text"


@dataclass(frozen=True)
class Link:
    """A line that leads to another section of the page; paper leaves it out."""

    text: str
    section: str
    kind: ClassVar[str] = "link"


@dataclass(frozen=True)
class Heading:
    """A heading inside a section."""

    text: str
    kind: ClassVar[str] = "heading"


@dataclass(frozen=True)
class Callout:
    """Something the reader must not overlook."""

    lines: tuple[str, ...]
    kind: ClassVar[str] = "callout"


@dataclass(frozen=True)
class Key:
    """A number with its unit and its meaning."""

    value: str
    unit: str
    label: str


@dataclass(frozen=True)
class Keys:
    """The key numbers, side by side."""

    items: tuple[Key, ...]
    kind: ClassVar[str] = "keys"


@dataclass(frozen=True)
class Verdict:
    """A table cell with the outcome of a check: ``passed``, ``failed`` or ``unverified``."""

    text: str
    outcome: str


Cell = str | Verdict


@dataclass(frozen=True)
class Table:
    """A table.

    Attributes
    ----------
    caption : str
    head : tuple of str
    align : str
        One letter per column, ``l`` or ``r``.
    rows : tuple of tuple of Cell
    groups : tuple of (str, int)
        Upper heading: texts and the number of columns each spans; empty for none.
    """

    caption: str
    head: tuple[str, ...]
    align: str
    rows: tuple[tuple[Cell, ...], ...]
    groups: tuple[tuple[str, int], ...] = ()
    kind: ClassVar[str] = "table"


@dataclass(frozen=True)
class Columns:
    """Tables side by side on a wide screen."""

    tables: tuple[Table, ...]
    kind: ClassVar[str] = "columns"


@dataclass(frozen=True)
class Button:
    """A button under which a figure shows a part of its horizontal axis."""

    label: str
    low: float
    high: float


@dataclass(frozen=True)
class Chart:
    """An interactive figure.

    Attributes
    ----------
    name : str
        Identifier on the page.
    json : str
        Data and layout, safe inside a script element.
    caption : str
        Names the filter with its numbers where a force is filtered.
    summary : str
        What the figure shows, for those who cannot see it.
    height : int
        Pixels.
    buttons : tuple of Button
    """

    name: str
    json: str
    caption: str
    summary: str
    height: int
    buttons: tuple[Button, ...] = ()
    kind: ClassVar[str] = "chart"


@dataclass(frozen=True)
class Pair:
    """Two figures side by side on a wide screen."""

    left: Chart
    right: Chart
    kind: ClassVar[str] = "pair"


@dataclass(frozen=True)
class Details:
    """Tables that are folded away at first."""

    summary: str
    tables: tuple[Table, ...]
    kind: ClassVar[str] = "details"


@dataclass(frozen=True)
class Animation:
    """The moving picture and its data, safe inside a script element."""

    json: str
    films: tuple[str, ...]
    caption: str
    summary: str
    exaggeration: int
    length: int
    kind: ClassVar[str] = "animation"


@dataclass(frozen=True)
class Section:
    """A numbered section of the page."""

    name: str
    title: str
    blocks: tuple[Any, ...] = field(default=())
