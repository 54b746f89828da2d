"""One command under way: where it writes, and how it ends."""

from __future__ import annotations

import errno
import io
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, NoReturn

import typer

from tautwire.cli.json_text import to_json
from tautwire.errors import ConvergenceError, InputError, ModelError, TautwireError, cure_of
from tautwire.text import shortened

if TYPE_CHECKING:
    from tautwire.cli.views.console import PlainConsole
    from tautwire.model.preflight import Advice

DONE, FAILED, REFUSED = 0, 1, 2

DEBUG = "TAUTWIRE_DEBUG"
"""Environment variable; ``1`` shows tracebacks."""


class OutputError(TautwireError):
    """A result was computed but could not be written.

    Parameters
    ----------
    problems
        One sentence per file.
    """

    def __init__(self, problems: Sequence[str]) -> None:
        self.problems = tuple(problems)
        super().__init__("\n".join(self.problems))


class Interrupted(BaseException):
    """A signal asks to stop at once.

    Parameters
    ----------
    number
        Number of the signal.

    Attributes
    ----------
    kept : str
        What becomes of the work so far.
    """

    def __init__(self, number: int) -> None:
        self.number, self.kept = number, "nothing was kept"
        super().__init__(f"interrupted by signal {number}")


@dataclass
class Answer:
    """What a command says, and where.

    Attributes
    ----------
    as_json : bool
        Standard output takes the JSON document instead of text.
    document : dict
        The JSON document.
    exit_code : int
    lost_output : OSError or None
        Why standard output cannot be written any more.
    """

    as_json: bool
    document: dict[str, Any] = field(default_factory=dict)
    exit_code: int = DONE
    lost_output: OSError | None = None

    @cached_property
    def out(self) -> PlainConsole:
        """Standard output, for people."""
        return _console(stderr=False)

    @cached_property
    def err(self) -> PlainConsole:
        """Standard error."""
        return _console(stderr=True)

    def show(self, *parts: Any) -> None:
        """Print tables and texts for people; nothing in JSON mode.

        When standard output cannot be written, as after ``| head``, the command goes on: its
        files must not depend on it.
        """
        if self.as_json or self.lost_output is not None:
            return
        try:
            for part in parts:
                self.out.print_whole(part)
            sys.stdout.flush()
        except OSError as error:
            self.lost_output = error
        except SystemExit:  # how rich answers to a closed pipe
            self.lost_output = BrokenPipeError()

    def say(self, text: str, style: str = "dim") -> None:
        """Print a line on standard error."""
        self.err.print(text, style=style, soft_wrap=True)

    def warn(self, texts: Sequence[str]) -> None:
        """Print warnings on standard error."""
        for text in texts:
            self._labelled("warning", text, "yellow")

    def advise(self, advice: Sequence[Advice]) -> None:
        """Print advice on standard error."""
        for item in advice:
            label, style = ("note", "dim") if item.severity == "note" else ("warning", "yellow")
            self._labelled(label, str(item), style)

    def fail(self, kind: str, problems: Sequence[str], exit_code: int) -> None:
        """Report problems on standard error and in the document."""
        self.exit_code = exit_code
        self.document["error"] = {"kind": kind, "problems": list(problems)}
        if len(problems) > 1:
            self._labelled("error", f"{len(problems)} problems", "bold red")
            for number, problem in enumerate(problems, 1):
                self.err.print(f" {number:2d}. {problem}", soft_wrap=True)
        else:
            self._labelled("error", "".join(problems), "bold red")

    def close(self) -> None:
        """Print the JSON document; tell when standard output was lost.

        Raises
        ------
        OSError
            When standard output could not be written.
        """
        if self.lost_output is not None:
            raise self.lost_output
        if self.as_json:
            sys.stdout.write(to_json(self.document) + "\n")
            sys.stdout.flush()

    def _labelled(self, label: str, text: str, style: str) -> None:
        from rich.text import Text

        self.err.print(Text.assemble((f"{label}:", style), " ", text), soft_wrap=True)


@contextmanager
def answering(as_json: bool) -> Iterator[Answer]:
    """Run a command: print its document, and turn errors into messages and exit codes.

    Parameters
    ----------
    as_json : bool
        Whether standard output takes one JSON document.

    Yields
    ------
    Answer

    Raises
    ------
    typer.Exit
        With the exit code, unless it is 0.
    """
    answer = Answer(as_json)
    try:
        yield answer
    except (typer.Exit, BrokenPipeError):
        raise
    except (Exception, KeyboardInterrupt, Interrupted) as error:
        kind, problems, exit_code = _explain(error)
        if kind == "internal" and os.environ.get(DEBUG) == "1":
            raise
        answer.fail(kind, problems, exit_code)
    answer.close()
    if answer.exit_code != DONE:
        raise typer.Exit(answer.exit_code)


def _explain(error: BaseException) -> tuple[str, Sequence[str], int]:
    """Return kind, sentences and exit code of an error."""
    if isinstance(error, InputError):
        return "input", error.problems, REFUSED
    if isinstance(error, ModelError):
        return "model", str(error).splitlines(), REFUSED
    if isinstance(error, ConvergenceError):
        return "computation", [str(error)], FAILED
    if isinstance(error, OutputError):
        return "output", error.problems, FAILED
    if isinstance(error, Interrupted):
        return "interrupted", [f"interrupted; {error.kept}"], 128 + error.number
    if isinstance(error, KeyboardInterrupt):
        return "interrupted", ["interrupted; nothing was kept"], 130
    if isinstance(error, MemoryError):
        cure = "use fewer spans (line.spans) or a lower settings.band"
        return "memory", [f"there is not enough memory; {cure}"], FAILED
    if isinstance(error, OSError):
        what = f"{shortened(str(error.filename), 300)}: " if error.filename else ""
        reason = error.strerror or str(error)
        return "system", [f"{what}{reason}; {cure_of(error)}"], FAILED
    return "internal", [_unexpected(error)], FAILED


def _unexpected(error: BaseException) -> str:
    what = " ".join(f"{type(error).__name__}: {error}".split())[:300]
    return (
        f"something went wrong inside tautwire ({what}); please report it with the case file. "
        f"{DEBUG}=1 shows where it happened"
    )


def _console(*, stderr: bool) -> PlainConsole:
    from tautwire.cli.views.console import PlainConsole

    return PlainConsole(stderr=stderr, markup=False, highlight=False, emoji=False)


class ClosedOutput(io.TextIOBase):
    """An output that cannot be written, and says so like a file that was closed."""

    def fileno(self) -> int:
        """Return the number of standard output, which leads nowhere."""
        return 1

    def writable(self) -> bool:
        """Tell that text may be tried."""
        return True

    def write(self, text: str) -> NoReturn:  # noqa: ARG002
        """Refuse the text.

        Raises
        ------
        OSError
            Always.
        """
        raise OSError(errno.EBADF, os.strerror(errno.EBADF))


def open_closed_streams() -> None:
    """Occupy the numbers of closed streams, so that no file that is opened later takes them.

    Otherwise what a library prints would end in the middle of a result file.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)
    if sys.stdout is None:
        sys.stdout = ClosedOutput()
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115, PTH123
