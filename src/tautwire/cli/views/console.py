"""A console that obeys nobody but the program: control characters in texts are shown as numbers."""

from __future__ import annotations

from collections.abc import Iterable

from rich.console import Console, ConsoleOptions, RenderableType
from rich.measure import Measurement
from rich.segment import Segment

from tautwire.text import printable

WIDEST = 1000
"""Characters that a line may take at most; more than any table needs."""


class PlainConsole(Console):
    """A console for texts from files: titles, keys, file names.

    A terminal takes escape sequences in a text for orders: to hide lines, to change the window's
    title, to answer as if the user had typed. Only those that the program itself writes reach it.
    """

    def render(
        self, renderable: RenderableType, options: ConsoleOptions | None = None
    ) -> Iterable[Segment]:
        """Render text without control characters in it."""
        for segment in super().render(renderable, options):
            if segment.control:
                yield segment
            else:
                yield Segment(printable(segment.text), segment.style)

    def print_whole(self, part: RenderableType) -> None:
        """Print a part with lines longer than the terminal's rather than with cut numbers."""
        usual = self.width
        free = self.options.update(max_width=WIDEST)
        self.width = max(usual, Measurement.get(self, free, part).minimum)
        try:
            self.print(part)
        finally:
            self.width = usual
