"""Exceptions a user of tautwire can meet; every message says what, where and what to try."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any


class TautwireError(Exception):
    """Base of all errors raised by tautwire on purpose."""


class InputError(TautwireError):
    """The input is refused; nothing was computed.

    Parameters
    ----------
    problems
        One sentence per fault; all faults of an input are reported together.
    """

    def __init__(self, problems: str | Sequence[str]) -> None:
        self.problems: tuple[str, ...] = (
            (problems,) if isinstance(problems, str) else tuple(problems)
        )
        super().__init__("\n".join(self.problems))


class ModelError(TautwireError):
    """The line described by the input cannot exist (an arm would push, a dropper would push)."""


class ConvergenceError(TautwireError):
    """An iteration did not reach its tolerance.

    Parameters
    ----------
    message
        What happened, where, and what to try.
    partial
        What had been computed until then, when that is worth keeping.
    """

    def __init__(self, message: str, partial: Any = None) -> None:
        super().__init__(message)
        self.partial = partial
