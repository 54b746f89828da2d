"""Every test asserts, and its docstring is the claim."""

from __future__ import annotations

import ast

Function = ast.FunctionDef | ast.AsyncFunctionDef
CHECKING_CALLS = ("raises", "warns", "fail", "assert_", "check_")


def _called(node: ast.AST) -> set[str]:
    """Return the last names of everything called inside a node."""
    names = set()
    for call in ast.walk(node):
        if isinstance(call, ast.Call):
            name = getattr(call.func, "attr", getattr(call.func, "id", ""))
            names.add(name)
    return names


def _asserts(node: ast.AST, helpers: dict[str, Function], seen: frozenset[str]) -> bool:
    """Tell whether a function asserts, itself or through a helper of the same module."""
    if any(isinstance(child, ast.Assert) for child in ast.walk(node)):
        return True
    called = _called(node)
    if any(name.startswith(CHECKING_CALLS) for name in called):
        return True
    inner = (called & set(helpers)) - seen
    return any(_asserts(helpers[name], helpers, seen | inner) for name in inner)


def _functions(tree: ast.Module) -> dict[str, Function]:
    return {node.name: node for node in ast.walk(tree) if isinstance(node, Function)}


def test_every_test_asserts(test_sources: dict[str, ast.Module]) -> None:
    """A test without an assertion proves nothing."""
    silent = []
    for path, tree in test_sources.items():
        functions = _functions(tree)
        silent += [
            f"{path}:{node.lineno} {name}"
            for name, node in functions.items()
            if name.startswith("test_") and not _asserts(node, functions, frozenset({name}))
        ]
    assert test_sources
    assert not silent, "\n".join(silent)


def test_every_test_states_its_claim(test_sources: dict[str, ast.Module]) -> None:
    """The docstring of a test says what it claims, with the source of a number."""
    mute = [
        f"{path}:{node.lineno} {name}"
        for path, tree in test_sources.items()
        for name, node in _functions(tree).items()
        if name.startswith("test_") and not ast.get_docstring(node)
    ]
    assert not mute, "\n".join(mute)


def test_a_silent_test_is_found() -> None:
    """The search tells a test that asserts through a helper from one that does not assert."""
    tree = ast.parse(
        "def helper(): assert True\ndef test_good(): helper()\ndef test_bad(): print(1)\n"
    )
    functions = _functions(tree)
    verdicts = {
        name: _asserts(functions[name], functions, frozenset({name}))
        for name in ("test_good", "test_bad")
    }
    assert verdicts == {"test_good": True, "test_bad": False}
