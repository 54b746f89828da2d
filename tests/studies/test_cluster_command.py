"""``tautwire study --cluster`` against a real scheduler on loopback: how it ends."""

from __future__ import annotations

import contextlib
import json
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from ..lines import HAS_CORE
from .conftest import SMALL, values_on_disk
from .local_cluster import Cluster, free_port

pytest.importorskip("distributed", reason="Dask is not installed")
pytestmark = pytest.mark.slow

CASES = 24
STUDY = {
    "schema": 1,
    "name": "far",
    "title": "A study far away",
    "base": "ac-simple",
    "overrides": SMALL,
    "axes": {"scenario.speed": {"from": "200 km/h", "to": "292 km/h", "count": CASES}},
}
LONGEST = 20.0
"""Time [s] within which an address that is of no use is refused."""

Finished = subprocess.CompletedProcess[str]


def command(*options: str) -> list[str]:
    """Return the command that runs the study."""
    return [sys.executable, "-m", "tautwire", "study", "study.json", *options]


@pytest.fixture
def study(tmp_path: Path) -> Callable[..., Finished]:
    """Run the command in an empty folder that holds the study's file."""
    (tmp_path / "study.json").write_text(json.dumps(STUDY))

    def run(*options: str) -> Finished:
        return subprocess.run(
            command(*options),
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=False,
            timeout=120,
        )

    return run


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The folder that the study makes."""
    return tmp_path / "tautwire-study-far"


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Cluster]:
    """A scheduler and two workers with one thread each."""
    with Cluster(tmp_path) as running:
        for _ in range(2):
            running.add_worker()
        running.wait_for_workers(2)
        yield running


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What local processes compute, undisturbed."""
    place = tmp_path_factory.mktemp("local")
    (place / "study.json").write_text(json.dumps(STUDY))
    subprocess.run(command("--workers", "2"), cwd=place, check=True, capture_output=True)
    return values_on_disk(place / "tautwire-study-far")


def wait_for_rows(process: subprocess.Popen[str], folder: Path, count: int) -> None:
    """Wait until so many cases are finished while the study goes on."""
    end = time.monotonic() + 60.0
    while len(values_on_disk(folder)) < count:
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < end, "no cases are finished"
        time.sleep(0.01)


