"""How the package and the repository hang together."""

from __future__ import annotations

import ast
import hashlib
import re
import tomllib
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import pytest
from plotly.offline import get_plotlyjs_version

import tautwire
from tautwire.report.writers.html import LIBRARIES, library_file

CHART_LIBRARY = "4.1.1"
"""Version of plotly.js-basic-dist-min and plotly.js-cartesian-dist-min on the npm registry; below,
the digests of their scripts."""
CHART_LIBRARY_SHA256 = {
    "basic": "99784e3abfb07b142a15e521a439e6d9addceadb3f79553fd24c72774f0649ba",
    "cartesian": "79542150855a52c567260e3137095dbe2b744e6d702a5cabe67da246942fba7a",
}


def test_only_the_command_line_prints(sources: dict[str, ast.Module]) -> None:
    """No module outside ``cli`` calls print, breakpoint or input."""
    found = [
        f"{path}:{node.lineno} {node.func.id}"
        for path, tree in sources.items()
        if not path.startswith("tautwire/cli/")
        for node in ast.walk(tree)
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Name)
        and node.func.id in {"print", "breakpoint", "input"}
    ]
    assert not found, "\n".join(found)


def test_every_package_has_an_init(root: Path) -> None:
    """A folder with modules is a package, so it is installed and layered."""
    folders = {path.parent for path in (root / "src" / "tautwire").rglob("*.py")}
    missing = [str(folder) for folder in folders if not (folder / "__init__.py").exists()]
    assert not missing


def test_data_files_are_installed(root: Path) -> None:
    """Library cases, templates and the typing marker are part of the installed package."""
    installed = Path(tautwire.__file__).parent
    source = root / "src" / "tautwire"
    kinds = {".yaml", ".csv", ".html", ".j2", ".js", ".css", ".typ", ".typed"}
    data = [
        p.relative_to(source)
        for p in source.rglob("*")
        if p.suffix in kinds or p.name == "py.typed"
    ]
    missing = [str(path) for path in data if not (installed / path).exists()]
    assert Path("py.typed") in data
    assert not missing


def test_version_stands_in_one_place(root: Path) -> None:
    """The installed version is the one in ``tautwire/version.py``."""
    try:
        installed = version("tautwire")
    except PackageNotFoundError:
        installed = tautwire.__version__
    texts = [
        (root / name).read_text(encoding="utf-8") for name in ("pyproject.toml", "CITATION.cff")
    ]
    assert installed == tautwire.__version__
    assert not any(re.search(r"^version\s*[:=]", text, re.MULTILINE) for text in texts)


def test_ci_runs_the_readme_test_command(root: Path) -> None:
    """``.ci/run`` contains the README's test command, with its own virtual environment."""
    readme = (root / "README.md").read_text(encoding="utf-8")
    script = (root / ".ci" / "run").read_text(encoding="utf-8")
    command = next(line for line in readme.splitlines() if line.endswith("-m pytest"))
    plain = (
        script.replace('"', "")
        .replace("$work/native", ".venv")
        .replace("install --quiet", "install")
    )
    assert command in plain


def test_make_check_is_ci(root: Path) -> None:
    """``make check`` and the hosted workflow run the same script."""
    makefile = (root / "Makefile").read_text(encoding="utf-8")
    workflow = (root / ".github" / "workflows" / "ci.yml").read_text(encoding="utf-8")
    assert "check:\n\tbash .ci/run\n" in makefile
    assert "run: bash .ci/run" in workflow


@pytest.mark.parametrize("bundle", LIBRARIES)
def test_chart_library_is_the_one_that_is_named(bundle: str, root: Path) -> None:
    """A bundle of plotly.js is the published file, unchanged, its licence beside it."""
    folder = root / "src" / "tautwire" / "report" / "templates" / "plotly"
    script = (folder / f"plotly-{bundle}.min.js").read_bytes()
    assert hashlib.sha256(script).hexdigest() == CHART_LIBRARY_SHA256[bundle]
    named = re.search(rb"plotly\.js \((\w+) - minified\) v([\d.]+)", script[:200])
    assert named
    assert (named[1].decode(), named[2].decode()) == (bundle, CHART_LIBRARY)
    assert (folder / "LICENSE").read_text(encoding="utf-8").startswith("MIT License")
    licences = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))
    assert set(licences["project"]["license-files"]) == {
        "LICENSE",
        "src/tautwire/report/templates/plotly/LICENSE",
    }


def test_chart_library_knows_what_the_figures_say() -> None:
    """Python's Plotly, which describes the figures, speaks of the same generation of plotly.js."""
    spoken = get_plotlyjs_version()
    assert spoken.split(".")[0] == CHART_LIBRARY.split(".")[0]


@pytest.mark.parametrize("bundle", LIBRARIES)
def test_traces_of_a_bundle_are_in_it(bundle: str) -> None:
    """The kinds of traces for which a bundle of plotly.js is taken are those that it has."""
    script = library_file(bundle).read_text(encoding="utf-8")
    assert set(re.findall(r'moduleType:"trace",name:"(\w+)"', script)) == LIBRARIES[bundle]


def test_a_folder_holds_at_most_twelve_files(root: Path) -> None:
    """Folders stay small enough to be read at a glance; compiled files do not count."""
    folders = {path.parent for path in (root / "src" / "tautwire").rglob("*.py")}
    counts = {
        str(folder.relative_to(root)): sum(
            path.is_file() and path.suffix not in {".so", ".pyd"} for path in folder.iterdir()
        )
        for folder in folders
    }
    assert not {folder: count for folder, count in counts.items() if count > 12}
