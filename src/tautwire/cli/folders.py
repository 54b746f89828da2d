"""Output folders and files: refused before the work when they cannot be written."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from tautwire.errors import InputError, cure_of
from tautwire.text import shortened


def default_folder(case_name: str) -> Path:
    """Return the folder for the files of a case when the user names none."""
    return Path("tautwire-" + re.sub(r"[^A-Za-z0-9._+-]", "-", case_name))


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
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.written: dict[str, str] = {}
        self.problems: list[str] = []

    def write(self, name: str, write: Callable[[Path], object]) -> None:
        """Write one file; a failure is noted and does not keep others from being written.

        Parameters
        ----------
        name
            File name inside the folder.
        write
            Is given the path; writes the file completely or not at all.
        """
        path = self.folder / name
        try:
            write(path)
        except InputError as error:
            self.problems += error.problems
        except (OSError, RuntimeError) as error:
            reason = getattr(error, "strerror", None) or str(error)
            self.problems.append(f"{path}: cannot be written ({reason}); {cure_of(error)}")
        else:
            self.written[name] = str(path)