def test_ends_with_table_and_report(
    cluster: Cluster, study: Callable[..., Finished], folder: Path, expected: dict[str, Any]
) -> None:
    """Two workers: exit code 0, table, report and document, the numbers of local processes."""
    outcome = study("--cluster", cluster.address, "--json")
    assert outcome.returncode == 0, outcome.stderr
    document = json.loads(outcome.stdout)
    assert document["cases"]["done"] == CASES
    assert document["computed_by"].endswith(f"{cluster.address} (workers: 2, threads: 2)")
    assert set(document["files"]) == {"table.csv", "table.nc", "study.json", "study.html"}
    assert cluster.address in (folder / "study.html").read_text(encoding="utf-8")
    assert values_on_disk(folder) == expected


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_interrupted(
    cluster: Cluster,
    study: Callable[..., Finished],
    folder: Path,
    expected: dict[str, Any],
    number: int,
    code: int,
) -> None:
    """A signal keeps its exit code and what is finished; --resume computes the rest."""
    process = subprocess.Popen(
        command("--cluster", cluster.address, "--json"),
        cwd=folder.parent, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    wait_for_rows(process, folder, 3)
    process.send_signal(number)
    out, errors = process.communicate(timeout=60)
    assert process.returncode == code, errors
    assert 3 <= json.loads(out)["cases"]["done"] < CASES
    assert set(json.loads(out)["files"]) >= {"table.csv", "study.html"}
    assert study("--cluster", cluster.address, "--resume").returncode == 0
    assert values_on_disk(folder) == expected


@pytest.mark.parametrize("victim", ["worker", "scheduler", "client"])
def test_killed_part(
    cluster: Cluster,
    study: Callable[..., Finished],
    folder: Path,
    expected: dict[str, Any],
    victim: str,
) -> None:
    """kill -9 of a worker, the scheduler, the command: finished rows stay, --resume ends equal."""
    process = subprocess.Popen(
        command("--cluster", cluster.address),
        cwd=folder.parent, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    wait_for_rows(process, folder, 3)
    kept = values_on_disk(folder)
    parts = {"worker": cluster.workers[0], "scheduler": cluster.scheduler, "client": process}
    parts[victim].kill()
    out, errors = process.communicate(timeout=90)
    assert process.returncode == {"worker": 0, "scheduler": 1, "client": -9}[victim], errors
    if victim == "scheduler":
        assert "is gone" in errors
        assert "finished cases are kept" in errors
        assert "study.html" in out
    assert kept.items() <= values_on_disk(folder).items()
    assert study("--workers", "2", "--resume").returncode == 0
    assert values_on_disk(folder) == expected


def test_last_worker_killed(
    tmp_path: Path, study: Callable[..., Finished], folder: Path, expected: dict[str, Any]
) -> None:
    """Without any worker left the study stops with its reason; nothing finished is lost."""
    with Cluster(tmp_path) as cluster:
        worker = cluster.add_worker()
        cluster.wait_for_workers(1)
        process = subprocess.Popen(
            command("--cluster", cluster.address),
            cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
        wait_for_rows(process, folder, 3)
        worker.kill()
        _, errors = process.communicate(timeout=60)
    assert process.returncode == 1
    assert "no workers for 20 s" in errors
    assert study("--workers", "2", "--resume").returncode == 0
    assert values_on_disk(folder) == expected


def refused(study: Callable[..., Finished], *options: str) -> str:
    """See that the command refuses its options in time, leaves nothing, and return what it says."""
    begin = time.monotonic()
    outcome = study(*options)
    assert time.monotonic() - begin < LONGEST
    assert outcome.returncode == 2, outcome.stderr
    return outcome.stderr


@pytest.mark.parametrize(
    ("address", "words"),
    [
        ("", "expected tcp://HOST:PORT or tls://HOST:PORT"),
        ("tcp://127.0.0.1", "expected tcp://HOST:PORT"),
        ("tcp://127.0.0.1:many", "expected tcp://HOST:PORT"),
        ("tcp://127.0.0.1:70000", "expected tcp://HOST:PORT"),
        ("http://127.0.0.1:8787", "expected tcp://HOST:PORT"),
        ("tls://127.0.0.1:8786", "needs certificates; give --tls DIR"),
        ("tcp://no-such-host.invalid:8786", "no Dask scheduler answers there"),
    ],
)
def test_address_of_no_use(
    study: Callable[..., Finished], tmp_path: Path, address: str, words: str
) -> None:
    """Malformed addresses, unknown machines and missing certificates are refused by name."""
    assert words in refused(study, "--cluster", address)
    assert [path.name for path in tmp_path.iterdir()] == ["study.json"]


def test_nobody_listens(study: Callable[..., Finished], tmp_path: Path) -> None:
    """A port at which nobody listens is refused."""
    told = refused(study, "--cluster", f"127.0.0.1:{free_port()}")
    assert "no Dask scheduler answers there (Connection refused" in told
    assert [path.name for path in tmp_path.iterdir()] == ["study.json"]


@pytest.mark.parametrize("words", [b"", b"HTTP/1.1 400 Bad Request\r\n\r\n"])
def test_port_of_something_else(
    study: Callable[..., Finished], tmp_path: Path, words: bytes
) -> None:
    """A port that accepts and is silent, or speaks another language, is refused in time."""
    with contextlib.closing(socket.create_server(("127.0.0.1", 0))) as server:
        code = (
            "import socket, sys, time\n"
            "server = socket.socket(fileno=int(sys.argv[1]))\n"
            "kept = []\n"
            "while True:\n"
            "    kept.append(server.accept()[0]); kept[-1].sendall(eval(sys.argv[2]))\n"
        )
        number = server.fileno()
        with subprocess.Popen(
            [sys.executable, "-c", code, str(number), repr(words)], pass_fds=[number]
        ) as other:
            told = refused(study, "--cluster", f"tcp://127.0.0.1:{server.getsockname()[1]}")
            other.kill()
    assert "no Dask scheduler answers there" in told
    assert [path.name for path in tmp_path.iterdir()] == ["study.json"]


def test_no_workers(study: Callable[..., Finished], tmp_path: Path) -> None:
    """A scheduler without workers is refused with the command that starts one."""
    with Cluster(tmp_path) as cluster:
        told = refused(study, "--cluster", cluster.address)
        assert f"no workers; start some, as in: dask worker {cluster.address}" in told


def test_address_of_a_worker(study: Callable[..., Finished], cluster: Cluster) -> None:
    """The address of a worker in place of the scheduler's is told apart."""
    from distributed import Client

    with Client(cluster.address, set_as_default=False) as client:
        worker = next(iter(client.nthreads()))
    told = refused(study, "--cluster", worker)
    assert "a Dask worker does; give the scheduler's address" in told


@pytest.fixture
def other_version(tmp_path: Path) -> Path:
    """A folder with another version of the package, which is laid out differently."""
    folder = tmp_path / "other"
    (folder / "tautwire").mkdir(parents=True)
    (folder / "tautwire" / "__init__.py").write_text("__version__ = '9.9.9'\n")
    code = "import sys\nsys.meta_path[:] = [f for f in sys.meta_path if isinstance(f, type)]\n"
    (folder / "sitecustomize.py").write_text(code)  # without the finder of an editable install
    return folder


def test_wrong_version(
    study: Callable[..., Finished], tmp_path: Path, other_version: Path, folder: Path
) -> None:
    """A worker with another version is named before anything is computed."""
    with Cluster(tmp_path) as cluster:
        cluster.add_worker(other_version)
        told = refused(study, "--cluster", cluster.address)
    assert "has tautwire 9.9.9, this is" in told
    assert "install the same version on all workers" in told
    assert not folder.exists()


def test_wrong_version_joins_later(
    cluster: Cluster, study: Callable[..., Finished], other_version: Path, folder: Path
) -> None:
    """A worker of another version that joins during the study stops it by name; rows are kept."""
    process = subprocess.Popen(
        command("--cluster", cluster.address),
        cwd=folder.parent, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    wait_for_rows(process, folder, 2)
    cluster.add_worker(other_version)
    for worker in cluster.workers[:2]:
        worker.send_signal(signal.SIGSTOP)  # the newcomer must get a case
    cluster.wait_for_workers(3)
    for worker in cluster.workers[:2]:
        worker.kill()
    out, errors = process.communicate(timeout=90)
    assert process.returncode == 1
    assert "a worker cannot load what computes a case" in errors
    assert "install the same version on all workers; finished cases are kept" in errors
    assert "study.html" in out


def test_mixed_instruction_sets(
    tmp_path: Path, study: Callable[..., Finished], folder: Path
) -> None:
    """Workers with different instruction sets are named in the terminal, table and report."""
    if not HAS_CORE:
        pytest.skip("there are no compiled kernels to choose from")
    with Cluster(tmp_path) as cluster:
        cluster.add_worker(TAUTWIRE_SIMD="plain")
        cluster.add_worker(TAUTWIRE_SIMD="v2")
        cluster.wait_for_workers(2)
        outcome = study("--cluster", cluster.address, "--json")
    document = json.loads(outcome.stdout)
    kernels = {row["backend"] for row in document["rows"]}
    assert outcome.returncode == 0, outcome.stderr
    assert len(kernels) == 2
    for told in (outcome.stderr, document["mixture"], (folder / "study.html").read_text("utf-8")):
        assert "cases were computed by different kernels" in told
        assert all(f"{kernel}: " in told for kernel in kernels)


def test_certificates(tmp_path: Path, study: Callable[..., Finished], folder: Path) -> None:
    """A tls:// cluster is used with certificates, and refused with those of a stranger."""
    for name in ("ours", "theirs"):
        (tmp_path / name).mkdir()
        make_certificates(tmp_path / name)
    with Cluster(tmp_path, tls=tmp_path / "ours") as cluster:
        cluster.add_worker()
        told = refused(study, "--cluster", cluster.address, "--tls", "theirs")
        assert "no Dask scheduler answers there" in told
        assert "certificate" in told.lower()
        plain = cluster.address.replace("tls", "tcp")
        assert "or one for tls://?" in refused(study, "--cluster", plain)
        assert "--tls ours: is for a tls://" in refused(study, "--cluster", plain, "--tls", "ours")
        outcome = study("--cluster", cluster.address, "--tls", "ours")
        assert outcome.returncode == 0, outcome.stderr
    assert len(values_on_disk(folder)) == CASES


def make_certificates(folder: Path) -> None:
    """Write a certificate that signs itself, which serves as authority and for every role."""
    try:
        subprocess.run(
            ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-subj", "/CN=tautwire",
             "-days", "2", "-keyout", "key.pem", "-out", "cert.pem"],
            cwd=folder, check=True, capture_output=True,
        )  # fmt: skip
    except FileNotFoundError:
        pytest.skip("openssl is needed to make certificates")
    (folder / "ca.pem").write_text((folder / "cert.pem").read_text())
