"""Output folders and files: refused before the work when they cannot be written."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from tautwire.cli.session import DONE, Answer, OutputError
from tautwire.cli.views.tables import files_written, heading
from tautwire.errors import InputError, cure_of
from tautwire.files import FolderLock, remove_drafts
from tautwire.text import shortened

RESULTS = (
    "run.nc", "results.json", "report.html", "report.pdf", "force.csv", "force-*.csv",
    "droppers.csv", "static.nc", "static.json", "elasticity.csv", "supports.csv", "tensions.csv",
    "installation.csv", "lateral.csv", "design.csv", "conditions.csv", "conditions.html",
    "line.xlsx", "workshop.xlsx", "static.html", "static.pdf",
)  # fmt: skip
"""Files of one run, or of one static state; a folder holds those of one of them."""

_LONGEST_NAME = 80
"""Characters of a folder's name before the rest is told by a checksum."""


def default_folder(case_name: str, overrides: Sequence[str] = ()) -> Path:
    """Return the folder for the files of a case when the user names none.

    Parameters
    ----------
    case_name
    overrides
        What was set for this run, ``path=value``: it becomes part of the name, so that runs that
        differ by it do not meet in one folder.
    """
    changes = (text.partition("=") for text in overrides)
    name = "-".join([case_name, *(f"{path.split('.')[-1]}-{value}" for path, _, value in changes)])
    name = re.sub(r"[^A-Za-z0-9._+-]+", "-", name).strip("-")
    if len(name) > _LONGEST_NAME:
        name = f"{name[: _LONGEST_NAME - 9]}-{hashlib.sha256(name.encode()).hexdigest()[:8]}"
    return Path(f"tautwire-{name}")


@contextmanager
def prepared_folder(folder: Path) -> Iterator[Path]:
    """Make a folder and see that it can be written to, before anything is computed.

    When the work inside fails without leaving a file, a folder that was made is removed again.

    Parameters
    ----------
    folder
        Path as the user wrote it.

    Raises
    ------
    InputError
        When it cannot be written to.
    """
    is_new = _made(folder)
    try:
        yield folder
    finally:
        if is_new and folder.is_dir() and not any(folder.iterdir()):
            folder.rmdir()


@contextmanager
def result_folder(folder: Path, *, force: bool) -> Iterator[Files]:
    """Prepare a folder for the files of one result, and keep other commands from writing there.

    Parameters
    ----------
    folder
        Path as the user wrote it.
    force
        Whether the files of another result may be replaced; they go when the first file of this
        one is written.

    Raises
    ------
    InputError
        When the folder cannot be written to, is in use by another command, or holds another
        result.
    """
    with prepared_folder(folder), FolderLock(folder):
        remove_drafts(folder)
        held = [path for pattern in RESULTS for path in sorted(folder.glob(pattern))]
        if held and not force:
            raise InputError(
                f"--out {folder}: holds the files of another result ({_few(held)}); choose "
                "another folder with --out, or replace them with --force"
            )
        yield Files(folder, held)


def _few(paths: Sequence[Path]) -> str:
    names = [path.name for path in paths]
    return ", ".join(names) if len(names) <= 3 else f"{', '.join(names[:3])}, ..."


def _made(folder: Path) -> bool:
    """Make a folder that can be written to; tell whether there was none."""
    named = shortened(str(folder), 300)
    try:
        is_new = not folder.exists()
        if not is_new and not folder.is_dir():
            raise InputError(
                f"--out {named}: is a file, a folder is needed; choose another folder with --out"
            )
        folder.mkdir(parents=True, exist_ok=True)
        probe = folder / f".tautwire-{os.getpid()}.part"
        probe.touch()
        probe.unlink()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(
            f"--out {named}: cannot be written to ({reason}); {cure_of(error)}, or "
            "choose another folder with --out"
        ) from None
    return is_new


class Files:
    """Files written by a command, and those that could not be.

    Parameters
    ----------
    folder
        Where they go.
    replaced
        Files of another result, removed when the first file is written.
    """

    def __init__(self, folder: Path, replaced: Sequence[Path] = ()) -> None:
        self.folder = folder
        self._replaced = list(replaced)
        self.written: dict[str, str] = {}
        self._failed: dict[str, Sequence[str]] = {}

    def write(self, name: str, write: Callable[[Path], object]) -> None:
        """Write one file; a failure is noted and does not keep others from being written.

        A file may be written again; the last failure of each counts.

        Parameters
        ----------
        name
            File name inside the folder.
        write
            Is given the path; writes the file completely or not at all.
        """
        path = self.folder / name
        try:
            self._make_room(path)
            write(path)
        except InputError as error:
            self._failed[name] = error.problems
        except (OSError, RuntimeError) as error:
            reason = getattr(error, "strerror", None) or str(error)
            self._failed[name] = (f"{path}: cannot be written ({reason}); {cure_of(error)}",)
        else:
            self._failed.pop(name, None)
            self.written[name] = str(path)

    @property
    def problems(self) -> list[str]:
        """One sentence per file that could not be written."""
        return [text for texts in self._failed.values() for text in texts]

    def _make_room(self, path: Path) -> None:
        """Remove the files of another result, except the one that is replaced as a whole."""
        while self._replaced:
            if self._replaced[-1] != path:
                self._replaced[-1].unlink(missing_ok=True)
            self._replaced.pop()


def tell_files(answer: Answer, files: Files) -> None:
    """List the files that a command has written, with what each is for.

    Raises
    ------
    OutputError
        When one could not be written and the command has not failed by itself; a command that has
        says it as a warning.
    """
    answer.document["files"] = files.written
    answer.show(heading("Files"), files_written(files.written))
    if files.problems and answer.exit_code == DONE:
        raise OutputError(files.problems)
    answer.warn(files.problems)
