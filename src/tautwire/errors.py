"""Exceptions a user of tautwire can meet; every message says what, where and what to try."""

from __future__ import annotations

import errno
from collections.abc import Sequence
from typing import Any

_CURES = (
    ((errno.ENAMETOOLONG,), "choose a shorter name"),
    ((errno.ENOSPC, errno.EDQUOT, errno.EFBIG), "make room on the disk"),
    ((errno.EACCES, errno.EPERM, errno.EROFS), "change its permissions"),
    ((errno.ENOENT, errno.ENOTDIR, errno.ELOOP), "check that its folder exists"),
)
"""What helps against a refusal of the operating system, by its number."""


def cure_of(error: Exception) -> str:
    """Say what to try when the operating system refuses to read or write a file."""
    number = getattr(error, "errno", None)
    cures = (cure for numbers, cure in _CURES if number in numbers)
    return next(cures, "check free space, path and permissions")


def not_installed(package: str, extra: str) -> InputError:
    """Return what is raised where a package of an extra is missing."""
    return InputError(
        f"{package} is not installed; install it with: pip install 'tautwire[{extra}]'"
    )


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
