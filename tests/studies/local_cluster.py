"""A Dask cluster on loopback, process by process, so that each can be killed."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

TOOL = [sys.executable, "-m"]


def free_port() -> int:
    """Return a port on which nobody listens."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


class Cluster:
    """A scheduler and its workers; a context manager that kills them all.

    Parameters
    ----------
    folder
        Where they put their files; also where workers find modules.
    modules
        Folders from which the workers import.
    tls
        Folder of ``ca.pem``, ``cert.pem`` and ``key.pem``; None for plain TCP.
    """

    def __init__(self, folder: Path, *modules: Path, tls: Path | None = None) -> None:
        self._folder, self._modules = folder, modules
        scheme = "tcp" if tls is None else "tls"
        self.address = f"{scheme}://127.0.0.1:{free_port()}"
        files = () if tls is None else (("ca-file", "ca"), ("cert", "cert"), ("key", "key"))
        self._tls = [
            part for name, file in files for part in (f"--tls-{name}", f"{tls}/{file}.pem")
        ]
        self.workers: list[subprocess.Popen[bytes]] = []

    def __enter__(self) -> Cluster:
        self.scheduler = self._start(
            "scheduler", "--host", self.address.rpartition(":")[0], "--port",
            self.address.rpartition(":")[2], "--no-show",
        )  # fmt: skip
        return self

    def __exit__(self, *_: object) -> None:
        for process in (*self.workers, self.scheduler):
            process.kill()
            process.wait()

    def add_worker(self, *modules: Path, **environment: str) -> subprocess.Popen[bytes]:
        """Start a worker with one thread."""
        worker = self._start(
            "worker", self.address, "--nthreads", "1", "--no-nanny",
            modules=modules, environment=environment,
        )  # fmt: skip
        self.workers.append(worker)
        return worker

    def wait_for_workers(self, count: int) -> None:
        """Wait until so many workers have joined."""
        from distributed import Client

        end = time.monotonic() + 60.0
        while time.monotonic() < end:
            try:
                with Client(self.address, timeout=2, set_as_default=False) as client:
                    client.wait_for_workers(count, timeout=30)
                    return
            except OSError:
                time.sleep(0.2)
        pytest.fail("the cluster did not start")

    def _start(
        self,
        role: str,
        *arguments: str,
        modules: tuple[Path, ...] = (),
        environment: dict[str, str] | None = None,
    ) -> subprocess.Popen[bytes]:
        paths = map(str, (*modules, *self._modules, *filter(None, sys.path)))
        return subprocess.Popen(
            [*TOOL, f"distributed.cli.dask_{role}", *arguments, "--no-dashboard", *self._tls],
            env={**os.environ, **(environment or {}), "PYTHONPATH": os.pathsep.join(paths)},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            cwd=self._folder,
        )
