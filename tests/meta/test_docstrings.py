"""Docstrings say what the signature says."""

from __future__ import annotations

import ast
import inspect
import re

import pytest

import tautwire

FUNCTIONS = sorted(name for name in tautwire.__all__ if name[0].islower())
_UNDERLINE = re.compile(r"^-{3,}\s*$")


def _section(docstring: str, title: str) -> list[str] | None:
    """Return the lines of a numpydoc section, or None when there is none."""
    lines = inspect.cleandoc(docstring).splitlines()
    heads = [
        i for i in range(len(lines) - 1) if lines[i].strip() and _UNDERLINE.match(lines[i + 1])
    ]
    for number, head in enumerate(heads):
        if lines[head].strip() == title:
            end = heads[number + 1] if number + 1 < len(heads) else len(lines)
            return lines[head + 2 : end]
    return None


def _documented(section: list[str]) -> set[str]:
    """Return the parameter names of a section: unindented lines, ``a, b : type``."""
    heads = (line.split(" :")[0] for line in section if line.strip() and not line[0].isspace())
    return {name.strip().lstrip("*") for head in heads for name in head.split(",")}


def _parameters(function: ast.FunctionDef) -> set[str]:
    """Return the parameter names of a function without ``self`` and ``cls``."""
    a = function.args
    named = [*a.posonlyargs, *a.args, *a.kwonlyargs, a.vararg, a.kwarg]
    return {arg.arg for arg in named if arg is not None} - {"self", "cls"}


def test_parameters_match_the_signature(sources: dict[str, ast.Module]) -> None:
    """A "Parameters" section names exactly the parameters of its function."""
    wrong, seen = [], 0
    for path, tree in sources.items():
        for node in ast.walk(tree):
            if not isinstance(node, ast.FunctionDef):
                continue
            section = _section(ast.get_docstring(node) or "", "Parameters")
            if section is None:
                continue
            seen += 1
            difference = _documented(section) ^ _parameters(node)
            if difference:
                wrong.append(f"{path}:{node.lineno} {node.name}: {sorted(difference)}")
    assert seen > 0
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_public_function_describes_its_parameters(name: str) -> None:
    """Every public function with parameters has a "Parameters" section."""
    function = getattr(tautwire, name)
    needed = bool(inspect.signature(function).parameters)
    assert not needed or _section(function.__doc__ or "", "Parameters")
