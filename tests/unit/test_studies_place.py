"""Where a study computes and what it leaves there: addresses of clusters, locks of folders."""

from __future__ import annotations

from pathlib import Path

import pytest

from tautwire.errors import InputError
from tautwire.studies.execution.scheduler import parse_address
from tautwire.studies.store import FolderLock


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


def test_lock_leaves_an_empty_folder_as_it_was(tmp_path: Path) -> None:
    """A lock goes with its holder where nothing was written, and stays beside results."""
    with FolderLock(tmp_path):
        assert list(tmp_path.iterdir())
    assert not list(tmp_path.iterdir())
    with FolderLock(tmp_path):
        (tmp_path / "rows").mkdir()
    assert len(list(tmp_path.iterdir())) == 2
    with (
        FolderLock(tmp_path),
        pytest.raises(InputError, match="another study is computing"),
        FolderLock(tmp_path),
    ):
        pass
