"""Writing of result files: complete or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from tautwire.errors import InputError, cure_of


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Give a temporary name beside ``path`` and rename it to ``path`` when all went well.

    A reader never meets a half-written file: on any failure, an interruption included, the
    temporary file is removed and what stood at ``path`` before is untouched.

    Parameters
    ----------
    path : str or path
        Final name.

    Yields
    ------
    Path
        Name to write to, in the same directory.

    Raises
    ------
    InputError
        When ``path`` cannot be written, with the reason and what to try.
    """
    final = Path(path)
    if not final.parent.is_dir():
        raise InputError(
            f"{final}: the folder {final.parent} does not exist; create it or choose another name"
        )
    if final.is_dir():
        raise InputError(f"{final}: is a folder; give the name of a file")
    draft = final.with_name(f".{final.name}.{os.getpid()}.part")
    try:
        yield draft
        draft.replace(final)
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(
            f"{final}: cannot be written ({reason}); {cure_of(error)}, or choose another place"
        ) from error
    finally:
        with suppress(OSError):  # a name too long for the folder has no file either
            draft.unlink(missing_ok=True)


def write_bytes(path: str | os.PathLike[str], content: bytes) -> Path:
    """Write ``content`` to ``path``, completely or not at all, and return the path.

    The bytes are on the disk before the file has its name: a power cut leaves it whole.

    Raises
    ------
    InputError
        When it cannot be written, with the reason and what to try.
    """
    with replacing(path) as draft, draft.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    return Path(path)


def write_text(path: str | os.PathLike[str], text: str) -> Path:
    """Write ``text`` to ``path`` (UTF-8), completely or not at all, and return the path.

    Line ends are written as they stand in ``text``.
    """
    return write_bytes(path, text.encode())
