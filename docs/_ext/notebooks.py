"""Run the notebooks of the gallery and write down what their cells show.

A notebook is kept without its outputs: they are made when the documentation is built, and a test
runs every cell. A cell shows the value of its last line, as Jupyter does.
"""

from __future__ import annotations

import ast
import io
import json
from base64 import b64encode
from collections.abc import Iterator
from contextlib import chdir, redirect_stdout
from pathlib import Path
from typing import Any

GALLERY = Path(__file__).resolve().parents[1] / "gallery"
WIDTH = 170.0
"""Of figures [mm]."""


def cells_of(path: Path) -> list[tuple[str, str]]:
    """Return kind, ``"markdown"`` or ``"code"``, and text of every cell of a notebook."""
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return [(cell["cell_type"], "".join(cell["source"])) for cell in cells]


def page_of(path: Path) -> str:
    """Run a notebook in its folder and return it with its outputs as Markdown."""
    with chdir(path.parent):
        return "\n\n".join(_parts(path)) + "\n"


def _parts(path: Path) -> Iterator[str]:
    names: dict[str, Any] = {"__name__": "__main__"}
    for kind, text in cells_of(path):
        if kind == "markdown":
            yield text
            continue
        yield f"```python\n{text}\n```"
        printed, value = run_cell(text, names)
        if printed:
            yield f"```text\n{printed.rstrip()}\n```"
        if value is not None:
            yield _shown(value)


def run_cell(text: str, names: dict[str, Any]) -> tuple[str, Any]:
    """Run a cell; return what it prints and the value of its last line, None if it has none."""
    tree, last = ast.parse(text), None
    if tree.body and isinstance(tree.body[-1], ast.Expr):
        last = ast.Expression(tree.body.pop().value)
    with redirect_stdout(io.StringIO()) as printed:
        exec(compile(tree, "<cell>", "exec"), names)
        value = None if last is None else eval(compile(last, "<cell>", "eval"), names)
    return printed.getvalue(), value


def _shown(value: Any) -> str:
    """Return a value as Jupyter would show it, figures as pictures."""
    if hasattr(value, "to_plotly_json"):
        from tautwire.report.writers.drawing.figure import figure_svg

        picture = b64encode(figure_svg(value.to_json(), WIDTH)).decode("ascii")
        return _raw(f'<img alt="Figure" src="data:image/svg+xml;base64,{picture}">')
    page = value._repr_html_() if hasattr(value, "_repr_html_") else None
    return _raw(page) if page else f"```text\n{value!r}\n```"


def _raw(text: str) -> str:
    return f"````{{raw}} html\n{text}\n````"


def gallery() -> str:
    """Return all notebooks of the gallery, run, one after the other."""
    return "\n\n".join(page_of(path) for path in sorted(GALLERY.glob("*.ipynb")))
