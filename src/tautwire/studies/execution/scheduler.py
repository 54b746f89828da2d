"""The Dask scheduler that a user names: its address, its certificates, and whether it answers.

Dask itself waits for ever for a port that accepts and says nothing, so the scheduler is asked who
it is, in limited time, before a client is made.
"""

from __future__ import annotations

import asyncio
import re
import socket
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from tautwire.errors import InputError

_ADDRESS = re.compile(
    r"(?:(?P<scheme>[A-Za-z][\w+.-]*)://)?(?P<host>\[[0-9A-Fa-f:.]+\]|[^\s:/@\[\]]+):(?P<port>\d+)/?"
)
_RETRY = 0.25
"""Time between two attempts to reach a scheduler [s]: short for a person, long for the network."""
_EXPECTED = "expected tcp://HOST:PORT or tls://HOST:PORT, as the scheduler prints it at its start"


AUTHORITY, CERTIFICATE, KEY = "ca.pem", "cert.pem", "key.pem"


def make_security(address: str, folder: Path | None) -> Any:
    """Return what Dask needs to prove who is who; a ``distributed.Security``.

    Parameters
    ----------
    address
        Of the scheduler, in full.
    folder
        Holds ``ca.pem`` (who signed the certificates of scheduler and workers), ``cert.pem`` and
        ``key.pem`` of this client; None leaves it to Dask's configuration.

    Raises
    ------
    InputError
        When a ``tls://`` address lacks certificates, or a plain one has them.
    """
    from distributed import Security

    is_tls = address.startswith("tls://")
    if folder is None:
        security = Security()
        if is_tls and not (security.tls_ca_file and security.tls_client_cert):
            raise InputError(
                f"--cluster {address}: needs certificates; give --tls DIR, or set "
                "distributed.comm.tls in Dask's configuration"
            )
        return security
    if not is_tls:
        raise InputError(f"--tls {folder}: is for a tls:// address, --cluster is {address}")
    files = {
        "tls_ca_file": folder / AUTHORITY,
        "tls_client_cert": folder / CERTIFICATE,
        "tls_client_key": folder / KEY,
    }
    missing = [path for path in files.values() if not path.is_file()]
    if missing:
        raise InputError([f"--tls {folder}: {path.name} is missing there" for path in missing])
    return Security(require_encryption=True, **{name: str(path) for name, path in files.items()})


def parse_address(text: str) -> str:
    """Return the address of a scheduler in full.

    Parameters
    ----------
    text
        ``tcp://host:port``, ``tls://host:port``; ``host:port`` means tcp.

    Raises
    ------
    InputError
        When it is no such address.

    Examples
    --------
    >>> parse_address("localhost:8786")
    'tcp://localhost:8786'
    """
    match = _ADDRESS.fullmatch(text.strip())
    scheme = (match["scheme"] or "tcp").lower() if match else ""
    if match is None or scheme not in ("tcp", "tls") or not 0 < int(match["port"]) < 65536:
        raise InputError(f"--cluster: got {text!r}; {_EXPECTED}")
    return f"{scheme}://{match['host']}:{match['port']}"


def ask_scheduler(address: str, security: Any, timeout: float) -> None:
    """See that a scheduler answers at an address.

    Parameters
    ----------
    address
    security
        A ``distributed.Security``.
    timeout
        Longest time it may take [s].

    Raises
    ------
    InputError
        When nothing answers there, or something else does.
    """
    end = time.monotonic() + timeout
    _reach(address, end)
    left = max(1.0, end - time.monotonic())
    with ThreadPoolExecutor(1) as apart:  # the caller may have a running event loop of its own
        answer = apart.submit(asyncio.run, _identity(address, security, left))
        try:
            kind = answer.result()
        except TimeoutError:
            raise _foreign(address, "silence") from None
        except Exception as error:  # noqa: BLE001  whatever a foreign program may answer
            raise _foreign(address, _last(error)) from None
    if kind != "Scheduler":
        raise _no_scheduler(address, f"a Dask {kind.lower()} does; give the scheduler's address")


def _reach(address: str, end: float) -> None:
    """Open a connection, again and again until a time: the scheduler may be starting just now."""
    host, _, port = address.partition("://")[2].rpartition(":")
    while True:
        left = max(0.1, end - time.monotonic())
        try:
            socket.create_connection((host.strip("[]"), int(port)), timeout=left).close()
        except OSError as error:
            if isinstance(error, ConnectionRefusedError) and left > _RETRY:
                time.sleep(_RETRY)
                continue
            reason = error.strerror or str(error)
            raise _no_scheduler(address, f"{reason}; check address and network") from None
        return


async def _identity(address: str, security: Any, timeout: float) -> str:
    """Return what kind of Dask process answers."""
    from distributed.core import rpc

    arguments = security.get_connection_args("client")
    async with (
        asyncio.timeout(timeout),
        rpc(address, connection_args=arguments, timeout=timeout) as other,
    ):
        identity: Any = await other.identity()
        return str(identity["type"])


def _last(error: BaseException) -> str:
    """Return the cause of a chain of errors, which says more than what Dask makes of it."""
    while error.__cause__ is not None:
        error = error.__cause__
    return " ".join(f"{type(error).__name__}: {error}".split())[:200]


def _foreign(address: str, reason: str) -> InputError:
    other = "tcp" if address.startswith("tls:") else "tls"
    text = f"the port is open, but what comes from it is of no use: {reason}"
    return _no_scheduler(address, f"{text}; is it another program's, or one for {other}://?")


def _no_scheduler(address: str, reason: str) -> InputError:
    return InputError(f"--cluster {address}: no Dask scheduler answers there ({reason})")
