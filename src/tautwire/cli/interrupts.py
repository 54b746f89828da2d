"""Ctrl-C and SIGTERM: the first asks a passage to stop and keep what it has, the second stops."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from tautwire.cli.session import Interrupted

SIGNALS = (signal.SIGINT, signal.SIGTERM)


class Interrupts:
    """Signals that arrive while a command computes.

    Attributes
    ----------
    requested : int or None
        Number of the last signal that asked to stop.
    """

    def __init__(self) -> None:
        self.requested: int | None = None
        self._patient = False

    @property
    def exit_code(self) -> int:
        """Exit code that names the signal; 0 without one."""
        return 0 if self.requested is None else 128 + self.requested

    @contextmanager
    def patient(self) -> Iterator[None]:
        """Let a first signal only set ``requested``; outside it stops at once."""
        self._patient = True
        try:
            yield
        finally:
            self._patient = False

    @contextmanager
    def handled(self) -> Iterator[Interrupts]:
        """Receive the signals of the process."""
        if threading.current_thread() is not threading.main_thread():
            yield self
            return
        previous = {number: signal.signal(number, self._receive) for number in SIGNALS}
        try:
            yield self
        finally:
            for number, handler in previous.items():
                signal.signal(number, handler)

    def _receive(self, number: int, _frame: FrameType | None) -> None:
        stops = self.requested is not None or not self._patient
        self.requested = number  # kept also where a library swallows the exception
        if stops:
            raise Interrupted(number)
