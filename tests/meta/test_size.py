"""The size rules of the house style."""

from __future__ import annotations

import ast
from pathlib import Path

LONGEST_FUNCTION = 60
LONGEST_MODULE = 500


def _length(function: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    """Count the lines of a function without its decorators and docstring."""
    lines = (function.end_lineno or function.lineno) - function.lineno + 1
    first = function.body[0]
    if ast.get_docstring(function, clean=False) is not None:
        lines -= (first.end_lineno or first.lineno) - first.lineno + 1
    return lines


def test_functions_are_short(sources: dict[str, ast.Module]) -> None:
    """No function is longer than 60 lines, its docstring excluded."""
    functions = (
        (path, node)
        for path, tree in sources.items()
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
    )
    too_long = [
        f"{path}:{node.lineno} {node.name}: {_length(node)} lines"
        for path, node in functions
        if _length(node) > LONGEST_FUNCTION
    ]
    assert not too_long, "\n".join(too_long)


def test_modules_are_short(root: Path) -> None:
    """No module is longer than 500 lines."""
    lengths = {
        path: len(path.read_text(encoding="utf-8").splitlines())
        for path in (root / "src").rglob("*.py")
    }
    too_long = [f"{path}: {n} lines" for path, n in lengths.items() if n > LONGEST_MODULE]
    assert lengths
    assert not too_long, "\n".join(too_long)
