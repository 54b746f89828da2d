"""Runs and their provenance."""

from __future__ import annotations

import re
from datetime import datetime
from pathlib import Path

import numpy as np
import pytest

from tautwire import __version__
from tautwire.errors import InputError
from tautwire.results import provenance as module
from tautwire.results.provenance import provenance

from .synthetic import make_case, make_run


def test_provenance_is_complete() -> None:
    """Program, input, machine and moment are named; the moment is UTC."""
    case = make_case(spans=2)
    found = provenance(case, "reference")
    assert set(found) == {
        *("version", "commit", "created", "case_hash", "python", "platform", "backend"),
    }
    assert found["version"] == __version__
    assert found["case_hash"] == case.hash()
    assert datetime.fromisoformat(found["created"]).utcoffset().total_seconds() == 0.0
    assert re.fullmatch(r"|[0-9a-f]{7,40}(-modified)?", found["commit"])


def test_commit_of_a_foreign_repository_is_not_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A package installed inside somebody's repository does not report that repository."""
    installed = tmp_path / ".venv" / "lib" / "tautwire" / "results" / "provenance.py"
    (tmp_path / ".git").mkdir()
    monkeypatch.setattr(module, "__file__", str(installed))
    module.commit.cache_clear()
    try:
        assert module.commit() == ""
    finally:
        module.commit.cache_clear()


def test_missing_git_is_no_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a git program the commit is empty."""
    monkeypatch.setenv("PATH", "")
    module.commit.cache_clear()
    try:
        assert module.commit() == ""
    finally:
        module.commit.cache_clear()


def test_force_record_starts_when_the_pantograph_enters() -> None:
    """The force of a following pantograph begins when it enters, on a uniform time step."""
    run = make_run(make_case(spans=3, pantographs=2))
    record = run.contact_force("rear")
    assert record.position[0] >= 5.0
    assert record.time[0] > 1.0
    assert record.time_step == pytest.approx(1e-3)
    assert np.all(np.diff(record.time) > 0)


def test_unknown_pantograph_is_refused() -> None:
    """A wrong name is refused and the right ones listed."""
    with pytest.raises(InputError, match=r"'middle'.*front"):
        make_run(make_case(spans=2), duration=0.05).contact_force("middle")
