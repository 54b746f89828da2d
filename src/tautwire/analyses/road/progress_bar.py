"""A progress bar for passages that are computed from Python."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.progress import TaskID

    from tautwire.analyses.road.dynamics import Progress


@contextmanager
def progress_bar() -> Iterator[Callable[[int | str, Progress], bool]]:
    """Show each passage of a run as a bar, on a terminal and in a notebook, while it is computed.

    Yields
    ------
    callable
        To be told the number of the passage (from 1), or its name, and its progress; never asks to
        stop.
    """
    from rich.progress import Progress as Bars

    tasks: dict[int | str, TaskID] = {}
    with Bars(transient=True) as bars:

        def show(passage: int | str, progress: Progress) -> bool:
            if passage not in tasks:
                name = passage if isinstance(passage, str) else f"passage {passage}"
                tasks[passage] = bars.add_task(name, total=1.0)
            bars.update(tasks[passage], completed=progress.share)
            return False

        yield show
