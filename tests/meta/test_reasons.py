"""Numbers that somebody chose say why they are as they are."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest

PLAIN = {0, 1, 2, 0.5}
"""Numbers that need no reason: halves, pairs, signs."""


def bare_constants(tree: ast.Module, lines: list[str]) -> Iterator[str]:
    """Yield the constants of a module and its classes that hold a number and no reason."""
    for body in (tree.body, *(n.body for n in tree.body if isinstance(n, ast.ClassDef))):
        for node, after in pairwise([*body, None]):
            if not isinstance(node, (ast.Assign, ast.AnnAssign)) or node.value is None:
                continue
            target = node.targets[0] if isinstance(node, ast.Assign) else node.target
            names, line = ast.unparse(target), node.lineno - 1
            beside = "#" in lines[line] or lines[line - 1].lstrip().startswith("#")
            if names.isupper() and _has_number(node.value) and not beside and not _is_text(after):
                yield f"{line + 1}: {names}"


def _has_number(value: ast.expr) -> bool:
    """Tell whether a value is made of numbers alone, and one of them wants a reason."""
    parts = list(ast.walk(value))
    if any(isinstance(part, (ast.Call, ast.Name, ast.Attribute)) for part in parts):
        return False
    found = [part.value for part in parts if isinstance(part, ast.Constant)]
    numbers = [one for one in found if isinstance(one, (int, float)) and not isinstance(one, bool)]
    return len(numbers) == len(found) and any(one not in PLAIN for one in numbers)


def _is_text(node: ast.stmt | None) -> bool:
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )


def test_constants_give_their_reason(root: Path, sources: dict[str, ast.Module]) -> None:
    """Every constant that holds a number is followed by a sentence or stands beside a comment."""
    bare = [
        f"{name}:{found}"
        for name, tree in sources.items()
        for found in bare_constants(
            tree, (root / "src" / name).read_text(encoding="utf-8").splitlines()
        )
    ]
    assert not bare, "\n".join(bare)


def test_constants_of_the_compiled_core_give_their_reason(root: Path) -> None:
    """Every numeric ``constexpr`` of the C++ core has a comment on its line or above its group."""
    constant = re.compile(r"constexpr [\w:<> ]+ \w+ = -?[0-9][0-9.e'+-]*[;,]")
    bare, count = [], 0
    for path in sorted((root / "src" / "tautwire" / "_native").rglob("*.?pp")):
        lines = path.read_text(encoding="utf-8").splitlines()
        for number, line in enumerate(lines):
            if not constant.search(line):
                continue
            count += 1
            above = next(one for one in reversed(lines[:number]) if not constant.search(one))
            if "//" not in line + above:
                bare.append(f"{path.relative_to(root)}:{number + 1}: {line.strip()}")
    assert not bare, "\n".join(bare)
    assert count > 5


@pytest.mark.parametrize(
    ("text", "is_bare"),
    [
        ("LIMIT = 0.3\n", True),
        ('LIMIT = 0.3\n"""Why."""\n', False),
        ("LIMIT = 0.3  # why\n", False),
        ("class A:\n    STEPS, EDGE = 7, 0.1\n", True),
        ("HALF = 0.5\n", False),
        ("NAMES = ('a', 'b')\n", False),
    ],
)
def test_bare_constants_are_seen(text: str, is_bare: bool) -> None:
    """The check itself: a number without a sentence or comment is found, others are not."""
    assert bool(list(bare_constants(ast.parse(text), text.splitlines()))) == is_bare
