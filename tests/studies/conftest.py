"""What the tests of studies share: a study of the seeds, its folder, and the log of its tasks."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import textwrap
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from tautwire.specs.study import Study
from tautwire.studies.study_file import make_study

HERE = Path(__file__).parent
SMALL = {
    "line.spans": 4,
    "settings.nodes_between_droppers": 3,
    "settings.time_step": "4 ms",
    "scenario.uplift_force": "150 N",
}
"""Overrides that make a passage of the reference line last less than a second."""


def seeds(count: int, **more: Any) -> Study:
    """Return a study with one case per seed."""
    axes = {"settings.seed": {"seeds": count}}
    return make_study({"schema": 1, "name": "seeds", "base": "ac-simple", "axes": axes, **more})


@dataclass(frozen=True)
class Place:
    """Folder of a study and log of its tasks."""

    folder: Path
    log: Path

    def noted(self, word: str) -> Counter[int]:
        """Return how often each seed was begun or ended."""
        lines = self.log.read_text().splitlines() if self.log.exists() else []
        return Counter(int(line.split()[1]) for line in lines if line.startswith(word))

    def workers(self) -> set[int]:
        """Return the processes that have computed."""
        return {int(line.split()[2]) for line in self.log.read_text().splitlines()}

    def rows(self) -> int:
        """Return the number of finished cases on disk."""
        return len(list((self.folder / "rows").glob("??/*.json")))

    def drafts(self) -> list[Path]:
        """Return what was left half-written."""
        return list(self.folder.rglob("*.part"))


def values_on_disk(folder: Path) -> dict[str, Any]:
    """Return the numbers of every finished case by key, without what it cost."""
    rows = [json.loads(path.read_text()) for path in (folder / "rows").glob("??/*.json")]
    return {row["key"]: row["values"] for row in rows}


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Place:
    """An empty place whose worker processes find the tasks of this folder."""
    log = tmp_path / "tasks.log"
    monkeypatch.setenv("TASK_LOG", str(log))
    monkeypatch.syspath_prepend(str(HERE))
    return Place(tmp_path / "study", log)


Start = Callable[..., subprocess.Popen[str]]


@pytest.fixture
def start_study(place: Place) -> Start:
    """Start a study in a process of its own, which can be killed."""

    def start(code: str, **options: Any) -> subprocess.Popen[str]:
        script = f"""
            from tautwire.studies.execution.executor import LocalWorkers
            from tautwire.studies.run import Options, run_study
            from tautwire.studies.study_file import make_study
            folder = {str(place.folder)!r}
        """
        paths = os.pathsep.join([str(HERE), *filter(None, sys.path)])
        return subprocess.Popen(
            [sys.executable, "-c", textwrap.dedent(script) + textwrap.dedent(code)],
            env={**os.environ, "PYTHONPATH": paths},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            **options,
        )

    return start
