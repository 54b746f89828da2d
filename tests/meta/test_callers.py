"""Everything that the package defines is used by it, or is offered to its users by name."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

Definition = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef

PROTOCOLS = {"_repr_html_": "notebooks", "writable": "text streams"}
"""Methods that others call by their names."""


def test_every_definition_is_used_or_documented(root: Path, sources: dict[str, ast.Module]) -> None:
    """A function, method or class that only tests name goes, or gets its place on a page."""
    used = {word for tree in sources.values() for word in words_used(tree)}
    pages = "".join(page.read_text(encoding="utf-8") for page in (root / "docs").glob("*.md"))
    shown_whole = set(re.findall(r"autoclass:: [\w.]*\.(\w+)\n   :members:\n", pages))
    used |= set(words_in(pages)) | {
        method.name
        for tree in sources.values()
        for node in ast.walk(tree)
        if isinstance(node, ast.ClassDef) and node.name in shown_whole
        for method in node.body
        if isinstance(method, Definition)
    }
    unused = [
        f"{path}:{node.lineno} {node.name}"
        for path, tree in sources.items()
        for node in definitions(tree)
        if node.name not in used | PROTOCOLS.keys()
    ]
    assert not unused


def definitions(tree: ast.Module) -> Iterator[Definition]:
    """Yield what a module defines; decorators register what they stand on."""
    for node in ast.walk(tree):
        is_named = isinstance(node, Definition) and not node.name.startswith("__")
        if is_named and not any(map(registers, node.decorator_list)):
            yield node


def registers(decorator: ast.expr) -> bool:
    """Tell whether a decorator hands a function on to something that calls it."""
    return isinstance(decorator, ast.Call) and not ast.unparse(decorator).startswith(
        ("dataclass", "lru_cache", "cache")
    )


def words_used(tree: ast.Module) -> Iterator[str]:
    """Yield the names that a module reads, quoted ones included; its docstrings do not count."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Name):
            yield node.id
        elif isinstance(node, ast.Attribute):
            yield node.attr
        elif isinstance(node, ast.Constant) and " " not in str(node.value):
            yield from words_in(str(node.value))


def words_in(text: str) -> list[str]:
    """Return the words of a text."""
    return re.findall(r"[A-Za-z_]\w*", text)
