"""Parts of a study computed on their own, and folders of studies that are moved."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tautwire.errors import InputError
from tautwire.files import FolderLock
from tautwire.studies.execution.executor import LocalWorkers
from tautwire.studies.plan import Shard, plan_study
from tautwire.studies.run import Options, run_study

from .conftest import SMALL, Place, seeds, values_on_disk

STUDY: dict[str, Any] = {
    "schema": 1,
    "name": "parts",
    "base": "ac-simple",
    "overrides": SMALL,
    "axes": {"scenario.speed": {"from": "200 km/h", "to": "260 km/h", "count": 7}},
}


def tautwire(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run the study's command in a folder."""
    return subprocess.run(
        [sys.executable, "-m", "tautwire", "study", "study.json", "--workers", "1", *arguments],
        cwd=folder, capture_output=True, text=True, check=False, timeout=300,
    )  # fmt: skip


@pytest.mark.parametrize("count", [1, 2, 3, 7, 9])
def test_parts_make_up_the_study(count: int) -> None:
    """Every case belongs to exactly one part; parts differ by one case at most."""
    keys = list(plan_study(seeds(7)).by_key)
    parts = [Shard(number, count).of(keys) for number in range(1, count + 1)]
    assert sorted(key for part in parts for key in part) == sorted(keys)
    assert max(map(len, parts)) - min(map(len, parts)) <= 1


@pytest.mark.parametrize("text", ["", "3", "0/4", "5/4", "1/0", "-1/4", "a/b", "1/2/3", "1.5/2"])
def test_malformed_parts(text: str) -> None:
    """What names no part is refused."""
    with pytest.raises(InputError, match="expected I/N with I from 1 to N"):
        Shard.parse(text)


def test_parts_share_a_folder_and_whole_studies_do_not(tmp_path: Path) -> None:
    """Two parts compute side by side; the same part twice, or the whole beside one, is refused."""
    refused = pytest.raises(InputError, match="another command is computing")
    with FolderLock(tmp_path, "1/2"), FolderLock(tmp_path, "2/2"):
        with refused, FolderLock(tmp_path, "1/2"):
            pass
        with refused, FolderLock(tmp_path):
            pass
    with FolderLock(tmp_path), refused, FolderLock(tmp_path, "1/2"):
        pass
    with FolderLock(tmp_path):
        pass


def test_part_leaves_the_drafts_of_others(place: Place) -> None:
    """A part removes nothing that another one may be writing; the whole study clears it up."""
    options = {"task": "slow_tasks:nap", "resume": True}
    draft = place.folder / "rows" / "ab" / ".abcd.json.1.part"
    draft.parent.mkdir(parents=True)
    draft.touch()
    for number in (1, 2):
        part = Options(shard=Shard(number, 2), **options)  # type: ignore[arg-type]
        table = run_study(
            seeds(5), place.folder, executor=LocalWorkers(1, place.folder), options=part
        )
        assert table.counts()["done"] == (3, 5)[number - 1]
        assert draft.exists()
    whole = Options(**options)  # type: ignore[arg-type]
    run_study(seeds(5), place.folder, executor=LocalWorkers(1, place.folder), options=whole)
    assert not draft.exists()
    assert place.noted("begin") == dict.fromkeys(range(5), 1)


@pytest.mark.slow
def test_parts_are_merged(tmp_path: Path) -> None:
    """Parts in one folder, or in several put together, give the rows of the whole; resumable."""
    for name in ("whole", "shared", "apart", "other"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "study.json").write_text(json.dumps(STUDY))
    result = "tautwire-study-parts"
    assert tautwire(tmp_path / "whole").returncode == 0
    expected = values_on_disk(tmp_path / "whole" / result)

    first = tautwire(tmp_path / "shared", "--shard", "1/2")
    assert (first.returncode, "4 of 7 cases" in first.stdout) == (0, True)
    assert not (tmp_path / "shared" / result / "table.csv").exists()
    again = tautwire(tmp_path / "shared", "--shard", "1/2")
    assert again.returncode == 2
    assert "add --resume" in again.stderr
    resumed = tautwire(tmp_path / "shared", "--shard", "1/2", "--resume", "--json")
    assert json.loads(resumed.stdout)["computed_now"] == 0
    assert tautwire(tmp_path / "shared", "--shard", "2/2").returncode == 0
    assert (tmp_path / "shared" / result / "table.csv").exists()
    assert values_on_disk(tmp_path / "shared" / result) == expected

    tautwire(tmp_path / "apart", "--shard", "1/2")
    tautwire(tmp_path / "other", "--shard", "2/2")
    rows = Path(result, "rows")
    shutil.copytree(tmp_path / "other" / rows, tmp_path / "apart" / rows, dirs_exist_ok=True)
    merged = tautwire(tmp_path / "apart", "--resume", "--json")
    assert json.loads(merged.stdout)["computed_now"] == 0
    assert values_on_disk(tmp_path / "apart" / result) == expected


@pytest.mark.slow
def test_folder_is_moved(tmp_path: Path) -> None:
    """Study, base case, its table and the results are moved: --resume computes nothing again."""
    first, second = tmp_path / "first", tmp_path / "second" / "deeper"
    (first / "lines").mkdir(parents=True)
    second.parent.mkdir()
    subprocess.run(
        [sys.executable, "-m", "tautwire", "cases", "ac-simple", "--copy", "lines/own.yaml"],
        cwd=first, check=True, capture_output=True,
    )  # fmt: skip
    rows = "\n".join(f"{number},{55 * (number - 1)}" for number in range(1, 6))
    (first / "lines" / "supports.csv").write_text(f"support,x [m]\n{rows}\n")
    text = (first / "lines" / "own.yaml").read_text()
    text = re.sub(r"\n  span(s|_length): .*", "", text)
    (first / "lines" / "own.yaml").write_text(f"{text}\ntables: {{supports: supports.csv}}\n")
    overrides = {path: value for path, value in SMALL.items() if path != "line.spans"}
    own = {**STUDY, "base": "lines/own.yaml", "overrides": overrides, "keep_runs": True}
    (first / "study.json").write_text(json.dumps(own))
    outcome = tautwire(first, "--json")
    assert outcome.returncode == 0, outcome.stderr
    first.rename(second)
    resumed = tautwire(second, "--resume", "--json")
    assert resumed.returncode == 0, resumed.stderr
    assert json.loads(resumed.stdout)["computed_now"] == 0
    assert json.loads(resumed.stdout)["rows"] == json.loads(outcome.stdout)["rows"]
