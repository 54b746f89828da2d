"""Notebooks of the documentation: kept without outputs, true, and run to their ends."""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path
from types import ModuleType

import pytest

DOCS = Path(__file__).resolve().parents[2] / "docs"
NOTEBOOKS = sorted((DOCS / "gallery").glob("*.ipynb"))
LARGEST = 10_000
"""Bytes of a notebook that is kept with the source."""


def _module() -> ModuleType:
    spec = importlib.util.spec_from_file_location("notebooks", DOCS / "_ext" / "notebooks.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook_is_kept_without_outputs(path: Path) -> None:
    """A notebook has a heading, an assertion, and neither outputs nor counts of runs."""
    notebook = json.loads(path.read_text(encoding="utf-8"))
    codes = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert "".join(notebook["cells"][0]["source"]).startswith("## ")
    assert any("assert " in "".join(cell["source"]) for cell in codes)
    assert not any(cell["outputs"] or cell["execution_count"] for cell in codes)
    assert path.stat().st_size <= LARGEST


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook_runs(path: Path) -> None:
    """Every cell runs, its assertions hold, and the page shows what it says."""
    page = _module().page_of(path)
    assert page.count("```python") == sum(kind == "code" for kind, _ in _module().cells_of(path))
    assert "<table>" in page
    assert "```text" in page
