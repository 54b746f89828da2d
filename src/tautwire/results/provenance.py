"""Where a result comes from: program, input and machine."""

from __future__ import annotations

import platform
import subprocess
from datetime import UTC, datetime
from functools import cache
from pathlib import Path

from tautwire.specs.case import Case
from tautwire.version import __version__


def provenance(case: Case, backend: str) -> dict[str, str]:
    """Collect what is needed to find out later how a result was made.

    Parameters
    ----------
    case : Case
        Input of the computation.
    backend : str
        Kernels that computed it (``"native"`` or ``"reference"``).

    Returns
    -------
    dict
        ``version, commit, created, case_hash, python, platform, backend``; ``commit`` is empty
        outside a source checkout, ``created`` is UTC in ISO 8601.
    """
    return {
        "version": __version__,
        "commit": commit(),
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "case_hash": case.hash(),
        "python": platform.python_version(),
        "platform": platform.platform(),
        "backend": backend,
    }


@cache
def commit() -> str:
    """Git commit of the source checkout, ``-modified`` appended when files differ from it.

    Empty when the package does not run from its own checkout: a user's repository around a
    virtual environment says nothing about this program.
    """
    root = _checkout()
    if root is None:
        return ""
    command = ["git", "-C", str(root), "describe", "--always", "--abbrev=12", "--exclude=*"]
    try:
        answer = subprocess.run(
            [*command, "--dirty=-modified"], capture_output=True, text=True, timeout=10, check=True
        )
    except (OSError, subprocess.SubprocessError):
        return ""
    return answer.stdout.strip()


def _checkout() -> Path | None:
    """Return the root of the source checkout this package runs from."""
    package = Path(__file__).resolve().parent.parent
    root = package.parent.parent
    is_own = package.parent.name == "src" and (root / "pyproject.toml").is_file()
    return root if is_own and (root / ".git").exists() else None
