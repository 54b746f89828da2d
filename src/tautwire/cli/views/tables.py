"""Tables and texts for the terminal, readable at 80 columns."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import islice
from typing import Any, TypeVar

from rich import box
from rich.cells import cell_len
from rich.console import Console, ConsoleOptions
from rich.measure import Measurement
from rich.table import Table
from rich.text import Text

T = TypeVar("T")

STYLES = {
    "inside": "green",
    "within": "green",
    "met": "green",
    "done": "green",
    "not checked": "yellow",
    "partial": "yellow",
    "outside": "red",
    "not within": "bold red",
    "missed": "bold red",
    "failed": "bold red",
}


def heading(text: str, detail: str = "") -> Text:
    """Return a heading with an empty line above it."""
    parts: list[Any] = ["\n", (text, "bold")]
    if detail:
        parts.append((f"  {detail}", "dim"))
    return Text.assemble(*parts)


NARROWEST = 12
"""Characters that a column keeps when it gives way; about a word of a name or of a sentence."""


def table(heads: Sequence[str], align: str, rows: Iterable[Sequence[str]]) -> Table:
    """Return a table.

    Parameters
    ----------
    heads : sequence of str
    align : str
        One letter per column: ``l``, ``r``, or ``L`` for a column that gives way when the
        terminal is narrow.
    rows : iterable of sequence of str
        A word with a meaning of its own (``inside``, ``within`` ...) is coloured.
    """
    result = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, show_header=any(heads))
    cells = [tuple(row) for row in rows]
    for number, (head, letter) in enumerate(zip(heads, align, strict=True)):
        lines = [*head.splitlines(), *(row[number] for row in cells)]
        result.add_column(
            head,
            justify="right" if letter == "r" else "left",
            no_wrap=letter in "lr",
            overflow="fold",
            min_width=NARROWEST if letter == "L" else max(map(cell_len, lines), default=0),
            header_style="dim",
        )
    for row in cells:
        kinds = (_Folded if letter == "L" else Text for letter in align)
        result.add_row(
            *(kind(cell, style=STYLES.get(cell, "")) for kind, cell in zip(kinds, row, strict=True))
        )
    return result


class _Folded(Text):
    """A text whose words may be broken, so that the longest of them does not ask for its width."""

    def __rich_measure__(self, console: Console, options: ConsoleOptions) -> Measurement:
        """Return the width of a few letters and that of the longest line."""
        words = super().__rich_measure__(console, options)
        return Measurement(min(words.minimum, NARROWEST), words.maximum)


def batched(items: Iterable[T], size: int) -> Iterator[tuple[T, ...]]:
    """Yield items in groups of at most ``size``."""
    rest = iter(items)
    while group := tuple(islice(rest, size)):
        yield group


def facts(pairs: Iterable[tuple[str, str]]) -> Table:
    """Return names and values side by side."""
    result = Table.grid(padding=(0, 2))
    result.add_column(style="dim", no_wrap=True)
    result.add_column(overflow="fold")
    for name, value in pairs:
        result.add_row(name, Text(value, style=STYLES.get(value, "")))
    return result


def files_written(written: dict[str, str]) -> Table:
    """Return the names of the files that were written, with what each is for."""
    return facts((_PURPOSE.get(name, name), path) for name, path in written.items())


_PURPOSE = {
    "report.html": "report",
    "report.pdf": "report to print",
    "run.nc": "histories",
    "static.nc": "static state",
    "results.json": "results",
    "static.json": "results",
    "static.html": "page of the static line",
    "static.pdf": "the page to print",
    "droppers.csv": "dropper table",
    "line.xlsx": "the case as a workbook",
    "workshop.xlsx": "workshop sheet",
    "elasticity.csv": "elasticity",
    "supports.csv": "forces on supports",
    "tensions.csv": "tension along the line",
    "installation.csv": "installation table",
    "design.csv": "checks of the design",
    "lateral.csv": "lateral position",
    "conditions.csv": "conditions",
    "conditions.html": "page of the conditions",
    "force.csv": "force history",
    "record.html": "validation record",
    "record.json": "record as data",
    "record.csv": "record as a table",
}
