"""A progress bar for passages that are computed from Python."""

from __future__ import annotations

from types import TracebackType
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from rich.progress import TaskID

    from tautwire.analyses.road.dynamics import Progress


class ProgressBar:
    """Shows each passage of a run as a bar, on a terminal and in a notebook.

    As a context it removes its bars when the run has ended.
    """

    def __init__(self) -> None:
        from rich.progress import Progress as Bars

        self._bars = Bars(transient=True)
        self._tasks: dict[int, TaskID] = {}

    def __enter__(self) -> Self:
        self._bars.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._bars.stop()

    def __call__(self, passage: int, progress: Progress) -> bool:
        """Show a passage (from 1) and how much of it is done; never asks to stop."""
        if passage not in self._tasks:
            self._tasks[passage] = self._bars.add_task(f"passage {passage}", total=1.0)
        self._bars.update(self._tasks[passage], completed=progress.share)
        return False
