"""The public names of the package."""

from __future__ import annotations

import ast
import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import tautwire

NAMES = sorted(set(tautwire.__all__) - {"__version__"})


@pytest.mark.parametrize("name", NAMES)
def test_export_is_documented(name: str) -> None:
    """Every public name can be imported and carries a docstring of its own."""
    thing = getattr(tautwire, name)
    assert inspect.getdoc(thing)
    assert thing.__doc__ is not None


def test_names_are_listed_once() -> None:
    """``dir``, ``__all__``, the table of homes and the imports for editors name the same things."""
    tree = ast.parse(Path(inspect.getfile(tautwire)).read_text(encoding="utf-8"))
    for_editors = {
        f"{node.module}.{alias.name}"
        for block in tree.body
        if isinstance(block, ast.If)
        for node in block.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    homes = tautwire._HOMES
    assert dir(tautwire) == sorted(tautwire.__all__)
    assert sorted(homes) == NAMES
    assert for_editors == {f"{module}.{name}" for name, module in homes.items()}


def test_exports_are_on_the_reference_page(root: Path) -> None:
    """``docs/api.md`` shows every public name."""
    text = (root / "docs" / "api.md").read_text(encoding="utf-8")
    missing = [
        name
        for name, module in tautwire._HOMES.items()
        if f"{module}.{name}" not in text and f"tautwire.{name}" not in text
    ]
    assert not missing


def test_unknown_name_is_an_attribute_error() -> None:
    """A name that does not exist is reported as usual."""
    with pytest.raises(AttributeError, match="no attribute 'pantograf'"):
        _ = tautwire.pantograf  # pyright: ignore[reportAttributeAccessIssue]


def test_import_has_no_side_effect() -> None:
    """``import tautwire`` loads nothing heavy."""
    code = (
        "import sys; before = set(sys.modules); import tautwire; "
        "print(*sorted(m for m in set(sys.modules) - before if '.' not in m))"
    )
    loaded = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout.split()
    assert "tautwire" in loaded
    assert not {"numpy", "scipy", "pydantic", "yaml", "plotly", "typer"} & set(loaded)
