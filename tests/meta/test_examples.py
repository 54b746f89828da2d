"""Examples are listed, short, and true."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
SCRIPTS = sorted(path.name for path in EXAMPLES.glob("*.py"))
LONGEST = 80


def test_every_example_is_listed() -> None:
    """``examples/README.md`` names each script once, and no other."""
    text = (EXAMPLES / "README.md").read_text(encoding="utf-8")
    listed = [word.strip("`[]()|,") for word in text.replace("](", " ").split()]
    assert SCRIPTS
    assert {word for word in listed if word.endswith(".py")} == set(SCRIPTS)


@pytest.mark.parametrize("name", SCRIPTS)
def test_example_says_what_it_shows(name: str) -> None:
    """An example opens with its question, asserts its number and has at most 80 lines."""
    text = (EXAMPLES / name).read_text(encoding="utf-8")
    tree = ast.parse(text)
    assert "?" in (ast.get_docstring(tree) or "")
    assert any(isinstance(node, ast.Assert) for node in ast.walk(tree))
    assert len(text.splitlines()) <= LONGEST


@pytest.mark.slow
@pytest.mark.parametrize("name", SCRIPTS)
def test_example_runs(name: str, tmp_path: Path) -> None:
    """An example runs to its end in an empty folder, and its assertions hold."""
    done = subprocess.run(
        [sys.executable, "-W", "error", str(EXAMPLES / name)],
        cwd=tmp_path,
        env={**os.environ, "MPLBACKEND": "Agg"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
