"""Progress of a run on standard error: a bar on a terminal, a few lines elsewhere."""

from __future__ import annotations

import time
from types import TracebackType
from typing import TYPE_CHECKING, Self

from tautwire.cli.interrupts import Interrupts
from tautwire.cli.session import Answer

if TYPE_CHECKING:
    from rich.progress import Progress as Bar
    from rich.progress import TaskID

    from tautwire.analyses.road.dynamics import Progress

SECONDS_BETWEEN_LINES = 20.0
"""Where no bar can be drawn: long enough for a log file, short enough to see that it lives."""


class PassageWatch:
    """Shows how far a passage is, and tells it to stop when a signal has asked for it.

    Parameters
    ----------
    answer
        The command, for its standard error.
    interrupts
        Signals received.
    is_tuned
        Whether the passage may be repeated to tune the mean force.
    """

    def __init__(self, answer: Answer, interrupts: Interrupts, *, is_tuned: bool = False) -> None:
        self._answer, self._interrupts, self._is_tuned = answer, interrupts, is_tuned
        self._passage: int | str | None = None
        self._spoke = time.monotonic()
        self._bar: Bar | None = None
        self._task: TaskID | None = None

    def __enter__(self) -> Self:
        if self._answer.err.is_terminal:
            self._bar = bar = _make_bar(self._answer)
            bar.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._bar is not None:
            self._bar.stop()

    def __call__(self, passage: int | str, progress: Progress) -> bool:
        """Show the progress of a numbered or named passage; True asks it to stop."""
        if self._bar is not None:
            self._move_bar(self._bar, passage, progress)
        else:
            self._write_line(passage, progress)
        if self._interrupts.requested is None:
            return False
        self._answer.say("stopping; what was computed is kept (a second signal stops at once)")
        return True

    def _name(self, passage: int | str) -> str:
        if isinstance(passage, str):
            return passage
        return f"passage {passage} of the mean-force tuning" if self._is_tuned else "passage"

    def _move_bar(self, bar: Bar, passage: int | str, progress: Progress) -> None:
        if passage != self._passage or self._task is None:
            self._passage = passage
            if self._task is not None:
                bar.remove_task(self._task)
            self._task = bar.add_task(self._name(passage), total=1.0, left="")
        bar.update(
            self._task,
            completed=progress.share,
            left=f"{duration(progress.remaining)} left" if progress.elapsed > 1.0 else "",
        )

    def _write_line(self, passage: int | str, progress: Progress) -> None:
        now = time.monotonic()
        if passage != self._passage:
            self._passage, self._spoke = passage, now
            self._answer.say(f"{self._name(passage)}: {progress.duration:.1f} s to simulate")
        elif now - self._spoke >= SECONDS_BETWEEN_LINES:
            self._spoke = now
            self._answer.say(
                f"{self._name(passage)}: {100 * progress.share:.0f} %, "
                f"about {duration(progress.remaining)} left"
            )


class StepWatch:
    """Shows how many of some equal steps are done, and stops when a signal has asked for it.

    As a context it ends quietly with the computation that it stopped.

    Parameters
    ----------
    answer
        The command, for its standard error.
    interrupts
        Signals received.
    name
        What is computed.
    """

    def __init__(self, answer: Answer, interrupts: Interrupts, name: str) -> None:
        self._answer, self._interrupts, self._name = answer, interrupts, name
        self._spoke = time.monotonic()
        self._bar: Bar | None = None
        self._task: TaskID | None = None

    def __enter__(self) -> Self:
        if self._answer.err.is_terminal:
            self._bar = bar = _make_bar(self._answer)
            self._task = bar.add_task(self._name, total=1.0, left="")
            bar.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> bool:
        if self._bar is not None:
            self._bar.stop()
        return isinstance(error, _StoppedError)

    def __call__(self, done: int, total: int) -> None:
        """Show that ``done`` of ``total`` steps are done.

        Raises
        ------
        Exception
            Caught by the context, when a signal has asked to stop.
        """
        if self._interrupts.requested is not None:
            self._answer.say(f"{self._name} stopped; what was computed before is kept")
            raise _StoppedError
        now = time.monotonic()
        if self._bar is not None and self._task is not None:
            self._bar.update(self._task, completed=done / total)
        elif now - self._spoke >= SECONDS_BETWEEN_LINES:
            self._spoke = now
            self._answer.say(f"{self._name}: {100 * done / total:.0f} %")


class _StoppedError(Exception):
    """A signal has asked to stop."""


def duration(seconds: float) -> str:
    """Return a time as people say it: ``42 s``, ``3 min 20 s``, ``2 h 5 min``."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"


def _make_bar(answer: Answer) -> Bar:
    from rich.progress import BarColumn, TaskProgressColumn, TextColumn
    from rich.progress import Progress as Bar

    return Bar(
        TextColumn("{task.description}", markup=False),
        BarColumn(bar_width=24),
        TaskProgressColumn(),
        TextColumn("{task.fields[left]}", markup=False),
        console=answer.err,
        transient=True,
    )
