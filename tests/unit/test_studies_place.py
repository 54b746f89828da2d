"""Where a study computes and what it leaves there: addresses of clusters, locks of folders."""

from __future__ import annotations

from pathlib import Path
from typing import IO

import pytest

from tautwire.errors import InputError
from tautwire.files import FolderLock
from tautwire.studies.execution.scheduler import parse_address


@pytest.mark.parametrize(
    ("text", "address"),
    [
        ("node1:8786", "tcp://node1:8786"),
        ("tcp://10.0.0.7:8786/", "tcp://10.0.0.7:8786"),
        ("TLS://node1.example.org:1", "tls://node1.example.org:1"),
        (" [::1]:8786 ", "tcp://[::1]:8786"),
    ],
)
def test_addresses(text: str, address: str) -> None:
    """An address is completed as Dask would complete it."""
    assert parse_address(text) == address


@pytest.mark.parametrize(
    "text",
    ["", ":8786", "node1", "tcp://", "tcp://node1", "tcp://node1:x", "node1:0", "node1:65536",
     "http://node1:8787/status", "tcp://me@node1:8786", "::1:8786", "two words:1", "node1:1\n-x"],
)  # fmt: skip
def test_malformed_addresses(text: str) -> None:
    """What is no address is refused with the two forms that are."""
    with pytest.raises(InputError, match=r"expected tcp://HOST:PORT or tls://HOST:PORT"):
        parse_address(text)


def test_lock_goes_with_its_holder(tmp_path: Path) -> None:
    """A lock leaves no file behind, alone or shared by parts, whoever ends last."""
    with FolderLock(tmp_path):
        assert list(tmp_path.iterdir())
    assert not list(tmp_path.iterdir())
    first, second = FolderLock(tmp_path, "1/2"), FolderLock(tmp_path, "2/2")
    with first:
        second.__enter__()
    assert [path.name for path in sorted(tmp_path.iterdir())] == [".lock", ".lock-2-of-2"]
    second.__exit__()
    assert not list(tmp_path.iterdir())
    with (
        FolderLock(tmp_path),
        pytest.raises(InputError, match="another command is computing"),
        FolderLock(tmp_path),
    ):
        pass


def test_lock_that_was_just_removed_is_taken_anew(tmp_path: Path) -> None:
    """A file of the lock that its last holder removes between opening and locking is no lock."""
    lock = FolderLock(tmp_path)
    opened = lock._opened

    def late(path: Path) -> IO[bytes]:
        file = opened(path)
        if not hasattr(lock, "was_removed"):
            path.unlink()
            lock.was_removed = True  # type: ignore[attr-defined]
        return file

    lock._opened = late  # type: ignore[method-assign]
    with lock:
        assert [path.name for path in tmp_path.iterdir()] == [".lock"]
