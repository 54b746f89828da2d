"""Results of a study on disk: one small file per finished case, there as soon as it is finished.

A file is written beside its place, flushed to the disk and renamed, so a row is either there as a
whole or not at all, whatever is killed when.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import IO, Any

from tautwire.errors import InputError

ROWS, RUNS, LOCK = "rows", "runs", ".lock"

Row = Mapping[str, Any]


class Store:
    """The folder of a study.

    Parameters
    ----------
    folder
        Made when it is first written to.
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = Path(folder)

    def row_path(self, key: str) -> Path:
        """Return where the row of a case is kept."""
        return self.folder / ROWS / key[:2] / f"{key}.json"

    def run_path(self, key: str) -> Path:
        """Return where the histories of a case are kept, if the study keeps them."""
        return self.folder / RUNS / f"{key}.nc"

    def finished(self) -> set[str]:
        """Return the keys of all cases with a row that can be read."""
        paths = (self.folder / ROWS).glob("??/*.json")
        return {path.stem for path in paths if self.load(path.stem) is not None}

    def load(self, key: str) -> Row | None:
        """Return the row of a case; None when there is none, or not a whole one."""
        try:
            row = json.loads(self.row_path(key).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        return row if isinstance(row, dict) and row.get("key") == key else None

    def save(self, key: str, row: Row, run_file: bytes | None = None) -> None:
        """Write the row of a finished case, its histories before it.

        Raises
        ------
        OSError
            When it cannot be written; nothing half-written stays.
        """
        if run_file is not None:
            write_whole(self.run_path(key), run_file)
        text = json.dumps({**row, "key": key}, allow_nan=False, separators=(",", ":"))
        write_whole(self.row_path(key), text.encode())

    def clear(self) -> None:
        """Remove all rows and kept histories."""
        for path in [
            *(self.folder / ROWS).glob("??/*.json"),
            *(self.folder / RUNS).glob("*.nc"),
        ]:
            path.unlink(missing_ok=True)

    def sweep(self) -> None:
        """Remove what killed processes left half-written."""
        for path in [
            *(self.folder / ROWS).glob("??/.*.part"),
            *(self.folder / RUNS).glob(".*.part"),
        ]:
            path.unlink(missing_ok=True)


def write_whole(path: Path, content: bytes) -> None:
    """Write a file completely or not at all, and see it on the disk before returning.

    Raises
    ------
    OSError
        When that fails.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    draft = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with draft.open("wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        draft.replace(path)
    finally:
        draft.unlink(missing_ok=True)


class FolderLock:
    """Keeps two studies from computing the same cases in one folder at the same time.

    A whole study has the folder to itself; parts of one share it with other parts. The operating
    system releases the lock when the process ends, however it ends. A folder in which nothing else
    was written is left as it was found.

    Parameters
    ----------
    folder
        Folder of the study.
    part
        Name of the part of a study, as in ``"3/16"``; empty for a whole one.
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
        with suppress(OSError):  # the folder may have been moved away, or its disk be gone
            if set(self._folder.iterdir()) == {path for path, _file in held}:
                for path, _file in held:
                    path.unlink()
        for _path, file in held:
            file.close()

    def _take(self, path: Path, *, is_shared: bool) -> None:
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            file = path.open("ab")
        except OSError as error:
            self.__exit__()
            raise InputError(
                f"{self._folder}: cannot be written to ({error.strerror or error}); choose "
                "another folder"
            ) from None
        self._held.append((path, file))
        if not _lock(file, is_shared=is_shared) or not _is_at(file, path):
            self._held.pop()
            file.close()
            self.__exit__()
            raise InputError(
                f"{self._folder}: another study is computing in this folder; wait for it, or "
                "choose another folder"
            )


def _is_at(file: IO[bytes], path: Path) -> bool:
    """Say whether an open file still has its name: the last holder of a lock may remove it."""
    try:
        return os.path.samestat(os.fstat(file.fileno()), path.stat())
    except OSError:
        return False


def _lock(file: IO[bytes], *, is_shared: bool) -> bool:
    """Lock a file without waiting; True when it was free, or shared by those who hold it."""
    try:
        import fcntl
    except ImportError:  # not POSIX
        return True
    try:
        fcntl.flock(file, (fcntl.LOCK_SH if is_shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
