"""How the package and the repository hang together."""

from __future__ import annotations

import ast
import re
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import tautwire


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
