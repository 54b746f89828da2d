"""What the tests about the code itself share: the parsed sources."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def root() -> Path:
    """The root of the repository."""
    return ROOT


@pytest.fixture(scope="session")
def sources() -> dict[str, ast.Module]:
    """Syntax tree of every module of the package, by its path below ``src``."""
    return _trees(ROOT / "src")


@pytest.fixture(scope="session")
def test_sources() -> dict[str, ast.Module]:
    """Syntax tree of every test module, by its path below ``tests``."""
    return _trees(ROOT / "tests", "test_*.py")


def _trees(folder: Path, pattern: str = "*.py") -> dict[str, ast.Module]:
    return {
        path.relative_to(folder).as_posix(): ast.parse(path.read_text(encoding="utf-8"))
        for path in sorted(folder.rglob(pattern))
    }
