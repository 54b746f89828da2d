"""A console that obeys nobody but the program: control characters in texts are shown as numbers."""

from __future__ import annotations

from collections.abc import Iterable

from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment

from tautwire.text import printable


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
