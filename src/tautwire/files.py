"""Files that are whole or not there, and folders that one command writes to at a time."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from tautwire.errors import InputError, cure_of
from tautwire.text import shortened

LOCK = ".lock"
"""File of a folder that a command holds while it computes for it."""


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Give a temporary name beside ``path`` and rename it to ``path`` when all went well.

    A reader never meets a half-written file: on any failure, an interruption included, the
    temporary file is removed and what stood at ``path`` before is untouched.

    Parameters
    ----------
    path : Path
        Final name.

    Yields
    ------
    Path
        Name to write to, in the same directory.

    Raises
    ------
    OSError
        When that fails.
    """
    draft = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        yield draft
        draft.replace(path)
    finally:
        with suppress(OSError):  # a name too long for the folder has no file either
            draft.unlink(missing_ok=True)


def remove_drafts(folder: Path, inside: str = ".") -> None:
    """Remove what killed processes left half-written.

    Parameters
    ----------
    folder
    inside
        Pattern of the folders in it that are looked at.
    """
    for draft in folder.glob(f"{inside}/.*.part"):
        draft.unlink(missing_ok=True)


def write_whole(path: Path, content: bytes) -> None:
    """Write a file completely or not at all.

    The bytes are on the disk before the file has its name: a power cut leaves it whole.

    Raises
    ------
    OSError
        When that fails.
    """
    with replacing(path) as draft, draft.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())


def write_bytes(path: str | os.PathLike[str], content: bytes) -> Path:
    """Write ``content`` to ``path`` as :func:`write_whole` does, and return the path.

    Raises
    ------
    InputError
        When it cannot be written, with the reason and what to try.
    """
    final = Path(path)
    named = shortened(str(final), 300)
    try:
        if final.is_dir():
            raise InputError(f"{named}: is a folder; give the name of a file")
        if not final.parent.is_dir():
            raise InputError(
                f"{named}: the folder {shortened(str(final.parent), 300)} does not exist; create "
                "it or choose another name"
            )
        write_whole(final, content)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(
            f"{named}: cannot be written ({reason}); {cure_of(error)}, or choose another place"
        ) from error
    return final


def write_text(path: str | os.PathLike[str], text: str) -> Path:
    """Write ``text`` to ``path`` (UTF-8) as :func:`write_bytes` does, and return the path.

    Line ends are written as they stand in ``text``.
    """
    return write_bytes(path, text.encode())


class FolderLock:
    """Keeps two commands from computing for one folder at the same time.

    A command has the folder to itself; parts of a study share it with other parts. The operating
    system releases the lock when the process ends, however it ends; a process that ends in order
    leaves no file of the lock behind.

    Parameters
    ----------
    folder
        Made where it is missing.
    part
        Name of the part of a study, as in ``"3/16"``; empty for all else.
    """

    def __init__(self, folder: Path, part: str = "") -> None:
        self._folder, self._part = folder, part
        self._held: list[tuple[Path, IO[bytes]]] = []

    def __enter__(self) -> FolderLock:
        self._take(self._folder / LOCK, is_shared=bool(self._part))
        if self._part:
            self._take(self._folder / f"{LOCK}-{self._part.replace('/', '-of-')}", is_shared=False)
        return self

    def __exit__(self, *_: object) -> None:
        held, self._held = self._held, []
        for path, file in reversed(held):
            with suppress(OSError):  # the folder may have been moved away, or its disk be gone
                if _lock(file, is_shared=False):  # nobody else shares it
                    path.unlink()
            file.close()

    def _take(self, path: Path, *, is_shared: bool) -> None:
        file = self._opened(path)
        while _lock(file, is_shared=is_shared):
            if _is_at(file, path):
                self._held.append((path, file))
                return
            file.close()  # its last holder has just removed it
            file = self._opened(path)
        file.close()
        self.__exit__()
        raise InputError(
            f"{self._folder}: another command is computing for this folder; wait for it, or "
            "choose another folder"
        )

    def _opened(self, path: Path) -> IO[bytes]:
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            return path.open("ab")
        except OSError as error:
            self.__exit__()
            raise InputError(
                f"{self._folder}: cannot be written to ({error.strerror or error}); "
                f"{cure_of(error)}, or choose another folder"
            ) from None


def _is_at(file: IO[bytes], path: Path) -> bool:
    """Say whether an open file still has its name."""
    try:
        return os.path.samestat(os.fstat(file.fileno()), path.stat())
    except OSError:
        return False


def _lock(file: IO[bytes], *, is_shared: bool) -> bool:
    """Lock a file without waiting; False when another process has it."""
    try:
        import fcntl
    except ImportError:  # not POSIX
        return True
    try:
        fcntl.flock(file, (fcntl.LOCK_SH if is_shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):
        return False
    except OSError:  # a file system without locks
        return True
    return True
